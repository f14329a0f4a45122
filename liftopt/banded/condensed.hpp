// The condensed matrix K = H + J^T diag(d) J + diag(s) of the Newton step, assembled into a block Cholesky.
#pragma once

#include <vector>

#include "block_cholesky.hpp"
#include "sparse.hpp"

namespace banded {

class Condensed {
 public:
  // The patterns of H (upper triangle) and J, and the blocks of unknowns in the order of elimination.
  Condensed(const Sparse& hessian, const Sparse& jacobian, std::vector<std::vector<int>> blocks);

  // Set K for the values of H and J, weights d (rows) and s (unknowns); unknowns held fixed get the identity.
  void assemble(const Sparse& hessian, const Sparse& jacobian, const double* d, const double* s,
                const std::vector<int>& held);

  bool factorise() { return cholesky_.factorise(); }
  void solve(double* x) { cholesky_.solve(x); }
  double multiplications() const { return cholesky_.multiplications(); }

 private:
  // Consecutive rows of J that share most of their columns: their dense product is added at once.
  struct Element {
    int first_row, last_row, columns;
    std::vector<int> place;   // of each nonzero of the rows in the dense rows
    std::vector<int> target;  // of each entry of the lower triangle, column by column, in the Cholesky's values
  };
  void add_dense(const Element& element, const Sparse& jacobian, const double* d);
  void add_sparse(const Element& element, const Sparse& jacobian, const double* d);

  BlockCholesky cholesky_;
  std::vector<int> hessian_target_, diagonal_target_;
  std::vector<Element> elements_;
  Aligned dense_, weighted_, product_;
};

}  // namespace banded
