#include "kernel_nlp.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "dense.hpp"
#include "knot_assembly.hpp"

namespace banded {

KernelNlp::KernelNlp(Knots knots, std::vector<KernelPart> parts, std::vector<KnotRow> knot_rows, Sparse linear)
    : knots_(std::move(knots)), parts_(std::move(parts)), knot_rows_(std::move(knot_rows)), linear_(std::move(linear)) {
  for (const KernelPart& part : parts_) {
    columns_.push_back(part.columns);
    first_y_.push_back(n_y_);
    first_c_.push_back(n_c_);
    first_slope_.push_back(n_slopes_);
    first_curvature_.push_back(n_curvatures_);
    n_y_ += part.columns.size();
    n_c_ += part.n_c;
    n_slopes_ += static_cast<int>(part.jacobian_row.size());
    n_curvatures_ += static_cast<int>(part.curvature_row.size()) + part.columns.size();
  }
  std::vector<char> taken(linear_.rows, 0);
  for (int r = 0; r < linear_.rows; ++r) taken[r] = linear_.start[r] < linear_.start[r + 1];
  for (const KnotRow& row : knot_rows_) {
    if (static_cast<int>(row.row.size()) != knots_.knots()) throw std::invalid_argument("a row does not fit the mesh");
    for (int r : row.row)
      if (r >= 0 && std::exchange(taken.at(r), 1)) throw std::invalid_argument("a row of g has two meanings");
    for (const KnotRow::Term& term : row.terms) {
      if (term.output < 0 || term.output >= parts_.at(term.part).n_c) throw std::invalid_argument("no such output");
      n_varied_ = std::max(n_varied_, term.varied + 1);
    }
  }
  gradient.resize(linear_.columns);
  squares.resize(linear_.rows);
  const int groups = knots_.groups();
  factors_.resize(groups * n_varied_ * lanes());
  y_.resize(groups * n_y_ * lanes());
  for (Aligned* v : {&other_y_, &sum_y_}) v->resize(n_y_ * lanes());
  for (Aligned* v : {&c_, &pull_}) v->resize(groups * n_c_ * lanes());
  slopes_.resize(groups * n_slopes_ * lanes());
  curvatures_.resize(groups * n_curvatures_ * lanes());
  row_values_.resize(rows());
  square_pull_.resize(n_c_ * lanes());
  find_squares();
  plan_products();
}

void KernelNlp::find_squares() {
  squared_.resize(parts_.size());
  for (std::size_t p = 0; p < parts_.size(); ++p)
    for (int j = 0; j < parts_[p].n_squared; ++j) {
      const auto own = std::find_if(knot_rows_.begin(), knot_rows_.end(), [&](const KnotRow& row) {
        return row.terms.size() == 1 && row.terms[0].part == static_cast<int>(p) && row.terms[0].output == j &&
               !row.is_varied() &&
               std::find(row.row.begin(), row.row.end(), -1) == row.row.end();
      });
      if (own == knot_rows_.end())
        throw std::invalid_argument("a squared output has no constraint row of its own to be condensed with");
      squared_[p].push_back({first_c_[p] + j, static_cast<int>(own - knot_rows_.begin()), own->terms[0].factor});
    }
}

void KernelNlp::plan_products() {
  struct Entry {
    int value, from, to;
  };
  std::vector<Entry> jacobian, transposed, hessian;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const KernelPart& part = parts_[p];
    for (std::size_t e = 0; e < part.jacobian_row.size(); ++e) {
      const int value = first_slope_[p] + static_cast<int>(e);
      const int row = first_c_[p] + part.jacobian_row[e], column = first_y_[p] + part.jacobian_column[e];
      jacobian.push_back({value, column, row});
      transposed.push_back({value, row, column});
    }
    const auto add = [&](int value, int row, int column) {
      hessian.push_back({value, first_y_[p] + column, first_y_[p] + row});
      if (row != column) hessian.push_back({value, first_y_[p] + row, first_y_[p] + column});
    };
    int value = first_curvature_[p];
    for (std::size_t e = 0; e < part.curvature_row.size(); ++e)
      add(value++, part.curvature_row[e], part.curvature_column[e]);
    for (int j = 0; j < part.columns.size(); ++j) add(value++, j, j);
  }
  // What makes up a sum comes together and keeps its order, so that the sum stays in a register.
  const auto sums_of = [](std::vector<Entry>& entries) {
    std::stable_sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.to < b.to; });
    Sums all;
    for (const Entry& entry : entries) {
      if (all.sums.empty() || all.sums.back().to != entry.to) all.sums.push_back({entry.to, 0});
      all.products.push_back({entry.value, entry.from});
      all.sums.back().end = static_cast<int>(all.products.size());
    }
    return all;
  };
  by_jacobian_ = sums_of(jacobian);
  by_jacobian_transposed_ = sums_of(transposed);
  by_hessian_ = sums_of(hessian);
}

