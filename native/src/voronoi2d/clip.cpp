// A cell that no edge of the domain comes near is taken whole or not at all. Elsewhere the domain is cut by the cell's
// sides, one after another; each cut joins what is left of all loops along the side, so that parts and holes come out
// as loops of their own.

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/error.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

#include "support/threads/parallel.h"
#include "voronoi2d/clipping/clip_weighted.h"
#include "voronoi2d/clipping/domain_map.h"
#include "voronoi2d/clipping/loops.h"
#include "voronoi2d/diagram/cell_sides.h"

namespace saddleback {

using namespace voronoi2d;

namespace {

/// The side of a cell: points at least as near to `mine` as to `other`, through a point of the line between them. The
/// values for the cells on both sides are each other's negatives, to the last bit, so that neighbors are cut at the
/// same points.
struct Side {
  Vec2 middle, along, across;
  double distance = 0;  ///< that points must keep from the side, in the unit of `value`
  Side(const Vec2& mine, const Vec2& other, const Vec2& through)
      : middle(through), along(mine.y() - other.y(), other.x() - mine.x()), across(mine - other) {}
  double value(const Vec2& p) const { return (p - middle).dot(across) - distance; }
};

struct Corner {
  Vec2 place;
  Index side;  ///< of the cell, that goes on from here; k_none for edges of the domain
};
using Corners = std::vector<Corner>;

/// Holds what a cut leaves of a loop: from where it comes in to where it goes out.
struct Chain {
  std::size_t begin, end;  ///< of the corners of all chains
  double in, out;          ///< places along the side
};

/// Cuts the domain by the sides of a cell, one after another.
class CellClip {
 public:
  CellClip(const Voronoi2d& diagram, Index site, double gap) : sides_(diagram, site), gap_(gap) {}

  std::vector<Loop> clip(std::span<const Loop> within) {
    for (const Loop& loop : within) {
      Corners& corners = loops_.emplace_back(loop.size());
      for (std::size_t i = 0; i < loop.size(); ++i) corners[i] = {loop[i], k_none};
    }
    for (Index k = 0; k < sides_.count() && !loops_.empty(); ++k) cut(k);
    std::vector<Loop> result;
    for (const Corners& corners : loops_) {
      Loop& loop = result.emplace_back(corners.size());
      for (std::size_t i = 0; i < loop.size(); ++i) loop[i] = corners[i].place;
    }
    return result;
  }

 private:
  Side side(Index k) const {
    Side result(sides_.mine(), sides_.neighbor(k), sides_.middle(k));
    result.distance = 0.5 * gap_ * result.across.norm();
    return result;
  }

  void cut(Index k) {
    const Side by = side(k);
    kept_.clear();
    chains_.clear();
    chain_corners_.clear();
    for (Corners& loop : loops_) {
      values_.resize(loop.size());
      for (std::size_t i = 0; i < loop.size(); ++i)
        values_[i] = value(loop[i == 0 ? loop.size() - 1 : i - 1].side, loop[i], k, by);
      const auto is_in = [](double value) { return value >= 0; };
      if (std::all_of(values_.begin(), values_.end(), is_in)) {
        kept_.push_back(std::move(loop));
      } else if (std::any_of(values_.begin(), values_.end(), is_in)) {
        cut_loop(loop, k, by);
      }
    }
    join_chains();
    loops_.swap(kept_);
  }

  // The chains of a loop that has points on both sides.
  void cut_loop(const Corners& loop, Index k, const Side& by) {
    const std::size_t count = loop.size();
    std::size_t start = 0;
    while (values_[start] >= 0) ++start;  // outside: whatever comes in from here on goes out again
    bool is_in = false;
    for (std::size_t step = 0, i = start; step < count; ++step) {
      const std::size_t j = i + 1 == count ? 0 : i + 1;
      const bool will_be_in = values_[j] >= 0;
      if (is_in != will_be_in) {
        const Vec2 point = crossing(loop[i], loop[j].place, k, by);
        const double place = (point - by.middle).dot(by.along);
        if (will_be_in) chains_.push_back({chain_corners_.size(), 0, place, 0});
        add_corner(chain_corners_, chains_.back().begin, {point, will_be_in ? loop[i].side : k});
        if (!will_be_in) chains_.back().end = chain_corners_.size(), chains_.back().out = place;
      }
      if (will_be_in) add_corner(chain_corners_, chains_.back().begin, loop[j]);
      is_in = will_be_in;
      i = j;
    }
  }

  static void add_corner(Corners& corners, std::size_t begin, const Corner& corner) {
    if (corners.size() == begin || corners.back().place != corner.place) return corners.push_back(corner);
    corners.back().side = corner.side;
  }

  double value(Index side_before, const Corner& corner, Index k, const Side& by) const {
    const bool is_first = side_before == k_none, is_last = corner.side == k_none;
    if (gap_ > 0 || (is_first && is_last)) return by.value(corner.place);
    int least = 1;
    if (is_first || is_last || sides_.vertex_between(side_before, corner.side) == k_none)
      for (const Index j : {side_before, corner.side})
        if (j != k_none) least = std::min(least, sides_.compare(corner.place, j, k));
    return least == 0 ? by.value(corner.place) : least;
  }

