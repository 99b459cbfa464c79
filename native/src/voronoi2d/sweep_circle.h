#pragma once
// One sweep circle over some sites: their Delaunay triangulation, exactly.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "saddleback/job.h"

#include "voronoi2d/planar_mesh.h"
#include "voronoi2d/sweep_step.h"

namespace saddleback::voronoi2d {

/// Working memory of circles, kept from one to the next.
class SweepCircle {
 public:
  /// Sweeps all of the sites (distinct, any order) from the one nearest to a place. The result's corners are positions
  /// in the arrays given; it lives as long as they do and until the next call. O(n log n).
  /// \throw Cancelled
  PlanarMesh triangulate(std::span<const double> x, std::span<const double> y, const Vec2& centre,
                         const JobStage& stage);

  /// By half-edge of the latest result: whether its two triangles share a Voronoi vertex.
  std::span<const std::uint8_t> is_flat() const { return {is_flat_.data(), is_flat_.size()}; }

 private:
  void sort_sites(std::span<const double> x, std::span<const double> y, const Vec2& centre);
  void near_to_far(std::span<const double> x, std::span<const double> y, Index first);
  void reserve(Index count);
  void sweep(const JobStage& stage);

  struct Place {
    double radius;
    Index site;
  };
  std::vector<Place> order_, unsorted_;
  std::vector<Index> days_;
  double days_per_area_ = 0;
  std::vector<double> x_, y_;
  std::unique_ptr<Arc[]> arcs_;
  std::unique_ptr<Event[]> events_;
  std::unique_ptr<Index[]> triangles_, twins_;
  std::vector<Index> near_;
  std::vector<std::uint8_t> is_flat_;
  Index capacity_ = 0;
  SweepState state_{};
};

}  // namespace saddleback::voronoi2d
