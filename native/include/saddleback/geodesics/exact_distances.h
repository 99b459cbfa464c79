#pragma once
// Exact geodesic distances and shortest paths, by window propagation: no graph, nothing precomputed.

#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"
#include "saddleback/job.h"
#include "saddleback/mesh/mesh.h"
#include "saddleback/mesh/surface_points.h"
#include "saddleback/mesh/trace.h"

namespace saddleback {

/// Distance of every vertex from the nearest source, exact up to rounding: (V,), mesh units, infinity where no source
/// reaches or only beyond `limit`. Sources lie anywhere on the surface; one within 1e-12 (barycentric) of a vertex
/// counts as at it. Correct on flat and regular meshes, needles, boundaries and several components. \throw InputError
/// for no sources, a source off the mesh, limit < 0 or not a number; Cancelled. About O(V^1.5) time, some 600 bytes a
/// vertex while it runs. After [chen1990] and [xin2009].
std::vector<double> exact_distances(const Mesh& mesh, const SurfacePoints& sources,
                                    double limit = std::numeric_limits<double>::infinity(), Job* job = nullptr);

/// Works as exact_distances, and tells which source is nearest. Of sources at the same distance, up to a relative
/// 1e-12, the one of the smaller index.
NearestField exact_nearest(const Mesh& mesh, const SurfacePoints& sources,
                           double limit = std::numeric_limits<double>::infinity(), Job* job = nullptr);

class WaysToFace;

/// The exact distance of every point of the surface, not of the vertices alone, and the shortest paths. Keeps the
/// windows, some 40 bytes each and 20 to 150 of them a vertex of a scan, a thousand where a million vertices are flat
/// or round. Immutable: any number of threads may ask it.
class ExactField {
 public:
  /// The mesh must outlive the field. Errors as exact_distances; InputError where memory is too small for the windows.
  ExactField(const Mesh& mesh, const SurfacePoints& sources, Job* job = nullptr);
  /// Does the same as a part of other work.
  ExactField(const Mesh& mesh, const SurfacePoints& sources, const JobStage& stage);
  ~ExactField();
  ExactField(ExactField&&) noexcept;

  const Mesh& mesh() const;
  std::span<const double> distances() const;  ///< (V,), mesh units, infinity where no source reaches
  std::span<const Index> nearest() const;     ///< (V,) index into the sources, k_none where none reaches

  /// Distance of each point, infinity where no source reaches. O(windows about its face) each. \throw InputError for a
  /// point off the mesh; Cancelled.
  std::vector<double> distance_to(const SurfacePoints& points, Job* job = nullptr) const;

  struct Sight {
    Index source;
    double distance;
  };
  /// The nearest source of a point and its distance; k_none and infinity where none reaches. O(windows about its face).
  Sight nearest_at(const SurfacePoint& point) const;
  /// A way to a point: to a root, a source or a vertex, and from there straight as seen in the plane of the point's
  /// face, or bent where less is seen of the root.
  struct Way {
    Index source;
    double distance;
    double before;  ///< of the root from the source
    Vec2 image;     ///< of the root
    double straight_to(const Vec2& place) const { return before + (place - image).norm(); }
  };
  /// The ways to the points of a face; the field must outlive them. O(windows about it).
  WaysToFace ways_to(Index face) const;
  /// Returns the place of a point in the plane of its face, which some source must reach.
  Vec2 place_of(const SurfacePoint& point) const;

  /// The shortest path from the nearest source to a point: straight in faces, bent only at saddle and boundary
  /// vertices, as long as the distance. O(faces crossed). \throw InputError for a point off the mesh or that no source
  /// reaches.
  GeodesicPath path(const SurfacePoint& target) const;
  /// Does the same for several points. \throw InputError naming the first that is wrong; Cancelled.
  std::vector<GeodesicPath> paths(const SurfacePoints& targets, Job* job = nullptr) const;

  std::int64_t window_count() const;  ///< windows propagated: the work done
  std::size_t nbytes() const;         ///< memory of the field

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

}  // namespace saddleback
