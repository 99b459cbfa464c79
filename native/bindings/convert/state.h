#pragma once
// What objects are made of, as tuples of numbers and arrays that equal ones are made of again: `_state` and
// `_from_state`, by which the package pickles and compares (saddleback/_content.py).
//
// A class takes part with `let_travel`. Structs say by `fields_of`, beside them or in convert/fields.h, what is in
// them.

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "convert/points.h"

namespace saddleback::bindings {

/// The numbers of an array's row: one, or all of a vector's, without gaps between them.
template <class T>
struct Row {
  using Scalar = void;
};
template <class T>
requires std::is_arithmetic_v<T>
struct Row<T> {
  using Scalar = T;
  static constexpr py::ssize_t k_width = 1;
};
template <class T, int N>
struct Row<Eigen::Matrix<T, N, 1>> {
  using Scalar = T;
  static constexpr py::ssize_t k_width = N;
};
template <class T, std::size_t N>
requires(!std::is_void_v<typename Row<T>::Scalar>) struct Row<std::array<T, N>> {
  using Scalar = typename Row<T>::Scalar;
  static constexpr py::ssize_t k_width = static_cast<py::ssize_t>(N) * Row<T>::k_width;
};

template <class T>
concept IsRow = !std::is_void_v<typename Row<T>::Scalar>;
/// Python's own objects, and what pybind11 makes of numbers and words.
template <class T>
concept IsPlain = std::is_arithmetic_v<T> || std::is_same_v<T, std::string> || std::is_base_of_v<py::object, T> ||
    std::is_same_v<T, SurfacePoints>;

template <class T>
struct IsVector : std::false_type {};
template <class T, class Memory>
struct IsVector<std::vector<T, Memory>> : std::true_type {};
template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

/// Numbers, as tags and flags of lists of structs are kept.
template <class T>
using Kept = std::conditional_t<std::is_enum_v<T>, Index, std::conditional_t<std::is_same_v<T, bool>, std::uint8_t, T>>;
template <class Item, std::size_t I>
using Field = std::remove_cvref_t<std::tuple_element_t<I, decltype(fields_of(std::declval<Item&>()))>>;
template <class Item>
inline constexpr std::size_t k_field_count = std::tuple_size_v<decltype(fields_of(std::declval<Item&>()))>;

[[noreturn]] inline void refuse_state(const std::string& wanted, const py::handle& got) {
  throw InputError(message("state: wanted ", wanted, ", got ", std::string(py::str(py::type::of(got)))));
}

template <class T>
py::object state_of(const T& value);

template <class Item, std::size_t I>
std::vector<Kept<Field<Item, I>>> column(const std::vector<Item>& items) {
  std::vector<Kept<Field<Item, I>>> values;
  values.reserve(items.size());
  for (const Item& item : items)
    values.push_back(static_cast<Kept<Field<Item, I>>>(std::get<I>(fields_of(const_cast<Item&>(item)))));
  return values;
}

template <class T, class Memory>
py::object state_of_items(const std::vector<T, Memory>& items) {
  if constexpr (IsRow<T>) {
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(items.size())};
    if (Row<T>::k_width > 1) shape.push_back(Row<T>::k_width);
    using Scalar = typename Row<T>::Scalar;
    return py::array_t<Scalar>(shape, reinterpret_cast<const Scalar*>(items.data()));
  } else {  // structs: an array for each of their fields
    return [&]<std::size_t... I>(std::index_sequence<I...>) { return py::make_tuple(state_of(column<T, I>(items))...); }
    (std::make_index_sequence<k_field_count<T>>{});
  }
}

/// The tuple, array or number that `restore` makes an equal value of.
template <class T>
py::object state_of(const T& value) {
  if constexpr (IsPlain<T>)
    return py::cast(value);
  else if constexpr (std::is_enum_v<T>)
    return py::int_(static_cast<int>(value));
  else if constexpr (std::is_same_v<T, SurfacePoint>)
    return py::cast(SurfacePoints{value});
  else if constexpr (IsVector<T>::value)
    return state_of_items(value);
  else if constexpr (IsOptional<T>::value)
    return value ? state_of(*value) : py::none();
  else if constexpr (IsRow<T>)
    return state_of(std::vector<T>{value});
  else
    return std::apply([](const auto&... field) { return py::make_tuple(state_of(field)...); },
                      fields_of(const_cast<T&>(value)));
}

