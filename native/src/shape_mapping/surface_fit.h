#pragma once
// One mesh bent onto the surface, divided where it leaves it.

#include <vector>

#include "saddleback/shape_mapping/bent_copies.h"

#include "shape_mapping/outline_mapper.h"

namespace saddleback {

/// A solid and its edges, for all of its copies.
struct SolidEdges {
  explicit SolidEdges(const Solid& solid);
  std::vector<std::array<Index, 2>> ends;      ///< of each edge, the smaller vertex first
  std::vector<std::array<Index, 3>> triangle;  ///< per triangle the edges from corners 0, 1, 2
};

class SurfaceFit {
 public:
  struct Vertex {
    Vec3 given;  ///< in the shape's space
    SurfacePoint anchor;
    double height;
    Vec3 position;
    bool is_lost;
  };
  struct Face {
    Triangle vertices;
    Index source;
    std::array<Vec3, 3> weights;  ///< of the corners, in the source
  };

  SurfaceFit(const Mesh& mesh, std::span<const Vec3> vertex_normals) : mesh_(&mesh), normals_(vertex_normals) {}

  /// `mapper` has laid the placement's shape. Tolerance in mesh units, 0 to divide nothing.
  void bend(OutlineMapper& mapper, const Placement& placement, const Solid& solid, const SolidEdges& edges,
            double tolerance);

  std::span<const Vertex> vertices() const { return vertices_; }
  std::span<const Face> faces() const { return faces_; }
  double deviation() const { return deviation_; }  ///< the largest that was found and left, mesh units

 private:
  /// An edge or a part of one. Both its faces ask this one node, so that they split it alike.
  struct Edge {
    Index begin, end;
    int depth;
    bool is_decided;
    Index middle;    ///< k_none: not split
    Index children;  ///< two edges: from `begin` to the middle, from there to `end`
  };
  struct Part {
    Face face;
    std::array<Index, 3> edges;  ///< from corners 0, 1, 2
    int depth;
  };
  struct Peak {
    double height = 0;  ///< distance of the surface
    double along = 0;   ///< of an edge
    Vec3 weights = Vec3::Zero();
  };

  Vertex lay(const Vec3& given);
  Index add(const Vec3& given);
  Index add_edge(Index begin, Index end, int depth);
  Index middle_of(Index edge);
  Peak peak_of_edge(const Vertex& a, const Vertex& b);
  Peak peak_of_face(const Face& face);
  double sample_length(const Vertex& vertex) const;
  void divide(const Part& part);
  void divide_inside(const Part& part, const Peak& peak);
  void cut_one(const Part& part, int edge);
  void cut_two(const Part& part, int whole);
  void cut_three(const Part& part);
  Index half(const Part& part, int edge, bool first) const;
  Part child(const Part& part, const std::array<Index, 3>& vertices, const std::array<Vec3, 3>& weights,
             const std::array<Index, 3>& edges) const;

  const Mesh* mesh_;
  std::span<const Vec3> normals_;
  OutlineMapper* mapper_ = nullptr;
  SurfacePoint center_{};
  double scale_ = 1, tolerance_ = 0, deviation_ = 0;
  Index hint_ = 0;  ///< face near the last point
  std::vector<Vertex> vertices_;
  std::vector<Edge> edges_;
  std::vector<Part> parts_;
  std::vector<Face> faces_;
};

}  // namespace saddleback
