#pragma once
// A triangle cut along straight pieces.

#include <array>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

namespace saddleback {

/// Triangulates one triangle with points in or on it and straight pieces between them as edges. Points are weights of
/// the corners 1 and 2, so the corners are (0, 0), (1, 0) and (0, 1); what lies where is decided exactly. Used again
/// and again in the same memory.
class ConstrainedTriangulation {
 public:
  /// The bare triangle, its corners being points 0, 1 and 2. `shape` are the corners laid out flat: they only decide
  /// which of the possible triangulations is the best (Delaunay's, as far as the pieces let it).
  void begin(const std::array<Vec2, 3>& shape);

  /// The number of the point; that of an equal one when there is one. O(square root of n) for neighbors in turn, O(1)
  /// with a triangle near it.
  Index add(const Vec2& weights, Index near_triangle = k_none);

  /// Makes the straight piece an edge, or several where it passes points. False when it crosses an earlier one. `stage`
  /// may stop it, when the triangulation is none.
  bool connect(Index from, Index to, const JobStage& stage = {});

  /// Exchanges triangles until no edge but the pieces can be bettered. `stage` may stop it, when the triangulation is
  /// none.
  void improve(const JobStage& stage = {});

  std::size_t triangle_count() const { return origins_.size() / 3; }
  Triangle triangle(std::size_t t) const { return {origins_[3 * t], origins_[3 * t + 1], origins_[3 * t + 2]}; }
  /// The neighbor across edge k of triangle t, k_none across pieces and at the rim.
  Index neighbor(std::size_t t, int k) const {
    const auto h = static_cast<Index>(3 * t) + k;
    return fixed_[h] || twins_[h] == k_none ? k_none : twins_[h] / 3;
  }
  /// The other half of an edge, k_none at the rim.
  Index twin(Index h) const { return twins_[h]; }
  /// Half-edges along the edges that a piece became, in its direction, each in the triangle on its left.
  void edges_along(Index from, Index to, std::vector<Index>& halfedges) const;

 private:
  static Index next(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static Index prev(Index h) { return h % 3 == 0 ? h + 2 : h - 1; }
  Index to(Index h) const { return origins_[next(h)]; }
  Index apex(Index h) const { return origins_[prev(h)]; }
  int side(Index a, Index b, Index p) const;
  Index new_triangle(Index a, Index b, Index c);
  void join(Index h, Index twin);
  Index locate(Index point);
  void split_face(Index t, Index point);
  void split_edge(Index h, Index point);
  void legalise(const JobStage& stage = {});
  bool flip(Index h);
  bool is_better_flipped(Index h) const;
  Index find(Index from, Index to) const;
  Index first_out(Index vertex) const;
  Index toward(Index from, Index to) const;
  Index find_crossed(Index h, Index from, Index end);
  void clear_crossed(Index from, Index end, const JobStage& stage);

  std::array<Vec2, 3> shape_;
  std::vector<Vec2> weights_, places_;
  std::vector<Index> origins_, twins_, outs_;  ///< half-edge 3t+k: its begin and its twin; per point one that leaves it
  std::vector<std::uint8_t> fixed_;
  std::vector<Index> suspects_;  ///< half-edges that may have to be exchanged
  std::vector<std::array<Index, 2>> crossed_;
  Index last_ = 0;
};

}  // namespace saddleback
