#include "voronoi2d/weighted/weighted_mesh.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "support/threads/parallel.h"
#include "voronoi2d/weighted/weighted_vertex.h"

namespace saddleback::voronoi2d {

using predicates::WeightedPoint2;

namespace {

constexpr Index k_sites = 2048;         ///< side by side, whose triangles stay in a core's cache
constexpr Index k_block = 2 * k_sites;  ///< their triangles, but for some at the border
constexpr std::size_t k_ahead = 16;     ///< half-edges

}  // namespace

WeightedMesh::WeightedMesh(Triangulation&& triangulation, std::span<const WeightedPoint2> points)
    : mesh_(std::move(triangulation)), points_(points) {
  add_far_triangles();
  centers_.resize(mesh_.corners.size() / 4);
  is_certain_.resize(points.size());
}

Index WeightedMesh::free_triangle(Index from) const {
  while (mesh_.corners[4 * from] != k_none) ++from;
  return from;
}

/// Adds beyond each edge of the border a triangle with the infinitely far.
void WeightedMesh::add_far_triangles() {
  Index start = 0;
  while (std::min({mesh_.twins[4 * start], mesh_.twins[4 * start + 1], mesh_.twins[4 * start + 2]}) >= 0 ||
         mesh_.corners[4 * start] == k_none)
    ++start;
  const auto is_border = [&](Index half) { return mesh_.twins[half] < 0; };
  Index half = 4 * start;
  while (!is_border(half)) ++half;
  const Index first_site = mesh_.corners[half];
  Index triangle = 0, last = k_none, first = k_none, site = first_site;
  do {
    const Index edge = mesh_.leaving[site], end = mesh_.corners[next_half(edge)];
    triangle = free_triangle(triangle);
    const Index added = 4 * triangle;
    mesh_.corners[added] = end, mesh_.corners[added + 1] = site, mesh_.corners[added + 2] = far_away();
    mesh_.twins[added] = edge, mesh_.twins[edge] = added;
    if (last != k_none) mesh_.twins[added + 1] = last + 2, mesh_.twins[last + 2] = added + 1;
    if (first == k_none) first = added;
    last = added;
    site = end;
  } while (site != first_site);
  mesh_.twins[first + 1] = last + 2, mesh_.twins[last + 2] = first + 1;
}

/// A triangle's corners, counter-clockwise: its center is seen from the lowest, as coordinates of vertices are.
std::array<Index, 3> WeightedMesh::from_lowest(Index a, Index b, Index c) {
  if (b < a && b < c) return {b, c, a};
  if (c < a && c < b) return {c, a, b};
  return {a, b, c};
}

WeightedMesh::Center WeightedMesh::center(Index a, Index b, Index c) const {
  constexpr double k_known = 0x1p-20, k_epsilon = predicates::detail::k_epsilon;
  const std::array<Index, 3> sites = from_lowest(a, b, c);
  const WeightedPoint2& here = points_[sites[0]];
  const auto wave = [&](Index site) { return site == far_away() ? Wave{} : wave_of(here, points_[site]); };
  const WaveCrossing crossing = wave_crossing(wave(sites[1]), wave(sites[2]));
  const bool is_far = std::max(sites[1], sites[2]) == far_away();
  if (!(crossing.blur < k_known) || !(is_far || crossing.doubt < k_known * crossing.height))
    return {0, 0, std::numeric_limits<double>::infinity(), 0, true};
  if (is_far) return {crossing.x, crossing.y, crossing.blur, 0, true};
  const auto [x, y] = crossing_point(here, crossing.x, crossing.y, crossing.height);
  const double away = 0.5 / crossing.height;
  const double doubt = 2 * away * (crossing.blur + crossing.doubt / crossing.height) +
                       8 * k_epsilon * (std::fabs(x) + std::fabs(y) + away);
  return {x, y, doubt, 1, !crossing.is_good()};
}

Vec2 WeightedMesh::corner(Index triangle) const {
  const Center& center = centers_[triangle];
  if (!center.is_rough) return {center.x, center.y};
  const Index* const corner = mesh_.corners.data() + 4 * static_cast<std::size_t>(triangle);
  const std::array<Index, 3> sites = from_lowest(corner[0], corner[1], corner[2]);
  return rough_vertex(points_[sites[0]], &points_[sites[1]], &points_[sites[2]]);
}

WeightedMesh::Way WeightedMesh::way(Index site, const Center& center) const {
  return {center.x - center.w * points_[site].x, center.y - center.w * points_[site].y, center.doubt};
}

/// Sign of the turn from one way to another, 0 where that is not certain.
int WeightedMesh::turn(const Way& from, const Way& to) {
  constexpr double k_rounding = 8 * predicates::detail::k_epsilon;
  const double from_size = std::fabs(from.x) + std::fabs(from.y), to_size = std::fabs(to.x) + std::fabs(to.y);
  const double value = from.x * to.y - from.y * to.x;
  const double off =
      from_size * to.doubt + to_size * from.doubt + from.doubt * to.doubt + k_rounding * from_size * to_size;
  return static_cast<int>(value > off) - static_cast<int>(value < -off);
}

/// Tells whether between the centers beside the edge from one site to another there is a piece of curve.
bool WeightedMesh::is_piece(Index from, Index to, const Center& right, const Center& left) const {
  if (from == far_away()) return turn(way(to, left), way(to, right)) > 0;
  if (to == far_away()) return turn(way(from, right), way(from, left)) > 0;
  return may_follow(from, to, turn(way(from, right), way(from, left))) &&
         may_follow(to, from, turn(way(to, left), way(to, right)));
}

// From a heavier site the whole curve is seen under less than half a turn. So it tells which end of a piece comes
// first; seen from the lighter one, inside the curve, the piece may be more than half a turn.
bool WeightedMesh::may_follow(Index site, Index neighbor, int turn) const {
  return turn > 0 || (turn < 0 && neighbor != far_away() && points_[neighbor].weight > points_[site].weight);
}

bool WeightedMesh::is_side(Index half) const {
  return is_piece(mesh_.corners[half], mesh_.corners[next_half(half)], centers_[mesh_.twins[half] / 4],
                  centers_[half / 4]);
}

/// The centers beside a half-edge are brought near.
void WeightedMesh::ask_for_centers([[maybe_unused]] Index half) const {
#ifdef __GNUC__
  __builtin_prefetch(&centers_[mesh_.twins[half] / 4]);
  __builtin_prefetch(&centers_[half / 4]);
#endif
}

/// Tells whether a way that turns with some sign, by less than once, passes the x axis.
bool WeightedMesh::passes(const Way& from, const Way& to, int sign) {
  const bool was_low = from.y < 0, is_low = to.y < 0;
  return sign > 0 ? was_low && !is_low : was_low || !is_low;
}

/// `is_side`, and how often the ways of the sites at both ends pass the x axis.
bool WeightedMesh::is_side(Index half, std::int64_t& passed) const {
  const Index from = mesh_.corners[half], to = mesh_.corners[next_half(half)];
  const Center &right = centers_[mesh_.twins[half] / 4], &left = centers_[half / 4];
  bool result = true;
  const auto see = [&](Index site, Index neighbor, const Center& first, const Center& last) {
    if (site == far_away()) return;
    const Way begin = way(site, first), end = way(site, last);
    const int sign = turn(begin, end);
    result &= may_follow(site, neighbor, sign);
    passed += static_cast<std::int64_t>(passes(begin, end, sign));
  };
  see(from, to, right, left);
  see(to, from, left, right);
  return result;
}

WeightedMesh::Ring WeightedMesh::ring(Index site) const {
  Way last = way(site, centers_[last_in_ring(site) / 4]);
  Ring result{0, 0};
  Index lowest = far_away();
  visit_ring(site, [&](Index neighbor, Index half) {
    const Way next = way(site, centers_[half / 4]);
    result.turns += static_cast<Index>(passes(last, next, turn(last, next)));
    result.begins = neighbor < lowest ? 1 : result.begins + static_cast<Index>(neighbor == lowest);
    lowest = std::min(lowest, neighbor);
    last = next;
  });
  return result;
}

void WeightedMesh::find_centers(Index begin, Index end) {
  for (Index triangle = begin; triangle < end; ++triangle) {
    const Index* const corner = mesh_.corners.data() + 4 * static_cast<std::size_t>(triangle);
    if (corner[0] != k_none) centers_[triangle] = center(corner[0], corner[1], corner[2]);
  }
}

std::vector<WeightedMesh::Exchanges> WeightedMesh::blocks_of(Index size, Index count) {
  std::vector<Exchanges> result;
  for (Index begin = 0; begin < count; begin += std::min(size, count - begin))
    result.push_back({begin, begin + std::min(size, count - begin)});
  return result;
}

/// Finds all centers, and half-edges that are no sides.
std::vector<WeightedMesh::Exchanges> WeightedMesh::find_sides(int threads, const JobStage& stage) {
  const Index count = triangle_count();
  std::vector<Exchanges> result = blocks_of(k_sites, far_away() + 1);
  std::vector<std::vector<Index>> deferred(result.size());  // half-edges that lead from block to block
  const auto look_at = [&](Index half, Exchanges& block) {
    if (is_side(half, block.turns)) return;
    const Index from = mesh_.corners[half], to = mesh_.corners[next_half(half)];
    const bool is_here = std::min(from, to) >= block.begin && std::max(from, to) < block.end;
    (is_here ? block.wanted : block.beyond).push_back(half);
  };
  const Index blocks = static_cast<Index>(result.size());
  parallel_for(blocks, threads, 1, [&](Index i, int) {
    stage.update(0.9 * i / static_cast<double>(blocks));
    const Index begin = std::min(count, i * k_block), end = std::min(count, begin + k_block);
    find_centers(begin, end);
    std::vector<Index> later;
    for (Index triangle = begin; triangle < end; ++triangle) {
      if (mesh_.corners[4 * triangle] == k_none) continue;
      for (Index half = 4 * triangle; half < 4 * triangle + 3; ++half) {
        if (mesh_.twins[half] < half) continue;
        if (mesh_.twins[half] >= 4 * end) {
          later.push_back(half);
        } else {
          look_at(half, result[i]);
        }
      }
    }
    deferred[i] = std::move(later);
  });
  parallel_for(blocks, threads, 1, [&](Index i, int) {
    stage.check();
    for (std::size_t k = 0; k < deferred[i].size(); ++k) {
      ask_for_centers(deferred[i][std::min(k + k_ahead, deferred[i].size() - 1)]);
      look_at(deferred[i][k], result[i]);
    }
  });
  return result;
}

bool WeightedMesh::are_neighbors(Index a, Index b) const {
  const Index site = std::min(a, b), other = std::max(a, b);
  bool result = false;
  visit_ring(site, [&](Index neighbor, Index) { result |= neighbor == other; });
  return result;
}

/// Returns how often ways pass the x axis between the centers beside and about a half-edge.
std::int64_t WeightedMesh::passed_about(Index half) const {
  const Index twin = mesh_.twins[half];
  std::int64_t result = 0;
  for (const Index one : {half, next_half(half), previous_half(half), next_half(twin), previous_half(twin)})
    is_side(one, result);
  return result;
}

std::int64_t WeightedMesh::passed_by_all(int threads, const JobStage& stage) const {
  const Index count = triangle_count(), blocks = (count + k_block - 1) / k_block;
  std::atomic<std::int64_t> passed{0};
  parallel_for(blocks, threads, 1, [&](Index block, int) {
    stage.update(block / static_cast<double>(blocks));
    std::int64_t here = 0;
    for (Index triangle = block * k_block; triangle < std::min(count, (block + 1) * k_block); ++triangle) {
      if (mesh_.corners[4 * triangle] == k_none) continue;
      for (Index half = 4 * triangle; half < 4 * triangle + 3; ++half)
        if (mesh_.twins[half] < half) is_side(half, here);
    }
    passed += here;
  });
  return passed;
}

/// Exchanges two triangles if there is a piece of curve between the new ones.
bool WeightedMesh::exchange(Index half, Exchanges& some) {
  const Index twin = mesh_.twins[half], from = mesh_.corners[half], to = mesh_.corners[twin];
  const Index left = mesh_.corners[previous_half(half)], right = mesh_.corners[previous_half(twin)];
  if (left == right) return false;
  const Center near_from = center(from, right, left), near_to = center(to, left, right);
  if (!is_piece(right, left, near_to, near_from)) return false;
  if (are_neighbors(left, right)) some.repeated.insert(some.repeated.end(), {left, right});
  if (!recounts_) some.turns -= passed_about(half);
  PlanarMesh view{nullptr, nullptr, far_away(), mesh_.corners.data(), mesh_.twins.data(), 0};
  exchange_pair(view, half);
  centers_[half / 4] = near_from;
  centers_[twin / 4] = near_to;
  if (from != far_away()) mesh_.leaving[from] = half;
  if (to != far_away()) mesh_.leaving[to] = twin;
  if (!recounts_) some.turns += passed_about(next_half(half));
  return true;
}

/// Exchanges triangles all of whose corners are among some sites, and reads no others that are. So threads with
/// different sites do not meet: each triangle is one's alone, or nobody changes its corners, and the edges between two
/// sites are theirs alone.
void WeightedMesh::exchange_within(Exchanges& some, const JobStage& stage) {
  const auto is_here = [&](Index site) { return some.begin <= site && site < some.end; };
  std::vector<Index>& wanted = some.wanted;
  std::size_t done = 0;
  const std::size_t most = 64 * static_cast<std::size_t>(some.end - some.begin);  // never seen, but not shown to do
  while (!wanted.empty() && done < most) {
    if (++done % k_block == 0) stage.check();
    const Index half = wanted.back(), twin = mesh_.twins[half];
    wanted.pop_back();
    if (is_side(half)) continue;
    if (!is_here(mesh_.corners[previous_half(half)]) || !is_here(mesh_.corners[previous_half(twin)])) {
      some.beyond.push_back(half);
    } else if (exchange(half, some)) {
      wanted.insert(wanted.end(), {half, previous_half(half), twin, previous_half(twin)});
    } else {
      some.bad.push_back(half);
    }
  }
  some.bad.insert(some.bad.end(), wanted.begin(), wanted.end());
}

/// Exchanges what can be, between few sites first, side by side, then between more. Which cells the mesh has then does
/// not depend on the order.
WeightedMesh::Exchanges WeightedMesh::exchange_all(std::vector<Exchanges>&& blocks, int threads,
                                                   const JobStage& stage) {
  constexpr Index k_more = 8;
  const Index count = far_away() + 1;
  const auto take = [](std::vector<Index>& to, std::vector<Index>& from) {
    to.insert(to.end(), from.begin(), from.end());
    from.clear();
  };
  Exchanges all{0, count};
  for (Exchanges& block : blocks) take(all.beyond, block.beyond);
  for (Index size = k_sites; !all.beyond.empty() || size == k_sites; size *= k_more) {
    if (size > k_sites) blocks = blocks_of(size, count);
    for (const Index half : all.beyond) {
      const Index from = mesh_.corners[half] / size, to = mesh_.corners[next_half(half)] / size;
      (from == to ? blocks[from].wanted : blocks[from].beyond).push_back(half);
    }
    all.beyond.clear();
    parallel_for(static_cast<Index>(blocks.size()), threads, 1, [&](Index i, int) {
      stage.check();
      exchange_within(blocks[i], stage);
    });
    for (Exchanges& block : blocks) {
      take(all.beyond, block.beyond);
      take(all.bad, block.bad);
      take(all.repeated, block.repeated);
      all.turns += block.turns;
    }
  }
  return all;
}

// Around a site with sides only, the ways turn once or more often: if together they turn as often as there are such
// sites, then around each of them they turn once.
void WeightedMesh::improve(int threads, const JobStage& stage) {
  std::vector<Exchanges> blocks = find_sides(threads, stage.part(0, 0.8));
  std::size_t bad = 0;
  for (const Exchanges& block : blocks) bad += block.wanted.size() + block.beyond.size();
  constexpr std::size_t k_many = 16;  // one in so many sites: then all turns are counted sooner than those that change
  recounts_ = bad > points_.size() / k_many;
  Exchanges all = exchange_all(std::move(blocks), threads, stage);
  if (recounts_) all.turns = passed_by_all(threads, stage.part(0.8, 1));
  find_certain(all, threads, stage);
  stage.update(1);
}

void WeightedMesh::find_certain(const Exchanges& all, int threads, const JobStage& stage) {
  const auto is_certain = [&](Index site) { return std::atomic_ref(is_certain_[site]); };
  const auto doubt = [&](Index site) {
    if (site != far_away()) is_certain(site).store(0, std::memory_order_relaxed);
  };
  const auto for_blocks = [&](std::size_t count, auto&& work) {
    parallel_for(static_cast<Index>((count + k_sites - 1) / k_sites), threads, 1, [&](Index block, int) {
      stage.check();
      const std::size_t begin = static_cast<std::size_t>(block) * k_sites;
      work(begin, std::min(count, begin + k_sites));
    });
  };
  for_blocks(points_.size(), [&](std::size_t begin, std::size_t end) {
    std::fill(is_certain_.begin() + begin, is_certain_.begin() + end, std::uint8_t{1});
  });
  for_blocks(all.bad.size(), [&](std::size_t begin, std::size_t end) {
    for (const Index half : std::span(all.bad).subspan(begin, end - begin)) {
      if (is_side(half)) continue;
      doubt(mesh_.corners[half]);
      doubt(mesh_.corners[next_half(half)]);
    }
  });
  for_blocks(all.repeated.size(), [&](std::size_t begin, std::size_t end) {
    for (const Index site : std::span(all.repeated).subspan(begin, end - begin)) {
      if (site == far_away() || is_certain(site).load(std::memory_order_relaxed) == 0) continue;
      const Ring found = ring(site);
      if (found.turns != 1 || found.begins != 1) doubt(site);
    }
  });
  std::atomic<std::int64_t> left{all.turns - far_away()};  // turns too many of certain sites
  for_blocks(points_.size(), [&](std::size_t begin, std::size_t end) {
    std::int64_t doubted = 0;
    for (std::size_t site = begin; site < end; ++site)
      if (is_certain_[site] == 0) doubted += ring(static_cast<Index>(site)).turns - 1;
    left -= doubted;
  });
  if (left == 0) return;
  for_blocks(points_.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t site = begin; site < end; ++site)
      if (is_certain_[site] != 0 && ring(static_cast<Index>(site)).turns != 1) is_certain_[site] = 0;
  });
}

}  // namespace saddleback::voronoi2d
