// The diagram by exact distances: found on the faces' parts, then told in the mesh's own faces.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "saddleback/mesh/surface_curve.h"

#include "support/threads/parallel.h"
#include "tessellation/cells/exact_candidates.h"
#include "tessellation/relaxation/diagram.h"

namespace saddleback {
namespace {

// The tolerance of distances, relative to the size of a cell, where straight bits stand for hyperbolas. Bits are as
// many as its root has digits: some ten a face that a bisector crosses.
constexpr double k_tolerance = 5e-6;
// Relative to the extent of the part of the mesh: rounding of distances, some 1e-14 of it, then moves a bisector by
// 1e-4 of its distance at most. Of sites that are nearer to each other rounding alone would say which is nearest.
constexpr double k_same_place = 1e-10;

std::vector<double> areas_of_parts(const Mesh& mesh) {
  std::vector<double> areas(mesh.component_count(), 0);
  for (Index face = 0; face < mesh.face_count(); ++face)
    areas[mesh.component_of(mesh.triangles()[face][0])] += mesh.face_area(face);
  return areas;
}

/// Returns for each component the distance within which places count as one: a share of its extent in space, or else
/// of the root of its area or its longest edge.
std::vector<double> limits_of_places(const Mesh& mesh) {
  std::vector<double> limits;
  if (mesh.is_intrinsic()) {
    for (const double area : areas_of_parts(mesh)) limits.push_back(std::sqrt(area));
    for (Index h = 0; h < mesh.halfedge_count(); ++h) {
      double& limit = limits[mesh.component_of(mesh.from(h))];
      limit = std::max(limit, mesh.length(h));
    }
  } else {
    std::vector<Eigen::AlignedBox3d> boxes(mesh.component_count());
    for (Index v = 0; v < mesh.vertex_count(); ++v) boxes[mesh.component_of(v)].extend(mesh.position(v));
    for (const Eigen::AlignedBox3d& box : boxes) limits.push_back(box.diagonal().norm());
  }
  for (double& limit : limits) limit *= k_same_place;
  return limits;
}

/// Returns for each component the tolerance of distances in it.
std::vector<double> tolerances(const Mesh& mesh, const SurfacePoints& sites) {
  std::vector<double> counts(mesh.component_count(), 0), result;
  for (const SurfacePoint& site : sites) ++counts[mesh.component_of(mesh.triangles()[site.face][0])];
  const std::vector<double> areas = areas_of_parts(mesh);
  for (std::size_t part = 0; part < areas.size(); ++part)
    result.push_back(k_tolerance * std::sqrt(areas[part] / counts[part]));
  return result;
}

/// The sites but those that are at the place of an earlier one. O(n log n) but for many beside each other, or shown so.
std::vector<Index> sites_of_places(const Mesh& mesh, const SurfacePoints& sites) {
  const std::vector<double> limits = limits_of_places(mesh);
  const Vec3 direction = Vec3(0.48, 0.6, 0.64);  // any unit vector; grids are seldom square to this one
  std::multimap<double, Index> along;
  std::vector<Index> kept;
  for (Index site = 0; site < static_cast<Index>(sites.size()); ++site) {
    const double here = direction.dot(position(mesh, sites[site]));
    const double limit = limits[mesh.component_of(mesh.triangles()[sites[site].face][0])];
    const double shown = mesh.in_space(limit);
    const bool is_known = std::any_of(along.lower_bound(here - shown), along.upper_bound(here + shown), [&](auto& at) {
      const SurfacePoint& other = sites[at.second];
      return step_length(mesh, sites[site], other) <= limit &&
             shared_face(mesh, sites[site], other, k_barycentric_tolerance) != k_none;
    });
    if (is_known) continue;
    along.emplace(here, site);
    kept.push_back(site);
  }
  return kept;
}

/// The parts as faces, in their order.
class FacesOfParts {
 public:
  explicit FacesOfParts(const ExactParts& parts) : vertex_count_(parts.refinement().vertex_count()) {
    const std::vector<FaceRefinement::Part>& all = parts.refinement().parts();
    std::vector<Index> face_of(all.size());
    for (std::size_t face = 0; face < all.size(); ++face) face_of[parts.order()[face]] = static_cast<Index>(face);
    for (const Index i : parts.order()) {
      const FaceRefinement::Part& part = all[i];
      triangles_.push_back(part.corner);
      areas_.push_back(part.area);
      for (const Index other : part.beyond) {
        if (other == k_none) {
          twins_.push_back(k_none);
          continue;
        }
        const auto& back = all[other].beyond;
        twins_.push_back(3 * face_of[other] + static_cast<Index>(std::ranges::find(back, i) - back.begin()));
      }
    }
  }
  FaceTable table() const { return {vertex_count_, triangles_, twins_, areas_}; }

