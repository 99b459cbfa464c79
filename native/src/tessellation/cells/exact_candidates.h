#pragma once
// Candidates by exact distances, on faces divided so finely that squared distances are what one plane would say.

#include "saddleback/geodesics/exact_distances.h"

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
  ExactParts(const ExactField& field, const std::vector<Index>& sites, std::vector<double> tolerances,
             const JobStage& stage);

  const FaceRefinement& refinement() const { return refinement_; }
  /// Values by face of the mesh.
  const std::vector<Index>& order() const { return order_; }
  const ExactField::Sight& nearest(Index vertex) const { return nearest_[vertex]; }
  /// The sites that may own something of a part, by site.
  void find_candidates(const FaceRefinement::Part& part, std::vector<FaceCandidate>& candidates) const;

 private:
  using Way = ExactField::Way;
  using Ways = std::vector<Way>;
  /// The distance of a site from a vertex, in all its faces.
  struct Known {
    Index source;
    double distance;
    bool is_straight = false;  ///< told as if the surface went on
    double excess = 0;         ///< what is told then, beyond the distance that is known
  };
  using Distances = std::vector<Known>;  ///< by site
  using Corners = std::array<const Distances*, 3>;
  void look_at_mesh_vertices(const JobStage& stage);
  void look_at_added();
  void find_ways(const SurfacePoint& place, Ways& ways) const;
  void add_distances(const SurfacePoint& place, Distances& distances) const;
  void set_nearest(Index vertex);
  Corners corners_of(const FaceRefinement::Part& part) const;
  void find_candidates(const FaceRefinement::Part& part, const Corners& corners,
                       std::vector<FaceCandidate>& candidates) const;
  void divide(Index part);
  bool is_looked_at(Index part) const;
  double tolerance_of(const FaceRefinement::Part& part) const {
    return tolerances_[field_.mesh().component_of(field_.mesh().triangles()[part.face][0])];
  }
  bool is_right(const FaceRefinement::Part& part);
  bool fits(const FaceRefinement::Part& part, const std::vector<FaceCandidate>& candidates, const Ways* straight,
            double tolerance) const;
  bool owners_are_nearest(const FaceRefinement::Part& part, const std::vector<FaceCandidate>& candidates,
                          double tolerance) const;
  Ways ways_seen(const std::vector<FaceCandidate>& candidates) const;
  bool explain(const FaceRefinement::Part& part, const Ways& ways, std::span<const Vec3> places) const;
  bool straighten(const FaceRefinement::Part& part, const std::vector<FaceCandidate>& candidates, double tolerance);

  const ExactField& field_;
  const std::vector<Index>& sites_;
  const std::vector<double> tolerances_;  ///< by component
  FaceRefinement refinement_;
  std::vector<Distances> distances_;  ///< by vertex
  std::vector<ExactField::Sight> nearest_;
  std::array<Ways, 4> at_samples_;  ///< of the part that is looked at
  Index clock_ = 0;                 ///< counts what is told anew
  std::vector<Index> told_;         ///< by vertex: when its distances were told
  std::vector<Index> looked_;       ///< by part: when it was found to be right, k_none: not yet
  std::vector<Index> order_;
};

/// Gives the same as candidates of faces that are the parts, in their order.
class ExactCandidates final : public FaceCandidates {
 public:
  /// Both must outlive the candidates.
  ExactCandidates(const ExactParts& parts, const FaceTable& faces, Index site_count);
  Index label(Index vertex) const override { return parts_.nearest(vertex).source; }
  double distance(Index vertex) const override { return parts_.nearest(vertex).distance; }

 private:
  const ExactParts& parts_;
};

}  // namespace saddleback
