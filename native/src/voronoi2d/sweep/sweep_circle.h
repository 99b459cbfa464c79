#pragma once
// One sweep circle over some sites.

#include <memory>
#include <span>
#include <vector>

#include "saddleback/job.h"

#include "voronoi2d/sites/site_order.h"
#include "voronoi2d/sweep/sweep_step.h"

namespace saddleback::voronoi2d {

/// Working memory of circles, kept from one to the next.
class SweepCircle {
 public:
  /// Sweeps the sites of these ranks. The circle grows from the one of them that is nearest to a place. Triangles, from
  /// `first` on, go into arrays as those of a Triangulation, with room for two a site; they turn counter-clockwise and
  /// know their twins, but are right only up to rounding. Returns the end of them. O(n log n). \throw Cancelled
  Index sweep(const OrderedSites& sites, Index begin, Index end, const Vec2& place, Index first, Index* corners,
              Index* twins, const JobStage& stage);

 private:
  struct Place {
    double radius;
    Index site;
  };
  void sort_sites(std::span<const double> x, std::span<const double> y, Index first);
  void reserve(Index count);
  bool vanish_until(double radius);
  void run(const OrderedSites& sites, Index begin, const JobStage& stage);

  std::vector<Place> order_, unsorted_;
  std::vector<Index> buckets_, near_, overdue_, soonest_;
  std::unique_ptr<Arc[]> arcs_;
  Index capacity_ = 0;
  SweepState state_{};
};

}  // namespace saddleback::voronoi2d
