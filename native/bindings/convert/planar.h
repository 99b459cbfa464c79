#pragma once
// Arguments of the plane that several bindings take.

#include <vector>

#include "saddleback/voronoi2d/planar_domain.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

#include "convert/convert.h"

namespace saddleback::bindings {

/// An (n, 2) array.
std::vector<Vec2> as_points_2d(const py::object& value, const char* name);

/// An (n,) array, or None for none.
std::vector<double> as_weights(const py::object& value, std::size_t site_count);

/// An (m, 2) array, or a sequence of such: the outline and its holes.
PlanarDomain as_domain(const py::object& value, const char* name);

/// The diagram of an argument. \throw InputError when it is anything else.
const Voronoi2d& as_voronoi_2d(const py::object& value, const char* name);

}  // namespace saddleback::bindings
