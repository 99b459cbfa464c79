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
#include "support/threads/parallel.h"
#include "support/work_done.h"

namespace saddleback {
namespace {

// Windows end a little early, see geodesic_disks.cpp: on thousands of fields over twenty meshes this kept every error
// below the accuracy asked for. Fine graphs need more room: there errors of a sixth more than their tolerance were
// seen.
constexpr double k_room = 0.95, k_room_where_fine = 0.8, k_fine = 2e-3, k_usual = 5e-3;

double room_for(double accuracy) {
  const double usual = std::log(accuracy / k_fine) / std::log(k_usual / k_fine);
  return std::lerp(k_room_where_fine, k_room, std::clamp(usual, 0.0, 1.0));
}

// Bytes.
constexpr std::size_t k_piece = std::size_t{1} << 21, k_piece_a_node = 512;

/// Calls find(draft, count, thread, done) from all threads, which returns whether the block was found. Blocks are
/// filled in memory that each thread keeps.
template <class Find>
std::vector<KeptArcs> find_by_blocks(std::span<const Index> blocks, const ArcSearch& search, const JobStage& stage,
                                     Find&& find) {
  const auto node_count = static_cast<Index>(search.vertices.size());
  std::vector<KeptArcs> found(blocks.size());
  std::vector<FoundArcs> drafts(thread_count(search.threads));
  const std::size_t piece = std::min(k_piece, k_piece_a_node * static_cast<std::size_t>(node_count));
  std::vector<ReturnedPieces> pieces(drafts.size(), ReturnedPieces(piece));
  WorkDone done(stage, std::min(node_count, static_cast<Index>(blocks.size()) * k_nodes_a_block));
  const auto find_block = [&](Index i, int thread) {
    FoundArcs& draft = drafts[thread];
    draft.first_node = blocks[i] * k_nodes_a_block;
    draft.counts.clear();
    draft.words.clear();
    draft.back_sectors.clear();
    if (find(draft, std::min(k_nodes_a_block, node_count - draft.first_node), thread, done))
      found[i] = KeptArcs(draft, pieces[thread]);
  };
  try {
    parallel_for(static_cast<Index>(found.size()), search.threads, 1, find_block);
  } catch (const Cancelled&) {
    free_in_background(std::move(found));
    throw;
  }
  return found;
}

std::vector<Index> all_blocks(const ArcSearch& search) {
  std::vector<Index> blocks(block_count(static_cast<Index>(search.vertices.size())));
  std::iota(blocks.begin(), blocks.end(), 0);
  return blocks;
}

// Shares of the time in which tables for waves are laid, until the end of each.
constexpr double k_with_edges = 0.08, k_with_mesh = 0.87;

/// Vertices in sight of one, in the mean of a few all over the mesh. Their number grows like a power of that of the
/// vertices looked at, which is estimated from disks of two sizes.
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

/// Checks that memory will do: what is built holds the arcs twice for a while, with the directions back.
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

void check_mesh_size(std::int64_t triangle_count) {
  constexpr Index k_most_triangles = std::numeric_limits<std::int32_t>::max() / k_batch / 3;
  if (triangle_count <= k_most_triangles) return;
  throw InputError(message("mesh: ", triangle_count, " triangles are more than a graph can be built for (",
                           k_most_triangles, "); exact_distances needs no graph, or make a mesh of each part"));
}

DiskRule disk_rule(Index k, double accuracy, Lattice lattice) {
  return {.k = k, .tolerance = accuracy > 0 ? room_for(accuracy) * accuracy : 0, .lattice = lattice};
}

WaveTables::WaveTables(const Unfolding& unfolding, std::span<const Index> nodes, std::span<const Index> vertices,
                       int threads, const JobStage& stage)
    : WaveTables(unfolding, LaidNodes(static_cast<Index>(vertices.size())), nodes, vertices, threads, stage) {}

WaveTables::WaveTables(const Unfolding& unfolding, const LaidNodes& laid, std::span<const Index> nodes,
                       std::span<const Index> vertices, int threads, const JobStage& stage)
    : WaveTables(unfolding,
                 (check_mesh_size(unfolding.mesh().face_count()),
                  NodeEdges(unfolding.mesh(), laid, vertices, threads, stage.part(0, k_with_edges))),
                 laid, nodes, vertices, threads, stage) {}

WaveTables::WaveTables(const Unfolding& unfolding, const NodeEdges& edges, const LaidNodes& laid,
                       std::span<const Index> nodes, std::span<const Index> vertices, int threads,
                       const JobStage& stage)
    : mesh(unfolding, edges, laid, nodes, vertices, threads, stage.part(k_with_edges, k_with_mesh)),
      sectors(edges, unfolding.mesh(), vertices, threads, stage.part(k_with_mesh, 1)),
      strips(unfolding, {edges.edge_of.data(), edges.edge_of.size()}, nodes, mesh.unit()) {}

std::vector<KeptArcs> disk_arcs(const ArcSearch& search, const ArcCodec& codec, const WaveTables& tables,
                                const DiskRule& rule, const JobStage& stage) {
  return disk_arcs_of(all_blocks(search), search, codec, tables, rule, stage);
}

std::vector<KeptArcs> disk_arcs_of(std::span<const Index> blocks, const ArcSearch& search, const ArcCodec& codec,
                                   const WaveTables& tables, const DiskRule& rule, const JobStage& stage) {
  std::vector<std::unique_ptr<DiskRows>> finders(thread_count(search.threads));
  return find_by_blocks(blocks, search, stage, [&](FoundArcs& found, Index count, int thread, WorkDone& done) {
    if (!finders[thread]) finders[thread] = std::make_unique<DiskRows>(search, tables, codec, rule);
    for (Index i = 0; i < count; i += k_batch) {
      const Index batch = std::min(k_batch, count - i);
      if (!finders[thread]->find(found.first_node + i, batch, found, stage)) return false;
      done.add(batch);
    }
    return true;
  });
}

std::vector<KeptArcs> exact_arcs(const ArcSearch& search, const ArcCodec& codec, const JobStage& stage) {
  std::vector<std::unique_ptr<VisibleVertices>> propagators(thread_count(search.threads));
  std::vector<std::vector<DirectArc>> rows(propagators.size());
  propagators[0] = std::make_unique<VisibleVertices>(search.unfolding);
  check_memory(search, *propagators[0], stage);
  return find_by_blocks(
      all_blocks(search), search, stage, [&](FoundArcs& found, Index count, int thread, WorkDone& done) {
        if (!propagators[thread]) propagators[thread] = std::make_unique<VisibleVertices>(search.unfolding);
        for (Index i = 0; i < count; ++i) {
          const Index vertex = search.vertices[found.first_node + i];
          propagators[thread]->from_vertex(vertex, static_cast<Index>(search.vertices.size()), rows[thread], stage);
          found.counts.push_back(static_cast<std::int32_t>(rows[thread].size()));
          for (const DirectArc& arc : rows[thread]) append_arc(search, codec, vertex, arc, found);
          done.add(1);
        }
        return true;
      });
}

}  // namespace saddleback
