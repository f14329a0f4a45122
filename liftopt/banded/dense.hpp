// Operations on small dense blocks, in the widest instructions the processor has.
//
// A block is column-major; its rows are padded with zeros to a multiple of kLanes, its start is aligned to a lane.
#pragma once

#include <string>
#include <vector>

namespace banded {

constexpr int kLanes = 8;

inline int padded(int n) { return (n + kLanes - 1) / kLanes * kLanes; }

struct DenseOperations {
  const char* name;

  // C (rows x padded n) = A L^T, A (rows x n), L (n x n) lower triangular with zeros above; C may be A.
  void (*multiply_triangular)(double* c, int ldc, const double* a, int lda, const double* l, int ldl, int rows,
                              int n);

  // C (rows x columns) = D - A B^T, A (rows x depth), B (columns x depth); rows and columns padded, depth not. D has C's
  // columns as far apart, and may be C.
  void (*subtract_product)(double* c, int ldc, const double* d, const double* a, int lda, const double* b, int ldb,
                           int rows, int columns, int depth);

  // The lower triangle of C (rows x rows) -= A A^T; above it, anything.
  void (*subtract_square)(double* c, int ldc, const double* a, int lda, int rows, int depth);

  // A = L L^T in place on the lower triangle of A (n x n, columns ld apart), and L^-1; false where A is not positive
  // definite by more than rounding: a pivot must exceed `threshold`.
  bool (*factorise)(double* a, int ld, int n, double* inverse, double threshold);

  // y (rows) += sign A x, x (columns).
  void (*multiply_vector)(double* y, const double* a, int lda, int rows, int columns, const double* x, double sign);

  // y (columns) += sign A^T x, x (rows).
  void (*multiply_transposed)(double* y, const double* a, int lda, int rows, int columns, const double* x,
                              double sign);
};

// The variants that this processor can run, the fastest first.
std::vector<const DenseOperations*> runnable_operations();

// The fastest of them, or the one chosen by name; solvers that exist keep theirs.
const DenseOperations& dense_operations();
bool choose_operations(const std::string& name);

}  // namespace banded
