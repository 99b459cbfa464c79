#pragma once
// Polygons in space cut into triangles.

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

#include "predicates/plane_predicates.h"

namespace saddleback {

/// Cuts polygons into triangles between their corners, again and again in the same memory. Where all triangles of the
/// fan from some corner are turned alike (a convex polygon, most quads) that fan; elsewhere Delaunay's triangulation
/// constrained by the edges, in the plane across the mean normal (Newell), where all is decided exactly. An edge that
/// is gone there and back may lead to a hole. What only crosses itself by the rounding of a file passes for touching.
class PolygonTriangulator {
 public:
  /// Appends the triangles as vertices: n - 2 of them, but none that has a vertex twice. False when the polygon crosses
  /// itself or has no area: its triangles may overlap then. O(n) where there is a fan, else O(n log n) for usual
  /// polygons, quadratic at the worst. \throw Cancelled.
  bool triangulate(std::span<const Index> corners, std::span<const double> xyz, std::vector<Index>& triangles,
                   const JobStage& stage);

 private:
  using Point = predicates::Point2;
  using Sign = predicates::Sign;
  struct Box {
    double low_x, low_y, high_x, high_y;
    Index left;  ///< corners in it that are not cut off yet
  };

  Index count() const { return static_cast<Index>(points_.size()); }
  Sign turn(Index a, Index b, Index c) const { return turn(plane_[a], plane_[b], plane_[c]); }
  Sign turn(const Point& a, const Point& b, const Point& c) const;
  void lay_out(std::span<const Index> corners, std::span<const double> xyz);
  Vec3 mean_normal() const;
  bool fans_out(Index apex, const Vec3& normal) const;
  Index fan_apex(const Vec3& normal) const;
  void project(const Vec3& normal);

  bool clip_ears(const JobStage& stage);
  void begin_clipping();
  void grow_boxes();
  Index next_ear(Index start, const JobStage& stage);
  bool is_ear(Index corner) const;
  bool is_free(Index box, const std::array<Index, 3>& ear) const;
  bool misses(const Box& box, const std::array<Index, 3>& ear) const;
  bool blocks(Index corner, const std::array<Index, 3>& ear) const;
  Index flat_corner(Index start) const;
  void queue(Index corner) { queue_.emplace_back(corner, ++tickets_[corner]); }
  void cut(Index corner);
  void add_triangle(Index a, Index b, Index c);

  void make_delaunay(const JobStage& stage);
  bool is_better_flipped(Index h) const;
  void flip(Index h);
  void join(Index h, Index twin);

  std::vector<Vec3> points_;
  double largest_ = 0;  ///< the largest coordinate in the file, in the unit of the points
  double slack_ = 0;    ///< what is no farther from a line lies on it
  std::vector<Point> plane_;
  std::vector<Index> prev_, next_;      ///< in the polygon that is left; k_none for corners that are cut off
  std::vector<Index> behind_;           ///< for the edge after each corner: the half-edge of the triangle cut off there
  std::vector<Index> origins_, twins_;  ///< half-edge 3t+k: its corner and its other half, k_none at the rim
  std::vector<Box> boxes_;              ///< a binary tree over the corners in turn: the children of i are 2i and 2i+1
  Index first_leaf_ = 0;
  std::vector<std::pair<Index, Index>> queue_;  ///< corners that may be ears, each with its ticket
  std::size_t head_ = 0;
  std::vector<Index> tickets_;  ///< the last of each corner: earlier ones are void
  std::vector<Index> suspects_;
};

}  // namespace saddleback
