#include "geodesics/graph/window_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "geodesics/graph/arc_rows.h"
#include "geodesics/unfolding/unfolded_corner.h"
#include "mesh/tables/outgoing.h"
#include "support/planar.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr Index k_chunk = 256;
// Edges whose half-edges' records are asked for ahead, and edges whose neighbors' are.
constexpr Index k_records_ahead = 24, k_neighbors_ahead = 12;

/// Calls use(node, edge, halfedge) for all edges, a chunk of nodes to a thread. `fetch(halfedge)`
/// and `fetch_neighbors(halfedge)` ask for what will be read: half-edges of neighboring nodes lie anywhere.
template <class Use, class Fetch, class FetchNeighbors>
void for_each_edge(const NodeEdges& edges, int threads, const JobStage& stage, Use&& use, Fetch&& fetch,
                   FetchNeighbors&& fetch_neighbors) {
  const auto nodes = static_cast<Index>(edges.first.size()) - 1, last = static_cast<Index>(edges.halfedges.size()) - 1;
  const Index chunks = (nodes + k_chunk - 1) / k_chunk;
  parallel_for(chunks, threads, 1, [&](Index chunk, int) {
    stage.update(static_cast<double>(chunk) / chunks);
    const Index begin = chunk * k_chunk, end = std::min(nodes, begin + k_chunk);
    for (Index node = begin; node < end; ++node) {
      for (Index e = edges.first[node]; e < edges.first[node + 1]; ++e) {
        fetch(edges.halfedges[std::min(e + k_records_ahead, last)]);
        fetch_neighbors(edges.halfedges[std::min(e + k_neighbors_ahead, last)]);
        use(node, e, edges.halfedges[e]);
      }
    }
  });
}

}  // namespace

NodeEdges::NodeEdges(const Mesh& mesh, const LaidNodes& laid, std::span<const Index> vertices, int threads,
                     const JobStage& stage)
    : first(vertices.size() + 1, 0), edge_of(mesh.halfedge_count()) {
  const auto count = static_cast<Index>(vertices.size()), chunks = (count + k_chunk - 1) / k_chunk;
  std::vector<std::vector<Index>> found(chunks);  // how many a node has is known once they are
  const JobStage finding = stage.part(0, 0.6), placing = stage.part(0.6, 1);
  parallel_for(chunks, threads, 1, [&](Index chunk, int) {
    finding.update(static_cast<double>(chunk) / chunks);
    std::vector<Index>& out = found[chunk];
    for (Index node = chunk * k_chunk; node < std::min(count, (chunk + 1) * k_chunk); ++node) {
      if (!laid.is_laid(node)) continue;
      if (out.empty()) out.reserve(8 * k_chunk);
      const std::size_t before = out.size();
      for (const Index h : outgoing(mesh, vertices[node])) {
        out.push_back(h);
      }
      first[node + 1] = static_cast<Index>(out.size() - before);
    }
  });
  for (Index node = 0; node < count; ++node) first[node + 1] += first[node];
  halfedges.resize(first.back());
  if (first.back() < mesh.halfedge_count()) std::ranges::fill(edge_of, first.back());
  parallel_for(chunks, threads, 1, [&](Index chunk, int) {
    placing.update(static_cast<double>(chunk) / chunks);
    Index e = first[chunk * k_chunk];
    for (const Index h : found[chunk]) {
      halfedges[e] = h;
      edge_of[h] = e++;
    }
  });
}

LaidNodes::LaidNodes(const Mesh& mesh, std::span<const Index> nodes, std::span<const Index> vertices,
                     std::vector<Index> inner, int rings)
    : states_(nodes.size(), nothing) {
  for (const Index node : inner) states_[node] = open;
  for (int ring = 0; ring <= rings; ++ring) {
    std::vector<Index> outer;
    const auto add = [&](Index vertex) {
      const Index node = nodes[vertex];
      if (states_[node] != nothing) return;
      states_[node] = ring < rings ? open : laid;
      outer.push_back(node);
    };
    for (const Index node : inner) {
      for (const Index h : outgoing(mesh, vertices[node])) {
        add(mesh.to(h));
        add(mesh.apex(h));
      }
    }
    inner = std::move(outer);
  }
}

