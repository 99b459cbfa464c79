#pragma once
// Voronoi diagrams of the plane that stay on the CUDA device that found them.

#include <cstdint>
#include <memory>
#include <optional>

#include "saddleback/job.h"

#include "support/cuda/cuda_module.h"

namespace saddleback {

/// Rows of numbers in a device's memory, complete: there is nothing to wait for.
struct DeviceArray {
  const void* data = nullptr;
  std::int64_t rows = 0;
  int columns = 1;       ///< of a row
  bool is_real = false;  ///< float64, or else int32
  int device = 0;        ///< the driver's number
  std::shared_ptr<void> owner;

  std::uint64_t nbytes() const { return static_cast<std::uint64_t>(rows) * columns * (is_real ? 8 : 4); }
  /// Copies them to host memory for nbytes(). \throw DeviceError
  void copy_to(void* host) const;
};

/// Holds the arrays as Voronoi2d has them; of triangles alone the others are empty.
struct DeviceVoronoi2d {
  DeviceArray vertices, edges, edge_sites, site_of;
  /// The cell of site i is [offsets[p], offsets[p + 1]) of `corner_vertices` and `side_edges` where p is
  /// `cell_places[i]`; `cell_sites` goes back.
  DeviceArray cell_places, cell_sites, cell_offsets, corner_vertices, side_edges;
  DeviceArray triangles;
  DeviceTimes times;
};

struct DeviceVoronoi2dOptions {
  int device = 0;                ///< the driver's number
  bool only_triangles = false;   ///< the Delaunay triangles, and nothing else
  bool sites_are_there = false;  ///< in the memory of that device
};

/// \param sites (count, 2), of host memory or of the device's
/// \return none for sites that a device is not made for: fewer than three, all on one line or one circle, numbers that
/// are not finite or too large
/// \throw DeviceError, Cancelled
std::optional<DeviceVoronoi2d> voronoi_2d_on_device(const double* sites, std::int64_t count,
                                                    const DeviceVoronoi2dOptions& options, Job* job = nullptr);

}  // namespace saddleback
