#pragma once
// What texels show of their cells: distances to the boundary, logarithms about the site.

#include <vector>

#include "saddleback/tessellation/bake_cells.h"

#include "geodesics/wavefront/curve_windows.h"
#include "geodesics/wavefront/directions_at_point.h"
#include "tessellation/baking/cell_borders.h"
#include "tessellation/baking/uv_raster.h"

namespace saddleback {

/// Texels of one cell and their places on the surface, by face.
struct CellTexels {
  Index cell = k_none;
  std::vector<std::size_t> texels;
  SurfacePoints places;
};

/// Measures texels in cells. Holds scratch memory of O(V + F); one a thread.
class CellMeasure {
 public:
  CellMeasure(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, const CellBorders& borders,
              const std::vector<double>& reaches);
  /// \throw Cancelled.
  void find_edge_distances(const CellTexels& texels, BakedCells& baked, const JobStage& stage);
  /// `axis`: where the first local axis points; null: as `log_map` has it. \throw Cancelled.
  void find_local_uv(const CellTexels& texels, const Vec3* axis, BakedCells& baked, const JobStage& stage);

 private:
  const SaddleVertexGraph& graph_;
  const Mesh& mesh_;
  const GeodesicVoronoi& cells_;
  const CellBorders& borders_;
  const std::vector<double>& reaches_;
  CurveWindows border_;
  WavefrontDistances about_;
};

}  // namespace saddleback
