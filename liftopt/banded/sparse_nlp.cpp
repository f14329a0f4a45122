#include "sparse_nlp.hpp"

#include <set>

namespace banded {
namespace {

class SparseAssembly : public Assembly {
 public:
  SparseAssembly(const SparseNlp& nlp, const BlockCholesky& storage) : nlp_(nlp) {
    const Sparse &h = nlp.hessian, &j = nlp.jacobian;
    for (int r = 0; r < h.rows; ++r)
      for (int k = h.start[r]; k < h.start[r + 1]; ++k) of_hessian_.push_back(storage.at(r, h.index[k]));
    for (int r = 0; r < j.rows; ++r)
      for (int k = j.start[r]; k < j.start[r + 1]; ++k)
        for (int l = j.start[r]; l <= k; ++l) of_products_.push_back(storage.at(j.index[k], j.index[l]));
  }

  void add(const double* d, double* matrix) override {
    const Sparse& j = nlp_.jacobian;
    for (std::size_t k = 0; k < of_hessian_.size(); ++k) matrix[of_hessian_[k]] += nlp_.hessian.value[k];
    const int* at = of_products_.data();
    for (int r = 0; r < j.rows; ++r)
      for (int k = j.start[r]; k < j.start[r + 1]; ++k) {
        const double weighted = d[r] * j.value[k];
        for (int l = j.start[r]; l <= k; ++l) matrix[*at++] += weighted * j.value[l];
      }
  }

 private:
  const SparseNlp& nlp_;
  std::vector<int> of_hessian_, of_products_;  // where each entry, and each product of two in a row, is stored
};

}  // namespace

SparseNlp::SparseNlp(Sparse jacobian_pattern, Sparse hessian_pattern)
    : jacobian(std::move(jacobian_pattern)), hessian(std::move(hessian_pattern)) {
  gradient.resize(jacobian.columns);
  squares.assign(jacobian.rows, 0.0);
}

std::vector<std::pair<int, int>> SparseNlp::coupled(const std::vector<std::vector<int>>& blocks) const {
  const std::vector<int> number = block_numbers(blocks, unknowns());
  std::set<std::pair<int, int>> pairs;
  for (int r = 0; r < hessian.rows; ++r)
    for (int k = hessian.start[r]; k < hessian.start[r + 1]; ++k) pairs.emplace(number[r], number[hessian.index[k]]);
  for (int r = 0; r < jacobian.rows; ++r) {
    std::set<int> touched;
    for (int k = jacobian.start[r]; k < jacobian.start[r + 1]; ++k) touched.insert(number[jacobian.index[k]]);
    for (int i : touched)
      for (int j : touched) pairs.emplace(i, j);
  }
  return {pairs.begin(), pairs.end()};
}

std::unique_ptr<Assembly> SparseNlp::assembly(const BlockCholesky& storage) const {
  return std::make_unique<SparseAssembly>(*this, storage);
}

}  // namespace banded
