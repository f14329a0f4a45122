// The condensed matrix K = H + J^T diag(d) J + diag(s) of the Newton step and its block Cholesky factors.
#pragma once

#include <memory>
#include <vector>

#include "block_cholesky.hpp"
#include "nlp.hpp"

namespace banded {

class Condensed {
 public:
  // `blocks`: of unknowns, in the order of elimination.
  Condensed(const Nlp& nlp, const std::vector<std::vector<int>>& blocks);

  // Unknowns whose row and column are those of the identity from now on.
  void hold(const std::vector<int>& held);

  // Set K for the derivatives the problem has now, weights d (rows) and s (unknowns).
  void assemble(const double* d, const double* s);

  // Factorise K + delta I; false where it is not positive definite. K stays as it was assembled.
  bool factorise(double delta) { return cholesky_.factorise(matrix_.data(), delta); }
  void solve(double* x) { cholesky_.solve(x); }
  double multiplications() const { return cholesky_.multiplications(); }

 private:
  BlockCholesky cholesky_;
  std::unique_ptr<Assembly> assembly_;
  Aligned matrix_;                   // K, stored as the factors are
  std::vector<int> diagonal_;        // where each unknown's diagonal entry is
  std::vector<int> cleared_, ones_;  // entries of held unknowns, and of those the diagonal ones
};

}  // namespace banded
