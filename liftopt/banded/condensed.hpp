// The condensed matrix K = H + J^T diag(d) J + diag(s) of the Newton step, assembled into a block Cholesky.
#pragma once

#include <vector>

#include "block_cholesky.hpp"
#include "sparse.hpp"

namespace banded {

// Neighbours in one array that go to neighbours in another.
struct Run {
  int from, to, length;
};

class Condensed {
 public:
  // The patterns of H (upper triangle) and J, and the blocks of unknowns in the order of elimination.
  Condensed(const Sparse& hessian, const Sparse& jacobian, std::vector<std::vector<int>> blocks);

  // Set K for the values of H and J, weights d (rows) and s (unknowns); unknowns held fixed get the identity.
  void assemble(const Sparse& hessian, const Sparse& jacobian, const double* d, const double* s,
                const std::vector<int>& held);

  // Factorise K + delta I; false where it is not positive definite. K stays as it was assembled.
  bool factorise(double delta);
  void solve(double* x) { cholesky_.solve(x); }
  double multiplications() const { return cholesky_.multiplications(); }

 private:
  // Consecutive rows of J that share most of their columns: their dense product is added at once.
  struct Element {
    int first_row, last_row, columns;
    std::vector<int> place;  // of each nonzero of the rows in the dense rows
    std::vector<Run> runs;   // from the product's lower triangle, column by column, to K
  };
  void fill_rows(const Element& element, const Sparse& jacobian, const double* d);
  void multiply_small(const Element& element);
  static void add(const std::vector<Run>& runs, const double* from, double* to);

  BlockCholesky cholesky_;
  Aligned matrix_;  // K, in the order of the Cholesky's values
  std::vector<Run> hessian_runs_;
  std::vector<int> diagonal_;  // where each unknown's diagonal entry is
  std::vector<Element> elements_;
  Aligned dense_, weighted_, product_;
};

}  // namespace banded
