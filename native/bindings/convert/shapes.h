#pragma once
// Shapes and placements as every binding takes them.

#include <memory>
#include <vector>

#include "saddleback/field/direction_field.h"
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

/// A Placements. \throw InputError when it is anything else.
const Placements& as_placements(const py::object& value, const char* argument);
/// A Placements, checked against mesh and shapes.
Placements as_placements(const py::object& value, const Mesh& mesh, std::size_t shape_count);

/// Fields of `field`: none, one DirectionField, or a sequence of them. They live as long as the object does.
std::vector<const DirectionField*> as_fields(const py::object& value);
/// Returns what to keep of it: a sequence as a tuple that nobody changes.
py::object kept_fields(const py::object& value);

}  // namespace saddleback::bindings
