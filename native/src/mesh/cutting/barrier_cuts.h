#pragma once
// Faces cut along barriers: where curves meet edges, vertices and each other, and the triangles between.

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/surface_curve.h"

#include "mesh/cutting/constrained_triangulation.h"
#include "mesh/tables/edge_key.h"

namespace saddleback {

/// Asks for small triangles about one curve, on a part of its mesh: edges longer than `length` are divided where
/// `is_near` says so of their ends. Messages tell of the whole mesh.
struct Fineness {
  double length;
  std::function<bool(const Vec3& a, const Vec3& b)> is_near;
  const Mesh& whole;
  const std::vector<Index>& faces;  ///< of the whole mesh that are the part's
};

/// Nodes are the vertices of the mesh and, numbered after them, the points at which curves bend, meet or cross edges.
/// Two faces that are parted along an edge must differ in one of its ends: an edge that is a barrier for itself has a
/// node in its middle.
class BarrierCuts {
 public:
  /// \throw InputError for an edge that is none of the mesh, a curve that crosses or touches itself, telling where and
  /// which. O(n^2) for n points of curves in a face; `stage` may stop it,
  /// and later cuts.
  BarrierCuts(const Mesh& mesh, std::span<const std::array<Index, 2>> edges,
              std::span<const SurfaceCurve* const> curves, const JobStage& stage, const Fineness* fineness = nullptr);

  /// All nodes on the mesh: those within faces that are divided for fineness once these are cut.
  const SurfacePoints& points() const { return points_; }
  /// Tells whether the edge between two nodes is a barrier.
  bool is_barrier(Index a, Index b) const { return barriers_.contains(edge_key(a, b)); }
  /// The nodes that a curve passes, in order; the first once more where a closed one ends.
  const std::vector<Index>& line(std::size_t curve) const { return lines_[curve]; }
  /// Tells whether there are nodes in or on the face beside its corners.
  bool is_cut(Index face) const;
  /// The triangles that the face has become, as nodes. \throw InputError where curves meet too narrowly.
  void cut(Index face, std::vector<Triangle>& triangles);

 private:
  struct Piece {
    Index face, curve, from, to;
  };
  struct OnEdge {
    double along;  ///< share of the way along the half-edge that speaks for the edge
    Index node;
  };

  struct FaceNodes {
    Index face = k_none;
    std::vector<Index> nodes;
    std::vector<Vec2> weights;
  };

  /// A barrier between two nodes that no other lies between.
  struct Edge {
    Index face, from, to;
  };

  void add_curve(Index curve, const SurfaceCurve& line);
  void add_piece(Index curve, Index face, Index from, Index to);
  void add_given_edge(Index halfedge);
  void add_edge(const Edge& edge);
  Index node_at(Index face, const Vec3& barycentric);
  Index node_on(Index halfedge, double along);
  Index new_node(Index face, const Vec3& barycentric);
  Index speaker(Index h) const;
  Vec2 weights(Index face, Index node) const;
  std::vector<Index> nodes_of(Index face) const;
  void cross(std::span<const Index> pieces);
  void divide(Index face, std::vector<Index>& chain, std::vector<std::pair<Index, Index>>& within);
  void divide_edges();
  void divide_inside(Index face, std::vector<Index>& nodes);
  void follow_curves(std::span<const SurfaceCurve* const> curves);
  void follow(const Piece& piece, std::vector<Index>& chain);
  void halve_lonely_edges();
  [[noreturn]] void refuse(Index curve, Index node) const;

  const Mesh& mesh_;
  const JobStage stage_;
  const Fineness* fineness_;
  SurfacePoints points_;
  std::vector<Piece> pieces_;                               ///< in the order along the curves
  std::unordered_map<Index, std::vector<Index>> inside_;    ///< nodes within a face
  std::unordered_map<Index, std::vector<OnEdge>> on_edge_;  ///< by the half-edge that speaks for it, ascending
  std::vector<std::vector<Index>> lines_;                   ///< nodes of the curves
  std::vector<Edge> edges_;                                 ///< that are barriers, each once
  std::unordered_set<std::uint64_t> barriers_;              ///< keys of these
  std::unordered_map<Index, std::vector<Edge>> edges_in_;   ///< of these, by face
  FaceNodes followed_;                                      ///< of the piece that was followed last
  ConstrainedTriangulation flat_;
};

}  // namespace saddleback
