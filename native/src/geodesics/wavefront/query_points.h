#pragma once
// Points of the surface whose distances a wave front is asked for beside those of the vertices.

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "saddleback/mesh/surface_points.h"

namespace saddleback {

/// Points by the faces that they lie in. Made once, read by any number of threads.
class WatchedPlaces {
 public:
  WatchedPlaces() = default;
  explicit WatchedPlaces(std::span<const SurfacePoint> points) : points_(points) {
    for (std::size_t i = 0; i < points.size(); ++i) by_face_.push_back({points[i].face, static_cast<Index>(i)});
    std::ranges::sort(by_face_);
    for (const SurfacePoint& point : points) may_hold_[block(point.face)] |= bit(point.face);
  }

  std::size_t size() const { return points_.size(); }
  /// Calls `visit(index, barycentric)` for every point given in the face.
  template <class Visit>
  void in_face(Index face, Visit&& visit) const {
    if (!(may_hold_[block(face)] & bit(face))) return;
    auto entry = std::ranges::lower_bound(by_face_, std::pair(face, Index{0}));
    for (; entry != by_face_.end() && entry->first == face; ++entry)
      visit(entry->second, points_[static_cast<std::size_t>(entry->second)].barycentric);
  }

 private:
  static std::size_t block(Index face) { return static_cast<std::size_t>(face) / 64 % 64; }
  static std::uint64_t bit(Index face) { return std::uint64_t{1} << (face & 63); }

  std::span<const SurfacePoint> points_;
  std::array<std::uint64_t, 64> may_hold_{};      ///< a bit for each face modulo 4096: most faces hold none
  std::vector<std::pair<Index, Index>> by_face_;  ///< face, index
};

/// Holds what a wave front has found of them.
class PlaceDistances {
 public:
  void reset(const WatchedPlaces* places) {
    places_ = places;
    distances_.assign(places ? places->size() : 0, std::numeric_limits<double>::infinity());
    labels_.assign(distances_.size(), 0);
  }
  bool empty() const { return distances_.empty(); }
  const WatchedPlaces& places() const { return *places_; }
  void offer(Index place, double distance, double label = 0) {
    if (distance >= distances_[place]) return;
    distances_[place] = distance;
    labels_[place] = label;
  }
  std::span<const double> values() const { return distances_; }
  /// RayLabel::value of rays from a point.
  std::span<const double> labels() const { return labels_; }

 private:
  const WatchedPlaces* places_ = nullptr;
  std::vector<double> distances_, labels_;
};

}  // namespace saddleback
