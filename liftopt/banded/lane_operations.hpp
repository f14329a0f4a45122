// Operations on several knots at once, in vectors of as many doubles as the kernels have lanes.
#pragma once

#include <vector>

namespace banded {

constexpr int kOrders = 3;    // value, first and second derivative
constexpr int kMostNear = 4;  // control points that may act at one knot

// Products values[value] from[from] of vectors; a sum of them is added to to[to]. Each sum starts where the last ends.
struct Product {
  int value, from;
};
struct Sum {
  int to, end;
};
struct Sums {
  std::vector<Product> products;
  std::vector<Sum> sums;
};

// rows[to] = or += scale[row] factor slopes[from]; where `varied` is not negative, factors[varied] is the factor.
struct RowEntry {
  int row, from, to, varied;
  double factor;
  bool first;
};

// A pair of a knot's variables and what makes their entry of H + R^T R: nonzeros of H, and products of entries of
// rows R. Coordinates stand for three variables, their orders.
struct Pair {
  enum Kind { coordinates, coordinate_force, forces } kind;
  int one, other;            // coordinates or forces; of two coordinates or two forces the first is not the larger
  struct Curvature {
    int entry, from;         // which of the orders x orders (orders, 1) entries; nonzero of H
  };
  struct Row {
    int one, other;          // where the entries of the row are
  };
  std::vector<Curvature> curvatures;
  std::vector<Row> full, first;  // rows with entries for all orders of the coordinates, or for values alone
};

struct LaneOperations {
  void (*multiply)(const Sums& sums, const double* values, const double* from, double* to);
  // y (orders, n) = basis (orders, width) points (width, stride); and transposed.
  void (*interpolate)(const double* basis, int width, const double* points, int stride, int n, double* y);
  void (*interpolate_transposed)(const double* basis, int width, const double* y, int stride, int n, double* points);
  void (*fill_rows)(const RowEntry* entries, int count, const double* scale, const double* factors,
                    const double* slopes, double* rows);
  // The entries of H + R^T R between the control points, forces of a pair: (width, width), (width,) or one.
  void (*condense)(const Pair& pair, const double* basis, int width, const double* curvatures, const double* rows,
                   double* entries);
};

// Throws std::invalid_argument where the processor has no vectors of that many lanes.
const LaneOperations& lane_operations(int lanes);

}  // namespace banded
