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

void extend(std::vector<Run>& runs, int from, int to) {
  if (!runs.empty() && runs.back().from + runs.back().length == from && runs.back().to + runs.back().length == to)
    ++runs.back().length;
  else
    runs.push_back({from, to, 1});
}

// Loops of equal lengths one after another cost no mispredicted branches.
void sort_by_length(std::vector<Run>& runs) {
  std::stable_sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.length < b.length; });
}

}  // namespace

Condensed::Condensed(const Sparse& hessian, const Sparse& jacobian, std::vector<std::vector<int>> blocks)
    : cholesky_(blocks, coupled_blocks(hessian, group_rows(jacobian), blocks)) {
  matrix_.resize(cholesky_.storage());
  for (int r = 0; r < hessian.rows; ++r) {
    diagonal_.push_back(cholesky_.at(r, r));
    for (int k = hessian.start[r]; k < hessian.start[r + 1]; ++k)
      extend(hessian_runs_, k, cholesky_.at(r, hessian.index[k]));
  }
  sort_by_length(hessian_runs_);
  int largest = 0, tallest = 0;
  for (const Group& group : group_rows(jacobian)) {
    Element element{group.first, group.last, static_cast<int>(group.columns.size()), {}, {}};
    // In the order in which K stores them, so that runs are long.
    std::vector<int> columns = group.columns;
    std::sort(columns.begin(), columns.end(), [&](int a, int b) { return cholesky_.before(a, b); });
    for (int k = jacobian.start[group.first]; k < jacobian.start[group.last]; ++k) {
      const auto found = std::find(columns.begin(), columns.end(), jacobian.index[k]);
      element.place.push_back(static_cast<int>(found - columns.begin()));
    }
    const int ld = padded(element.columns);
    for (int c = 0; c < element.columns; ++c)
      for (int r = c; r < element.columns; ++r)
        extend(element.runs, c * ld + r, cholesky_.at(columns[r], columns[c]));
    sort_by_length(element.runs);
    largest = std::max(largest, ld);
    tallest = std::max(tallest, group.last - group.first);
    elements_.push_back(std::move(element));
  }
  dense_.resize(largest * tallest);
  weighted_.resize(largest * tallest);
  product_.resize(largest * largest);
}

void Condensed::assemble(const Sparse& hessian, const Sparse& jacobian, const double* d, const double* s,
                         const std::vector<int>& held) {
  std::fill(matrix_.begin(), matrix_.end(), 0.0);
  add(hessian_runs_, hessian.value.data(), matrix_.data());
  for (std::size_t i = 0; i < diagonal_.size(); ++i) matrix_[diagonal_[i]] += s[i];
  for (const Element& element : elements_) {
    const int rows = element.last_row - element.first_row, ld = padded(element.columns);
    fill_rows(element, jacobian, d);
    if (rows * element.columns < kWorthwhile) {
      multiply_small(element);
    } else {
      std::fill_n(product_.data(), ld * ld, 0.0);
      dense_operations().multiply_add_lower(product_.data(), ld, weighted_.data(), ld, dense_.data(), ld, ld, rows);
    }
    add(element.runs, product_.data(), matrix_.data());
  }
  for (int unknown : held) cholesky_.isolate(unknown, matrix_.data());
}

bool Condensed::factorise(double delta) {
  std::copy(matrix_.begin(), matrix_.end(), cholesky_.values());
  for (int i : diagonal_) cholesky_.values()[i] += delta;
  return cholesky_.factorise();
}

void Condensed::fill_rows(const Element& element, const Sparse& jacobian, const double* d) {
  const int ld = padded(element.columns), first = element.first_row, rows = element.last_row - first;
  std::fill_n(dense_.data(), rows * ld, 0.0);
  std::fill_n(weighted_.data(), rows * ld, 0.0);
  const int* place = element.place.data();
  for (int r = 0; r < rows; ++r)
    for (int k = jacobian.start[first + r]; k < jacobian.start[first + r + 1]; ++k, ++place) {
      dense_[r * ld + *place] = jacobian.value[k];
      weighted_[r * ld + *place] = d[first + r] * jacobian.value[k];
    }
}

void Condensed::multiply_small(const Element& element) {
  const int ld = padded(element.columns), rows = element.last_row - element.first_row;
  for (int c = 0; c < element.columns; ++c)
    for (int i = c; i < element.columns; ++i) {
      double sum = 0.0;
      for (int r = 0; r < rows; ++r) sum += weighted_[r * ld + c] * dense_[r * ld + i];
      product_[c * ld + i] = sum;
    }
}

void Condensed::add(const std::vector<Run>& runs, const double* from, double* to) {
  for (const Run& run : runs)
    for (int i = 0; i < run.length; ++i) to[run.to + i] += from[run.from + i];
}

}  // namespace banded
