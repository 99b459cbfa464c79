#include "field/linear/coarsening.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "field/linear/row_blocks.h"
#include "support/hypotenuse.h"

namespace saddleback {
namespace {

constexpr double k_dominant = 10;        // a diagonal larger than this many times its row needs no coarse correction
constexpr double k_stronger = 1 + 1e-9;  // many are equal but for rounding, which must not say who pairs with whom
constexpr double k_weak = 0.5;           // of a node's strongest tie: others say nothing of how it varies
constexpr double k_stalled = 0.9;        // of the nodes left by pairing: weak ties are taken then
constexpr double k_loosest = 4;          // see is_too_loose; 8 in [napov2012]

/// The interpolation that takes a node's value to its neighbor across an entry of the matrix.
double transported(double) { return 1; }
std::complex<double> transported(const std::complex<double>& entry) { return -std::conj(entry) / std::abs(entry); }

/// Holds how firmly nodes are tied: the sizes of a matrix' entries, and of each row their sum and the largest.
struct Ties {
  UnsetArray<double> strength, sum, strongest;
};
double size_of(double value) { return std::abs(value); }
double size_of(const std::complex<double>& value) { return hypotenuse(value.real(), value.imag()); }

template <class Scalar>
Ties ties_of(const GraphMatrix<Scalar>& matrix, const JobStage& stage) {
  Ties result{UnsetArray<double>(matrix.values.size()), UnsetArray<double>(matrix.size()),
              UnsetArray<double>(matrix.size())};
  for_stretches(matrix.size(), stage, [&](Index begin, Index end) {
    for (Index i = begin; i < end; ++i) {
      double sum = 0, most = 0;
      for (Index k = matrix.begins[i]; k < matrix.begins[i + 1]; ++k) {
        const double strength = result.strength[k] = size_of(matrix.values[k]);
        sum += strength;
        most = std::max(most, strength);
      }
      result.sum[i] = sum;
      result.strongest[i] = most;
    }
  });
  return result;
}

/// Tells whether Gauss-Seidel on the finer level, on which two nodes have these sums of ties, evens them out so slowly
/// that they must stay apart: two triangles that are tied firmly move together, and their neighbors hardly move them.
/// After the quality of aggregates [napov2012].
bool is_too_loose(double tie, double of_one, double of_other) {
  return of_one * of_other > k_loosest * tie * (of_one + of_other);
}

/// Pairs the nodes of one level.
template <class Scalar>
class Pairing {
 public:
  /// `finer`: sums of the ties that each node has on a finer level, to compare with; zeros: pairs may be tied loosely.
  /// Ties below `weak` of a node's strongest count for nothing.
  Pairing(const GraphMatrix<Scalar>& matrix, const Ties& ties, UnsetArray<double> finer, double weak)
      : matrix_(matrix),
        ties_(ties),
        whole_(std::move(finer)),
        weak_(weak),
        leader_(matrix.size(), k_free),
        next_(matrix.size(), k_none),
        phase_(matrix.size(), Scalar(1)) {}

  /// Each node with the free neighbor that it is tied to most, unless either is tied much more to others: who takes a
  /// neighbor from its partner leaves that one to take another's, and so on all over the mesh. Those without one join
  /// the strongest neighbor's pair. Who finds no partner within its stretch but may beyond comes when all are done.
  Aggregates<Scalar> aggregates(const JobStage& stage) {
    const Index size = matrix_.size();
    for_stretches(size, stage, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        if (matrix_.diagonal[i] >= k_dominant * ties_.sum[i]) leader_[i] = k_none;
    });
    for_stretches(size, stage, [&](Index begin, Index end) {
      for (Index i = begin; i < end; ++i)
        if (leader_[i] == k_free) place(i, begin, end);
    });
    for (Index i = 0; i < size; ++i) {
      if (i % k_stretch == 0) stage.check();
      if (leader_[i] == k_free) place(i, 0, size);
    }
    Aggregates<Scalar> result;
    UnsetArray<Index> number(size);
    for (Index i = 0; i < size; ++i) {
      if (leader_[i] != i) continue;
      number[i] = result.count();
      result.leaders.push_back(i);
    }
    for_rows(0, size, 0, [&](Index i) {
      if (leader_[i] != k_none) leader_[i] = number[leader_[i]];
    });
    result.of = std::move(leader_);
    result.phase = std::move(phase_);
    result.next = std::move(next_);
    return result;
  }

