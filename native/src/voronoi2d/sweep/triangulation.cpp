// Tiles are squares of the space-filling curve with not too many sites, so that a circle's work stays in a core's
// cache. Each has a circle that sees the tile's sites only; the triangulations are joined in pairs, square by square,
// which costs little more than the tiles' borders, however dense the sites are here or there.

#include "voronoi2d/sweep/triangulation.h"

#include <algorithm>
#include <atomic>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "support/threads/parallel.h"
#include "voronoi2d/sites/curve_order.h"
#include "voronoi2d/sweep/join_meshes.h"
#include "voronoi2d/sweep/sweep_circle.h"

namespace saddleback::voronoi2d {
namespace {

/// A square of the curve: one tile, or two squares, or pairs of them, side by side.
struct Square {
  MeshPart part;
  Index first = k_none, second = k_none;  ///< squares
  Index start;                            ///< the first square of those that are in it
};

/// Squares, each after its parts: split until they have few enough sites. The smallest squares of a curve with too many
/// sites are split by the curve within.
class SquareTree {
 public:
  SquareTree(const OrderedSites& sites, Index size, const JobStage& stage) : sites_(sites), size_(size), stage_(stage) {
    if (sites.count() > 0) add({sites.places, 0}, 0, sites.count(), k_all_bits);
  }
  std::vector<Square>& squares() { return squares_; }

 private:
  static constexpr int k_all_bits = 32;
  /// Holds the places of the sites from `first` on.
  struct Places {
    std::span<const std::uint32_t> places;
    Index first;
  };

  Index add(const Places& curve, Index begin, Index end, int bits) {
    if (end - begin <= size_) return add_square(begin, end, k_none, k_none);
    if (bits == 0) return add_crowded(begin, end);
    const auto in_first_half = [&](std::uint32_t place) { return ((place >> (bits - 1)) & 1) == 0; };
    const auto places = curve.places.subspan(begin - curve.first, end - begin);
    const auto middle = std::partition_point(places.begin(), places.end(), in_first_half);
    const Index half = begin + static_cast<Index>(middle - places.begin());
    if (half == begin || half == end) return add(curve, begin, end, bits - 1);
    const Index first = add(curve, begin, half, bits - 1), second = add(curve, half, end, bits - 1);
    return add_square(begin, end, first, second);
  }
  Index add_crowded(Index begin, Index end) {
    const auto of_square = [&](const LargeArray<double>& all) { return std::span(all).subspan(begin, end - begin); };
    const LargeArray<std::uint32_t> places = places_in_square(of_square(sites_.x), of_square(sites_.y), stage_);
    if (places.empty()) return add_square(begin, end, k_none, k_none);
    return add({places, begin}, begin, end, k_all_bits);
  }
  Index add_square(Index begin, Index end, Index first, Index second) {
    const Index square = static_cast<Index>(squares_.size()), start = first == k_none ? square : squares_[first].start;
    squares_.push_back({{begin, end, begin, begin, begin, begin, false, {}}, first, second, start});
    return square;
  }

  const OrderedSites& sites_;
  Index size_;
  const JobStage& stage_;
  std::vector<Square> squares_;
};

/// Triangulates tiles into the arrays of all.
class alignas(k_apart) TileSweeper {
 public:
  TileSweeper(const OrderedSites& sites, Triangulation& result, MeshJoiner& joiner)
      : sites_(sites), result_(result), joiner_(joiner) {}

  void triangulate(MeshPart& part, const JobStage& stage) {
    find_box(part);
    const Index first = 2 * part.begin;
    part.free = {{first, 2 * part.end}};
    if (is_line(part, stage)) return;
    const Vec2 center(0.5 * sites_.x[part.leftmost] + 0.5 * sites_.x[part.rightmost],
                      0.5 * sites_.y[part.lowest] + 0.5 * sites_.y[part.highest]);
    Index *const corners = result_.corners.data(), *const twins = result_.twins.data();
    Index end = circle_.sweep(sites_, part.begin, part.end, center, first, corners, twins, stage);
    link_sites(part, first, end);
    if (!is_triangulation(part, end - first)) {
      end = triangulate_from_left(part);
      link_sites(part, first, end);
      doubtful_.clear();
      for (Index half = 4 * first; half < 4 * end; ++half)
        if ((half & 3) != 3) doubtful_.push_back(half);
    }
    joiner_.restore(doubtful_);
    part.has_triangles = end > first;
    part.free = {{end, 2 * part.end}};
  }

