#include "voronoi2d/weighted/weighted_sites.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/error.h"

#include "support/threads/parallel.h"
#include "voronoi2d/sites/site_order.h"
#include "voronoi2d/sites/site_weights.h"

namespace saddleback::voronoi2d {

using predicates::WeightedPoint2;

namespace {

void check_scaled(std::span<const double> weights, double scale) {
  constexpr double k_largest = 0x1p500;  // squares stay among the doubles
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double scaled = weights[i] * scale;
    if (!(std::fabs(scaled) <= k_largest) || scaled / scale != weights[i])
      throw InputError(message("weights: weight ", i, " is ", weights[i],
                               ", too different in size from the sites' coordinates to be told exactly"));
  }
}

/// Finds hidden sites, a block of sites in a row after the other. At one place there is one site.
class HiddenFinder {
 public:
  HiddenFinder(std::span<const WeightedPoint2> points, const DiskTree& tree) : points_(points), tree_(tree) {}

  void find(Index begin, Index end, std::uint8_t* hidden) {
    open_block(begin, end);
    for (Index site = begin; site < end; ++site) hidden[site] = static_cast<std::uint8_t>(is_hidden(site));
  }

 private:
  static constexpr double k_slack = 1e-12;  ///< far more than the rounding of a few operations

  /// Collects the rows of sites whose disks reach into the block's box.
  void open_block(Index begin, Index end) {
    const WeightedBox block(points_.subspan(begin, end - begin));
    rows_.clear();
    disks_.clear();
    tree_.visit(
        [&](const DiskTree::Disk& disk) {
          const double x = std::max({block.low[0] - disk.x, disk.x - block.high[0], 0.0}),
                       y = std::max({block.low[1] - disk.y, disk.y - block.high[1], 0.0});
          return is_within(x, y, disk.radius - block.lightest);
        },
        [&](Index row) {
          rows_.push_back(row);
          disks_.push_back(tree_.rows()[row]);
        });
    near_.resize(std::max(near_.size(), rows_.size()));
  }

  bool is_hidden(Index site) {
    const WeightedPoint2& point = points_[site];
    std::size_t near = 0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {  // without branches, which could not be predicted
      const DiskTree::Disk& disk = disks_[i];
      near_[near] = rows_[i];
      near += static_cast<std::size_t>(is_within(disk.x - point.x, disk.y - point.y, disk.radius - point.weight));
    }
    return std::any_of(near_.begin(), near_.begin() + static_cast<std::ptrdiff_t>(near),
                       [&](Index row) { return is_hidden_in(row, site); });
  }

  bool is_hidden_in(Index row, Index site) const {
    const WeightedPoint2& point = points_[site];
    const Index begin = row * DiskTree::k_fan,
                end = std::min(static_cast<Index>(points_.size()), begin + DiskTree::k_fan);
    bool may_be = false;
    for (Index i = begin; i < end; ++i)
      may_be |=
          is_within(points_[i].x - point.x, points_[i].y - point.y, points_[i].weight - point.weight) & (i != site);
    if (!may_be) return false;
    for (Index i = begin; i < end; ++i)
      if (i != site && predicates::hides(points_[i], point)) return true;
    return false;
  }

  static bool is_within(double x, double y, double reach) {
    return x * x + y * y <= reach * std::fabs(reach) * (1 + k_slack);
  }

  std::span<const WeightedPoint2> points_;
  const DiskTree& tree_;
  std::vector<Index> rows_, near_;
  std::vector<DiskTree::Disk> disks_;
};

}  // namespace

WeightedSites order_weighted_sites(std::span<const Vec2> sites, std::span<const double> weights, int threads,
                                   const JobStage& stage) {
  check_weights(sites, weights);
  const OrderedSites ordered = order_sites(sites, threads, stage.part(0, 0.5));
  check_scaled(weights, ordered.scale);
  WeightedSites result;
  result.scale = ordered.scale;
  result.site_of = smallest_equal(ordered, weights);
  Heaviest heaviest = heaviest_by_place(ordered, weights);

  const Index count = ordered.count();
  LargeArray<WeightedPoint2> points(count);
  for (Index rank = 0; rank < count; ++rank)
    points[rank] = {ordered.x[rank], ordered.y[rank], weights[heaviest.original[rank]] * result.scale};
  const DiskTree tree(points);
  std::vector<std::uint8_t> hidden(count, 0);
  constexpr Index k_block = 64, k_blocks = 16;
  std::vector<HiddenFinder> finders(thread_count(threads), HiddenFinder(points, tree));
  parallel_for((count + k_block - 1) / k_block, threads, k_blocks, [&](Index block, int thread) {
    stage.check();
    finders[thread].find(block * k_block, std::min(count, (block + 1) * k_block), hidden.data());
  });
  stage.update(0.9);
  result.points.reserve(count);
  result.places.reserve(count);
  result.original.reserve(count);
  for (Index rank = 0; rank < count; ++rank) {
    if (hidden[rank]) {
      heaviest.is_hidden[heaviest.original[rank]] = true;
    } else {
      result.points.push_back(points[rank]);
      result.places.push_back(ordered.places[rank]);
      result.original.push_back(heaviest.original[rank]);
    }
  }
  for (std::size_t i = 0; i < sites.size(); ++i)
    if (heaviest.is_hidden[i] || heaviest.is_hidden[result.site_of[i]]) result.hidden.push_back(static_cast<Index>(i));
  stage.update(1);
  return result;
}

DiskTree::DiskTree(std::span<const WeightedPoint2> points) : site_count_(static_cast<Index>(points.size())) {
  constexpr double k_slack = 0x1p-49;  // of the radius, for its rounding
  const auto disk_about = [&](Index begin, Index end, auto&& disk_at) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (Index i = begin; i < end; ++i) {
      const auto [x, y, radius] = disk_at(i);
      low[0] = std::min(low[0], x), high[0] = std::max(high[0], x);
      low[1] = std::min(low[1], y), high[1] = std::max(high[1], y);
    }
    Disk result{0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]), -INFINITY};
    for (Index i = begin; i < end; ++i) {
      const auto [x, y, radius] = disk_at(i);
      const double away = std::sqrt((x - result.x) * (x - result.x) + (y - result.y) * (y - result.y));
      result.radius = std::max(result.radius, away + radius + k_slack * (away + std::fabs(radius)));
    }
    return result;
  };
  Index count = site_count_;
  while (count > 0 && (levels_.empty() || count > k_fan)) {
    std::vector<Disk> level;
    for (Index begin = 0; begin < count; begin += k_fan) {
      const Index end = std::min(count, begin + k_fan);
      if (levels_.empty()) {
        level.push_back(disk_about(begin, end, [&](Index i) {
          return Disk{points[i].x, points[i].y, points[i].weight};
        }));
      } else {
        level.push_back(disk_about(begin, end, [&](Index i) { return levels_.back()[i]; }));
      }
    }
    levels_.push_back(std::move(level));
    count = static_cast<Index>(levels_.back().size());
  }
}

}  // namespace saddleback::voronoi2d
