// Breadth-first trees: within blocks of neighboring nodes, by all threads, and then over the connected pieces of these
// blocks. No path is longer than twice the longest way from the root of such a tree, of the worst component.

#include "geodesics/graph/path_bound.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <vector>

#include "mesh/tables/outgoing.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr Index k_block = 1024;

/// Calls visit(neighbor, length) for the half-edges out of a node, counter-clockwise; lengths are in units of the mean
/// edge. At a border one way between two nodes is missing, but there is another about the face.
struct LaidNeighbors {
  const WindowMesh& mesh;
  template <class Visit>
  void each(Index node, Visit&& visit) const {
    for (Index e = mesh.begin(node); e < mesh.end(node); ++e) visit(mesh.target(e), mesh.length(e));
  }
};
struct MeshNeighbors {
  const Mesh& mesh;
  std::span<const Index> nodes, vertices;
  template <class Visit>
  void each(Index node, Visit&& visit) const {
    const double unit = mesh.mean_edge_length();
    for (const Index h : outgoing(mesh, vertices[node])) visit(nodes[mesh.to(h)], mesh.length(h) / unit);
  }
};

/// Leads from one node to another or, later, from the root of one piece to that of another.
struct Link {
  Index from, to;
  double length;
};

template <class Neighbors>
class PathBound {
 public:
  PathBound(const Neighbors& neighbors, Index node_count, int threads, const JobStage& stage)
      : neighbors_(neighbors), threads_(threads), stage_(stage), piece_(node_count, k_none), depth_(node_count, 0) {}

  PathBounds find() {
    const Index blocks = (node_count() + k_block - 1) / k_block;
    std::vector<std::vector<double>> depths(blocks);
    std::vector<std::vector<Link>> links(blocks);
    std::vector<double> shortest(blocks, std::numeric_limits<double>::infinity());
    parallel_for(blocks, threads_, 1, [&](Index block, int) {
      stage_.check();
      depths[block] = cut_into_pieces(block, links[block], shortest[block]);
    });
    std::vector<Index> first(static_cast<std::size_t>(blocks) + 1, 0);
    for (Index block = 0; block < blocks; ++block) {
      first[block + 1] = first[block] + static_cast<Index>(depths[block].size());
      piece_depths_.insert(piece_depths_.end(), depths[block].begin(), depths[block].end());
    }
    parallel_for(node_count(), threads_, k_block, [&](Index node, int) { piece_[node] += first[node / k_block]; });
    parallel_for(blocks, threads_, 1, [&](Index block, int) {
      stage_.check();
      join_pieces(links[block]);
    });
    return {2 * deepest_over_pieces(links), *std::ranges::min_element(shortest)};
  }

 private:
  Index node_count() const { return static_cast<Index>(piece_.size()); }

  /// Numbers a block's pieces from 0. \return how deep each is; the half-edges that lead out of them; the length of the
  /// shortest half-edge.
  std::vector<double> cut_into_pieces(Index block, std::vector<Link>& out, double& shortest) {
    const Index begin = block * k_block, end = std::min(node_count(), begin + k_block);
    std::vector<double> deepest;
    std::vector<Index> queue;
    for (Index root = begin; root < end; ++root) {
      if (piece_[root] != k_none) continue;
      const auto piece = static_cast<Index>(deepest.size());
      deepest.push_back(0);
      piece_[root] = piece;
      queue.assign(1, root);
      for (std::size_t next = 0; next < queue.size(); ++next) {
        const double depth = depth_[queue[next]];
        deepest.back() = std::max(deepest.back(), depth);
        neighbors_.each(queue[next], [&](Index node, double length) {
          shortest = std::min(shortest, length);
          const bool is_outside = node < begin || node >= end;
          if (is_outside || (piece_[node] != k_none && piece_[node] != piece)) {
            out.push_back({queue[next], node, length});
          } else if (piece_[node] == k_none) {
            piece_[node] = piece;
            depth_[node] = depth + length;
            queue.push_back(node);
          }
        });
      }
    }
    return deepest;
  }

  /// Makes links between nodes one for each other piece that a piece touches.
  void join_pieces(std::vector<Link>& links) const {
    for (auto& [from, to, length] : links) {
      length = depth_[from] + length + depth_[to];
      from = piece_[from];
      to = piece_[to];
    }
    const auto key = [](const Link& link) { return std::tuple(link.from, link.to, link.length); };
    std::ranges::sort(links, {}, key);
    const auto same = [](const Link& a, const Link& b) { return a.from == b.from && a.to == b.to; };
    links.erase(std::unique(links.begin(), links.end(), same), links.end());
  }

  double deepest_over_pieces(const std::vector<std::vector<Link>>& links) const {
    std::vector<const Link*> first(piece_depths_.size() + 1, nullptr);
    std::vector<Link> all;
    for (const std::vector<Link>& some : links) all.insert(all.end(), some.begin(), some.end());
    const Link* link = all.data();
    for (std::size_t piece = 0; piece <= piece_depths_.size(); ++piece) {
      while (link != all.data() + all.size() && static_cast<std::size_t>(link->from) < piece) ++link;
      first[piece] = link;
    }
    std::vector<double> depths(piece_depths_.size(), -1);
    std::vector<Index> queue;
    double deepest = 0;
    const auto reach = [&](Index piece, double depth) {
      if (depths[piece] >= 0) return;
      depths[piece] = depth;
      deepest = std::max(deepest, depth + piece_depths_[piece]);
      queue.push_back(piece);
    };
    std::size_t next = 0;
    for (std::size_t root = 0; root < depths.size(); ++root) {
      reach(static_cast<Index>(root), 0);
      for (; next < queue.size(); ++next) {
        const Index piece = queue[next];
        for (const Link* each = first[piece]; each != first[piece + 1]; ++each)
          reach(each->to, depths[piece] + each->length);
      }
    }
    return deepest;
  }

  const Neighbors neighbors_;
  int threads_;
  const JobStage& stage_;
  std::vector<Index> piece_;   ///< of the nodes
  std::vector<double> depth_;  ///< of the nodes in their pieces
  std::vector<double> piece_depths_;
};

template <class Neighbors>
PathBounds bounds_of(const Neighbors& neighbors, Index node_count, double unit, int threads, const JobStage& stage) {
  const PathBounds bounds = PathBound(neighbors, node_count, threads, stage).find();
  return {bounds.longest * unit, bounds.shortest_edge * unit};
}

}  // namespace

PathBounds path_bounds(const WindowMesh& mesh, int threads, const JobStage& stage) {
  return bounds_of(LaidNeighbors{mesh}, mesh.node_count(), mesh.unit(), threads, stage);
}

PathBounds path_bounds(const Mesh& mesh, std::span<const Index> nodes, std::span<const Index> vertices, int threads,
                       const JobStage& stage) {
  return bounds_of(MeshNeighbors{mesh, nodes, vertices}, mesh.vertex_count(), mesh.mean_edge_length(), threads, stage);
}

}  // namespace saddleback
