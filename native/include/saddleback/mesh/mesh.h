#pragma once
// The triangle mesh that everything stands on: checked once, immutable, flat arrays.

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

namespace saddleback {

/// An oriented manifold triangle mesh, with or without boundary, of any number of components.
///
/// Half-edges are implicit: half-edge 3f+i runs from corner i to corner i+1 of face f, so from, to, next and prev need
/// no memory and only the twins are stored. All arrays are flat and indexed by vertex, half-edge or face.
/// Every vertex belongs to at least one face.
class Mesh {
 public:
  /// Checks and copies. `xyz` holds three coordinates a vertex; `triangles` three vertices a face.
  /// \throw MeshError naming the first offenders: no faces, a coordinate that is not finite, an index out of range, a
  /// degenerate face (repeated vertex or no area), a duplicate face, a non-manifold edge or vertex, neighbors of
  /// opposite orientation, an unreferenced vertex, a coordinate beyond 1e60. O(V + F).
  Mesh(std::span<const double> xyz, std::span<const Index> triangles, Job* job = nullptr);
  /// Does the same as a part of other work.
  Mesh(std::span<const double> xyz, std::span<const Index> triangles, const JobStage& stage);

  Index vertex_count() const { return static_cast<Index>(positions_.size()); }
  Index face_count() const { return static_cast<Index>(triangles_.size()); }
  Index halfedge_count() const { return 3 * face_count(); }

  std::span<const Vec3> positions() const { return positions_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  const Vec3& position(Index vertex) const { return positions_[vertex]; }

  // Half-edges.
  static Index face_of(Index h) { return h / 3; }
  static Index next(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static Index prev(Index h) { return h % 3 == 0 ? h + 2 : h - 1; }
  Index from(Index h) const { return triangles_[h / 3][h % 3]; }
  Index to(Index h) const { return from(next(h)); }
  Index apex(Index h) const { return from(prev(h)); }               ///< the corner of h's face that is not on h
  Index twin(Index h) const { return twins_[h]; }                   ///< k_none on the boundary
  double length(Index h) const { return lengths_[h]; }              ///< equal to the bit for both twins
  double corner_angle(Index h) const { return corner_angles_[h]; }  ///< at from(h), inside h's face, radians
  std::span<const Index> twins() const { return twins_; }
  std::span<const double> lengths() const { return lengths_; }
  std::span<const double> corner_angles() const { return corner_angles_; }

  /// First half-edge out of a vertex in counter-clockwise order; on a boundary vertex the one whose clockwise side is
  /// the boundary. Go on with `rotate` until k_none (boundary) or the first again.
  Index first_halfedge(Index vertex) const { return first_halfedges_[vertex]; }
  std::span<const Index> first_halfedges() const { return first_halfedges_; }
  /// The next half-edge counter-clockwise out of the same vertex, k_none where the boundary comes.
  Index rotate(Index h) const { return twins_[prev(h)]; }

  // Vertices.
  double total_angle(Index vertex) const { return total_angles_[vertex]; }  ///< sum of the corner angles, radians
  bool is_boundary(Index vertex) const { return boundary_[vertex] != 0; }
  /// Interior vertex whose total angle exceeds 2 pi, or any boundary vertex: where a shortest path may bend.
  bool is_saddle(Index vertex) const { return saddle_[vertex] != 0; }
  std::span<const std::uint8_t> saddles() const { return saddle_; }  ///< of all vertices: whether they are
  Index component_of(Index vertex) const { return components_[vertex]; }
  std::span<const double> total_angles() const { return total_angles_; }
  std::span<const Index> components() const { return components_; }  ///< labels in the order of their first vertices
  std::vector<Index> saddle_vertices() const;
  std::vector<Index> boundary_vertices() const;

  // The whole.
  double face_area(Index face) const { return face_areas_[face]; }
  std::span<const double> face_areas() const { return face_areas_; }
  double area() const { return area_; }
  Index component_count() const { return component_count_; }
  /// Sum of the genera of the components, boundary loops thought closed by disks.
  Index genus() const { return genus_; }
  Index edge_count() const { return edge_count_; }
  /// The half-edge that speaks for each edge: of two twins the one of the smaller face.
  std::vector<Index> edge_halfedges() const;
  /// Each loop as vertices in order, the surface on its left.
  const std::vector<std::vector<Index>>& boundary_loops() const { return boundary_loops_; }
  double mean_edge_length() const { return mean_edge_length_; }
  /// 64-bit hash of positions and triangles: tells meshes apart, in files and caches.
  std::uint64_t fingerprint() const { return fingerprint_; }

 private:
  void order_vertices();
  void measure();
  void find_components();
  void find_boundary_loops();

  std::vector<Vec3> positions_;
  std::vector<Triangle> triangles_;
  std::vector<Index> twins_, first_halfedges_, components_;
  std::vector<double> lengths_, corner_angles_, total_angles_, face_areas_;
  std::vector<std::uint8_t> boundary_, saddle_;
  std::vector<std::vector<Index>> boundary_loops_;
  double area_ = 0, mean_edge_length_ = 0;
  Index component_count_ = 0, genus_ = 0, edge_count_ = 0;
  std::uint64_t fingerprint_ = 0;
};

}  // namespace saddleback
