// The lift's problem from its compiled knot kernels, called without Python:
//
//     f = sum_parts sum_k w_k (c_weight . c_k^2 + y_weight . y_k^2),   g = G C(x) + A x,   y = S x,
//
// C all outputs c of all kernels. Every nonzero of the derivatives is a fixed linear combination of what the kernels
// return, so one sparse product scatters it.
#pragma once

#include <cstdint>
#include <vector>

#include "nlp.hpp"

namespace banded {

// CasADi's calling convention of generated code.
using Kernel = int (*)(const double** arguments, double** results, long long* iw, double* w, int memory);

// A kernel and the lengths of its arguments, results and work vectors.
struct KernelCall {
  Kernel function = nullptr;
  int n_arg = 0, n_res = 0, n_iw = 0, n_w = 0;
};

// One agent or the object.
struct KernelPart {
  KernelCall value, jacobian, curvature;  // (y, p) -> c; (y, p) -> dc/dy; (y, p, m) -> upper triangle of m . c''
  int n_y = 0, n_c = 0, jacobian_nonzeros = 0, curvature_nonzeros = 0;
  Sparse select;                  // S, knot by knot
  std::vector<int> squared_rows;  // row of g that is proportional to each leading output, and by which factor
  Vector squared_factors;
  Vector parameters, c_weight, y_weight;  // set before a solve
};

// A linear map to the nonzeros of a matrix, with a constant part.
struct Scatter {
  Sparse map;
  Vector offset;
  void apply(const Vector& values, Vector& nonzeros) const {
    nonzeros = offset;
    map.multiply(values.data(), nonzeros.data());
  }
};

class KernelNlp : public Nlp {
 public:
  // `combine` is G, `linear` A; the patterns are the members of Nlp, filled by the scatters.
  KernelNlp(std::vector<KernelPart> parts, Vector weights, Sparse combine, Sparse linear, Sparse jacobian_pattern,
            Scatter jacobian_scatter, Sparse hessian_pattern, Scatter hessian_scatter);

  void set_parameters(int part, Vector parameters, Vector c_weight, Vector y_weight);

  double evaluate(const double* x, double* g) override;
  void differentiate(const double* x, const double* multipliers, double scale) override;

 private:
  void call(const KernelCall& kernel, const double* y, const double* p, const double* m, double* out);
  int knots() const { return static_cast<int>(weights_.size()); }

  std::vector<KernelPart> parts_;
  Vector weights_;
  Sparse combine_, linear_;
  Scatter jacobian_scatter_, hessian_scatter_;
  std::vector<Vector> y_;  // of each part at the last point
  Vector at_, c_, pull_, slopes_, curvatures_, rows_, by_y_;
  std::vector<const double*> arguments_;
  std::vector<double*> results_;
  std::vector<long long> iw_;
  Vector w_;
};

}  // namespace banded
