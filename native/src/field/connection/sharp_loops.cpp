#include "field/connection/sharp_loops.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

namespace saddleback {
namespace {

/// Holds how far faces have to be turned about, from 0 downwards, and across which half-edge that was found.
class TurnSearch {
 public:
  TurnSearch(const Mesh& mesh, double limit, std::span<const double> turns)
      : mesh_(mesh),
        limit_(limit),
        turns_(turns),
        needed_(mesh.face_count(), 0.0),
        entered_by_(mesh.face_count(), k_none),
        is_taken_(mesh.face_count(), false) {}

  /// A loop around which no turning about helps, of faces that no earlier one has; empty without one.
  std::vector<Index> next(const std::vector<Index>& sharp) {
    clear();
    std::deque<Index> waiting(sharp.begin(), sharp.end());
    for (std::size_t visits = k_visits * sharp.size(); visits > 0 && !waiting.empty(); --visits) {
      const Index face = waiting.front();
      waiting.pop_front();
      if (is_taken_[face]) continue;
      for (Index h = 3 * face; h < 3 * face + 3; ++h) {
        if (!relax(h)) continue;
        const Index other = Mesh::face_of(mesh_.twin(h));
        if (std::vector<Index> loop = loop_into(other); !loop.empty()) return loop;
        waiting.push_back(other);
      }
    }
    return {};
  }

 private:
  static constexpr std::size_t k_visits = 1000;  // for each sharp face; most need a few

  void clear() {
    for (const Index face : touched_) needed_[face] = 0, entered_by_[face] = k_none;
    touched_.clear();
  }

  bool relax(Index h) {
    constexpr double k_rounding = 1e-9;
    const Index twin = mesh_.twin(h);
    if (twin == k_none || is_taken_[Mesh::face_of(twin)]) return false;
    const Index face = Mesh::face_of(h), other = Mesh::face_of(twin);
    const double needed = needed_[face] + limit_ - turns_[h];
    if (!(needed < needed_[other] - k_rounding * limit_)) return false;
    if (entered_by_[other] == k_none) touched_.push_back(other);
    needed_[other] = needed;
    entered_by_[other] = h;
    return true;
  }

  /// The loop that the last edge into this face closes, if it does; its faces are taken then.
  std::vector<Index> loop_into(Index face) {
    std::vector<Index> loop;
    for (Index at = face; entered_by_[at] != k_none;) {
      loop.push_back(entered_by_[at]);
      at = Mesh::face_of(entered_by_[at]);
      if (at != face) continue;
      std::reverse(loop.begin(), loop.end());
      for (const Index h : loop) is_taken_[Mesh::face_of(h)] = true;
      return loop;
    }
    return {};
  }

  const Mesh& mesh_;
  const double limit_;
  const std::span<const double> turns_;
  std::vector<double> needed_;
  std::vector<Index> entered_by_, touched_;
  std::vector<bool> is_taken_;
};

}  // namespace

std::vector<std::vector<Index>> sharp_loops(const Mesh& mesh, int symmetry, std::span<const double> turns) {
  const double limit = k_told_share * std::numbers::pi / symmetry;
  std::vector<Index> sharp;
  for (Index h = 0; h < mesh.halfedge_count(); ++h)
    if (turns[h] > limit) sharp.push_back(Mesh::face_of(h));
  std::vector<std::vector<Index>> result;
  if (sharp.empty()) return result;
  TurnSearch search(mesh, limit, turns);
  for (std::vector<Index> loop = search.next(sharp); !loop.empty(); loop = search.next(sharp))
    result.push_back(std::move(loop));
  return result;
}

}  // namespace saddleback
