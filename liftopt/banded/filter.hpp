// The filter of Waechter and Biegler (2006), Math. Program. 106, 25-57, section 2.3: a trial point is acceptable where
// it makes enough progress in the constraint violation theta or in the barrier function phi.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace banded {

// The point a step starts from.
struct Merit {
  double theta, phi;
};

class Filter {
 public:
  explicit Filter(double theta_at_start)
      : largest_(1e4 * std::max(1.0, theta_at_start)), small_(1e-4 * std::max(1.0, theta_at_start)) {}

  void clear() { pairs_.clear(); }

  // Whether a trial point at step length `length` is accepted (step ), where `slope` is phi's derivative along
  // the step. An accepted one extends the filter unless it is a descent of phi (step A-7).
  bool accepts(const Merit& from, const Merit& trial, double slope, double length) {
    if (!std::isfinite(trial.phi) || !std::isfinite(trial.theta) || trial.theta > largest_) return false;
    for (const Merit& pair : pairs_)
      if (trial.theta >= pair.theta && trial.phi >= pair.phi) return false;
    // Rounding of phi must not refuse the last steps (section 3.8).
    const double rounding = 10.0 * std::numeric_limits<double>::epsilon() * std::fabs(from.phi);
    const bool descends = trial.phi - from.phi - rounding <= kArmijo * length * slope;
    const bool switching = slope < 0.0 && length * std::pow(-slope, 2.3) > std::pow(from.theta, 1.1);
    const bool progress = trial.theta <= (1.0 - kMarginTheta) * from.theta ||
                          trial.phi - rounding <= from.phi - kMarginPhi * from.theta;
    if (switching && from.theta <= small_ ? !descends : !progress) return false;
    if (!(switching && descends))
      pairs_.push_back({(1.0 - kMarginTheta) * from.theta, from.phi - kMarginPhi * from.theta});
    return true;
  }

 private:
  static constexpr double kMarginTheta = 1e-5, kMarginPhi = 1e-8, kArmijo = 1e-8;
  double largest_, small_;
  std::vector<Merit> pairs_;
};

}  // namespace banded
