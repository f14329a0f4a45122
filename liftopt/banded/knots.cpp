#include "knots.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace banded {

Knots::Knots(int lanes, const Vector& weights, const Vector& basis, std::vector<int> control, std::vector<int> force)
    : operations_(lane_operations(lanes)), lanes_(lanes), knots_(static_cast<int>(weights.size())),
      groups_((knots_ + lanes - 1) / lanes), control_(std::move(control)), force_(std::move(force)) {
  points_ = knots_ ? static_cast<int>(basis.size()) / (knots_ * kOrders) : 0;
  if (points_ == 0 || basis.size() != static_cast<std::size_t>(knots_) * kOrders * points_ ||
      control_.size() % points_ != 0 || force_.size() % knots_ != 0)
    throw std::invalid_argument("the basis does not fit the mesh");
  coordinates_ = static_cast<int>(control_.size()) / points_;
  forces_ = static_cast<int>(force_.size()) / knots_;
  const auto value = [&](int knot, int order, int point) { return basis[(knot * kOrders + order) * points_ + point]; };
  for (int k = 0; k < knots_; ++k) {
    int low = points_, high = 0;
    for (int i = 0; i < points_; ++i)
      for (int a = 0; a < kOrders; ++a)
        if (value(k, a, i) != 0.0) {
          low = std::min(low, i);
          high = i;
        }
    first_.push_back(std::min(low, high));
    width_ = std::max(width_, high - first_.back() + 1);
  }
  if (width_ > kMostNear) throw std::invalid_argument("too many control points act at one knot");
  weights_.resize(groups_ * lanes_);
  basis_.resize(groups_ * kOrders * width_ * lanes_);
  near_.resize(width_ * coordinates_ * lanes_);
  for (int k = 0; k < knots_; ++k) {
    first_[k] = std::min(first_[k], points_ - width_);
    weights_[k] = weights[k];
    for (int a = 0; a < kOrders; ++a)
      for (int i = 0; i < width_; ++i)
        basis_[((k / lanes_ * kOrders + a) * width_ + i) * lanes_ + k % lanes_] = value(k, a, first_[k] + i);
  }
}

double Knots::reach(int group, int lane, int order) const {
  if (order < 0) return 1.0;
  double most = 0.0;
  for (int i = 0; i < width_; ++i) most = std::max(most, std::fabs(basis(group)[(order * width_ + i) * lanes_ + lane]));
  return most;
}

void Knots::select(int group, const std::vector<PartColumns>& parts, const double* x, double* y) {
  for (int l = 0; l < knots_of(group); ++l) {
    const int* from = control_.data() + first_[group * lanes_ + l] * coordinates_;
    for (int j = 0; j < width_ * coordinates_; ++j) near_[j * lanes_ + l] = x[from[j]];
  }
  for (const PartColumns& part : parts) {
    operations_.interpolate(basis(group), width_, near_.data() + part.first * lanes_, coordinates_, part.coordinates,
                            y);
    y += kOrders * part.coordinates * lanes_;
    for (int column : part.forces) {
      for (int l = 0; l < knots_of(group); ++l) y[l] = column < 0 ? 0.0 : x[force(group * lanes_ + l, column)];
      y += lanes_;
    }
    for (int column : part.others) {
      std::fill_n(y, lanes_, 0.0);
      for (int i = 0; i < width_; ++i) {
        const double *value = basis(group) + i * lanes_, *near = near_.data() + (i * coordinates_ + column) * lanes_;
        for (int l = 0; l < lanes_; ++l) y[l] += value[l] * near[l];
      }
      y += lanes_;
    }
  }
}

void Knots::add_selected(int group, const std::vector<PartColumns>& parts, const double* y, double* x) {
  const double* from = y;
  for (const PartColumns& part : parts) {
    operations_.interpolate_transposed(basis(group), width_, y, coordinates_, part.coordinates,
                                       near_.data() + part.first * lanes_);
    y += kOrders * part.coordinates * lanes_;
    for (int column : part.forces) {
      for (int l = 0; column >= 0 && l < knots_of(group); ++l) x[force(group * lanes_ + l, column)] += y[l];
      y += lanes_;
    }
    y += static_cast<int>(part.others.size()) * lanes_;
  }
  // Added to what the parts whose coordinates they are have set.
  for (const PartColumns& part : parts) {
    from += part.size() * lanes_;
    const double* other = from - static_cast<int>(part.others.size()) * lanes_;
    for (int column : part.others) {
      for (int i = 0; i < width_; ++i) {
        const double* value = basis(group) + i * lanes_;
        double* near = near_.data() + (i * coordinates_ + column) * lanes_;
        for (int l = 0; l < lanes_; ++l) near[l] += value[l] * other[l];
      }
      other += lanes_;
    }
  }
  for (int l = 0; l < knots_of(group); ++l) {
    const int* to = control_.data() + first_[group * lanes_ + l] * coordinates_;
    for (int j = 0; j < width_ * coordinates_; ++j) x[to[j]] += near_[j * lanes_ + l];
  }
}

}  // namespace banded
