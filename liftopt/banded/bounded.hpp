// Values kept strictly between bounds by a logarithmic barrier, with the multipliers of their bounds.
//
// Used for the unknowns x and, in the same way, for the slacks of the constraint rows. Numbers in brackets are the
// equations of Waechter and Biegler (2006), Math. Program. 106, 25-57.
#pragma once

#include <vector>

#include "aligned.hpp"

namespace banded {

class Bounded {
 public:
  // Where lower equals upper, the value is held there and has no barrier.
  Bounded(const double* lower, const double* upper, int n);

  int size() const { return static_cast<int>(value.size()); }
  bool is_held(int i) const { return held_mask_[i] != 0; }
  const std::vector<int>& held() const { return held_; }
  int sides() const { return sides_; }

  // Move the values into the interior by at least `push` of the room (section 3.6).
  void push_inside(double push);

  // Start the multipliers at the centre mu / distance.
  void centre(double mu);

  // Start them from multipliers of a neighbouring solution (positive at an upper bound), not too far from the centre.
  void warm(const double* multiplier, double mu);

  // sigma_i = z_low / (v - low) + z_high / (high - v), the barrier's share of the Newton matrix (13).
  void sigma(double* out) const;

  // out_i += derivative of the barrier term -mu sum log(distance).
  void add_barrier_gradient(double mu, double* out) const;

  // sum of the logarithms of all distances, at `at`.
  double logarithms(const double* at) const;

  // Multiplier steps for a step of the values (12), kept until `move_multipliers`.
  void find_multiplier_steps(double mu, const double* step);

  // Largest steps that keep the share 1 - tau of each distance or multiplier (15).
  double longest_step(double tau, const double* step) const;
  double longest_multiplier_step(double tau) const;

  // Move the multipliers and keep them within a factor of the centre (16).
  void move_multipliers(double length, double mu);

  // Move the multipliers by whole steps, not too far from the centre.
  void predict_multipliers(double mu);

  // Largest |distance z - mu|.
  double complementarity(double mu) const;

  // Sum of the multipliers.
  double multiplier_sum() const;

  Vector lower, upper, value, z_low, z_high;

 private:
  std::vector<int> held_, low_, high_;  // held; with a lower, an upper bound
  std::vector<char> held_mask_;
  Vector dz_low_, dz_high_;
  int sides_ = 0;
};

}  // namespace banded