EdgeRecord WindowMesh::record_of(const Unfolding& unfolding, const NodeEdges& edges, std::span<const Index> nodes,
                                 Index h) const {
  const Mesh& mesh = unfolding.mesh();
  const auto edge_behind = [&](Index side) {
    const Index twin = mesh.twins()[side];
    return twin == k_none ? k_none : edges.edge_of[twin];
  };
  // As the device lays it, which has no positions and leaves the extreme to the processor: directions are of single
  // precision here.
  const double base = mesh.length(h), left = mesh.length(Mesh::prev(h)), right = mesh.length(Mesh::next(h));
  const double off = corner_off(base, mesh.face_area(Mesh::face_of(h)));
  const double along = left > k_extreme * base ? unfolding.apex(h).x() : corner_along(base, left, right);
  return {along / base, off / base, edge_behind(Mesh::prev(h)), edge_behind(Mesh::next(h)), nodes[mesh.apex(h)], 0};
}

namespace {

/// Asks ahead for what records are made of.
auto fetch_faces(const Mesh& mesh) {
  return [&mesh](Index h) {
    __builtin_prefetch(mesh.twins().data() + h);
    __builtin_prefetch(&mesh.triangles()[Mesh::face_of(h)]);
    __builtin_prefetch(mesh.lengths().data() + h);
    __builtin_prefetch(&mesh.face_areas()[Mesh::face_of(h)]);
  };
}
auto fetch_neighbors(const Mesh& mesh, const NodeEdges& edges, std::span<const Index> nodes) {
  return [&mesh, edge_of = edges.edge_of.data(), nodes](Index h) {
    __builtin_prefetch(edge_of + std::max(mesh.twins()[Mesh::prev(h)], 0));
    __builtin_prefetch(edge_of + std::max(mesh.twins()[Mesh::next(h)], 0));
    __builtin_prefetch(&nodes[mesh.apex(h)]);
    __builtin_prefetch(&nodes[mesh.to(h)]);
  };
}

constexpr double k_recorded = 0.63;  // of the time
constexpr double k_summed = 0.4;     // and of that of sectors

}  // namespace

WindowMesh::WindowMesh(const Unfolding& unfolding, const NodeEdges& edges, const LaidNodes& laid,
                       std::span<const Index> nodes, std::span<const Index> vertices, int threads,
                       const JobStage& stage)
    : placed_(laid), first_(edges.first) {
  const Mesh& mesh = unfolding.mesh();
  unit_ = mesh.mean_edge_length();
  records_.resize(edges.halfedges.size() + 1);
  records_.back() = {0, 0, k_none, k_none, 0, 0};
  targets_.resize(edges.halfedges.size());
  lengths_.resize(edges.halfedges.size());
  saddles_.resize(vertices.size());
  for_each_edge(
      edges, threads, stage.part(0, k_recorded),
      [&](Index node, Index e, Index h) {
        if (e == first_[node]) saddles_[node] = mesh.is_saddle(vertices[node]);
        records_[e] = record_of(unfolding, edges, nodes, h);
        targets_[e] = nodes[mesh.to(h)];
        lengths_[e] = mesh.length(h) / unit_;
      },
      fetch_faces(mesh), fetch_neighbors(mesh, edges, nodes));
  find_clearances(threads, stage.part(k_recorded, 1));
}

/// Finds clearances. From a point of an edge a straight way comes to the corner beyond, or it crosses a side, and with
/// it the faces about one of the edge's ends. There it comes to a vertex, which is off the edge by the face's angle at
/// that end at least, or it leaves across an edge opposite the end. Laid flat, the two edges are nearest to each other
/// at an end of one of them: that is one of those vertices, or one of the first edge's ends and an edge opposite it.
void WindowMesh::find_clearances(int threads, const JobStage& stage) {
  constexpr double k_about = 0.35, k_cleared = 0.9;  // of the time, until then
  const JobStage first = stage.part(0, k_about), second = stage.part(k_about, k_cleared);
  const auto look = [this](const JobStage& part, Index node) {
    if (node % k_chunk == 0) part.update(static_cast<double>(node) / node_count());
  };
  struct About {
    double clearance = std::numeric_limits<double>::infinity();  ///< from the node to the edges opposite it
    double shortest = std::numeric_limits<double>::infinity();   ///< edge
  };
  LargeArray<About> about(node_count());
  parallel_for(node_count(), threads, k_chunk, [&](Index node, int) {
    look(first, node);
    for (Index e = begin(node); e < end(node); ++e) {
      const Vec2 target(length(e), 0), far = apex(e);
      about[node].clearance = std::min(about[node].clearance, distance_to_segment(Vec2(0, 0), target, far));
      about[node].shortest = std::min({about[node].shortest, length(e), far.norm()});
    }
  });
  LargeArray<float> clearances(records_.size());
  parallel_for(node_count(), threads, k_chunk, [&](Index node, int) {
    look(second, node);
    const auto beside = [](const About& end, const Vec2& along, const Vec2& to_apex) {
      const double sine =
          along.dot(to_apex) > 0 ? std::abs(cross(along, to_apex)) / (along.norm() * to_apex.norm()) : 1;
      return std::min(end.clearance, sine * end.shortest);
    };
    for (Index e = begin(node); e < end(node); ++e) {
      const Vec2 target(length(e), 0), far = apex(e);
      const double least = std::min({distance_to_segment(far, Vec2(0, 0), target), beside(about[node], target, far),
                                     beside(about[targets_[e]], -target, far - target)});
      clearances[e] = static_cast<float>(least * (1 - k_clearance_rounding));
    }
  });
  const auto upper_half = [&](Index edge) {
    return edge < 0 ? 0U : std::bit_cast<std::uint32_t>(clearances[edge]) >> 16;
  };
  parallel_for(node_count(), threads, k_chunk, [&](Index node, int) {
    if (!placed_.is_open(node)) return;
    for (Index e = begin(node); e < end(node); ++e) {
      EdgeRecord& record = records_[e];
      record.clearances = upper_half(record.left) << 16 | (upper_half(record.right) & ~k_saddle_bit);
      if (record.right >= 0 && !placed_.is_open(record.apex)) record.right = beyond();
    }
  });
}

