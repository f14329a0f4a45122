#include "kernel_nlp.hpp"

#include <algorithm>
#include <stdexcept>

namespace banded {

KernelNlp::KernelNlp(int lanes, std::vector<KernelPart> parts, const Vector& weights, Sparse combine, Sparse linear,
                     Sparse jacobian_pattern, Scatter jacobian_scatter, Sparse hessian_pattern,
                     Scatter hessian_scatter)
    : lanes_(lanes), groups_((static_cast<int>(weights.size()) + lanes - 1) / lanes), parts_(std::move(parts)),
      weights_(weights), combine_(std::move(combine)), linear_(std::move(linear)),
      jacobian_scatter_(std::move(jacobian_scatter)), hessian_scatter_(std::move(hessian_scatter)) {
  jacobian = std::move(jacobian_pattern);
  hessian = std::move(hessian_pattern);
  const int knots = groups_ * lanes_;
  weights_.resize(knots, 0.0);
  squares.resize(rows());
  rows_.resize(rows());
  gradient.resize(unknowns());
  int outputs = 0, slopes = 0, curvatures = 0, widest = 0;
  for (const KernelPart& part : parts_) {
    if (part.select.rows != knots * part.n_y || part.squared_rows.size() != part.squared_factors.size())
      throw std::invalid_argument("a part does not fit the mesh");
    y_.emplace_back(part.select.rows);
    outputs += part.n_c * knots;
    slopes += part.jacobian_nonzeros * knots;
    curvatures += part.curvature_nonzeros * knots + part.n_y;
    widest = std::max(widest, part.select.rows);
  }
  if (jacobian_scatter_.map.columns() != slopes || hessian_scatter_.map.columns() != curvatures ||
      combine_.columns != outputs)
    throw std::invalid_argument("the scatters do not fit the kernels");
  c_.resize(outputs);
  pull_.resize(outputs);
  slopes_.resize(slopes);
  curvatures_.resize(curvatures);
  by_y_.resize(widest);
}

void KernelNlp::set_parameters(int part, const Vector& parameters, Vector c_weight, Vector y_weight) {
  KernelPart& at = parts_.at(part);
  const std::size_t squared = at.squared_rows.size() / (groups_ * lanes_);
  if (static_cast<int>(parameters.size()) != at.n_p || c_weight.size() != squared ||
      static_cast<int>(y_weight.size()) != at.n_y)
    throw std::length_error("the parameters of a part do not have its sizes");
  at.parameters.resize(parameters.size() * lanes_);
  for (std::size_t i = 0; i < at.parameters.size(); ++i) at.parameters[i] = parameters[i / lanes_];
  at.c_weight = std::move(c_weight);
  at.y_weight = std::move(y_weight);
  at_.clear();
}

double KernelNlp::evaluate(const double* x, double* g) {
  double f = 0.0;
  double* c = c_.data();
  at_.assign(x, x + unknowns());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const KernelPart& part = parts_[i];
    std::fill(y_[i].begin(), y_[i].end(), 0.0);
    part.select.multiply(x, y_[i].data());
    const double* y = y_[i].data();
    for (int group = 0; group < groups_; ++group, y += part.n_y * lanes_, c += part.n_c * lanes_) {
      const double* arguments[] = {y, part.parameters.data()};
      double* results[] = {c};
      part.value(arguments, results, nullptr, nullptr, 0);
      const double* w = weights_.data() + group * lanes_;
      const auto add_squares = [&](const Vector& weight, const double* values) {
        for (std::size_t j = 0; j < weight.size(); ++j)
          for (int l = 0; l < lanes_; ++l) {
            const double value = values[j * lanes_ + l];
            f += w[l] * weight[j] * value * value;
          }
      };
      add_squares(part.c_weight, c);
      add_squares(part.y_weight, y);
    }
  }
  std::fill_n(g, rows(), 0.0);
  combine_.multiply(c_.data(), g);
  linear_.multiply(x, g);
  return f;
}

void KernelNlp::differentiate(const double* x, const double* multipliers, double scale) {
  if (at_.empty() || !std::equal(at_.begin(), at_.end(), x)) evaluate(x, rows_.data());
  std::fill(pull_.begin(), pull_.end(), 0.0);
  combine_.multiply_transposed(multipliers, pull_.data());
  std::fill(gradient.begin(), gradient.end(), 0.0);
  std::fill(squares.begin(), squares.end(), 0.0);
  std::fill(rows_.begin(), rows_.end(), 0.0);
  int c_at = 0, slope_at = 0, curvature_at = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) differentiate_part(i, scale, c_at, slope_at, curvature_at);
  for (const KernelPart& part : parts_)
    for (double weight : part.y_weight) curvatures_[curvature_at++] = 2.0 * scale * weight;
  jacobian_scatter_.apply(slopes_, jacobian.value);
  hessian_scatter_.apply(curvatures_, hessian.value);
  jacobian.multiply_transposed(rows_.data(), gradient.data());
}

void KernelNlp::differentiate_part(std::size_t i, double scale, int& c_at, int& slope_at, int& curvature_at) {
  const KernelPart& part = parts_[i];
  const int squared = static_cast<int>(part.c_weight.size());
  const double* y = y_[i].data();
  std::fill(by_y_.begin(), by_y_.end(), 0.0);
  for (int group = 0; group < groups_; ++group, y += part.n_y * lanes_, c_at += part.n_c * lanes_) {
    for (int j = 0; j < squared * lanes_; ++j) {
      const int row = part.squared_rows[group * squared * lanes_ + j];
      if (row < 0) continue;
      // The square's 2 w c' c'^T in terms of rows of g, which are factor times c.
      const double factor = part.squared_factors[group * squared * lanes_ + j];
      const double weight = 2.0 * scale * weights_[group * lanes_ + j % lanes_] * part.c_weight[j / lanes_];
      pull_[c_at + j] += weight * c_[c_at + j];
      rows_[row] = weight * c_[c_at + j] / factor;
      squares[row] = weight / (factor * factor);
    }
    for (int j = 0; j < part.n_y * lanes_; ++j)
      by_y_[group * part.n_y * lanes_ + j] =
          2.0 * scale * weights_[group * lanes_ + j % lanes_] * part.y_weight[j / lanes_] * y[j];
    const double* arguments[] = {y, part.parameters.data(), pull_.data() + c_at};
    double* results[] = {slopes_.data() + slope_at, curvatures_.data() + curvature_at};
    part.derivatives(arguments, results, nullptr, nullptr, 0);
    slope_at += part.jacobian_nonzeros * lanes_;
    curvature_at += part.curvature_nonzeros * lanes_;
  }
  part.select.multiply_transposed(by_y_.data(), gradient.data());
}

}  // namespace banded
