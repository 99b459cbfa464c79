// The public diagram from the cell complex: areas, boundaries chained into polylines, branch points, the split mesh.

#include "saddleback/tessellation/geodesic_voronoi.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "saddleback/error.h"

#include "geodesics/queries/point_targets.h"
#include "tessellation/cells/split_mesh.h"
#include "tessellation/relaxation/diagram.h"

namespace saddleback {
namespace {

/// Twice the signed area, as a share of the face, of a triangle given in barycentric coordinates.
double double_area(const Vec3& a, const Vec3& b, const Vec3& c) { return a.dot(b.cross(c)); }

std::vector<double> cell_areas(const CellComplex& complex) {
  const FaceTable& table = complex.table();
  std::vector<double> areas(complex.site_count(), 0);
  for (Index f = 0; f < table.face_count(); ++f) {
    if (complex.face_site(f) != k_none) areas[complex.face_site(f)] += table.areas[f];
  }
  for (const CellComplex::Piece& piece : complex.pieces()) {
    const Vec3* corner = &complex.loop_barycentric()[piece.first];
    double share = 0;
    for (Index i = 1; i + 1 < piece.count; ++i) share += double_area(corner[0], corner[i], corner[i + 1]);
    areas[piece.site] += share * table.areas[piece.face];
  }
  return areas;
}

/// A straight bit of the boundary between two cells inside one face; points count from 0.
struct Segment {
  Index from, to;
  Index left, right;
};

std::vector<Segment> find_segments(const CellComplex& complex) {
  struct Side {
    Index from, to, site;
  };
  const Index first_point = complex.table().vertex_count;
  std::vector<Segment> segments;
  std::vector<Side> sides;
  const auto& pieces = complex.pieces();
  for (std::size_t begin = 0, end = 0; begin < pieces.size(); begin = end) {
    sides.clear();
    for (; end < pieces.size() && pieces[end].face == pieces[begin].face; ++end) {
      const Index* loop = &complex.loop()[pieces[end].first];
      for (Index i = 0; i < pieces[end].count; ++i)
        sides.push_back({loop[i], loop[(i + 1) % pieces[end].count], pieces[end].site});
    }
    for (const Side& a : sides) {
      if (a.from > a.to) continue;
      for (const Side& b : sides) {
        if (b.from != a.to || b.to != a.from || b.site == a.site) continue;
        if (a.from < first_point)  // rather than write to where no point is
          throw std::logic_error(message("cells ", a.site, " and ", b.site, " meet in vertex ", a.from));
        segments.push_back({a.from - first_point, a.to - first_point, a.site, b.site});
      }
    }
  }
  return segments;
}

/// Chains segments into polylines that end at branch points or at the mesh's boundary, or are closed.
class Chains {
 public:
  Chains(const std::vector<Segment>& segments, std::size_t point_count, GeodesicVoronoi& out)
      : segments_(segments),
        used_(segments.size(), 0),
        first_(point_count + 1, 0),
        at_(2 * segments.size()),
        out_(out) {
    for (const Segment& s : segments) ++first_[s.from + 1], ++first_[s.to + 1];
    for (std::size_t i = 0; i < point_count; ++i) first_[i + 1] += first_[i];
    std::vector<Index> cursor(first_.begin(), first_.end() - 1);
    for (Index i = 0; i < static_cast<Index>(segments.size()); ++i) {
      at_[cursor[segments[i].from]++] = i;
      at_[cursor[segments[i].to]++] = i;
    }
    out_.edge_offsets.push_back(0);
    const auto count = static_cast<Index>(point_count);
    for (Index point = 0; point < count; ++point) {
      if (degree(point) > 2) out_.branch_points.push_back(point);
      if (degree(point) != 2) follow_all(point, false);
    }
    for (Index point = 0; point < count; ++point) follow_all(point, true);
  }

 private:
  Index degree(Index point) const { return first_[point + 1] - first_[point]; }

  void follow_all(Index point, bool closed) {
    for (Index i = first_[point]; i < first_[point + 1]; ++i) {
      if (!used_[at_[i]]) follow(point, at_[i], closed);
    }
  }

  void follow(Index start, Index segment, bool closed) {
    const bool forward = segments_[segment].from == start;
    out_.edge_cells.push_back(forward ? std::array{segments_[segment].left, segments_[segment].right}
                                      : std::array{segments_[segment].right, segments_[segment].left});
    out_.edge_closed.push_back(closed);
    out_.edge_points.push_back(start);
    Index point = start;
    while (segment != k_none) {
      used_[segment] = 1;
      point = segments_[segment].from == point ? segments_[segment].to : segments_[segment].from;
      out_.edge_points.push_back(point);
      segment = degree(point) == 2 ? unused_at(point) : k_none;
    }
    out_.edge_offsets.push_back(static_cast<Index>(out_.edge_points.size()));
  }

  Index unused_at(Index point) const {
    for (Index i = first_[point]; i < first_[point + 1]; ++i) {
      if (!used_[at_[i]]) return at_[i];
    }
    return k_none;
  }