template <class T>
void restore(const py::handle& state, T& value);

inline py::tuple as_state(const py::handle& state, std::size_t size) {
  if (!py::isinstance<py::tuple>(state) || py::len(state) != size) refuse_state(message(size, " parts"), state);
  return py::reinterpret_borrow<py::tuple>(state);
}

template <class T, class Memory>
void restore_items(const py::handle& state, std::vector<T, Memory>& items) {
  if constexpr (IsRow<T>) {
    using Scalar = typename Row<T>::Scalar;
    constexpr py::ssize_t k_width = Row<T>::k_width;
    const std::string wanted = message("an array of rows of ", k_width, " numbers");
    if (!py::isinstance<py::array_t<Scalar>>(state)) refuse_state(wanted, state);
    const auto array = py::array_t<Scalar, py::array::c_style>::ensure(state);
    if (array.ndim() != (k_width > 1 ? 2 : 1) || (k_width > 1 && array.shape(1) != k_width))
      refuse_state(wanted, state);
    items.resize(static_cast<std::size_t>(array.shape(0)));
    std::copy_n(array.data(), array.size(), reinterpret_cast<Scalar*>(items.data()));
  } else {
    const py::tuple columns = as_state(state, k_field_count<T>);
    const auto fill = [&]<std::size_t I>() {
      std::vector<Kept<Field<T, I>>> values;
      restore(columns[I], values);
      if (I == 0) items.resize(values.size());
      if (values.size() != items.size()) refuse_state(message(items.size(), " values"), columns[I]);
      for (std::size_t i = 0; i < values.size(); ++i)
        std::get<I>(fields_of(items[i])) = static_cast<Field<T, I>>(values[i]);
    };
    [&]<std::size_t... I>(std::index_sequence<I...>) { (fill.template operator()<I>(), ...); }
    (std::make_index_sequence<k_field_count<T>>{});
  }
}

/// \throw InputError for the state of something else.
template <class T>
void restore(const py::handle& state, T& value) {
  if constexpr (IsPlain<T>) {
    try {
      value = py::cast<T>(state);
    } catch (const py::cast_error&) {
      refuse_state("a number, a word or points", state);
    }
  } else if constexpr (std::is_enum_v<T>) {
    int number = 0;
    restore(state, number);
    value = static_cast<T>(number);
  } else if constexpr (std::is_same_v<T, SurfacePoint> || (IsRow<T> && !IsVector<T>::value)) {
    std::vector<T> values;
    restore(state, values);
    if (values.size() != 1) refuse_state("one value", state);
    value = values.front();
  } else if constexpr (IsVector<T>::value) {
    restore_items(state, value);
  } else if constexpr (IsOptional<T>::value) {
    value.reset();
    if (!state.is_none()) restore(state, value.emplace());
  } else {
    auto fields = fields_of(value);
    const py::tuple parts = as_state(state, std::tuple_size_v<decltype(fields)>);
    [&]<std::size_t... I>(std::index_sequence<I...>) { (restore(parts[I], std::get<I>(fields)), ...); }
    (std::make_index_sequence<std::tuple_size_v<decltype(fields)>>{});
  }
}

/// Lets objects of a bound class travel: `save(self)` gives a tuple of what is in one, `load(tuple)` makes one of it.
/// The last `notes` parts tell how it was found and are no part of what it is.
template <class T, class Save, class Load>
void let_travel(const py::module_& m, const char* name, Save save, Load load, int notes = 0) {
  py::class_<T> type = m.attr(name);
  type.def("_state", [save](const py::object& self) -> py::tuple { return save(self); });
  type.def_static(
      "_from_state", [load](const py::tuple& state) { return load(state); }, py::arg("state"));
  type.attr("_notes") = notes;
}

/// Lets objects of a bound struct with `fields_of` travel.
template <class T>
void let_travel(const py::module_& m, const char* name) {
  let_travel<T>(
      m, name, [](const py::object& self) { return py::tuple(state_of(py::cast<const T&>(self))); },
      [](const py::tuple& state) {
        T value{};
        restore(state, value);
        return value;
      });
}

}  // namespace saddleback::bindings
