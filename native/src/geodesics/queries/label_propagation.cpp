#include "geodesics/queries/label_propagation.h"

#include "geodesics/queries/query_cache.h"

namespace saddleback {

LabelField propagate_labels(const SaddleVertexGraph& graph, std::span<const Seed> seeds, const QueryOptions& options,
                            bool with_predecessors, const JobStage& stage) {
  const auto search = graph.query_cache().field_searches.lease();
  const SearchLabels labels = with_predecessors ? SearchLabels::sources_and_predecessors : SearchLabels::sources;
  constexpr double k_searched = 0.92;  // of the time
  search->run(graph, seeds, options, labels, stage.part(0, k_searched));
  const Index count = graph.mesh().vertex_count();
  LabelField field;
  field.distance.resize(count);
  field.source.resize(count);
  search->write_distances(graph, field.distance);
  search->write_sources(graph, field.source);
  if (with_predecessors) {
    field.predecessor.resize(count);
    search->write_predecessors(graph, field.predecessor);
  }
  stage.update(1);
  return field;
}

}  // namespace saddleback
