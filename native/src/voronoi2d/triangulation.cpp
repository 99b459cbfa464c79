// Tiles are squares of the space-filling curve with not too many sites, so that a circle's work stays in a core's
// cache. Each has a circle that sees the tile's sites only; the triangulations are joined in pairs, square by square,
// which costs little more than the tiles' borders, however dense the sites are here or there.

#include "voronoi2d/triangulation.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "support/parallel.h"
#include "voronoi2d/join_meshes.h"
#include "voronoi2d/sweep_circle.h"

namespace saddleback::voronoi2d {
namespace {

/// A square of the curve: one tile, or two squares, or pairs of them, side by side.
struct Square {
  MeshPart part;
  Index first = k_none, second = k_none;  ///< squares
  Index height = 0;                       ///< above the lowest of its tiles
};

/// Squares, each after its parts: split until they have few enough sites.
class SquareTree {
 public:
  SquareTree(const LargeArray<std::uint32_t>& places, Index count, Index size) : places_(places), size_(size) {
    if (count > 0) add(0, count, 32);
  }
  std::vector<Square>& squares() { return squares_; }

 private:
  Index add(Index begin, Index end, int bits) {
    if (end - begin <= size_ || bits == 0) return add_square({{begin, end, begin, begin, begin, begin, false, {}}});
    const auto in_first_half = [&](std::uint32_t place) { return ((place >> (bits - 1)) & 1) == 0; };
    const auto middle = std::partition_point(places_.begin() + begin, places_.begin() + end, in_first_half);
    const Index half = static_cast<Index>(middle - places_.begin());
    if (half == begin || half == end) return add(begin, end, bits - 1);
    const Index first = add(begin, half, bits - 1), second = add(half, end, bits - 1);
    Square square{{begin, end, begin, begin, begin, begin, false, {}}, first, second};
    square.height = 1 + std::max(squares_[first].height, squares_[second].height);
    return add_square(std::move(square));
  }
  Index add_square(Square&& square) {
    squares_.push_back(std::move(square));
    return static_cast<Index>(squares_.size()) - 1;
  }

  const LargeArray<std::uint32_t>& places_;
  Index size_;
  std::vector<Square> squares_;
};

/// Triangulates tiles into the arrays of all.
class TileSweeper {
 public:
  TileSweeper(const OrderedSites& sites, Triangulation& result, MeshJoiner& joiner)
      : sites_(sites), result_(result), joiner_(joiner) {}