 private:
  static constexpr Index k_free = -2;

  void place(Index i, Index begin, Index end) {
    Index free = k_none, joined = k_none;
    bool is_whole = true;
    for (Index k = matrix_.begins[i]; k < matrix_.begins[i + 1]; ++k) {
      const Index j = matrix_.columns[k];
      if (j < begin || j >= end) {
        is_whole = false;
        continue;
      }
      const double strength = ties_.strength[k];
      if (strength < weak_ * ties_.strongest[i] || leader_[j] == k_none) continue;
      if (is_too_loose(strength, whole_[i], whole_[leader_[j] >= 0 ? leader_[j] : j])) continue;
      const auto beats = [&](Index other) { return other == k_none || strength > k_stronger * ties_.strength[other]; };
      if (leader_[j] == k_free && strength >= weak_ * ties_.strongest[j] && beats(free)) free = k;
      if (leader_[j] >= 0 && beats(joined)) joined = k;
    }
    if (free != k_none) {
      const Index j = matrix_.columns[free];
      leader_[i] = leader_[j] = i;
      next_[i] = j;
      phase_[j] = transported(matrix_.values[free]);
      whole_[i] += whole_[j];
    } else if (is_whole && joined != k_none) {
      const Index j = matrix_.columns[joined];
      const Index leader = leader_[i] = leader_[j];
      next_[i] = std::exchange(next_[leader], i);
      whole_[leader] += whole_[i];
      phase_[i] = times(phase_[j], Scalar(conjugate(transported(matrix_.values[joined]))));
    } else if (is_whole) {
      leader_[i] = i;
    }
  }

  const GraphMatrix<Scalar>& matrix_;
  const Ties& ties_;
  UnsetArray<double> whole_;  ///< `finer` of each aggregate, where its leader is
  double weak_;
  UnsetArray<Index> leader_, next_;  ///< the node whose aggregate each belongs to; see Aggregates
  UnsetArray<Scalar> phase_;
};

/// Interpolation^H matrix interpolation.
template <class Scalar>
class Galerkin {
 public:
  Galerkin(const GraphMatrix<Scalar>& matrix, const Aggregates<Scalar>& aggregates)
      : matrix_(matrix), aggregates_(aggregates) {}

  GraphMatrix<Scalar> product(const JobStage& stage) const {
    const Index count = aggregates_.count(), stretches = (count + k_stretch - 1) / k_stretch;
    GraphMatrix<Scalar> coarse;
    coarse.begins.resize(count + 1);
    coarse.diagonal.resize(count);
    std::vector<Rows> parts(stretches);
    std::vector<std::vector<Index>> places(thread_count(0));  // where the row being made has each column
    parallel_for(stretches, static_cast<int>(places.size()), 1, [&](Index stretch, int thread) {
      stage.check();
      Rows& rows = parts[stretch];
      places[thread].resize(count, k_none);
      for (Index a = stretch * k_stretch; a < std::min(count, (stretch + 1) * k_stretch); ++a) {
        coarse.diagonal[a] = append_row(a, rows, places[thread]);
        coarse.begins[a + 1] = static_cast<Index>(rows.columns.size());
      }
      for (const Index column : rows.columns) places[thread][column] = k_none;
    });
    std::vector<Index> first(stretches + 1, 0);
    for (Index s = 0; s < stretches; ++s) first[s + 1] = first[s] + static_cast<Index>(parts[s].columns.size());
    coarse.columns.resize(first.back());
    coarse.values.resize(first.back());
    for_stretches(count, stage, [&](Index begin, Index end) {
      const Index stretch = begin / k_stretch;
      for (Index a = begin; a < end; ++a) coarse.begins[a + 1] += first[stretch];
      std::ranges::copy(parts[stretch].columns, coarse.columns.begin() + first[stretch]);
      std::ranges::copy(parts[stretch].values, coarse.values.begin() + first[stretch]);
    });
    return coarse;
  }

