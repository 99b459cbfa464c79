#pragma once
// The parts of a diagram's straight edges within a domain.

#include <algorithm>
#include <vector>

#include "saddleback/voronoi2d/voronoi_2d.h"

#include "voronoi2d/clipping/domain_map.h"
#include "voronoi2d/diagram/edge_curve.h"

namespace saddleback::voronoi2d {

/// Finds them edge by edge, to rounding.
class EdgesWithin {
 public:
  EdgesWithin(const Voronoi2d& diagram, const PlanarDomain& domain, const DomainMap& map)
      : diagram_(diagram), domain_(domain), map_(map) {
    Vec2 low = domain.loops()[0][0], high = low;
    for (const Vec2& corner : domain.loops()[0]) low = low.cwiseMin(corner), high = high.cwiseMax(corner);
    middle_ = 0.5 * low + 0.5 * high;
    reach_ = (high - low).norm();
  }

  /// Calls visit(from, to) for each part of an edge. O(1), for edges near the domain's sides O(corners of the domain).
  template <class Visit>
  void for_parts(Index edge, const Visit& visit) const {
    const auto [left, right] = diagram_.edge_sites[edge];
    const auto [first, second] = diagram_.edges[edge];
    const Vec2 across = (diagram_.sites[right] - diagram_.sites[left]).stableNormalized(),
               along(-across.y(), across.x()), foot = middle_between(diagram_, left, right),
               begin =
                   foot + (middle_ - foot).dot(along) * along;  // of the edge's line, nearest to the domain's middle
    const auto place = [&](Index vertex, double infinite) {
      return vertex == k_none ? infinite : std::clamp((diagram_.vertices[vertex] - begin).dot(along), -reach_, reach_);
    };
    const double from = place(first, -reach_), to = place(second, reach_);
    if (from < to) for_parts(begin, along, across, from, to, visit);
  }

  /// Does the same for the parts of a straight way between two points.
  template <class Visit>
  void for_parts(const Vec2& a, const Vec2& b, const Visit& visit) const {
    const Vec2 along = (b - a).stableNormalized();
    if (a != b) for_parts(a, along, Vec2(along.y(), -along.x()), 0, (b - a).dot(along), visit);
  }

  /// Returns more than the distance of two sites from any point of the domain.
  double farthest(const Vec2& p, const Vec2& q) const {
    return std::max((p - middle_).norm(), (q - middle_).norm()) + reach_;
  }

 private:
  template <class Visit>
  void for_parts(const Vec2& begin, const Vec2& along, const Vec2& across, double from, double to,
                 const Visit& visit) const {
    const Vec2 a = begin + from * along, b = begin + to * along;
    const DomainMap::Place where = map_.place(a.cwiseMin(b), a.cwiseMax(b));
    if (where == DomainMap::Place::outside) return;
    if (where == DomainMap::Place::inside) return visit(a, b);
    constexpr double k_margin = 1e-9;  // of the domain's size, more than cuts are rounded by
    const PlanarDomain::Box box{a.cwiseMin(b).array() - k_margin * reach_, a.cwiseMax(b).array() + k_margin * reach_};
    std::vector<double> cuts{from, to};
    for (std::size_t l = 0; l < domain_.loops().size(); ++l) {
      if (!domain_.boxes()[l].meets(box)) continue;
      const std::vector<Vec2>& loop = domain_.loops()[l];
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const Vec2 p = loop[i] - begin, q = loop[(i + 1) % loop.size()] - begin;
        const double at_p = p.dot(across), at_q = q.dot(across);
        if ((at_p > 0) == (at_q > 0)) continue;
        const double cut = (p + at_p / (at_p - at_q) * (q - p)).dot(along);
        if (cut > from && cut < to) cuts.push_back(cut);
      }
    }
    std::sort(cuts.begin(), cuts.end());
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i)
      if (cuts[i] < cuts[i + 1] && domain_.contains(begin + 0.5 * (cuts[i] + cuts[i + 1]) * along))
        visit(Vec2(begin + cuts[i] * along), Vec2(begin + cuts[i + 1] * along));
  }

  const Voronoi2d& diagram_;
  const PlanarDomain& domain_;
  const DomainMap& map_;
  Vec2 middle_;
  double reach_;
};

}  // namespace saddleback::voronoi2d