  const std::vector<Segment>& segments_;
  std::vector<std::uint8_t> used_;
  std::vector<Index> first_, at_;  ///< segments at each point
  GeodesicVoronoi& out_;
};

void copy_candidates(const FaceCandidates& candidates, GeodesicVoronoi& out) {
  out.face_candidates.assign(1, 0);
  for (Index face = 0; face < candidates.table().face_count(); ++face) {
    if (const Index shared = candidates.shared_index(face); shared != k_none) {
      for (const FaceCandidate& candidate : candidates.candidates(shared)) {
        out.candidates.push_back({candidate.site, candidate.squared_distance});
      }
    }
    out.face_candidates.push_back(static_cast<Index>(out.candidates.size()));
  }
}

/// Returns by how much the squared distance to a point of a face is below the interpolation of its values at the
/// corners.
double bulge_at(const Mesh& mesh, const SurfacePoint& point) {
  double bulge = 0;
  for (int i = 0; i < 3; ++i) {
    const double side = mesh.length(3 * point.face + i);
    bulge += point.barycentric[i] * point.barycentric[(i + 1) % 3] * side * side;
  }
  return bulge;
}

/// The candidate that is least at a point, and the distance that it tells: the face's interpolation of squared
/// distances.
CellAt candidate_at(const GeodesicVoronoi& cells, const Mesh& mesh, const SurfacePoint& point) {
  const auto at_point = [&](const std::array<double, 3>& squared) {
    return squared[0] * point.barycentric[0] + squared[1] * point.barycentric[1] + squared[2] * point.barycentric[2];
  };
  CellAt result{cells.face_cell[point.face], 0};
  double least = std::numeric_limits<double>::infinity();
  if (result.cell != k_none) {
    const Triangle& t = mesh.triangles()[point.face];
    std::array<double, 3> squared;
    for (int i = 0; i < 3; ++i) squared[i] = cells.vertex_distance[t[i]] * cells.vertex_distance[t[i]];
    least = at_point(squared);
  }
  for (Index i = cells.face_candidates[point.face]; i < cells.face_candidates[point.face + 1]; ++i) {
    const double squared = at_point(cells.candidates[i].squared_distance);
    if (squared < least) least = squared, result.cell = cells.candidates[i].cell;
  }
  result.distance = std::sqrt(std::max(0.0, least - bulge_at(mesh, point)));
  return result;
}

/// The shortest way to a site that leads straight to a corner of the face; from a vertex, its own.
double way_over_corner(const GeodesicVoronoi& cells, const Mesh& mesh, const SurfacePoint& point) {
  if (const Index vertex = vertex_at(mesh, point); vertex != k_none) return cells.vertex_distance[vertex];
  const FaceChart chart(mesh, point.face);
  double shortest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    Vec2 way = Vec2::Zero();  // from differences, which know no rounding of places far from the origin
    for (int k = 0; k < 3; ++k) way += point.barycentric[k] * (chart.corner[k] - chart.corner[i]);
    shortest = std::min(shortest, cells.vertex_distance[mesh.triangles()[point.face][i]] + way.norm());
  }
  return shortest;
}

/// Returns the sites that may be seen straight from a place by a shorter way than the one known: those that are nearer
/// as the bird flies, whether or not they own something near there.
std::vector<Index> sites_in_reach(const GeodesicVoronoi& cells, const Mesh& mesh, const SurfacePoints& places,
                                  std::span<const double> known) {
  constexpr double k_bird = 1 + 1e-12;
  std::vector<Vec3> positions;
  Eigen::AlignedBox3d box;
  for (const SurfacePoint& site : cells.sites) box.extend(positions.emplace_back(position(mesh, site)));
  Index axis = 0;
  box.sizes().maxCoeff(&axis);
  std::vector<std::pair<double, Index>> along;
  for (std::size_t i = 0; i < positions.size(); ++i) along.emplace_back(positions[i][axis], static_cast<Index>(i));
  std::ranges::sort(along);
  std::vector<std::uint8_t> is_in_reach(positions.size(), 0);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3 place = position(mesh, places[i]);
    const double reach = mesh.in_space(known[i] * k_bird);
    auto site = std::ranges::lower_bound(along, std::pair(place[axis] - reach, Index(0)));
    for (; site != along.end() && site->first <= place[axis] + reach; ++site)
      is_in_reach[site->second] |= (positions[site->second] - place).norm() <= reach;
  }
  std::vector<Index> sites;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (is_in_reach[i]) sites.push_back(static_cast<Index>(i));
  return sites;
}

}  // namespace

Index GeodesicVoronoi::cell_at(const Mesh& mesh, const SurfacePoint& point) const {
  return exact_field ? exact_sites[exact_field->nearest_at(point).source] : candidate_at(*this, mesh, point).cell;
}