Index WindowMesh::edge_between(Index from, Index to) const {
  Index edge = begin(from);
  while (edge < end(from) && target(edge) != to) ++edge;
  return edge < end(from) ? edge : k_none;
}

FanMesh::FanMesh(const Unfolding& unfolding, std::span<const Index> nodes, std::span<const Index> vertices, int threads,
                 const JobStage& stage)
    : FanMesh(unfolding,
              NodeEdges(unfolding.mesh(), LaidNodes(static_cast<Index>(vertices.size())), vertices, threads,
                        stage.part(0, 0.4)),
              nodes, vertices, threads, stage.part(0.4, 1)) {}

FanMesh::FanMesh(const Unfolding& unfolding, const NodeEdges& edges, std::span<const Index> nodes,
                 std::span<const Index> vertices, int threads, const JobStage& stage)
    : waves_(unfolding, edges, LaidNodes(static_cast<Index>(vertices.size())), nodes, vertices, threads,
             stage.part(0, 0.7)),
      apex_directions_(edges.halfedges.size()) {
  for_each_edge(
      edges, threads, stage.part(0.7, 1),
      [&](Index, Index e, Index h) { apex_directions_[e] = unfolding.polar(Mesh::prev(h)); },
      [&](Index h) { __builtin_prefetch(unfolding.polars().data() + h); }, [](Index) {});
}

WaveSectors::WaveSectors(const NodeEdges& edges, const Mesh& mesh, std::span<const Index> vertices, int threads,
                         const JobStage& stage) {
  sectors_.resize(edges.halfedges.size() + 1);
  sectors_.back() = 0;  // of half-edges that are not laid
  reverse_sectors_.resize(edges.halfedges.size());
  apex_sectors_.resize(edges.halfedges.size());
  per_radian_.resize(vertices.size());
  const auto last = static_cast<Index>(edges.halfedges.size()) - 1;
  parallel_for(static_cast<Index>(vertices.size()), threads, k_chunk, [&](Index node, int) {
    if (node % k_chunk == 0) stage.update(k_summed * node / static_cast<double>(vertices.size()));
    const double here = ArcCodec::k_sectors / mesh.total_angle(vertices[node]);
    per_radian_[node] = static_cast<float>(here);
    double angle = 0;
    for (Index e = edges.first[node]; e < edges.first[node + 1]; ++e) {
      sectors_[e] = static_cast<float>(angle * here);
      angle += mesh.corner_angle(edges.halfedges[e]);
      __builtin_prefetch(&mesh.corner_angles()[edges.halfedges[std::min(e + k_records_ahead, last)]]);
    }
  });
  for_each_edge(
      edges, threads, stage.part(k_summed, 1),
      [&](Index, Index e, Index h) {
        const Index twin = mesh.twin(h);
        reverse_sectors_[e] = twin == k_none ? static_cast<float>(ArcCodec::k_sectors) : sectors_[edges.edge_of[twin]];
        apex_sectors_[e] = sectors_[edges.edge_of[Mesh::prev(h)]];
      },
      [&](Index h) {
        __builtin_prefetch(mesh.twins().data() + h);
        __builtin_prefetch(&edges.edge_of[Mesh::prev(h)]);
      },
      [&](Index h) {
        __builtin_prefetch(&edges.edge_of[std::max(mesh.twin(h), 0)]);
        __builtin_prefetch(&sectors_[edges.edge_of[Mesh::prev(h)]]);
      });
}

}  // namespace saddleback
