#include "saddleback/shape_mapping/map_shapes.h"

#include "saddleback/error.h"

#include "shape_mapping/mapper_team.h"
#include "support/threads/parallel.h"

namespace saddleback {

void check_mapping(const Mesh& mesh, std::span<const Shape> shapes, std::span<const Placement> placements,
                   const MapShapesOptions& options) {
  check_placements(mesh, shapes.size(), placements);
  if (options.fields.size() > 1 && options.fields.size() != shapes.size())
    throw InputError(message("field: ", options.fields.size(), " fields, but there are ", shapes.size(), " shapes"));
  for (const DirectionField* field : options.fields)
    if (&field->mesh() != &mesh) throw InputError("field belongs to another mesh");
  const MapLimits& limits = options.limits;
  if (!(limits.smallest > 0 && limits.smallest <= 1 && limits.largest >= 1))
    throw InputError(message("limits are ", limits.smallest, " and ", limits.largest,
                             ", but must be positive, the first at most 1 and the second at least 1"));
}

std::vector<MappedShape> map_shapes(const Mesh& mesh, std::span<const Shape> shapes,
                                    std::span<const Placement> placements, const MapShapesOptions& options) {
  const JobStage stage(options.job, "Laying shapes on the surface");
  check_mapping(mesh, shapes, placements, options);
  const auto count = static_cast<Index>(placements.size());
  std::vector<MappedShape> result(placements.size());
  std::atomic<Index> done{0};
  MapperTeam team(mesh, options.threads);
  parallel_for(count, team.threads(), 4, [&](Index i, int thread) {
    MappedShape& mapped = result[i];
    const Placement& placement = placements[i];
    mapped.failure = map_shape(team.of(thread), shapes[placement.shape], placement, options.field(placement.shape),
                               mapped.outline, options.limits);
    if (mapped.failure != MapFailure::none) mapped.outline = {};
    stage.update(static_cast<double>(++done) / count);
  });
  return result;
}

}  // namespace saddleback
