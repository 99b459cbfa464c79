// Outside of the convex hull lies a triangle beyond each of its edges, whose third corner is infinitely far away: so
// every edge has two triangles, and a site outside takes the place of triangles as one inside does. A site that lies
// above the triangulation, lifted to the paraboloid, stays there whatever comes later.

#include "voronoi2d/power/power_triangulation.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>

#include "predicates/power_2d.h"
#include "voronoi2d/sweep/planar_mesh.h"

namespace saddleback::voronoi2d {
namespace {

using predicates::PowerPoint2;
using predicates::Sign;

PowerPoint2 point_of(const OrderedSites& sites, Index site) {
  return {sites.x[site], sites.y[site], sites.weights[site]};
}

Sign turn(const OrderedSites& sites, Index a, Index b, Index c) {
  return predicates::orient_2d_by_steps(point_of(sites, a).place(), point_of(sites, b).place(),
                                        point_of(sites, c).place());
}

/// Random rounds, of which each has about twice as many sites as all before, in the order of rank within each.
std::vector<Index> in_rounds(Index count) {
  static constexpr int k_rounds = 24;
  const auto round_of = [](Index site) {  // Steele's and Vigna's mixing of bits, SplitMix64
    std::uint64_t bits = (static_cast<std::uint64_t>(site) + 1) * 0x9e3779b97f4a7c15;
    bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
    bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
    return k_rounds - std::min(k_rounds, std::countr_one(bits ^ (bits >> 31)));
  };
  std::vector<Index> order(count);
  std::vector<Index> begin(k_rounds + 2, 0);
  for (Index site = 0; site < count; ++site) ++begin[round_of(site) + 1];
  for (int round = 0; round <= k_rounds; ++round) begin[round + 1] += begin[round];
  for (Index site = 0; site < count; ++site) order[begin[round_of(site)]++] = site;
  return order;
}

class Inserter {
 public:
  explicit Inserter(const OrderedSites& sites)
      : sites_(sites),
        infinite_(sites.count()),
        is_hidden_(sites.count(), false),
        link_(sites.count() + 1, k_none),
        stamp_(sites.count() + 1, k_none) {
    const std::size_t most = 8 * static_cast<std::size_t>(sites.count());
    corners_.reserve(most);
    twins_.reserve(most);
  }

  /// Inserts all sites. False, and nothing done, if they are on one line.
  bool run(const JobStage& stage) {
    const std::vector<Index> order = in_rounds(sites_.count());
    if (order.size() < 3) return false;
    std::size_t third = 2;
    while (third < order.size() && turn(sites_, order[0], order[1], order[third]) == Sign::zero) {
      stage.check();
      ++third;
    }
    if (third == order.size()) return false;
    begin_with(order[0], order[1], order[third]);
    for (std::size_t i = 2; i < order.size(); ++i) {
      constexpr std::size_t k_block = 1024;
      if (i % k_block == 0) stage.update(static_cast<double>(i) / static_cast<double>(order.size()));
      if (i != third) insert(order[i], stage);
    }
    return true;
  }

  /// Hides the sites whose cells are a point or a part of a line. Tells whether there are such.
  bool hide_flat_cells(const JobStage& stage) {
    std::vector<bool> is_done = is_hidden_;
    bool has_flat = false;
    for (std::size_t half = 0; half < corners_.size(); ++half) {
      if ((half & 3) == 3 || corners_[half] == infinite_ || is_done[corners_[half]]) continue;
      stage.check();
      is_done[corners_[half]] = true;
      if (is_flat_cell(static_cast<Index>(half))) has_flat = is_hidden_[corners_[half]] = true;
    }
    return has_flat;
  }

  const std::vector<bool>& is_hidden() const { return is_hidden_; }

  /// Returns the triangles that are not beyond the hull; uses this up. `rank`: of each visible site.
  Triangulation finish(const std::vector<Index>& rank, Index visible_count, const JobStage& stage) {
    const std::size_t count = corners_.size() / 4;
    std::vector<Index> place(count, k_none);
    Index next = 0;
    for (std::size_t t = 0; t < count; ++t)
      if (!is_beyond(static_cast<Index>(4 * t))) place[t] = next++;
    Triangulation result;
    result.corners.assign(8 * static_cast<std::size_t>(visible_count), k_none);
    result.twins.assign(8 * static_cast<std::size_t>(visible_count), k_none);
    result.leaving.assign(visible_count, k_none);
    for (std::size_t t = 0; t < count; ++t) {
      if (place[t] == k_none) continue;
      stage.check();
      Index flat = 0;
      for (Index k = 0; k < 3; ++k) {
        const Index half = static_cast<Index>(4 * t) + k, to = 4 * place[t] + k, twin = twins_[half],
                    corner = rank[corners_[half]];
        const bool is_border = is_beyond(twin & ~3);
        result.corners[to] = corner;
        result.twins[to] = is_border ? k_none : 4 * place[twin / 4] + (twin & 3);
        if (is_border || result.leaving[corner] == k_none) result.leaving[corner] = to;
        if (!is_border && lies_flat(half)) flat |= 1 << k;
      }
      result.twins[4 * place[t] + 3] = flat;
    }
    return result;
  }

