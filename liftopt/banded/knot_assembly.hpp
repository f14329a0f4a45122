// The condensed matrix of a problem of knots, H + J^T diag(d) J, summed over the knots in two stages.
//
// At a knot, in its own variables y (values and two derivatives of each coordinate, forces), the matrix is
// M = H_y + R^T R, where R is J_y with rows weighed by sqrt(d). Each coordinate's three variables are combinations of
// the same few control points, y = B p, so a pair of coordinates takes a 3 x 3 block of M and gives B^T M B, for
// several knots at once and without leaving the registers.
#pragma once

#include "kernel_nlp.hpp"

namespace banded {

class KnotAssembly : public Assembly {
 public:
  KnotAssembly(const KernelNlp& nlp, const BlockCholesky& storage);
  void add(const double* d, double* matrix) override;

  static std::vector<std::pair<int, int>> coupled(const KernelNlp& nlp, const std::vector<std::vector<int>>& blocks);

 private:
  // Entry (one, other) of a block of the matrix is at base + by_one one + by_other other.
  struct Place {
    int base = 0, by_one = 0, by_other = 0;
  };
  // What each row of a knot has entries for, and where they are kept.
  struct Support {
    bool all_orders = false;
    std::vector<int> coordinate, force;  // where, or -1
  };
  // d[row] weight, the products of two entries of a row of A.
  struct Linear {
    int row, place;
    double weight;
  };
  void plan_rows();
  void plan_pairs();
  void plan_places(const BlockCholesky& storage);
  void plan_linear(const BlockCholesky& storage);
  Pair& pair(Pair::Kind kind, int one, int other);
  void add_strip(int group, std::size_t first, std::size_t last, double* matrix) const;

  const KernelNlp& nlp_;
  const Knots& knots_;
  int lanes_, width_;
  std::vector<Support> supports_;
  std::vector<RowEntry> entries_;
  int n_entries_ = 0;
  std::vector<Pair> pairs_;            // those of one first variable together
  std::vector<std::size_t> strips_;    // the first pair of each, and the end
  std::vector<int> others_;            // the second variable of each pair
  std::vector<Place> places_, force_places_, own_places_;  // (knots, width, width); (knots, width); (knots,)
  std::vector<Linear> linear_;
  Aligned scale_, rows_, strip_;
};

}  // namespace banded
