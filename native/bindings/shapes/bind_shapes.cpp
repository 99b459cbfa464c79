// Shape and the presets.

#include "convert/planar.h"
#include "convert/shapes.h"

namespace saddleback::bindings {

const Shape& as_shape(const py::object& value, const char* argument) {
  if (!py::isinstance<Shape>(value))
    throw InputError(
        message(argument, ": wanted a Shape, got a ", py::cast<std::string>(py::type::of(value).attr("__name__"))));
  return py::cast<const Shape&>(value);
}

std::vector<Shape> as_shapes(const py::object& value, const char* argument) {
  std::vector<Shape> result;
  if (py::isinstance<Shape>(value) || !py::isinstance<py::sequence>(value)) return {as_shape(value, argument)};
  for (const py::handle item : py::cast<py::sequence>(value))
    result.push_back(as_shape(py::reinterpret_borrow<py::object>(item), argument));
  if (result.empty()) throw InputError(message(argument, ": wanted at least one Shape"));
  return result;
}

std::vector<const DirectionField*> as_fields(const py::object& value) {
  if (value.is_none()) return {};
  std::vector<const DirectionField*> result;
  const auto take = [&](const py::handle item, const std::string& name) {
    if (!py::isinstance<DirectionField>(item))
      throw InputError(message(name, ": wanted a DirectionField, got a ",
                               py::cast<std::string>(py::type::of(item).attr("__name__"))));
    result.push_back(&py::cast<const DirectionField&>(item));
  };
  if (!py::isinstance<py::sequence>(value)) {
    take(value, "field");
    return result;
  }
  for (const py::handle item : py::cast<py::sequence>(value)) take(item, message("field of shape ", result.size()));
  if (result.empty()) throw InputError("field: wanted at least one DirectionField");
  return result;
}

py::object kept_fields(const py::object& value) {
  return py::isinstance<py::sequence>(value) ? py::object(py::tuple(value)) : value;
}

namespace {

constexpr const char* k_shape_doc =
    R"(A shape to lay on a surface: a flat outline of one or several parts, with or without holes.

The origin of its plane lies at the center of a placement, its x axis points along the field.

Args:
    parts: each an outline (n, 2), or a sequence of an outline and its holes; in any unit, in either direction.

Raises:
    InputError: naming part, loop and corner: no part, fewer than three corners, a coordinate that is not finite or beyond
        1e30, loops that touch or cross themselves or each other, no area, a hole outside of its outline, a part within
        another.

Notes:
    Decided exactly. O(m log m) expected for m corners.
)";

bool holds_loops(const py::object& value) {
  const bool is_list = py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value);
  if (!is_list || py::len(value) == 0) return false;
  const py::object first = value[py::int_(0)];
  return py::hasattr(first, "__len__") && py::len(first) > 0 && py::hasattr(first[py::int_(0)], "__len__");
}

Shape make_shape(const py::args& parts) {
  std::vector<Shape::Part> result;
  for (const py::handle item : parts) {
    const py::object part = py::reinterpret_borrow<py::object>(item);
    Shape::Part loops;
    if (holds_loops(part)) {
      for (const py::handle loop : part)
        loops.push_back(as_points_2d(py::reinterpret_borrow<py::object>(loop), "shape"));
    } else {
      loops.push_back(as_points_2d(part, "shape"));
    }
    result.push_back(std::move(loops));
  }
  return Shape(std::move(result));
}

py::list loops_of(const Shape& shape) {
  py::list result;
  for (const Shape::Loop& loop : shape.loops()) result.append(to_array(Shape::Loop(loop)));
  return result;
}

/// Parts as the constructor takes them.
py::tuple parts_of(const Shape& shape) {
  const py::list loops = loops_of(shape);
  py::tuple result(shape.part_count());
  for (Index part = 0; part < shape.part_count(); ++part) {
    py::list own;
    for (Index loop = shape.part_begins()[part]; loop < shape.part_begins()[part + 1]; ++loop) own.append(loops[loop]);
    result[part] = own;
  }
  return result;
}

py::array contains(const Shape& shape, const py::object& points) {
  std::vector<std::uint8_t> inside;
  for (const Vec2& point : as_points_2d(points, "points")) inside.push_back(shape.contains(point));
  return to_array(std::move(inside)).attr("astype")("bool");
}

constexpr const char* k_mask_doc = R"(The parts of an image where it is over one half.

Outlines by marching squares, simplified outwards only: the shape covers all of what they enclose. The image's right is
x, up is y.

Args:
    image: (rows, columns) from top to bottom: booleans, reals 0 to 1, or uint8 0 to 255; with a last axis of 4 channels
        the alpha counts.
    max_corners: at least 8.
    centered: about the smallest circle, of circumradius 1; or else in pixels, the first pixel's center at the origin.
    job: progress and cancellation.

Raises:
    InputError: another shape of array, a value that is not finite; no clear mask: nothing or everything over one half, or
        more parts and holes than there are corners for.
    Cancelled: the job was.
)";

