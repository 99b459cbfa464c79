#include "mesh/cutting/barrier_cuts.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "saddleback/error.h"

#include "mesh/tables/outgoing.h"

namespace saddleback {
namespace {

// In barycentric coordinates: what is nearer meets. Far above the rounding of points where two curves cross, so that no
// slit is left where one ends on another, and far below what anybody draws.
constexpr double k_meets = 1e-9;
// Edges and pieces that are too long become parts that are shorter than asked for by this factor, so that those between
// the parts of two edges side by side, as needles have them, are short enough at once.
constexpr double k_shorter = 1 / std::numbers::sqrt2;
constexpr int k_most_rounds = 100;

double area_between(const Vec2& u, const Vec2& v) { return u.x() * v.y() - u.y() * v.x(); }
Vec3 from_weights(const Vec2& w) { return {1 - w.x() - w.y(), w.x(), w.y()}; }
/// Equal parts of a way for which edges of that length are wanted.
int parts_of(double way, double length) {
  return way <= length ? 1 : static_cast<int>(std::ceil(way / (k_shorter * length)));
}

}  // namespace

BarrierCuts::BarrierCuts(const Mesh& mesh, std::span<const std::array<Index, 2>> edges,
                         std::span<const SurfaceCurve* const> curves, const JobStage& stage, const Fineness* fineness)
    : mesh_(mesh), stage_(stage), fineness_(fineness), lines_(curves.size()) {
  points_.reserve(static_cast<std::size_t>(mesh.vertex_count()));
  for (Index v = 0; v < mesh.vertex_count(); ++v) points_.push_back(at_vertex(mesh, v));
  for (std::size_t i = 0; i < curves.size(); ++i) add_curve(static_cast<Index>(i), *curves[i]);
  std::map<Index, std::vector<Index>> by_face;
  for (std::size_t i = 0; i < pieces_.size(); ++i) by_face[pieces_[i].face].push_back(static_cast<Index>(i));
  for (const auto& [face, pieces] : by_face) cross(pieces);
  // Only now are all nodes known that a barrier may pass.
  follow_curves(curves);
  if (fineness_) divide_edges();
  for (std::size_t i = 0; i < edges.size(); ++i) add_given_edge(given_edge(mesh, edges[i], i));
  halve_lonely_edges();
  for (const Edge& edge : edges_) edges_in_[edge.face].push_back(edge);
}

void BarrierCuts::follow_curves(std::span<const SurfaceCurve* const> curves) {
  std::vector<Index> chain;
  std::vector<std::pair<Index, Index>> within;  // faces and nodes that no other piece passes
  for (std::size_t i = 0; i < pieces_.size();) {
    const Index curve = pieces_[i].curve, first = pieces_[i].from;
    std::unordered_set<Index> passed{first};
    lines_[curve].push_back(first);
    for (; i < pieces_.size() && pieces_[i].curve == curve; ++i) {
      const bool is_last = i + 1 == pieces_.size() || pieces_[i + 1].curve != curve;
      stage_.check();
      follow(pieces_[i], chain);
      if (fineness_) divide(pieces_[i].face, chain, within);
      for (std::size_t k = 1; k < chain.size(); ++k) {
        const bool closes = is_last && k + 1 == chain.size() && curves[curve]->closed() && chain[k] == first;
        if (!passed.insert(chain[k]).second && !closes) refuse(curve, chain[k]);
        add_edge({pieces_[i].face, chain[k - 1], chain[k]});
        lines_[curve].push_back(chain[k]);
      }
    }
  }
  for (const auto& [face, node] : within) inside_[face].push_back(node);
}

void BarrierCuts::add_edge(const Edge& edge) {
  if (barriers_.insert(edge_key(edge.from, edge.to)).second) edges_.push_back(edge);
}

/// Adds the parts between all nodes along the edge.
void BarrierCuts::add_given_edge(Index halfedge) {
  const Index h = speaker(halfedge), face = Mesh::face_of(h);
  Index last = mesh_.from(h);
  if (const auto found = on_edge_.find(h); found != on_edge_.end())
    for (const OnEdge& on : found->second) add_edge({face, std::exchange(last, on.node), on.node});
  add_edge({face, last, mesh_.to(h)});
}

/// Halves those that end at inner vertices alone, about which the surface hangs together: nothing would part it.
void BarrierCuts::halve_lonely_edges() {
  std::unordered_map<Index, Index> ends;
  for (const Edge& edge : edges_) ++ends[edge.from], ++ends[edge.to];
  const auto is_loose = [&](Index node) {
    return ends[node] == 1 && (node >= mesh_.vertex_count() || !mesh_.is_boundary(node));
  };
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    const auto [face, from, to] = edges_[i];
    if (!is_loose(from) || !is_loose(to)) continue;
    const Index middle =
        node_at(face, (*barycentric_in(mesh_, points_[from], face) + *barycentric_in(mesh_, points_[to], face)) / 2);
    if (middle == from || middle == to) continue;  // shorter than what meets
    barriers_.erase(edge_key(from, to));
    barriers_.insert({edge_key(from, middle), edge_key(middle, to)});
    edges_[i].to = middle;
    edges_.push_back({face, middle, to});
    ends[middle] = 2;
  }
}

