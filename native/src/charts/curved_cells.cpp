// Within a face the pieces of edges are edges of a triangulation. Triangles that no piece parts are of one cell, that
// on the left or on the right of the pieces around them; so are faces that no edge comes to and their neighbors.

#include "charts/curved_cells.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "charts/edge_pieces.h"
#include "mesh/cutting/constrained_triangulation.h"
#include "support/planar.h"
#include "support/threads/parallel.h"
#include "voronoi2d/diagram/edge_curve.h"

namespace saddleback::charts {
namespace {

/// Cuts one face after another in the same memory.
class FaceCut {
 public:
  FaceCut(const Chart& chart, const Voronoi2d& diagram, const EdgePieces& edges)
      : chart_(chart), diagram_(diagram), edges_(edges) {}

  void cut(Index face, std::vector<FacePiece>& triangles) {
    begin(face);
    for (const Index piece : found_) add_piece(piece);
    if (corners_.size() <= 3 && ways_.empty()) return;
    connect();
    label();
    for (std::size_t t = 0; t < flat_.triangle_count(); ++t) triangles.push_back(triangle(t));
  }

 private:
  /// A part of a piece between two points.
  struct Way {
    Index edge, from, to;
  };
  using Corner = PieceCorner;

  void begin(Index face) {
    face_ = face;
    corners_.clear();
    ways_.clear();
    edges_.find(face, found_);
    if (found_.empty()) return;
    const Vec2* corner = &chart_.corners()[3 * face];
    flat_.begin({corner[0], corner[1], corner[2]});
    for (int k = 0; k < 3; ++k)
      corners_.push_back(
          {{CornerKey::Kind::vertex, chart_.mesh().from(3 * face + k), k_none}, corner[k], k_none, k_none, k_none});
  }

  void add_piece(Index piece) {
    edges_.meet(face_, piece, meetings_);
    Index before = k_none;
    for (const Meeting& meeting : meetings_) {
      const Index point = number(meeting);
      if (before != k_none && before != point) ways_.push_back({edges_.edge(piece), before, point});
      before = point;
    }
  }

  Index number(const Meeting& meeting) {
    if (meeting.corner >= 0) return meeting.corner;
    const Index point = flat_.add(weights(meeting));
    if (point == static_cast<Index>(corners_.size()))
      corners_.push_back({meeting.key, meeting.place, meeting.halfedge, k_none, k_none});
    return point;
  }

  /// Weights of the corners 1 and 2: on a side exactly, else within.
  Vec2 weights(const Meeting& meeting) const {
    const double share = meeting.share;
    if (meeting.halfedge != k_none) {
      const int k = meeting.halfedge % 3;
      return k == 0 ? Vec2(share, 0) : k == 1 ? Vec2(1 - share, share) : Vec2(0, 1 - share);
    }
    constexpr double k_least = 0x1p-50;
    const Vec3 inside = point_at(chart_, face_, meeting.place).barycentric.cwiseMax(k_least);
    return Vec2(inside[1], inside[2]) / inside.sum();
  }

  void connect() {
    std::vector<Way> connected;
    for (const Way& way : ways_)
      if (flat_.connect(way.from, way.to)) connected.push_back(way);
    is_whole_ = connected.size() == ways_.size();
    flat_.improve();
    const std::size_t halfedges = 3 * flat_.triangle_count();
    left_of_.assign(halfedges, k_none);
    right_of_.assign(halfedges, k_none);
    for (const Way& way : connected) {
      mark(way.from, way.to, way.edge, left_of_);
      mark(way.to, way.from, way.edge, right_of_);
    }
  }

  void mark(Index from, Index to, Index edge, std::vector<Index>& marked) {
    along_.clear();
    flat_.edges_along(from, to, along_);
    for (const Index h : along_) {
      if (marked[h] != k_none && marked[h] != edge) is_whole_ = false;
      marked[h] = edge;
    }
  }

  /// Finds the site of each triangle; k_none for all where no piece is a side of one.
  void label() {
    site_.assign(flat_.triangle_count(), k_none);
    is_seen_.assign(flat_.triangle_count(), false);
    for (std::size_t t = 0; t < site_.size(); ++t) {
      if (!is_whole_) gather_all(t);
      if (is_whole_ && is_seen_[t]) continue;
      if (is_whole_) gather(static_cast<Index>(t));
      const Index site = choose();
      for (const Index triangle : part_) site_[triangle] = site;
    }
    if (!is_whole_) mark_between();
  }

