// A problem whose derivatives are sparse matrices of no further structure.
#pragma once

#include "nlp.hpp"
#include "sparse.hpp"

namespace banded {

class SparseNlp : public Nlp {
 public:
  SparseNlp(Sparse jacobian_pattern, Sparse hessian_pattern);

  void multiply_jacobian(const double* x, double* y) override { jacobian.multiply(x, y); }
  void multiply_jacobian_transposed(const double* x, double* y) override { jacobian.multiply_transposed(x, y); }
  void multiply_hessian(const double* x, double* y) override { hessian.multiply_symmetric(x, y); }
  void row_sizes(double* sizes) const override { jacobian.row_sizes(sizes); }
  std::vector<std::pair<int, int>> coupled(const std::vector<std::vector<int>>& blocks) const override;
  std::unique_ptr<Assembly> assembly(const BlockCholesky& storage) const override;

  Sparse jacobian;
  // Entries on and above the diagonal.
  Sparse hessian;
};

}  // namespace banded
