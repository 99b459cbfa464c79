#pragma once
// Directions all over a surface: vectors, lines or crosses that turn smoothly and are singular where one wants.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/surface_curve.h"
#include "saddleback/support/large_array.h"

namespace saddleback {

/// A vertex about which a field turns. Counted in units of 1 / symmetry of a full turn: a line field (symmetry 2) has
/// units of half a turn.
struct Singularity {
  Index vertex;
  Index units;
  bool operator==(const Singularity&) const = default;
};

/// One direction a face, of which `symmetry` equal ones at equal angles make a vector (1), a line (2) or a cross (4),
/// and how far it turns from each face to the next. Immutable; the mesh must outlive it.
class DirectionField {
 public:
  /// `angles`: per face, radians in its FaceChart. `turns`: per half-edge, by how much the field turns besides the
  /// Levi-Civita transport where it crosses from its face to the twin's, opposite for the twin, 0 on the boundary.
  DirectionField(const Mesh& mesh, int symmetry, std::vector<double> angles, std::vector<double> turns,
                 const JobStage& stage = {});

  const Mesh& mesh() const { return *mesh_; }
  int symmetry() const { return symmetry_; }
  std::span<const double> angles() const { return angles_; }
  std::span<const double> turns() const { return turns_; }
  /// (F,) unit vectors in space.
  std::vector<Vec3> vectors() const;

  /// Interior vertices of an index other than 0, ascending. Units of all and of the loops sum to symmetry times the
  /// Euler characteristic in each component.
  const std::vector<Singularity>& singularities() const { return singularities_; }
  Index units_at(Index vertex) const;
  /// Returns for each boundary loop how often (in units) the field turns against the boundary along it, 0 where it
  /// follows it.
  const std::vector<Index>& loop_units() const { return loop_units_; }
  /// The largest of the turns, radians. While it is below pi / symmetry the directions of the faces alone tell the
  /// singularities; beyond, faces are too large for how fast the field has to turn there.
  double largest_turn() const { return largest_turn_; }
  /// Half-edges, of two twins the one of the smaller face, across which the field turns by pi / symmetry or more:
  /// empty while the directions of the faces alone tell the singularities. O(F).
  std::vector<Index> sharp_edges() const;

  /// The field at a point, radians in the chart of its face. Continuous inside and across faces: within the surface
  /// only the vertices are left out, about which it turns evenly (there a mean is given). Exactly the face's own angle
  /// at its center. O(1).
  double angle_at(const SurfacePoint& point) const;

  /// The field at the begin of a half-edge, seen along it and along the edge before it in its face: angles in the chart
  /// of the face, between which it is linear about the vertex.
  std::pair<double, double> about_corner(Index h) const {
    return {angles_[h / 3] + along_[h], angles_[h / 3] + before_[h]};
  }

  /// Returns the same field turned by a constant angle, radians counter-clockwise. \throw InputError for one that is
  /// not finite.
  DirectionField turned(double angle) const;

 private:
  void measure_fan(Index vertex, std::vector<double>& differences);

