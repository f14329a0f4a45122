// A sparse matrix in compressed rows.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "aligned.hpp"

namespace banded {

struct Sparse {
  int rows = 0, columns = 0;
  std::vector<int> start, index;
  Vector value;

  int nonzeros() const { return static_cast<int>(index.size()); }

  // y += A x
  void multiply(const double* x, double* y) const {
    for (int r = 0; r < rows; ++r) {
      // Two sums, since each addition waits for the one before.
      double sum = 0.0, other = 0.0;
      int k = start[r];
      for (; k + 1 < start[r + 1]; k += 2) {
        sum += value[k] * x[index[k]];
        other += value[k + 1] * x[index[k + 1]];
      }
      if (k < start[r + 1]) sum += value[k] * x[index[k]];
      y[r] += sum + other;
    }
  }

  // y += A^T x
  void multiply_transposed(const double* x, double* y) const {
    for (int r = 0; r < rows; ++r) {
      const double factor = x[r];
      if (factor == 0.0) continue;
      for (int k = start[r]; k < start[r + 1]; ++k) y[index[k]] += value[k] * factor;
    }
  }

  // The largest entry of each row without its sign, if it is larger than what is there.
  void row_sizes(double* sizes) const {
    for (int r = 0; r < rows; ++r)
      for (int k = start[r]; k < start[r + 1]; ++k) sizes[r] = std::max(sizes[r], std::fabs(value[k]));
  }

  // y += A x where these are the entries on and above the diagonal of a symmetric matrix
  void multiply_symmetric(const double* x, double* y) const {
    for (int r = 0; r < rows; ++r) {
      double sum = 0.0;
      const double factor = x[r];
      for (int k = start[r]; k < start[r + 1]; ++k) {
        const int c = index[k];
        sum += value[k] * x[c];
        if (c != r) y[c] += value[k] * factor;
      }
      y[r] += sum;
    }
  }
};

}  // namespace banded
