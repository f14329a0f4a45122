// Sparse Cholesky factorisation of a symmetric matrix in blocks, eliminated in a given order.
//
// Unknowns are gathered in blocks; a block of the matrix is stored dense where it or its fill is not zero. Elimination
// goes block column by block column: the fill of column j is the clique of its rows, found once by the elimination
// tree (Liu 1990, "The role of elimination trees in sparse factorization"). A matrix banded in time stays banded.
#pragma once

#include <utility>
#include <vector>

#include "aligned.hpp"
#include "dense.hpp"

namespace banded {

class BlockCholesky {
 public:
  // `blocks`: the unknowns of each block, in the order of elimination; each unknown in one block.
  // `coupled`: pairs of blocks whose block of the matrix is not zero; the diagonal ones need not be among them.
  BlockCholesky(std::vector<std::vector<int>> blocks, const std::vector<std::pair<int, int>>& coupled);

  int size() const { return static_cast<int>(position_.size()); }

  // Where the entry (row, column) is stored: once, in the lower triangle by the order of elimination.
  int at(int row, int column) const;
  std::size_t storage() const { return values_.size(); }

  // Append the places of all entries in the row and the column of an unknown.
  void add_places(int unknown, std::vector<int>& places) const;

  // Factorise `matrix` + delta I, stored as the factors are; false where it is not positive definite.
  bool factorise(const double* matrix, double delta);

  // Solve with the factors, in place.
  void solve(double* x);

  // Multiplications of one factorisation, padding included: a measure that depends on no machine.
  double multiplications() const;

 private:
  struct Below {
    int block, offset;
    bool updated = false;  // before its own column is reached
  };
  // The target of an update; the first one takes it from the matrix.
  struct Update {
    int offset;
    bool first;
  };
  int find(int row, int column) const;
  Update plan_update(int row, int column);
  void fetch_diagonal(const double* matrix, double delta, int last);
  int stored(int block) const { return padded(static_cast<int>(blocks_[block].size())); }

  std::vector<std::vector<int>> blocks_;
  std::vector<std::pair<int, int>> position_;  // block and place in it, of each unknown
  std::vector<int> diagonal_, inverse_;        // offsets; a block column is stored whole, from its diagonal block on
  int fetched_ = 0;                            // diagonal blocks that are no longer those of the last matrix
  std::vector<std::vector<Below>> below_;
  std::vector<Update> updates_;  // of each column, in the order of use
  std::vector<int> first_;       // of each block in the permuted vector
  Aligned values_, inverses_, panel_, permuted_;
  const DenseOperations& dense_;
};

}  // namespace banded