  void triangulate(MeshPart& part, const JobStage& stage) {
    find_box(part);
    const Index first = 2 * part.begin;
    part.free = {{first, 2 * part.end}};
    if (is_line(part)) return;
    const Vec2 centre(0.5 * sites_.x[part.leftmost] + 0.5 * sites_.x[part.rightmost],
                      0.5 * sites_.y[part.lowest] + 0.5 * sites_.y[part.highest]);
    Index *const corners = result_.corners.data(), *const twins = result_.twins.data();
    Index end = circle_.sweep(sites_, part.begin, part.end, centre, first, corners, twins, stage);
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
  void find_box(MeshPart& part) const {
    const Index count = part.end - part.begin;
    const std::span<const double> x = std::span(sites_.x).subspan(part.begin, count),
                                  y = std::span(sites_.y).subspan(part.begin, count);
    const auto [leftmost, rightmost] = std::minmax_element(x.begin(), x.end());
    const auto [lowest, highest] = std::minmax_element(y.begin(), y.end());
    part.leftmost = part.begin + static_cast<Index>(leftmost - x.begin());
    part.rightmost = part.begin + static_cast<Index>(rightmost - x.begin());
    part.lowest = part.begin + static_cast<Index>(lowest - y.begin());
    part.highest = part.begin + static_cast<Index>(highest - y.begin());
  }

  bool is_line(const MeshPart& part) const {
    for (Index site = part.begin + 2; site < part.end; ++site)
      if (predicates::orient_2d_by_steps(point(part.begin), point(part.begin + 1), point(site)) !=
          predicates::Sign::zero)
        return false;
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

/// All tiles, then all pairs, from the lowest up.
class TileWork {
 public:
  TileWork(const OrderedSites& sites, std::vector<Square>& squares, Triangulation& result, int threads)
      : squares_(squares), threads_(std::min(thread_count(threads), static_cast<int>(squares.size()))) {
    const PlanarMesh mesh{sites.x.data(), sites.y.data(), sites.count(), result.corners.data(), result.twins.data(), 0};
    joiners_.reserve(threads_);
    for (int i = 0; i < threads_; ++i) {
      joiners_.emplace_back(mesh, result.leaving.data());
      sweepers_.emplace_back(sites, result, joiners_.back());
    }
    Index top = 0;
    for (const Square& square : squares) top = std::max(top, square.height);
    levels_.resize(top + 1);
    for (std::size_t i = 0; i < squares.size(); ++i) levels_[squares[i].height].push_back(static_cast<Index>(i));
  }

  void run(const JobStage& stage) {
    const Index count = squares_.back().part.end;
    const std::size_t pair_count = squares_.size() - levels_[0].size();
    std::atomic<Index> done{0}, joined{0};
    for (std::size_t level = 0; level < levels_.size(); ++level) {
      parallel_for(static_cast<Index>(levels_[level].size()), threads_, 1, [&](Index i, int thread) {
        stage.check();
        Square& square = squares_[levels_[level][i]];
        if (level > 0) {
          join(square, thread, stage);
          stage.update(0.9 + 0.1 * ++joined / static_cast<double>(pair_count));
          return;
        }
        const Index size = square.part.end - square.part.begin;
        const bool is_long = size > k_long;
        sweepers_[thread].triangulate(square.part, is_long ? stage.part(0, 0.9) : JobStage());
        stage.update(0.9 * static_cast<double>(done += size) / count);
      });
    }
    stage.update(1);
  }

 private:
  static constexpr Index k_long = 65536;  ///< sites: takes so long that it reports and can be stopped

  void join(Square& square, int thread, const JobStage& stage) {
    MeshPart &part = square.part, &first = squares_[square.first].part, &second = squares_[square.second].part;
    if (!joiners_[thread].join(first, second, part)) sweepers_[thread].triangulate(part, stage);
  }

  std::vector<Square>& squares_;
  int threads_;
  std::vector<TileSweeper> sweepers_;
  std::vector<MeshJoiner> joiners_;
  std::vector<std::vector<Index>> levels_;
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
  SquareTree tree(sites.places, count, tile_size);
  TileWork(sites, tree.squares(), result, threads).run(stage);
  const MeshPart& all = tree.squares().back().part;
  result.is_line = !all.has_triangles;
  for (const auto& [begin, end] : all.free)
    for (Index triangle = begin; triangle < end; ++triangle) result.corners[4 * triangle] = k_none;
  return result;
}

std::vector<Index> along_line(const OrderedSites& sites) {
  std::vector<Index> along(sites.count());
  std::iota(along.begin(), along.end(), 0);
  std::sort(along.begin(), along.end(), [&](Index a, Index b) {
    return sites.x[a] != sites.x[b] ? sites.x[a] < sites.x[b] : sites.y[a] < sites.y[b];
  });
  return along;
}

namespace {

NeighbourLists neighbours_on_line(const OrderedSites& sites) {
  const std::vector<Index> along = along_line(sites);
  const Index count = sites.count();
  std::vector<Index> place(count);
  for (Index i = 0; i < count; ++i) place[along[i]] = i;
  NeighbourLists lists;
  lists.offsets.push_back(0);
  for (Index site = 0; site < count; ++site) {
    if (place[site] > 0) lists.neighbours.push_back(along[place[site] - 1]);
    if (place[site] + 1 < count) lists.neighbours.push_back(along[place[site] + 1]);
    lists.offsets.push_back(static_cast<Index>(lists.neighbours.size()));
  }
  return lists;
}

}  // namespace

NeighbourLists neighbours_of(const Triangulation& triangulation, const OrderedSites& sites) {
  if (triangulation.is_line) return neighbours_on_line(sites);
  NeighbourLists lists;
  lists.offsets.reserve(sites.count() + 1);
  lists.offsets.push_back(0);
  lists.neighbours.reserve(static_cast<std::size_t>(6) * sites.count());
  for (Index site = 0; site < sites.count(); ++site) {
    const Index first = triangulation.leaving[site];
    Index half = first;
    do {
      lists.neighbours.push_back(triangulation.corners[next_half(half)]);
      const Index last = previous_half(half);
      half = triangulation.twins[last];
      if (half < 0) lists.neighbours.push_back(triangulation.corners[last]);
    } while (half >= 0 && half != first);
    lists.offsets.push_back(static_cast<Index>(lists.neighbours.size()));
  }
  return lists;
}

}  // namespace saddleback::voronoi2d
