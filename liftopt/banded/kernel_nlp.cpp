#include "kernel_nlp.hpp"

#include <algorithm>
#include <stdexcept>

namespace banded {

KernelNlp::KernelNlp(std::vector<KernelPart> parts, Vector weights, Sparse combine, Sparse linear,
                     Sparse jacobian_pattern, Scatter jacobian_scatter, Sparse hessian_pattern,
                     Scatter hessian_scatter)
    : parts_(std::move(parts)), weights_(std::move(weights)), combine_(std::move(combine)),
      linear_(std::move(linear)), jacobian_scatter_(std::move(jacobian_scatter)),
      hessian_scatter_(std::move(hessian_scatter)) {
  jacobian = std::move(jacobian_pattern);
  hessian = std::move(hessian_pattern);
  squares.resize(rows());
  rows_.resize(rows());
  gradient.resize(unknowns());
  std::size_t outputs = 0, slopes = 0, curvatures = 0;
  for (const KernelPart& part : parts_) {
    y_.emplace_back(part.select.rows);
    outputs += static_cast<std::size_t>(part.n_c) * knots();
    slopes += static_cast<std::size_t>(part.jacobian_nonzeros) * knots();
    curvatures += static_cast<std::size_t>(part.curvature_nonzeros) * knots() + part.n_y;
    for (const KernelCall* kernel : {&part.value, &part.jacobian, &part.curvature}) {
      arguments_.resize(std::max<std::size_t>(arguments_.size(), kernel->n_arg));
      results_.resize(std::max<std::size_t>(results_.size(), kernel->n_res));
      iw_.resize(std::max<std::size_t>(iw_.size(), kernel->n_iw));
      w_.resize(std::max<std::size_t>(w_.size(), kernel->n_w));
    }
  }
  if (jacobian_scatter_.map.columns != static_cast<int>(slopes) ||
      hessian_scatter_.map.columns != static_cast<int>(curvatures) || combine_.columns != static_cast<int>(outputs))
    throw std::invalid_argument("the scatters do not fit the kernels");
  c_.resize(outputs);
  pull_.resize(outputs);
  slopes_.resize(slopes);
  curvatures_.resize(curvatures);
}

void KernelNlp::set_parameters(int part, Vector parameters, Vector c_weight, Vector y_weight) {
  KernelPart& at = parts_.at(part);
  at.parameters = std::move(parameters);
  at.c_weight = std::move(c_weight);
  at.y_weight = std::move(y_weight);
  at_.clear();
}

void KernelNlp::call(const KernelCall& kernel, const double* y, const double* p, const double* m, double* out) {
  arguments_[0] = y;
  arguments_[1] = p;
  if (m != nullptr) arguments_[2] = m;
  results_[0] = out;
  kernel.function(arguments_.data(), results_.data(), iw_.data(), w_.data(), 0);
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
    for (int k = 0; k < knots(); ++k, y += part.n_y, c += part.n_c) {
      call(part.value, y, part.parameters.data(), nullptr, c);
      double sum = 0.0;
      for (std::size_t j = 0; j < part.c_weight.size(); ++j) sum += part.c_weight[j] * c[j] * c[j];
      for (int j = 0; j < part.n_y; ++j) sum += part.y_weight[j] * y[j] * y[j];
      f += weights_[k] * sum;
    }
  }
  std::fill_n(g, rows(), 0.0);
  combine_.multiply(c_.data(), g);
  linear_.multiply(x, g);
  return f;
}

void KernelNlp::differentiate(const double* x, const double* multipliers, double scale) {
  if (!std::equal(at_.begin(), at_.end(), x, x + unknowns())) evaluate(x, rows_.data());
  std::fill(pull_.begin(), pull_.end(), 0.0);
  combine_.multiply_transposed(multipliers, pull_.data());
  std::fill(gradient.begin(), gradient.end(), 0.0);
  std::fill(squares.begin(), squares.end(), 0.0);
  std::fill(rows_.begin(), rows_.end(), 0.0);
  const double* c = c_.data();
  double *pull = pull_.data(), *slopes = slopes_.data(), *curvatures = curvatures_.data();
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const KernelPart& part = parts_[i];
    const double *y = y_[i].data(), *p = part.parameters.data();
    const int squared = static_cast<int>(part.c_weight.size());
    by_y_.resize(y_[i].size());
    for (int k = 0; k < knots(); ++k, y += part.n_y, c += part.n_c, pull += part.n_c) {
      for (int j = 0; j < squared; ++j) {
        // 2 w c' c'^T of the square as rows of g, which are factor c.
        const double weight = 2.0 * scale * weights_[k] * part.c_weight[j];
        const int row = part.squared_rows[k * squared + j];
        const double factor = part.squared_factors[k * squared + j];
        pull[j] += weight * c[j];
        rows_[row] = weight * c[j] / factor;
        squares[row] = weight / (factor * factor);
      }
      for (int j = 0; j < part.n_y; ++j) by_y_[k * part.n_y + j] = 2.0 * scale * weights_[k] * part.y_weight[j] * y[j];
      call(part.jacobian, y, p, nullptr, slopes);
      call(part.curvature, y, p, pull, curvatures);
      slopes += part.jacobian_nonzeros;
      curvatures += part.curvature_nonzeros;
    }
    for (int j = 0; j < part.n_y; ++j) *curvatures++ = 2.0 * scale * part.y_weight[j];
    part.select.multiply_transposed(by_y_.data(), gradient.data());
  }
  jacobian_scatter_.apply(slopes_, jacobian.value);
  hessian_scatter_.apply(curvatures_, hessian.value);
  jacobian.multiply_transposed(rows_.data(), gradient.data());
}

}  // namespace banded
