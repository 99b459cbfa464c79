#pragma once
// The places of the faces about a copy in its plane.

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/mesh/mesh.h"

#include "distribution/flat_faces.h"

namespace saddleback::distribution {

/// Holds how a face lies in the plane of a copy, in mesh units: a point p of the face's own plane (FlatFaces) is at
/// origin + turn * p.
struct FacePlace {
  Index face;
  Vec2 origin;
  Eigen::Matrix2d turn;
};

/// A vertex that a copy's plane was laid on, and where.
struct LaidVertex {
  Index vertex;
  Vec2 place;
};

/// Lays out what is about a piece of a plane, again and again in the same memory. One thread at a time.
class LocalLayout {
 public:
  LocalLayout(const Mesh& mesh, const FlatFaces& flat);

  /// All faces of which something is within `reach` of the origin, but for the known ones. The given vertices stay
  /// where they are; others follow ring by ring outwards as those of a ShapeMap about a point do, but for the order
  /// within a ring, and the first edge that will do is taken. The faces have no meaning after the next call. O(faces).
  const std::vector<FacePlace>& about(std::span<const LaidVertex> vertices, std::span<const Index> known, double reach);

 private:
  static constexpr int k_rings = 64;
  struct Node {
    Vec2 place;
    std::uint32_t stamp = 0;
  };

  bool has(Index vertex) const { return nodes_[vertex].stamp == stamp_; }
  const Vec2& place(Index vertex) const { return nodes_[vertex].place; }
  void begin(double reach);
  bool is_within_reach(const Vec2& from, const Vec2& to) const;
  void put(Index vertex, const Vec2& place);
  void spread();
  void look_around(Index vertex);
  bool insert(Index halfedge, double most_miss);
  void write_down(Index face);

  const Mesh* mesh_;
  const FlatFaces* flat_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> face_stamps_;
  std::uint32_t stamp_ = 0;
  double reach_ = 0;
  int ring_ = 0;
  std::vector<Index> rings_[k_rings];
  std::vector<Index> turned_away_, waiting_;  ///< half-edges through which a vertex does not see the origin
  std::vector<FacePlace> faces_;
};

}  // namespace saddleback::distribution
