// A primal-dual interior point with a filter line search for problems whose condensed Newton matrix is block banded.
//
// The algorithm is that of Waechter and Biegler (2006), "On the implementation of an interior-point filter line-search
// algorithm for large-scale nonlinear programming", Math. Program. 106, 25-57 (equations and steps are its own): the
// barrier parameter decreases by (7), steps keep a share of every distance to a bound (15), the filter judges them
// (section 2.3), a second-order correction is tried (section 2.4). What is different:
//   - a warm start may begin with whole Newton steps that no bound shortens (`predict`);
//   - the Newton system is condensed to the unknowns and factorised by a block Cholesky, see newton.hpp;
//   - there is no restoration phase: where no step is acceptable, delta grows a few times, then it gives up and says
//     so, or that the violation cannot be reduced from here;
//   - far from a solution the Hessian may be Gauss's and Newton's, see newton.hpp;
//   - slope and complementarity may be asked for as a share of the objective (`rough`);
//   - given the objective of another solution (`incumbent`), it gives up where this one promises none lower.
#pragma once

#include <deque>
#include <vector>

#include "aligned.hpp"
#include "bounded.hpp"
#include "filter.hpp"
#include "newton.hpp"
#include "nlp.hpp"

namespace banded {

struct Options {
  double tolerance = 1e-6;           // largest KKT error in the problem's own units
  double rough = 0.0;                // share of the objective that all but the violation of rows may reach instead
  double objective_scaling = 0.1;    // factor on the objective inside
  double seconds = INFINITY;         // wall time before it stops
  double incumbent = INFINITY;       // objective of another solution, worth going on only to get below
  double mu = 0.1, push = 1e-2;      // barrier parameter and distance from bounds at the start
  int max_iterations = 500;
  int predictions = 0;               // Newton steps at the start that no bound shortens
  int verbose = 0;
};

enum class Status { solved, iterations, time, line_search, infeasible, invalid, beaten };

struct Result {
  Status status = Status::invalid;
  Vector x, bound_multipliers, multipliers;  // L = f + multipliers . g + bound_multipliers . x
  double objective = 0.0, error = INFINITY;
  int iterations = 0, factorisations = 0, refinements = 0, evaluations = 0;
  double seconds = 0.0, evaluation_seconds = 0.0, assembly_seconds = 0.0, factorisation_seconds = 0.0;
};

class InteriorPoint {
 public:
  InteriorPoint(Nlp& nlp, std::vector<std::vector<int>> blocks);

  // `warm_x`, `warm_g`: multipliers of a neighbouring solution, or null.
  Result solve(const double* lower_x, const double* upper_x, const double* lower_g, const double* upper_g,
               const double* x0, const double* warm_x, const double* warm_g, const Options& options);

  double multiplications() const { return newton_.multiplications(); }

 private:
  struct Point {
    Vector x, s, g;
    double f = 0.0;
  };
  void start(const double* x0, const double* warm_x, const double* warm_g);
  void settle();
  void differentiate();
  bool predict();
  void find_weights();
  double barrier_error(double mu) const;
  double original_error() const;
  double leniency() const;
  void residuals();
  void solve_newton(const Vector& residual);
  bool step();
  bool search();
  bool correct(double length);
  bool try_point(double length, const Vector& dx, const Vector& ds, double armijo_length);
  void move(double multiplier_length);
  Merit merit(const Point& point) const;
  double evaluate(Point& point);
  bool stuck() const;
  bool beaten();
  void finish(Result& result);

  Nlp& nlp_;
  Newton newton_;
  Options options_;
  std::vector<char> equality_;
  Bounded x_{nullptr, nullptr, 0}, s_{nullptr, nullptr, 0};
  Filter filter_{0.0};
  Point now_, trial_;
  Vector lambda_, lagrangian_;         // multipliers of the rows; gradient of scaled f + lambda . g
  Vector residual_;                    // of the rows: g - s, s held at the bound for equalities
  Vector sigma_x_, sigma_s_, centre_;  // Newton's weights, and the gradient of the Lagrangian by s
  Vector ds_, dlambda_, right_, rows_;
  double mu_ = 0.1, tau_ = 0.99, slope_ = 0.0, length_ = 0.0;
  Merit from_{0.0, 0.0};
  std::deque<double> past_;            // objectives of the last iterations, the latest last
  int evaluations_ = 0, predictions_ = 0;
  double evaluation_seconds_ = 0.0;
};

}  // namespace banded
