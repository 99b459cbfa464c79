#include "saddleback/shape_mapping/bent_copies.h"

#include <cmath>
#include <limits>
#include <utility>

#include "saddleback/error.h"
#include "saddleback/shape_mapping/conform.h"

#include "shape_mapping/mapper_team.h"
#include "shape_mapping/surface_fit.h"

namespace saddleback {
namespace {

void check(std::span<const Shape> shapes, std::span<const Solid> solids, const BendOptions& options) {
  if (solids.size() != shapes.size())
    throw InputError(message("solids: wanted one for each of the ", shapes.size(), " shapes, got ", solids.size()));
  if (!(options.tolerance >= 0) || !std::isfinite(options.tolerance))
    throw InputError(message("tolerance is ", options.tolerance, ", but must be finite and not negative"));
  for (std::size_t s = 0; s < solids.size(); ++s) {
    const Solid& solid = solids[s];
    const auto count = static_cast<Index>(solid.vertices.size());
    for (Index i = 0; i < count; ++i)
      if (!solid.vertices[i].allFinite())
        throw InputError(message("solids: vertex ", i, " of solid ", s, " is not finite"));
    for (std::size_t t = 0; t < solid.triangles.size(); ++t)
      for (const Index corner : solid.triangles[t])
        if (corner < 0 || corner >= count)
          throw InputError(message("solids: triangle ", t, " of solid ", s, " has corner ", corner, ", but there are ",
                                   count, " vertices"));
  }
}

/// Holds what became of one placement.
struct Bent {
  MapFailure failure = MapFailure::none;
  std::vector<SurfaceFit::Vertex> vertices;
  std::vector<SurfaceFit::Face> faces;
  double deviation = std::numeric_limits<double>::quiet_NaN();
};

void append(const Bent& bent, Index number, bool is_mirrored, BentCopies& result) {
  const std::int64_t first = result.begins.back();
  for (const SurfaceFit::Vertex& vertex : bent.vertices) {
    if (vertex.is_lost) result.lost.push_back(static_cast<std::int64_t>(result.anchors.size()));
    result.anchors.push_back(vertex.anchor);
    result.heights.push_back(vertex.height);
  }
  const auto offset = static_cast<Index>(first);
  for (const SurfaceFit::Face& face : bent.faces) {
    Triangle triangle{face.vertices[0] + offset, face.vertices[1] + offset, face.vertices[2] + offset};
    std::array<Vec3, 3> weights = face.weights;
    if (is_mirrored) {
      std::swap(triangle[1], triangle[2]);
      std::swap(weights[1], weights[2]);
    }
    result.triangles.push_back(triangle);
    result.triangle_copy.push_back(number);
    result.triangle_source.push_back(face.source);
    result.weights.push_back(weights);
  }
  result.begins.push_back(static_cast<std::int64_t>(result.anchors.size()));
  result.deviations.push_back(bent.deviation);
}

}  // namespace

BentCopies bent_copies(const Mesh& mesh, std::span<const Shape> shapes, std::span<const Placement> placements,
                       std::span<const Solid> solids, const BendOptions& options) {
  const JobStage stage(options.mapping.job, "Bending shapes onto the surface");
  check_mapping(mesh, shapes, placements, options.mapping);
  check(shapes, solids, options);
  const std::vector<Vec3> found = options.normals.empty() ? vertex_normals(mesh) : std::vector<Vec3>();
  const std::span<const Vec3> normals = options.normals.empty() ? std::span<const Vec3>(found) : options.normals;
  std::vector<SolidEdges> edges;
  for (const Solid& solid : solids) edges.emplace_back(solid);
  const auto count = static_cast<Index>(placements.size());
  std::vector<Bent> bent(placements.size());
  std::atomic<Index> done{0};
  MapperTeam team(mesh, options.mapping.threads);
  parallel_for(count, team.threads(), 1, [&](Index i, int thread) {
    const Placement& placement = placements[i];
    const Shape& shape = shapes[placement.shape];
    const double radius = shape.circumradius() * placement.scale;
    OutlineMapper& mapper = team.of(thread);
    SurfaceOutline outline;
    bent[i].failure =
        map_shape(mapper, shape, placement, options.mapping.field(placement.shape), outline, options.mapping.limits);
    if (bent[i].failure == MapFailure::none) {
      SurfaceFit fit(mesh, normals);
      fit.bend(mapper, placement, solids[placement.shape], edges[placement.shape], options.tolerance * radius);
      bent[i].vertices.assign(fit.vertices().begin(), fit.vertices().end());
      bent[i].faces.assign(fit.faces().begin(), fit.faces().end());
      if (options.tolerance > 0) bent[i].deviation = fit.deviation() / radius;
    }
    stage.update(static_cast<double>(++done) / count);
  });
  BentCopies result;
  result.begins.push_back(0);
  for (Index i = 0; i < count; ++i) {
    if (result.anchors.size() + bent[i].vertices.size() > static_cast<std::size_t>(std::numeric_limits<Index>::max()))
      throw InputError("solids: the copies have more vertices together than one mesh can have");
    append(bent[i], i, placements[i].mirrored, result);
    bent[i] = {};
  }
  return result;
}

}  // namespace saddleback
