#pragma once
// The boundary of each cell, as rays set out from it, and how far its site reaches.

#include <span>
#include <vector>

#include "saddleback/tessellation/geodesic_voronoi.h"

#include "geodesics/wavefront/curve_windows.h"

namespace saddleback {

class CellBorders {
 public:
  /// \throw Cancelled.
  CellBorders(const Mesh& mesh, const GeodesicVoronoi& cells, const JobStage& stage);

  std::span<const BorderPart> of(Index cell) const {
    return std::span(parts_).subspan(first_[cell], first_[cell + 1] - first_[cell]);
  }

 private:
  std::vector<SurfaceCurve> curves_;
  std::vector<BorderPart> parts_;  ///< by cell
  std::vector<Index> first_;       ///< (cells + 1,)
};

/// The largest distance from its site, as the cells tell it, of a corner of the faces and parts of faces of each cell.
std::vector<double> reaches_of(const Mesh& mesh, const GeodesicVoronoi& cells);

}  // namespace saddleback
