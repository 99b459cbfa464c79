#include "geodesics/graph_checks.h"

#include <atomic>
#include <cmath>

#include "saddleback/error.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr Index k_block = 256;  // nodes between two looks at the job

class ArcChecker {
 public:
  ArcChecker(const Mesh& mesh, const ArcRows& arcs, std::span<const Index> vertices, const std::string& path)
      : mesh_(mesh), arcs_(arcs), vertices_(vertices), path_(path) {}

  /// `last_row` (V,), -1 at first, holds the row in which each target was met last: the thread's own.
  void check_row(Index node, std::vector<Index>& last_row) {
    std::int64_t upward = 0;
    for (std::int64_t arc = arcs_.first(node); arc < arcs_.first(node + 1); ++arc) {
      const Index target = arcs_.target(arc);
      if (target >= mesh_.vertex_count()) refuse(node, message("leads to node ", target, ", which there is not"));
      if (target == node) refuse(node, "leads back to it");
      if (last_row[target] == node) refuse(node, message("leads to node ", target, " a second time"));
      last_row[target] = node;
      if (mesh_.component_of(vertices_[target]) != mesh_.component_of(vertices_[node]))
        refuse(node, message("leads to node ", target, " of another component"));
      const std::uint64_t word = arcs_.words()[arc];
      if (!arcs_.codec().is_packed(word))
        refuse(node, message("to node ", target, " has a length that is no multiple of the unit"));
      if (target < node) continue;
      ++upward;
      const std::int64_t reverse = arcs_.find(target, node);
      if (reverse < 0 || arcs_.codec().length_bits(arcs_.words()[reverse]) != arcs_.codec().length_bits(word))
        refuse(node, message("to node ", target, " has no reverse of the same length"));
    }
    upward_.fetch_add(upward, std::memory_order_relaxed);
  }

  /// Checks the counts after all rows: every upward arc has its reverse and no target comes twice, so that equal counts
  /// leave no others.
  void check_counts() const {
    if (2 * upward_.load() != arcs_.count()) refuse_graph_file(path_, "it has arcs without their reverses");
  }

 private:
  [[noreturn]] void refuse(Index node, const std::string& what) const {
    refuse_graph_file(path_, message("an arc of node ", node, " ", what));
  }

  const Mesh& mesh_;
  const ArcRows& arcs_;
  std::span<const Index> vertices_;
  const std::string& path_;
  std::atomic<std::int64_t> upward_{0};
};

}  // namespace

void check_options(const Mesh& mesh, const SaddleVertexGraphOptions& options) {
  if ((options.k != 0) + (options.accuracy != 0) + options.exact > 1)
    throw InputError("k, accuracy, exact: give one of them; each says how the graph is built");
  if (options.k < 0) throw InputError(message("k: wanted at least 1 vertex per geodesic disk, got ", options.k));
  if (options.k > mesh.vertex_count()) {
    throw InputError(message("k: ", options.k, " vertices per geodesic disk are more than the mesh has (",
                             mesh.vertex_count(), ")"));
  }
  if (!(options.accuracy >= 0 && options.accuracy < 1)) {
    throw InputError(
        message("accuracy: wanted a relative error above 0 and below 1, such as 0.005 for half a percent, "
                "got ",
                options.accuracy));
  }
  if (options.threads < 0) throw InputError(message("threads: wanted 0 (all) or more, got ", options.threads));
}

void refuse_graph_file(const std::string& path, const std::string& what) {
  throw InputError(message("path: ", path, " is a damaged graph file: ", what, "; build and save the graph again"));
}

std::vector<Index> inverse_order(std::span<const Index> vertices, const std::string& path) {
  const auto count = static_cast<Index>(vertices.size());
  std::vector<Index> nodes(vertices.size(), k_none);
  for (Index node = 0; node < count; ++node) {
    const Index vertex = vertices[node];
    if (vertex < 0 || vertex >= count || nodes[vertex] != k_none)
      refuse_graph_file(path, message("node ", node, " is vertex ", vertex, ", which is out of range or taken"));
    nodes[vertex] = node;
  }
  return nodes;
}

void check_arcs(const Mesh& mesh, const ArcRows& arcs, std::span<const Index> vertices, const std::string& path,
                const JobStage& stage) {
  const Index count = arcs.node_count(), blocks = (count + k_block - 1) / k_block;
  ArcChecker checker(mesh, arcs, vertices, path);
  std::vector<std::vector<Index>> last_rows(thread_count(0));
  std::atomic<Index> done{0};
  parallel_for(blocks, 0, 1, [&](Index b, int thread) {
    last_rows[thread].resize(count, k_none);
    for (Index node = b * k_block; node < std::min(b * k_block + k_block, count); ++node)
      checker.check_row(node, last_rows[thread]);
    stage.update(static_cast<double>(done.fetch_add(1, std::memory_order_relaxed) + 1) / blocks);
  });
  checker.check_counts();
}

}  // namespace saddleback
