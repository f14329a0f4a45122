// The lift's problem from its compiled knot kernels, called without Python:
//
//     f = sum_parts sum_k w_k (c_weight . c_k^2 + y_weight . y_k^2),   g = G C(x) + A x,   y = S x,
//
// C all outputs c of all kernels. Every nonzero of the derivatives is a fixed linear combination of what the kernels
// return, so one sparse product scatters it. A kernel serves `lanes` knots a call, its values interleaved: entry j of
// n of knot k is at ((k / lanes) n + j) lanes + k % lanes. The last group is filled up with knots of weight zero that
// no map reads.
#pragma once

#include <vector>

#include "nlp.hpp"
#include "sliced.hpp"

namespace banded {

// CasADi's calling convention of generated code.
using Kernel = int (*)(const double** arguments, double** results, long long* iw, double* w, int memory);

// One agent or the object.
struct KernelPart {
  Kernel value = nullptr;        // (y, p) -> c
  Kernel derivatives = nullptr;  // (y, p, m) -> dc/dy, upper triangle of m . c''
  int n_y = 0, n_c = 0, n_p = 0, jacobian_nonzeros = 0, curvature_nonzeros = 0;
  Sparse select;  // S, its rows interleaved
  // Row of g that is proportional to each squared output, by which factor; interleaved, -1 where there is no knot.
  std::vector<int> squared_rows;
  Vector squared_factors;
  Aligned parameters;           // a lane each
  Vector c_weight, y_weight;    // of the squared outputs and of y in the objective
};

// A linear map to the nonzeros of a matrix, with a constant part.
struct Scatter {
  Sliced map;
  Vector offset;
  void apply(const Aligned& values, Vector& nonzeros) const {
    nonzeros = offset;
    map.multiply(values.data(), nonzeros.data());
  }
};

class KernelNlp : public Nlp {
 public:
  // `weights`: of the knots. `combine` is G, its columns interleaved; `linear` is A; the patterns of the Jacobian and
  // of the upper triangle of the Hessian have what the scatters fill: the scatters' columns are the kernels' slopes,
  // or their curvatures and then, of each part, n_y entries of a diagonal that its knots share.
  KernelNlp(int lanes, std::vector<KernelPart> parts, const Vector& weights, Sparse combine, Sparse linear,
            Sparse jacobian_pattern, Scatter jacobian_scatter, Sparse hessian_pattern, Scatter hessian_scatter);

  void set_parameters(int part, const Vector& parameters, Vector c_weight, Vector y_weight);

  double evaluate(const double* x, double* g) override;
  void differentiate(const double* x, const double* multipliers, double scale) override;

 private:
  void differentiate_part(std::size_t part, double scale, int& c_at, int& slope_at, int& curvature_at);

  int lanes_, groups_;
  std::vector<KernelPart> parts_;
  Vector weights_;  // filled up with zeros
  Sparse combine_, linear_;
  Scatter jacobian_scatter_, hessian_scatter_;
  std::vector<Aligned> y_;  // of each part at the last point
  Vector at_, rows_;
  Aligned c_, pull_, slopes_, curvatures_, by_y_;
};

}  // namespace banded