void BarrierCuts::add_curve(Index curve, const SurfaceCurve& line) {
  Index last = k_none;
  SurfacePoint end;
  const auto join = [&](const SurfacePoint& begin, Index node) {
    // A point that the curve has off an edge by rounding counts as on it in the face beyond alone: the gap is closed.
    if (last == k_none || last == node) return;
    if (const Index face = shared_face(mesh_, end, begin, k_barycentric_tolerance); face != k_none)
      add_piece(curve, face, last, node);
  };
  for (const CurveSegment& segment : line.segments()) {
    const Index from = node_at(segment.face, segment.begin), to = node_at(segment.face, segment.end);
    join({segment.face, segment.begin}, from);
    add_piece(curve, segment.face, from, to);
    last = to;
    end = {segment.face, segment.end};
  }
  if (line.closed()) {
    const CurveSegment& first = line.segments().front();
    join({first.face, first.begin}, node_at(first.face, first.begin));
  }
}

void BarrierCuts::add_piece(Index curve, Index face, Index from, Index to) {
  if (from != to) pieces_.push_back({face, curve, from, to});
}

Index BarrierCuts::speaker(Index h) const {
  const Index twin = mesh_.twin(h);
  return twin == k_none ? h : std::min(h, twin);
}

Index BarrierCuts::new_node(Index face, const Vec3& barycentric) {
  points_.push_back({face, barycentric});
  return static_cast<Index>(points_.size()) - 1;
}

Index BarrierCuts::node_at(Index face, const Vec3& barycentric) {
  for (int i = 0; i < 3; ++i)
    if (barycentric[i] >= 1 - k_meets) return mesh_.from(3 * face + i);
  for (int i = 0; i < 3; ++i) {
    const double here = barycentric[i], next = barycentric[(i + 1) % 3];
    if (barycentric[(i + 2) % 3] <= k_meets) return node_on(3 * face + i, next / (here + next));
  }
  std::vector<Index>& nodes = inside_[face];
  for (const Index node : nodes)
    if ((points_[node].barycentric - barycentric).cwiseAbs().maxCoeff() <= k_meets) return node;
  nodes.push_back(new_node(face, barycentric));
  return nodes.back();
}

Index BarrierCuts::node_on(Index halfedge, double along) {
  if (along <= k_meets) return mesh_.from(halfedge);
  if (along >= 1 - k_meets) return mesh_.to(halfedge);
  const Index h = speaker(halfedge);
  if (h != halfedge) along = 1 - along;
  std::vector<OnEdge>& nodes = on_edge_[h];
  const auto place = std::ranges::lower_bound(nodes, along - k_meets, {}, &OnEdge::along);
  if (place != nodes.end() && place->along <= along + k_meets) return place->node;
  Vec3 barycentric = Vec3::Zero();
  barycentric[h % 3] = 1 - along;
  barycentric[(h + 1) % 3] = along;
  const Index node = new_node(Mesh::face_of(h), barycentric);
  nodes.insert(place, {along, node});
  followed_.face = k_none;
  return node;
}

/// Weights of the face's corners 1 and 2, exactly on its edge for a node on one.
Vec2 BarrierCuts::weights(Index face, Index node) const {
  const Vec3 barycentric = *barycentric_in(mesh_, points_[node], face);
  // These two are taken so that their sum is exactly 1: the larger is rounded, and what is left of 1 then is no more.
  if (barycentric[0] == 0) {
    const double second = 1 - barycentric[1];
    return {1 - second, second};
  }
  return {barycentric[1], barycentric[2]};
}

bool BarrierCuts::is_cut(Index face) const {
  if (points_.size() == static_cast<std::size_t>(mesh_.vertex_count())) return false;
  if (inside_.contains(face)) return true;
  for (Index h = 3 * face; h < 3 * face + 3; ++h)
    if (on_edge_.contains(speaker(h))) return true;
  return false;
}

