// Each cell is cut out of the face by its sides, one after another. Where a side crosses a mesh edge depends on that
// edge and the two sites alone, so the faces and the cells on both sides find the same places; where sides of cells
// meet is a vertex of the diagram.

#include "charts/face_cells.h"

#include <algorithm>
#include <cmath>

namespace saddleback::charts {
namespace {

// Places nearer than this part of their coordinates are one: far below what single precision shows, far above what
// rounding does to vertices of the diagram. So an edge along a mesh edge lies on it, and what meets there meets in one
// point.
constexpr double k_same_place = 0x1p-40;

/// Points nearer to `mine` than to `other` have a positive value; for the cell beyond it is the same with the other
/// sign, to the last bit. Zero on the bisector, for both.
struct Bisector {
  Vec2 middle, across;
  double size;
  Bisector(const Vec2& mine, const Vec2& other)
      : middle(0.5 * mine + 0.5 * other), across(mine - other), size(mine.cwiseAbs().sum() + other.cwiseAbs().sum()) {}
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
      : chart_(chart), diagram_(diagram), site_(site), cell_edges_(diagram.cell_edges(site)) {
    for (Index h = 3 * face; h < 3 * face + 3; ++h)
      loop_.push_back({{CornerKey::Kind::vertex, chart.mesh().from(h), k_none}, chart.corners()[h], k_none, h});
  }

  /// What is left of the face; fewer than three corners where nothing is.
  std::vector<PieceCorner> clip() {
    for (std::size_t k = 0; k < cell_edges_.size() && !loop_.empty(); ++k) cut(static_cast<Index>(k));
    std::vector<PieceCorner> corners;
    for (const Corner& corner : loop_) {
      const bool is_side = corner.line < 0;
      const PieceCorner next{corner.key, corner.place, corner.halfedge, is_side ? cell_edges_[~corner.line] : k_none,
                             is_side ? k_none : corner.line};
      if (!corners.empty() && corners.back().key == next.key) corners.pop_back();  // a side of no length goes
      corners.push_back(next);
    }
    while (corners.size() > 1 && corners.front().key == corners.back().key) corners.pop_back();
    return corners;
  }

 private:
  struct Corner {
    CornerKey key;
    Vec2 place;
    Index halfedge;  ///< of the face that the corner lies on; k_none for vertices, and inside
    Index line;      ///< what follows: a half-edge h of the face, or ~k for side k of the cell
  };

  void cut(Index k) {
    const auto [left, right] = diagram_.edge_sites[cell_edges_[k]];
    const Bisector side(diagram_.sites[site_], diagram_.sites[left == site_ ? right : left]);
    std::vector<double> values;
    for (const Corner& corner : loop_) values.push_back(side.value(corner.place));
    if (std::all_of(values.begin(), values.end(), [](double v) { return v >= 0; })) return;
    std::vector<Corner> kept;
    for (std::size_t i = 0; i < loop_.size(); ++i) {
      const std::size_t j = (i + 1) % loop_.size();
      if (values[i] >= 0) kept.push_back(loop_[i]);
      if (values[i] >= 0 && values[j] < 0) {  // goes out: the side follows
        if (values[i] > 0) {
          kept.push_back(crossing(loop_[i], loop_[j], values[i], values[j], loop_[i].line, k));
        }
        kept.back().line = ~k;
      } else if (values[i] < 0 && values[j] > 0) {
        kept.push_back(crossing(loop_[i], loop_[j], values[i], values[j], loop_[i].line, k));
        kept.back().line = loop_[i].line;
      }
    }
    loop_ = std::move(kept);
  }

  Corner crossing(const Corner& from, const Corner& to, double from_value, double to_value, Index line, Index k) const {
    if (line >= 0) return edge_crossing(line, k);
    // Two sides of the cell: they meet at the vertex between them. Side k leads to vertex k of the cell.
    const Index other = ~line, count = static_cast<Index>(cell_edges_.size());
    const bool goes_out = from_value > 0;
    const Index first = goes_out ? other : k, second = goes_out ? k : other;
    const Index vertex = diagram_.cell_vertices(site_)[first];
    const Vec2 place = from.place + from_value / (from_value - to_value) * (to.place - from.place);
    // Those that are no neighbours meet outside of the cell, and what lies there is cut off later.
    const bool is_vertex = (first + 1) % count == second && vertex != k_none;
    return {{CornerKey::Kind::branch, vertex, k_none}, is_vertex ? diagram_.vertices[vertex] : place, k_none, 0};
  }

  Corner edge_crossing(Index h, Index k) const {
    const Index edge = cell_edges_[k];
    const auto [left, right] = diagram_.edge_sites[edge];
    Vec2 a = chart_.corners()[h], b = chart_.corners()[Mesh::next(h)];
    if (b.x() < a.x() || (b.x() == a.x() && b.y() < a.y())) std::swap(a, b);  // the same from both sides of the edge
    const Bisector side(diagram_.sites[left], diagram_.sites[right]);
    const double at_a = side.value(a), at_b = side.value(b);
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
  Index site_;
  std::span<const Index> cell_edges_;
  std::vector<Corner> loop_;
};

/// Whether a cell holds the whole face: nearly all faces of fine meshes.
bool holds(const Voronoi2d& diagram, Index site, const Vec2* corner) {
  for (const Index edge : diagram.cell_edges(site)) {
    const auto [left, right] = diagram.edge_sites[edge];
    const Bisector side(diagram.sites[site], diagram.sites[left == site ? right : left]);
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
  for (std::size_t i = 0; i < found.size(); ++i) {
    FacePiece piece{found[i], CellClip(chart, diagram, face, found[i]).clip()};
    if (piece.corners.size() < 3) continue;
    for (const PieceCorner& corner : piece.corners) {
      if (corner.side == k_none) continue;
      const auto [left, right] = diagram.edge_sites[corner.side];
      const Index other = left == piece.site ? right : left;
      const auto place = std::lower_bound(known.begin(), known.end(), other);
      if (place != known.end() && *place == other) continue;
      known.insert(place, other);
      found.push_back(other);
    }
    pieces.push_back(std::move(piece));
  }
  std::sort(pieces.begin(), pieces.end(), [](const FacePiece& a, const FacePiece& b) { return a.site < b.site; });
}

}  // namespace saddleback::charts
