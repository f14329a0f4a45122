#include "condensed.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

namespace banded {
namespace {

// Rows share an element while their union has at most this many times the columns of the sparsest of them.
constexpr double kLoosest = 1.3;
// Elements with fewer entries than this are added one by one.
constexpr int kWorthwhile = 32;

struct Group {
  int first, last;
  std::vector<int> columns;
};

std::vector<Group> group_rows(const Sparse& jacobian) {
  std::vector<Group> groups;
  std::size_t sparsest = 0;
  for (int r = 0; r < jacobian.rows; ++r) {
    const std::vector<int> row(jacobian.index.begin() + jacobian.start[r],
                               jacobian.index.begin() + jacobian.start[r + 1]);
    if (!groups.empty()) {
      Group& group = groups.back();
      std::vector<int> both;
      std::set_union(group.columns.begin(), group.columns.end(), row.begin(), row.end(), std::back_inserter(both));
      const std::size_t fewest = std::min(sparsest, row.size());
      if (both.size() <= kLoosest * fewest) {
        group.last = r + 1;
        group.columns = std::move(both);
        sparsest = fewest;
        continue;
      }
    }
    groups.push_back({r, r + 1, row});
    sparsest = row.size();
  }
  return groups;
}

std::vector<std::pair<int, int>> coupled_blocks(const Sparse& hessian, const std::vector<Group>& groups,
                                                const std::vector<std::vector<int>>& blocks) {
  std::vector<int> block_of(hessian.columns);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    for (int unknown : blocks[b]) block_of.at(unknown) = static_cast<int>(b);
  std::set<std::pair<int, int>> coupled;
  for (int r = 0; r < hessian.rows; ++r)
    for (int k = hessian.start[r]; k < hessian.start[r + 1]; ++k)
      coupled.emplace(block_of[r], block_of[hessian.index[k]]);
  for (const Group& group : groups) {
    std::set<int> touched;
    for (int column : group.columns) touched.insert(block_of[column]);
    for (int i : touched)
      for (int j : touched) coupled.emplace(i, j);
  }
  return {coupled.begin(), coupled.end()};
}

}  // namespace

Condensed::Condensed(const Sparse& hessian, const Sparse& jacobian, std::vector<std::vector<int>> blocks)
    : cholesky_(blocks, coupled_blocks(hessian, group_rows(jacobian), blocks)) {
  for (int r = 0; r < hessian.rows; ++r) {
    diagonal_target_.push_back(cholesky_.at(r, r));
    for (int k = hessian.start[r]; k < hessian.start[r + 1]; ++k)
      hessian_target_.push_back(cholesky_.at(r, hessian.index[k]));
  }
  int largest = 0, tallest = 0;
  for (const Group& group : group_rows(jacobian)) {
    Element element{group.first, group.last, static_cast<int>(group.columns.size()), {}, {}};
    for (int k = jacobian.start[group.first]; k < jacobian.start[group.last]; ++k) {
      const auto found = std::lower_bound(group.columns.begin(), group.columns.end(), jacobian.index[k]);
      element.place.push_back(static_cast<int>(found - group.columns.begin()));
    }
    for (int c = 0; c < element.columns; ++c)
      for (int r = c; r < element.columns; ++r)
        element.target.push_back(cholesky_.at(group.columns[r], group.columns[c]));
    largest = std::max(largest, padded(element.columns));
    tallest = std::max(tallest, group.last - group.first);
    elements_.push_back(std::move(element));
  }
  dense_.resize(largest * tallest);
  weighted_.resize(largest * tallest);
  product_.resize(largest * largest);
}

void Condensed::assemble(const Sparse& hessian, const Sparse& jacobian, const double* d, const double* s,
                         const std::vector<int>& held) {
  cholesky_.clear();
  double* values = cholesky_.values();
  for (int k = 0; k < hessian.nonzeros(); ++k) values[hessian_target_[k]] += hessian.value[k];
  for (std::size_t i = 0; i < diagonal_target_.size(); ++i) values[diagonal_target_[i]] += s[i];
  for (const Element& element : elements_) {
    const int rows = element.last_row - element.first_row;
    if (rows * element.columns < kWorthwhile)
      add_sparse(element, jacobian, d);
    else
      add_dense(element, jacobian, d);
  }
  for (int unknown : held) cholesky_.isolate(unknown);
}

void Condensed::add_sparse(const Element& element, const Sparse& jacobian, const double* d) {
  double* values = cholesky_.values();
  int k = 0;
  for (int r = element.first_row; r < element.last_row; ++r) {
    double* row = dense_.data();
    std::fill_n(row, element.columns, 0.0);
    for (int e = jacobian.start[r]; e < jacobian.start[r + 1]; ++e) row[element.place[k++]] = jacobian.value[e];
    int entry = 0;
    for (int c = 0; c < element.columns; ++c)
      for (int i = c; i < element.columns; ++i) values[element.target[entry++]] += d[r] * row[c] * row[i];
  }
}

void Condensed::add_dense(const Element& element, const Sparse& jacobian, const double* d) {
  const int rows = element.last_row - element.first_row, ld = padded(element.columns);
  std::fill_n(dense_.data(), rows * ld, 0.0);
  std::fill_n(product_.data(), ld * ld, 0.0);
  int k = 0;
  for (int r = 0; r < rows; ++r) {
    double *row = dense_.data() + r * ld, *weighted = weighted_.data() + r * ld;
    const int at = element.first_row + r;
    for (int e = jacobian.start[at]; e < jacobian.start[at + 1]; ++e) row[element.place[k++]] = jacobian.value[e];
    for (int i = 0; i < ld; ++i) weighted[i] = d[at] * row[i];
  }
  dense_operations().multiply_add(product_.data(), ld, weighted_.data(), ld, dense_.data(), ld, ld, ld, rows, 1.0);
  double* values = cholesky_.values();
  const int* target = element.target.data();
  for (int c = 0; c < element.columns; ++c) {
    const double* column = product_.data() + c * ld;
    for (int i = c; i < element.columns; ++i) values[*target++] += column[i];
  }
}

}  // namespace banded
