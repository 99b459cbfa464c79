#pragma once
// Geodesic Voronoi cells on a surface.

#include <array>
#include <memory>
#include <vector>

#include "saddleback/geodesics/exact_distances.h"
#include "saddleback/geodesics/saddle_vertex_graph.h"

namespace saddleback {

struct GeodesicVoronoiOptions {
  int threads = 0;  ///< 0: all cores; the result does not depend on it
  /// Number of the CUDA device that finds the nearest sites of vertices, -1: the processor does, as all else. The
  /// result does not depend on it. The device keeps the graph's arcs from then on.
  int cuda_device = -1;
};

/// A mesh in which every triangle lies in exactly one cell.
struct SplitMesh {
  std::vector<Vec3> vertices;  ///< the mesh's, then those on cell boundaries
  std::vector<Triangle> triangles;
  std::vector<Index> triangle_cell;
  std::vector<Index> vertex_origin;  ///< vertex of the original mesh, k_none for added ones
};

/// The cell to which a point of the surface belongs.
struct CellAt {
  Index cell;
  double distance;  ///< from the cell's site
};

/// Cells of the sites, their boundaries and areas.
struct GeodesicVoronoi {
  /// A site that may own a part of a shared face: its squared distances from the face's corners. Inside, squared
  /// distances are what a site in the face's plane would have.
  struct Candidate {
    Index cell;
    std::array<double, 3> squared_distance;
  };

  /// Part of a divided face: a convex polygon.
  struct Piece {
    Index face, cell;
    Index first, count;  ///< in piece_vertices
  };

  SurfacePoints sites;
  std::vector<Index> vertex_cell;       ///< (V,) the nearest site; ties: the smaller
  std::vector<double> vertex_distance;  ///< (V,) from it
  std::vector<double> areas;            ///< (n,) they sum to the mesh's area

  /// The points where cell boundaries cross mesh edges or meet; for exact cells also where boundaries bend and where
  /// faces are divided.
  SurfacePoints points;
  std::vector<Vec3> positions;         ///< of the points
  std::vector<double> point_distance;  ///< of the points, from the sites that meet there
  /// Boundaries between two cells as polylines of points; polyline i is [edge_offsets[i], edge_offsets[i+1]) of
  /// edge_points. Consecutive points share a face. A closed one repeats its first point.
  std::vector<Index> edge_points, edge_offsets;
  std::vector<std::array<Index, 2>> edge_cells;  ///< on the left and on the right of the polyline
  std::vector<std::uint8_t> edge_closed;
  std::vector<Index> branch_points;  ///< points where three or more cells meet

  std::vector<Index> face_cell;         ///< (F,) the cell that owns a face whole, k_none where it is divided
  std::vector<Piece> pieces;            ///< of the divided faces
  std::vector<Index> piece_vertices;    ///< corners of the pieces: mesh vertices, or V + i for points[i]
  std::vector<Vec3> piece_barycentric;  ///< the same in their faces
  std::vector<Candidate> candidates;    ///< on the shared faces, by face and cell
  std::vector<Index> face_candidates;   ///< (F + 1,) those on face f are [face_candidates[f], face_candidates[f + 1])
  std::shared_ptr<const ExactField> exact_field;  ///< of exact cells, in place of candidates
  std::vector<Index> exact_sites;                 ///< the sites that are its sources: one of each place

  /// Cuts the mesh along the boundaries. O(V + F).
  SplitMesh split(const Mesh& mesh) const;
  /// The cell of a point of the surface, ties to the smaller. O(candidates on the face).
  Index cell_at(const Mesh& mesh, const SurfacePoint& point) const;
  /// The cells of points of the surface, as cell_at, and the distances from the nearest site: of cells by a graph,
  /// which must be theirs, the lengths of ways in it, never shorter than the surface's and longer by no more than its
  /// accuracy. \throw InputError for a point off the mesh, Cancelled. O(k log k) a point.
  std::vector<CellAt> locate(const SaddleVertexGraph& graph, const SurfacePoints& points, Job* job = nullptr) const;
  /// The points where boundaries meet around a cell (branch points, ends at the mesh's boundary), in order with the
  /// cell on the left; indices into `points`. \throw InputError for a cell out of range.
  std::vector<Index> corners(Index cell) const;
};

/// Assigns every point of the surface to its nearest site. Bisectors are straight inside a face, right where both sites
/// see it straight, past no saddle vertex and by one way; cells smaller than a face and several sites in one face are
/// found. \throw InputError for no sites, a site off the mesh, a component without a site; DeviceError; Cancelled.
/// O(sites k log k + arcs + pieces). After [liu2011], with candidates spread over edges instead of vertex labels alone.
GeodesicVoronoi geodesic_voronoi(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                                 const GeodesicVoronoiOptions& options = {}, Job* job = nullptr);

/// Finds the cells by exact distances, as a reference: without a graph, and slowly. Bisectors are divided so finely
/// that at no point of a cell another site is nearer by more than 1e-5 of the size of a cell (the square root of the
/// area per site, in each part of the mesh), a tenth of that where no shortest way bends; straight bisectors are right
/// but for rounding. `vertex_cell` and `locate` are exact up to rounding. Two ways to a site that are equally long may
/// be told apart by rounding. Sites within 1e-10 of the extent of their part of the mesh of each other are one: the
/// first has the cell. Where lengths were given, the extent is the root of its area, or its longest edge. \throw as
/// geodesic_voronoi. About O(V^1.5 + points) time. `threads`: 0: all cores; the result does not depend on them.
GeodesicVoronoi exact_voronoi(const Mesh& mesh, const SurfacePoints& sites, Job* job = nullptr, int threads = 0);

}  // namespace saddleback
