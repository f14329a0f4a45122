// One body for all instruction sets: GCC's and Clang's vector types lower to what the target has. The shapes of the
// register tiles differ: the accumulators must fit the registers and be as many as hide the latency of an addition.
#include "dense.hpp"

#include <cmath>
#include <cstring>

#include "vectors.hpp"

namespace banded {
namespace {

template <class Lane>
constexpr int kWidth = sizeof(Lane) / sizeof(double);

template <class Lane, int Height, int Width>
LIFTOPT_INLINE void multiply_tile(double* c, int ldc, const double* a, int lda, const double* b, int ldb, int depth,
                                  double sign) {
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
#pragma GCC unroll 4
    for (int i = 0; i < Height; ++i) column[i] += sign * sum[j][i];
  }
}

// Tiles of Tall vectors by Width columns, then of kLanes rows; of the lower triangle only those from the diagonal
// on.
template <class Lane, int Tall, int Width, bool Lower>
LIFTOPT_INLINE void multiply_add(double* c, int ldc, const double* a, int lda, const double* b, int ldb, int rows,
                                 int columns, int depth, double sign) {
  constexpr int kTall = Tall * kWidth<Lane>, kShort = kLanes / kWidth<Lane>;
  for (int j = 0; j < columns; j += Width) {
    double* cj = c + static_cast<long>(ldc) * j;
    int i = Lower ? j / kLanes * kLanes : 0;
    if (kTall % kLanes == 0 || (rows - i) % kTall == 0)
      for (; i + kTall <= rows; i += kTall)
        multiply_tile<Lane, Tall, Width>(cj + i, ldc, a + i, lda, b + j, ldb, depth, sign);
    for (; i < rows; i += kLanes)
      multiply_tile<Lane, kShort, Width>(cj + i, ldc, a + i, lda, b + j, ldb, depth, sign);
  }
}

template <class Lane>
LIFTOPT_INLINE bool factorise(double* a, int ld, int n, double* inverse, double threshold) {
  constexpr int kSize = kWidth<Lane>;
  const int lanes = ld / kSize;
  for (int j = 0; j < n; ++j) {
    double* column = a + static_cast<long>(ld) * j;
    if (!(column[j] > threshold)) return false;
    const double pivot = std::sqrt(column[j]), scale = 1.0 / pivot;
    Lane* from = reinterpret_cast<Lane*>(column);
    for (int r = j / kSize; r < lanes; ++r) from[r] *= scale;
    for (int k = j + 1; k < n; ++k) {
      const double factor = column[k];
      Lane* to = reinterpret_cast<Lane*>(a + static_cast<long>(ld) * k);
      for (int r = k / kSize; r < lanes; ++r) to[r] -= from[r] * factor;
    }
    // Rows above the diagonal hold what symmetry left there.
    for (int r = 0; r < j; ++r) column[r] = 0.0;
  }
  std::memset(inverse, 0, sizeof(double) * ld * padded(n));
  for (int c = 0; c < n; ++c) inverse[static_cast<long>(ld) * c + c] = 1.0;
  for (int j = 0; j < n; ++j) {
    const double* column = a + static_cast<long>(ld) * j;
    const Lane* lower = reinterpret_cast<const Lane*>(column);
    const double scale = 1.0 / column[j];
    for (int c = 0; c <= j; ++c) {
      double* x = inverse + static_cast<long>(ld) * c;
      const double value = x[j] * scale;
      Lane* to = reinterpret_cast<Lane*>(x);
      // The first lane holds rows up to j too: the zeros above the diagonal keep them, row j is set afterwards.
      for (int r = j / kSize; r < lanes; ++r) to[r] -= lower[r] * value;
      x[j] = value;
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
  TARGET void multiply_add(double* c, int ldc, const double* a, int lda, const double* b, int ldb, int rows,           \
                           int columns, int depth, double sign) {                                                      \
    banded::multiply_add<LANE, TALL, WIDTH, false>(c, ldc, a, lda, b, ldb, rows, columns, depth, sign);                \
  }                                                                                                                    \
  TARGET void multiply_add_lower(double* c, int ldc, const double* a, int lda, const double* b, int ldb, int rows,     \
                                 int depth) {                                                                          \
    banded::multiply_add<LANE, TALL, WIDTH, true>(c, ldc, a, lda, b, ldb, rows, rows, depth, 1.0);                     \
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
  const DenseOperations all = {#NAME,     multiply_add,    multiply_add_lower,                                         \
                               factorise, multiply_vector, multiply_transposed};                                       \
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
