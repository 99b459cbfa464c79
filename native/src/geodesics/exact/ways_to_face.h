#pragma once
// Shortest ways to many points of one face, or of a part of it.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/geodesics/exact_distances.h"

#include "geodesics/exact/exact_windows.h"

namespace saddleback {

/// The ways that are known to the points of a face: from sources in it, from its corners, through its edges. A corner
/// is taken as a point of the face like any other.
class WaysToFace {
 public:
  WaysToFace() = default;
  /// `nearest`: the sources of the mesh's vertices. The surface must outlive it. O(windows about the face).
  WaysToFace(const ExactSurface& surface, const ExactPropagation& propagation, const KeptWindows& windows,
             std::span<const Index> nearest, Index face);

  /// Finds the sources that reach a point of the face, by number, each with its shortest way: of the nearest source its
  /// distance, of others no less than that. O(size()).
  void at(const Vec3& barycentric, std::vector<ExactField::Way>& ways) const;
  /// Returns the nearest source of a point and its distance. O(size()).
  ExactField::Sight nearest_at(const Vec3& barycentric) const;
  /// Copies to `result` all that may be the shortest from its source somewhere in a triangle in the face. O(size()).
  void find_inside(const std::array<Vec3, 3>& corners, WaysToFace& result) const;
  std::size_t size() const { return ways_.size(); }
  std::size_t source_count() const { return sources_.size(); }

 private:
  struct Way {
    KeptWindow window;  ///< of one of the face's edges; endless from a source in it and from a corner
    double before;      ///< distance of the root
    Vec2 image;         ///< of the root, in the plane of ExactField::place_of
    Index source;       ///< among sources_
    std::int8_t edge;
  };
  using Places = std::array<Vec2, 3>;  ///< of a point in the frames of the edges
  Places places_of(const Vec3& barycentric) const;
  static WayThrough through(const Way& way, const Places& places) { return {way.window, way.before, places[way.edge]}; }

  const ExactSurface* surface_ = nullptr;
  Index first_ = 0;             ///< half-edge of the face
  std::vector<Index> sources_;  ///< by number
  std::vector<Way> ways_;
};

}  // namespace saddleback
