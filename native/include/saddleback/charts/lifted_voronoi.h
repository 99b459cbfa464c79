#pragma once
// Voronoi diagrams of the plane, brought to a surface by its map.

#include <array>
#include <vector>

#include "saddleback/charts/chart.h"
#include "saddleback/tessellation/geodesic_voronoi.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

namespace saddleback {

/// Holds what lies of each cell on the surface.
struct LiftedVoronoi {
  using Piece = GeodesicVoronoi::Piece;

  std::vector<double> areas;  ///< (n) on the surface; they sum to the mesh's area
  std::vector<Vec2>
      centroids;  ///< (n) centers of mass in the plane, by area on the surface; not a number where it is 0

  SurfacePoints points;         ///< where edges cross mesh edges or meet
  std::vector<Vec3> positions;  ///< of the points
  /// The diagram's edges as polylines of points, ordered by edge; polyline i is [edge_offsets[i], edge_offsets[i + 1])
  /// of edge_points. Consecutive points share a face. An edge ends at the map's border, and may come in again.
  std::vector<Index> edge_points, edge_offsets;
  std::vector<Index> edge_of;                    ///< the diagram's edge of each polyline
  std::vector<std::array<Index, 2>> edge_cells;  ///< sites on the left and on the right of the polyline

  std::vector<Index> face_cell;         ///< (F) the cell that a face lies in, k_none where several share it
  std::vector<Piece> pieces;            ///< of the shared faces, ordered by face: convex polygons
  std::vector<Index> piece_vertices;    ///< corners of the pieces: mesh vertices, or V + i for points[i]
  std::vector<Vec3> piece_barycentric;  ///< the same in their faces

  /// The cell of each point. O(m log F). \throw InputError for a point off the mesh.
  std::vector<Index> locate(const Mesh& mesh, const SurfacePoints& points) const;
  /// Cuts the mesh along the edges. O(V + F).
  SplitMesh split(const Mesh& mesh) const;
};

struct LiftOptions {
  double tolerance = 0;  ///< in the plane, of polylines along curved edges, by which cells are divided; 0: a thousandth
                         ///< of a mean cell's width, of which it is 2^-28 at least
  int threads = 0;       ///< 0: all cores
};

/// Each point of the surface gets the cell that its place in the plane lies in. What the map does not cover is left
/// out; a cell that comes to several islands or parts of the border is in several parts. Faces that share a mesh edge
/// in the plane agree about it to the bit. With weights sides are polylines along the curves. \throw InputError for a
/// diagram without sites, a tolerance that is negative; Cancelled. O((F + pieces) log F).
LiftedVoronoi lift(const Chart& chart, const Voronoi2d& diagram, const LiftOptions& options = {}, Job* job = nullptr);

}  // namespace saddleback
