// The lift's problem from its compiled knot kernels, called without Python:
//
//     f = sum_parts sum_k w_k (c_weight . c_k^2 + y_weight . y_k^2 + range(y_k)),   g = G C(x) + A x,   y = S x,
//
// C all outputs c of all kernels; c_weight is another where an output is negative, so that f and its gradient are
// continuous and its curvature is that of the present side. Derivatives stay at the knots, as the kernels return them: a product with the
// Jacobian or the Hessian interpolates to the knots, multiplies there for several knots at once, and interpolates back.
#pragma once

#include <vector>

#include "knots.hpp"
#include "lane_operations.hpp"
#include "nlp.hpp"
#include "sparse.hpp"

namespace banded {

// CasADi's calling convention of generated code.
using Kernel = int (*)(const double** arguments, double** results, long long* iw, double* w, int memory);

// What a leading variable y costs: square d^2 + fourth d^4 of d = y - neutral, with weights below and above neutral.
struct RangeTerm {
  double neutral, square[2], fourth[2];
};

// One agent or the object.
struct KernelPart {
  Kernel value = nullptr;        // (y, p) -> c
  Kernel derivatives = nullptr;  // (y, p, m) -> dc/dy, upper triangle of m . c''
  PartColumns columns;
  int n_c = 0, n_p = 0, n_squared = 0;
  std::vector<int> jacobian_row, jacobian_column, curvature_row, curvature_column;  // of the nonzeros
  Aligned parameters;                                                               // a lane each
  Vector c_weight, y_weight;  // of the squared leading outputs and of y in the objective
  Vector c_weight_below;      // of outputs that are negative
  std::vector<RangeTerm> range;
};

// A row of g at every knot that has it: the sum of factors times outputs of the knot.
struct KnotRow {
  struct Term {
    int part, output;
    double factor;    // at every knot, unless
    int varied = -1;  // it is that one of the factors that differ from knot to knot, see `KernelNlp::set_factors`
  };
  bool is_varied() const { return !terms.empty() && terms[0].varied >= 0; }  // all terms are, or none
  std::vector<Term> terms;
  std::vector<int> row;  // (knots,) which of g, or -1
};

class KernelNlp : public Nlp {
 public:
  // Each row of g has either a KnotRow or entries in `linear`, which is A. Every squared output has a row to itself,
  // whose factor is the same at all knots.
  KernelNlp(Knots knots, std::vector<KernelPart> parts, std::vector<KnotRow> knot_rows, Sparse linear);

  void set_parameters(int part, const Vector& parameters, Vector c_weight, Vector y_weight, Vector c_weight_below,
                      std::vector<RangeTerm> range);
  // (varied, knots) factors that differ from knot to knot; zero until they are set.
  void set_factors(const Vector& factors);

  double evaluate(const double* x, double* g) override;
  void differentiate(const double* x, const double* multipliers, double scale) override;
  void multiply_jacobian(const double* x, double* y) override;
  void multiply_jacobian_transposed(const double* x, double* y) override;
  void multiply_hessian(const double* x, double* y) override;
  void row_sizes(double* sizes) const override;
  bool drop_curvature() override;
  std::vector<std::pair<int, int>> coupled(const std::vector<std::vector<int>>& blocks) const override;
  std::unique_ptr<Assembly> assembly(const BlockCholesky& storage) const override;

  const Knots& knots() const { return knots_; }
  const std::vector<KernelPart>& parts() const { return parts_; }
  const std::vector<KnotRow>& knot_rows() const { return knot_rows_; }
  const Sparse& linear() const { return linear_; }
  // Where the nonzeros of a part are among those of a knot; the Hessian's are followed by a diagonal of the size of y.
  int first_slope(int part) const { return first_slope_[part]; }
  int first_curvature(int part) const { return first_curvature_[part]; }
  // (varied,) vectors.
  const double* factors(int group) const { return factors_.data() + group * n_varied_ * lanes(); }
  const double* slopes(int group) const { return slopes_.data() + group * n_slopes_ * lanes(); }
  const double* curvatures(int group) const { return curvatures_.data() + group * n_curvatures_ * lanes(); }

 private:
  struct Square {
    int output, row;  // of all outputs of a knot; of the knot rows
    double factor;
  };
  int lanes() const { return knots_.lanes(); }
  void find_squares();
  void plan_products();
  // f += weighted squares, knot by knot: the same sum whatever the number of lanes.
  void add_squares(int group, double& f) const;
  void add_outputs(int group, const double* c, double* g) const;
  void pull_back(int group, const double* multipliers, double* pull) const;
  void differentiate(int group, double scale, double* slope_by_y);

  Knots knots_;
  std::vector<KernelPart> parts_;
  std::vector<PartColumns> columns_;
  std::vector<KnotRow> knot_rows_;
  Sparse linear_;
  std::vector<int> first_y_, first_c_, first_slope_, first_curvature_;
  int n_y_ = 0, n_c_ = 0, n_slopes_ = 0, n_curvatures_ = 0, n_varied_ = 0;  // of a knot
  std::vector<std::vector<Square>> squared_;                 // of each part
  Sums by_jacobian_, by_jacobian_transposed_, by_hessian_;
  Vector at_, row_values_;
  Aligned factors_;
  Aligned y_, c_, pull_, slopes_, curvatures_, other_y_, sum_y_, square_pull_;  // y, c, pull: of all groups
};

}  // namespace banded
