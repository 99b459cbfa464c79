#include "geodesics/label_propagation.h"

#include "geodesics/query_cache.h"

namespace saddleback {

LabelField propagate_labels(const SaddleVertexGraph& graph, std::span<const Seed> seeds, const QueryOptions& options,
                            bool with_predecessors, const JobStage& stage) {
  const auto search = graph.query_cache().field_searches.lease();
  const SearchLabels labels = with_predecessors ? SearchLabels::sources_and_predecessors : SearchLabels::sources;
  search->run(graph, seeds, options, labels, stage);
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
  return field;
}

Index previous_vertex(const SaddleVertexGraph& graph, std::span<const double> distance, std::span<const Index> source,
                      Index vertex, std::int64_t* arc) {
  const ArcRows& arcs = graph.arcs();
  const Index node = graph.node_of(vertex);
  std::int64_t best = -1;
  for (std::int64_t i = arcs.first(node); i < arcs.first(node + 1); ++i) {
    const Index before = graph.vertex_of(arcs.target(i));
    if (distance[before] + arcs.length(i) != distance[vertex]) continue;
    if (!source.empty() && source[before] != source[vertex]) continue;
    if (best >= 0 && arcs.length(i) < arcs.length(best)) continue;
    if (best >= 0 && arcs.length(i) == arcs.length(best) && arcs.target(i) > arcs.target(best)) continue;
    best = i;
  }
  if (arc) *arc = best;
  return best >= 0 ? graph.vertex_of(arcs.target(best)) : k_none;
}

}  // namespace saddleback
