// One body for all widths, as in dense.cpp.
#include "lane_operations.hpp"

#include <stdexcept>

#include "vectors.hpp"

namespace banded {
namespace {

template <class Lane>
LIFTOPT_INLINE const Lane* lanes(const double* p) {
  return reinterpret_cast<const Lane*>(p);
}
template <class Lane>
LIFTOPT_INLINE Lane* lanes(double* p) {
  return reinterpret_cast<Lane*>(p);
}

template <class Lane>
LIFTOPT_INLINE void multiply(const Sums& all, const double* values, const double* from, double* to) {
  const Product* p = all.products.data();
  for (const Sum& sum : all.sums) {
    Lane total = lanes<Lane>(to)[sum.to];
    for (const Product* end = all.products.data() + sum.end; p != end; ++p)
      total += lanes<Lane>(values)[p->value] * lanes<Lane>(from)[p->from];
    lanes<Lane>(to)[sum.to] = total;
  }
}

template <class Lane>
LIFTOPT_INLINE void interpolate(const double* basis, int width, const double* points, int stride, int n, double* y) {
  const Lane *b = lanes<Lane>(basis), *from = lanes<Lane>(points);
  Lane* to = lanes<Lane>(y);
  for (int a = 0; a < kOrders; ++a)
    for (int j = 0; j < n; ++j) {
      Lane sum = b[a * width] * from[j];
      for (int i = 1; i < width; ++i) sum += b[a * width + i] * from[i * stride + j];
      to[a * n + j] = sum;
    }
}

template <class Lane>
LIFTOPT_INLINE void interpolate_transposed(const double* basis, int width, const double* y, int stride, int n,
                                           double* points) {
  const Lane *b = lanes<Lane>(basis), *from = lanes<Lane>(y);
  Lane* to = lanes<Lane>(points);
  for (int i = 0; i < width; ++i)
    for (int j = 0; j < n; ++j) {
      Lane sum = b[i] * from[j];
      for (int a = 1; a < kOrders; ++a) sum += b[a * width + i] * from[a * n + j];
      to[i * stride + j] = sum;
    }
}

template <class Lane>
LIFTOPT_INLINE void fill_rows(const RowEntry* entries, int count, const double* scale, const double* factors,
                              const double* slopes, double* rows) {
  Lane* to = lanes<Lane>(rows);
  for (const RowEntry* e = entries; e != entries + count; ++e) {
    const Lane weight = e->varied < 0 ? lanes<Lane>(scale)[e->row] * e->factor
                                      : lanes<Lane>(scale)[e->row] * lanes<Lane>(factors)[e->varied];
    const Lane value = weight * lanes<Lane>(slopes)[e->from];
    to[e->to] = e->first ? value : to[e->to] + value;
  }
}

template <class Lane, int Width>
LIFTOPT_INLINE void condense_coordinates(const Pair& pair, const double* basis, const double* curvatures,
                                         const double* rows, double* entries) {
  Lane sum[kOrders][kOrders] = {};
  const Lane *r = lanes<Lane>(rows), *b = lanes<Lane>(basis);
  for (const Pair::Row& row : pair.full)
#pragma GCC unroll 3
    for (int i = 0; i < kOrders; ++i)
#pragma GCC unroll 3
      for (int j = 0; j < kOrders; ++j) sum[i][j] += r[row.one + i] * r[row.other + j];
  for (const Pair::Row& row : pair.first) sum[0][0] += r[row.one] * r[row.other];
  alignas(sizeof(Lane)) Lane kept[kOrders * kOrders];
#pragma GCC unroll 9
  for (int i = 0; i < kOrders * kOrders; ++i) kept[i] = sum[i / kOrders][i % kOrders];
  for (const Pair::Curvature& c : pair.curvatures) kept[c.entry] += lanes<Lane>(curvatures)[c.from];
  Lane half[kOrders][Width];
#pragma GCC unroll 3
  for (int i = 0; i < kOrders; ++i)
#pragma GCC unroll 4
    for (int q = 0; q < Width; ++q) {
      half[i][q] = kept[i * kOrders] * b[q];
#pragma GCC unroll 2
      for (int j = 1; j < kOrders; ++j) half[i][q] += kept[i * kOrders + j] * b[j * Width + q];
    }
#pragma GCC unroll 4
  for (int p = 0; p < Width; ++p)
#pragma GCC unroll 4
    for (int q = 0; q < Width; ++q) {
      Lane entry = b[p] * half[0][q];
#pragma GCC unroll 2
      for (int i = 1; i < kOrders; ++i) entry += b[i * Width + p] * half[i][q];
      lanes<Lane>(entries)[p * Width + q] = entry;
    }
}

template <class Lane, int Width>
LIFTOPT_INLINE void condense(const Pair& pair, const double* basis, const double* curvatures, const double* rows,
                             double* entries) {
  if (pair.kind == Pair::coordinates) {
    condense_coordinates<Lane, Width>(pair, basis, curvatures, rows, entries);
    return;
  }
  const Lane *r = lanes<Lane>(rows), *b = lanes<Lane>(basis);
  Lane sum[kOrders] = {};
  for (const Pair::Curvature& c : pair.curvatures) sum[c.entry] += lanes<Lane>(curvatures)[c.from];
  for (const Pair::Row& row : pair.full)
    for (int j = 0; j < kOrders; ++j) sum[j] += r[row.one + j] * r[row.other];
  for (const Pair::Row& row : pair.first) sum[0] += r[row.one] * r[row.other];
  if (pair.kind == Pair::forces) {
    lanes<Lane>(entries)[0] = sum[0];
    return;
  }
  for (int p = 0; p < Width; ++p) {
    Lane entry = b[p] * sum[0];
    for (int j = 1; j < kOrders; ++j) entry += b[j * Width + p] * sum[j];
    lanes<Lane>(entries)[p] = entry;
  }
}

template <class Lane>
LIFTOPT_INLINE void condense(const Pair& pair, const double* basis, int width, const double* curvatures,
                             const double* rows, double* entries) {
  switch (width) {
    case 1: return condense<Lane, 1>(pair, basis, curvatures, rows, entries);
    case 2: return condense<Lane, 2>(pair, basis, curvatures, rows, entries);
    case 3: return condense<Lane, 3>(pair, basis, curvatures, rows, entries);
    default: return condense<Lane, kMostNear>(pair, basis, curvatures, rows, entries);
  }
}

#define LIFTOPT_LANES(NAME, TARGET, LANE)                                                                              \
  namespace NAME {                                                                                                     \
  TARGET void multiply(const Sums& sums, const double* values, const double* from, double* to) {                       \
    banded::multiply<LANE>(sums, values, from, to);                                                                    \
  }                                                                                                                    \
  TARGET void interpolate(const double* basis, int width, const double* points, int stride, int n, double* y) {        \
    banded::interpolate<LANE>(basis, width, points, stride, n, y);                                                     \
  }                                                                                                                    \
  TARGET void interpolate_transposed(const double* basis, int width, const double* y, int stride, int n,               \
                                     double* points) {                                                                 \
    banded::interpolate_transposed<LANE>(basis, width, y, stride, n, points);                                          \
  }                                                                                                                    \
  TARGET void fill_rows(const RowEntry* entries, int count, const double* scale, const double* factors,                \
                        const double* slopes, double* rows) {                                                          \
    banded::fill_rows<LANE>(entries, count, scale, factors, slopes, rows);                                             \
  }                                                                                                                    \
  TARGET void condense(const Pair& pair, const double* basis, int width, const double* curvatures,                     \
                       const double* rows, double* entries) {                                                          \
    banded::condense<LANE>(pair, basis, width, curvatures, rows, entries);                                             \
  }                                                                                                                    \
  const LaneOperations all = {multiply, interpolate, interpolate_transposed, fill_rows, condense};                     \
  }

LIFTOPT_LANES(two, , Two)
#if defined(__x86_64__)
LIFTOPT_LANES(four, LIFTOPT_AVX2, Four)
LIFTOPT_LANES(eight, LIFTOPT_AVX512, Eight)
#endif

}  // namespace

const LaneOperations& lane_operations(int lanes) {
#if defined(__x86_64__)
  if (lanes == 8 && has_avx512()) return eight::all;
  if (lanes == 4 && has_avx2()) return four::all;
#endif
  if (lanes == 2) return two::all;
  throw std::invalid_argument("this processor has no vectors of that many lanes");
}

}  // namespace banded