  const Mesh* mesh_;
  int symmetry_;
  std::vector<double> angles_, turns_;
  /// Angles for each half-edge: of the field at its begin, seen along it and along the edge before it, less the face's
  /// angle.
  UnsetArray<double> along_, before_;
  std::vector<Singularity> singularities_;
  std::vector<Index> loop_units_;
  double largest_turn_ = 0;
};

/// A curve that the field shall follow.
struct Stroke {
  SurfaceCurve curve;
  /// Says whether the stroke is met exactly in every face that the curve crosses; otherwise it pulls as a spring of
  /// `weight`.
  bool is_hard = false;
  double weight = 1;
};

/// Directions that the field shall have in some places: one vector for each face or for each vertex (as many as both:
/// of faces), zero where nothing is given; lengths do not count. They pull as springs of their weight: 1 meets smooth
/// ones to about a degree.
struct GivenDirections {
  std::vector<Vec3> vectors;    ///< (F,) or (V,)
  std::vector<double> weights;  ///< as many, 0 or more; none for 1 everywhere
};

enum class FieldAlignment : std::uint8_t {
  none,
  curvature,  ///< lines along the least bent direction, crosses along both principal directions
  boundary,   ///< along every boundary loop
};

struct DirectionFieldOptions {
  /// All vertices that shall have an index, or none to let the field choose them.
  std::optional<std::vector<Singularity>> singularities;
  /// Turning of the field along each boundary loop; none: free to be what turns least. Only together with
  /// singularities.
  std::vector<std::optional<Index>> loop_units;
  std::vector<Stroke> strokes;
  std::optional<GivenDirections> directions;
  FieldAlignment align = FieldAlignment::none;
  double align_weight = 1;  ///< how much curvature counts against smoothness
};

/// Makes fields of one mesh and symmetry one after another, keeping what does not change between them: factors, loops
/// around handles and harmonic forms, and the last answers to begin from. One call at a time.
class DirectionFieldEditor {
 public:
  /// \throw InputError for a symmetry other than 1, 2 and 4. The mesh must outlive this. O(F).
  DirectionFieldEditor(const Mesh& mesh, int symmetry);
  ~DirectionFieldEditor();
  DirectionFieldEditor(DirectionFieldEditor&&) noexcept;
  DirectionFieldEditor& operator=(DirectionFieldEditor&&) noexcept;

  /// Finds, when there are singularities, the trivial connection that has exactly those [crane2010], to which strokes
  /// and given directions add a single-valued turning only, so that none can change an index. Without: the smoothest
  /// field, or the one nearest to strokes, given directions and alignment, with the singularities that it then has
  /// [knoppel2013]. Without anything that fixes it, the angle in the smallest face of a component is 0.
  /// \throw InputError for a vertex out of range, on the boundary or named twice; indices that do not sum to the Euler
  /// characteristic of their component (naming it and what is missing); a stroke of another mesh or a weight that is
  /// not positive and finite; hard strokes that disagree in a face, with others or themselves; another number of
  /// directions than faces or vertices, or of weights, one that is not finite or stands on its face, a weight below 0;
  /// curvature for symmetry 1. Cancelled. About O(F).
  DirectionField field(const DirectionFieldOptions& options = {}, Job* job = nullptr);
  /// Does the same as a part of other work.
  DirectionField field(const DirectionFieldOptions& options, const JobStage& stage);

 private:
  struct Kept;
  std::unique_ptr<Kept> kept_;
};

/// The field that has these directions: (F,) vectors in space, of which the part within each face counts, and no more
/// than their symmetry. From face to face it turns by less than half of 1 / symmetry, the nearer way.
/// \throw InputError for another symmetry than 1, 2 and 4, another number of vectors, one that is not finite or has no
/// part within its face; Cancelled. O(F).
DirectionField field_of_vectors(const Mesh& mesh, int symmetry, std::span<const Vec3> vectors, Job* job = nullptr);

/// The field that has these angles and turns, as `angles` and `turns` of another gave them. \throw InputError for
/// arrays of another length, values beyond a thousand (turns) or a million (angles) radians, turns that are not
/// opposite for the two faces of an edge, not 0 on the boundary or do not lead from one face's direction to one of the
/// other's; Cancelled. O(F).
DirectionField field_of_turns(const Mesh& mesh, int symmetry, std::span<const double> angles,
                              std::span<const double> turns, Job* job = nullptr);

/// One field, as by an editor that is used once.
DirectionField direction_field(const Mesh& mesh, int symmetry, const DirectionFieldOptions& options = {},
                               Job* job = nullptr);
/// Does the same as a part of other work.
DirectionField direction_field(const Mesh& mesh, int symmetry, const DirectionFieldOptions& options,
                               const JobStage& stage);

}  // namespace saddleback
