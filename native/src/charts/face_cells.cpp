// Each cell is cut out of the face by its sides, one after another. Where a side crosses a mesh edge depends on that
// edge and the two sites alone, so the faces and the cells on both sides find the same places; where sides of cells
// meet is a vertex of the diagram.

#include "charts/face_cells.h"

#include <algorithm>
#include <cmath>

#include "voronoi2d/diagram/cell_sides.h"

namespace saddleback::charts {
namespace {

// Places nearer than this part of their coordinates are one: the most that rounding does to a bisector, to where it
// crosses a mesh edge, or to a vertex of the diagram. So an edge along a mesh edge lies on it, and what meets there
// meets in one point.
constexpr double k_same_place = 0x1p-51;

/// Points nearer to `mine` than to `other` have a positive value; for the cell beyond it is the same with the other
/// sign, to the last bit. Zero on the bisector, for both.
struct Bisector {
  Vec2 middle, across;
  double size;
  Bisector(const Voronoi2d& diagram, Index mine, Index other)
      : middle(voronoi2d::middle_between(diagram, mine, other)),
        across(diagram.sites[mine] - diagram.sites[other]),
        size(diagram.sites[mine].cwiseAbs().sum() + diagram.sites[other].cwiseAbs().sum() +
             (diagram.powers.empty() ? 0 : middle.cwiseAbs().sum())) {}
  double value(const Vec2& p) const {
    const double value = (p - middle).dot(across);
    const double rounding = k_same_place * (size + p.cwiseAbs().sum()) * across.cwiseAbs().maxCoeff();
    return std::abs(value) <= rounding ? 0 : value;
  }
};

/// The corner that the faces on both sides of a mesh edge share; a seam's faces share none.
Index edge_key(const Chart& chart, Index h) { return chart.is_joined(h) ? std::min(h, chart.mesh().twin(h)) : h; }

class CellClip {
 public:
  CellClip(const Chart& chart, const Voronoi2d& diagram, Index face, Index site)
      : chart_(chart), diagram_(diagram), sides_(diagram, site) {
    for (Index h = 3 * face; h < 3 * face + 3; ++h)
      loop_.push_back({{CornerKey::Kind::vertex, chart.mesh().from(h), k_none}, chart.corners()[h], k_none, h});
  }

  /// Returns what is left of the face; fewer than three corners where nothing is.
  std::vector<PieceCorner> clip() {
    for (Index k = 0; k < sides_.count() && !loop_.empty(); ++k) cut(k);
    // A side nearly in line with one that came later may have seen nothing to cut off.
    for (Index left = sides_.count(); left-- > 0;) {
      const Index k = missing_side();
      if (k == k_none) break;
      cut(k);
    }
    std::vector<PieceCorner> corners;
    for (const Corner& corner : loop_) {
      const bool is_side = corner.line < 0;
      const PieceCorner next{corner.key, corner.place, corner.halfedge, is_side ? sides_.edge(~corner.line) : k_none,
                             is_side ? k_none : corner.line};
      if (!corners.empty() && corners.back().key == next.key) corners.pop_back();  // a side of no length goes
      corners.push_back(next);
    }
    while (corners.size() > 1 && corners.front().key == corners.back().key) corners.pop_back();
    return corners;
  }

  /// Lists edges of the diagram: those that have cut something off.
  const std::vector<Index>& cutting_edges() const { return cutting_edges_; }

 private:
  struct Corner {
    CornerKey key;
    Vec2 place;
    Index halfedge;  ///< of the face that the corner lies on; k_none for vertices, and inside
    Index line;      ///< what follows: a half-edge h of the face, or ~k for side k of the cell
  };

  void cut(Index k) {
    const Bisector by(diagram_, sides_.site(), sides_.other(k));
    values_.clear();
    for (std::size_t i = 0; i < loop_.size(); ++i)
      values_.push_back(value(loop_[i == 0 ? loop_.size() - 1 : i - 1].line, loop_[i], k, by));
    if (std::all_of(values_.begin(), values_.end(), [](double v) { return v >= 0; })) return;
    cutting_edges_.push_back(sides_.edge(k));
    std::vector<Corner> kept;
    for (std::size_t i = 0; i < loop_.size(); ++i) {
      const std::size_t j = (i + 1) % loop_.size();
      if (values_[i] >= 0) kept.push_back(loop_[i]);
      if (values_[i] >= 0 && values_[j] < 0) {  // goes out: the side follows
        if (values_[i] > 0) kept.push_back(crossing(loop_[i], loop_[j].place, k));
        kept.back().line = ~k;
      } else if (values_[i] < 0 && values_[j] > 0) {
        kept.push_back(crossing(loop_[i], loop_[j].place, k));
        kept.back().line = loop_[i].line;
      }
    }
    loop_ = std::move(kept);
  }

