// A field from directions that somebody else made: combed hair, a flow painted on faces.

#include <cmath>
#include <complex>
#include <numbers>

#include "saddleback/error.h"
#include "saddleback/field/direction_field.h"

#include "field/connection/surface_connection.h"
#include "field/smoothing/given_directions.h"

namespace saddleback {
namespace {

/// The part of a vector within a face as an angle in the face's chart.
double angle_within(const Mesh& mesh, Index face, const Vec3& vector) {
  if (!vector.allFinite()) throw InputError(message("vectors: the one of face ", face, " is not finite"));
  const double largest = vector.cwiseAbs().maxCoeff();
  const int exponent = largest > 0 ? std::ilogb(largest) : 0;  // taken out exactly: squares stay among the doubles
  const Vec3 scaled = vector.unaryExpr([&](double v) { return std::ldexp(v, -exponent); });
  const std::complex<double> part = part_within(mesh, face, scaled);
  if (!has_part_within(part, scaled))
    throw InputError(message("vectors: the one of face ", face, " has no direction within the face"));
  return std::arg(part);
}

}  // namespace

DirectionField field_of_vectors(const Mesh& mesh, int symmetry, std::span<const Vec3> vectors, Job* job) {
  if (symmetry != 1 && symmetry != 2 && symmetry != 4)
    throw InputError(message("symmetry is ", symmetry, ", but must be 1, 2 or 4"));
  if (vectors.size() != static_cast<std::size_t>(mesh.face_count()))
    throw InputError(
        message("vectors: wanted one for each of the ", mesh.face_count(), " faces, got ", vectors.size()));
  const JobStage stage(job, "Reading directions");
  std::vector<double> angles(vectors.size());
  for (Index f = 0; f < mesh.face_count(); ++f) {
    stage.check();
    angles[f] = angle_within(mesh, f, vectors[f]);
  }

  const SurfaceConnection connection = surface_connection(mesh, stage.part(0.3, 0.6));
  std::vector<double> turns(mesh.halfedge_count(), 0.0);
  for (Index h = 0; h < mesh.halfedge_count(); ++h) {
    const Index twin = mesh.twin(h);
    stage.check();
    if (twin == k_none || twin < h) continue;
    const double difference = angles[twin / 3] - angles[h / 3] - connection.transport[h];
    turns[h] = std::remainder(difference, 2 * std::numbers::pi / symmetry);
    turns[twin] = -turns[h];
  }
  return {mesh, symmetry, std::move(angles), std::move(turns), stage.part(0.6, 1)};
}

}  // namespace saddleback
