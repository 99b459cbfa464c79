#include "geodesics/graph/graph_arcs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>

#include "saddleback/error.h"

#include "geodesics/graph/disk_arcs.h"
#include "geodesics/graph/visible_vertices.h"
#include "support/memory/memory.h"
#include "support/scattering_step.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

// Windows end a little early, see geodesic_disks.cpp: on thousands of fields over twenty meshes this kept every error below
// the accuracy asked for. Fine graphs need more room: there errors of a sixth more than their tolerance were seen.
constexpr double k_room = 0.95, k_room_where_fine = 0.8, k_fine = 2e-3, k_usual = 5e-3;

double room_for(double accuracy) {
  const double usual = std::log(accuracy / k_fine) / std::log(k_usual / k_fine);
  return std::lerp(k_room_where_fine, k_room, std::clamp(usual, 0.0, 1.0));
}

/// So many parts of the mesh, one after the other from all over it, take as long as they would if the mesh were even.
/// By count some vertices take many times as long as others, and are neighbors: there a part has no more arcs than
/// these.
constexpr Index k_parts = 377, k_part_arcs = 64000;
// Nodes whose arcs are kept together: so many that what is done for each block is nothing, so few that no thread waits
// long for the last.
constexpr Index k_block = 128, k_most_watched = 256, k_least_watched = 64;
// Bytes. Of blocks that are united in another order each has a piece of its own, lest all be kept to the end.
constexpr std::size_t k_piece = std::size_t{1} << 21, k_piece_a_node = 512;

/// Neighbors that are done one after the other, for those who watch; k of a graph by count, or 0.
Index part_size(Index node_count, Index k) {
  const Index even = std::max(k_least_watched, (node_count / k_parts + k_batch - 1) / k_batch * k_batch);
  return k > 0 ? std::clamp(k_part_arcs / k / k_batch * k_batch, k_batch, even) : even;
}

std::size_t piece_size(Index node_count, bool watched) {
  return watched ? 0 : std::min(k_piece, k_piece_a_node * static_cast<std::size_t>(node_count));
}

/// Blocks in the order in which they are done: by itself theirs, which is as near as memory can be; for those who watch
/// a few neighbors at a time from all over the mesh, since parts of it may take longer.
std::vector<Index> order_of_blocks(Index count, Index per_part) {
  std::vector<Index> order(count);
  std::iota(order.begin(), order.end(), 0);
  if (per_part >= count) return order;
  const Index parts = (count + per_part - 1) / per_part;
  const Index step = scattering_step(parts);
  auto next = order.begin();
  for (Index i = 0; i < parts; ++i) {
    const auto part = static_cast<Index>(std::int64_t{i} * step % parts);
    for (Index b = part * per_part; b < std::min(count, (part + 1) * per_part); ++b) *next++ = b;
  }
  return order;
}

/// Calls find(draft, count, thread) from all threads. Blocks are filled in memory that each thread keeps.
template <class Find>
std::vector<KeptArcs> find_by_blocks(const ArcSearch& search, Index k, bool watched, Find&& find) {
  const auto node_count = static_cast<Index>(search.vertices.size());
  const Index part = watched ? part_size(node_count, k) : node_count;
  const Index size = watched ? std::min(part, k_most_watched) : k_block;
  const std::vector<Index> order = order_of_blocks((node_count + size - 1) / size, (part + size - 1) / size);
  std::vector<KeptArcs> found(order.size());
  std::vector<FoundArcs> drafts(thread_count(search.threads));
  std::vector<ReturnedPieces> pieces(drafts.size(), ReturnedPieces(piece_size(node_count, watched)));
  const auto find_block = [&](Index i, int thread) {
    FoundArcs& draft = drafts[thread];
    draft.first_node = order[i] * size;
    draft.counts.clear();
    draft.words.clear();
    draft.back_sectors.clear();
    find(draft, std::min(size, node_count - draft.first_node), thread);
    found[order[i]] = KeptArcs(draft, pieces[thread]);
  };
  try {
    parallel_for(static_cast<Index>(found.size()), search.threads, 1, find_block);
  } catch (const Cancelled&) {
    free_in_background(std::move(found));
    throw;
  }
  return found;
}

// Of the time in which tables for waves are laid, until the end of each.
constexpr double k_with_edges = 0.08, k_with_mesh = 0.87;

int sector_of(double angle, double total_angle) {
  return std::clamp(static_cast<int>(angle / total_angle * ArcCodec::k_sectors), 0, ArcCodec::k_sectors - 1);
}

void append_row(const ArcSearch& search, const ArcCodec& codec, Index vertex, const std::vector<DirectArc>& row,
                FoundArcs& found) {
  const Mesh& mesh = search.unfolding.mesh();
  found.counts.push_back(static_cast<std::int32_t>(row.size()));
  for (const DirectArc& arc : row) {
    const int sector = sector_of(arc.start_angle, mesh.total_angle(vertex));
    found.words.push_back(codec.pack(search.nodes[arc.vertex], sector, arc.length));
    found.back_sectors.push_back(static_cast<std::uint8_t>(sector_of(arc.end_angle, mesh.total_angle(arc.vertex))));
  }
}

std::string in_gigabytes(double bytes) { return message(std::max(0.1, std::round(bytes / 1e8) / 10), " GB"); }

