#include "voronoi2d/weighted_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/parallel.h"
#include "voronoi2d/weighted_wave.h"

namespace saddleback::voronoi2d {

using predicates::WeightedPoint2;

namespace {

constexpr Index k_block = 4096;  ///< sites, a thread's work at a time

template <class Work>
void for_blocks(Index count, int threads, const JobStage& stage, Work&& work) {
  const Index blocks = (count + k_block - 1) / k_block;
  parallel_for(blocks, threads, 1, [&](Index block, int thread) {
    stage.update(block / static_cast<double>(blocks));
    work(block * k_block, std::min(count, (block + 1) * k_block), thread);
  });
}

}  // namespace

WeightedMesh::WeightedMesh(Triangulation&& triangulation, std::span<const WeightedPoint2> points)
    : mesh_(std::move(triangulation)), points_(points) {
  add_far_triangles();
  centres_.resize(mesh_.corners.size() / 4);
  is_certain_.resize(points.size());
}

Index WeightedMesh::free_triangle(Index from) const {
  while (mesh_.corners[4 * from] != k_none) ++from;
  return from;
}

/// Beyond each edge of the border a triangle with the infinitely far.
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

/// Of a triangle that turns counter-clockwise. Seen from the lowest site, as coordinates of vertices are.
WeightedMesh::Centre WeightedMesh::centre(Index a, Index b, Index c) const {
  constexpr double k_good = 0x1p-36, k_epsilon = predicates::detail::k_epsilon;
  if (b < a && b < c) {
    std::swap(a, b), std::swap(b, c);
  } else if (c < a && c < b) {
    std::swap(a, c), std::swap(b, c);
  }
  const WeightedPoint2& here = points_[a];
  const auto wave = [&](Index site) { return site == far_away() ? Wave{} : wave_of(here, points_[site]); };
  const WaveCrossing crossing = wave_crossing(wave(b), wave(c));
  if (!(crossing.blur < k_good)) return {0, 0, 0, std::numeric_limits<double>::infinity()};
  if (std::max(b, c) == far_away()) return {crossing.x, crossing.y, 0, crossing.blur};
  if (!(crossing.doubt < k_good * crossing.height)) return {0, 0, 0, std::numeric_limits<double>::infinity()};
  const double x = here.x + 0.5 * crossing.x / crossing.height, y = here.y + 0.5 * crossing.y / crossing.height;
  const double away = 0.5 / crossing.height;
  return {x, y, 1,
          2 * away * (crossing.blur + crossing.doubt / crossing.height) +
              8 * k_epsilon * (std::fabs(x) + std::fabs(y) + away)};
}

WeightedMesh::Way WeightedMesh::way(Index site, const Centre& centre) const {
  return {centre.x - centre.w * points_[site].x, centre.y - centre.w * points_[site].y, centre.doubt};
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

/// Whether between the centres beside the edge from one site to another there is a piece of curve.
bool WeightedMesh::is_piece(Index from, Index to, const Centre& right, const Centre& left) const {
  if (from == far_away()) return turn(way(to, left), way(to, right)) > 0;
  if (to == far_away()) return turn(way(from, right), way(from, left)) > 0;
  return may_follow(from, to, turn(way(from, right), way(from, left))) &&
         may_follow(to, from, turn(way(to, left), way(to, right)));
}

// From a heavier site the whole curve is seen under less than half a turn. So it tells which end of a piece comes
// first; seen from the lighter one, inside the curve, the piece may be more than half a turn.
bool WeightedMesh::may_follow(Index site, Index neighbour, int turn) const {
  return turn > 0 || (turn < 0 && neighbour != far_away() && points_[neighbour].weight > points_[site].weight);
}

bool WeightedMesh::is_side(Index half) const {
  return is_piece(mesh_.corners[half], mesh_.corners[next_half(half)], centres_[mesh_.twins[half] / 4],
                  centres_[half / 4]);
}

/// Adds the half-edges that are in the way. Not certain, too, is where a cell begins that has several sides towards its
/// lowest neighbour.
bool WeightedMesh::is_turned_once(Index site, std::vector<Index>& bad) const {
  const Index first = mesh_.leaving[site];
  const std::size_t bad_before = bad.size();
  Way last = way(site, centres_[first / 4]);
  Index half = first, turn_count = 0, lowest = far_away(), lowest_count = 0;
  do {
    half = next_around(half);
    const Index neighbour = mesh_.corners[next_half(half)];
    const Way next = way(site, centres_[half / 4]);
    const int sign = turn(last, next);
    if (!may_follow(site, neighbour, sign)) bad.push_back(half);
    const bool was_low = last.y < 0, is_low = next.y < 0;  // passes the x axis if it does so, or is more than half
    turn_count += static_cast<Index>(sign > 0 ? was_low && !is_low : was_low || !is_low);
    lowest_count = neighbour < lowest ? 1 : lowest_count + static_cast<Index>(neighbour == lowest);
    lowest = std::min(lowest, neighbour);
    last = next;
  } while (half != first);
  return turn_count == 1 && lowest_count == 1 && bad.size() == bad_before;
}

void WeightedMesh::find_centres(int threads, const JobStage& stage) {
  for_blocks(static_cast<Index>(centres_.size()), threads, stage, [&](Index begin, Index end, int) {
    for (Index triangle = begin; triangle < end; ++triangle) {
      const Index* const corner = mesh_.corners.data() + 4 * static_cast<std::size_t>(triangle);
      if (corner[0] != k_none) centres_[triangle] = centre(corner[0], corner[1], corner[2]);
    }
  });
}

/// Exchanges two triangles if there is a piece of curve between the new ones.
bool WeightedMesh::exchange(Index half) {
  const Index twin = mesh_.twins[half], from = mesh_.corners[half], to = mesh_.corners[twin];
  const Index left = mesh_.corners[previous_half(half)], right = mesh_.corners[previous_half(twin)];
  if (left == right) return false;
  const Centre near_from = centre(from, right, left), near_to = centre(to, left, right);
  if (!is_piece(right, left, near_to, near_from)) return false;
  PlanarMesh view{nullptr, nullptr, far_away(), mesh_.corners.data(), mesh_.twins.data(), 0};
  exchange_pair(view, half);
  centres_[half / 4] = near_from;
  centres_[twin / 4] = near_to;
  if (from != far_away()) mesh_.leaving[from] = half;
  if (to != far_away()) mesh_.leaving[to] = twin;
  return true;
}

/// Leaves the sites about exchanged edges in place of the bad ones.
void WeightedMesh::exchange_all(std::vector<Index>& bad, const JobStage& stage) {
  std::vector<Index> touched;
  const std::size_t most = 16 * points_.size();  // exchanges: never seen, but not shown that they must end
  while (!bad.empty() && touched.size() < 4 * most) {
    if (touched.size() % k_block == 0) stage.check();
    const Index half = bad.back();
    bad.pop_back();
    if (is_side(half)) continue;
    const Index twin = mesh_.twins[half];
    if (!exchange(half)) continue;
    for (const Index one : {half, twin}) {
      touched.push_back(mesh_.corners[one]);
      touched.push_back(mesh_.corners[previous_half(one)]);
      bad.push_back(one);
      bad.push_back(previous_half(one));
    }
  }
  bad.swap(touched);
}

void WeightedMesh::improve(int threads, const JobStage& stage) {
  const Index count = far_away();
  find_centres(threads, stage.part(0, 0.4));
  std::vector<std::vector<Index>> bad(thread_count(threads));
  for_blocks(count, threads, stage.part(0.4, 0.8), [&](Index begin, Index end, int thread) {
    for (Index site = begin; site < end; ++site)
      is_certain_[site] = static_cast<std::uint8_t>(is_turned_once(site, bad[thread]));
  });
  std::vector<Index> all;
  for (const std::vector<Index>& some : bad) all.insert(all.end(), some.begin(), some.end());
  exchange_all(all, stage);
  bad[0].clear();
  for (const Index site : all)
    if (site != count) is_certain_[site] = 0;
  for (const Index site : all)
    if (site != count && is_certain_[site] == 0)
      is_certain_[site] = static_cast<std::uint8_t>(is_turned_once(site, bad[0]));
  stage.update(1);
}

}  // namespace saddleback::voronoi2d
