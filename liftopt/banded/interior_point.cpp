#include "interior_point.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "clock.hpp"

namespace banded {
namespace {

// Table of constants in section 3 of the paper.
constexpr double kBarrierError = 10.0, kLinearDecrease = 0.2, kSuperlinear = 1.5, kLeastTau = 0.99;
// The last barrier parameter, as a share of the complementarity that the tolerance allows.
constexpr double kLeastMu = 0.4;
// The share of the violation that a whole Newton step of a warm start may leave.
constexpr double kPredicted = 0.5;
constexpr int kMostHalvings = 24, kMostCorrections = 2, kMostShifts = 6;
constexpr double kFirstShift = 1e-2, kShiftGrowth = 10.0;
// What is expected of a solve that has an incumbent: that the objective falls once more by what it fell in so many
// iterations, and that this share of the unknowns is at a bound. A shorter window loses optima (docs/tuning.md).
constexpr std::size_t kWindow = 5;
constexpr double kAtBounds = 0.2;

}  // namespace

InteriorPoint::InteriorPoint(Nlp& nlp, std::vector<std::vector<int>> blocks) : nlp_(nlp), newton_(nlp, std::move(blocks)) {
  const int n = nlp.unknowns(), m = nlp.rows();
  for (Vector* v : {&lagrangian_, &sigma_x_, &right_}) v->resize(n);
  for (Vector* v : {&lambda_, &residual_, &sigma_s_, &centre_, &ds_, &dlambda_, &rows_}) v->resize(m);
  for (Point* point : {&now_, &trial_}) {
    point->x.resize(n);
    point->s.resize(m);
    point->g.resize(m);
  }
}

Result InteriorPoint::solve(const double* lower_x, const double* upper_x, const double* lower_g, const double* upper_g,
                            const double* x0, const double* warm_x, const double* warm_g, const Options& options) {
  const double began = seconds_now();
  options_ = options;
  evaluations_ = predictions_ = 0;
  evaluation_seconds_ = 0.0;
  past_.clear();
  x_ = Bounded(lower_x, upper_x, nlp_.unknowns());
  s_ = Bounded(lower_g, upper_g, nlp_.rows());
  equality_.assign(nlp_.rows(), 0);
  for (int i : s_.held()) equality_[i] = 1;
  newton_.begin(equality_, x_.held());
  start(x0, warm_x, warm_g);

  Result result;
  result.iterations = predictions_;
  for (;; ++result.iterations) {
    differentiate();
    result.error = original_error();
    if (options.verbose)
      std::printf("%3d f %.8g theta %.1e error %.1e mu %.1e delta %.1e length %.1e factorisations %d refinements %d\n",
                  result.iterations, now_.f, merit(now_).theta, result.error, mu_, newton_.delta(), length_,
                  newton_.factorisations, newton_.refinements);
    if (!std::isfinite(result.error)) result.status = Status::invalid;
    else if (result.error <= options.tolerance) result.status = Status::solved;
    else if (result.iterations >= options.max_iterations) result.status = Status::iterations;
    else if (seconds_now() - began > options.seconds) result.status = Status::time;
    else if (beaten()) result.status = Status::beaten;
    else {
      const double least_mu = kLeastMu * leniency() * options.tolerance * options.objective_scaling;
      while (mu_ > least_mu && barrier_error(mu_) <= kBarrierError * mu_) {
        mu_ = std::max(least_mu, std::min(kLinearDecrease * mu_, std::pow(mu_, kSuperlinear)));
        filter_.clear();
      }
      tau_ = std::max(kLeastTau, 1.0 - mu_);
      if (step()) continue;
      result.status = stuck() ? Status::infeasible : Status::line_search;
    }
    break;
  }
  finish(result);
  result.seconds = seconds_now() - began;
  return result;
}

void InteriorPoint::start(const double* x0, const double* warm_x, const double* warm_g) {
  const double scale = options_.objective_scaling;
  mu_ = options_.mu;
  std::copy_n(x0, x_.size(), x_.value.begin());
  settle();
  if (warm_x != nullptr && warm_g != nullptr) {
    Vector scaled(x_.size());
    for (int i = 0; i < x_.size(); ++i) scaled[i] = scale * warm_x[i];
    x_.warm(scaled.data(), mu_);
    for (int i = 0; i < s_.size(); ++i) lambda_[i] = scale * warm_g[i];
    s_.warm(lambda_.data(), mu_);
  } else {
    x_.centre(mu_);
    s_.centre(mu_);
    for (int i = 0; i < s_.size(); ++i) lambda_[i] = s_.z_high[i] - s_.z_low[i];
  }
  while (predictions_ < options_.predictions && predict()) ++predictions_;
  filter_ = Filter(merit(now_).theta);
}

// Evaluate at the unknowns, pushed inside their bounds, and let the slacks follow the rows, inside theirs.
void InteriorPoint::settle() {
  x_.push_inside(options_.push);
  now_.x = x_.value;
  evaluate(now_);
  s_.value = now_.g;
  s_.push_inside(options_.push);
  now_.s = s_.value;
}

// Take the whole Newton step and move what left the bounds back inside: near a solution, bounds that become active
// would shorten step after step, while the step as a whole tells which do. It is undone where it does not take the
// violation down.
bool InteriorPoint::predict() {
  const double theta = merit(now_).theta;
  differentiate();
  find_weights();
  if (!newton_.factorise(sigma_x_.data(), sigma_s_.data())) return false;
  solve_newton(residual_);
  x_.find_multiplier_steps(mu_, newton_.dx.data());
  s_.find_multiplier_steps(mu_, ds_.data());
  const Point point = now_;
  const Bounded x = x_, s = s_;
  for (int i = 0; i < x_.size(); ++i) x_.value[i] += newton_.dx[i];
  settle();
  if (!(merit(now_).theta <= kPredicted * theta)) {
    now_ = point;
    x_ = x;
    s_ = s;
    return false;
  }
  for (int i = 0; i < s_.size(); ++i) lambda_[i] += dlambda_[i];
  x_.predict_multipliers(mu_);
  s_.predict_multipliers(mu_);
  return true;
}

// Whether nothing lower than the incumbent is in sight, from the second barrier problem on: before, the objective tells
// little. Each active bound holds the minimum of a barrier problem some mu above that of the problem.
bool InteriorPoint::beaten() {
  if (!std::isfinite(options_.incumbent)) return false;
  past_.push_back(now_.f);
  if (past_.size() <= kWindow) return false;
  const double fall = std::fabs(past_.front() - now_.f);
  past_.pop_front();
  const double lowest = now_.f - fall - kAtBounds * x_.size() * mu_;
  return mu_ < options_.mu && lowest > options_.objective_scaling * options_.incumbent;
}

double InteriorPoint::evaluate(Point& point) {
  const double began = seconds_now();
  point.f = options_.objective_scaling * nlp_.evaluate(point.x.data(), point.g.data());
  evaluation_seconds_ += seconds_now() - began;
  ++evaluations_;
  return point.f;
}

void InteriorPoint::differentiate() {
  const double began = seconds_now();
  nlp_.differentiate(now_.x.data(), lambda_.data(), options_.objective_scaling);
  evaluation_seconds_ += seconds_now() - began;
  lagrangian_ = nlp_.gradient;
  nlp_.multiply_jacobian_transposed(lambda_.data(), lagrangian_.data());
  residuals();
}

void InteriorPoint::residuals() {
  for (int i = 0; i < s_.size(); ++i) residual_[i] = now_.g[i] - now_.s[i];
}

// Solve for dx, ds and dlambda, where `residual` is g - s or what a second-order correction puts in its place.
void InteriorPoint::solve_newton(const Vector& residual) {
  std::fill(right_.begin(), right_.end(), 0.0);
  for (int i = 0; i < s_.size(); ++i) rows_[i] = equality_[i] ? 0.0 : sigma_s_[i] * residual[i] + centre_[i];
  nlp_.multiply_jacobian_transposed(rows_.data(), right_.data());
  for (int i = 0; i < x_.size(); ++i) right_[i] += lagrangian_[i];
  x_.add_barrier_gradient(mu_, right_.data());
  for (double& entry : right_) entry = -entry;
  for (int i : x_.held()) right_[i] = 0.0;
  newton_.solve(right_.data(), residual.data());
  for (int i = 0; i < s_.size(); ++i) {
    ds_[i] = equality_[i] ? 0.0 : newton_.j_dx[i] + residual[i];
    dlambda_[i] = equality_[i] ? newton_.dlambda[i] : sigma_s_[i] * ds_[i] + centre_[i];
  }
}

void InteriorPoint::find_weights() {
  x_.sigma(sigma_x_.data());
  s_.sigma(sigma_s_.data());
  for (int i = 0; i < s_.size(); ++i) centre_[i] = -lambda_[i];
  s_.add_barrier_gradient(mu_, centre_.data());
}

bool InteriorPoint::step() {
  find_weights();
  double shift = 0.0;
  for (int attempt = 0; attempt < kMostShifts; ++attempt) {
    if (!newton_.factorise(sigma_x_.data(), sigma_s_.data(), shift)) return false;
    solve_newton(residual_);
    if (search()) return true;
    shift = std::max(kFirstShift, kShiftGrowth * newton_.delta());
    if (attempt == 2) filter_.clear();
  }
  return false;
}

// Backtracking line search along the Newton step (steps ).
bool InteriorPoint::search() {
  x_.find_multiplier_steps(mu_, newton_.dx.data());
  s_.find_multiplier_steps(mu_, ds_.data());
  const double multiplier_length = std::min(x_.longest_multiplier_step(tau_), s_.longest_multiplier_step(tau_));
  from_ = merit(now_);
  // The slope of phi along the step: its gradient by x is that of the Lagrangian less J^T lambda.
  std::copy(lagrangian_.begin(), lagrangian_.end(), right_.begin());
  x_.add_barrier_gradient(mu_, right_.data());
  slope_ = 0.0;
  for (int i = 0; i < x_.size(); ++i) slope_ += right_[i] * newton_.dx[i];
  for (int i = 0; i < s_.size(); ++i) slope_ += -lambda_[i] * newton_.j_dx[i] + (centre_[i] + lambda_[i]) * ds_[i];
  length_ = std::min(x_.longest_step(tau_, newton_.dx.data()), s_.longest_step(tau_, ds_.data()));
  for (int halving = 0; halving < kMostHalvings; ++halving, length_ *= 0.5) {
    if (try_point(length_, newton_.dx, ds_, length_) || (halving == 0 && correct(length_))) {
      move(multiplier_length);
      return true;
    }
  }
  return false;
}

bool InteriorPoint::try_point(double length, const Vector& dx, const Vector& ds, double armijo_length) {
  for (int i = 0; i < x_.size(); ++i) trial_.x[i] = now_.x[i] + length * dx[i];
  for (int i = 0; i < s_.size(); ++i) trial_.s[i] = now_.s[i] + length * ds[i];
  evaluate(trial_);
  return filter_.accepts(from_, merit(trial_), slope_, armijo_length);
}

// Second-order corrections (section 2.4): the same matrix, the residual of the trial point added. The multipliers
// keep the step of the uncorrected direction.
bool InteriorPoint::correct(double length) {
  double theta = merit(trial_).theta;
  if (!(theta >= from_.theta)) return false;
  const Vector dx = newton_.dx, ds = ds_, dlambda = dlambda_, j_dx = newton_.j_dx;
  Vector residual = residual_;
  double factor = length;
  bool accepted = false;
  for (int k = 0; k < kMostCorrections && !accepted; ++k) {
    for (int i = 0; i < s_.size(); ++i) residual[i] = factor * residual[i] + trial_.g[i] - trial_.s[i];
    solve_newton(residual);
    factor = std::min(x_.longest_step(tau_, newton_.dx.data()), s_.longest_step(tau_, ds_.data()));
    accepted = try_point(factor, newton_.dx, ds_, length);
    const double corrected = merit(trial_).theta;
    if (!(corrected <= 0.99 * theta)) break;
    theta = corrected;
  }
  newton_.dx = dx;
  newton_.j_dx = j_dx;
  ds_ = ds;
  dlambda_ = dlambda;
  return accepted;
}

void InteriorPoint::move(double multiplier_length) {
  std::swap(now_, trial_);
  x_.value = now_.x;
  s_.value = now_.s;
  for (int i = 0; i < s_.size(); ++i) lambda_[i] += length_ * dlambda_[i];
  x_.move_multipliers(multiplier_length, mu_);
  s_.move_multipliers(multiplier_length, mu_);
}

void InteriorPoint::finish(Result& result) {
  const double scale = options_.objective_scaling;
  result.x = now_.x;
  result.objective = now_.f / scale;
  result.multipliers.resize(s_.size());
  for (int i = 0; i < s_.size(); ++i) result.multipliers[i] = lambda_[i] / scale;
  result.bound_multipliers.resize(x_.size());
  for (int i = 0; i < x_.size(); ++i)
    result.bound_multipliers[i] = (x_.is_held(i) ? -lagrangian_[i] : x_.z_high[i] - x_.z_low[i]) / scale;
  result.factorisations = newton_.factorisations;
  result.refinements = newton_.refinements;
  result.evaluations = evaluations_;
  result.evaluation_seconds = evaluation_seconds_;
  result.assembly_seconds = newton_.assembly_seconds;
  result.factorisation_seconds = newton_.factorisation_seconds;
}

}  // namespace banded
