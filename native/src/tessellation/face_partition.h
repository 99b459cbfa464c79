#pragma once
// How the cells of several sites share one face.

#include <array>
#include <vector>

#include "saddleback/types.h"

namespace saddleback {

/// A site's squared distances at the corners of the face.
struct FacePlane {
  Index site;
  std::array<double, 3> at_corner;
};

/// Lower envelope of affine functions over a triangle, as a planar subdivision: pieces with one site each, that share
/// their vertices. The topology is valid whatever the rounding: sites are inserted one after another, each vertex is
/// decided once, and pieces are cut by the signs at their vertices.
class FacePartition {
 public:
  struct Vertex {
    Vec3 barycentric = Vec3::Zero();
    double value = 0;  ///< least squared distance so far, up to the term that all sites share
    int side = k_inside;
  };
  static constexpr int k_corner = -2, k_inside = -1;  ///< otherwise 0..2: on the side from corner i to corner i+1
  struct Piece {
    Index site;
    std::vector<Index> loop;  ///< vertices, counter-clockwise
  };

  /// The planes in increasing order of site, at least one. Vertices 0..2 are the corners.
  void build(const std::vector<FacePlane>& planes);

  const std::vector<Vertex>& vertices() const { return vertices_; }
  const std::vector<Piece>& pieces() const { return pieces_; }

  /// The sites along a side from corner i to corner i+1 and the vertices between them.
  /// False when a vertex on the side lies between pieces of one site (possible only by rounding).
  bool read_side(int side, std::vector<Index>& sites, std::vector<Index>& breaks) const;

  /// Replaces the pieces by a star: each run of the boundary is joined to one inner vertex, in the middle of where
  /// pieces met before. Used where the subdivision's sides do not agree with what the edges say (rounding at a tie).
  struct Side {
    std::vector<double> breaks;  ///< from corner i, 0 to 1
    std::vector<Index> sites;    ///< one more than breaks
  };
  void build_star(const std::array<Side, 3>& sides);

 private:
  void insert(const FacePlane& plane);
  void cut(const Piece& piece, const FacePlane& plane, std::vector<Piece>& kept, std::vector<Piece>& taken);
  Index crossing(Index a, Index b);
  Vec3 middle() const;
  void merge(std::vector<Piece>& taken);
  void drop_idle_side_vertices();

  std::vector<Vertex> vertices_;
  std::vector<Piece> pieces_;
  std::vector<double> height_;  ///< of the plane being inserted above the envelope, per vertex
  struct Cut {
    Index a, b, vertex;
  };
  std::vector<Cut> cuts_;
};

}  // namespace saddleback