Shape from_mask(const py::object& image, const py::object& max_corners, bool centered, const py::object& job) {
  const char* const wanted = "a (rows, columns) or (rows, columns, 4) array of reals";
  py::array array = as_array(image, "image", wanted);
  if (array.ndim() == 3 && array.shape(2) == 4) array = array[py::make_tuple(py::ellipsis(), 3)];
  const bool is_bytes = array.dtype().kind() == 'u' && array.itemsize() == 1;
  if (array.dtype().kind() == 'b') array = array.attr("astype")("uint8");
  const ArrayIn<double> values = as_rows(array, "image", wanted);
  std::vector<double> copy(values.values.begin(), values.values.end());
  if (is_bytes)
    for (double& value : copy) value /= 255;
  const JobIn token(job);
  const MaskImage mask{copy, values.count, static_cast<Index>(values.array.shape(1))};
  const Index most = as_integer(max_corners, "max_corners");
  return without_gil([&] { return shape_from_mask(mask, most, centered, token); });
}

void bind_presets(py::class_<Shape>& shape) {
  shape
      .def_static(
          "disk", [](const py::object& corners) { return shapes::disk(as_integer(corners, "corners")); },
          py::arg("corners") = 64, "A regular polygon on the unit circle, its first corner on the x axis.")
      .def_static(
          "star",
          [](const py::object& points, const py::object& inner) {
            return shapes::star(as_integer(points, "points"), as_real(inner, "inner"));
          },
          py::arg("points") = 5, py::arg("inner") = 0.381966011250105,
          "`points` tips on the unit circle, one on the x axis, corners at the radius `inner` between them.")
      .def_static(
          "needle", [](const py::object& aspect) { return shapes::needle(as_real(aspect, "aspect")); },
          py::arg("aspect") = 10.0, "A rhombus of length 2 along the x axis, `aspect` times as long as wide.")
      .def_static(
          "leaf",
          [](const py::object& aspect, const py::object& corners) {
            return shapes::leaf(as_real(aspect, "aspect"), as_integer(corners, "corners"));
          },
          py::arg("aspect") = 2.5, py::arg("corners") = 40,
          "Two arcs between tips at -1 and 1 on the x axis, `aspect` times as long as wide.")
      .def_static(
          "drop",
          [](const py::object& round, const py::object& corners) {
            return shapes::drop(as_real(round, "round"), as_integer(corners, "corners"));
          },
          py::arg("round") = 0.6, py::arg("corners") = 40,
          "A disk of radius `round` drawn out to a tip at 1 on the x axis: a scale, a drop, a feather.")
      .def_static(
          "crescent",
          [](const py::object& inner, const py::object& shift, const py::object& corners) {
            return shapes::crescent(as_real(inner, "inner"), as_real(shift, "shift"), as_integer(corners, "corners"));
          },
          py::arg("inner") = 0.8, py::arg("shift") = 0.4, py::arg("corners") = 48,
          "The unit disk less a disk of radius `inner` about (shift, 0).");
}

}  // namespace

void bind_shapes(py::module_& m) {
  py::class_<Shape> shape(m, "Shape", py::module_local(), k_shape_doc);
  shape.def(py::init(&make_shape))
      .def_static("from_mask", &from_mask, py::arg("image"), py::arg("max_corners") = 128, py::arg("centered") = true,
                  py::kw_only(), py::arg("job") = py::none(), k_mask_doc)
      .def_property_readonly("loops", &loops_of,
                             "Lists of (n, 2) float64: outlines counter-clockwise, holes clockwise, part by part.")
      .def_property_readonly("parts", &parts_of, "The loops as the constructor takes them: per part outline and holes.")
      .def_property_readonly("circumradius", &Shape::circumradius, "Distance of the farthest corner from the origin.")
      .def_property_readonly("inradius", &Shape::inradius,
                             "Radius of the largest disk about the origin within; 0 when the origin is outside.")
      .def_property_readonly("area", &Shape::area, "Area of all parts, holes left out.")
      .def_property_readonly("has_half_turn", &Shape::has_half_turn,
                             "True if half a turn about the origin changes nothing.")
      .def("contains", &contains, py::arg("points"), "(n,) bool for (n, 2) points of the plane.")
      .def(
          "moved",
          [](const Shape& self, const py::object& scale, const py::object& angle, const py::object& shift) {
            const ArrayIn<double> by = as_reals(shift, "shift", 2);
            return self.moved(as_real(scale, "scale"), as_real(angle, "angle"), {by.values[0], by.values[1]});
          },
          py::arg("scale") = 1.0, py::arg("angle") = 0.0, py::arg("shift") = py::make_tuple(0.0, 0.0),
          "Returns the shape scaled, then turned counter-clockwise (radians), then shifted.")
      .def(
          "overlaps",
          [](const Shape& self, const py::object& other) { return self.overlaps(as_shape(other, "other")); },
          py::arg("other"), "Tells exactly whether the two have a common point, outlines included.")
      .def("mirrored", &Shape::mirrored, "Returns the shape with y negated.")
      .def(
          "centered",
          [](const Shape& self, const py::object& radius) { return self.centered(as_real(radius, "radius")); },
          py::arg("radius") = 1.0,
          "Moved so that the smallest circle around it is about the origin, and scaled so that it has this radius.")
      .def("__reduce__",
           [](const py::object& self) {
             return py::make_tuple(py::type::of(self), parts_of(py::cast<const Shape&>(self)));
           })
      .def("__repr__", [](const Shape& self) {
        return message("<Shape: ", self.part_count(), self.part_count() == 1 ? " part, " : " parts, ",
                       self.loops().size() - self.part_count(), " holes, ", self.corner_count(),
                       " corners, circumradius ", self.circumradius(), ">");
      });
  bind_presets(shape);
}

}  // namespace saddleback::bindings