std::vector<CellAt> GeodesicVoronoi::locate(const SaddleVertexGraph& graph, const SurfacePoints& places,
                                            Job* job) const {
  const JobStage stage(job, "Locating points");
  const Mesh& mesh = graph.mesh();
  check_surface_points(mesh, places, "points");
  std::vector<CellAt> result;
  if (exact_field) {
    for (const SurfacePoint& place : places) {
      stage.check();
      const ExactField::Sight sight = exact_field->nearest_at(place);
      result.push_back({exact_sites[sight.source], sight.distance});
    }
    return result;
  }
  std::vector<double> known;
  for (const SurfacePoint& place : places) {
    if (result.size() % 256 == 0) stage.check();
    result.push_back({candidate_at(*this, mesh, place).cell, 0});
    known.push_back(way_over_corner(*this, mesh, place));
  }
  SurfacePoints rival_sites;
  for (const Index rival : sites_in_reach(*this, mesh, places, known)) rival_sites.push_back(sites[rival]);
  const std::vector<PointFan> fans = find_fans(graph, rival_sites, stage.part(0, 0.2));
  known = distances_at(
      graph, rival_sites, fans, [&](Index vertex) { return vertex_distance[vertex]; }, places, std::move(known),
      stage.part(0.2, 1));
  for (std::size_t i = 0; i < places.size(); ++i) result[i].distance = known[i];
  stage.update(1);
  return result;
}

GeodesicVoronoi geodesic_voronoi(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                                 const GeodesicVoronoiOptions& options, Job* job) {
  check_sites(graph.mesh(), sites);
  return find_cells(graph, sites, options.threads, options.cuda_device, JobStage(job, "Finding cells"));
}

GeodesicVoronoi find_cells(const SaddleVertexGraph& graph, const SurfacePoints& sites, int threads, int cuda_device,
                           const JobStage& stage) {
  const VertexRings rings(graph, threads);
  CellCandidates cells(graph, rings, CellLengths::of_ways, threads, cuda_device);
  cells.find(sites, stage.part(0.05, 0.7));
  const CandidatesOfCells candidates(cells);
  GeodesicVoronoi result =
      make_diagram(graph.mesh(), CellComplex(candidates, threads, stage.part(0.7, 0.9)), sites, stage);
  stage.update(1);
  return result;
}

GeodesicVoronoi make_diagram(const Mesh& mesh, const CellComplex& complex, const SurfacePoints& sites,
                             const JobStage& stage) {
  GeodesicVoronoi result = subdivision(complex, sites, stage);
  copy_candidates(complex.candidates(), result);
  for (const SurfacePoint& point : result.points) {
    result.positions.push_back(position(mesh, point));
    result.point_distance.push_back(candidate_at(result, mesh, point).distance);
  }
  return result;
}

GeodesicVoronoi subdivision(const CellComplex& complex, const SurfacePoints& sites, const JobStage& stage) {
  GeodesicVoronoi result;
  result.sites = sites;
  result.vertex_cell = complex.vertex_site();
  result.vertex_distance = complex.vertex_distance();
  stage.check();
  result.areas = cell_areas(complex);
  result.points = complex.added();
  const std::vector<Segment> segments = find_segments(complex);
  stage.check();
  const Chains chains(segments, result.points.size(), result);
  stage.check();
  result.face_cell.resize(complex.table().face_count());
  for (Index f = 0; f < complex.table().face_count(); ++f) result.face_cell[f] = complex.face_site(f);
  for (const CellComplex::Piece& piece : complex.pieces()) {
    result.pieces.push_back({piece.face, piece.site, piece.first, piece.count});
  }
  result.piece_vertices = complex.loop();
  result.piece_barycentric = complex.loop_barycentric();
  return result;
}

std::vector<Index> GeodesicVoronoi::corners(Index cell) const {
  if (cell < 0 || cell >= static_cast<Index>(areas.size())) {
    throw InputError(message("cell: wanted 0 to ", areas.size() - 1, ", got ", cell));
  }
  // The polylines with the cell on their left lead once round each of its boundaries.
  struct Arc {
    Index start, end;
  };
  std::vector<Arc> arcs;
  for (std::size_t i = 0; i < edge_cells.size(); ++i) {
    if (edge_closed[i]) continue;
    const Index start = edge_points[edge_offsets[i]], end = edge_points[edge_offsets[i + 1] - 1];
    if (edge_cells[i][0] == cell) arcs.push_back({start, end});
    if (edge_cells[i][1] == cell) arcs.push_back({end, start});
  }
  std::vector<Index> result;
  while (!arcs.empty()) {
    // Begin where no other polyline leads, at the mesh's boundary; anywhere when the cell does not touch it.
    const auto leads_in = [&](const Arc& arc) {
      return std::any_of(arcs.begin(), arcs.end(), [&](const Arc& other) { return other.end == arc.start; });
    };
    auto arc = std::find_if_not(arcs.begin(), arcs.end(), leads_in);
    if (arc == arcs.end()) arc = arcs.begin();
    const Index begin = arc->start;
    Index end = begin;
    while (arc != arcs.end()) {
      result.push_back(arc->start);
      end = arc->end;
      arcs.erase(arc);
      arc = std::find_if(arcs.begin(), arcs.end(), [&](const Arc& other) { return other.start == end; });
    }
    if (end != begin) result.push_back(end);
  }
  return result;
}

SplitMesh GeodesicVoronoi::split(const Mesh& mesh) const {
  return split_mesh(mesh, {positions, face_cell, pieces, piece_vertices, piece_barycentric});
}

}  // namespace saddleback
