#include "geodesics/wave_mesh.h"

#include "support/parallel.h"

namespace saddleback {
namespace {

constexpr Index k_chunk = 1024;

/// Calls use(halfedge) for the half-edges out of a vertex, counter-clockwise.
template <class Use>
void for_each_out(const Mesh& mesh, Index vertex, Use&& use) {
  const Index first = mesh.first_halfedge(vertex);
  Index h = first;
  do {
    use(h);
    h = mesh.rotate(h);
  } while (h != k_none && h != first);
}

}  // namespace

WaveMesh::WaveMesh(const Unfolding& unfolding, std::span<const Index> nodes, std::span<const Index> vertices,
                   int threads, const JobStage& stage) {
  const Mesh& mesh = unfolding.mesh();
  const auto edges = static_cast<std::size_t>(mesh.halfedge_count());
  unit_ = mesh.mean_edge_length();
  first_.assign(vertices.size() + 1, 0);
  const auto count = static_cast<Index>(vertices.size());
  parallel_for(count, threads, k_chunk, [&](Index node, int) {
    stage.check();
    for_each_out(mesh, vertices[node], [&](Index) { ++first_[node + 1]; });
  });
  for (Index node = 0; node < count; ++node) first_[node + 1] += first_[node];
  stage.update(0.2);
  LargeArray<Index> edge_of(edges);
  parallel_for(count, threads, k_chunk, [&](Index node, int) {
    stage.check();
    Index next = first_[node];
    for_each_out(mesh, vertices[node], [&](Index h) { edge_of[h] = next++; });
  });
  stage.update(0.4);
  records_.resize(edges);
  targets_.resize(edges);
  lengths_.resize(edges);
  saddles_.resize(vertices.size());
  const auto edge_behind = [&](Index h) { return mesh.twin(h) == k_none ? k_none : edge_of[mesh.twin(h)]; };
  parallel_for(count, threads, k_chunk, [&](Index node, int) {
    stage.check();
    const Index vertex = vertices[node];
    saddles_[node] = mesh.is_saddle(vertex);
    for_each_out(mesh, vertex, [&](Index h) {
      const Index e = edge_of[h], apex = mesh.apex(h);
      const Vec2 place = unfolding.apex(h) / mesh.length(h);
      records_[e] = {place.x(), place.y(), edge_behind(Mesh::prev(h)), edge_behind(Mesh::next(h)), nodes[apex], 0};
      targets_[e] = nodes[mesh.to(h)];
      lengths_[e] = mesh.length(h) / unit_;
    });
  });
}

Index WaveMesh::edge_between(Index from, Index to) const {
  Index edge = begin(from);
  while (edge < end(from) && target(edge) != to) ++edge;
  return edge < end(from) ? edge : k_none;
}

FanMesh::FanMesh(const Unfolding& unfolding, std::span<const Index> nodes, std::span<const Index> vertices, int threads,
                 const JobStage& stage)
    : waves_(unfolding, nodes, vertices, threads, stage.part(0, 0.8)),
      apex_directions_(static_cast<std::size_t>(unfolding.mesh().halfedge_count())) {
  parallel_for(waves_.node_count(), threads, k_chunk, [&](Index node, int) {
    stage.check();
    Index e = waves_.begin(node);
    for_each_out(unfolding.mesh(), vertices[node],
                 [&](Index h) { apex_directions_[e++] = unfolding.polar(Mesh::prev(h)); });
  });
}

WaveSectors::WaveSectors(const WaveMesh& waves, const Unfolding& unfolding, std::span<const Index> vertices,
                         int sectors, int threads, const JobStage& stage) {
  const Mesh& mesh = unfolding.mesh();
  const auto edges = static_cast<std::size_t>(mesh.halfedge_count());
  sectors_.resize(edges);
  reverse_sectors_.resize(edges);
  apex_sectors_.resize(edges);
  per_radian_.resize(vertices.size());
  const auto per_radian = [&](Index vertex) { return sectors / mesh.total_angle(vertex); };
  parallel_for(waves.node_count(), threads, k_chunk, [&](Index node, int) {
    stage.check();
    const Index vertex = vertices[node];
    per_radian_[node] = static_cast<float>(per_radian(vertex));
    Index e = waves.begin(node);
    for_each_out(mesh, vertex, [&](Index h) {
      sectors_[e] = static_cast<float>(unfolding.polar(h) * per_radian(vertex));
      reverse_sectors_[e] = static_cast<float>(unfolding.polar_of_reverse(h) * per_radian(mesh.to(h)));
      apex_sectors_[e] = static_cast<float>(unfolding.polar(Mesh::prev(h)) * per_radian(mesh.apex(h)));
      ++e;
    });
  });
}

}  // namespace saddleback
