// What the interior point asks of a problem: minimise f(x) subject to bounds on x and on g(x).
#pragma once

#include "sparse.hpp"

namespace banded {

class Nlp {
 public:
  virtual ~Nlp() = default;

  int unknowns() const { return jacobian.columns; }
  int rows() const { return jacobian.rows; }

  // Set g (rows) and return f.
  virtual double evaluate(const double* x, double* g) = 0;

  // Set the members below for the Lagrangian `scale f + multipliers . g`.
  virtual void differentiate(const double* x, const double* multipliers, double scale) = 0;

  // Gradient of scale f.
  Vector gradient;
  // dg/dx.
  Sparse jacobian;
  // Entries on and above the diagonal of the Lagrangian's Hessian, less J^T diag(squares) J.
  Sparse hessian;
  // (rows,) weights of the rows whose squares the objective holds, so that they are condensed with the constraints.
  Vector squares;
};

}  // namespace banded