 private:
  PowerPoint2 point(Index site) const { return point_of(sites_, site); }
  bool is_beyond(Index first) const {
    return corners_[first] == infinite_ || corners_[first + 1] == infinite_ || corners_[first + 2] == infinite_;
  }

  Index new_triangle(Index a, Index b, Index c) {
    Index first;
    if (free_.empty()) {
      first = static_cast<Index>(corners_.size());
      corners_.resize(corners_.size() + 4, k_none);
      twins_.resize(twins_.size() + 4, k_none);
    } else {
      first = free_.back();
      free_.pop_back();
    }
    corners_[first] = a, corners_[first + 1] = b, corners_[first + 2] = c;
    twins_[first + 3] = k_none;  // the site whose insertion asked last, and found it in its way
    return first;
  }
  void join(Index a, Index b) { twins_[a] = b, twins_[b] = a; }

  void begin_with(Index a, Index b, Index c) {
    if (turn(sites_, a, b, c) == Sign::negative) std::swap(b, c);
    last_ = new_triangle(a, b, c);
    const Index ab = new_triangle(b, a, infinite_), bc = new_triangle(c, b, infinite_),
                ca = new_triangle(a, c, infinite_);
    join(last_, ab), join(last_ + 1, bc), join(last_ + 2, ca);
    join(ab + 1, ca + 2), join(bc + 1, ab + 2), join(ca + 1, bc + 2);
  }

  /// Tells whether a site has less power than a triangle's corners at its center; beyond the hull, whether it is
  /// farther out than the triangle's edge, or on its line and then as `power_test_on_line` has it.
  bool is_in_way(Index first, Index site) const {
    const Index* const corner = &corners_[first];
    for (int k = 0; k < 3; ++k) {
      if (corner[k] != infinite_) continue;
      const Index from = corner[(k + 1) % 3], to = corner[(k + 2) % 3];
      const Sign side = turn(sites_, from, to, site);
      if (side != Sign::zero) return side == Sign::positive;
      return predicates::power_test_on_line(point(from), point(to), point(site)) == Sign::positive;
    }
    return predicates::power_test(point(corner[0]), point(corner[1]), point(corner[2]), point(site)) == Sign::positive;
  }

  /// The triangle about a site, or one beyond an edge of the hull that it is beyond. Such a walk ends, since these are
  /// the shadows of a convex surface [edelsbrunner1989].
  Index triangle_about(Index site, const JobStage& stage) const {
    Index at = last_;
    for (Index came = k_none, step = 0;; ++step) {
      constexpr Index k_block = 1024;
      if (step % k_block == 0) stage.check();
      Index out = k_none;
      for (Index half = at; half < at + 3; ++half) {
        if (half == came || turn(sites_, corners_[half], corners_[next_half(half)], site) != Sign::negative) continue;
        out = half;
        break;
      }
      if (out == k_none) return at;
      came = twins_[out];
      at = came & ~3;
      if (is_beyond(at)) return at;
    }
  }

  void insert(Index site, const JobStage& stage) {
    const Index start = triangle_about(site, stage);
    if (!is_in_way(start, site)) {
      is_hidden_[site] = true;
      return;
    }
    gather(start, site, stage);
    replace(site);
  }

  /// Collects the triangles in the way of a site, which are joined to each other, and the half-edges about them.
  void gather(Index start, Index site, const JobStage& stage) {
    in_way_.assign(1, start);
    about_.clear();
    twins_[start + 3] = site;
    for (std::size_t i = 0; i < in_way_.size(); ++i) {
      constexpr std::size_t k_block = 1024;
      if (i % k_block == 0) stage.check();
      for (Index half = in_way_[i]; half < in_way_[i] + 3; ++half) {
        const Index twin = twins_[half], first = twin & ~3;
        if (twins_[first + 3] == site) continue;
        if (is_in_way(first, site)) {
          twins_[first + 3] = site;
          in_way_.push_back(first);
        } else {
          about_.push_back({corners_[half], corners_[next_half(half)], twin});
        }
      }
    }
  }

  /// A fan from a site to the edges about what was in its way.
  void replace(Index site) {
    for (const Edge& edge : about_) stamp_[edge.from] = site;
    for (const Index first : in_way_) {
      for (Index half = first; half < first + 3; ++half)
        if (stamp_[corners_[half]] != site) is_hidden_[corners_[half]] = true;
      corners_[first] = corners_[first + 1] = corners_[first + 2] = infinite_;
      free_.push_back(first);
    }
    for (const Edge& edge : about_) {
      const Index first = new_triangle(edge.from, edge.to, site);
      join(first, edge.twin);
      link_[edge.from] = first;
      if (edge.from != infinite_ && edge.to != infinite_) last_ = first;
    }
    for (const Edge& edge : about_) join(link_[edge.from] + 1, link_[edge.to] + 2);
  }