 private:
  const Index vertex_count_;
  std::vector<Triangle> triangles_;
  std::vector<Index> twins_;
  std::vector<double> areas_;
};

/// Leads from points and pieces of the parts to those of the faces. Added vertices of the parts come last among the
/// points.
class InFaces {
 public:
  InFaces(const ExactParts& parts, GeodesicVoronoi& diagram)
      : parts_(parts),
        mesh_(parts.refinement().mesh()),
        diagram_(diagram),
        on_boundaries_(static_cast<Index>(diagram.points.size())) {}

  void tell() {
    for (SurfacePoint& point : diagram_.points) point = in_face(part(point.face), point.barycentric);
    for (const FaceRefinement::Added& added : parts_.refinement().added()) diagram_.points.push_back(added.at[0]);
    for (const SurfacePoint& point : diagram_.points) diagram_.positions.push_back(position(mesh_, point));
    diagram_.vertex_cell.resize(mesh_.vertex_count());
    diagram_.vertex_distance.resize(mesh_.vertex_count());
    std::vector<Index> part_cell(mesh_.face_count(), k_none);
    part_cell.swap(diagram_.face_cell);
    GeodesicVoronoi found;
    found.pieces.swap(diagram_.pieces);
    found.piece_vertices.swap(diagram_.piece_vertices);
    found.piece_barycentric.swap(diagram_.piece_barycentric);
    auto piece = found.pieces.begin();
    const auto count = static_cast<Index>(parts_.order().size());
    for (Index i = 0; i < count; ++i) {
      const FaceRefinement::Part& at = part(i);
      for (; piece != found.pieces.end() && piece->face == i; ++piece) add_piece(at, *piece, found);
      if (part_cell[i] == k_none) continue;
      const bool is_whole = (i == 0 || part(i - 1).face != at.face) && (i + 1 == count || part(i + 1).face != at.face);
      if (is_whole)
        diagram_.face_cell[at.face] = part_cell[i];
      else
        add_whole(at, part_cell[i]);
    }
  }

 private:
  const FaceRefinement::Part& part(Index i) const { return parts_.refinement().parts()[parts_.order()[i]]; }
  static SurfacePoint in_face(const FaceRefinement::Part& part, const Vec3& x) {
    return {part.face, x[0] * part.place[0] + x[1] * part.place[1] + x[2] * part.place[2]};
  }
  /// Returns a vertex's number among the faces. The parts number the mesh's vertices, the added ones, then the points;
  /// the faces number the points before the added ones.
  Index vertex_of(Index vertex) const {
    const Index of_mesh = mesh_.vertex_count(), of_parts = parts_.refinement().vertex_count();
    if (vertex < of_mesh) return vertex;
    return vertex < of_parts ? vertex + on_boundaries_ : vertex - of_parts + of_mesh;
  }
  void begin_piece(Index face, Index cell, Index count) {
    diagram_.pieces.push_back({face, cell, static_cast<Index>(diagram_.piece_vertices.size()), count});
  }
  void add_corner(Index vertex, const Vec3& barycentric) {
    diagram_.piece_vertices.push_back(vertex_of(vertex));
    diagram_.piece_barycentric.push_back(barycentric);
  }
  void add_piece(const FaceRefinement::Part& at, const GeodesicVoronoi::Piece& piece, const GeodesicVoronoi& found) {
    begin_piece(at.face, piece.cell, piece.count);
    for (Index i = piece.first; i < piece.first + piece.count; ++i)
      add_corner(found.piece_vertices[i], in_face(at, found.piece_barycentric[i]).barycentric);
  }
  void add_whole(const FaceRefinement::Part& at, Index cell) {
    begin_piece(at.face, cell, 3);
    for (int i = 0; i < 3; ++i) add_corner(at.corner[i], at.place[i]);
  }

  const ExactParts& parts_;
  const Mesh& mesh_;
  GeodesicVoronoi& diagram_;
  const Index on_boundaries_;
};

}  // namespace

GeodesicVoronoi exact_voronoi(const Mesh& mesh, const SurfacePoints& sites, Job* job, int threads) {
  check_sites(mesh, sites);
  const JobStage stage(job, "Finding cells by exact distances");
  std::vector<Index> kept = sites_of_places(mesh, sites);
  SurfacePoints sources;
  for (const Index site : kept) sources.push_back(sites[site]);
  auto field = std::make_shared<const ExactField>(mesh, sources, stage.part(0, 0.3));
  const ExactParts parts(*field, kept, tolerances(mesh, sites), threads, stage.part(0.3, 0.8));
  const FacesOfParts faces(parts);
  const ExactCandidates candidates(parts, faces.table(), static_cast<Index>(sites.size()), threads);
  GeodesicVoronoi diagram = subdivision(candidates, sites, threads, stage.part(0.85, 0.95));
  InFaces(parts, diagram).tell();
  diagram.point_distance.resize(diagram.points.size());
  parallel_for(static_cast<Index>(diagram.points.size()), threads, 256, [&](Index point, int) {
    diagram.point_distance[point] = field->nearest_at(diagram.points[point]).distance;
  });
  diagram.exact_field = std::move(field);
  diagram.exact_sites = std::move(kept);
  stage.update(1);
  return diagram;
}

}  // namespace saddleback
