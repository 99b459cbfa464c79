// Breadth-first trees: within blocks of neighboring nodes, by all threads, and then over the connected pieces of these
// blocks. No path is longer than twice the longest way from the root of such a tree, of the worst component.

#include "geodesics/graph/path_bound.h"

#include <algorithm>
#include <tuple>
#include <vector>

#include "saddleback/support/large_array.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr Index k_block = 1024;

/// Holds where the half-edges out of a node lead, counter-clockwise, and their lengths in units of the mean edge. At a
/// border one way is missing, but there is another about the face.
struct Neighbors {
  Index count;         ///< of nodes
  const Index* first;  ///< per node, with the number of half-edges at the end
  const Index* targets;
  const double* lengths;

  template <class Visit>
  void each(Index node, Visit&& visit) const {
    for (Index e = first[node]; e < first[node + 1]; ++e) visit(targets[e], lengths[e]);
  }
};

/// Leads from the root of one piece to that of another.
struct Link {
  Index from, to;
  double length;
};

class PathBound {
 public:
  PathBound(const Neighbors& neighbors, int threads, const JobStage& stage)
      : neighbors_(neighbors),
        threads_(threads),
        stage_(stage),
        piece_(neighbors.count, k_none),
        depth_(neighbors.count, 0) {}

  PathBounds find() {
    const Index blocks = (node_count() + k_block - 1) / k_block;
    std::vector<std::vector<double>> depths(blocks);
    std::vector<double> shortest(blocks);
    parallel_for(blocks, threads_, 1, [&](Index block, int) {
      stage_.check();
      depths[block] = cut_into_pieces(block);
      const double* const lengths = neighbors_.lengths;
      shortest[block] =
          *std::min_element(lengths + neighbors_.first[block * k_block], lengths + neighbors_.first[end_of(block)]);
    });
    std::vector<Index> first(static_cast<std::size_t>(blocks) + 1, 0);
    for (Index block = 0; block < blocks; ++block) {
      first[block + 1] = first[block] + static_cast<Index>(depths[block].size());
      piece_depths_.insert(piece_depths_.end(), depths[block].begin(), depths[block].end());
    }
    parallel_for(node_count(), threads_, k_block, [&](Index node, int) { piece_[node] += first[node / k_block]; });
    std::vector<std::vector<Link>> links(blocks);
    parallel_for(blocks, threads_, 1, [&](Index block, int) {
      stage_.check();
      links[block] = links_of(block);
    });
    return {2 * deepest_over_pieces(links), *std::ranges::min_element(shortest)};
  }

 private:
  Index node_count() const { return neighbors_.count; }
  Index end_of(Index block) const { return std::min(node_count(), (block + 1) * k_block); }

  /// Numbers a block's pieces from 0. \return how deep each is.
  std::vector<double> cut_into_pieces(Index block) {
    const Index begin = block * k_block, end = end_of(block);
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
          if (node < begin || node >= end || piece_[node] != k_none) return;
          piece_[node] = piece;
          depth_[node] = depth + length;
          queue.push_back(node);
        });
      }
    }
    return deepest;
  }

  /// One for each other piece that a piece of the block touches.
  std::vector<Link> links_of(Index block) const {
    std::vector<Link> links;
    for (Index node = block * k_block; node < end_of(block); ++node) {
      neighbors_.each(node, [&](Index other, double length) {
        if (piece_[other] != piece_[node])
          links.push_back({piece_[node], piece_[other], depth_[node] + length + depth_[other]});
      });
    }
    const auto key = [](const Link& link) { return std::tuple(link.from, link.to, link.length); };
    std::ranges::sort(links, {}, key);
    const auto same = [](const Link& a, const Link& b) { return a.from == b.from && a.to == b.to; };
    links.erase(std::unique(links.begin(), links.end(), same), links.end());
    return links;
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

PathBounds in_units(const PathBounds& bounds, double unit) {
  return {bounds.longest * unit, bounds.shortest_edge * unit};
}

}  // namespace

PathBounds path_bounds(const WindowMesh& mesh, int threads, const JobStage& stage) {
  const Neighbors neighbors{mesh.node_count(), mesh.firsts(), mesh.targets(), mesh.lengths()};
  return in_units(PathBound(neighbors, threads, stage).find(), mesh.unit());
}

PathBounds path_bounds(const Mesh& mesh, std::span<const Index> nodes, std::span<const Index> vertices, int threads,
                       const JobStage& stage) {
  const NodeEdges edges(mesh, vertices, threads, stage);
  const double unit = mesh.mean_edge_length();
  const auto count = static_cast<Index>(edges.halfedges.size());
  LargeArray<Index> targets(edges.halfedges.size());
  LargeArray<double> lengths(edges.halfedges.size());
  constexpr Index k_chunk = 4096, k_ahead = 16;
  parallel_for((count + k_chunk - 1) / k_chunk, threads, 1, [&](Index chunk, int) {
    stage.check();
    for (Index e = chunk * k_chunk; e < std::min(count, (chunk + 1) * k_chunk); ++e) {
      const Index h = edges.halfedges[e], ahead = edges.halfedges[std::min(e + k_ahead, count - 1)];
      __builtin_prefetch(&mesh.triangles()[Mesh::face_of(ahead)]);
      __builtin_prefetch(&mesh.lengths()[ahead]);
      targets[e] = nodes[mesh.to(h)];
      lengths[e] = mesh.length(h) / unit;
    }
  });
  const Neighbors neighbors{static_cast<Index>(vertices.size()), edges.first.data(), targets.data(), lengths.data()};
  return in_units(PathBound(neighbors, threads, stage).find(), unit);
}

}  // namespace saddleback