std::vector<Index> BarrierCuts::nodes_of(Index face) const {
  std::vector<Index> nodes(mesh_.triangles()[face].begin(), mesh_.triangles()[face].end());
  for (Index h = 3 * face; h < 3 * face + 3; ++h)
    if (const auto found = on_edge_.find(speaker(h)); found != on_edge_.end())
      for (const OnEdge& on : found->second) nodes.push_back(on.node);
  if (const auto found = inside_.find(face); found != inside_.end())
    nodes.insert(nodes.end(), found->second.begin(), found->second.end());
  return nodes;
}

/// Makes nodes where pieces of one face cross.
void BarrierCuts::cross(std::span<const Index> pieces) {
  std::vector<std::array<Vec2, 2>> ends;
  for (const Index i : pieces)
    ends.push_back({weights(pieces_[i].face, pieces_[i].from), weights(pieces_[i].face, pieces_[i].to)});
  const Index face = pieces_[pieces.front()].face;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    stage_.check();
    const Vec2 &a = ends[i][0], along = ends[i][1] - a;
    for (std::size_t j = 0; j < i; ++j) {
      const auto& [c, d] = ends[j];
      const double from = area_between(along, c - a), to = area_between(along, d - a);
      if ((from > 0) == (to > 0)) continue;
      const Vec2 crossing = c + from / (from - to) * (d - c);
      const double share = (crossing - a).dot(along) / along.squaredNorm();
      if (share > 0 && share < 1) node_at(face, normalized_barycentric(from_weights(crossing)));
    }
  }
}

/// Makes nodes between those of a piece that are too far apart.
void BarrierCuts::divide(Index face, std::vector<Index>& chain, std::vector<std::pair<Index, Index>>& within) {
  std::vector<Index> finer{chain.front()};
  for (std::size_t k = 1; k < chain.size(); ++k) {
    const Vec3 a = *barycentric_in(mesh_, points_[chain[k - 1]], face),
               b = *barycentric_in(mesh_, points_[chain[k]], face);
    const int parts = parts_of((position(mesh_, {face, b}) - position(mesh_, {face, a})).norm(), fineness_->length);
    for (int i = 1; i < parts; ++i) {
      stage_.check();
      const Vec3 between = a + i / static_cast<double>(parts) * (b - a);
      const bool is_within = between.minCoeff() > k_meets;
      finer.push_back(is_within ? new_node(face, between) : node_at(face, between));
      if (is_within) within.emplace_back(face, finer.back());
    }
    finer.push_back(chain[k]);
  }
  chain.swap(finer);
}

/// Makes nodes in edges that are too long, between those that are there: equal parts, as far as they are near.
void BarrierCuts::divide_edges() {
  std::vector<double> shares;
  for (Index h = 0; h < mesh_.halfedge_count(); ++h) {
    if (speaker(h) != h || mesh_.length(h) <= fineness_->length) continue;
    const Vec3 &start = mesh_.position(mesh_.from(h)), way = mesh_.position(mesh_.to(h)) - start;
    std::vector<double> ends{0};
    if (const auto found = on_edge_.find(h); found != on_edge_.end())
      for (const OnEdge& on : found->second) ends.push_back(on.along);
    ends.push_back(1);
    for (std::size_t i = 1; i < ends.size(); ++i) {
      const double first = ends[i - 1], step = ends[i] - first;
      const int parts = parts_of(step * mesh_.length(h), fineness_->length);
      const auto divide = [&](auto&& self, int low, int high) -> void {
        const double a = first + step * low / parts, b = first + step * high / parts;
        if (high - low < 2 || !fineness_->is_near(start + a * way, start + b * way)) return;
        const int middle = (low + high) / 2;
        self(self, low, middle);
        node_on(h, first + step * middle / parts);
        self(self, middle, high);
      };
      divide(divide, 0, parts);
    }
  }
}

