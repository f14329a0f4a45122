// One body for all instruction sets: GCC's and Clang's vector types lower to what the target has. The shapes of the
// register tiles differ: the accumulators must fit the registers and be as many as hide the latency of an addition.
#include "dense.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "vectors.hpp"

namespace banded {
namespace {

template <class Lane>
constexpr int kWidth = sizeof(Lane) / sizeof(double);

// A tile of C: A B^T if `d` is null, else D - A B^T. It is written when all of it is known.
template <class Lane, int Height, int Width>
LIFTOPT_INLINE void multiply_tile(double* c, int ldc, const double* d, const double* a, int lda, const double* b,
                                  int ldb, int depth) {
  Lane sum[Width][Height];
  for (int j = 0; j < Width; ++j)
    for (int i = 0; i < Height; ++i) sum[j][i] = Lane{};
  for (int l = 0; l < depth; ++l) {
    const Lane* column = reinterpret_cast<const Lane*>(a + static_cast<long>(lda) * l);
    const double* row = b + static_cast<long>(ldb) * l;
#pragma GCC unroll 8
    for (int j = 0; j < Width; ++j)
#pragma GCC unroll 4
      for (int i = 0; i < Height; ++i) sum[j][i] += column[i] * row[j];
  }
#pragma GCC unroll 8
  for (int j = 0; j < Width; ++j) {
    Lane* column = reinterpret_cast<Lane*>(c + static_cast<long>(ldc) * j);
    const Lane* from = d ? reinterpret_cast<const Lane*>(d + static_cast<long>(ldc) * j) : nullptr;
#pragma GCC unroll 4
    for (int i = 0; i < Height; ++i) column[i] = from ? from[i] - sum[j][i] : sum[j][i];
  }
}

// Tiles of Tall vectors by Width columns, then of kLanes rows, from row i on.
template <class Lane, int Tall, int Width>
LIFTOPT_INLINE void multiply_columns(double* c, int ldc, const double* d, const double* a, int lda, const double* b,
                                     int ldb, int i, int rows, int depth) {
  constexpr int kTall = Tall * kWidth<Lane>, kShort = kLanes / kWidth<Lane>;
  if (kTall % kLanes == 0 || (rows - i) % kTall == 0)
    for (; i + kTall <= rows; i += kTall)
      multiply_tile<Lane, Tall, Width>(c + i, ldc, d ? d + i : nullptr, a + i, lda, b, ldb, depth);
  for (; i < rows; i += kLanes)
    multiply_tile<Lane, kShort, Width>(c + i, ldc, d ? d + i : nullptr, a + i, lda, b, ldb, depth);
}

// The last columns first: those before need none of them, so C may be A. Products with the zeros of L are left out.
template <class Lane, int Tall, int Width>
LIFTOPT_INLINE void multiply_triangular(double* c, int ldc, const double* a, int lda, const double* l, int ldl,
                                        int rows, int n) {
  for (int j = padded(n) - Width; j >= 0; j -= Width)
    multiply_columns<Lane, Tall, Width>(c + static_cast<long>(ldc) * j, ldc, nullptr, a, lda, l + j, ldl, 0, rows,
                                        std::min(n, j + Width));
}

template <class Lane, int Tall, int Width, bool Lower>
LIFTOPT_INLINE void subtract_product(double* c, int ldc, const double* d, const double* a, int lda, const double* b,
                                     int ldb, int rows, int columns, int depth) {
  for (int j = 0; j < columns; j += Width) {
    const long column = static_cast<long>(ldc) * j;
    multiply_columns<Lane, Tall, Width>(c + column, ldc, d + column, a, lda, b + j, ldb,
                                        Lower ? j / kLanes * kLanes : 0, rows, depth);
  }
}

// Vectors first .. first + Height of column k less what the columns before it take away, in their order.
template <class Lane, int Height>
LIFTOPT_INLINE void eliminate(double* a, int ld, int k, int first) {
  Lane* to = reinterpret_cast<Lane*>(a + static_cast<long>(ld) * k) + first;
  Lane rest[Height];
#pragma GCC unroll 4
  for (int r = 0; r < Height; ++r) rest[r] = to[r];
  for (int j = 0; j < k; ++j) {
    const double* column = a + static_cast<long>(ld) * j;
    const Lane* from = reinterpret_cast<const Lane*>(column) + first;
#pragma GCC unroll 4
    for (int r = 0; r < Height; ++r) rest[r] -= from[r] * column[k];
  }
#pragma GCC unroll 4
  for (int r = 0; r < Height; ++r) to[r] = rest[r];
}

// Row j of the inverse, columns 0 .. j, and what it takes from Height vectors of rows from there on.
template <class Lane, int Height>
LIFTOPT_INLINE void substitute(const double* column, int ld, int j, double* inverse) {
  constexpr int kSize = kWidth<Lane>;
  using Mask = decltype(Lane{} < Lane{});
  Mask own;
  for (int r = 0; r < kSize; ++r) own[r] = r == j % kSize ? -1 : 0;
  Lane lower[Height];
#pragma GCC unroll 4
  for (int r = 0; r < Height; ++r) lower[r] = reinterpret_cast<const Lane*>(column)[j / kSize + r];
  const double scale = 1.0 / column[j];
  for (int c = 0; c <= j; ++c) {
    double* x = inverse + static_cast<long>(ld) * c;
    const double value = x[j] * scale;
    Lane* to = reinterpret_cast<Lane*>(x) + j / kSize;
    // The first vector holds rows up to j too: the zeros above the diagonal keep them.
    to[0] = own ? Lane{} + value : to[0] - lower[0] * value;
#pragma GCC unroll 4
    for (int r = 1; r < Height; ++r) to[r] -= lower[r] * value;
  }
}

// The same where there are more vectors than registers for them.
template <class Lane>
LIFTOPT_INLINE void substitute_tall(const double* column, int ld, int j, int lanes, double* inverse) {
  const Lane* lower = reinterpret_cast<const Lane*>(column);
  const double scale = 1.0 / column[j];
  for (int c = 0; c <= j; ++c) {
    double* x = inverse + static_cast<long>(ld) * c;
    const double value = x[j] * scale;
    for (int r = j / kWidth<Lane>; r < lanes; ++r) reinterpret_cast<Lane*>(x)[r] -= lower[r] * value;
    x[j] = value;
  }
}

template <class Lane>
LIFTOPT_INLINE bool factorise(double* a, int ld, int n, double* inverse, double threshold) {
  constexpr int kSize = kWidth<Lane>;
  const int lanes = ld / kSize;
  for (int k = 0; k < n; ++k) {
    double* column = a + static_cast<long>(ld) * k;
    int first = k / kSize;
    for (; first + 3 <= lanes; first += 3) eliminate<Lane, 3>(a, ld, k, first);
    if (first + 2 == lanes) eliminate<Lane, 2>(a, ld, k, first);
    if (first + 1 == lanes) eliminate<Lane, 1>(a, ld, k, first);
    if (!(column[k] > threshold)) return false;
    const double scale = 1.0 / std::sqrt(column[k]);
    for (int r = k / kSize; r < lanes; ++r) reinterpret_cast<Lane*>(column)[r] *= scale;
    // Rows above the diagonal hold what symmetry left there.
    for (int r = 0; r < k; ++r) column[r] = 0.0;
  }
  std::memset(inverse, 0, sizeof(double) * ld * padded(n));
  for (int c = 0; c < n; ++c) inverse[static_cast<long>(ld) * c + c] = 1.0;
  for (int j = 0; j < n; ++j) {
    const double* column = a + static_cast<long>(ld) * j;
    switch (lanes - j / kSize) {
      case 1: substitute<Lane, 1>(column, ld, j, inverse); break;
      case 2: substitute<Lane, 2>(column, ld, j, inverse); break;
      case 3: substitute<Lane, 3>(column, ld, j, inverse); break;
      default: substitute_tall<Lane>(column, ld, j, lanes, inverse);
    }
  }
  return true;
}

template <class Lane>
LIFTOPT_INLINE void multiply_vector(double* y, const double* a, int lda, int rows, int columns, const double* x,
                                    double sign) {
  Lane* to = reinterpret_cast<Lane*>(y);
  for (int j = 0; j < columns; ++j) {
    const Lane* column = reinterpret_cast<const Lane*>(a + static_cast<long>(lda) * j);
    const double factor = sign * x[j];
    for (int r = 0; r < rows / kWidth<Lane>; ++r) to[r] += column[r] * factor;
  }
}

template <class Lane>
LIFTOPT_INLINE void multiply_transposed(double* y, const double* a, int lda, int rows, int columns, const double* x,
                                        double sign) {
  // As many sums side by side with vectors of any width, so that all round alike.
  constexpr int kSums = kLanes / kWidth<Lane>;
  const Lane* from = reinterpret_cast<const Lane*>(x);
  for (int j = 0; j < columns; ++j) {
    const Lane* column = reinterpret_cast<const Lane*>(a + static_cast<long>(lda) * j);
    Lane sum[kSums] = {};
    for (int r = 0; r < rows / kWidth<Lane>; r += kSums)
#pragma GCC unroll 4
      for (int s = 0; s < kSums; ++s) sum[s] += column[r + s] * from[r + s];
    double total = 0.0;
    for (int s = 0; s < kSums; ++s)
      for (int r = 0; r < kWidth<Lane>; ++r) total += sum[s][r];
    y[j] += sign * total;
  }
}

// The same bodies for a target: its name, its attribute, its vectors, and the tile of vectors by columns.
#define LIFTOPT_VARIANT(NAME, TARGET, LANE, TALL, WIDTH)                                                               \
  namespace NAME {                                                                                                     \
  TARGET void multiply_triangular(double* c, int ldc, const double* a, int lda, const double* l, int ldl, int rows,    \
                                  int n) {                                                                             \
    banded::multiply_triangular<LANE, TALL, WIDTH>(c, ldc, a, lda, l, ldl, rows, n);                                   \
  }                                                                                                                    \
  TARGET void subtract_product(double* c, int ldc, const double* d, const double* a, int lda, const double* b,         \
                               int ldb, int rows, int columns, int depth) {                                            \
    banded::subtract_product<LANE, TALL, WIDTH, false>(c, ldc, d, a, lda, b, ldb, rows, columns, depth);               \
  }                                                                                                                    \
  TARGET void subtract_square(double* c, int ldc, const double* a, int lda, int rows, int depth) {                     \
    banded::subtract_product<LANE, TALL, WIDTH, true>(c, ldc, c, a, lda, a, lda, rows, rows, depth);                   \
  }                                                                                                                    \
  TARGET bool factorise(double* a, int ld, int n, double* inverse, double threshold) {                                 \
    return banded::factorise<LANE>(a, ld, n, inverse, threshold);                                                      \
  }                                                                                                                    \
  TARGET void multiply_vector(double* y, const double* a, int lda, int rows, int columns, const double* x,             \
                              double sign) {                                                                           \
    banded::multiply_vector<LANE>(y, a, lda, rows, columns, x, sign);                                                  \
  }                                                                                                                    \
  TARGET void multiply_transposed(double* y, const double* a, int lda, int rows, int columns, const double* x,         \
                                  double sign) {                                                                       \
    banded::multiply_transposed<LANE>(y, a, lda, rows, columns, x, sign);                                              \
  }                                                                                                                    \
  const DenseOperations all = {#NAME,     multiply_triangular, subtract_product,   subtract_square,                    \
                               factorise, multiply_vector,     multiply_transposed};                                   \
  }

LIFTOPT_VARIANT(portable, , Two, 4, 2)
#if defined(__x86_64__)
LIFTOPT_VARIANT(avx2, LIFTOPT_AVX2, Four, 3, 4)
LIFTOPT_VARIANT(avx512, LIFTOPT_AVX512, Eight, 3, 8)
#endif

const DenseOperations*& chosen() {
  static const DenseOperations* operations = runnable_operations().front();
  return operations;
}

}  // namespace

std::vector<const DenseOperations*> runnable_operations() {
  std::vector<const DenseOperations*> variants;
#if defined(__x86_64__)
  if (has_avx512()) variants.push_back(&avx512::all);
  if (has_avx2()) variants.push_back(&avx2::all);
#endif
  variants.push_back(&portable::all);
  return variants;
}

const DenseOperations& dense_operations() { return *chosen(); }

bool choose_operations(const std::string& name) {
  for (const DenseOperations* variant : runnable_operations())
    if (variant->name == name) {
      chosen() = variant;
      return true;
    }
  return false;
}

}  // namespace banded