void KernelNlp::set_parameters(int part, const Vector& parameters, Vector c_weight, Vector y_weight,
                               Vector c_weight_below, std::vector<RangeTerm> range) {
  KernelPart& at = parts_.at(part);
  if (static_cast<int>(parameters.size()) != at.n_p || static_cast<int>(c_weight.size()) != at.n_squared ||
      c_weight_below.size() != c_weight.size() || static_cast<int>(y_weight.size()) != at.columns.size() ||
      static_cast<int>(range.size()) > at.columns.size())
    throw std::length_error("the parameters of a part do not have its sizes");
  at.parameters.resize(parameters.size() * lanes());
  for (std::size_t i = 0; i < at.parameters.size(); ++i) at.parameters[i] = parameters[i / lanes()];
  at.c_weight = std::move(c_weight);
  at.y_weight = std::move(y_weight);
  at.c_weight_below = std::move(c_weight_below);
  at.range = std::move(range);
  at_.clear();
}

void KernelNlp::set_factors(const Vector& factors) {
  if (factors.size() != static_cast<std::size_t>(n_varied_) * knots_.knots())
    throw std::length_error("a factor for each varied term at each knot");
  for (int k = 0; k < knots_.knots(); ++k)
    for (int j = 0; j < n_varied_; ++j)
      factors_[(k / lanes() * n_varied_ + j) * lanes() + k % lanes()] = factors[j * knots_.knots() + k];
  at_.clear();
}

void KernelNlp::add_squares(int group, double& f) const {
  const int width = lanes();
  const double *w = knots_.weights(group), *c = c_.data() + group * n_c_ * width;
  const double* y = y_.data() + group * n_y_ * width;
  double sum[kLanes] = {};
  const auto add = [&](const Vector& below, const Vector& above, const double* values) {
    for (std::size_t j = 0; j < above.size(); ++j)
      if (below[j] != 0.0 || above[j] != 0.0)
        for (int l = 0; l < width; ++l) {
          const double value = values[j * width + l];
          sum[l] += (value > 0.0 ? above[j] : below[j]) * value * value;
        }
  };
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const KernelPart& part = parts_[p];
    add(part.c_weight_below, part.c_weight, c + first_c_[p] * width);
    add(part.y_weight, part.y_weight, y + first_y_[p] * width);
    for (std::size_t j = 0; j < part.range.size(); ++j) {
      const RangeTerm& term = part.range[j];
      for (int l = 0; l < width; ++l) {
        const double away = y[(first_y_[p] + static_cast<int>(j)) * width + l] - term.neutral, squared = away * away;
        const int side = away > 0.0;
        sum[l] += (term.square[side] + term.fourth[side] * squared) * squared;
      }
    }
  }
  for (int l = 0; l < width; ++l) f += w[l] * sum[l];
}

// g += G c
void KernelNlp::add_outputs(int group, const double* c, double* g) const {
  const int width = lanes(), count = knots_.knots_of(group);
  for (const KnotRow& row : knot_rows_) {
    const int* to = row.row.data() + group * width;
    double sum[kLanes] = {};
    for (const KnotRow::Term& term : row.terms) {
      const double* from = c + (first_c_[term.part] + term.output) * width;
      if (term.varied < 0) {
        for (int l = 0; l < count; ++l)
          if (to[l] >= 0) g[to[l]] += term.factor * from[l];
      } else {
        const double* factor = factors(group) + term.varied * width;
        for (int l = 0; l < width; ++l) sum[l] += factor[l] * from[l];
      }
    }
    for (int l = 0; row.is_varied() && l < count; ++l)
      if (to[l] >= 0) g[to[l]] += sum[l];
  }
}