  /// Tells whether the triangles beside an edge of the hull's inside have one center.
  bool lies_flat(Index half) const {
    return predicates::power_test(point(corners_[half]), point(corners_[next_half(half)]),
                                  point(corners_[previous_half(half)]),
                                  point(corners_[previous_half(twins_[half])])) == Sign::zero;
  }

  // About a site whose cell has an area lie three centers at least; on the hull one, and one more if it is no corner.
  bool is_flat_cell(Index half) const {
    Index centers = 0, walk = half, before = k_none, after = k_none;
    bool is_on_hull = false;
    do {
      const Index last = previous_half(walk);  // towards the site
      if (is_beyond(walk & ~3)) {
        is_on_hull = true;
        if (corners_[next_half(walk)] == infinite_) before = corners_[last];
        if (corners_[last] == infinite_) after = corners_[next_half(walk)];
      }
      const bool is_inner = !is_beyond(walk & ~3) && !is_beyond(twins_[last] & ~3);
      centers += static_cast<Index>(!is_beyond(walk & ~3) && (!is_inner || !lies_flat(last)));
      walk = twins_[last];
    } while (walk != half);
    if (!is_on_hull) return centers < 3;
    return centers < 2 && turn(sites_, before, corners_[half], after) == Sign::zero;
  }

  struct Edge {
    Index from, to, twin;
  };

  const OrderedSites& sites_;
  Index infinite_;                      ///< the number of the corner infinitely far away
  std::vector<Index> corners_, twins_;  ///< as in Triangulation
  std::vector<Index> free_;             ///< triangles that there are no more
  std::vector<bool> is_hidden_;
  std::vector<Index> link_, stamp_;  ///< by corner: the new triangle along the edge from there; the last site about it
  Index last_ = k_none;              ///< a triangle within the hull
  // Of the site at hand.
  std::vector<Index> in_way_;
  std::vector<Edge> about_;
};

/// Tells which sites of a line have no part of it: those not below the others, lifted [andrew1979].
std::vector<bool> hidden_on_line(const OrderedSites& sites, const JobStage& stage) {
  std::vector<Index> along(sites.count()), kept;
  for (Index site = 0; site < sites.count(); ++site) along[site] = site;
  std::sort(along.begin(), along.end(), [&](Index a, Index b) {
    return sites.x[a] != sites.x[b] ? sites.x[a] < sites.x[b] : sites.y[a] < sites.y[b];
  });
  std::vector<bool> is_hidden(sites.count(), false);
  for (const Index site : along) {
    stage.check();
    const auto has_part = [&](Index middle) {
      return predicates::power_test_on_line(point_of(sites, kept[kept.size() - 2]), point_of(sites, site),
                                            point_of(sites, middle)) == Sign::positive;
    };
    while (kept.size() > 1 && !has_part(kept.back())) {
      is_hidden[kept.back()] = true;
      kept.pop_back();
    }
    kept.push_back(site);
  }
  return is_hidden;
}

/// Keeps those of the sites, and their numbers among these by rank in all of them.
OrderedSites kept_of(const OrderedSites& sites, const std::vector<bool>& is_hidden, std::vector<Index>& rank) {
  OrderedSites kept;
  kept.scale = sites.scale;
  rank.assign(sites.count(), k_none);
  for (Index site = 0; site < sites.count(); ++site) {
    if (is_hidden[site]) continue;
    rank[site] = kept.count();
    kept.x.push_back(sites.x[site]);
    kept.y.push_back(sites.y[site]);
    kept.weights.push_back(sites.weights[site]);
    kept.original.push_back(sites.original[site]);
  }
  return kept;
}

}  // namespace

PowerTriangulation triangulate_by_powers(const OrderedSites& sites, const JobStage& stage) {
  PowerTriangulation result;
  std::vector<Index> rank;
  Inserter inserter(sites);
  if (!inserter.run(stage.part(0, 0.8))) {
    result.visible = kept_of(sites, hidden_on_line(sites, stage), rank);
    result.triangulation.is_line = true;
    return result;
  }
  if (inserter.hide_flat_cells(stage.part(0.8, 0.9))) {
    // What cells without an area leave when they go has its triangles anew; no other cell changes.
    result.visible = kept_of(sites, inserter.is_hidden(), rank);
    return triangulate_by_powers(OrderedSites(std::move(result.visible)), stage.part(0.9, 1));
  }
  result.visible = kept_of(sites, inserter.is_hidden(), rank);
  result.triangulation = inserter.finish(rank, result.visible.count(), stage.part(0.9, 1));
  return result;
}

}  // namespace saddleback::voronoi2d
