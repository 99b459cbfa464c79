#pragma once
// The dual of a weighted diagram, as far as doubles tell it for certain: the triangulation without weights, with edges
// exchanged until each is dual to a piece of curve.
//
// Each triangle stands for the point that is equally far from its three sites, and each site's triangles in turn for
// the corners of a cell. A cell bounded by curves towards some of the sites contains the true one. If around each
// site the corners follow each other along these curves, once around, then the cells fit together along their sides and
// about their corners and cover the plane once: so they are the true cells. No circle has to be tested for being empty.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/support/large_array.h"
#include "saddleback/types.h"

#include "predicates/weighted_2d.h"
#include "support/threads/parallel.h"
#include "voronoi2d/sweep/planar_mesh.h"
#include "voronoi2d/sweep/triangulation.h"

namespace saddleback::voronoi2d {

class WeightedMesh {
 public:
  /// Makes it from a triangulation that is no line. No site may have the place of another.
  WeightedMesh(Triangulation&& triangulation, std::span<const predicates::WeightedPoint2> points);

  /// Exchanges edges, and finds out which cells are certain. O(n + exchanges). \throw Cancelled
  void improve(int threads, const JobStage& stage);

  /// Tells whether the corners around a site turn once: its cell is right if those of its neighbors are.
  bool is_certain(Index site) const { return is_certain_[site] != 0; }
  /// The neighbor at the border's sites that stands for the infinitely far.
  Index far_away() const { return static_cast<Index>(points_.size()); }

  /// Calls visit(neighbor, half) for a site's neighbors, counter-clockwise, and the half-edges towards them; the
  /// corner behind is that of the half-edge's triangle. O(neighbors).
  template <class Visit>
  void visit_ring(Index site, Visit&& visit) const {
    const Index first = mesh_.leaving[site];
    Index half = first;
    do {
      visit(mesh_.corners[next_half(half)], half);
      half = next_around(half);
    } while (half != first);
  }
  /// Returns where a triangle's corner lies, which is not far.
  Vec2 corner(Index triangle) const;
  /// Returns the lowest of the sites about a triangle's corner.
  Index lowest_about(Index triangle) const {
    const Index* const corner = mesh_.corners.data() + 4 * static_cast<std::size_t>(triangle);
    return std::min({corner[0], corner[1], corner[2]});
  }
  Index twin(Index half) const { return mesh_.twins[half]; }
  /// The half-edge that `visit_ring` comes to last.
  Index last_in_ring(Index site) const { return next_half(mesh_.twins[mesh_.leaving[site]]); }
  /// Tells whether a triangle's corner is at infinity.
  bool is_far(Index triangle) const { return centers_[triangle].w == 0; }
  Index triangle_count() const { return static_cast<Index>(centers_.size()); }

 private:
  /// Equally far from three sites: (x, y) / w, which is a direction for w = 0.
  struct Center {
    double x, y;
    double doubt;  ///< how far off (x, y) may be; infinite where not known
    float w;
    bool is_rough;  ///< not to be read as a vertex
  };
  struct Way {
    double x, y, doubt;
  };

  /// The corners around a site in turn.
  struct Ring {
    Index turns;   ///< how often the ways to them pass the x axis
    Index begins;  ///< sides towards the lowest neighbor: with several, where a cell begins is open
  };
  /// What is done between sites in a row, [begin, end), besides all others.
  struct alignas(k_apart) Exchanges {
    Index begin, end;
    std::vector<Index> wanted{};    ///< half-edges to look at, between two of the sites
    std::vector<Index> beyond{};    ///< others that are no sides: next to more sites than these
    std::vector<Index> bad{};       ///< that are no sides and cannot be exchanged
    std::vector<Index> repeated{};  ///< sites with several sides towards another
    std::int64_t turns = 0;         ///< how often the ways of all sites to their corners pass the x axis: what is new
  };

  Index next_around(Index half) const { return mesh_.twins[previous_half(half)]; }
  void add_far_triangles();
  Index free_triangle(Index from) const;
  void find_centers(Index begin, Index end);
  std::vector<Exchanges> find_sides(int threads, const JobStage& stage);
  static std::vector<Exchanges> blocks_of(Index size, Index count);
  Exchanges exchange_all(std::vector<Exchanges>&& blocks, int threads, const JobStage& stage);
  void find_certain(const Exchanges& all, int threads, const JobStage& stage);
  static std::array<Index, 3> from_lowest(Index a, Index b, Index c);
  Center center(Index a, Index b, Index c) const;
  Way way(Index site, const Center& center) const;
  static int turn(const Way& from, const Way& to);
  static bool passes(const Way& from, const Way& to, int sign);
  bool may_follow(Index site, Index neighbor, int turn) const;
  bool is_piece(Index from, Index to, const Center& right, const Center& left) const;
  bool is_side(Index half) const;
  void ask_for_centers(Index half) const;
  bool is_side(Index half, std::int64_t& passed) const;
  Ring ring(Index site) const;
  bool are_neighbors(Index a, Index b) const;
  std::int64_t passed_about(Index half) const;
  std::int64_t passed_by_all(int threads, const JobStage& stage) const;
  bool exchange(Index half, Exchanges& some);
  void exchange_within(Exchanges& some, const JobStage& stage);

  Triangulation mesh_;
  std::span<const predicates::WeightedPoint2> points_;
  LargeArray<Center> centers_;
  LargeArray<std::uint8_t> is_certain_;
  bool recounts_ = false;  ///< how often ways pass the x axis, at the end, and not with each exchange
};

}  // namespace saddleback::voronoi2d
