// The graph's questions and answers: sources become seeds, a search does the rest.

#include <cmath>

#include "saddleback/error.h"
#include "saddleback/saddle_vertex_graph.h"

#include "geodesics/label_propagation.h"
#include "geodesics/query_cache.h"
#include "geodesics/seeds.h"

namespace saddleback {
namespace {

void check_limit(double limit) {
  if (std::isnan(limit) || limit < 0) throw InputError(message("limit: wanted a distance of 0 or more, got ", limit));
}

}  // namespace

std::vector<double> SaddleVertexGraph::distances(const SurfacePoints& sources, const QueryOptions& options,
                                                 Job* job) const {
  const JobStage stage(job, "Measuring distances");
  check_limit(options.limit);
  const std::vector<Seed> seeds = make_seeds(*this, sources, stage);
  const auto search = queries_->lease();
  search->run(*this, seeds, options, SearchLabels::none, stage);
  std::vector<double> result(mesh_->vertex_count());
  search->write_distances(*this, result);
  return result;
}

NearestField SaddleVertexGraph::nearest(const SurfacePoints& sources, const QueryOptions& options, Job* job) const {
  const JobStage stage(job, "Finding nearest sources");
  check_limit(options.limit);
  LabelField field = propagate_labels(*this, make_seeds(*this, sources, stage), options, false, stage);
  return {std::move(field.distance), std::move(field.source)};
}

}  // namespace saddleback
