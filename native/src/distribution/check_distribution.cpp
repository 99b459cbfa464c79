#include "saddleback/distribution/check_distribution.h"

#include "saddleback/error.h"

#include "distribution/check/check_parts.h"

namespace saddleback {

CheckReport check_distribution(const Mesh& mesh, std::span<const Shape> shapes, std::span<const Placement> placements,
                               std::span<const MappedShape> mapped, const CheckOptions& options) {
  check_placements(mesh, shapes.size(), placements);
  if (mapped.size() != placements.size())
    throw InputError(message("mapped: ", mapped.size(), " shapes for ", placements.size(), " placements"));
  if (options.samples < 0) throw InputError(message("samples is ", options.samples, ", but must not be negative"));
  const JobStage stage(options.job, "Checking shapes");
  CheckReport report;
  FaultList faults(options.most_faults);
  report.placement_count = static_cast<Index>(placements.size());
  for (std::size_t i = 0; i < mapped.size(); ++i)
    if (mapped[i].failure != MapFailure::none)
      faults.add(Fault::not_laid, static_cast<Index>(i), k_none, placements[i].center);
  const CheckedPieces pieces = list_pieces(mesh, mapped);
  report.piece_count = static_cast<std::int64_t>(pieces.pieces.size());
  check_chains(mesh, mapped, faults);
  check_crossings(pieces, options, stage, faults);
  stage.update(0.2);
  check_nesting(mesh, mapped, pieces, stage, faults);
  stage.update(0.3);
  check_patches(mesh, shapes, placements, mapped, options, stage.part(0.3, 1), faults, report);
  report.fault_count = faults.count();
  report.faults = faults.take();
  stage.update(1);
  return report;
}

}  // namespace saddleback
