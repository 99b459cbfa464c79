// Building the graph: a window propagation from every vertex, then the union of arcs and reverse arcs in flat arrays.

#include "saddleback/saddle_vertex_graph.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "saddleback/error.h"

#include "geodesics/window_propagation.h"
#include "support/parallel.h"

namespace saddleback {
namespace {

/// One end of an arc, as it will lie in its vertex's row.
struct ArcEnd {
  Index target;
  float length, angle;
  bool operator<(const ArcEnd& other) const {
    return target != other.target   ? target < other.target
           : length != other.length ? length < other.length
                                    : angle < other.angle;
  }
};

struct FoundArc {
  Index source, target;
  float length, start_angle, end_angle;
};

void check_options(const Mesh& mesh, const SaddleVertexGraphOptions& options) {
  if (options.k < 1) throw InputError(message("k: wanted at least 1 vertex per geodesic disk, got ", options.k));
  if (options.k > mesh.vertex_count()) {
    throw InputError(message("k: ", options.k, " vertices per geodesic disk are more than the mesh has (",
                             mesh.vertex_count(), ")"));
  }
  if (options.threads < 0) throw InputError(message("threads: wanted 0 (all) or more, got ", options.threads));
}

/// The arcs that every vertex finds, a list a thread; their order depends on the threads, their set does not.
std::vector<std::vector<FoundArc>> find_arcs(const Unfolding& unfolding, const LengthQuantum& quantum, double unit,
                                             const SaddleVertexGraphOptions& options, const JobStage& stage) {
  const Mesh& mesh = unfolding.mesh();
  const int threads = thread_count(options.threads);
  std::vector<std::vector<FoundArc>> found(threads);
  std::vector<std::unique_ptr<WindowPropagator>> propagators(threads);
  std::vector<std::vector<DirectArc>> direct(threads);
  std::atomic<Index> done{0};
  parallel_for(mesh.vertex_count(), threads, 64, [&](Index source, int thread) {
    stage.check();
    if (!propagators[thread]) propagators[thread] = std::make_unique<WindowPropagator>(unfolding);
    propagators[thread]->from_vertex(source, options.k, direct[thread]);
    for (const DirectArc& arc : direct[thread]) {
      found[thread].push_back({source, arc.vertex, static_cast<float>(quantum.round(arc.length) / unit),
                               static_cast<float>(arc.start_angle), static_cast<float>(arc.end_angle)});
    }
    const Index count = done.fetch_add(1, std::memory_order_relaxed) + 1;
    if (count % 64 == 0) stage.update(static_cast<double>(count) / mesh.vertex_count());
  });
  return found;
}

template <class Use>
void for_each_arc(const std::vector<std::vector<FoundArc>>& found, const JobStage& stage, Use&& use) {
  constexpr std::size_t k_block = 1 << 16;
  for (const auto& list : found) {
    for (std::size_t begin = 0; begin < list.size(); begin += k_block) {
      stage.check();
      for (std::size_t i = begin; i < std::min(begin + k_block, list.size()); ++i) use(list[i]);
    }
  }
}

}  // namespace

LengthQuantum::LengthQuantum(double mean_edge) : step_(std::ldexp(1.0, std::ilogb(mean_edge) - 32)) {}

double LengthQuantum::round(double length) const { return std::max(std::round(length / step_), 1.0) * step_; }

SaddleVertexGraph::SaddleVertexGraph(const Mesh& mesh, const SaddleVertexGraphOptions& options, Job* job)
    : mesh_(&mesh),
      k_(options.k),
      unit_(std::ldexp(1.0, std::ilogb(mesh.mean_edge_length()))),
      quantum_(mesh.mean_edge_length()) {
  check_options(mesh, options);
  const auto started = std::chrono::steady_clock::now();
  const JobStage stage(job, "Building the saddle vertex graph");
  unfolding_ = std::make_unique<Unfolding>(mesh, options.threads, stage);
  const auto found = find_arcs(*unfolding_, quantum_, unit_, options, stage.part(0, 0.9));

  // Every found arc goes into the rows of both its ends; the shortest of each pair stays.
  std::vector<std::int64_t> begin(mesh.vertex_count() + 1, 0);
  for_each_arc(found, stage, [&](const FoundArc& arc) { ++begin[arc.source + 1], ++begin[arc.target + 1]; });
  for (Index v = 0; v < mesh.vertex_count(); ++v) begin[v + 1] += begin[v];
  std::vector<ArcEnd> ends(begin.back());
  std::vector<std::int64_t> cursor(begin.begin(), begin.end() - 1);
  for_each_arc(found, stage, [&](const FoundArc& arc) {
    ends[cursor[arc.source]++] = {arc.target, arc.length, arc.start_angle};
    ends[cursor[arc.target]++] = {arc.source, arc.length, arc.end_angle};
  });
  stage.update(0.93);
  std::vector<Index> degree(mesh.vertex_count());
  parallel_for(mesh.vertex_count(), options.threads, 1024, [&](Index v, int) {
    stage.check();
    const auto row = ends.begin() + begin[v], row_end = ends.begin() + begin[v + 1];
    std::sort(row, row_end);
    degree[v] = static_cast<Index>(
        std::unique(row, row_end, [](const ArcEnd& a, const ArcEnd& b) { return a.target == b.target; }) - row);
  });
  stage.update(0.97);

  offsets_.assign(mesh.vertex_count() + 1, 0);
  for (Index v = 0; v < mesh.vertex_count(); ++v) offsets_[v + 1] = offsets_[v] + degree[v];
  targets_.resize(offsets_.back());
  lengths_.resize(offsets_.back());
  angles_.resize(offsets_.back());
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    stage.check();
    for (Index i = 0; i < degree[v]; ++i) {
      const ArcEnd& end = ends[begin[v] + i];
      targets_[offsets_[v] + i] = end.target;
      lengths_[offsets_[v] + i] = end.length;
      angles_[offsets_[v] + i] = end.angle;
      longest_arc_ = std::max(longest_arc_, length(offsets_[v] + i));
    }
  }
  stage.update(1);
  build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
}

SaddleVertexGraph::~SaddleVertexGraph() = default;
SaddleVertexGraph::SaddleVertexGraph(SaddleVertexGraph&&) noexcept = default;

std::size_t SaddleVertexGraph::nbytes() const {
  return offsets_.size() * sizeof(std::int64_t) + targets_.size() * (sizeof(Index) + 2 * sizeof(float));
}

std::int64_t SaddleVertexGraph::find_arc(Index from, Index to) const {
  const auto row = targets_.begin() + offsets_[from], end = targets_.begin() + offsets_[from + 1];
  const auto found = std::lower_bound(row, end, to);
  return found != end && *found == to ? found - targets_.begin() : -1;
}

}  // namespace saddleback
