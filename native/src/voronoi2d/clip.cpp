// A cell that no edge of the domain comes near is taken whole or not at all. Elsewhere the domain is cut by the cell's
// sides, one after another; each cut joins what is left of all loops along the side, so that parts and holes come out
// as loops of their own.

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/error.h"
#include "saddleback/voronoi_2d.h"

#include "support/parallel.h"
#include "voronoi2d/clip_weighted.h"
#include "voronoi2d/domain_map.h"
#include "voronoi2d/loops.h"

namespace saddleback {

using namespace voronoi2d;

namespace {

/// The side of a cell: points at least as near to `mine` as to `other`. The values for the cells on both sides are each
/// other's negatives, to the last bit, so that neighbours are cut at the same points.
struct Side {
  Vec2 middle, along, across;
  double distance = 0;  ///< that points must keep from the side, in the unit of `value`
  Side(const Vec2& mine, const Vec2& other)
      : middle(0.5 * mine + 0.5 * other), along(mine.y() - other.y(), other.x() - mine.x()), across(mine - other) {}
  double value(const Vec2& p) const { return (p - middle).dot(across) - distance; }
};

/// What a cut leaves of a loop: from where it comes in to where it goes out.
struct Chain {
  Loop points;
  double in, out;  ///< places along the side
};

// The chains of a loop that has points on both sides.
void cut_loop(const Loop& loop, const std::vector<double>& values, const Side& side, std::vector<Chain>& chains) {
  const std::size_t count = loop.size();
  std::size_t start = 0;
  while (values[start] >= 0) ++start;  // outside: whatever comes in from here on goes out again
  bool is_in = false;
  for (std::size_t step = 0; step < count; ++step) {
    const std::size_t i = (start + step) % count, j = (i + 1) % count;
    const bool will_be_in = values[j] >= 0;
    if (is_in != will_be_in) {
      const Vec2 crossing = loop[i] + (values[i] / (values[i] - values[j])) * (loop[j] - loop[i]);
      const double place = (crossing - side.middle).dot(side.along);
      if (will_be_in) chains.push_back({{}, place, 0});
      add_point(chains.back().points, crossing);
      if (!will_be_in) chains.back().out = place;
    }
    if (will_be_in) add_point(chains.back().points, loop[j]);
    is_in = will_be_in;
  }
}

// Going out at one place the border of what is left runs along the side to the next place where a chain comes in.
void join_chains(std::vector<Chain>& chains, std::vector<Loop>& loops) {
  std::vector<std::size_t> by_in(chains.size()), by_out(chains.size()), next(chains.size());
  for (std::size_t i = 0; i < chains.size(); ++i) by_in[i] = by_out[i] = i;
  std::sort(by_in.begin(), by_in.end(), [&](std::size_t a, std::size_t b) { return chains[a].in < chains[b].in; });
  std::sort(by_out.begin(), by_out.end(), [&](std::size_t a, std::size_t b) { return chains[a].out < chains[b].out; });
  for (std::size_t k = 0; k < chains.size(); ++k) next[by_out[k]] = by_in[k];
  std::vector<bool> is_done(chains.size(), false);
  for (std::size_t first = 0; first < chains.size(); ++first) {
    if (is_done[first]) continue;
    Loop loop;
    for (std::size_t chain = first; !is_done[chain]; chain = next[chain]) {
      is_done[chain] = true;
      for (const Vec2& point : chains[chain].points) add_point(loop, point);
    }
    if (loop.size() > 1 && loop.front() == loop.back()) loop.pop_back();
    if (loop.size() >= 3) loops.push_back(std::move(loop));
  }
}

void cut(std::vector<Loop>& loops, const Side& side) {
  std::vector<Loop> kept;
  std::vector<Chain> chains;
  std::vector<double> values;
  for (Loop& loop : loops) {
    values.resize(loop.size());
    std::transform(loop.begin(), loop.end(), values.begin(), [&](const Vec2& p) { return side.value(p); });
    const auto is_in = [](double value) { return value >= 0; };
    if (std::all_of(values.begin(), values.end(), is_in)) {
      kept.push_back(std::move(loop));
    } else if (std::any_of(values.begin(), values.end(), is_in)) {
      cut_loop(loop, values, side, chains);
    }
  }
  join_chains(chains, kept);
  loops = std::move(kept);
}

std::vector<Loop> clip_cell(const Voronoi2d& diagram, Index site, const PlanarDomain& domain, const DomainMap& map,
                            double gap) {
  std::vector<Loop> loops(domain.loops().begin(), domain.loops().end());
  if (diagram.is_bounded(site)) {
    Vec2 low = diagram.sites[site], high = low;
    Loop whole;
    for (const Index vertex : diagram.cell_vertices(site)) {
      whole.push_back(diagram.vertices[vertex]);
      low = low.cwiseMin(whole.back());
      high = high.cwiseMax(whole.back());
    }
    switch (map.place(low, high)) {
      case DomainMap::Place::inside:
        if (gap == 0) return {whole};
        loops.assign(1, whole);
        break;
      case DomainMap::Place::outside:
        return {};
      case DomainMap::Place::at_edge:
        break;
    }
  }
  for (const Index edge : diagram.cell_edges(site)) {
    const auto [left, right] = diagram.edge_sites[edge];
    Side side(diagram.sites[site], diagram.sites[left == site ? right : left]);
    side.distance = 0.5 * gap * side.across.norm();
    cut(loops, side);
  }
  return loops;
}

}  // namespace

ClippedCells Voronoi2d::clip(const PlanarDomain& domain, int threads, Job* job) const {
  return clip(domain, {.threads = threads}, JobStage(job, "Clipping cells"));
}

ClippedCells Voronoi2d::clip(const PlanarDomain& domain, const ClipOptions& options, const JobStage& stage) const {
  const double gap = options.gap, tolerance = options.tolerance;
  if (!(gap >= 0) || std::isinf(gap)) throw InputError(message("gap: wanted a length of 0 or more, got ", gap));
  if (gap > 0 && !weights.empty()) throw InputError("gap: wanted 0 for sites with weights, whose edges are curved");
  if (!(tolerance >= 0)) throw InputError(message("tolerance: wanted a length of 0 or more, got ", tolerance));
  const Index count = static_cast<Index>(sites.size());
  const double side = 0.5 * std::sqrt(static_cast<double>(cell_sites.size()));
  const DomainMap map(domain, std::clamp(static_cast<Index>(side), 1, 1024));
  const double mean_width = std::sqrt(domain.area() / std::max<double>(1, static_cast<double>(cell_sites.size())));
  const CurvedCells curved(*this, domain, map, tolerance > 0 ? tolerance : 1e-3 * mean_width);
  std::vector<std::vector<Loop>> cells(count);
  ClippedCells result;
  result.areas.assign(count, 0);
  result.centroids.assign(count, Vec2::Constant(std::numeric_limits<double>::quiet_NaN()));
  constexpr Index k_block = 256;
  parallel_for(count, options.threads, k_block, [&](Index site, int) {
    if (site % k_block == 0) stage.check();
    if (site_of[site] != site || cell_places[site] == k_none) return;
    cells[site] = weights.empty() ? clip_cell(*this, site, domain, map, gap) : curved.clip(site);
    if (cells[site].empty()) return;
    add_moments(cells[site], cells[site][0][0], result.areas[site], result.centroids[site]);
  });
  stage.update(0.8);
  result.loop_offsets.push_back(0);
  for (Index site = 0; site < count; ++site) {
    for (const Loop& loop : cells[site]) {
      result.points.insert(result.points.end(), loop.begin(), loop.end());
      result.loop_offsets.push_back(static_cast<Index>(result.points.size()));
      result.loop_sites.push_back(site);
    }
  }
  stage.update(1);
  return result;
}

}  // namespace saddleback
