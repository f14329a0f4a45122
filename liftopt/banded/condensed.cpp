#include "condensed.hpp"

#include <algorithm>

namespace banded {

Condensed::Condensed(const Nlp& nlp, const std::vector<std::vector<int>>& blocks)
    : cholesky_(blocks, nlp.coupled(blocks)), assembly_(nlp.assembly(cholesky_)) {
  matrix_.resize(cholesky_.storage());
  for (int i = 0; i < nlp.unknowns(); ++i) diagonal_.push_back(cholesky_.at(i, i));
}

void Condensed::hold(const std::vector<int>& held) {
  cleared_.clear();
  ones_.clear();
  for (int unknown : held) {
    cholesky_.add_places(unknown, cleared_);
    ones_.push_back(diagonal_[unknown]);
  }
}

void Condensed::assemble(const double* d, const double* s) {
  std::fill(matrix_.begin(), matrix_.end(), 0.0);
  assembly_->add(d, matrix_.data());
  for (std::size_t i = 0; i < diagonal_.size(); ++i) matrix_[diagonal_[i]] += s[i];
  for (int place : cleared_) matrix_[place] = 0.0;
  for (int place : ones_) matrix_[place] = 1.0;
}

}  // namespace banded