 private:
  /// The first of the least of some coordinates, and the last of the greatest.
  static std::pair<Index, Index> ends_of(const LargeArray<double>& values, Index begin, Index end) {
    double least = values[begin], greatest = least;
    for (Index i = begin; i < end; ++i) {
      least = values[i] < least ? values[i] : least;
      greatest = values[i] > greatest ? values[i] : greatest;
    }
    Index first = begin, last = end - 1;
    while (values[first] != least) ++first;
    while (values[last] != greatest) --last;
    return {first, last};
  }

  void find_box(MeshPart& part) const {
    std::tie(part.leftmost, part.rightmost) = ends_of(sites_.x, part.begin, part.end);
    std::tie(part.lowest, part.highest) = ends_of(sites_.y, part.begin, part.end);
  }

  bool is_line(const MeshPart& part, const JobStage& stage) const {
    for (Index site = part.begin + 2; site < part.end; ++site) {
      stage.check();
      if (predicates::orient_2d_by_steps(point(part.begin), point(part.begin + 1), point(site)) !=
          predicates::Sign::zero)
        return false;
    }
    return true;
  }

  /// Each site's half-edge, those along the border, and those that are not certain to pass the circle test.
  void link_sites(const MeshPart& part, Index first, Index end) {
    const Index *const corners = result_.corners.data(), *const twins = result_.twins.data();
    Index* const leaving = result_.leaving.data();
    std::fill(leaving + part.begin, leaving + part.end, k_none);
    border_.clear();
    doubtful_.clear();
    for (Index half = 4 * first; half < 4 * end; half += 4) {
      for (Index k = 0; k < 3; ++k) leaving[corners[half + k]] = half + k;
      // The later triangle of two that meet was joined by its second or third half-edge: a test of these is one of all.
      const CircleTest circle(point(corners[half]), point(corners[half + 1]), point(corners[half + 2]));
      if (std::min({twins[half], twins[half + 1], twins[half + 2]}) < 0) {
        for (Index k = 0; k < 3; ++k) {
          const bool is_border = twins[half + k] < 0;
          if (is_border) border_.push_back(half + k);
          if (!is_border && k > 0 && !(circle.room(opposite(half + k), opposite(half + k))[0] > 0))
            doubtful_.push_back(half + k);
        }
        continue;
      }
      const TwoDoubles room = circle.room(opposite(half + 1), opposite(half + 2));
      if (TwoDoubles::are_positive(room)) continue;
      for (Index k = 1; k < 3; ++k)
        if (!(room[k - 1] > 0)) doubtful_.push_back(half + k);
    }
    for (const Index half : border_) leaving[corners[half]] = half;
  }
  /// The corner beyond a half-edge.
  predicates::Point2 opposite(Index half) const { return point(result_.corners[previous_half(result_.twins[half])]); }

  // For the rare ones that no sweep in doubles gets through. Returns the triangles' end.
  Index triangulate_from_left(const MeshPart& part) {
    const Index begin = part.begin, first = 8 * begin;
    PlanarMesh mesh{sites_.x.data() + begin,        sites_.y.data() + begin,      part.end - begin,
                    result_.corners.data() + first, result_.twins.data() + first, 0};
    voronoi2d::triangulate_from_left(mesh);
    for (Index half = 0; half < mesh.half_end(); half += 4) {
      for (Index k = 0; k < 3; ++k) {
        mesh.triangles[half + k] += begin;
        if (mesh.twins[half + k] != k_none) mesh.twins[half + k] += first;
      }
      mesh.twins[half + 3] = 0;
    }
    return 2 * begin + mesh.triangle_count;
  }