/// Vertices in sight of one, in the mean of a few all over the mesh. Their number grows like a power of that of the
/// vertices looked at, which is told from disks of two sizes.
double mean_in_sight(const ArcSearch& search, VisibleVertices& propagator, const JobStage& stage) {
  constexpr Index k_samples = 16, k_disk = 4000, k_ratio = 4;
  const auto count = static_cast<Index>(search.vertices.size());
  const Index samples = std::min(k_samples, count), disk = std::min(k_disk, count);
  std::vector<DirectArc> row;
  double small = 0, large = 0;
  for (Index i = 0; i < samples; ++i) {
    stage.check();
    const Index vertex = search.vertices[static_cast<std::int64_t>(i) * count / samples];
    propagator.from_vertex(vertex, std::max<Index>(disk / k_ratio, 1), row, stage);
    small += static_cast<double>(row.size()) / samples;
    propagator.from_vertex(vertex, disk, row, stage);
    large += static_cast<double>(row.size()) / samples;
  }
  const double power = std::clamp(std::log(large / small) / std::log(k_ratio), 0.0, 1.0);
  return large * std::pow(static_cast<double>(count) / disk, power);
}

/// What is built holds the arcs twice for a while, with the directions back.
void check_memory(const ArcSearch& search, VisibleVertices& propagator, const JobStage& stage) {
  constexpr double k_bytes_per_arc = 2 * sizeof(std::uint64_t) + 1;
  const auto count = static_cast<double>(search.vertices.size()), available = static_cast<double>(available_memory());
  if (available <= 0 || count * count * k_bytes_per_arc <= available) return;
  const double wanted = mean_in_sight(search, propagator, stage) * count * k_bytes_per_arc;
  if (wanted <= available) return;
  throw InputError(message("exact: the exact graph of ", search.vertices.size(), " vertices needs about ",
                           in_gigabytes(wanted), " and ", in_gigabytes(available),
                           " are free; give accuracy=1e-3 instead, or call exact_distances for the sources you need"));
}

}  // namespace

void check_mesh_size(const Mesh& mesh) {
  constexpr Index k_most_edges = std::numeric_limits<std::int32_t>::max() / k_batch;
  if (mesh.halfedge_count() <= k_most_edges) return;
  throw InputError(message("mesh: ", mesh.face_count(), " triangles are more than a graph can be built for (",
                           k_most_edges / 3, ")"));
}

DiskRule disk_rule(Index k, double accuracy, Lattice lattice) {
  return {.k = k, .tolerance = accuracy > 0 ? room_for(accuracy) * accuracy : 0, .lattice = lattice};
}

WaveTables::WaveTables(const Unfolding& unfolding, std::span<const Index> nodes, std::span<const Index> vertices,
                       int threads, const JobStage& stage)
    : WaveTables(unfolding,
                 (check_mesh_size(unfolding.mesh()),
                  NodeEdges(unfolding.mesh(), vertices, threads, stage.part(0, k_with_edges))),
                 nodes, vertices, threads, stage) {}

WaveTables::WaveTables(const Unfolding& unfolding, const NodeEdges& edges, std::span<const Index> nodes,
                       std::span<const Index> vertices, int threads, const JobStage& stage)
    : mesh(unfolding, edges, nodes, vertices, threads, stage.part(k_with_edges, k_with_mesh)),
      sectors(edges, unfolding, vertices, ArcCodec::k_sectors, threads, stage.part(k_with_mesh, 1)) {}

std::vector<KeptArcs> disk_arcs(const ArcSearch& search, const ArcCodec& codec, const WaveTables& tables,
                                const DiskRule& rule, BuildProgress& progress) {
  std::vector<std::unique_ptr<DiskRows>> finders(thread_count(search.threads));
  return find_by_blocks(search, rule.k, progress.stage().is_watched(), [&](FoundArcs& found, Index count, int thread) {
    if (!finders[thread])
      finders[thread] = std::make_unique<DiskRows>(tables.mesh, tables.sectors, codec, search.kernel, rule);
    for (Index i = 0; i < count; i += k_batch) {
      const Index batch = std::min(k_batch, count - i);
      progress.time([&]() -> ArcCount {
        const std::int64_t before = std::ssize(found.words);
        finders[thread]->find(found.first_node + i, batch, found, progress.stage());
        return {batch, std::ssize(found.words) - before};
      });
    }
  });
}

std::vector<KeptArcs> exact_arcs(const ArcSearch& search, const ArcCodec& codec, BuildProgress& progress) {
  std::vector<std::unique_ptr<VisibleVertices>> propagators(thread_count(search.threads));
  std::vector<std::vector<DirectArc>> rows(propagators.size());
  propagators[0] = std::make_unique<VisibleVertices>(search.unfolding);
  check_memory(search, *propagators[0], progress.stage());
  return find_by_blocks(search, 0, progress.stage().is_watched(), [&](FoundArcs& found, Index count, int thread) {
    if (!propagators[thread]) propagators[thread] = std::make_unique<VisibleVertices>(search.unfolding);
    for (Index i = 0; i < count; ++i) {
      const Index vertex = search.vertices[found.first_node + i];
      progress.time([&]() -> ArcCount {
        propagators[thread]->from_vertex(vertex, static_cast<Index>(search.vertices.size()), rows[thread],
                                         progress.stage());
        append_row(search, codec, vertex, rows[thread], found);
        return {1, std::ssize(rows[thread])};
      });
    }
  });
}

}  // namespace saddleback