// pull = G^T multipliers
void KernelNlp::pull_back(int group, const double* multipliers, double* pull) const {
  const int width = lanes(), count = knots_.knots_of(group);
  std::fill_n(pull, n_c_ * width, 0.0);
  for (const KnotRow& row : knot_rows_) {
    const int* from = row.row.data() + group * width;
    double given[kLanes] = {};
    for (int l = 0; row.is_varied() && l < count; ++l)
      if (from[l] >= 0) given[l] = multipliers[from[l]];
    for (const KnotRow::Term& term : row.terms) {
      double* to = pull + (first_c_[term.part] + term.output) * width;
      if (term.varied < 0) {
        for (int l = 0; l < count; ++l)
          if (from[l] >= 0) to[l] += term.factor * multipliers[from[l]];
      } else {
        const double* factor = factors(group) + term.varied * width;
        for (int l = 0; l < width; ++l) to[l] += factor[l] * given[l];
      }
    }
  }
}

double KernelNlp::evaluate(const double* x, double* g) {
  double f = 0.0;
  at_.assign(x, x + unknowns());
  std::fill_n(g, rows(), 0.0);
  for (int group = 0; group < knots_.groups(); ++group) {
    double *y = y_.data() + group * n_y_ * lanes(), *c = c_.data() + group * n_c_ * lanes();
    knots_.select(group, columns_, x, y);
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const double* arguments[] = {y + first_y_[p] * lanes(), parts_[p].parameters.data()};
      double* results[] = {c + first_c_[p] * lanes()};
      parts_[p].value(arguments, results, nullptr, nullptr, 0);
    }
    add_squares(group, f);
    add_outputs(group, c, g);
  }
  linear_.multiply(x, g);
  return f;
}

void KernelNlp::differentiate(const double* x, const double* multipliers, double scale) {
  if (at_.empty() || !std::equal(at_.begin(), at_.end(), x)) evaluate(x, row_values_.data());
  std::fill(gradient.begin(), gradient.end(), 0.0);
  for (int group = 0; group < knots_.groups(); ++group) {
    double* by_y = sum_y_.data();
    pull_back(group, multipliers, pull_.data() + group * n_c_ * lanes());
    std::fill_n(by_y, n_y_ * lanes(), 0.0);
    differentiate(group, scale, by_y);
    knots_.add_selected(group, columns_, by_y, gradient.data());
  }
}

void KernelNlp::differentiate(int group, double scale, double* by_y) {
  const int width = lanes();
  const double *w = knots_.weights(group), *c = c_.data() + group * n_c_ * width;
  const double* y = y_.data() + group * n_y_ * width;
  double *pull = pull_.data() + group * n_c_ * width, *slopes = slopes_.data() + group * n_slopes_ * width;
  double* curvatures = curvatures_.data() + group * n_curvatures_ * width;
  // The pull of the squares alone, whose product with the Jacobian is their gradient.
  double* square_pull = square_pull_.data();
  std::fill_n(square_pull, n_c_ * width, 0.0);
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const KernelPart& part = parts_[p];
    for (int j = 0; j < part.n_squared; ++j) {
      const Square& square = squared_[p][j];
      const int* row = knot_rows_[square.row].row.data() + group * width;
      for (int l = 0; l < knots_.knots_of(group); ++l) {
        // The square's 2 w c' c'^T in terms of rows of g, which are factor times c.
        const double value = c[square.output * width + l];
        const double weight = 2.0 * scale * w[l] * (value > 0.0 ? part.c_weight[j] : part.c_weight_below[j]);
        square_pull[square.output * width + l] = weight * value;
        pull[square.output * width + l] += square_pull[square.output * width + l];
        squares[row[l]] = weight / (square.factor * square.factor);
      }
    }
    const double* arguments[] = {y + first_y_[p] * width, part.parameters.data(), pull + first_c_[p] * width};
    double* results[] = {slopes + first_slope_[p] * width, curvatures + first_curvature_[p] * width};
    part.derivatives(arguments, results, nullptr, nullptr, 0);
    double* diagonal = curvatures + (first_curvature_[p] + static_cast<int>(part.curvature_row.size())) * width;
    for (int j = 0; j < part.columns.size(); ++j)
      for (int l = 0; l < width; ++l) {
        diagonal[j * width + l] = 2.0 * scale * w[l] * part.y_weight[j];
        by_y[(first_y_[p] + j) * width + l] = diagonal[j * width + l] * y[(first_y_[p] + j) * width + l];
      }
    for (std::size_t j = 0; j < part.range.size(); ++j) {
      const RangeTerm& term = part.range[j];
      const int at = (first_y_[p] + static_cast<int>(j)) * width;
      for (int l = 0; l < width; ++l) {
        const double away = y[at + l] - term.neutral, weight = scale * w[l];
        const int side = away > 0.0;
        by_y[at + l] += weight * (2.0 * term.square[side] + 4.0 * term.fourth[side] * away * away) * away;
        diagonal[j * width + l] += weight * (2.0 * term.square[side] + 12.0 * term.fourth[side] * away * away);
      }
    }
  }
  knots_.operations().multiply(by_jacobian_transposed_, slopes, square_pull, by_y);
}

