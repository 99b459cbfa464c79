#pragma once
// Shapes and placements as every binding takes them.

#include <memory>
#include <vector>

#include "saddleback/shapes/placement.h"
#include "saddleback/shapes/shape.h"

#include "convert/convert.h"

// Placements cross the border as a class of their own, never as a Python list.
PYBIND11_MAKE_OPAQUE(saddleback::Placements)

namespace saddleback::bindings {

/// One Shape. \throw InputError when it is anything else.
const Shape& as_shape(const py::object& value, const char* argument);

/// One Shape or a sequence of at least one.
std::vector<Shape> as_shapes(const py::object& value, const char* argument);

/// A Placements, checked against mesh and shapes.
Placements as_placements(const py::object& value, const Mesh& mesh, std::size_t shape_count);

}  // namespace saddleback::bindings