  Vec2 crossing(const Corner& from, const Vec2& to, Index k, const Side& by) const {
    if (from.side != k_none) return CellSides::place_between(from.place, sides_.meeting(from.side, k, 0.5 * gap_), to);
    const double at_from = by.value(from.place), share = at_from / (at_from - by.value(to));
    return from.place + (share > 0 ? std::min(share, 1.0) : 0.0) * (to - from.place);
  }

  // Going out at one place the border of what is left runs along the side to the next place where a chain comes in.
  void join_chains() {
    const std::size_t count = chains_.size();
    by_in_.resize(count), by_out_.resize(count), next_.resize(count), is_done_.assign(count, false);
    for (std::size_t i = 0; i < count; ++i) by_in_[i] = by_out_[i] = i;
    std::sort(by_in_.begin(), by_in_.end(),
              [&](std::size_t a, std::size_t b) { return chains_[a].in < chains_[b].in; });
    std::sort(by_out_.begin(), by_out_.end(),
              [&](std::size_t a, std::size_t b) { return chains_[a].out < chains_[b].out; });
    for (std::size_t k = 0; k < count; ++k) next_[by_out_[k]] = by_in_[k];
    for (std::size_t first = 0; first < count; ++first) {
      if (is_done_[first]) continue;
      Corners loop;
      for (std::size_t chain = first; !is_done_[chain]; chain = next_[chain]) {
        is_done_[chain] = true;
        for (std::size_t i = chains_[chain].begin; i < chains_[chain].end; ++i) add_corner(loop, 0, chain_corners_[i]);
      }
      if (loop.size() > 1 && loop.front().place == loop.back().place) loop.pop_back();
      if (loop.size() >= 3) kept_.push_back(std::move(loop));
    }
  }

  CellSides sides_;
  double gap_;
  std::vector<Corners> loops_, kept_;
  // Of the cut at hand.
  std::vector<double> values_;  ///< at the corners of a loop
  std::vector<Chain> chains_;
  Corners chain_corners_;
  std::vector<std::size_t> by_in_, by_out_, next_;
  std::vector<bool> is_done_;
};

std::vector<Loop> clip_cell(const Voronoi2d& diagram, Index site, const PlanarDomain& domain, const DomainMap& map,
                            double gap) {
  CellClip cell(diagram, site, gap);
  if (!diagram.is_bounded(site)) return cell.clip(domain.loops());
  Vec2 low = diagram.sites[site], high = low;
  Loop whole;
  for (const Index vertex : diagram.cell_vertices(site)) {
    whole.push_back(diagram.vertices[vertex]);
    low = low.cwiseMin(whole.back());
    high = high.cwiseMax(whole.back());
  }
  switch (map.place(low, high)) {
    case DomainMap::Place::inside:
      return gap == 0 ? std::vector<Loop>{whole} : cell.clip({&whole, 1});
    case DomainMap::Place::outside:
      return {};
    case DomainMap::Place::at_edge:
      break;
  }
  return cell.clip(domain.loops());
}

}  // namespace

ClippedCells Voronoi2d::clip(const PlanarDomain& domain, int threads, Job* job) const {
  return clip(domain, {.threads = threads}, JobStage(job, "Clipping cells"));
}

ClippedCells Voronoi2d::clip(const PlanarDomain& domain, const ClipOptions& options, const JobStage& stage) const {
  const double gap = options.gap, tolerance = options.tolerance;
  if (!(gap >= 0) || std::isinf(gap)) throw InputError(message("gap: wanted a length of 0 or more, got ", gap));
  if (gap > 0 && !weights.empty() && !(domain.area() > 0))
    throw InputError("polygon: its area is less than any number, too small for a gap between curved edges");
  if (!(tolerance >= 0)) throw InputError(message("tolerance: wanted a length of 0 or more, got ", tolerance));
  const Index count = static_cast<Index>(sites.size());
  const double side = 0.5 * std::sqrt(static_cast<double>(cell_sites.size()));
  const DomainMap map(domain, std::clamp(static_cast<Index>(side), 1, 1024));
  const double mean_width = std::sqrt(domain.area() / std::max<double>(1, static_cast<double>(cell_sites.size())));
  constexpr double k_usual = 1e-3, k_finest = 0x1p-28;  // of which an edge as long as a cell is wide has thousands
  const CurvedCells curved(*this, domain, map,
                           tolerance > 0 ? std::max(tolerance, k_finest * mean_width) : k_usual * mean_width, gap,
                           stage);
  std::vector<std::vector<Loop>> cells(count);
  ClippedCells result;
  result.areas.assign(count, 0);
  result.centroids.assign(count, Vec2::Constant(std::numeric_limits<double>::quiet_NaN()));
  constexpr Index k_block = 256;
  parallel_for(count, options.threads, k_block, [&](Index site, int) {
    if (site % k_block == 0) stage.update(0.8 * site / count);
    if (site_of[site] != site || cell_places[site] == k_none) return;
    cells[site] = weights.empty() ? clip_cell(*this, site, domain, map, gap) : curved.clip(site);
    if (cells[site].empty()) return;
    add_moments(cells[site], cells[site][0][0], result.areas[site], result.centroids[site]);
  });
  stage.update(0.8);
  result.loop_offsets.push_back(0);
  for (Index site = 0; site < count; ++site) {
    if (site % k_block == 0) stage.check();
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
