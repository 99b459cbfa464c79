#pragma once

#include <vector>

#include "saddleback/mesh/surface_curve.h"

#include "convert/convert.h"

namespace saddleback::bindings {

/// Curves of an argument, and the Python objects that hold them: an iterator makes them on the way, and a list may
/// change meanwhile.
struct CurvesIn {
  py::tuple kept;
  std::vector<const SurfaceCurve*> curves;
};
/// The curves of an argument `curves`; none for None. \throw InputError for anything else.
CurvesIn as_curves(const py::object& curves);

}  // namespace saddleback::bindings