  // Triangles turn counter-clockwise and are joined by their twins. So around each site inside they wind once or more
  // often. With all sites in use, one border that is convex and turns once, and as many triangles as Euler says, they
  // wind once everywhere: a triangulation. Exact.
  bool is_triangulation(const MeshPart& part, Index triangle_count) const {
    for (Index site = part.begin; site < part.end; ++site)
      if (result_.leaving[site] == k_none) return false;
    const Index border_count = static_cast<Index>(border_.size());
    if (triangle_count != 2 * (part.end - part.begin) - 2 - border_count) return false;
    const auto target = [&](Index site) { return result_.corners[next_half(result_.leaving[site])]; };
    const auto goes_up = [&](Index from, Index to) {
      return sites_.y[to] > sites_.y[from] || (sites_.y[to] == sites_.y[from] && sites_.x[to] > sites_.x[from]);
    };
    Index a = part.leftmost, b = target(a), changes = 0;
    const Index start = a;
    for (Index i = 0; i < border_count; ++i) {
      const Index half = result_.leaving[b], c = target(b);
      if (result_.twins[half] != k_none || (b == start) != (i + 1 == border_count)) return false;
      if (predicates::orient_2d_by_steps(point(a), point(b), point(c)) == predicates::Sign::negative) return false;
      changes += goes_up(a, b) != goes_up(b, c);
      a = b;
      b = c;
    }
    return changes == 2;
  }

  predicates::Point2 point(Index site) const { return {sites_.x[site], sites_.y[site]}; }

  const OrderedSites& sites_;
  Triangulation& result_;
  MeshJoiner& joiner_;
  SweepCircle circle_;
  std::vector<Index> border_, doubtful_;
};

/// The work on all tiles and pairs. Pairs are joined right after their parts, while these are in a core's cache.
class TileWork {
 public:
  TileWork(const OrderedSites& sites, std::vector<Square>& squares, Triangulation& result, int threads,
           const JobStage& stage)
      : squares_(squares),
        stage_(stage),
        threads_(std::min(thread_count(threads), static_cast<int>(squares.size()))),
        count_(sites.count()) {
    const PlanarMesh mesh{sites.x.data(), sites.y.data(), count_, result.corners.data(), result.twins.data(), 0};
    joiners_.reserve(threads_);
    for (int i = 0; i < threads_; ++i) {
      joiners_.emplace_back(mesh, result.leaving.data(), stage_);
      sweepers_.emplace_back(sites, result, joiners_.back());
    }
    share_out();
  }

  void run() {
    for (const std::vector<Run>& level : levels_) {
      parallel_for(static_cast<Index>(level.size()), threads_, 1, [&](Index i, int thread) {
        for (Index square = level[i].begin; square < level[i].end; ++square) work(squares_[square], thread);
      });
    }
    stage_.update(1);
  }

 private:
  /// Squares in a row: each after its parts, those of it that are not done before it.
  struct Run {
    Index begin, end;
  };
  static constexpr Index k_long = 65536;  ///< sites: takes so long that it reports and can be stopped
  static constexpr Index k_shares = 16;   ///< for each thread

  /// Squares of up to a share of the sites, each with all its parts, are for one thread; then come those about them,
  /// from the lowest up.
  void share_out() {
    const Index share = threads_ == 1 ? count_ : count_ / (k_shares * threads_),
                size = static_cast<Index>(squares_.size());
    std::vector<std::size_t> level(size, 0);
    levels_.resize(1);
    const auto add = [&](Index square) { levels_[0].push_back({squares_[square].start, square + 1}); };
    for (Index i = 0; i < size; ++i) {
      const Square& square = squares_[i];
      if (square.first == k_none || square.part.end - square.part.begin <= share) continue;
      for (const Index part : {square.first, square.second})
        if (level[part] == 0) add(part);
      level[i] = 1 + std::max(level[square.first], level[square.second]);
      levels_.resize(std::max(levels_.size(), level[i] + 1));
      levels_[level[i]].push_back({i, i + 1});
    }
    if (level[size - 1] == 0) add(size - 1);
  }

