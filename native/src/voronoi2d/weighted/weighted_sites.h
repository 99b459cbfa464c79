#pragma once
// Weighted sites as all tiles see them: checked, without duplicates and hidden ones, along a space-filling curve, with
// a tree of disks above them.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/support/large_array.h"
#include "saddleback/types.h"

#include "predicates/weighted_2d.h"

namespace saddleback::voronoi2d {

/// Holds sites by rank, which depends on the sites alone.
struct WeightedSites {
  LargeArray<predicates::WeightedPoint2> points;  ///< times `scale`
  LargeArray<Index> original;                     ///< the smallest index of equal sites
  LargeArray<std::uint32_t> places;               ///< on the curve
  LargeArray<Index> site_of;                      ///< by index: the smallest index of an equal site
  std::vector<Index> hidden;                      ///< indices, ascending: sites without a cell
  double scale = 1;                               ///< a power of two

  Index count() const { return static_cast<Index>(points.size()); }
};

/// The box about some sites, and the least of their weights.
struct WeightedBox {
  double low[2], high[2], lightest;

  /// Makes the box of at least one.
  explicit WeightedBox(std::span<const predicates::WeightedPoint2> points)
      : low{points[0].x, points[0].y}, high{low[0], low[1]}, lightest(points[0].weight) {
    for (const predicates::WeightedPoint2& point : points) {
      low[0] = std::min(low[0], point.x), high[0] = std::max(high[0], point.x);
      low[1] = std::min(low[1], point.y), high[1] = std::max(high[1], point.y);
      lightest = std::min(lightest, point.weight);
    }
  }
};

/// \throw InputError naming the first wrong coordinate or weight. O(n log n). \throw Cancelled
WeightedSites order_weighted_sites(std::span<const Vec2> sites, std::span<const double> weights, int threads,
                                   const JobStage& stage);

/// Disks about every eight sites in a row, about every eight of those, and so on. A disk stands for all that it
/// contains: with its radius for weight it is nowhere farther than any of them.
class DiskTree {
 public:
  static constexpr Index k_fan = 8;
  struct Disk {
    double x, y, radius;
  };

  DiskTree() = default;
  DiskTree(std::span<const predicates::WeightedPoint2> points, int threads);

  /// Calls found(row) for rows of sites, [k_fan row, k_fan (row + 1)), as long as enters(disk) says so for all disks
  /// about them. O(disks entered).
  template <class Enters, class Found>
  void visit(Enters&& enters, Found&& found) const {
    visit(
        top(), 0, [](Index, Index first, Index) { return first; }, enters, found);
  }
  /// Does the same: of each eight disks the one with its center nearest to a point comes first.
  template <class Enters, class Found>
  void visit_from(double x, double y, Enters&& enters, Found&& found) const {
    const auto nearest = [&](Index level, Index first, Index end) {
      const auto away = [&](const Disk& d) { return (d.x - x) * (d.x - x) + (d.y - y) * (d.y - y); };
      return static_cast<Index>(std::min_element(levels_[level].begin() + first, levels_[level].begin() + end,
                                                 [&](const Disk& a, const Disk& b) { return away(a) < away(b); }) -
                                levels_[level].begin());
    };
    visit(top(), 0, nearest, enters, found);
  }

  std::span<const Disk> rows() const { return levels_.front(); }
  /// A few disks about all.
  std::span<const Disk> widest() const { return levels_.back(); }

 private:
  Index top() const { return static_cast<Index>(levels_.size()) - 1; }

  template <class Chosen, class Enters, class Found>
  void visit(Index level, Index first, Chosen&& chosen, Enters&& enters, Found&& found) const {
    if (level < 0) return;
    const std::vector<Disk>& disks = levels_[level];
    const Index end = std::min(static_cast<Index>(disks.size()), first + k_fan);
    const auto enter = [&](Index i) {
      if (!enters(disks[i])) return;
      if (level > 0) {
        visit(level - 1, k_fan * i, chosen, enters, found);
      } else {
        found(i);
      }
    };
    const Index foremost = chosen(level, first, end);
    enter(foremost);
    for (Index i = first; i < end; ++i)
      if (i != foremost) enter(i);
  }

  std::vector<std::vector<Disk>> levels_;  ///< from small to large
  Index site_count_ = 0;
};

}  // namespace saddleback::voronoi2d
