// What the interior point asks of a problem: minimise f(x) subject to bounds on x and on g(x).
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "aligned.hpp"
#include "block_cholesky.hpp"

namespace banded {

// Adds H + J^T diag(d) J at the last point to a matrix stored as a Cholesky factorisation stores it.
class Assembly {
 public:
  virtual ~Assembly() = default;
  // d (rows) is not negative.
  virtual void add(const double* d, double* matrix) = 0;
};

class Nlp {
 public:
  virtual ~Nlp() = default;

  int unknowns() const { return static_cast<int>(gradient.size()); }
  int rows() const { return static_cast<int>(squares.size()); }

  // Set g (rows) and return f.
  virtual double evaluate(const double* x, double* g) = 0;

  // Set the derivatives of the Lagrangian `scale f + multipliers . g` at x: `gradient`, `squares` and what the
  // products below and an assembly use.
  virtual void differentiate(const double* x, const double* multipliers, double scale) = 0;

  // With J = dg/dx and H the Lagrangian's Hessian less J^T diag(squares) J: y += J x, y += J^T x, y += H x.
  virtual void multiply_jacobian(const double* x, double* y) = 0;
  virtual void multiply_jacobian_transposed(const double* x, double* y) = 0;
  virtual void multiply_hessian(const double* x, double* y) = 0;

  // The largest entry of each row of J, without its sign; where several terms make up an entry, the largest of them.
  virtual void row_sizes(double* sizes) const = 0;

  // Leave out of H what outputs and rows add by their own curvature, so that H + J^T diag(squares) J is the matrix of
  // Gauss and Newton, until the next `differentiate`; false where that part is not known.
  virtual bool drop_curvature() { return false; }

  // Pairs of blocks of unknowns that share an entry of H + J^T J.
  virtual std::vector<std::pair<int, int>> coupled(const std::vector<std::vector<int>>& blocks) const = 0;
  virtual std::unique_ptr<Assembly> assembly(const BlockCholesky& storage) const = 0;

  // Gradient of scale f.
  Vector gradient;
  // (rows,) weights of the rows whose squares the objective holds, so that they are condensed with the constraints.
  Vector squares;
};

// The block of each unknown.
inline std::vector<int> block_numbers(const std::vector<std::vector<int>>& blocks, int unknowns) {
  std::vector<int> number(unknowns, -1);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (int unknown : blocks[b]) number.at(unknown) = static_cast<int>(b);
  return number;
}

}  // namespace banded
