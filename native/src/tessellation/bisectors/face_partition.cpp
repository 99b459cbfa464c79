#include "tessellation/bisectors/face_partition.h"

#include <algorithm>
#include <cmath>

#include "predicates/orient_3d.h"
#include "predicates/plane_predicates.h"
#include "tessellation/bisectors/edge_envelope.h"

namespace saddleback {
namespace {

/// The side that both vertices lie on, k_inside when there is none.
int common_side(const FacePartition::Vertex& a, const FacePartition::Vertex& b) {
  for (int side = 0; side < 3; ++side) {
    const int opposite = (side + 2) % 3;
    if (a.barycentric[opposite] == 0 && b.barycentric[opposite] == 0) return side;
  }
  return FacePartition::k_inside;
}

Vec3 corners_of(const FacePlane& plane) { return Vec3(plane.at_corner.data()); }

/// Scales planes to about 1 by a power of 2, so that products of three neither overflow nor vanish. Signs stay as they
/// are.
void scale(std::vector<FacePlane>& planes) {
  double most = 0;
  for (const FacePlane& plane : planes) most = std::max(most, *std::ranges::max_element(plane.at_corner));
  int exponent = 0;
  std::frexp(most, &exponent);
  const double factor = std::ldexp(1, -exponent);
  for (FacePlane& plane : planes)
    for (double& value : plane.at_corner) value *= factor;
}

}  // namespace

bool FacePartition::build(const std::vector<FacePlane>& planes, const JobStage& stage) {
  planes_ = planes;
  scale(planes_);
  vertices_.clear();
  pieces_.clear();
  for (int corner = 0; corner < 3; ++corner) vertices_.push_back({Vec3::Unit(corner), k_corner, {0, k_none, k_none}});
  pieces_.push_back({planes.front().site, {0, 1, 2}});
  for (Index plane = 1; plane < static_cast<Index>(planes.size()); ++plane) {
    stage.check();
    if (!insert(plane)) return false;
  }
  return true;
}

bool FacePartition::insert(Index plane) {
  const auto count = static_cast<Index>(vertices_.size());
  below_.resize(count);
  for (Index v = 0; v < count; ++v) below_[v] = is_below(planes_[plane], v);
  if (std::ranges::find(below_, 1) == below_.end()) return true;
  cuts_.clear();
  std::vector<Piece> kept, taken;
  kept.reserve(pieces_.size() + 1);
  for (Piece& piece : pieces_) {
    if (!cut(piece, plane, kept, taken)) return false;
  }
  if (!merge(taken)) return false;
  for (int corner = 0; corner < 3; ++corner)
    if (below_[corner]) vertices_[corner].planes[0] = plane;
  pieces_ = std::move(kept);
  pieces_.push_back(std::move(taken.front()));
  drop_idle_vertices();
  return true;
}

/// Tells whether a plane that comes after the envelope's is below it at a vertex. A tie is none: it stays with the
/// smaller site.
bool FacePartition::is_below(const FacePlane& plane, Index vertex) const {
  const Vertex& at = vertices_[vertex];
  if (at.planes[0] == k_none) return false;
  const auto corners = [&](int i) { return corners_of(planes_[at.planes[i]]); };
  if (at.side == k_corner) return plane.at_corner[vertex] < planes_[at.planes[0]].at_corner[vertex];
  if (at.side == k_inside) return predicates::orient_3d(corners(0), corners(1), corners(2), corners_of(plane)) > 0;
  const auto ends = [&](const FacePlane& of) {
    return predicates::Point2{of.at_corner[at.side], of.at_corner[(at.side + 1) % 3]};
  };
  return predicates::orient_2d(ends(planes_[at.planes[0]]), ends(planes_[at.planes[1]]), ends(plane)) ==
         predicates::Sign::negative;
}

/// Divides a piece into what stays with its site and what the plane's site takes. Pieces are convex: if their vertices'
/// signs change more than twice, they are wrong.
bool FacePartition::cut(Piece& piece, Index plane, std::vector<Piece>& kept, std::vector<Piece>& taken) {
  if (std::ranges::none_of(piece.loop, [&](Index v) { return below_[v] != 0; })) {
    kept.push_back(std::move(piece));
    return true;
  }
  Piece stays{piece.site, {}}, goes{planes_[plane].site, {}};
  stays.loop.reserve(piece.loop.size() + 1);
  goes.loop.reserve(piece.loop.size() + 1);
  int changes = 0;
  for (std::size_t i = 0; i < piece.loop.size(); ++i) {
    const Index a = piece.loop[i], b = piece.loop[(i + 1) % piece.loop.size()];
    (below_[a] ? goes : stays).loop.push_back(a);
    if (below_[a] == below_[b]) continue;
    ++changes;
    const Index middle = crossing(a, b, piece.site, plane);
    stays.loop.push_back(middle);
    goes.loop.push_back(middle);
  }
  if (!stays.loop.empty()) kept.push_back(std::move(stays));
  if (!goes.loop.empty()) taken.push_back(std::move(goes));
  return changes <= 2;
}

/// The vertex where the plane crosses the envelope between two vertices, along the loop of a site's piece; the same one
/// for both pieces beside.
Index FacePartition::crossing(Index a, Index b, Index site, Index plane) {
  for (const Cut& known : cuts_) {
    if (known.a == b && known.b == a) return known.vertex;
  }
  Vertex vertex;
  vertex.side = common_side(vertices_[a], vertices_[b]);
  vertex.planes = planes_at_crossing(a, b, site, plane);
  const Vec3 &from = vertices_[a].barycentric, &to = vertices_[b].barycentric;
  const double t = (meeting_place(vertex) - from).dot(to - from) / (to - from).squaredNorm();
  const double share = std::max(k_least_gap, std::min(t, 1 - k_least_gap));  // the least also of what is no number
  vertex.barycentric = (1 - share) * from + share * to;
  const auto index = static_cast<Index>(vertices_.size());
  vertices_.push_back(vertex);
  cuts_.push_back({a, b, index});
  return index;
}

/// Returns the planes that are least at both vertices (the piece's and, inside, the one on the right of its loop) and
/// the new one.
std::array<Index, 3> FacePartition::planes_at_crossing(Index a, Index b, Index site, Index plane) const {
  Index left = k_none, right = k_none;
  const auto& of_b = vertices_[b].planes;
  for (const Index common : vertices_[a].planes) {
    if (common == k_none || std::ranges::find(of_b, common) == of_b.end()) continue;
    (planes_[common].site == site ? left : right) = common;
  }
  if (right == k_none) return below_[a] ? std::array{plane, left, k_none} : std::array{left, plane, k_none};
  return below_[a] ? std::array{right, left, plane} : std::array{left, right, plane};
}

/// Returns where a vertex's planes meet. Inside, it follows from two of their differences; the smaller ones have lost
/// least to rounding.
Vec3 FacePartition::meeting_place(const Vertex& vertex) const {
  const auto difference = [&](int i, int j) -> Vec3 {
    return corners_of(planes_[vertex.planes[j]]) - corners_of(planes_[vertex.planes[i]]);
  };
  const Vec3 u = difference(0, 1);
  Vec3 weight = Vec3::Zero();
  if (vertex.side == k_inside) {
    const Vec3 v = difference(1, 2), w = difference(2, 0);
    const double of_u = u.squaredNorm(), of_v = v.squaredNorm(), of_w = w.squaredNorm();
    weight = of_u >= std::max(of_v, of_w) ? v.cross(w) : of_v >= of_w ? w.cross(u) : u.cross(v);
  } else {
    const int end = (vertex.side + 1) % 3;
    weight[vertex.side] = -u[end];
    weight[end] = u[vertex.side];
  }
  return weight / weight.sum();
}

/// Joins the taken pieces into one by dropping the edges between them, if that leaves one simple loop.
bool FacePartition::merge(std::vector<Piece>& taken) {
  if (taken.size() < 2) return true;
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
    if (std::count_if(outer.begin(), outer.end(), leaves) != 1) return false;
    vertex = std::find_if(outer.begin(), outer.end(), leaves)->second;
    if (vertex == outer.front().first) break;
  }
  if (loop.size() != outer.size()) return false;
  const Index site = taken.front().site;
  taken.assign(1, {site, std::move(loop)});
  return true;
}