  void work(Square& square, int thread) {
    stage_.check();
    const auto tell = [&](double sites, Index pairs) {
      stage_.update(0.9 * sites / count_ + 0.1 * pairs / static_cast<double>(squares_.size()));
    };
    if (square.first != k_none) {
      MeshPart &part = square.part, &first = squares_[square.first].part, &second = squares_[square.second].part;
      if (!joiners_[thread].join(first, second, part)) sweepers_[thread].triangulate(part, stage_);
      const Index joined = ++joined_;
      tell(swept_, joined);
      return;
    }
    const Index size = square.part.end - square.part.begin;
    sweepers_[thread].triangulate(square.part, size > k_long ? stage_.part(0, 0.9) : JobStage());
    const Index swept = swept_ += size;
    tell(swept, joined_);
  }

  std::vector<Square>& squares_;
  JobStage stage_;
  int threads_;
  Index count_;
  std::vector<TileSweeper> sweepers_;
  std::vector<MeshJoiner> joiners_;
  std::vector<std::vector<Run>> levels_;
  std::atomic<Index> swept_{0}, joined_{0};
};

}  // namespace

Triangulation triangulate(const OrderedSites& sites, Index tile_size, int threads, const JobStage& stage) {
  const Index count = sites.count();
  Triangulation result;
  if (count < 3) {
    result.is_line = true;
    return result;
  }
  result.corners.resize(static_cast<std::size_t>(8) * count);
  result.twins.resize(static_cast<std::size_t>(8) * count);
  result.leaving.reserve(count + 1);  // one more, for who takes the memory over
  result.leaving.resize(count);
  const JobStage parting = stage.part(0, 0.05);
  SquareTree tree(sites, tile_size, parting);
  TileWork(sites, tree.squares(), result, threads, stage.part(0.05, 1)).run();
  const MeshPart& all = tree.squares().back().part;
  result.is_line = !all.has_triangles;
  for (const auto& [begin, end] : all.free)
    for (Index triangle = begin; triangle < end; ++triangle) result.corners[4 * triangle] = k_none;
  return result;
}

namespace {

/// Returns the ranks of sites that are all on one line, from one end to the other.
std::vector<Index> along_line(const OrderedSites& sites, const JobStage& stage) {
  std::vector<Index> along(sites.count());
  std::iota(along.begin(), along.end(), 0);
  std::sort(along.begin(), along.end(), [&](Index a, Index b) {
    stage.check();
    return sites.x[a] != sites.x[b] ? sites.x[a] < sites.x[b] : sites.y[a] < sites.y[b];
  });
  return along;
}

NeighborLists neighbors_on_line(const OrderedSites& sites, const JobStage& stage) {
  const std::vector<Index> along = along_line(sites, stage);
  const Index count = sites.count();
  std::vector<Index> place(count);
  for (Index i = 0; i < count; ++i) place[along[i]] = i;
  NeighborLists lists;
  lists.offsets.push_back(0);
  for (Index site = 0; site < count; ++site) {
    stage.check();
    if (place[site] > 0) lists.neighbors.push_back(along[place[site] - 1]);
    if (place[site] + 1 < count) lists.neighbors.push_back(along[place[site] + 1]);
    lists.offsets.push_back(static_cast<Index>(lists.neighbors.size()));
  }
  return lists;
}

}  // namespace

NeighborLists neighbors_of(const Triangulation& triangulation, const OrderedSites& sites, const JobStage& stage) {
  if (triangulation.is_line) return neighbors_on_line(sites, stage);
  NeighborLists lists;
  lists.offsets.reserve(sites.count() + 1);
  lists.offsets.push_back(0);
  lists.neighbors.reserve(static_cast<std::size_t>(6) * sites.count());
  for (Index site = 0; site < sites.count(); ++site) {
    const Index first = triangulation.leaving[site];
    Index half = first;
    do {
      lists.neighbors.push_back(triangulation.corners[next_half(half)]);
      const Index last = previous_half(half);
      half = triangulation.twins[last];
      if (half < 0) lists.neighbors.push_back(triangulation.corners[last]);
    } while (half >= 0 && half != first);
    lists.offsets.push_back(static_cast<Index>(lists.neighbors.size()));
  }
  return lists;
}

}  // namespace saddleback::voronoi2d
