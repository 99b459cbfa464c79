#include "voronoi2d/weighted/weighted_sites.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "saddleback/error.h"

#include "support/threads/parallel.h"
#include "voronoi2d/sites/for_pieces.h"
#include "voronoi2d/sites/site_order.h"
#include "voronoi2d/sites/site_weights.h"

namespace saddleback::voronoi2d {

using predicates::WeightedPoint2;

namespace {

void check_scaled(std::span<const double> weights, double scale) {
  constexpr double k_largest = 0x1p500;  // squares stay among the doubles
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const double scaled = weights[i] * scale;
    if (!(std::fabs(scaled) <= k_largest) || (scale != 1 && scaled / scale != weights[i]))
      throw InputError(message("weights: weight ", i, " is ", weights[i],
                               ", too different in size from the sites' coordinates to be told exactly"));
  }
}

/// Finds hidden sites, a block of sites in a row after the other. At one place there is one site.
class alignas(k_apart) HiddenFinder {
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

/// Counts what is left of each piece of sites: where it begins in a row, and the row's end.
std::vector<std::size_t> starts_of_left(const LargeArray<std::uint8_t>& hidden, int threads) {
  std::vector<std::size_t> starts(hidden.size() / k_piece + 2, 0);
  for_pieces(hidden.size(), threads, {}, [&](Index piece, std::size_t begin, std::size_t end) {
    starts[piece + 1] = static_cast<std::size_t>(std::count(hidden.begin() + begin, hidden.begin() + end, 0));
  });
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  return starts;
}

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
  for_pieces(count, threads, {}, [&](Index, std::size_t begin, std::size_t end) {
    for (std::size_t rank = begin; rank < end; ++rank)
      points[rank] = {ordered.x[rank], ordered.y[rank], weights[heaviest.original[rank]] * result.scale};
  });
  const DiskTree tree(points, threads);
  LargeArray<std::uint8_t> hidden(count);
  constexpr Index k_block = 64, k_blocks = 16;
  std::vector<HiddenFinder> finders(thread_count(threads), HiddenFinder(points, tree));
  parallel_for((count + k_block - 1) / k_block, threads, k_blocks, [&](Index block, int thread) {
    stage.check();
    finders[thread].find(block * k_block, std::min(count, (block + 1) * k_block), hidden.data());
  });
  stage.update(0.9);
  const std::vector<std::size_t> starts = starts_of_left(hidden, threads);
  result.points.resize(starts.back());
  result.places.resize(starts.back());
  result.original.resize(starts.back());
  for_pieces(count, threads, {}, [&](Index piece, std::size_t begin, std::size_t end) {
    std::size_t to = starts[piece];
    for (std::size_t rank = begin; rank < end; ++rank) {
      if (hidden[rank]) {
        heaviest.is_hidden[heaviest.original[rank]] = 1;
      } else {
        result.points[to] = points[rank];
        result.places[to] = ordered.places[rank];
        result.original[to++] = heaviest.original[rank];
      }
    }
  });
  std::vector<std::vector<Index>> hidden_of(sites.size() / k_piece + 1);
  for_pieces(sites.size(), threads, {}, [&](Index piece, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if ((heaviest.is_hidden[i] | heaviest.is_hidden[result.site_of[i]]) != 0)
        hidden_of[piece].push_back(static_cast<Index>(i));
  });
  for (const std::vector<Index>& some : hidden_of) result.hidden.insert(result.hidden.end(), some.begin(), some.end());
  stage.update(1);
  return result;
}

DiskTree::DiskTree(std::span<const WeightedPoint2> points, int threads)
    : site_count_(static_cast<Index>(points.size())) {
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
    std::vector<Disk> level((count + k_fan - 1) / k_fan, Disk{0, 0, 0});
    constexpr Index k_together = 1024;
    parallel_for(static_cast<Index>(level.size()), threads, k_together, [&](Index i, int) {
      const Index begin = i * k_fan, end = std::min(count, begin + k_fan);
      level[i] = levels_.empty() ? disk_about(begin, end,
                                              [&](Index site) {
                                                return Disk{points[site].x, points[site].y, points[site].weight};
                                              })
                                 : disk_about(begin, end, [&](Index disk) { return levels_.back()[disk]; });
    });
    levels_.push_back(std::move(level));
    count = static_cast<Index>(levels_.back().size());
  }
}

}  // namespace saddleback::voronoi2d