  /// Marks edges between triangles of different cells.
  void mark_between() {
    for (Index h = 0; h < static_cast<Index>(left_of_.size()); ++h) {
      if (flat_.twin(h) == k_none) continue;
      left_of_[h] = right_of_[h] = k_none;
      const std::array sites{site_[h / 3], site_[flat_.twin(h) / 3]};
      const auto way =
          std::find_if(ways_.begin(), ways_.end(), [&](const Way& w) { return diagram_.edge_sites[w.edge] == sites; });
      if (way != ways_.end()) left_of_[h] = way->edge;
    }
  }

  /// Takes each triangle for itself where pieces cross or lie on each other, being those of cells narrower than the
  /// tolerance.
  void gather_all(std::size_t t) {
    part_ = {static_cast<Index>(t)};
    sites_.clear();
    for (const Way& way : ways_)
      for (const Index site : diagram_.edge_sites[way.edge]) sites_.push_back(site);
  }

  /// Finds the triangles that no piece parts from one, and the sites that the pieces around say.
  void gather(Index first) {
    part_ = {first};
    sites_.clear();
    is_seen_[first] = true;
    for (std::size_t i = 0; i < part_.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        const Index h = 3 * part_[i] + k, next = flat_.neighbor(part_[i], k);
        if (left_of_[h] != k_none) sites_.push_back(diagram_.edge_sites[left_of_[h]][0]);
        if (right_of_[h] != k_none) sites_.push_back(diagram_.edge_sites[right_of_[h]][1]);
        if (next == k_none || is_seen_[next]) continue;
        is_seen_[next] = true;
        part_.push_back(next);
      }
    }
  }

  /// Returns the site that the pieces say. Where these differ, in cells narrower than the tolerance, it is the one that
  /// no corner or middle of the triangles is much farther from than from the nearest: the narrow cell may be nearest in
  /// the middle of a triangle that reaches far beyond it.
  Index choose() const {
    if (sites_.empty()) return k_none;
    if (std::all_of(sites_.begin(), sites_.end(), [&](Index site) { return site == sites_[0]; })) return sites_[0];
    std::pair<double, Index> best{std::numeric_limits<double>::infinity(), k_none};
    for (const Index site : sites_) best = std::min(best, {largest_lag(site), site});
    return best.second;
  }

  double largest_lag(Index site) const {
    double largest = 0;
    for (const Index t : part_) {
      const Triangle points = flat_.triangle(t);
      const Vec2 &a = corners_[points[0]].place, &b = corners_[points[1]].place, &c = corners_[points[2]].place;
      for (const Vec2& place : {a, b, c, Vec2((a + b + c) / 3)}) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Index other : sites_) nearest = std::min(nearest, distance(place, other));
        largest = std::max(largest, distance(place, site) - nearest);
      }
    }
    return largest;
  }

  double distance(const Vec2& place, Index site) const {
    return (place - diagram_.sites[site]).norm() - diagram_.weights[site];
  }

  FacePiece triangle(std::size_t t) const {
    FacePiece piece{site_[t], {}};
    const Triangle points = flat_.triangle(t);
    for (int k = 0; k < 3; ++k) {
      const auto h = static_cast<Index>(3 * t) + k;
      Corner corner = corners_[points[k]];
      const Index rim = flat_.twin(h) == k_none ? rim_between(points[k], points[(k + 1) % 3]) : k_none;
      const bool is_bare = left_of_[h] == k_none && right_of_[h] == k_none;
      if (rim == k_none || chart_.is_joined(rim)) corner.side = left_of_[h];
      corner.line = is_bare ? rim : k_none;
      piece.corners.push_back(corner);
    }
    return piece;
  }

  /// The face's half-edge that two points lie on, one after the other.
  Index rim_between(Index a, Index b) const {
    if (a >= 3) return corners_[a].halfedge;
    return b >= 3 ? corners_[b].halfedge : 3 * face_ + a;
  }

  const Chart& chart_;
  const Voronoi2d& diagram_;
  const EdgePieces& edges_;
  ConstrainedTriangulation flat_;
  Index face_ = k_none;
  std::vector<Corner> corners_;  ///< by number in the triangulation
  std::vector<Way> ways_;
  std::vector<Meeting> meetings_;
  std::vector<Index> found_, along_, left_of_, right_of_, site_, part_, sites_;
  std::vector<bool> is_seen_;
  bool is_whole_ = true;  ///< no piece crosses another, or lies on it
};

