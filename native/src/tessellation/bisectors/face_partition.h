#pragma once
// The partition of one face by the bisectors of several sites.

#include <array>
#include <cstdint>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

namespace saddleback {

/// A site's squared distances at the corners of the face.
struct FacePlane {
  Index site;
  std::array<double, 3> at_corner;
};

/// Lower envelope of affine functions over a triangle, as a planar subdivision: pieces with one site each, that share
/// their vertices. Sites are inserted one after another, and pieces are cut by the signs at their vertices. Signs are
/// exact, of a vertex as the place where given planes meet, and ties go to the smaller site: as though every plane lay
/// higher than those before it by far less than any difference. Thus the sides are what `lower_envelope` says of them.
class FacePartition {
 public:
  struct Vertex {
    Vec3 barycentric = Vec3::Zero();
    int side = k_inside;
    /// The planes that are least here: one at a corner, two on a side in order along it, three inside
    /// counter-clockwise.
    std::array<Index, 3> planes{k_none, k_none, k_none};
  };
  static constexpr int k_corner = -2, k_inside = -1;  ///< otherwise 0..2: on the side from corner i to corner i+1
  struct Piece {
    Index site;
    std::vector<Index> loop;  ///< vertices, counter-clockwise
  };

  /// The planes in increasing order of site, at least one. Vertices 0..2 are the corners.
  /// False where signs contradict each other: products of distances underflow. O(n^2) for n planes that count.
  /// \throw Cancelled, when it is none.
  bool build(const std::vector<FacePlane>& planes, const JobStage& stage = {});

  const std::vector<Vertex>& vertices() const { return vertices_; }
  const std::vector<Piece>& pieces() const { return pieces_; }

  /// The sites along a side from corner i to corner i+1 and the vertices between them.
  void read_side(int side, std::vector<Index>& sites, std::vector<Index>& breaks) const;

  /// Replaces the pieces by a star: each run of the boundary is joined to one inner vertex, in the middle of where
  /// pieces met before. Used where the subdivision's sides do not agree with what the edges say: the faces beside an
  /// edge may know different candidates.
  struct Side {
    std::vector<double> breaks;  ///< from corner i, 0 to 1
    std::vector<Index> sites;    ///< one more than breaks
  };
  void build_star(const std::array<Side, 3>& sides);

 private:
  bool insert(Index plane);
  bool is_below(const FacePlane& plane, Index vertex) const;
  bool cut(Piece& piece, Index plane, std::vector<Piece>& kept, std::vector<Piece>& taken);
  Index crossing(Index a, Index b, Index site, Index plane);
  std::array<Index, 3> planes_at_crossing(Index a, Index b, Index site, Index plane) const;
  Vec3 meeting_place(const Vertex& vertex) const;
  Vec3 middle() const;
  bool merge(std::vector<Piece>& taken);
  void drop_idle_vertices();

  std::vector<FacePlane> planes_;
  std::vector<Vertex> vertices_;
  std::vector<Piece> pieces_;
  std::vector<int> uses_;            ///< by how many pieces, per vertex
  std::vector<std::uint8_t> below_;  ///< whether the plane being inserted is below the envelope, per vertex
  struct Cut {
    Index a, b, vertex;
  };
  std::vector<Cut> cuts_;
};

}  // namespace saddleback
