#include "bounded.hpp"

#include <algorithm>
#include <cmath>

namespace banded {
namespace {

// kappa_Sigma of (16).
constexpr double kFarthestFromCentre = 1e10;
// Multipliers of a warm start stay within this factor of the centre.
constexpr double kWarmRoom = 1e2;

double near_centre(double z, double distance, double mu) {
  return std::min(std::max(z, mu / distance / kWarmRoom), mu / distance * kWarmRoom);
}

}  // namespace

Bounded::Bounded(const double* lower_bound, const double* upper_bound, int n)
    : lower(lower_bound, lower_bound + n), upper(upper_bound, upper_bound + n), value(n, 0.0), z_low(n, 0.0),
      z_high(n, 0.0), held_mask_(n, 0), dz_low_(n, 0.0), dz_high_(n, 0.0) {
  for (int i = 0; i < n; ++i) {
    if (lower[i] >= upper[i]) {
      held_.push_back(i);
      held_mask_[i] = 1;
      continue;
    }
    if (std::isfinite(lower[i])) low_.push_back(i);
    if (std::isfinite(upper[i])) high_.push_back(i);
  }
  sides_ = static_cast<int>(low_.size() + high_.size());
}

void Bounded::push_inside(double push) {
  for (int i = 0; i < size(); ++i) {
    if (is_held(i)) {
      value[i] = lower[i];
      continue;
    }
    const double room = push * (upper[i] - lower[i]);
    const double from = lower[i] + std::min(push * std::max(1.0, std::fabs(lower[i])), room);
    const double to = upper[i] - std::min(push * std::max(1.0, std::fabs(upper[i])), room);
    if (std::isfinite(lower[i])) value[i] = std::max(value[i], from);
    if (std::isfinite(upper[i])) value[i] = std::min(value[i], to);
  }
}

void Bounded::centre(double mu) {
  for (int i : low_) z_low[i] = mu / (value[i] - lower[i]);
  for (int i : high_) z_high[i] = mu / (upper[i] - value[i]);
}

void Bounded::warm(const double* multiplier, double mu) {
  for (int i : low_) z_low[i] = near_centre(-multiplier[i], value[i] - lower[i], mu);
  for (int i : high_) z_high[i] = near_centre(multiplier[i], upper[i] - value[i], mu);
}

void Bounded::predict_multipliers(double mu) {
  for (int i : low_) z_low[i] = near_centre(z_low[i] + dz_low_[i], value[i] - lower[i], mu);
  for (int i : high_) z_high[i] = near_centre(z_high[i] + dz_high_[i], upper[i] - value[i], mu);
}

void Bounded::sigma(double* out) const {
  std::fill_n(out, size(), 0.0);
  for (int i : low_) out[i] += z_low[i] / (value[i] - lower[i]);
  for (int i : high_) out[i] += z_high[i] / (upper[i] - value[i]);
}

void Bounded::add_barrier_gradient(double mu, double* out) const {
  for (int i : low_) out[i] -= mu / (value[i] - lower[i]);
  for (int i : high_) out[i] += mu / (upper[i] - value[i]);
}

double Bounded::logarithms(const double* at) const {
  // One logarithm for several factors: the products stay far from overflow.
  double sum = 0.0, product = 1.0;
  int factors = 0;
  const auto add = [&](double distance) {
    if (!(distance > 0.0)) sum = std::nan("");
    product *= distance;
    if (++factors % 8 == 0) {
      sum += std::log(product);
      product = 1.0;
    }
  };
  for (int i : low_) add(at[i] - lower[i]);
  for (int i : high_) add(upper[i] - at[i]);
  return sum + std::log(product);
}

void Bounded::find_multiplier_steps(double mu, const double* step) {
  for (int i : low_) dz_low_[i] = (mu - z_low[i] * step[i]) / (value[i] - lower[i]) - z_low[i];
  for (int i : high_) dz_high_[i] = (mu + z_high[i] * step[i]) / (upper[i] - value[i]) - z_high[i];
}

double Bounded::longest_step(double tau, const double* step) const {
  double length = 1.0;
  for (int i : low_)
    if (length * step[i] < -tau * (value[i] - lower[i])) length = -tau * (value[i] - lower[i]) / step[i];
  for (int i : high_)
    if (length * step[i] > tau * (upper[i] - value[i])) length = tau * (upper[i] - value[i]) / step[i];
  return length;
}

double Bounded::longest_multiplier_step(double tau) const {
  double length = 1.0;
  for (int i : low_)
    if (length * dz_low_[i] < -tau * z_low[i]) length = -tau * z_low[i] / dz_low_[i];
  for (int i : high_)
    if (length * dz_high_[i] < -tau * z_high[i]) length = -tau * z_high[i] / dz_high_[i];
  return length;
}

void Bounded::move_multipliers(double length, double mu) {
  const auto near = [mu](double z, double distance) {
    const double centre = mu / distance;
    return std::max(std::min(z, kFarthestFromCentre * centre), centre / kFarthestFromCentre);
  };
  for (int i : low_) z_low[i] = near(z_low[i] + length * dz_low_[i], value[i] - lower[i]);
  for (int i : high_) z_high[i] = near(z_high[i] + length * dz_high_[i], upper[i] - value[i]);
}

double Bounded::complementarity(double mu) const {
  double worst = 0.0;
  for (int i : low_) worst = std::max(worst, std::fabs((value[i] - lower[i]) * z_low[i] - mu));
  for (int i : high_) worst = std::max(worst, std::fabs((upper[i] - value[i]) * z_high[i] - mu));
  return worst;
}

double Bounded::multiplier_sum() const {
  double sum = 0.0;
  for (int i : low_) sum += z_low[i];
  for (int i : high_) sum += z_high[i];
  return sum;
}

}  // namespace banded
