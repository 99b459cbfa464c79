#include "geodesics/graph_arcs.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "saddleback/error.h"

#include "geodesics/disk_rows.h"
#include "geodesics/window_propagation.h"
#include "support/memory.h"
#include "support/parallel.h"

namespace saddleback {
namespace {

// Windows end a little early, see disk_finder: on thousands of fields over twenty meshes this kept every error below
// the accuracy asked for.
constexpr double k_room = 0.95;

Index block_count(const ArcSearch& search) {
  return (static_cast<Index>(search.vertices.size()) + k_block - 1) / k_block;
}

/// A step that leads through all of `count` blocks, far from those before: the golden section of them, or near it.
Index scattering_step(Index count) {
  auto step = static_cast<Index>(count * 0.618);
  while (std::gcd(step, count) != 1) ++step;
  return step;
}

/// Calls find(block, count, thread) from all threads, and reports how many are done. For those who watch, blocks come
/// from all over the mesh, since parts of it may take longer; in their order they take 3 % less. Blocks are filled in
/// memory that each thread keeps, and kept without room to grow.
template <class Find>
std::vector<FoundArcs> find_by_blocks(const ArcSearch& search, const JobStage& stage, Find&& find) {
  std::vector<FoundArcs> found(block_count(search)), drafts(thread_count(search.threads));
  std::atomic<Index> done{0};
  const Index step = stage.is_watched() ? scattering_step(static_cast<Index>(found.size())) : 1;
  parallel_for(static_cast<Index>(found.size()), search.threads, 1, [&](Index i, int thread) {
    const auto b = static_cast<Index>(std::int64_t{i} * step % static_cast<std::int64_t>(found.size()));
    FoundArcs& draft = drafts[thread];
    draft.first_node = b * k_block;
    draft.counts.clear();
    draft.words.clear();
    draft.back_sectors.clear();
    find(draft, std::min(k_block, static_cast<Index>(search.vertices.size()) - draft.first_node), thread);
    draft.words.resize(draft.words.size() + k_row_padding);
    found[b] = draft;
    stage.update(static_cast<double>(++done) / static_cast<double>(found.size()));
  });
  return found;
}

int sector_of(double angle, double total_angle) {
  return std::clamp(static_cast<int>(angle / total_angle * ArcCodec::k_sectors), 0, ArcCodec::k_sectors - 1);
}

void append_row(const ArcSearch& search, Index vertex, const std::vector<DirectArc>& row, FoundArcs& found) {
  const Mesh& mesh = search.unfolding.mesh();
  found.counts.push_back(static_cast<std::int32_t>(row.size()));
  for (const DirectArc& arc : row) {
    const int sector = sector_of(arc.start_angle, mesh.total_angle(vertex));
    found.words.push_back(search.codec.pack(search.nodes[arc.vertex], sector, arc.length));
    found.back_sectors.push_back(static_cast<std::uint8_t>(sector_of(arc.end_angle, mesh.total_angle(arc.vertex))));
  }
}

std::string in_gigabytes(double bytes) { return message(std::max(0.1, std::round(bytes / 1e8) / 10), " GB"); }

/// Vertices in sight of one, in the mean of a few all over the mesh. Their number grows like a power of that of the
/// vertices looked at, which is told from disks of two sizes.
double mean_in_sight(const ArcSearch& search, WindowPropagator& propagator, const JobStage& stage) {
  constexpr Index k_samples = 16, k_disk = 4000, k_ratio = 4;
  const auto count = static_cast<Index>(search.vertices.size());
  const Index samples = std::min(k_samples, count), disk = std::min(k_disk, count);
  std::vector<DirectArc> row;
  double small = 0, large = 0;
  for (Index i = 0; i < samples; ++i) {
    stage.check();
    const Index vertex = search.vertices[static_cast<std::int64_t>(i) * count / samples];
    propagator.from_vertex(vertex, std::max<Index>(disk / k_ratio, 1), row);
    small += static_cast<double>(row.size()) / samples;
    propagator.from_vertex(vertex, disk, row);
    large += static_cast<double>(row.size()) / samples;
  }
  const double power = std::clamp(std::log(large / small) / std::log(k_ratio), 0.0, 1.0);
  return large * std::pow(static_cast<double>(count) / disk, power);
}

/// What is built holds the arcs twice for a while, with the directions back.
void check_memory(const ArcSearch& search, WindowPropagator& propagator, const JobStage& stage) {
  constexpr double k_bytes_per_arc = 2 * sizeof(std::uint64_t) + 1;
  const auto count = static_cast<double>(search.vertices.size()), available = static_cast<double>(available_memory());
  if (available <= 0 || count * count * k_bytes_per_arc <= available) return;
  const double wanted = mean_in_sight(search, propagator, stage) * count * k_bytes_per_arc;
  if (wanted <= available) return;
  throw InputError(message("exact: the exact graph of ", search.vertices.size(), " vertices needs about ",
                           in_gigabytes(wanted), " and ", in_gigabytes(available),
                           " are free; give accuracy=1e-3 instead, or call exact_distances for the sources you need"));
}

/// \throw InputError for more triangles than slots can be numbered for.
void check_mesh_size(const Mesh& mesh) {
  constexpr Index k_most_edges = std::numeric_limits<std::int32_t>::max() / k_batch;
  if (mesh.halfedge_count() <= k_most_edges) return;
  throw InputError(message("mesh: ", mesh.face_count(), " triangles are more than a graph can be built for (",
                           k_most_edges / 3, ")"));
}

}  // namespace

DiskRule disk_rule(Index k, double accuracy, Lattice lattice) {
  return {.k = k, .tolerance = k_room * accuracy, .lattice = lattice};
}

WaveTables::WaveTables(const Unfolding& unfolding, std::span<const Index> nodes, std::span<const Index> vertices,
                       int threads, const JobStage& stage)
    : WaveTables(unfolding,
                 (check_mesh_size(unfolding.mesh()), NodeEdges(unfolding.mesh(), nodes, vertices, threads, stage)),
                 nodes, vertices, threads, stage) {}

WaveTables::WaveTables(const Unfolding& unfolding, const NodeEdges& edges, std::span<const Index> nodes,
                       std::span<const Index> vertices, int threads, const JobStage& stage)
    : mesh(unfolding, edges, nodes, vertices, threads, stage),
      sectors(edges, unfolding, vertices, ArcCodec::k_sectors, threads, stage) {}

std::vector<FoundArcs> disk_arcs(const ArcSearch& search, const WaveTables& tables, const DiskRule& rule,
                                 const JobStage& stage) {
  std::vector<std::unique_ptr<DiskRows>> finders(thread_count(search.threads));
  return find_by_blocks(search, stage, [&](FoundArcs& found, Index count, int thread) {
    if (!finders[thread])
      finders[thread] = std::make_unique<DiskRows>(tables.mesh, tables.sectors, search.codec, search.kernel, rule);
    for (Index i = 0; i < count; i += k_batch)
      finders[thread]->find(found.first_node + i, std::min(k_batch, count - i), found, stage);
  });
}

std::vector<FoundArcs> exact_arcs(const ArcSearch& search, const JobStage& stage) {
  std::vector<std::unique_ptr<WindowPropagator>> propagators(thread_count(search.threads));
  std::vector<std::vector<DirectArc>> rows(propagators.size());
  propagators[0] = std::make_unique<WindowPropagator>(search.unfolding);
  check_memory(search, *propagators[0], stage);
  std::atomic<Index> done{0};  // rows: a block of them takes long
  return find_by_blocks(search, stage, [&](FoundArcs& found, Index count, int thread) {
    if (!propagators[thread]) propagators[thread] = std::make_unique<WindowPropagator>(search.unfolding);
    for (Index i = 0; i < count; ++i) {
      stage.update(static_cast<double>(done++) / static_cast<double>(search.vertices.size()));
      const Index vertex = search.vertices[found.first_node + i];
      propagators[thread]->from_vertex(vertex, static_cast<Index>(search.vertices.size()), rows[thread]);
      append_row(search, vertex, rows[thread], found);
    }
  });
}

}  // namespace saddleback
