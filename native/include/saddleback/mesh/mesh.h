#pragma once
// The triangle mesh that everything stands on: checked once, immutable, flat arrays.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

namespace saddleback {

/// Tells how long the edges of a mesh are, where positions do not.
struct MeshMetric {
  int dimension = 3;  ///< coordinates a vertex; of others than three the lengths are kept, and the first three to show
  /// Given lengths: three a face, of edge i to i+1, or one an edge in the order of edge_halfedges(). Else those of
  /// the coordinates count.
  std::optional<std::span<const double>> lengths = {};
};

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
  /// Takes lengths from elsewhere than space: is_intrinsic() but in the plane. \throw MeshError naming also the first
  /// lengths that are not finite and positive, that differ on the two sides of an edge by more than rounding, or of
  /// which no triangle can be made that is higher than 1e-12 of its longest side; InputError for another count.
  Mesh(std::span<const double> coordinates, std::span<const Index> triangles, const MeshMetric& metric,
       Job* job = nullptr);

  Index vertex_count() const { return static_cast<Index>(positions_.size()); }
  Index face_count() const { return static_cast<Index>(triangles_.size()); }
  Index halfedge_count() const { return 3 * face_count(); }

  std::span<const Vec3> positions() const { return positions_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  const Vec3& position(Index vertex) const { return positions_[vertex]; }

  // Lengths of its own.
  /// Tells whether lengths were given: nothing is then measured by positions, which only show the surface.
  bool is_intrinsic() const { return is_intrinsic_; }
  /// \throw InputError that says what needs the surface's shape in space, where lengths were given.
  void require_space(const char* call) const;
  /// from(h), to(h) and apex(h) as far from each other as on the surface: their positions, or else the face laid flat.
  std::array<Vec3, 3> corners(Index h) const {
    if (is_intrinsic_) [[unlikely]]
      return laid_flat(h);
    return {positions_[from(h)], positions_[to(h)], positions_[apex(h)]};
  }
  /// A bound below the distance over the surface of two places of it so far apart in space: as the bird flies.
  double bird(double in_space) const { return bird_ * in_space; }
  /// A bound above how far apart in space two places are that far apart on the surface.
  double in_space(double on_surface) const { return on_surface / bird_; }

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
  /// 64-bit hash of positions, triangles and given lengths: tells meshes apart, in files and caches.
  std::uint64_t fingerprint() const { return fingerprint_; }

 private:
  Mesh(std::span<const double> coordinates, std::span<const Index> triangles, const MeshMetric& metric,
       const JobStage& stage);
  std::array<Vec3, 3> laid_flat(Index h) const;
  bool is_second_side(Index h) const { return twins_[h] != k_none && twins_[h] < h; }
  void order_vertices(const JobStage& stage);
  void take_lengths(std::span<const double> coordinates, const MeshMetric& metric);
  void measure(const JobStage& stage);
  void measure_bird();
  void find_components();
  void find_boundary_loops();

  std::vector<Vec3> positions_;
  std::vector<Triangle> triangles_;
  std::vector<Index> twins_, first_halfedges_, components_;
  std::vector<double> lengths_, corner_angles_, total_angles_, face_areas_;
  std::vector<std::uint8_t> boundary_, saddle_;
  std::vector<std::vector<Index>> boundary_loops_;
  bool is_intrinsic_ = false;
  double bird_ = 1, area_ = 0, mean_edge_length_ = 0;
  Index component_count_ = 0, genus_ = 0, edge_count_ = 0;
  std::uint64_t fingerprint_ = 0;
};

}  // namespace saddleback