 private:
  struct Rows {
    std::vector<Index> columns;
    std::vector<Scalar> values;
  };

  /// Returns the diagonal.
  double append_row(Index a, Rows& rows, std::vector<Index>& place) const {
    const auto row = static_cast<Index>(rows.columns.size());
    double diagonal = 0;
    aggregates_.for_members(a, [&](Index i) {
      diagonal += matrix_.diagonal[i];
      for (Index k = matrix_.begins[i]; k < matrix_.begins[i + 1]; ++k) {
        const Index j = matrix_.columns[k], b = aggregates_.of[j];
        if (b < 0) continue;
        const Scalar entry = times(times(conjugate(aggregates_.phase[i]), matrix_.values[k]), aggregates_.phase[j]);
        if (b == a) {
          diagonal += std::real(entry);
        } else if (place[b] >= row) {
          rows.values[place[b]] += entry;
        } else {
          place[b] = static_cast<Index>(rows.columns.size());
          rows.columns.push_back(b);
          rows.values.push_back(entry);
        }
      }
    });
    return diagonal;
  }

  const GraphMatrix<Scalar>& matrix_;
  const Aggregates<Scalar>& aggregates_;
};

/// Appends as one step what two steps of pairing do.
template <class Scalar>
void append_step(Aggregates<Scalar>& first, const Aggregates<Scalar>& second) {
  UnsetArray<Index> leaders(second.count());
  for_rows(0, second.count(), 0, [&](Index a) {
    Index last = k_none;
    second.for_members(a, [&](Index pair) {
      (last == k_none ? leaders[a] : first.next[last]) = first.leaders[pair];
      first.for_members(pair, [&](Index i) { last = i; });
    });
  });
  first.leaders = std::move(leaders);
  for_rows(0, static_cast<Index>(first.of.size()), 0, [&](Index i) {
    if (first.of[i] < 0) return;
    first.phase[i] = times(first.phase[i], second.phase[first.of[i]]);
    first.of[i] = second.of[first.of[i]];
  });
}

}  // namespace

template <class Scalar>
Coarsening<Scalar> coarsened(const GraphMatrix<Scalar>& matrix, const JobStage& stage) {
  const Ties ties = ties_of(matrix, stage);
  const auto pairs = [&](double weak) {
    return Pairing<Scalar>(matrix, ties, UnsetArray<double>(matrix.size(), 0.0), weak).aggregates(stage);
  };
  Aggregates<Scalar> aggregates = pairs(k_weak);
  if (aggregates.count() > k_stalled * matrix.size()) aggregates = pairs(0);
  const GraphMatrix<Scalar> paired = Galerkin<Scalar>(matrix, aggregates).product(stage);
  UnsetArray<double> sums(aggregates.count(), 0.0);
  for_rows(0, aggregates.count(), 0,
           [&](Index a) { aggregates.for_members(a, [&](Index i) { sums[a] += ties.sum[i]; }); });
  const Aggregates<Scalar> second =
      Pairing<Scalar>(paired, ties_of(paired, stage), std::move(sums), k_weak).aggregates(stage);
  append_step(aggregates, second);
  return {std::move(aggregates), Galerkin<Scalar>(paired, second).product(stage)};
}

template Coarsening<double> coarsened(const GraphMatrix<double>&, const JobStage&);
template Coarsening<std::complex<double>> coarsened(const GraphMatrix<std::complex<double>>&, const JobStage&);

}  // namespace saddleback
