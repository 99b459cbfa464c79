#pragma once
// Barriers: the surface parted along lines that no path may cross, and without the faces that are left out.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "saddleback/mesh/surface_curve.h"

namespace saddleback {

struct Barriers {
  std::span<const std::array<Index, 2>> edges;  ///< of the mesh, each by its two vertices
  std::span<const SurfaceCurve* const> curves;  ///< may cross and touch each other, none itself
  std::span<const std::uint8_t> left_out;       ///< of all faces, or empty: which are no part of the surface
};

/// A surface with barriers as a mesh of its own, on which everything works unchanged: on both sides of a barrier the
/// vertices are others, so it is a boundary. Where a barrier ends inside the surface, its two sides meet.
struct BarredMesh {
  std::shared_ptr<Mesh> mesh;
  SurfacePoints vertex_points;       ///< where each vertex lies on the whole mesh
  std::vector<Index> vertex_origin;  ///< the whole mesh's vertex that each is a copy of, k_none for those on curves
  std::vector<Index> face_origin;    ///< the whole mesh's face that each is a part of, ascending
};

/// Vertices that are one keep their order and come first, then second and further copies. Faces that a curve crosses
/// become triangles with the pieces of the curve as edges, as near to Delaunay's as those let them be; curves nearer
/// than 1e-9 of a face to each other, to an edge or to a vertex meet it.
/// \throw InputError naming two vertices that no edge joins, a curve of another mesh, a curve that crosses or touches
/// itself (where), a wrong number of faces, that all are left out. O(F), and O(p^2) for p pieces of curves in one face.
BarredMesh add_barriers(const Mesh& whole, const Barriers& barriers, Job* job = nullptr);

/// Points of a whole mesh on a barred one: those on a barrier are there once for each side.
struct PointsOnBarred {
  SurfacePoints points;
  std::vector<Index> index;  ///< which of the given points each is
};

/// \throw InputError naming `argument` and the first point that lies only in faces that are left out. O(log F) each.
PointsOnBarred points_on_barred(const Mesh& whole, const BarredMesh& barred, const SurfacePoints& points,
                                const char* argument);

/// Points of a barred mesh on the whole one. \throw InputError as check_surface_points. O(1) each.
SurfacePoints points_on_whole(const Mesh& whole, const BarredMesh& barred, const SurfacePoints& points,
                              const char* argument);

/// Values (V,) of the whole mesh's vertices at those of the barred one, linear over each face. \throw InputError for a
/// wrong number of them. O(W).
std::vector<double> values_on_barred(const Mesh& whole, const BarredMesh& barred, std::span<const double> values);

/// Finds for each vertex of the whole mesh its copy of the least value, the smallest of equal ones; k_none where it is
/// left out. `values` holds one for each vertex of the barred mesh, otherwise \throw InputError. O(V).
std::vector<Index> least_copies(const Mesh& whole, const BarredMesh& barred, std::span<const double> values);

}  // namespace saddleback
