// Walks from cell to cell towards the point: a site that is not the nearest has a neighbor that is nearer, with
// weights, with powers or without. Each point starts at a site next to it on a space-filling curve through sites and
// points alike.

#include <algorithm>
#include <cmath>

#include "saddleback/error.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

#include "predicates/power_2d.h"
#include "predicates/predicates.h"
#include "predicates/weighted_2d.h"
#include "support/threads/parallel.h"
#include "voronoi2d/sites/curve_order.h"

namespace saddleback {
namespace {

/// A diagram whose coordinates are multiplied by a power of two, so that squares stay among the doubles.
struct Scaled {
  const Voronoi2d& diagram;
  double scale;

  predicates::Point2 operator()(const Vec2& v) const { return {v.x() * scale, v.y() * scale}; }
  predicates::Point2 site(Index i) const { return (*this)(diagram.sites[i]); }

  predicates::WeightedPoint2 weighted(Index i) const {
    return {diagram.sites[i].x() * scale, diagram.sites[i].y() * scale, diagram.weights[i] * scale};
  }

  predicates::PowerPoint2 powered(Index i) const {
    return {diagram.sites[i].x() * scale, diagram.sites[i].y() * scale, diagram.powers[i] * scale * scale};
  }

  /// Returns exactly whether a (negative) or b (positive) is nearer.
  predicates::Sign compare(const predicates::Point2& point, Index a, Index b) const {
    if (!diagram.powers.empty()) return predicates::compare_powers(point, powered(a), powered(b));
    if (diagram.weights.empty()) return predicates::compare_distances(point, site(a), site(b));
    return predicates::compare_weighted_distances(point, weighted(a), weighted(b));
  }

  template <class Visit>
  void for_neighbors(Index site, Visit&& visit) const {
    for (const Index edge : diagram.cell_edges(site)) {
      const auto [left, right] = diagram.edge_sites[edge];
      visit(left == site ? right : left);
    }
  }

  Index nearest_from(const predicates::Point2& point, Index site) const {
    for (Index next = site;; site = next) {
      bool is_shared = false;
      for_neighbors(site, [&](Index other) {
        const predicates::Sign sign = compare(point, other, next);
        if (sign == predicates::Sign::negative) next = other;
        is_shared |= sign == predicates::Sign::zero;
      });
      if (next == site) return is_shared ? smallest_nearest(point, site) : site;
    }
  }

  /// Returns of all sites as near as one of the nearest the smallest index: they are neighbors of each other in turn.
  Index smallest_nearest(const predicates::Point2& point, Index site) const {
    std::vector<Index> nearest{site};
    for (std::size_t i = 0; i < nearest.size(); ++i) {
      const Index from = nearest[i];
      for_neighbors(from, [&](Index other) {
        const bool is_known = std::find(nearest.begin(), nearest.end(), other) != nearest.end();
        if (!is_known && compare(point, other, site) == predicates::Sign::zero) nearest.push_back(other);
      });
    }
    return *std::min_element(nearest.begin(), nearest.end());
  }
};

double scale_for(std::span<const Vec2> points) {
  double largest = 0;
  for (const Vec2& point : points) largest = std::max(largest, point.cwiseAbs().maxCoeff());
  if (largest == 0 || (largest < 0x1p250 && largest > 0x1p-200)) return 1;
  int exponent;
  std::frexp(largest, &exponent);
  return std::ldexp(1, std::clamp(-exponent, -1022, 1023));
}

}  // namespace

std::vector<Index> Voronoi2d::locate(std::span<const Vec2> points, int threads, Job* job) const {
  using voronoi2d::Placed;
  if (sites.empty()) throw InputError("locate: the diagram has no sites");
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite())
      throw InputError(message("points: coordinates of point ", i, " are ", points[i].x(), ", ", points[i].y(),
                               ", wanted finite numbers"));
  const JobStage stage(job, "Nearest sites");
  LargeArray<Vec2> all(points.begin(), points.end());
  for (const Index site : cell_sites) all.push_back(sites[site]);
  const Scaled scaled{*this, scale_for(all)};
  const LargeArray<Placed> order = voronoi2d::curve_order(all, threads, stage.part(0, 0.3));

  const Index point_count = static_cast<Index>(points.size()), count = static_cast<Index>(order.size());
  std::vector<Index> result(points.size());
  constexpr Index k_block = 4096;
  const Index block_count = (count + k_block - 1) / k_block;
  parallel_for(block_count, threads, 1, [&](Index block, int) {
    stage.check();
    Index site = cell_sites[0];  // the last one on the curve
    for (Index i = block * k_block; i-- > 0;) {
      if (order[i].index < point_count) continue;
      site = cell_sites[order[i].index - point_count];
      break;
    }
    for (Index i = block * k_block; i < std::min(count, (block + 1) * k_block); ++i) {
      const Index index = order[i].index;
      if (index >= point_count) {
        site = cell_sites[index - point_count];
      } else {
        site = result[index] = scaled.nearest_from(scaled(points[index]), site);
      }
    }
  });
  stage.update(1);
  return result;
}

}  // namespace saddleback
