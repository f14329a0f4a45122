// How far an interior point's iterate is from optimal, feasible or anything better.
#include <algorithm>
#include <cmath>

#include "interior_point.hpp"

namespace banded {
namespace {

constexpr double kMultiplierScale = 100.0;  // s_max of (6)
// A violation whose projected gradient is below this share of it counts as stationary.
constexpr double kStationaryViolation = 1e-4;

double largest(const Vector& v) {
  double worst = 0.0;
  for (double entry : v) worst = std::fabs(entry) > worst || std::isnan(entry) ? std::fabs(entry) : worst;
  return worst;
}

}  // namespace

// E_mu of (5) for the scaled problem.
double InteriorPoint::barrier_error(double mu) const {
  double dual = 0.0, multipliers = x_.multiplier_sum() + s_.multiplier_sum(), all = multipliers;
  for (int i = 0; i < x_.size(); ++i)
    if (!x_.is_held(i)) dual = std::max(dual, std::fabs(lagrangian_[i] - x_.z_low[i] + x_.z_high[i]));
  for (int i = 0; i < s_.size(); ++i) {
    all += std::fabs(lambda_[i]);
    if (!s_.is_held(i)) dual = std::max(dual, std::fabs(-lambda_[i] - s_.z_low[i] + s_.z_high[i]));
  }
  const int sides = std::max(1, x_.sides() + s_.sides());
  const double s_d = std::max(kMultiplierScale, all / (s_.size() + sides)) / kMultiplierScale;
  const double s_c = std::max(kMultiplierScale, multipliers / sides) / kMultiplierScale;
  const double products = std::max(x_.complementarity(mu), s_.complementarity(mu));
  return std::max({dual / s_d, largest(residual_), products / s_c});
}

// How many times the tolerance slope and complementarity may reach.
double InteriorPoint::leniency() const {
  const double share = options_.rough * std::fabs(now_.f) / options_.objective_scaling;
  return std::max(1.0, share / options_.tolerance);
}

// E_0 of (5) for the problem as it was given: unscaled, and without slacks.
double InteriorPoint::original_error() const {
  const double scale = options_.objective_scaling;
  double dual = 0.0, violation = 0.0, products = 0.0, all = 0.0, bounded = 0.0;
  int count = 0, sided = 0;
  const auto add = [&](const Bounded& side, int i, double multiplier, double value) {
    const double size = std::fabs(multiplier);
    all += size;
    ++count;
    if (side.is_held(i)) return;
    bounded += size;
    ++sided;
    const double distance = multiplier < 0.0 ? value - side.lower[i] : side.upper[i] - value;
    products = std::max(products, size * (std::isfinite(distance) ? std::fabs(distance) : 1.0));
  };
  for (int i = 0; i < x_.size(); ++i) {
    if (x_.is_held(i)) continue;
    const double multiplier = (x_.z_high[i] - x_.z_low[i]) / scale;
    const double slope = std::fabs(lagrangian_[i] / scale + multiplier);
    dual = slope > dual || std::isnan(slope) ? slope : dual;
    add(x_, i, multiplier, now_.x[i]);
  }
  for (int i = 0; i < s_.size(); ++i) {
    add(s_, i, lambda_[i] / scale, now_.g[i]);
    const double outside = std::max(s_.lower[i] - now_.g[i], now_.g[i] - s_.upper[i]);
    violation = outside > violation || std::isnan(outside) ? outside : violation;
  }
  const double s_d = std::max(kMultiplierScale, all / std::max(1, count)) / kMultiplierScale;
  const double s_c = std::max(kMultiplierScale, bounded / std::max(1, sided)) / kMultiplierScale;
  const double optimality = std::max(dual / s_d, products / s_c) / leniency();
  return std::isfinite(dual + violation) ? std::max(optimality, violation) : NAN;
}

Merit InteriorPoint::merit(const Point& point) const {
  double theta = 0.0;
  for (int i = 0; i < s_.size(); ++i) theta += std::fabs(point.g[i] - point.s[i]);
  return {theta, point.f - mu_ * (x_.logarithms(point.x.data()) + s_.logarithms(point.s.data()))};
}

// Whether the violation is stationary: its projected gradient is small beside it.
bool InteriorPoint::stuck() const {
  Vector violation(s_.size()), gradient(x_.size(), 0.0);
  double norm = 0.0;
  for (int i = 0; i < s_.size(); ++i) {
    violation[i] = std::max(0.0, now_.g[i] - s_.upper[i]) - std::max(0.0, s_.lower[i] - now_.g[i]);
    norm = std::max(norm, std::fabs(violation[i]));
  }
  if (norm <= options_.tolerance) return false;
  nlp_.multiply_jacobian_transposed(violation.data(), gradient.data());
  double worst = 0.0;
  for (int i = 0; i < x_.size(); ++i) {
    if (x_.is_held(i)) continue;
    const double moved = std::min(std::max(now_.x[i] - gradient[i], x_.lower[i]), x_.upper[i]) - now_.x[i];
    worst = std::max(worst, std::fabs(moved));
  }
  return worst <= kStationaryViolation * norm;
}

}  // namespace banded
