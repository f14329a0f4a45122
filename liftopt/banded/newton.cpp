#include "newton.hpp"

#include <algorithm>
#include <cmath>

#include "clock.hpp"

namespace banded {
namespace {

// The penalty of a row is this, divided by its largest entry to the power of 3/2. In a lift closure has entries of 1
// on every mesh, but acts on positions, which yield less the finer it is; balance acts on accelerations, with entries
// that grow with N^2. With 1e6 for all rows refinement hardly converged at N = 160. Of the powers tried (0, 1, 3/2, 2)
// with 1e6 to 1e10 this takes the fewest refinements on 17 lifts at N = 10 to 160: at 160 14 a solve instead of 79.
// A row with no entry to speak of where the solve starts counts as one of this size.
constexpr double kPenalty = 3e8, kSmallestRow = 0.1;
// delta_w of Waechter and Biegler (2006), section 3.1 and table 3. It decays faster than theirs: an attempt that fails
// costs a fraction of an iteration, and steps that are held back need more iterations.
constexpr double kFirstDelta = 1e-4, kLeastDelta = 1e-20, kLargestDelta = 1e20;
constexpr double kFirstGrowth = 100.0, kGrowth = 8.0, kDecay = 0.1;
constexpr double kWorthSkipping = 0.1;
// A few times less or more does as well (docs/tuning.md).
constexpr double kMostDelta = 10.0;
constexpr int kMostRefinements = 5;
// Residuals of the linear system at which refinement stops, relative to the right-hand side. Smaller ones take more time
// and no fewer iterations (docs/tuning.md).
constexpr double kDualResidual = 1e-6, kPrimalResidual = 1e-2;

double largest(const Vector& v) {
  double worst = 0.0;
  for (double entry : v) worst = std::max(worst, std::fabs(entry));
  return worst;
}

}  // namespace

Newton::Newton(Nlp& nlp, std::vector<std::vector<int>> blocks)
    : dx(nlp.unknowns()), j_dx(nlp.rows()), dlambda(nlp.rows()), nlp_(nlp),
      condensed_(nlp, blocks), row_weight_(nlp.rows()),
      sigma_rows_(nlp.rows()), sigma_x_(nlp.unknowns()), step_(nlp.unknowns()), rows_(nlp.rows()),
      residual_(nlp.unknowns()), row_residual_(nlp.rows()) {}

void Newton::begin(const std::vector<char>& equality, const std::vector<int>& held) {
  equality_ = equality;
  held_ = held;
  condensed_.hold(held);
  delta_ = last_delta_ = exact_delta_ = 0.0;
  penalty_.clear();
  factorisations = refinements = 0;
  assembly_seconds = factorisation_seconds = 0.0;
}

bool Newton::try_delta() {
  const double began = seconds_now();
  const bool done = condensed_.factorise(delta_);
  factorisation_seconds += seconds_now() - began;
  ++factorisations;
  return done;
}

void Newton::assemble() {
  const double began = seconds_now();
  condensed_.assemble(row_weight_.data(), sigma_x_.data());
  assembly_seconds += seconds_now() - began;
}

void Newton::find_penalties() {
  penalty_.assign(nlp_.rows(), 0.0);
  nlp_.row_sizes(penalty_.data());
  for (double& entry : penalty_) entry = kPenalty / std::pow(std::max(entry, kSmallestRow), 1.5);
}

bool Newton::factorise(const double* sigma_x, const double* sigma_s, double least_delta) {
  if (penalty_.empty()) find_penalties();
  for (int r = 0; r < nlp_.rows(); ++r) {
    sigma_rows_[r] = nlp_.squares[r] + (equality_[r] ? 0.0 : sigma_s[r]);
    row_weight_[r] = sigma_rows_[r] + (equality_[r] ? penalty_[r] : 0.0);
  }
  std::copy_n(sigma_x, nlp_.unknowns(), sigma_x_.begin());
  assemble();
  // Where the last matrix needed a large delta, none at all would hardly do now.
  const bool likely = exact_delta_ > 0.0 && kDecay * exact_delta_ > kWorthSkipping && least_delta == 0.0;
  delta_ = likely ? kDecay * exact_delta_ : least_delta;
  if (try_delta()) {
    if (delta_ > 0.0) last_delta_ = delta_;
    exact_delta_ = delta_;
    return true;
  }
  const bool first = last_delta_ == 0.0;
  if (likely) delta_ *= kGrowth;
  else delta_ = std::max(first ? kFirstDelta : std::max(kLeastDelta, kDecay * last_delta_), 10.0 * least_delta);
  bool convex = false;
  for (;; delta_ *= first ? kFirstGrowth : kGrowth) {
    if (!(delta_ < kLargestDelta)) return false;
    if (!convex && delta_ > kMostDelta && nlp_.drop_curvature()) {
      convex = true;
      exact_delta_ = last_delta_ = delta_;
      assemble();
      delta_ = std::max(kFirstDelta, least_delta);
    }
    if (try_delta()) break;
  }
  if (!convex) exact_delta_ = last_delta_ = delta_;
  return true;
}

// Add to the step the solution for the residuals r and c.
void Newton::correct(const double* r, const double* c) {
  for (int i = 0; i < nlp_.rows(); ++i) rows_[i] = equality_[i] ? -penalty_[i] * c[i] : 0.0;
  std::copy_n(r, nlp_.unknowns(), step_.begin());
  nlp_.multiply_jacobian_transposed(rows_.data(), step_.data());
  for (int i : held_) step_[i] = 0.0;
  condensed_.solve(step_.data());
  for (int i : held_) step_[i] = 0.0;
  std::fill(rows_.begin(), rows_.end(), 0.0);
  nlp_.multiply_jacobian(step_.data(), rows_.data());
  for (int i = 0; i < nlp_.unknowns(); ++i) dx[i] += step_[i];
  for (int i = 0; i < nlp_.rows(); ++i) {
    j_dx[i] += rows_[i];
    if (equality_[i]) dlambda[i] += penalty_[i] * (rows_[i] + c[i]);
  }
}

void Newton::solve(const double* r, const double* c) {
  std::fill(dx.begin(), dx.end(), 0.0);
  std::fill(j_dx.begin(), j_dx.end(), 0.0);
  std::fill(dlambda.begin(), dlambda.end(), 0.0);
  double right = 1.0, primal_right = 0.0;
  for (int i = 0; i < nlp_.unknowns(); ++i) right = std::max(right, std::fabs(r[i]));
  for (int i = 0; i < nlp_.rows(); ++i)
    if (equality_[i]) primal_right = std::max(primal_right, std::fabs(c[i]));
  correct(r, c);
  double before = INFINITY;
  for (int k = 0; k < kMostRefinements; ++k) {
    std::fill(residual_.begin(), residual_.end(), 0.0);
    nlp_.multiply_hessian(dx.data(), residual_.data());
    for (int i = 0; i < nlp_.rows(); ++i) {
      row_residual_[i] = equality_[i] ? c[i] + j_dx[i] : 0.0;
      rows_[i] = sigma_rows_[i] * j_dx[i] + (equality_[i] ? dlambda[i] : 0.0);
    }
    nlp_.multiply_jacobian_transposed(rows_.data(), residual_.data());
    for (int i = 0; i < nlp_.unknowns(); ++i) residual_[i] = r[i] - residual_[i] - (sigma_x_[i] + delta_) * dx[i];
    for (int i : held_) residual_[i] = 0.0;
    const double dual = largest(residual_) / right;
    const double primal = largest(row_residual_) / std::max(primal_right, 1e-8);
    const double worst = std::max(dual / kDualResidual, primal / kPrimalResidual);
    if (worst < 1.0 || !(worst < 0.9 * before)) return;
    before = worst;
    ++refinements;
    correct(residual_.data(), row_residual_.data());
  }
}

}  // namespace banded
