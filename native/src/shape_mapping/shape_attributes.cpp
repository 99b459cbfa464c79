#include "saddleback/shape_mapping/shape_attributes.h"

#include <cmath>
#include <limits>
#include <numbers>

#include "saddleback/error.h"

#include "shape_mapping/mapper_team.h"
#include "support/planar.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

struct NearVertex {
  Index vertex;
  double distance;
  Vec2 plane;
};

double distance_to_outline(const Shape& shape, const Vec2& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const Shape::Loop& loop : shape.loops())
    for (std::size_t i = 0; i < loop.size(); ++i)
      least = std::min(least, distance_to_segment(point, loop[i], loop[i + 1 < loop.size() ? i + 1 : 0]));
  return least;
}

/// Lays the plane again with room for the reach about the shape.
void lay_wider(OutlineMapper& mapper, const Shape& shape, const Placement& placement, const DirectionField* field,
               double reach) {
  PlaneBox box = box_of(shape.loops(), placement);
  if (field) {
    const std::optional<CenterLine> line = center_line(*field, placement, box);
    const double far = std::max({-box.low.minCoeff(), box.high.maxCoeff()}) * std::numbers::sqrt2 + reach;
    if (line) return mapper.plane().along_curve(line->curve, line->origin, {Vec2(-far, -far), Vec2(far, far)});
  }
  box.low.array() -= reach;
  box.high.array() += reach;
  mapper.plane().about_point(placement.center, placement.angle, box);
}

std::vector<NearVertex> near_vertices(OutlineMapper& mapper, const Shape& shape, const Placement& placement,
                                      const SurfaceOutline& outline, const DirectionField* field, double reach) {
  std::vector<NearVertex> result;
  const auto depth = [&](const Vec2& plane) { return placement.scale * distance_to_outline(shape, plane); };
  for (std::size_t i = 0; i < outline.inside.size(); ++i)
    result.push_back({outline.inside[i], -depth(outline.inside_plane[i]), outline.inside_plane[i]});
  if (reach == 0) return result;
  lay_wider(mapper, shape, placement, field, reach);
  for (const Index vertex : mapper.plane().vertices()) {
    const Vec2 plane = mapper.given(mapper.plane().coordinates(vertex));
    const double distance = depth(plane);
    if (distance <= reach && !shape.contains(plane)) result.push_back({vertex, distance, plane});
  }
  return result;
}

}  // namespace

ShapeAttributes shape_attributes(const Mesh& mesh, std::span<const Shape> shapes, std::span<const Placement> placements,
                                 double reach, const MapShapesOptions& options) {
  if (!(reach >= 0) || !std::isfinite(reach))
    throw InputError(message("reach is ", reach, ", but must be finite and not negative"));
  const JobStage stage(options.job, "Measuring shapes on the surface");
  check_mapping(mesh, shapes, placements, options);
  const auto count = static_cast<Index>(placements.size());
  std::vector<std::vector<NearVertex>> near(placements.size());
  std::atomic<Index> done{0};
  MapperTeam team(mesh, options.threads);
  parallel_for(count, team.threads(), 4, [&](Index i, int thread) {
    SurfaceOutline outline;
    const Shape& shape = shapes[placements[i].shape];
    OutlineMapper& mapper = team.of(thread);
    const DirectionField* const field = options.field(placements[i].shape);
    if (map_shape(mapper, shape, placements[i], field, outline, options.limits) == MapFailure::none)
      near[i] = near_vertices(mapper, shape, placements[i], outline, field, reach);
    stage.update(static_cast<double>(++done) / count);
  });
  ShapeAttributes result;
  const auto vertices = static_cast<std::size_t>(mesh.vertex_count());
  result.placement.assign(vertices, k_none);
  result.distance.assign(vertices, std::numeric_limits<double>::infinity());
  result.plane.assign(vertices, Vec2::Zero());
  for (Index i = 0; i < count; ++i)
    for (const NearVertex& entry : near[i]) {
      if (entry.distance >= result.distance[entry.vertex]) continue;
      result.placement[entry.vertex] = i;
      result.distance[entry.vertex] = entry.distance;
      result.plane[entry.vertex] = entry.plane;
    }
  return result;
}

}  // namespace saddleback
