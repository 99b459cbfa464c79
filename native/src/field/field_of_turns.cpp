#include <cmath>
#include <numbers>

#include "saddleback/error.h"
#include "saddleback/field/direction_field.h"

#include "field/connection/surface_connection.h"

namespace saddleback {
namespace {

/// Bounds the turn beyond which no curve can follow the field from face to face in a time that one waits for.
constexpr double k_most_turn = 1000;
/// Bounds the angle beyond which what is left after whole turns is rounding.
constexpr double k_most_angle = 1e6;
constexpr double k_opposite = 1e-9, k_arrives = 1e-6;  // radians

void check_values(std::span<const double> angles, std::span<const double> turns) {
  for (std::size_t f = 0; f < angles.size(); ++f)
    if (!(std::abs(angles[f]) <= k_most_angle))
      throw InputError(message("angles: value ", angles[f], " at [", f, "] is not finite or beyond 1e6"));
  for (std::size_t h = 0; h < turns.size(); ++h)
    if (!(std::abs(turns[h]) <= k_most_turn))
      throw InputError(
          message("turns: value ", turns[h], " at [", h / 3, ", ", h % 3, "] is not finite or beyond 1000"));
}

}  // namespace

DirectionField field_of_turns(const Mesh& mesh, int symmetry, std::span<const double> angles,
                              std::span<const double> turns, Job* job) {
  if (symmetry != 1 && symmetry != 2 && symmetry != 4)
    throw InputError(message("symmetry: wanted 1, 2 or 4, got ", symmetry));
  if (angles.size() != static_cast<std::size_t>(mesh.face_count()))
    throw InputError(message("angles: wanted ", mesh.face_count(), " values, got ", angles.size()));
  if (turns.size() != static_cast<std::size_t>(mesh.halfedge_count()))
    throw InputError(message("turns: wanted ", mesh.face_count(), " rows, got ", turns.size() / 3));
  check_values(angles, turns);
  const JobStage stage(job, "Reading directions");
  const SurfaceConnection connection = surface_connection(mesh, stage.part(0, 0.5));
  for (Index h = 0; h < mesh.halfedge_count(); ++h) {
    stage.check();
    const Index twin = mesh.twin(h), face = Mesh::face_of(h);
    if (!(std::abs(turns[h] + (twin == k_none ? 0 : turns[twin])) < k_opposite))
      throw InputError(message("turns: not opposite across edge ", h % 3, " of face ", face));
    if (twin == k_none) continue;
    const double arrival = angles[face] + connection.transport[h] + turns[h];
    const double miss = std::remainder(arrival - angles[Mesh::face_of(twin)], 2 * std::numbers::pi / symmetry);
    if (!(std::abs(miss) < k_arrives))
      throw InputError(message("turns: across edge ", h % 3, " of face ", face, " the field turns to ", std::abs(miss),
                               " radians beside that of face ", Mesh::face_of(twin)));
  }
  return DirectionField(mesh, symmetry, {angles.begin(), angles.end()}, {turns.begin(), turns.end()},
                        stage.part(0.5, 1));
}

}  // namespace saddleback
