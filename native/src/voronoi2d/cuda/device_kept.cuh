#pragma once
// The part of a diagram that stays on the device.

#include <cstdint>
#include <memory>
#include <utility>

#include "support/cuda/device_buffer.h"
#include "support/cuda/device_stream.h"

namespace saddleback {

/// A diagram that stays on the device. Its memory is freed in the order of its own stream, which is the last to go.
struct KeptPlane {
  KeptPlane(std::unique_ptr<Stream> own_stream, int on_device) : stream(std::move(own_stream)), device(on_device) {}

  std::unique_ptr<Stream> stream;
  int device;
  DeviceBuffer<std::int32_t> site_of, cell_places, cell_sites, cell_offsets, corner_vertices, side_edges;
  DeviceBuffer<int2> edges, edge_sites;
  DeviceBuffer<double2> vertices;
  DeviceBuffer<std::int32_t> triangles;
};

}  // namespace saddleback
