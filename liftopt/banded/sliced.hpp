// A fixed sparse matrix with many short rows, laid out for products: rows sorted by length, kLanes of them abreast.
//
// Sliced ELLPACK (Monakov, Lokhmotov and Avetisyan 2010): a loop over rows of two to ten entries costs mispredicted
// branches above all; here neighbouring rows have equal lengths.
#pragma once

#include <algorithm>
#include <numeric>

#include "dense.hpp"
#include "sparse.hpp"

namespace banded {

class Sliced {
 public:
  Sliced() = default;

  explicit Sliced(const Sparse& matrix) : columns_(matrix.columns), order_(matrix.rows) {
    const auto length = [&](int r) { return matrix.start[r + 1] - matrix.start[r]; };
    std::iota(order_.begin(), order_.end(), 0);
    std::stable_sort(order_.begin(), order_.end(), [&](int a, int b) { return length(a) > length(b); });
    order_.resize(padded(matrix.rows), -1);
    start_.push_back(0);
    for (std::size_t first = 0; first < order_.size(); first += kLanes) {
      const int longest = length(order_[first]);
      for (int e = 0; e < longest; ++e)
        for (int l = 0; l < kLanes; ++l) {
          const int row = order_[first + l];
          const bool has = row >= 0 && e < length(row);
          index_.push_back(has ? matrix.index[matrix.start[row] + e] : 0);
          value_.push_back(has ? matrix.value[matrix.start[row] + e] : 0.0);
        }
      start_.push_back(static_cast<int>(index_.size()) / kLanes);
    }
  }

  int columns() const { return columns_; }

  // y += A x
  void multiply(const double* x, double* y) const {
    alignas(64) double sums[kLanes];
    const auto gather = dense_operations().gather;
    for (std::size_t slice = 0; slice + 1 < start_.size(); ++slice) {
      gather(sums, value_.data() + start_[slice] * kLanes, index_.data() + start_[slice] * kLanes,
             start_[slice + 1] - start_[slice], x);
      for (int l = 0; l < kLanes; ++l)
        if (const int row = order_[slice * kLanes + l]; row >= 0) y[row] += sums[l];
    }
  }

 private:
  int columns_ = 0;
  std::vector<int> order_, start_, index_;  // row of each lane; first entry of each slice; columns
  Aligned value_;
};

}  // namespace banded
