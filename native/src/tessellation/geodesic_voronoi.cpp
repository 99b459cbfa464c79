// The public diagram from the cell complex: areas, boundaries chained into polylines, branch points, the split mesh.

#include "saddleback/tessellation/geodesic_voronoi.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>

#include "saddleback/error.h"

#include "geodesics/queries/point_targets.h"
#include "support/threads/parallel.h"
#include "tessellation/cells/cell_complex.h"
#include "tessellation/cells/split_mesh.h"
#include "tessellation/relaxation/diagram.h"

namespace saddleback {
namespace {

/// Twice the signed area, as a share of the face, of a triangle given in barycentric coordinates.
double double_area(const Vec3& a, const Vec3& b, const Vec3& c) { return a.dot(b.cross(c)); }

/// Areas of each cell are added face after face, whatever the number of threads.
std::vector<double> cell_areas(const FaceTable& table, const GeodesicVoronoi& cells, int threads) {
  constexpr Index k_least_part = 64;  // cells: each thread looks at all faces
  const auto site_count = static_cast<Index>(cells.sites.size());
  const Index parts = std::clamp(site_count / k_least_part, 1, thread_count(threads));
  const auto end = [&](Index part) { return static_cast<Index>(std::int64_t{site_count} * part / parts); };
  std::vector<double> areas(site_count, 0);
  parallel_for(parts, threads, 1, [&](Index part, int) {
    const Index first = end(part), last = end(part + 1);
    const auto is_own = [&](Index cell) { return cell >= first && cell < last; };
    for (Index face = 0; face < table.face_count(); ++face)
      if (const Index cell = cells.face_cell[face]; is_own(cell)) areas[cell] += table.areas[face];
    for (const GeodesicVoronoi::Piece& piece : cells.pieces) {
      if (!is_own(piece.cell)) continue;
      const Vec3* corner = &cells.piece_barycentric[piece.first];
      double share = 0;
      for (Index i = 1; i + 1 < piece.count; ++i) share += double_area(corner[0], corner[i], corner[i + 1]);
      areas[piece.cell] += share * table.areas[piece.face];
    }
  });
  return areas;
}

/// A straight bit of the boundary between two cells inside one face; points count from 0.
struct Segment {
  Index from, to;
  Index left, right;
};

struct PieceSide {
  Index from, to, cell;
};

/// Appends the segments between the pieces of a face, given by their sides.
void add_segments(std::span<const PieceSide> sides, Index first_point, const JobStage& stage,
                  std::vector<Segment>& segments) {
  for (const PieceSide& a : sides) {
    stage.check();
    if (a.from > a.to) continue;
    for (const PieceSide& b : sides) {
      if (b.from != a.to || b.to != a.from || b.cell == a.cell) continue;
      if (a.from < first_point)  // rather than write to where no point is
        throw std::logic_error(message("cells ", a.cell, " and ", b.cell, " meet in vertex ", a.from));
      segments.push_back({a.from - first_point, a.to - first_point, a.cell, b.cell});
    }
  }
}

std::vector<Segment> find_segments(const GeodesicVoronoi& cells, Index first_point, int threads,
                                   const JobStage& stage) {
  constexpr Index k_block = 512;  // pieces; each begins with the first whole face
  const std::span<const GeodesicVoronoi::Piece> pieces = cells.pieces;
  const auto count = static_cast<Index>(pieces.size()), blocks = (count + k_block - 1) / k_block;
  const auto begin_of = [&](Index block) {
    Index begin = std::min(block * k_block, count);
    while (begin > 0 && begin < count && pieces[begin].face == pieces[begin - 1].face) ++begin;
    return begin;
  };
  std::vector<std::vector<Segment>> of_blocks(blocks);
  parallel_for(blocks, threads, 1, [&](Index block, int) {
    std::vector<PieceSide> sides;
    std::vector<Segment> segments;
    const Index last = begin_of(block + 1);
    for (Index begin = begin_of(block), end = begin; begin < last; begin = end) {
      sides.clear();
      for (; end < last && pieces[end].face == pieces[begin].face; ++end) {
        const Index* loop = &cells.piece_vertices[pieces[end].first];
        for (Index i = 0; i < pieces[end].count; ++i)
          sides.push_back({loop[i], loop[(i + 1) % pieces[end].count], pieces[end].cell});
      }
      add_segments(sides, first_point, stage, segments);
    }
    of_blocks[block] = std::move(segments);
  });
  std::vector<Segment> all;
  for (const std::vector<Segment>& segments : of_blocks) all.insert(all.end(), segments.begin(), segments.end());
  return all;
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

void copy_candidates(const FaceCandidates& candidates, int threads, GeodesicVoronoi& out) {
  constexpr Index k_chunk = 1024;
  const Index shared_count = candidates.shared_count(), face_count = candidates.table().face_count();
  out.candidates.resize(candidates.candidate_count());
  out.face_candidates.resize(face_count + 1);
  parallel_for(shared_count + 1, threads, k_chunk, [&](Index shared, int) {
    const Index first = shared < shared_count ? candidates.first_candidate(shared) : candidates.candidate_count();
    const auto begin = out.face_candidates.begin();  // the faces up to this one, from behind the shared one before
    std::fill(begin + (shared > 0 ? candidates.face(shared - 1) + 1 : 0),
              begin + (shared < shared_count ? candidates.face(shared) : face_count) + 1, first);
    if (shared == shared_count) return;
    std::ranges::transform(candidates.candidates(shared), out.candidates.begin() + first,
                           [](const FaceCandidate& candidate) {
                             return GeodesicVoronoi::Candidate{candidate.site, candidate.squared_distance};
                           });
  });
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
                                  std::span<const double> known, const JobStage& stage) {
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
    stage.check();
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
    stage.check();
    result.push_back({candidate_at(*this, mesh, place).cell, 0});
    known.push_back(way_over_corner(*this, mesh, place));
  }
  SurfacePoints rival_sites;
  for (const Index rival : sites_in_reach(*this, mesh, places, known, stage)) rival_sites.push_back(sites[rival]);
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
  const CandidatesOfCells candidates(cells, threads);
  GeodesicVoronoi result = make_diagram(graph.mesh(), candidates, sites, threads, stage.part(0.7, 1));
  stage.update(1);
  return result;
}

GeodesicVoronoi make_diagram(const Mesh& mesh, const FaceCandidates& candidates, const SurfacePoints& sites,
                             int threads, const JobStage& stage) {
  GeodesicVoronoi result = subdivision(candidates, sites, threads, stage);
  copy_candidates(candidates, threads, result);
  const auto count = static_cast<Index>(result.points.size());
  result.positions.resize(count);
  result.point_distance.resize(count);
  parallel_for(count, threads, 256, [&](Index i, int) {
    stage.check();
    result.positions[i] = position(mesh, result.points[i]);
    result.point_distance[i] = candidate_at(result, mesh, result.points[i]).distance;
  });
  return result;
}

GeodesicVoronoi subdivision(const FaceCandidates& candidates, const SurfacePoints& sites, int threads,
                            const JobStage& stage) {
  GeodesicVoronoi result = divide_faces(candidates, threads, stage.part(0, 0.7));
  result.sites = sites;
  const std::vector<Segment> segments = find_segments(result, candidates.table().vertex_count, threads, stage);
  stage.check();
  parallel_for(2, threads, 1, [&](Index task, int) {
    if (task == 0)  // by one thread, and takes as long as the areas by many
      Chains(segments, result.points.size(), result);
    else
      result.areas = cell_areas(candidates.table(), result, threads);
  });
  stage.update(1);
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
