#pragma once

#include <vector>

#include "saddleback/mesh/surface_curve.h"

#include "convert/convert.h"

namespace saddleback::bindings {

/// The curves of an argument `curves`, which keeps them; none for None. \throw InputError for anything else.
std::vector<const SurfaceCurve*> as_curves(const py::object& curves);

}  // namespace saddleback::bindings
