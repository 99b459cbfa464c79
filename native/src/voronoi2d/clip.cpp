// A cell that no edge of the domain comes near is taken whole or not at all. Elsewhere the domain is cut by the cell's
// sides, one after another; each cut joins what is left of all loops along the side, so that parts and holes come out
// as loops of their own.

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/error.h"
#include "saddleback/voronoi_2d.h"

#include "support/parallel.h"

namespace saddleback {
namespace {

using Loop = std::vector<Vec2>;

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

void add_point(Loop& loop, const Vec2& point) {
  if (loop.empty() || loop.back() != point) loop.push_back(point);
}

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

/// Squares over the domain's box, marked where an edge may pass.
class EdgeMap {
 public:
  EdgeMap(const PlanarDomain& domain, Index size) : domain_(domain), size_(size) {
    for (const Vec2& p : domain.loops()[0]) {
      lower_ = lower_.cwiseMin(p);
      upper_ = upper_.cwiseMax(p);
    }
    scale_ = (upper_ - lower_).cwiseInverse() * size;
    sums_.assign(static_cast<std::size_t>(size + 1) * (size + 1), 0);
    for (const auto& loop : domain.loops())
      for (std::size_t i = 0; i < loop.size(); ++i) mark(loop[i], loop[(i + 1) % loop.size()]);
    for (Index y = 1; y <= size; ++y)
      for (Index x = 1; x <= size; ++x) sum(x, y) += sum(x - 1, y) + sum(x, y - 1) - sum(x - 1, y - 1);
  }

  enum class Place { outside, inside, at_edge };
  /// Where a box lies; `at_edge` when in doubt.
  Place place(const Vec2& low, const Vec2& high) const {
    if ((high.array() < lower_.array()).any() || (low.array() > upper_.array()).any()) return Place::outside;
    if ((low.array() < lower_.array()).any() || (high.array() > upper_.array()).any()) return Place::at_edge;
    const Index x = column(low.x()), y = row(low.y()), end_x = column(high.x()) + 1, end_y = row(high.y()) + 1;
    if (sum(end_x, end_y) - sum(x, end_y) - sum(end_x, y) + sum(x, y) > 0) return Place::at_edge;
    return domain_.contains(low) ? Place::inside : Place::outside;
  }

 private:
  Index column(double x) const { return std::clamp(static_cast<Index>((x - lower_.x()) * scale_.x()), 0, size_ - 1); }
  Index row(double y) const { return std::clamp(static_cast<Index>((y - lower_.y()) * scale_.y()), 0, size_ - 1); }
  Index& sum(Index x, Index y) { return sums_[static_cast<std::size_t>(y) * (size_ + 1) + x]; }
  Index sum(Index x, Index y) const { return sums_[static_cast<std::size_t>(y) * (size_ + 1) + x]; }

  // One square more on every side than the edge meets, for the sake of rounding.
  void mark(Vec2 a, Vec2 b) {
    if (a.y() > b.y()) std::swap(a, b);
    const Index first = std::max(0, row(a.y()) - 1), last = std::min(size_ - 1, row(b.y()) + 1);
    for (Index y = first; y <= last; ++y) {
      const auto x_at = [&](Index line) {
        const double share = (lower_.y() + line / scale_.y() - a.y()) / (b.y() - a.y());
        return a.x() + (share > 0 ? std::min(share, 1.0) : 0.0) * (b.x() - a.x());
      };
      const bool is_level = row(a.y()) == row(b.y());
      const double from = is_level ? a.x() : x_at(y - 1), to = is_level ? b.x() : x_at(y + 2);
      const Index begin = std::max(0, column(std::min(from, to)) - 1),
                  end = std::min(size_ - 1, column(std::max(from, to)) + 1);
      for (Index x = begin; x <= end; ++x) sum(x + 1, y + 1) = 1;
    }
  }

  const PlanarDomain& domain_;
  Index size_;
  Vec2 lower_ = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 upper_ = -lower_;
  Vec2 scale_;  ///< squares by length
  std::vector<Index> sums_;
};

std::vector<Loop> clip_cell(const Voronoi2d& diagram, Index site, const PlanarDomain& domain, const EdgeMap& map,
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
      case EdgeMap::Place::inside:
        if (gap == 0) return {whole};
        loops.assign(1, whole);
        break;
      case EdgeMap::Place::outside:
        return {};
      case EdgeMap::Place::at_edge:
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

// Area and centre of mass of loops, counted from a point near them.
void add_moments(const std::vector<Loop>& loops, const Vec2& near, double& area, Vec2& centroid) {
  double twice_area = 0;
  Vec2 moment(0, 0);
  for (const Loop& loop : loops) {
    Vec2 before = loop.back() - near;
    for (const Vec2& point : loop) {
      const Vec2 corner = point - near;
      const double cross = before.x() * corner.y() - before.y() * corner.x();
      twice_area += cross;
      moment += cross * (before + corner);
      before = corner;
    }
  }
  area = 0.5 * twice_area;
  centroid = near + moment / (3 * twice_area);
}

}  // namespace

ClippedCells Voronoi2d::clip(const PlanarDomain& domain, int threads, Job* job) const {
  return clip(domain, 0, threads, JobStage(job, "Clipping cells"));
}

ClippedCells Voronoi2d::clip(const PlanarDomain& domain, double gap, int threads, const JobStage& stage) const {
  if (!(gap >= 0) || std::isinf(gap)) throw InputError(message("gap: wanted a length of 0 or more, got ", gap));
  const Index count = static_cast<Index>(sites.size());
  const double side = 0.5 * std::sqrt(static_cast<double>(cell_sites.size()));
  const EdgeMap map(domain, std::clamp(static_cast<Index>(side), 1, 1024));
  std::vector<std::vector<Loop>> cells(count);
  ClippedCells result;
  result.areas.assign(count, 0);
  result.centroids.assign(count, Vec2::Constant(std::numeric_limits<double>::quiet_NaN()));
  constexpr Index k_block = 256;
  parallel_for(count, threads, k_block, [&](Index site, int) {
    if (site % k_block == 0) stage.check();
    if (site_of[site] != site) return;
    cells[site] = clip_cell(*this, site, domain, map, gap);
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