/// Removes vertices on sides that no longer separate two pieces. No plane is least where no piece has a corner any
/// more.
void FacePartition::drop_idle_vertices() {
  uses_.assign(vertices_.size(), 0);
  for (const Piece& piece : pieces_) {
    for (const Index v : piece.loop) ++uses_[v];
  }
  for (std::size_t v = 3; v < vertices_.size(); ++v) {
    if (uses_[v] < 2) vertices_[v].planes[0] = k_none;
  }
  for (Piece& piece : pieces_) {
    std::erase_if(piece.loop, [&](Index v) { return vertices_[v].planes[0] == k_none; });
  }
}

void FacePartition::read_side(int side, std::vector<Index>& sites, std::vector<Index>& breaks) const {
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
        if (piece.loop[i] != vertex || common_side(vertices_[vertex], vertices_[other]) != side) continue;
        sites.push_back(piece.site);
        next = other;
      }
    }
    if (next == k_none) return;  // a side that is not whole agrees with no edge
    if (next != end) breaks.push_back(next);
    vertex = next;
  }
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
  const Vec3 center_place = middle();
  vertices_.clear();
  pieces_.clear();
  for (int corner = 0; corner < 3; ++corner) vertices_.push_back({Vec3::Unit(corner), k_corner});
  // Once round: the vertices in order, each with the site that follows it.
  std::vector<std::pair<Index, Index>> ring;
  for (int side = 0; side < 3; ++side) {
    ring.emplace_back(side, sides[side].sites.front());
    for (std::size_t i = 0; i < sides[side].breaks.size(); ++i) {
      const double t = sides[side].breaks[i];
      ring.emplace_back(static_cast<Index>(vertices_.size()), sides[side].sites[i + 1]);
      vertices_.push_back({(1 - t) * Vec3::Unit(side) + t * Vec3::Unit((side + 1) % 3), side});
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
  const auto center = static_cast<Index>(vertices_.size());
  vertices_.push_back({center_place, k_inside});
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const std::size_t at_ring = (first + i) % ring.size();
    if (changes_at(at_ring)) {
      if (!pieces_.empty()) pieces_.back().loop.push_back(ring[at_ring].first);
      pieces_.push_back({ring[at_ring].second, {center}});
    }
    pieces_.back().loop.push_back(ring[at_ring].first);
  }
  pieces_.back().loop.push_back(ring[first].first);
}

}  // namespace saddleback
