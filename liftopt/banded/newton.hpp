// The Newton step of the barrier problem: factorisation with the right inertia, solution and its refinement.
//
// With slacks s of the inequality rows eliminated, the step solves
//
//     [ H + J^T diag(q + sigma_s) J + diag(sigma_x) + delta   J_E^T ] [ dx        ]   [ r  ]
//     [ J_E                                                     0   ] [ dlambda_E ] = [ -c ].
//
// A penalty J_E^T diag(gamma) J_E is added to the upper left block, which changes no solution. For large gamma it
// is positive definite exactly where the Hessian is on the null space of J_E (Debreu's lemma), which is the inertia
// that a descent direction needs, so one Cholesky factorisation finds out; where it fails, delta grows as in Waechter
// and Biegler (2006), section 3.1. Then dlambda_E = gamma (J_E dx + c) with a few steps of refinement on both
// residuals: the method of multipliers (Hestenes 1969, Powell 1969) on a linear system. Dependent rows do no harm.
//
// Far from a solution delta would have to be so large that steps creep along the gradient. From `kMostDelta` on the
// curvature of outputs and rows is left out instead, where the problem knows it apart: what remains is Gauss's and
// Newton's matrix, which is positive definite with hardly any delta. With it more starts converge, in fewer iterations
// (docs/tuning.md).
#pragma once

#include <vector>

#include "condensed.hpp"
#include "nlp.hpp"

namespace banded {

class Newton {
 public:
  Newton(Nlp& nlp, std::vector<std::vector<int>> blocks);

  // Say which rows are equalities and which unknowns are held; forgets the last delta.
  void begin(const std::vector<char>& equality, const std::vector<int>& held);

  // Factorise for the nlp's derivatives; false where no delta up to the largest does.
  bool factorise(const double* sigma_x, const double* sigma_s, double least_delta = 0.0);

  // Solve for right-hand sides r (unknowns) and c (rows; only those of equalities are used). Sets dx and dlambda; the
  // latter only in the rows of equalities; and J dx.
  void solve(const double* r, const double* c);

  double delta() const { return delta_; }

  Vector dx, j_dx, dlambda;
  int factorisations = 0, refinements = 0;
  double assembly_seconds = 0.0, factorisation_seconds = 0.0;
  double multiplications() const { return condensed_.multiplications(); }

 private:
  void correct(const double* r, const double* c);
  bool try_delta();
  void assemble();
  void find_penalties();

  Nlp& nlp_;
  Condensed condensed_;
  std::vector<char> equality_;
  std::vector<int> held_;
  double delta_ = 0.0, last_delta_ = 0.0;  // now, and the last one that was needed
  double exact_delta_ = 0.0;               // of the last matrix with all of its curvature
  Vector penalty_;                // of each row, by its size where the solve starts
  Vector row_weight_;             // of the matrix that was factorised
  Vector sigma_rows_, sigma_x_;   // of the matrix without the penalty
  Vector step_, rows_, residual_, row_residual_;
};

}  // namespace banded
