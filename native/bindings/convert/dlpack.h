#pragma once
// Arrays of a device for other libraries: DLPack's structures of version 0, which all of them read
// (https://dmlc.github.io/dlpack).

#include <array>
#include <cstdint>
#include <memory>

#include "convert/convert.h"
#include "voronoi2d/device_voronoi_2d.h"

namespace saddleback::bindings {

constexpr int k_dlpack_cuda = 2;

/// A tensor in the layout of the DLPack standard.
struct DlpackTensor {
  void* data;
  std::int32_t device_type, device_id;
  std::int32_t dimensions;
  std::uint8_t type_code, type_bits;  ///< 0: integer, 2: float
  std::uint16_t type_lanes;
  std::int64_t* shape;
  std::int64_t* strides;  ///< null: rows one after another
  std::uint64_t byte_offset;
};
struct DlpackManagedTensor {
  DlpackTensor tensor;
  void* context;
  void (*deleter)(DlpackManagedTensor*);
};

/// Keeps the array alive until the taker calls the deleter.
struct DlpackArray {
  DlpackManagedTensor managed{};
  DeviceArray array;
  std::array<std::int64_t, 2> shape{};
};

inline py::capsule dlpack_of(const DeviceArray& array) {
  auto held = std::make_unique<DlpackArray>();
  held->array = array;
  held->shape = {array.rows, array.columns};
  held->managed.tensor = {.data = const_cast<void*>(array.data),
                          .device_type = k_dlpack_cuda,
                          .device_id = array.device,
                          .dimensions = array.columns == 1 ? 1 : 2,
                          .type_code = static_cast<std::uint8_t>(array.is_real ? 2 : 0),
                          .type_bits = static_cast<std::uint8_t>(array.is_real ? 64 : 32),
                          .type_lanes = 1,
                          .shape = held->shape.data(),
                          .strides = nullptr,
                          .byte_offset = 0};
  held->managed.deleter = [](DlpackManagedTensor* managed) { delete static_cast<DlpackArray*>(managed->context); };
  // Who takes it renames the capsule, and calls the deleter when done.
  const auto destroy = [](PyObject* capsule) {
    if (!PyCapsule_IsValid(capsule, "dltensor")) return;
    auto* const managed = static_cast<DlpackManagedTensor*>(PyCapsule_GetPointer(capsule, "dltensor"));
    managed->deleter(managed);
  };
  DlpackManagedTensor* const managed = &held->managed;
  PyObject* const capsule = PyCapsule_New(managed, "dltensor", destroy);
  if (!capsule) throw py::error_already_set();
  managed->context = held.release();  // the taker's, or the capsule's
  return py::reinterpret_steal<py::capsule>(capsule);
}

}  // namespace saddleback::bindings