  /// Tells whether a corner is where two sides meet of which one comes after the other, but with others between them:
  /// outside of the cell, and of all of these.
  bool is_outside(Index line_before, const Corner& corner) const {
    return corner.key.kind == CornerKey::Kind::branch && corner.key.a == k_none && line_before < 0 && corner.line < 0 &&
           sides_.after(~line_before) != ~corner.line;
  }

  /// Returns a side that cuts off a corner outside of the cell; k_none where there is none.
  Index missing_side() const {
    for (std::size_t i = 0; i < loop_.size(); ++i)
      if (const Index before = loop_[i == 0 ? loop_.size() - 1 : i - 1].line; is_outside(before, loop_[i]))
        return sides_.after(~before);
    return k_none;
  }

  double value(Index line_before, const Corner& corner, Index k, const Bisector& by) const {
    if (corner.key.kind == CornerKey::Kind::vertex) return by.value(corner.place);
    if (is_outside(line_before, corner)) {
      const Index count = sides_.count(), first = ~line_before;
      if ((k - first + count) % count < (~corner.line - first + count) % count && k != first) return -1;
    }
    int least = 1;
    if (corner.key.kind == CornerKey::Kind::crossing || corner.key.a == k_none)
      for (const Index line : {line_before, corner.line})
        if (line < 0) least = std::min(least, sides_.compare(corner.place, ~line, k));
    return least == 0 ? by.value(corner.place) : least;
  }

  Corner crossing(const Corner& from, const Vec2& to, Index k) const {
    if (from.line >= 0) return edge_crossing(from.line, k);
    // Two sides that are no neighbors meet outside of the cell, and what lies there is cut off later.
    const CornerKey key{CornerKey::Kind::branch, sides_.vertex_between(~from.line, k), k_none};
    return {key, sides_.place_between(from.place, sides_.meeting(~from.line, k), to), k_none, 0};
  }

  Corner edge_crossing(Index h, Index k) const {
    const Index edge = sides_.edge(k);
    const auto [left, right] = diagram_.edge_sites[edge];
    Vec2 a = chart_.corners()[h], b = chart_.corners()[Mesh::next(h)];
    if (b.x() < a.x() || (b.x() == a.x() && b.y() < a.y())) std::swap(a, b);  // the same from both sides of the edge
    const Bisector by(diagram_, left, right);
    const double at_a = by.value(a), at_b = by.value(b);
    const double share = std::clamp(at_a / (at_a - at_b), 0.0, 1.0);
    const Vec2 place = a + share * (b - a);
    for (const Index vertex :
         diagram_.edges[edge]) {  // where edges meet on the mesh edge all of them end in one corner
      if (vertex == k_none) continue;
      const Vec2& end = diagram_.vertices[vertex];
      const double same = k_same_place * (end.cwiseAbs().sum() + place.cwiseAbs().sum());
      if ((end - place).cwiseAbs().maxCoeff() <= same) return {{CornerKey::Kind::branch, vertex, k_none}, place, h, 0};
    }
    return {{CornerKey::Kind::crossing, edge_key(chart_, h), edge}, place, h, 0};
  }

  const Chart& chart_;
  const Voronoi2d& diagram_;
  voronoi2d::CellSides sides_;
  std::vector<Corner> loop_;
  std::vector<double> values_;
  std::vector<Index> cutting_edges_;
};

/// Tells whether a cell holds the whole face: nearly all faces of fine meshes.
bool holds(const Voronoi2d& diagram, Index site, const Vec2* corner) {
  for (const Index edge : diagram.cell_edges(site)) {
    const auto [left, right] = diagram.edge_sites[edge];
    const Bisector side(diagram, site, left == site ? right : left);
    for (int i = 0; i < 3; ++i)
      if (side.value(corner[i]) < 0) return false;
  }
  return true;
}

}  // namespace

void divide_face(const Chart& chart, const Voronoi2d& diagram, Index face, Index site, std::vector<FacePiece>& pieces) {
  pieces.clear();
  if (holds(diagram, site, &chart.corners()[3 * face])) return;
  std::vector<Index> found{site}, known{site};  // `known` is sorted
  const auto find = [&](Index of, Index edge) {
    const auto [left, right] = diagram.edge_sites[edge];
    const Index other = left == of ? right : left;
    const auto place = std::lower_bound(known.begin(), known.end(), other);
    if (place != known.end() && *place == other) return;
    known.insert(place, other);
    found.push_back(other);
  };
  for (std::size_t i = 0; i < found.size(); ++i) {
    CellClip cell(chart, diagram, face, found[i]);
    FacePiece piece{found[i], cell.clip()};
    if (piece.corners.size() < 3) {  // a neighbor's side was taken for its: who cuts it off has the part
      for (const Index edge : cell.cutting_edges()) find(piece.site, edge);
      continue;
    }
    for (const PieceCorner& corner : piece.corners)
      if (corner.side != k_none) find(piece.site, corner.side);
    pieces.push_back(std::move(piece));
  }
  std::sort(pieces.begin(), pieces.end(), [](const FacePiece& a, const FacePiece& b) { return a.site < b.site; });
}

}  // namespace saddleback::charts
