#include "tessellation/face_partition.h"

#include <algorithm>

#include "tessellation/edge_envelope.h"

namespace saddleback {
namespace {

double at(const FacePlane& plane, const Vec3& barycentric) {
  return plane.at_corner[0] * barycentric[0] + plane.at_corner[1] * barycentric[1] +
         plane.at_corner[2] * barycentric[2];
}

/// The side that both vertices lie on, k_inside when there is none.
int common_side(const FacePartition::Vertex& a, const FacePartition::Vertex& b) {
  for (int side = 0; side < 3; ++side) {
    const int opposite = (side + 2) % 3;
    if (a.barycentric[opposite] == 0 && b.barycentric[opposite] == 0) return side;
  }
  return FacePartition::k_inside;
}

}  // namespace

void FacePartition::build(const std::vector<FacePlane>& planes) {
  vertices_.clear();
  pieces_.clear();
  for (int corner = 0; corner < 3; ++corner) {
    vertices_.push_back({Vec3::Unit(corner), planes.front().at_corner[corner], k_corner});
  }
  pieces_.push_back({planes.front().site, {0, 1, 2}});
  for (std::size_t i = 1; i < planes.size(); ++i) insert(planes[i]);
}

void FacePartition::insert(const FacePlane& plane) {
  height_.resize(vertices_.size());
  bool below = false;
  for (std::size_t v = 0; v < vertices_.size(); ++v) {
    height_[v] = at(plane, vertices_[v].barycentric) - vertices_[v].value;
    below = below || height_[v] < 0;  // a tie stays with the smaller site
  }
  if (!below) return;
  cuts_.clear();
  std::vector<Piece> kept, taken;
  for (const Piece& piece : pieces_) cut(piece, plane, kept, taken);
  for (const Piece& piece : taken) {
    for (const Index v : piece.loop)
      vertices_[v].value = std::min(vertices_[v].value, at(plane, vertices_[v].barycentric));
  }
  merge(taken);
  pieces_ = std::move(kept);
  for (Piece& piece : taken) pieces_.push_back(std::move(piece));
  drop_idle_side_vertices();
}

/// Divides a piece into what stays with its site and what the plane's site takes.
void FacePartition::cut(const Piece& piece, const FacePlane& plane, std::vector<Piece>& kept,
                        std::vector<Piece>& taken) {
  const auto size = piece.loop.size();
  std::size_t changes = 0;
  for (std::size_t i = 0; i < size; ++i) {
    changes += (height_[piece.loop[i]] < 0) != (height_[piece.loop[(i + 1) % size]] < 0);
  }
  if (changes == 0) {
    if (height_[piece.loop[0]] < 0) {
      taken.push_back({plane.site, piece.loop});
    } else {
      kept.push_back(piece);
    }
    return;
  }
  if (changes > 2) {  // not convex by rounding: triangles have at most two changes
    for (std::size_t i = 1; i + 1 < size; ++i) {
      cut({piece.site, {piece.loop[0], piece.loop[i], piece.loop[i + 1]}}, plane, kept, taken);
    }
    return;
  }
  Piece stays{piece.site, {}}, goes{plane.site, {}};
  for (std::size_t i = 0; i < size; ++i) {
    const Index a = piece.loop[i], b = piece.loop[(i + 1) % size];
    const bool a_below = height_[a] < 0, b_below = height_[b] < 0;
    (a_below ? goes : stays).loop.push_back(a);
    if (a_below != b_below) {
      const Index middle = crossing(a, b);
      stays.loop.push_back(middle);
      goes.loop.push_back(middle);
    }
  }
  kept.push_back(std::move(stays));
  taken.push_back(std::move(goes));
}

/// The vertex where the plane crosses the envelope between two vertices; the same one for both pieces beside.
Index FacePartition::crossing(Index a, Index b) {
  if (a > b) std::swap(a, b);
  for (const Cut& known : cuts_) {
    if (known.a == a && known.b == b) return known.vertex;
  }
  const double t = std::clamp(height_[a] / (height_[a] - height_[b]), k_least_gap, 1 - k_least_gap);
  Vertex vertex;
  vertex.side = common_side(vertices_[a], vertices_[b]);
  vertex.barycentric = (1 - t) * vertices_[a].barycentric + t * vertices_[b].barycentric;
  vertex.value = (1 - t) * vertices_[a].value + t * vertices_[b].value;
  const auto index = static_cast<Index>(vertices_.size());
  vertices_.push_back(vertex);
  height_.push_back(0);
  cuts_.push_back({a, b, index});
  return index;
}

/// Joins the taken pieces into one by dropping the edges between them, when that leaves one simple loop.
void FacePartition::merge(std::vector<Piece>& taken) {
  if (taken.size() < 2) return;
  std::vector<std::pair<Index, Index>> edges, outer;
  for (const Piece& piece : taken) {
    for (std::size_t i = 0; i < piece.loop.size(); ++i)
      edges.emplace_back(piece.loop[i], piece.loop[(i + 1) % piece.loop.size()]);
  }
  for (const auto& edge : edges) {
    if (std::find(edges.begin(), edges.end(), std::pair(edge.second, edge.first)) == edges.end()) outer.push_back(edge);
  }
  std::vector<Index> loop;
  Index vertex = outer.front().first;
  for (std::size_t steps = 0; steps < outer.size(); ++steps) {
    loop.push_back(vertex);
    const auto leaves = [&](const auto& edge) { return edge.first == vertex; };
    if (std::count_if(outer.begin(), outer.end(), leaves) != 1) return;
    vertex = std::find_if(outer.begin(), outer.end(), leaves)->second;
    if (vertex == outer.front().first) break;
  }
  if (loop.size() != outer.size()) return;
  const Index site = taken.front().site;
  taken.assign(1, {site, std::move(loop)});
}

/// Removes vertices on sides that no longer separate two pieces.
void FacePartition::drop_idle_side_vertices() {
  std::vector<int> uses(vertices_.size(), 0);
  for (const Piece& piece : pieces_) {
    for (const Index v : piece.loop) ++uses[v];
  }
  for (Piece& piece : pieces_) {
    std::erase_if(piece.loop, [&](Index v) { return vertices_[v].side >= 0 && uses[v] == 1; });
  }
}

bool FacePartition::read_side(int side, std::vector<Index>& sites, std::vector<Index>& breaks) const {
  sites.clear();
  breaks.clear();
  Index vertex = side;
  const Index end = (side + 1) % 3;
  while (vertex != end) {
    // The piece whose loop leaves this vertex along the side.
    Index next = k_none;
    for (const Piece& piece : pieces_) {
      for (std::size_t i = 0; i < piece.loop.size() && next == k_none; ++i) {
        const Index other = piece.loop[(i + 1) % piece.loop.size()];
        if (piece.loop[i] != vertex || (vertices_[other].side != side && other != end)) continue;
        if (common_side(vertices_[vertex], vertices_[other]) != side) continue;
        if (vertices_[other].barycentric[end] <= vertices_[vertex].barycentric[end]) continue;
        if (!sites.empty() && sites.back() == piece.site) return false;
        sites.push_back(piece.site);
        next = other;
      }
    }
    if (next == k_none) return false;
    if (next != end) breaks.push_back(next);
    vertex = next;
  }
  return true;
}

/// The mean of the inner vertices, else of those on sides, else the centroid.
Vec3 FacePartition::middle() const {
  std::vector<std::uint8_t> used(vertices_.size(), 0);
  for (const Piece& piece : pieces_) {
    for (const Index v : piece.loop) used[v] = 1;
  }
  Vec3 inner = Vec3::Zero(), outer = Vec3::Zero();
  for (std::size_t v = 3; v < vertices_.size(); ++v) {
    if (used[v]) (vertices_[v].side == k_inside ? inner : outer) += vertices_[v].barycentric;
  }
  const Vec3 sum = inner.sum() > 0 ? inner : outer.sum() > 0 ? outer : Vec3::Ones();
  // Strictly inside, so that no piece of the star is without area.
  const Vec3 mean = (sum / sum.sum()).cwiseMax(k_least_gap);
  return mean / mean.sum();
}

void FacePartition::build_star(const std::array<Side, 3>& sides) {
  const Vec3 centre_place = middle();
  vertices_.clear();
  pieces_.clear();
  for (int corner = 0; corner < 3; ++corner) vertices_.push_back({Vec3::Unit(corner), 0, k_corner});
  // Once round: the vertices in order, each with the site that follows it.
  std::vector<std::pair<Index, Index>> ring;
  for (int side = 0; side < 3; ++side) {
    ring.emplace_back(side, sides[side].sites.front());
    for (std::size_t i = 0; i < sides[side].breaks.size(); ++i) {
      const double t = sides[side].breaks[i];
      ring.emplace_back(static_cast<Index>(vertices_.size()), sides[side].sites[i + 1]);
      vertices_.push_back({(1 - t) * Vec3::Unit(side) + t * Vec3::Unit((side + 1) % 3), 0, side});
    }
  }
  const auto changes_at = [&](std::size_t i) {
    return ring[i].second != ring[(i + ring.size() - 1) % ring.size()].second;
  };
  const auto first = static_cast<std::size_t>(
      std::find_if(ring.begin(), ring.end(), [&](const auto& entry) { return changes_at(&entry - ring.data()); }) -
      ring.begin());
  if (first == ring.size()) {
    pieces_.push_back({ring.front().second, {0, 1, 2}});
    return;
  }
  const auto centre = static_cast<Index>(vertices_.size());
  vertices_.push_back({centre_place, 0, k_inside});
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const std::size_t at_ring = (first + i) % ring.size();
    if (changes_at(at_ring)) {
      if (!pieces_.empty()) pieces_.back().loop.push_back(ring[at_ring].first);
      pieces_.push_back({ring[at_ring].second, {centre}});
    }
    pieces_.back().loop.push_back(ring[at_ring].first);
  }
  pieces_.back().loop.push_back(ring[first].first);
}

}  // namespace saddleback
