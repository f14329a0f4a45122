#include "knot_assembly.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>
#include <tuple>

namespace banded {
namespace {

// A variable of a knot: an order of a coordinate, or a force; of index -1 if it is always zero.
struct Variable {
  bool is_force;
  int index, order;
};

Variable variable(const PartColumns& columns, int y) {
  const int n = columns.coordinates;
  const int after = y - kOrders * n, forces = static_cast<int>(columns.forces.size());
  if (after >= forces) return {false, columns.others.at(after - forces), 0};
  if (after >= 0) return {true, columns.forces[after], 0};
  return {false, columns.first + y % n, y / n};
}

}  // namespace

KnotAssembly::KnotAssembly(const KernelNlp& nlp, const BlockCholesky& storage)
    : nlp_(nlp), knots_(nlp.knots()), lanes_(knots_.lanes()), width_(knots_.width()) {
  plan_rows();
  plan_pairs();
  plan_places(storage);
  plan_linear(storage);
  scale_.resize(nlp.knot_rows().size() * lanes_);
  rows_.resize(n_entries_ * lanes_);
  strip_.resize((knots_.coordinates() + knots_.forces()) * width_ * width_ * lanes_);
}

void KnotAssembly::plan_rows() {
  for (std::size_t t = 0; t < nlp_.knot_rows().size(); ++t) {
    Support support{false, std::vector<int>(knots_.coordinates(), -1), std::vector<int>(knots_.forces(), -1)};
    struct Slope {
      Variable at;
      int from, varied;
      double factor;
    };
    std::vector<Slope> slopes;
    for (const KnotRow::Term& term : nlp_.knot_rows()[t].terms) {
      const KernelPart& part = nlp_.parts()[term.part];
      for (std::size_t e = 0; e < part.jacobian_row.size(); ++e)
        if (part.jacobian_row[e] == term.output) {
          const Variable at = variable(part.columns, part.jacobian_column[e]);
          if (at.index < 0) continue;
          slopes.push_back({at, nlp_.first_slope(term.part) + static_cast<int>(e), term.varied, term.factor});
          support.all_orders |= at.order > 0;
        }
    }
    std::set<int> written;
    for (const Slope& slope : slopes) {
      int& place = (slope.at.is_force ? support.force : support.coordinate)[slope.at.index];
      if (place < 0) {
        place = n_entries_;
        n_entries_ += !slope.at.is_force && support.all_orders ? kOrders : 1;
      }
      const int to = place + slope.at.order;
      entries_.push_back({static_cast<int>(t), slope.from, to, slope.varied, slope.factor, written.insert(to).second});
    }
    supports_.push_back(std::move(support));
  }
}

Pair& KnotAssembly::pair(Pair::Kind kind, int one, int other) {
  const auto found = std::find_if(pairs_.begin(), pairs_.end(), [&](const Pair& p) {
    return p.kind == kind && p.one == one && p.other == other;
  });
  if (found != pairs_.end()) return *found;
  pairs_.push_back({kind, one, other, {}, {}, {}});
  return pairs_.back();
}

void KnotAssembly::plan_pairs() {
  const auto add_curvature = [&](Variable a, Variable b, int from) {
    if (a.index < 0 || b.index < 0) return;
    if (std::make_tuple(b.is_force, b.index) < std::make_tuple(a.is_force, a.index)) std::swap(a, b);
    if (a.is_force) {
      pair(Pair::forces, a.index, b.index).curvatures.push_back({0, from});
    } else if (b.is_force) {
      pair(Pair::coordinate_force, a.index, b.index).curvatures.push_back({a.order, from});
    } else {
      Pair& at = pair(Pair::coordinates, a.index, b.index);
      at.curvatures.push_back({kOrders * a.order + b.order, from});
      if (a.index == b.index && a.order != b.order) at.curvatures.push_back({kOrders * b.order + a.order, from});
    }
  };
  for (std::size_t p = 0; p < nlp_.parts().size(); ++p) {
    const KernelPart& part = nlp_.parts()[p];
    int from = nlp_.first_curvature(static_cast<int>(p));
    for (std::size_t e = 0; e < part.curvature_row.size(); ++e)
      add_curvature(variable(part.columns, part.curvature_row[e]), variable(part.columns, part.curvature_column[e]),
                    from++);
    for (int j = 0; j < part.columns.size(); ++j)
      add_curvature(variable(part.columns, j), variable(part.columns, j), from++);
  }
  for (const Support& row : supports_) {
    for (int i = 0; i < knots_.coordinates(); ++i) {
      if (row.coordinate[i] < 0) continue;
      const auto add = [&](Pair& at, int other) {
        (row.all_orders ? at.full : at.first).push_back({row.coordinate[i], other});
      };
      for (int j = i; j < knots_.coordinates(); ++j)
        if (row.coordinate[j] >= 0) add(pair(Pair::coordinates, i, j), row.coordinate[j]);
      for (int j = 0; j < knots_.forces(); ++j)
        if (row.force[j] >= 0) add(pair(Pair::coordinate_force, i, j), row.force[j]);
    }
    for (int i = 0; i < knots_.forces(); ++i)
      for (int j = i; j < knots_.forces(); ++j)
        if (row.force[i] >= 0 && row.force[j] >= 0)
          pair(Pair::forces, i, j).first.push_back({row.force[i], row.force[j]});
  }
  const auto order = [](const Pair& a) { return std::make_tuple(a.kind, a.one, a.other); };
  std::sort(pairs_.begin(), pairs_.end(), [&](const Pair& a, const Pair& b) { return order(a) < order(b); });
  for (std::size_t i = 0; i < pairs_.size(); ++i)
    if (i == 0 || pairs_[i].kind != pairs_[i - 1].kind || pairs_[i].one != pairs_[i - 1].one) strips_.push_back(i);
  strips_.push_back(pairs_.size());
  for (const Pair& pair : pairs_) others_.push_back(pair.other);
}

void KnotAssembly::plan_places(const BlockCholesky& storage) {
  const int n = knots_.coordinates(), m = knots_.forces();
  // `row` and `column` give the unknowns of a block by number; within a diagonal block one <= other is asked for.
  const auto place = [&](auto one, int ones, auto other, int others, bool diagonal) {
    Place found;
    found.base = storage.at(one(0), other(0));
    if (others > 1) found.by_other = storage.at(one(0), other(1)) - found.base;
    if (ones > 1)
      found.by_one = diagonal ? storage.at(one(1), other(1)) - found.base - found.by_other
                              : storage.at(one(1), other(0)) - found.base;
    for (int i = 0; i < ones; ++i)
      for (int j = diagonal ? i : 0; j < others; j += std::max(1, others - 1 - j))
        if (storage.at(one(i), other(j)) != found.base + i * found.by_one + j * found.by_other)
          throw std::invalid_argument("each block must hold the coordinates of a control point, or a knot's forces");
    return found;
  };
  for (int k = 0; k < knots_.knots(); ++k) {
    const auto force = [&](int j) { return knots_.force(k, j); };
    for (int p = 0; p < width_; ++p) {
      const auto one = [&](int i) { return knots_.control(knots_.first(k) + p, i); };
      for (int q = 0; q < width_; ++q) {
        const auto other = [&](int j) { return knots_.control(knots_.first(k) + q, j); };
        places_.push_back(place(one, n, other, n, p == q));
      }
      force_places_.push_back(m ? place(one, n, force, m, false) : Place{});
    }
    own_places_.push_back(m ? place(force, m, force, m, true) : Place{});
  }
}

void KnotAssembly::plan_linear(const BlockCholesky& storage) {
  const Sparse& a = nlp_.linear();
  for (int r = 0; r < a.rows; ++r)
    for (int i = a.start[r]; i < a.start[r + 1]; ++i)
      for (int j = a.start[r]; j <= i; ++j)
        linear_.push_back({r, storage.at(a.index[i], a.index[j]), a.value[i] * a.value[j]});
}

std::vector<std::pair<int, int>> KnotAssembly::coupled(const KernelNlp& nlp,
                                                       const std::vector<std::vector<int>>& blocks) {
  const std::vector<int> number = block_numbers(blocks, nlp.unknowns());
  const Knots& knots = nlp.knots();
  std::set<std::pair<int, int>> pairs;
  const auto couple = [&](const std::set<int>& touched) {
    for (int i : touched)
      for (int j : touched) pairs.emplace(i, j);
  };
  for (int k = 0; k < knots.knots(); ++k) {
    std::set<int> touched;
    for (int p = 0; p < knots.width(); ++p)
      for (int i = 0; i < knots.coordinates(); ++i) touched.insert(number[knots.control(knots.first(k) + p, i)]);
    for (int j = 0; j < knots.forces(); ++j) touched.insert(number[knots.force(k, j)]);
    couple(touched);
  }
  const Sparse& a = nlp.linear();
  for (int r = 0; r < a.rows; ++r) {
    std::set<int> touched;
    for (int e = a.start[r]; e < a.start[r + 1]; ++e) touched.insert(number[a.index[e]]);
    couple(touched);
  }
  return {pairs.begin(), pairs.end()};
}

void KnotAssembly::add(const double* d, double* matrix) {
  const LaneOperations& operations = knots_.operations();
  for (int group = 0; group < knots_.groups(); ++group) {
    for (std::size_t t = 0; t < supports_.size(); ++t) {
      const int* row = nlp_.knot_rows()[t].row.data() + group * lanes_;
      for (int l = 0; l < lanes_; ++l)
        scale_[t * lanes_ + l] = l < knots_.knots_of(group) && row[l] >= 0 ? std::sqrt(d[row[l]]) : 0.0;
    }
    operations.fill_rows(entries_.data(), static_cast<int>(entries_.size()), scale_.data(), nlp_.factors(group),
                         nlp_.slopes(group), rows_.data());
    for (std::size_t s = 0; s + 1 < strips_.size(); ++s) {
      double* entries = strip_.data();
      for (std::size_t i = strips_[s]; i < strips_[s + 1]; ++i, entries += width_ * width_ * lanes_)
        operations.condense(pairs_[i], knots_.basis(group), width_, nlp_.curvatures(group), rows_.data(), entries);
      add_strip(group, strips_[s], strips_[s + 1], matrix);
    }
  }
  for (const Linear& product : linear_) matrix[product.place] += d[product.row] * product.weight;
}

// Add the entries of the pairs first .. last, which share their first variable.
void KnotAssembly::add_strip(int group, std::size_t first, std::size_t last, double* matrix) const {
  const Pair& head = pairs_[first];
  const int stride = width_ * width_ * lanes_, one = head.one;
  const auto add = [&](const Place& place, const double* entry, std::size_t begin) {
    double* to = matrix + place.base + one * place.by_one;
    entry += (begin - first) * stride;
    for (std::size_t i = begin; i < last; ++i, entry += stride) to[others_[i] * place.by_other] += *entry;
  };
  for (int l = 0; l < knots_.knots_of(group); ++l) {
    const int knot = group * lanes_ + l;
    const double* entry = strip_.data() + l;
    if (head.kind == Pair::forces) {
      add(own_places_[knot], entry, first);
      continue;
    }
    for (int p = 0; p < width_; ++p) {
      if (head.kind == Pair::coordinate_force) {
        add(force_places_[knot * width_ + p], entry + p * lanes_, first);
        continue;
      }
      for (int q = 0; q < width_; ++q) {
        // Of a coordinate with itself, (p, q) and (q, p) are one entry of the matrix.
        const bool twice = head.other == one && q > p;
        add(places_[(knot * width_ + p) * width_ + q], entry + (p * width_ + q) * lanes_, first + twice);
      }
    }
  }
}

}  // namespace banded