/// Makes nodes in the middle of edges within the face that are too long, the longest first, and keeps the triangles
/// Delaunay's [rivara1984].
void BarrierCuts::divide_inside(Index face, std::vector<Index>& nodes) {
  std::vector<Vec2> at;
  std::vector<Vec3> places;
  const auto add = [&](const Vec2& weight) {
    at.push_back(weight);
    places.push_back(position(mesh_, {face, from_weights(weight)}));
  };
  for (const Index node : nodes) add(weights(face, node));
  std::vector<std::array<Index, 3>> too_long;  // ends and a half-edge
  double limit = mesh_.length(3 * face) + mesh_.length(3 * face + 1);
  for (int round = 0; round < k_most_rounds; ++round) {
    limit = std::max(limit * k_shorter, fineness_->length);
    too_long.clear();
    for (std::size_t t = 0; t < flat_.triangle_count(); ++t) {
      stage_.check();
      const Triangle flat = flat_.triangle(t);
      for (int k = 0; k < 3; ++k) {
        const Index from = flat[k], to = flat[(k + 1) % 3];
        if (from > to || flat_.neighbor(t, k) == k_none) continue;
        if ((places[to] - places[from]).squaredNorm() > limit * limit && fineness_->is_near(places[from], places[to]))
          too_long.push_back({from, to, static_cast<Index>(3 * t) + k});
      }
    }
    if (too_long.empty() && limit == fineness_->length) return;
    for (const auto& [from, to, h] : too_long) {
      stage_.check();
      // One that was exchanged since is made good by the node for which it was, or is there in the next round.
      const Triangle flat = flat_.triangle(h / 3);
      if (flat[h % 3] != from || flat[(h % 3 + 1) % 3] != to) continue;
      const Vec2 middle = (at[from] + at[to]) / 2;
      if (flat_.add(middle, h / 3) < static_cast<Index>(at.size())) continue;
      add(middle);
      nodes.push_back(new_node(face, from_weights(middle)));
    }
  }
}

/// The nodes that a piece passes, with its ends.
void BarrierCuts::follow(const Piece& piece, std::vector<Index>& chain) {
  if (followed_.face != piece.face) {
    followed_ = {piece.face, nodes_of(piece.face), {}};
    for (const Index node : followed_.nodes) followed_.weights.push_back(weights(piece.face, node));
  }
  const Vec2 a = weights(piece.face, piece.from), along = weights(piece.face, piece.to) - a;
  const double length = along.norm();
  std::vector<OnEdge> passed;
  for (std::size_t i = 0; i < followed_.nodes.size(); ++i) {
    const Index node = followed_.nodes[i];
    if (node == piece.from || node == piece.to) continue;
    const Vec2 way = followed_.weights[i] - a;
    const double share = way.dot(along) / (length * length);
    if (share > 0 && share < 1 && std::abs(area_between(along, way)) <= k_meets * length)
      passed.push_back({share, node});
  }
  std::ranges::sort(passed, {}, &OnEdge::along);
  chain.assign(1, piece.from);
  for (const OnEdge& node : passed) chain.push_back(node.node);
  chain.push_back(piece.to);
}

void BarrierCuts::refuse(Index curve, Index node) const {
  const auto [face, weights] = points_[node];
  const Index own = fineness_ ? fineness_->faces[face] : face;
  const Vec3 place = position(fineness_ ? fineness_->whole : mesh_, {own, weights});
  const std::string where = message("crosses or touches itself at (", place.x(), ", ", place.y(), ", ", place.z(), ")");
  if (fineness_) throw InputError(message("curve: it ", where, "; give it as two curves"));
  throw InputError(message("curves: curve ", curve, " ", where, " in face ", own, "; give it as two curves"));
}

void BarrierCuts::cut(Index face, std::vector<Triangle>& triangles) {
  const FaceChart chart(mesh_, face);
  flat_.begin({chart.corner[0], chart.corner[1], chart.corner[2]});
  std::vector<Index> nodes = nodes_of(face);
  std::unordered_map<Index, Index> number;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    stage_.check();
    number[nodes[i]] = i < 3 ? static_cast<Index>(i) : flat_.add(weights(face, nodes[i]));
  }
  if (const auto found = edges_in_.find(face); found != edges_in_.end()) {
    for (const Edge& edge : found->second)
      if (!flat_.connect(number[edge.from], number[edge.to], stage_))
        throw InputError(message(fineness_ ? "curve: its parts meet" : "curves: they cross",
                                 " at too small an angle in face ", fineness_ ? fineness_->faces[face] : face,
                                 fineness_ ? "; move one of its points" : "; move one of them"));
  }
  flat_.improve(stage_);
  if (fineness_) divide_inside(face, nodes);
  for (std::size_t t = 0; t < flat_.triangle_count(); ++t) {
    const Triangle flat = flat_.triangle(t);
    triangles.push_back({nodes[flat[0]], nodes[flat[1]], nodes[flat[2]]});
  }
}

}  // namespace saddleback