/// Gives sites to faces that no edge parts from their neighbors.
class SiteSpread {
 public:
  SiteSpread(const Chart& chart, CurvedCells& cells) : chart_(chart), cells_(cells) {}

  void spread(const Voronoi2d& diagram, int threads) {
    from_divided();
    fill(0);
    std::vector<Index> begins;
    const std::size_t known = reached_.size();
    for (Index f = 0; f < chart_.mesh().face_count(); ++f) {
      if (!is_open(f)) continue;
      begins.push_back(f);
      cells_.face_site[f] = static_cast<Index>(begins.size()) - 1;
      reached_.push_back(f);
      fill(reached_.size() - 1);
    }
    name(diagram, known, begins, threads);
    for (std::size_t f = 0; f < cells_.pieces.size(); ++f)
      for (FacePiece& piece : cells_.pieces[f])
        if (piece.site == k_none) piece.site = cells_.face_site[f];
  }

 private:
  bool is_open(Index face) const {
    const std::vector<FacePiece>& pieces = cells_.pieces[face];
    return cells_.face_site[face] == k_none && (pieces.empty() || pieces[0].site == k_none);
  }

  void reach(Index halfedge, Index site) {
    if (halfedge == k_none || !chart_.is_joined(halfedge)) return;
    const Index face = Mesh::face_of(chart_.mesh().twin(halfedge));
    if (!is_open(face)) return;
    cells_.face_site[face] = site;
    reached_.push_back(face);
  }

  void from_divided() {
    for (const std::vector<FacePiece>& pieces : cells_.pieces)
      for (const FacePiece& piece : pieces)
        for (const PieceCorner& corner : piece.corners)
          if (piece.site != k_none) reach(corner.line, piece.site);
  }

  void fill(std::size_t begin) {
    for (std::size_t i = begin; i < reached_.size(); ++i)
      for (Index h = 3 * reached_[i]; h < 3 * reached_[i] + 3; ++h) reach(h, cells_.face_site[reached_[i]]);
  }

  /// Gives what no edge comes to at all the site nearest to any of its faces.
  void name(const Voronoi2d& diagram, std::size_t known, const std::vector<Index>& begins, int threads) {
    std::vector<Vec2> middles;
    for (const Index face : begins) {
      const Vec2* corner = &chart_.corners()[3 * face];
      middles.emplace_back((corner[0] + corner[1] + corner[2]) / 3);
    }
    const std::vector<Index> sites = diagram.locate(middles, threads);
    for (std::size_t i = known; i < reached_.size(); ++i) {
      Index& site = cells_.face_site[reached_[i]];
      site = sites[site];
    }
  }

  const Chart& chart_;
  CurvedCells& cells_;
  std::vector<Index> reached_;
};

}  // namespace

CurvedCells divide_faces(const Chart& chart, const Voronoi2d& diagram, double tolerance, int threads,
                         const JobStage& stage) {
  const Index face_count = chart.mesh().face_count();
  const EdgePieces edges(chart, diagram, tolerance, stage);
  stage.update(0.2);
  CurvedCells cells{std::vector<Index>(face_count, k_none), std::vector<std::vector<FacePiece>>(face_count)};
  constexpr Index k_block = 1024;
  const Index block_count = (face_count + k_block - 1) / k_block;
  parallel_for(block_count, threads, 1, [&](Index block, int) {
    FaceCut faces(chart, diagram, edges);
    for (Index f = block * k_block; f < std::min(face_count, (block + 1) * k_block); ++f) {
      stage.check();
      faces.cut(f, cells.pieces[f]);
    }
    stage.update(0.2 + 0.7 * block / block_count);
  });
  SiteSpread(chart, cells).spread(diagram, threads);
  stage.update(1);
  return cells;
}

}  // namespace saddleback::charts
