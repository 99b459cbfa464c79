#pragma once

#include "saddleback/geodesic_voronoi.h"

#include "tessellation/cell_complex.h"

namespace saddleback {

/// The public diagram of a cell complex of these sites. \throw Cancelled.
GeodesicVoronoi make_diagram(const CellComplex& complex, const SurfacePoints& sites, const JobStage& stage);

}  // namespace saddleback
