// Building the graph: a window propagation from every vertex, then the union of arcs and reverse arcs in flat arrays.

#include "saddleback/saddle_vertex_graph.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "saddleback/error.h"

#include "geodesics/arc_symmetry.h"
#include "geodesics/arc_unfolding.h"
#include "geodesics/path_bound.h"
#include "geodesics/window_propagation.h"
#include "mesh/hilbert.h"
#include "support/parallel.h"

namespace saddleback {
namespace {

// Nodes whose arcs are found and joined together.
constexpr Index k_block = 256;

void check_options(const Mesh& mesh, const SaddleVertexGraphOptions& options) {
  if (options.k < 1) throw InputError(message("k: wanted at least 1 vertex per geodesic disk, got ", options.k));
  if (options.k > mesh.vertex_count()) {
    throw InputError(message("k: ", options.k, " vertices per geodesic disk are more than the mesh has (",
                             mesh.vertex_count(), ")"));
  }
  if (options.threads < 0) throw InputError(message("threads: wanted 0 (all) or more, got ", options.threads));
}

int sector_of(double angle, double total_angle) {
  return std::clamp(static_cast<int>(angle / total_angle * ArcCodec::k_sectors), 0, ArcCodec::k_sectors - 1);
}

}  // namespace

SaddleVertexGraph::SaddleVertexGraph(const Mesh& mesh, const SaddleVertexGraphOptions& options, Job* job)
    : mesh_(&mesh), k_(options.k) {
  check_options(mesh, options);
  const auto started = std::chrono::steady_clock::now();
  const JobStage stage(job, "Building the saddle vertex graph");
  unfolding_ = std::make_unique<Unfolding>(mesh, options.threads, stage);
  order_nodes();
  const ArcCodec codec(mesh.vertex_count(), mesh.mean_edge_length(), longest_path_bound(mesh));
  auto found = find_arcs(codec, options.threads, stage.part(0, 0.9));
  arcs_ = unite_with_reverses(codec, found, k_block, options.threads, stage.part(0.9, 1));
  build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
}

void SaddleVertexGraph::order_nodes() {
  const HilbertCurve curve(mesh_->positions());
  std::vector<std::uint64_t> keys(mesh_->vertex_count());
  for (Index v = 0; v < mesh_->vertex_count(); ++v) keys[v] = curve.key(mesh_->position(v));
  vertices_ = order_of(keys);
  nodes_.resize(mesh_->vertex_count());
  for (Index node = 0; node < mesh_->vertex_count(); ++node) nodes_[vertices_[node]] = node;
}

std::vector<FoundArcs> SaddleVertexGraph::find_arcs(const ArcCodec& codec, int threads, const JobStage& stage) const {
  const Index count = mesh_->vertex_count(), blocks = (count + k_block - 1) / k_block;
  std::vector<FoundArcs> found(blocks);
  std::vector<std::unique_ptr<WindowPropagator>> propagators(thread_count(threads));
  std::vector<std::vector<DirectArc>> direct(thread_count(threads));
  std::atomic<Index> done{0};
  parallel_for(blocks, threads, 1, [&](Index b, int thread) {
    if (!propagators[thread]) propagators[thread] = std::make_unique<WindowPropagator>(*unfolding_);
    FoundArcs& block = found[b];
    block.first_node = b * k_block;
    for (Index node = block.first_node; node < std::min(block.first_node + k_block, count); ++node) {
      stage.check();
      const Index vertex = vertices_[node];
      propagators[thread]->from_vertex(vertex, k_, direct[thread]);
      block.counts.push_back(static_cast<std::int32_t>(direct[thread].size()));
      for (const DirectArc& arc : direct[thread]) {
        const int sector = sector_of(arc.start_angle, mesh_->total_angle(vertex));
        block.words.push_back(codec.pack(nodes_[arc.vertex], sector, arc.length));
        const int back = sector_of(arc.end_angle, mesh_->total_angle(arc.vertex));
        block.back_sectors.push_back(static_cast<std::uint8_t>(back));
      }
    }
    stage.update(static_cast<double>(done.fetch_add(1, std::memory_order_relaxed) + 1) / blocks);
  });
  return found;
}

SaddleVertexGraph::~SaddleVertexGraph() = default;
SaddleVertexGraph::SaddleVertexGraph(SaddleVertexGraph&&) noexcept = default;

std::size_t SaddleVertexGraph::nbytes() const {
  return arcs_.nbytes() + (nodes_.size() + vertices_.size()) * sizeof(Index);
}

ArcHint SaddleVertexGraph::hint(Index node, std::int64_t arc) const {
  // The angle was rounded down to a sector; its own rounding may have put it on the other side of the border.
  constexpr double k_margin = 1e-3;
  const Index vertex = vertices_[node];
  const double sector = arcs_.sector(arc), width = mesh_->total_angle(vertex) / ArcCodec::k_sectors;
  return {vertex, vertices_[arcs_.target(arc)], arcs_.length(arc), (sector - k_margin) * width,
          (sector + 1 + k_margin) * width};
}

void SaddleVertexGraph::fan(const SurfacePoint& point, WindowPropagator& propagator,
                            std::vector<DirectArc>& arcs) const {
  propagator.from_point(point, k_, arcs);
}

}  // namespace saddleback
