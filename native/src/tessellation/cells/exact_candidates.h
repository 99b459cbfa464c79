#pragma once
// Candidates by exact distances, on faces divided so finely that squared distances are what one plane would say.

#include <deque>

#include "saddleback/geodesics/exact_distances.h"

#include "geodesics/exact/ways_to_face.h"
#include "tessellation/cells/face_candidates.h"
#include "tessellation/cells/face_refinement.h"

namespace saddleback {

/// Divides faces where several sites are nearest until, in every part, the squared distance of each of them is that of
/// a point in the part's plane to within a tolerance: behind saddle vertices, where bisectors are hyperbolas, and where
/// geodesics to a site go round a vertex on two sides. Between two sites only the difference of their distances counts,
/// which is as smooth as they are near each other. How far a site is where another is nearer may be told as if the
/// surface went on as where the site is nearest: then straight bisectors need no parts. Parts are divided no further
/// beyond a number that is proportional to that of faces and sites and that no bisectors of lines and hyperbolas ask
/// for.
class ExactParts {
 public:
  /// `sites`: the sites that are the field's sources, in increasing order; cells are numbered by them. `tolerances`:
  /// of distances, mesh units, by the mesh's component. The others must outlive the parts. \throw Cancelled.
  ExactParts(const ExactField& field, const std::vector<Index>& sites, std::vector<double> tolerances, int threads,
             const JobStage& stage);

  const FaceRefinement& refinement() const { return refinement_; }
  /// Values by face of the mesh.
  const std::vector<Index>& order() const { return order_; }
  ExactField::Sight nearest(Index vertex) const { return {vertices_[vertex].source, vertices_[vertex].distance}; }
  /// The sites that may own something of a part, by site.
  void find_candidates(const FaceRefinement::Part& part, std::vector<FaceCandidate>& candidates) const;

 private:
  using Way = ExactField::Way;
  using Ways = std::vector<Way>;
  /// The distance of a site from a vertex, in all its faces.
  struct Known {
    Index source;
    bool is_straight;  ///< told as if the surface went on
    double distance;
    double excess;  ///< what is told then, beyond the distance that is known
  };
  using Distances = std::vector<Known>;  ///< by site
  using Corners = std::array<std::span<const Known>, 3>;
  struct Vertex {
    double distance;      ///< of the nearest source
    Index source, count;  ///< the nearest; of those that are known
    std::size_t first;
  };
  enum class State : std::uint8_t {
    due,        ///< not looked at yet, or not since something changed about it
    looked_at,  ///< ahead of its turn
    done
  };
  /// Holds what is found of a part.
  struct Look {
    Index part = k_none;
    bool is_right = false, tells = false;
    std::array<Distances, 3> told;  ///< of its corners, if it tells
    std::vector<FaceCandidate> candidates;
    std::array<Ways, 4> at_samples;
    WaysToFace found, inside;           ///< the ways, where they are not known, and those that matter, where fewer
    const WaysToFace* known = nullptr;  ///< may be `found`
    bool are_fewer = false;
    const WaysToFace& ways() const { return are_fewer ? inside : *known; }
  };
  Index look_ahead(Index part, double least);
  void look_at(Index index, Look& look) const;
  void tell_corners(const Look& look);
  void fetch(const Look* look, const Look* end) const;
  void sort_parts();
  void look_at_mesh_vertices(const JobStage& stage);
  void look_at_added();
  void find_ways(const WaysToFace& to_face, const Vec3& place, Ways& ways) const;
  void add_distances(const WaysToFace& to_face, const Vec3& place, Distances& distances);
  void add_vertex(const Distances& distances);
  void tell(Index vertex, const Distances& distances);
  std::span<const Known> distances_of(Index vertex) const {
    return {known_.data() + vertices_[vertex].first, static_cast<std::size_t>(vertices_[vertex].count)};
  }
  Corners corners_of(const FaceRefinement::Part& part) const;
  void find_candidates(const FaceRefinement::Part& part, const Corners& corners,
                       std::vector<FaceCandidate>& candidates) const;
  void divide(const Look& look);
  /// The length of a part, in tolerances.
  double length_of(const FaceRefinement::Part& part) const {
    return std::ranges::max(part.length) / tolerance_of(part);
  }
  double tolerance_of(const FaceRefinement::Part& part) const {
    return tolerances_.size() == 1 ? tolerances_[0]
                                   : tolerances_[field_.mesh().component_of(field_.mesh().triangles()[part.face][0])];
  }
  bool is_right(const FaceRefinement::Part& part, Look& look) const;
  void find_ways_inside(const FaceRefinement::Part& part, Look& look) const;
  bool fits(const FaceRefinement::Part& part, const std::vector<FaceCandidate>& candidates, const Look& look,
            const Ways* straight, double tolerance) const;
  bool owners_are_nearest(const FaceRefinement::Part& part, const Look& look, double tolerance) const;
  Ways ways_seen(const Look& look) const;
  bool explain(const FaceRefinement::Part& part, const Look& look, const Ways& ways,
               std::span<const Vec3> places) const;
  bool straighten(const FaceRefinement::Part& part, Look& look, double tolerance) const;

  const ExactField& field_;
  const std::vector<Index>& sites_;
  const std::vector<double> tolerances_;  ///< by component
  const int threads_;
  const JobStage stage_;
  FaceRefinement refinement_;
  LargeArray<Vertex> vertices_;
  LargeArray<Known> known_;         ///< of vertices, by source
  std::deque<WaysToFace> ways_to_;  ///< shared by the halves of a part
  std::vector<Index> ways_of_;      ///< by part: which of those, k_none: not found yet
  Ways found_;                      ///< for add_distances alone
  std::vector<State> state_;        ///< by part
  std::vector<Look> looks_;         ///< ahead, then one of no part
  Look* next_ = nullptr;            ///< the first of them whose turn has not come
  std::vector<Index> changed_;
  std::vector<Index> order_;
};

/// Gives the same as candidates of faces that are the parts, in their order.
class ExactCandidates final : public FaceCandidates {
 public:
  /// Both must outlive the candidates.
  ExactCandidates(const ExactParts& parts, const FaceTable& faces, Index site_count, int threads);
  Index label(Index vertex) const override { return parts_.nearest(vertex).source; }
  double distance(Index vertex) const override { return parts_.nearest(vertex).distance; }

 private:
  const ExactParts& parts_;
};

}  // namespace saddleback
