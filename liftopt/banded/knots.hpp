// The knots of a collocation mesh, several abreast: lane l of group k / lanes holds knot k, its values interleaved
// (entry j of lane l at j lanes + l). Lanes after the last knot have no weight, and nothing is read from them.
//
// At each knot every coordinate has a value and two derivatives by the phase, which are combinations of the `width`
// control points from `first` on; the grasp forces of the knot are unknowns themselves.
#pragma once

#include <algorithm>
#include <vector>

#include "aligned.hpp"
#include "lane_operations.hpp"

namespace banded {

// What one agent or the object has of a knot's variables: y = (q, q', q'', forces, values of others' coordinates).
struct PartColumns {
  int first = 0, coordinates = 0;  // of the coordinates of the knot
  std::vector<int> forces;         // of the forces of the knot, -1 for one that is always zero
  std::vector<int> others;         // of the coordinates of the knot
  // Of an entry of y, as a derivative of coordinates; -1 of a force.
  int order(int entry) const {
    const int after = entry - kOrders * coordinates;
    return after < 0 ? entry / coordinates : after < static_cast<int>(forces.size()) ? -1 : 0;
  }
  int size() const { return kOrders * coordinates + static_cast<int>(forces.size() + others.size()); }
};

class Knots {
 public:
  // `basis`: (knots, orders, control points), zero away from a few neighbouring control points of each knot.
  // `control`: (control points, coordinates) and `force`: (knots, forces), places in x.
  // Throws std::invalid_argument where the processor has no vectors of that many lanes, or the shapes do not fit.
  Knots(int lanes, const Vector& weights, const Vector& basis, std::vector<int> control, std::vector<int> force);

  int lanes() const { return lanes_; }
  const LaneOperations& operations() const { return operations_; }
  int knots() const { return knots_; }
  int groups() const { return groups_; }
  int width() const { return width_; }
  int coordinates() const { return coordinates_; }
  int forces() const { return forces_; }
  int knots_of(int group) const { return std::min(lanes_, knots_ - group * lanes_); }
  int first(int knot) const { return first_[knot]; }
  int control(int point, int coordinate) const { return control_[point * coordinates_ + coordinate]; }
  int force(int knot, int force) const { return force_[knot * forces_ + force]; }
  const double* weights(int group) const { return weights_.data() + group * lanes_; }
  // (orders, width) vectors.
  const double* basis(int group) const { return basis_.data() + group * kOrders * width_ * lanes_; }

  // The largest weight, without its sign, of an unknown in a knot's derivative of that order; 1 of order -1, a force.
  double reach(int group, int lane, int order) const;

  // The variables of all parts of a group, one part after the other.
  void select(int group, const std::vector<PartColumns>& parts, const double* x, double* y);
  // x += the transposed map of y.
  void add_selected(int group, const std::vector<PartColumns>& parts, const double* y, double* x);

 private:
  const LaneOperations& operations_;
  int lanes_, knots_, groups_, coordinates_, forces_, points_, width_ = 1;
  std::vector<int> first_, control_, force_;
  Aligned weights_, basis_, near_;  // near: the control points of a group's knots
};

}  // namespace banded
