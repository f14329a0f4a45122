#include "block_cholesky.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>
#include <stdexcept>
#include <utility>

namespace banded {
namespace {

// A pivot below this counts as not positive.
constexpr double kSmallestPivot = 1e-14;

}  // namespace

BlockCholesky::BlockCholesky(std::vector<std::vector<int>> blocks, const std::vector<std::pair<int, int>>& coupled)
    : blocks_(std::move(blocks)), dense_(dense_operations()) {
  const int count = static_cast<int>(blocks_.size());
  std::size_t unknowns = 0;
  for (const auto& block : blocks_) unknowns += block.size();
  position_.assign(unknowns, {-1, -1});
  for (int b = 0; b < count; ++b)
    for (std::size_t i = 0; i < blocks_[b].size(); ++i) {
      if (blocks_[b][i] < 0 || blocks_[b][i] >= size() || position_[blocks_[b][i]].first != -1)
        throw std::invalid_argument("the blocks must hold every unknown once");
      position_[blocks_[b][i]] = {b, static_cast<int>(i)};
    }

  std::vector<std::set<int>> rows(count);
  for (auto [i, j] : coupled)
    if (i != j) rows[std::min(i, j)].insert(std::max(i, j));
  for (int j = 0; j < count; ++j)
    if (!rows[j].empty()) {
      const int parent = *rows[j].begin();
      rows[parent].insert(std::next(rows[j].begin()), rows[j].end());
    }

  int offset = 0, inverse_offset = 0, permuted = 0, tallest = 0;
  for (int j = 0; j < count; ++j) {
    const int n = stored(j);
    first_.push_back(permuted);
    permuted += n;
    tallest = std::max(tallest, n);
    diagonal_.push_back(offset);
    offset += n * n;
    inverse_.push_back(inverse_offset);
    inverse_offset += n * n;
    below_.emplace_back();
    for (int i : rows[j]) {
      below_[j].push_back({i, offset, false});
      offset += stored(i) * n;
    }
  }
  for (int j = 0; j < count; ++j)
    for (std::size_t k = 0; k < below_[j].size(); ++k)
      for (std::size_t i = k; i < below_[j].size(); ++i)
        updates_.push_back(plan_update(below_[j][i].block, below_[j][k].block));
  values_.resize(offset);
  inverses_.resize(inverse_offset);
  panel_.resize(tallest * tallest);
  permuted_.resize(permuted);
}

BlockCholesky::Update BlockCholesky::plan_update(int row, int column) {
  for (Below& below : below_[column])
    if (below.block == row) return {below.offset, !std::exchange(below.updated, true)};
  return {find(row, column), false};  // a diagonal block, which is fetched
}

int BlockCholesky::find(int row, int column) const {
  if (row == column) return diagonal_[row];
  for (const Below& below : below_[column])
    if (below.block == row) return below.offset;
  throw std::invalid_argument("an entry outside the pattern");
}

int BlockCholesky::at(int row, int column) const {
  auto low = position_[row], high = position_[column];
  if (low < high) std::swap(low, high);
  return find(low.first, high.first) + high.second * stored(low.first) + low.second;
}

void BlockCholesky::add_places(int unknown, std::vector<int>& places) const {
  const auto [block, place] = position_[unknown];
  const int n = stored(block);
  for (int i = 0; i < n; ++i) {
    places.push_back(diagonal_[block] + place * n + i);
    places.push_back(diagonal_[block] + i * n + place);
  }
  for (const Below& below : below_[block])
    for (int i = 0; i < stored(below.block); ++i) places.push_back(below.offset + place * stored(below.block) + i);
  for (int j = 0; j < block; ++j)
    for (const Below& below : below_[j])
      if (below.block == block)
        for (std::size_t i = 0; i < blocks_[j].size(); ++i)
          places.push_back(below.offset + static_cast<int>(i) * n + place);
}

// Copy diagonal blocks up to `last` from the matrix. The other blocks are read from it when they are first needed: a
// factorisation that fails has not read the rest.
void BlockCholesky::fetch_diagonal(const double* matrix, double delta, int last) {
  for (; fetched_ <= last; ++fetched_) {
    const int n = stored(fetched_), first = diagonal_[fetched_];
    std::copy_n(matrix + first, n * n, values_.begin() + first);
    for (std::size_t i = 0; i < blocks_[fetched_].size(); ++i) values_[first + i * (n + 1)] += delta;
  }
}

bool BlockCholesky::factorise(const double* matrix, double delta) {
  auto update = updates_.begin();
  double* values = values_.data();
  fetched_ = 0;
  for (std::size_t j = 0; j < blocks_.size(); ++j) {
    fetch_diagonal(matrix, delta, below_[j].empty() ? static_cast<int>(j) : below_[j].back().block);
    const int n = static_cast<int>(blocks_[j].size()), ld = stored(static_cast<int>(j));
    double* inverse = inverses_.data() + inverse_[j];
    if (!dense_.factorise(values + diagonal_[j], ld, n, inverse, kSmallestPivot)) return false;
    for (const Below& below : below_[j]) {
      const double* from = below.updated ? values : matrix;
      const int rows = stored(below.block);
      dense_.multiply_triangular(values + below.offset, rows, from + below.offset, rows, inverse, ld, rows, n);
    }
    for (std::size_t k = 0; k < below_[j].size(); ++k) {
      const double* right = values + below_[j][k].offset;
      const int columns = stored(below_[j][k].block);
      dense_.subtract_square(values + update++->offset, columns, right, columns, columns, n);
      for (std::size_t i = k + 1; i < below_[j].size(); ++i, ++update) {
        const double *left = values + below_[j][i].offset, *from = update->first ? matrix : values;
        const int rows = stored(below_[j][i].block), target = update->offset;
        dense_.subtract_product(values + target, rows, from + target, left, rows, right, columns, rows, columns, n);
      }
    }
  }
  return true;
}

void BlockCholesky::solve(double* x) {
  std::fill(permuted_.begin(), permuted_.end(), 0.0);
  const int count = static_cast<int>(blocks_.size());
  for (int b = 0; b < count; ++b)
    for (std::size_t i = 0; i < blocks_[b].size(); ++i) permuted_[first_[b] + i] = x[blocks_[b][i]];
  for (int j = 0; j < count; ++j) {
    const int n = static_cast<int>(blocks_[j].size()), ld = stored(j);
    double* own = permuted_.data() + first_[j];
    std::memcpy(panel_.data(), own, sizeof(double) * ld);
    std::fill_n(own, ld, 0.0);
    dense_.multiply_vector(own, inverses_.data() + inverse_[j], ld, ld, n, panel_.data(), 1.0);
    for (const Below& below : below_[j])
      dense_.multiply_vector(permuted_.data() + first_[below.block], values_.data() + below.offset,
                             stored(below.block), stored(below.block), n, own, -1.0);
  }
  for (int j = count - 1; j >= 0; --j) {
    const int n = static_cast<int>(blocks_[j].size()), ld = stored(j);
    double* own = permuted_.data() + first_[j];
    for (const Below& below : below_[j])
      dense_.multiply_transposed(own, values_.data() + below.offset, stored(below.block), stored(below.block), n,
                                 permuted_.data() + first_[below.block], -1.0);
    std::memcpy(panel_.data(), own, sizeof(double) * ld);
    std::fill_n(own, ld, 0.0);
    dense_.multiply_transposed(own, inverses_.data() + inverse_[j], ld, ld, n, panel_.data(), 1.0);
  }
  for (int b = 0; b < count; ++b)
    for (std::size_t i = 0; i < blocks_[b].size(); ++i) x[blocks_[b][i]] = permuted_[first_[b] + i];
}

double BlockCholesky::multiplications() const {
  double sum = 0.0;
  for (std::size_t j = 0; j < blocks_.size(); ++j) {
    const double n = static_cast<double>(blocks_[j].size());
    double below = 0.0;
    for (const Below& b : below_[j]) below += stored(b.block);
    sum += n * n * n / 3 + below * n * n + below * below * n / 2;
  }
  return sum;
}

}  // namespace banded
