#include "charts/edge_pieces.h"

#include <algorithm>
#include <cmath>

#include "charts/turn.h"
#include "support/disjoint_sets.h"
#include "support/planar.h"
#include "voronoi2d/diagram/edge_curve.h"

namespace saddleback::charts {
namespace {

using predicates::Sign;

// Places nearer than this part of their coordinates are one: the most that rounding does to the points of curves.
constexpr double k_same_place = 0x1p-50;

// Of the tolerance: edges that are shorter are none, so that their ends are one where rounding moves them.
constexpr double k_merged = 0x1p-10;

// Points so many times as far from the chart as its farthest corner is from a site are beyond.
constexpr double k_far = 8;

double rounding_of(const Vec2& a, const Vec2& b) { return k_same_place * (a.cwiseAbs().sum() + b.cwiseAbs().sum()); }

bool is_same(const Vec2& a, const Vec2& b) { return (a - b).cwiseAbs().maxCoeff() <= rounding_of(a, b); }

/// Tells whether a place lies on a straight way, its ends left out.
bool is_on(const Vec2& place, const Vec2& from, const Vec2& to) {
  const Vec2 along = to - from;
  const double part = (place - from).dot(along), length = along.norm();
  if (!(part > 0 && part < length * length)) return false;
  return std::abs(cross(along, place - from)) <= (rounding_of(from, to) + rounding_of(place, place)) * length;
}

/// An edge of the mesh, told alike from both of its faces.
struct MeshEdge {
  Vec2 from, to;
  bool is_turned;  ///< against the half-edge
  MeshEdge(const Chart& chart, Index h) : from(chart.corners()[h]), to(chart.corners()[Mesh::next(h)]) {
    is_turned = to.x() < from.x() || (to.x() == from.x() && to.y() < from.y());
    if (is_turned) std::swap(from, to);
  }
};

/// Returns for each vertex of the diagram the first of those that edges shorter than a length join it to.
std::vector<Index> merged(const Voronoi2d& diagram, double length) {
  DisjointSets sets(static_cast<Index>(diagram.vertices.size()));
  for (const auto& [first, second] : diagram.edges)
    if (first != k_none && second != k_none && (diagram.vertices[first] - diagram.vertices[second]).norm() <= length)
      sets.join(first, second);
  std::vector<Index> roots(diagram.vertices.size());
  for (std::size_t i = 0; i < roots.size(); ++i) roots[i] = sets.root(static_cast<Index>(i));
  return roots;
}

/// Returns the half-edge if its place is another one on the other side of a seam, k_none elsewhere.
Index seam(const Chart& chart, Index h) { return chart.is_joined(h) ? k_none : h; }

}  // namespace

EdgePieces::EdgePieces(const Chart& chart, const Voronoi2d& diagram, double tolerance, const JobStage& stage)
    : chart_(chart), corners_(merged(diagram, k_merged * tolerance)) {
  Vec2 low = chart.corners()[0], high = low;
  for (const Vec2& corner : chart.corners()) low = low.cwiseMin(corner), high = high.cwiseMax(corner);
  for (Index edge = 0; edge < static_cast<Index>(diagram.edges.size()); ++edge) {
    stage.check();
    const auto [left, right] = diagram.edge_sites[edge];
    double reach = (diagram.sites[right] - diagram.sites[left]).stableNorm();
    for (const Index site : {left, right}) {
      const Vec2& s = diagram.sites[site];
      reach = std::max(reach, k_far * (s - low).cwiseAbs().cwiseMax((s - high).cwiseAbs()).stableNorm());
    }
    add_edge(diagram, edge, tolerance, reach);
  }
  for (const Piece& piece : pieces_) {
    const Vec2 &a = points_[piece.first].place, &b = points_[piece.first + 1].place;
    boxes_.push_back({a.cwiseMin(b), a.cwiseMax(b)});
  }
  tree_.emplace(boxes_);
}

void EdgePieces::add_edge(const Voronoi2d& diagram, Index edge, double tolerance, double extent) {
  const auto [first, second] = diagram.edges[edge];
  if (first != k_none && second != k_none && corners_[first] == corners_[second]) return;
  const voronoi2d::Bisector curve = voronoi2d::edge_bisector(diagram, edge);
  const voronoi2d::EdgePart part = voronoi2d::edge_part(diagram, edge, curve, extent);
  if (part.is_empty()) return;
  std::vector<Vec2> places;
  if (part.from.t < part.to.t) curve.sample(part.from.t, part.to.t, tolerance, places);
  const Vec2 begin = part.from.is_cut ? curve.at(part.from.t) : diagram.vertices[corners_[first]],
             end = part.to.is_cut ? curve.at(part.to.t) : diagram.vertices[corners_[second]];
  add_point(begin, part.from.is_cut ? k_none : corners_[first]);
  for (const Vec2& place : places) {
    if ((place - points_.back().place).norm() <= k_merged * tolerance || (place - end).norm() <= k_merged * tolerance)
      continue;
    pieces_.push_back({edge, static_cast<Index>(points_.size()) - 1});
    add_point(place, k_none);
  }
  pieces_.push_back({edge, static_cast<Index>(points_.size()) - 1});
  add_point(end, part.to.is_cut ? k_none : corners_[second]);
}

void EdgePieces::add_point(const Vec2& place, Index vertex) {
  const auto number = static_cast<Index>(points_.size());
  points_.push_back(vertex == k_none ? End{place, {CornerKey::Kind::curve, number, k_none}}
                                     : End{place, {CornerKey::Kind::branch, vertex, k_none}});
}

void EdgePieces::find(Index face, std::vector<Index>& pieces) const {
  const Vec2* corner = &chart_.corners()[3 * face];
  Vec2 low = corner[0].cwiseMin(corner[1]).cwiseMin(corner[2]),
       high = corner[0].cwiseMax(corner[1]).cwiseMax(corner[2]);
  const double rounding = 4 * rounding_of(low, high);
  pieces.clear();
  tree_->visit({low.array() - rounding, high.array() + rounding}, [&](Index piece) { pieces.push_back(piece); });
  std::sort(pieces.begin(), pieces.end());
}

void EdgePieces::meet(Index face, Index piece, std::vector<Meeting>& meetings) const {
  meetings.clear();
  const Index first = pieces_[piece].first;
  const Vec2 &begin = points_[first].place, &end = points_[first + 1].place;
  for (const Index point : {first, first + 1})
    if (const auto meeting = meet_end(face, point)) meetings.push_back(*meeting);
  const auto touches = [&](Index h) {  // by one of its ends
    return std::any_of(meetings.begin(), meetings.end(), [&](const Meeting& m) {
      return m.halfedge == h || (m.corner >= 0 && (m.corner == h % 3 || m.corner == (h + 1) % 3));
    });
  };
  std::array<bool, 3> is_crossed{};
  std::vector<Meeting> between;
  for (int k = 0; k < 3; ++k) {
    const Vec2& corner = chart_.corners()[3 * face + k];
    is_crossed[k] = is_on(corner, begin, end) && !is_same(corner, begin) && !is_same(corner, end);
    if (is_crossed[k])
      between.push_back({{CornerKey::Kind::vertex, chart_.mesh().from(3 * face + k), k_none}, corner, k_none, k, 0, 0});
  }
  for (int k = 0; k < 3; ++k)
    if (!is_crossed[k] && !is_crossed[(k + 1) % 3] && !touches(3 * face + k))
      if (const auto meeting = crossing(3 * face + k, piece)) between.push_back(*meeting);
  meetings.insert(meetings.end(), between.begin(), between.end());
  for (Meeting& meeting : meetings) meeting.along = (meeting.place - begin).dot(end - begin);
  std::stable_sort(meetings.begin(), meetings.end(),
                   [](const Meeting& a, const Meeting& b) { return a.along < b.along; });
}

std::optional<Meeting> EdgePieces::meet_end(Index face, Index point) const {
  const auto& [place, key] = points_[point];
  for (int k = 0; k < 3; ++k)
    if (const Vec2& corner = chart_.corners()[3 * face + k]; is_same(place, corner))
      return Meeting{{CornerKey::Kind::vertex, chart_.mesh().from(3 * face + k), k_none}, corner, k_none, k, 0, 0};
  bool is_inside = true;
  for (Index h = 3 * face; h < 3 * face + 3; ++h) {
    const MeshEdge edge(chart_, h);
    if (is_on(place, edge.from, edge.to)) return on_edge(h, place, {key.kind, key.a, seam(chart_, h)});
    is_inside = is_inside && turn(chart_.corners()[h], chart_.corners()[Mesh::next(h)], place) == Sign::positive;
  }
  if (!is_inside) return {};
  return Meeting{key, place, k_none, -1, 0, 0};
}

std::optional<Meeting> EdgePieces::crossing(Index h, Index piece) const {
  const Vec2 &begin = points_[pieces_[piece].first].place, &end = points_[pieces_[piece].first + 1].place;
  const MeshEdge edge(chart_, h);
  if (turn(edge.from, edge.to, begin) == turn(edge.from, edge.to, end) ||
      turn(begin, end, edge.from) == turn(begin, end, edge.to))
    return {};
  const Vec2 along = end - begin;
  const double from = cross(along, edge.from - begin), to = cross(along, edge.to - begin);
  const double share = from == to ? 0.5 : std::clamp(from / (from - to), 0.0, 1.0);
  const Index speaker = chart_.is_joined(h) ? std::min(h, chart_.mesh().twin(h)) : h;
  return on_edge(h, edge.from + share * (edge.to - edge.from), {CornerKey::Kind::crossing, speaker, piece});
}

Meeting EdgePieces::on_edge(Index h, const Vec2& place, CornerKey key) const {
  const MeshEdge edge(chart_, h);
  const Vec2 along = edge.to - edge.from;
  constexpr double k_steps = 0x1p53;  // of which each share, and what it leaves of 1, is a whole number
  const double share = std::clamp((place - edge.from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  const double rounded = std::round(share * k_steps) / k_steps;
  return {key, place, h, -1, edge.is_turned ? 1 - rounded : rounded, 0};
}

}  // namespace saddleback::charts
