#pragma once
// One sweep circle over some sites.

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
  /// Sweeps distinct sites until the cells of the first `own_count` are closed, or to the end. The circle grows from
  /// the one of these nearest to a place. Triangles are right up to rounding.
  /// The mesh counts the sites from near to far; it lives until the next call. O(n log n). \throw Cancelled
  PlanarMesh sweep(std::span<const double> x, std::span<const double> y, Index own_count, const Vec2& place,
                   const JobStage& stage);

  /// All edges of the triangles pass the circle test, exactly. That they are a triangulation is not proven, unless it
  /// was in doubt.
  PlanarMesh triangulate(std::span<const double> x, std::span<const double> y, const Vec2& place,
                         const JobStage& stage);
  /// Delaunay's triangulation, whatever the sites.
  PlanarMesh triangulate_safely(std::span<const double> x, std::span<const double> y, const Vec2& place,
                                const JobStage& stage);

  /// Position in the arrays given of the k-th site from near to far.
  Index position(Index k) const { return order_[k].site; }
  /// Scratch by half-edge of the latest result: whether its two triangles share a Voronoi vertex.
  std::vector<std::uint8_t> is_flat;

 private:
  struct Place {
    double radius;
    Index site;
  };
  void sort_sites(std::span<const double> x, std::span<const double> y, Index first);
  void reserve(Index count);
  void repair(PlanarMesh& mesh, std::vector<Index> failing);
  bool run(const JobStage& stage);

  std::vector<Place> order_, unsorted_;
  std::vector<double> x_, y_;
  std::vector<std::uint8_t> is_own_;
  std::vector<Index> days_, near_;
  double days_per_area_ = 0;
  std::unique_ptr<Arc[]> arcs_;
  std::unique_ptr<Event[]> events_;
  std::unique_ptr<Index[]> triangles_, twins_;
  Index capacity_ = 0;
  SweepState state_{};
};

}  // namespace saddleback::voronoi2d
