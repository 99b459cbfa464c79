#pragma once
// The sides of a cell in turn, to cut something by them.

#include <span>

#include "saddleback/voronoi2d/voronoi_2d.h"

#include "voronoi2d/diagram/circumcenter.h"
#include "voronoi2d/diagram/edge_curve.h"
#include "voronoi2d/diagram/power_center.h"

namespace saddleback::voronoi2d {

/// Straight sides of a cell, counter-clockwise: side k leads to vertex k. Two of them may be so nearly in line that the
/// distance of a place from one, rounded, says nothing about where it meets the other. The cell's vertices do.
class CellSides {
 public:
  CellSides(const Voronoi2d& diagram, Index site)
      : diagram_(diagram), site_(site), edges_(diagram.cell_edges(site)), vertices_(diagram.cell_vertices(site)) {}

  Index count() const { return static_cast<Index>(edges_.size()); }
  Index edge(Index k) const { return edges_[k]; }
  Index after(Index k) const { return k + 1 == count() ? 0 : k + 1; }
  Index before(Index k) const { return k == 0 ? count() - 1 : k - 1; }
  Index site() const { return site_; }
  /// Returns the site beyond a side.
  Index other(Index k) const {
    const auto [left, right] = diagram_.edge_sites[edges_[k]];
    return left == site_ ? right : left;
  }
  const Vec2& mine() const { return diagram_.sites[site_]; }
  const Vec2& neighbor(Index k) const { return diagram_.sites[other(k)]; }
  /// Returns where the line of a side crosses the line through its sites.
  Vec2 middle(Index k) const { return middle_between(diagram_, site_, other(k)); }

  /// Returns the vertex of the diagram, where one side goes on to the other; k_none for sides that are not next to each
  /// other.
  Index vertex_between(Index j, Index k) const {
    return after(j) == k ? vertices_[j] : after(k) == j ? vertices_[k] : k_none;
  }

  /// Compares the order of a place on the line of side j: 1 on the side itself, -1 beyond the vertex where side k
  /// follows or comes before, 0 elsewhere.
  int compare(const Vec2& place, Index j, Index k) const {
    const Vec2 across = neighbor(j) - mine(), along(-across.y(), across.x());
    const auto passed = [&](Index vertex) { return (place - diagram_.vertices[vertex]).dot(along); };
    const Index begin = vertices_[before(j)], end = vertices_[j];
    const bool is_early = begin != k_none && passed(begin) < 0, is_past = end != k_none && passed(end) > 0;
    if (!is_early && !is_past) return 1;
    return (is_past && after(j) == k) || (is_early && before(j) == k) ? -1 : 0;
  }

  /// Returns where the lines of two sides meet, both moved inwards by a distance.
  Vec2 meeting(Index j, Index k, double distance = 0) const {
    const Index vertex = vertex_between(j, k);
    Vec2 place = vertex != k_none ? diagram_.vertices[vertex] : center(site_, other(j), other(k));
    if (distance == 0) return place;
    const Vec2 a = (mine() - neighbor(j)).normalized(), b = (mine() - neighbor(k)).normalized();
    return place + distance / (1 + a.dot(b)) * (a + b);
  }

  /// A place on the way between others, which it is but for rounding, also where it is no number.
  static Vec2 place_between(const Vec2& from, const Vec2& place, const Vec2& to) {
    const Vec2 way = to - from;
    const double share = (place - from).dot(way);
    return share > 0 ? (share < way.squaredNorm() ? place : to) : from;
  }

 private:
  Vec2 center(Index a, Index b, Index c) const {
    const auto point = [&](Index site) {
      return predicates::Point2{diagram_.sites[site].x(), diagram_.sites[site].y()};
    };
    if (diagram_.powers.empty()) return circumcenter(point(a), point(b), point(c));
    const auto powered = [&](Index site) {
      return predicates::PowerPoint2{diagram_.sites[site].x(), diagram_.sites[site].y(), diagram_.powers[site]};
    };
    return power_center(powered(a), powered(b), powered(c));
  }

  const Voronoi2d& diagram_;
  Index site_;
  std::span<const Index> edges_, vertices_;
};

}  // namespace saddleback::voronoi2d