void KernelNlp::multiply_jacobian(const double* x, double* y) {
  double *at_knot = other_y_.data(), *c = pull_.data();
  for (int group = 0; group < knots_.groups(); ++group) {
    knots_.select(group, columns_, x, at_knot);
    std::fill_n(c, n_c_ * lanes(), 0.0);
    knots_.operations().multiply(by_jacobian_, slopes(group), at_knot, c);
    add_outputs(group, c, y);
  }
  linear_.multiply(x, y);
}

void KernelNlp::multiply_jacobian_transposed(const double* x, double* y) {
  double *at_knot = other_y_.data(), *pull = pull_.data();
  for (int group = 0; group < knots_.groups(); ++group) {
    pull_back(group, x, pull);
    std::fill_n(at_knot, n_y_ * lanes(), 0.0);
    knots_.operations().multiply(by_jacobian_transposed_, slopes(group), pull, at_knot);
    knots_.add_selected(group, columns_, at_knot, y);
  }
  linear_.multiply_transposed(x, y);
}

void KernelNlp::multiply_hessian(const double* x, double* y) {
  double *at_knot = other_y_.data(), *sum = sum_y_.data();
  for (int group = 0; group < knots_.groups(); ++group) {
    knots_.select(group, columns_, x, at_knot);
    std::fill_n(sum, n_y_ * lanes(), 0.0);
    knots_.operations().multiply(by_hessian_, curvatures(group), at_knot, sum);
    knots_.add_selected(group, columns_, sum, y);
  }
}

void KernelNlp::row_sizes(double* sizes) const {
  const int width = lanes();
  linear_.row_sizes(sizes);
  for (int group = 0; group < knots_.groups(); ++group) {
    Vector largest(n_c_ * width, 0.0);  // of each output's slopes
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const KernelPart& part = parts_[p];
      const double* slope = slopes(group) + first_slope_[p] * width;
      for (std::size_t e = 0; e < part.jacobian_row.size(); ++e, slope += width) {
        double* at = largest.data() + (first_c_[p] + part.jacobian_row[e]) * width;
        const int order = part.columns.order(part.jacobian_column[e]);
        for (int l = 0; l < knots_.knots_of(group); ++l)
          at[l] = std::max(at[l], std::fabs(slope[l]) * knots_.reach(group, l, order));
      }
    }
    for (const KnotRow& row : knot_rows_)
      for (const KnotRow::Term& term : row.terms)
        for (int l = 0; l < knots_.knots_of(group); ++l) {
          const int r = row.row[group * width + l];
          const double factor = term.varied < 0 ? term.factor : factors(group)[term.varied * width + l];
          const double size = std::fabs(factor) * largest[(first_c_[term.part] + term.output) * width + l];
          if (r >= 0) sizes[r] = std::max(sizes[r], size);
        }
  }
}

bool KernelNlp::drop_curvature() {
  for (int group = 0; group < knots_.groups(); ++group)
    for (std::size_t p = 0; p < parts_.size(); ++p)
      std::fill_n(curvatures_.data() + (group * n_curvatures_ + first_curvature_[p]) * lanes(),
                  parts_[p].curvature_row.size() * lanes(), 0.0);
  return true;
}

std::vector<std::pair<int, int>> KernelNlp::coupled(const std::vector<std::vector<int>>& blocks) const {
  return KnotAssembly::coupled(*this, blocks);
}

std::unique_ptr<Assembly> KernelNlp::assembly(const BlockCholesky& storage) const {
  return std::make_unique<KnotAssembly>(*this, storage);
}

}  // namespace banded
