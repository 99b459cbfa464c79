#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <unordered_map>

#include "saddleback/charts/lifted_voronoi.h"
#include "saddleback/error.h"

#include "charts/curved_cells.h"
#include "charts/face_cells.h"
#include "support/threads/parallel.h"
#include "tessellation/cells/split_mesh.h"

namespace saddleback {
namespace {

using charts::CornerKey;
using charts::FacePiece;
using charts::PieceCorner;

struct KeyHash {
  std::size_t operator()(const CornerKey& key) const {
    const std::uint64_t a = static_cast<std::uint32_t>(key.a), b = static_cast<std::uint32_t>(key.b);
    return ((a << 32 | b) + static_cast<std::uint64_t>(key.kind)) * 0x9E3779B97F4A7C15ull >> 7;
  }
};

Vec3 barycentric_of(const Chart& chart, Index face, const PieceCorner& corner) {
  if (corner.key.kind == CornerKey::Kind::vertex) {
    const Triangle& t = chart.mesh().triangles()[face];
    return Vec3::Unit(std::find(t.begin(), t.end(), corner.key.a) - t.begin());
  }
  if (corner.halfedge == k_none) return point_at(chart, face, corner.place).barycentric;
  const Vec2 &a = chart.corners()[corner.halfedge], &b = chart.corners()[Mesh::next(corner.halfedge)];
  const double share = std::clamp((corner.place - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  Vec3 result = Vec3::Zero();
  result[corner.halfedge % 3] = 1 - share;
  result[(corner.halfedge + 1) % 3] = share;
  return result;
}

/// Collects the pieces of one face after another.
class Builder {
 public:
  Builder(const Chart& chart, const Voronoi2d& diagram) : chart_(chart), diagram_(diagram) {
    const std::size_t count = diagram.sites.size();
    out_.areas.assign(count, 0);
    out_.centroids.assign(count, Vec2::Zero());
    out_.face_cell.assign(chart.mesh().face_count(), k_none);
  }

  void add_face(Index face, Index site, const std::vector<FacePiece>& pieces) {
    if (pieces.empty() || (pieces.size() == 1 && !is_curved_)) {
      if (!pieces.empty()) site = pieces[0].site;
      out_.face_cell[face] = site;
      const Vec2* corner = &chart_.corners()[3 * face];
      add_area(site, chart_.mesh().face_area(face), (corner[0] + corner[1] + corner[2]) / 3);
      return;
    }
    face_sides_.clear();
    for (const FacePiece& piece : pieces) add_piece(face, piece);
    add_segments();
  }

  LiftedVoronoi finish() {
    if (!is_curved_) find_edges_along_mesh_edges();
    for (std::size_t i = 0; i < out_.areas.size(); ++i) out_.centroids[i] /= out_.areas[i];  // 0 / 0 where it is none
    chain_edges();
    return std::move(out_);
  }

 private:
  struct Segment {
    Index edge, from, to;
  };
  /// A side of a piece along an edge of the diagram, in the edge's direction.
  struct FaceSide {
    Index edge;
    bool is_left;  ///< of the cell on the edge's left
    Index from, to;
  };
  /// A side of a piece, or of a whole face, along a mesh edge, in the direction of the half-edge that speaks for it.
  struct EdgeSide {
    Index halfedge;
    bool is_right;  ///< of the face on the other side
    double begin, end;
    Index from, to, site;
  };

  void add_area(Index site, double area, const Vec2& middle) {
    out_.areas[site] += area;
    out_.centroids[site] += area * middle;
  }

  void add_piece(Index face, const FacePiece& piece) {
    const auto count = static_cast<Index>(piece.corners.size());
    const auto first = static_cast<Index>(out_.piece_vertices.size());
    out_.pieces.push_back({face, piece.site, first, count});
    for (const PieceCorner& corner : piece.corners) {
      const Vec3 barycentric = barycentric_of(chart_, face, corner);
      out_.piece_vertices.push_back(number(face, corner, barycentric));
      out_.piece_barycentric.push_back(barycentric);
    }
    const Index* vertex = &out_.piece_vertices[first];
    for (Index i = 0; i < count; ++i) {
      const Index edge = piece.corners[i].side, from = vertex[i], to = vertex[(i + 1) % count];
      if (is_curved_) {
        if (edge != k_none) add_segment(edge, from, to);
      } else if (edge == k_none) {
        add_edge_side(piece.corners[i].line, piece.corners[i].place, piece.corners[(i + 1) % count].place, from, to,
                      piece.site);
      } else if (diagram_.edge_sites[edge][0] == piece.site) {
        face_sides_.push_back({edge, true, from, to});
      } else {
        face_sides_.push_back({edge, false, to, from});
      }
    }
    const Vec3* corner = &out_.piece_barycentric[first];
    for (Index i = 1; i + 1 < count; ++i) {
      const double share = corner[0].dot(corner[i].cross(corner[i + 1]));
      const Vec2 middle = (piece.corners[0].place + piece.corners[i].place + piece.corners[i + 1].place) / 3;
      add_area(piece.site, std::max(share, 0.0) * chart_.mesh().face_area(face), middle);
    }
  }

  void add_edge_side(Index h, const Vec2& begin, const Vec2& end, Index from, Index to, Index site) {
    if (!chart_.is_joined(h)) return;
    const Index twin = chart_.mesh().twin(h), speaker = std::min(h, twin);
    const Vec2 &a = chart_.corners()[speaker], along = chart_.corners()[Mesh::next(speaker)] - a;
    EdgeSide side{speaker, h != speaker, (begin - a).dot(along), (end - a).dot(along), from, to, site};
    if (side.is_right) {
      std::swap(side.begin, side.end);
      std::swap(side.from, side.to);
    }
    edge_sides_.push_back(side);
  }

  /// An edge of the diagram that lies on a mesh edge crosses no face: it is where the cells on both sides differ.
  void find_edges_along_mesh_edges() {
    const Mesh& mesh = chart_.mesh();
    for (Index h = 0; h < mesh.halfedge_count(); ++h) {
      const Index cell = out_.face_cell[Mesh::face_of(h)];
      if (cell == k_none || !chart_.is_joined(h) || out_.face_cell[Mesh::face_of(mesh.twin(h))] == cell) continue;
      add_edge_side(h, chart_.corners()[h], chart_.corners()[Mesh::next(h)], mesh.from(h), mesh.to(h), cell);
    }
    std::sort(edge_sides_.begin(), edge_sides_.end(), [](const EdgeSide& a, const EdgeSide& b) {
      return std::tie(a.halfedge, a.is_right, a.begin, a.end) < std::tie(b.halfedge, b.is_right, b.begin, b.end);
    });
    for (std::size_t begin = 0, end = 0; begin < edge_sides_.size(); begin = end) {
      std::size_t right = begin;
      while (end < edge_sides_.size() && edge_sides_[end].halfedge == edge_sides_[begin].halfedge)
        right += !edge_sides_[end++].is_right;
      compare_sides(begin, right, end);
    }
  }

  /// Sides [left, right) of one face and [right, end) of the other, each in order along the mesh edge.
  void compare_sides(std::size_t left, std::size_t right, std::size_t end) {
    for (std::size_t i = left, j = right; i < right && j < end;) {
      const EdgeSide &a = edge_sides_[i], &b = edge_sides_[j];
      const Index from = a.begin >= b.begin ? a.from : b.from, to = a.end <= b.end ? a.to : b.to;
      if (a.site != b.site && from != to && std::max(a.begin, b.begin) < std::min(a.end, b.end))
        add_edge_between(a.site, b.site, from, to);
      const bool leaves_both = a.to == b.to;
      if (leaves_both || a.end <= b.end) ++i;
      if (leaves_both || b.end <= a.end) ++j;
    }
  }

  void add_edge_between(Index left, Index right, Index from, Index to) {
    for (const Index edge : diagram_.cell_edges(left)) {
      const std::array<Index, 2>& sites = diagram_.edge_sites[edge];
      if (sites == std::array{left, right}) add_segment(edge, from, to);
      if (sites == std::array{right, left}) add_segment(edge, to, from);
    }
  }

  /// Adds the segments between cells. Both cells agree on their common side; where rounding left only one of them, that
  /// one counts.
  void add_segments() {
    std::sort(face_sides_.begin(), face_sides_.end(), [](const FaceSide& a, const FaceSide& b) {
      return std::pair(a.edge, !a.is_left) < std::pair(b.edge, !b.is_left);
    });
    for (std::size_t i = 0; i < face_sides_.size(); ++i) {
      const FaceSide& side = face_sides_[i];
      if (i == 0 || face_sides_[i - 1].edge != side.edge) add_segment(side.edge, side.from, side.to);
    }
  }

  void add_segment(Index edge, Index from, Index to) { segments_.push_back({edge, on_edge(from), on_edge(to)}); }

  Index number(Index face, const PieceCorner& corner, const Vec3& barycentric) {
    if (corner.key.kind == CornerKey::Kind::vertex) return corner.key.a;
    const auto [place, is_new] = numbers_.try_emplace(corner.key, static_cast<Index>(out_.points.size()));
    if (is_new) add_point({face, barycentric});
    return chart_.mesh().vertex_count() + place->second;
  }

  void add_point(const SurfacePoint& point) {
    out_.points.push_back(point);
    out_.positions.push_back(position(chart_.mesh(), point));
  }

  /// The point for a vertex of pieces: mesh vertices get one when an edge comes by.
  Index on_edge(Index vertex) {
    const Index vertex_count = chart_.mesh().vertex_count();
    if (vertex >= vertex_count) return vertex - vertex_count;
    const CornerKey key{CornerKey::Kind::vertex, vertex, k_none};
    const auto [place, is_new] = numbers_.try_emplace(key, static_cast<Index>(out_.points.size()));
    if (is_new) add_point(at_vertex(chart_.mesh(), vertex));
    return place->second;
  }

  void chain_edges() {
    std::stable_sort(segments_.begin(), segments_.end(),
                     [](const Segment& a, const Segment& b) { return a.edge < b.edge; });
    out_.edge_offsets.push_back(0);
    std::unordered_map<Index, std::size_t> leaving;
    for (std::size_t begin = 0, end = 0; begin < segments_.size(); begin = end) {
      leaving.clear();
      while (end < segments_.size() && segments_[end].edge == segments_[begin].edge) ++end;
      std::vector<Index> targets;
      for (std::size_t i = begin; i < end; ++i) {
        leaving.emplace(segments_[i].from, i);
        targets.push_back(segments_[i].to);
      }
      std::sort(targets.begin(), targets.end());
      for (std::size_t i = begin; i < end; ++i)
        if (!std::binary_search(targets.begin(), targets.end(), segments_[i].from)) add_polyline(i, leaving);
    }
  }

  void add_polyline(std::size_t segment, std::unordered_map<Index, std::size_t>& leaving) {
    const Index edge = segments_[segment].edge;
    out_.edge_points.push_back(segments_[segment].from);
    for (auto next = leaving.find(segments_[segment].from); next != leaving.end();) {
      const Index to = segments_[next->second].to;
      leaving.erase(next);  // never twice, whatever rounding did
      out_.edge_points.push_back(to);
      next = leaving.find(to);
    }
    const auto begin = out_.edge_points.begin() + out_.edge_offsets.back();
    const auto place = [&](Index point) { return out_.positions[point]; };
    if (std::all_of(begin, out_.edge_points.end(), [&](Index point) { return place(point) == place(*begin); }))
      return out_.edge_points.resize(out_.edge_offsets.back());  // rounding left it no length
    out_.edge_offsets.push_back(static_cast<Index>(out_.edge_points.size()));
    out_.edge_of.push_back(edge);
    out_.edge_cells.push_back(diagram_.edge_sites[edge]);
  }

  const Chart& chart_;
  const Voronoi2d& diagram_;
  const bool is_curved_ = !diagram_.weights.empty();
  LiftedVoronoi out_;
  std::unordered_map<CornerKey, Index, KeyHash> numbers_;
  std::vector<Segment> segments_;
  std::vector<FaceSide> face_sides_;  ///< of the face at hand
  std::vector<EdgeSide> edge_sides_;
};

std::vector<Index> sites_of_faces(const Chart& chart, const Voronoi2d& diagram, int threads, const JobStage& stage) {
  std::vector<Vec2> middles(chart.mesh().face_count());
  for (Index f = 0; f < chart.mesh().face_count(); ++f) {
    const Vec2* corner = &chart.corners()[3 * f];
    middles[f] = (corner[0] + corner[1] + corner[2]) / 3;
  }
  stage.check();
  return diagram.locate(middles, threads);
}

LiftedVoronoi lift_curved(const Chart& chart, const Voronoi2d& diagram, const LiftOptions& options,
                          const JobStage& stage) {
  constexpr double k_usual = 1e-3, k_finest = 0x1p-28;  // as of cells that are clipped
  const double width = std::sqrt(chart.area() / static_cast<double>(diagram.cell_sites.size()));
  const double tolerance = options.tolerance > 0 ? std::max(options.tolerance, k_finest * width) : k_usual * width;
  const charts::CurvedCells cells =
      charts::divide_faces(chart, diagram, tolerance, options.threads, stage.part(0, 0.8));
  Builder builder(chart, diagram);
  for (Index f = 0; f < chart.mesh().face_count(); ++f) {
    stage.check();
    builder.add_face(f, cells.face_site[f], cells.pieces[f]);
  }
  stage.update(0.9);
  LiftedVoronoi result = builder.finish();
  stage.update(1);
  return result;
}

}  // namespace

LiftedVoronoi lift(const Chart& chart, const Voronoi2d& diagram, const LiftOptions& options, Job* job) {
  if (diagram.sites.empty()) throw InputError("diagram: it has no sites");
  if (!(options.tolerance >= 0))
    throw InputError(message("tolerance: wanted a length of 0 or more, got ", options.tolerance));
  const JobStage stage(job, "Lifting the diagram");
  if (!diagram.weights.empty()) return lift_curved(chart, diagram, options, stage);
  const int threads = options.threads;
  const Index face_count = chart.mesh().face_count();
  const std::vector<Index> face_site = sites_of_faces(chart, diagram, threads, stage);
  stage.update(0.2);
  Builder builder(chart, diagram);
  constexpr Index k_block = 4096;  // pieces are kept for a block at a time and then numbered in order
  std::vector<std::vector<FacePiece>> pieces(std::min(face_count, k_block));
  for (Index begin = 0; begin < face_count; begin += k_block) {
    const Index size = std::min(k_block, face_count - begin);
    parallel_for(size, threads, 16, [&](Index i, int) {
      stage.check();
      charts::divide_face(chart, diagram, begin + i, face_site[begin + i], pieces[i]);
    });
    for (Index i = 0; i < size; ++i) builder.add_face(begin + i, face_site[begin + i], pieces[i]);
    stage.update(0.2 + 0.7 * (begin + size) / face_count);
  }
  LiftedVoronoi result = builder.finish();
  stage.update(1);
  return result;
}

std::vector<Index> LiftedVoronoi::locate(const Mesh& mesh, const SurfacePoints& where) const {
  check_surface_points(mesh, where, "points");
  const auto depth = [&](const Piece& piece, const Vec3& point) {
    double least = std::numeric_limits<double>::infinity();
    const Vec3* corner = &piece_barycentric[piece.first];
    for (Index i = 0; i < piece.count; ++i)
      least = std::min(least, point.dot(corner[i].cross(corner[(i + 1) % piece.count])));
    return least;
  };
  std::vector<Index> cells;
  cells.reserve(where.size());
  for (const SurfacePoint& point : where) {
    Index cell = face_cell[point.face];
    double deepest = -std::numeric_limits<double>::infinity();
    auto piece = std::lower_bound(pieces.begin(), pieces.end(), point.face,
                                  [](const Piece& p, Index face) { return p.face < face; });
    for (; piece != pieces.end() && piece->face == point.face; ++piece) {
      const double here = depth(*piece, point.barycentric);
      if (here > deepest) deepest = here, cell = piece->cell;
    }
    cells.push_back(cell);
  }
  return cells;
}

SplitMesh LiftedVoronoi::split(const Mesh& mesh) const {
  return split_mesh(mesh, {positions, face_cell, pieces, piece_vertices, piece_barycentric});
}

}  // namespace saddleback
