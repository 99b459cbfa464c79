#pragma once
// The interface between the plane's diagrams and the CUDA module: plain data and calls back, since the two belong to
// modules that are not linked with one another.

#include <cstddef>
#include <cstdint>

#include "support/cuda/cuda_module.h"

namespace saddleback {

struct KeptPlane;  ///< the owner of what stays on a device

/// A diagram, or its Delaunay triangles alone, left on a device, as Voronoi2d has them. Complete: there is nothing to
/// wait for.
struct DevicePlane {
  KeptPlane* owner;  ///< until drop_voronoi
  std::int32_t cells, sides, edges, vertices, triangles;
  const std::int32_t *site_of, *cell_places, *cell_sites, *cell_offsets, *corner_vertices, *side_edges;
  const std::int32_t *edge_vertices, *edge_sites;  ///< two each
  const double* vertex_places;                     ///< two each
  const std::int32_t* triangle_sites;              ///< three each
};

/// Sites are the caller's and live through the call.
struct DiagramRequest {
  const int* devices = nullptr;  ///< the driver's numbers; one that is named twice takes two parts
  int device_count = 0;
  std::uint64_t most_bytes = 0;     ///< of each device's memory; 0: what is free
  const double* sites = nullptr;    ///< (count, 2)
  const double* weights = nullptr;  ///< (count), or null where all weigh the same; of a diagram that comes back
  std::int32_t count = 0;
  bool sites_are_there = false;  ///< in the memory of the one device
  DevicePlane* kept = nullptr;   ///< receives the diagram that stays on the one device; null: it comes back
  bool only_triangles = false;   ///< of what stays
};

struct DiagramSizes {
  std::int32_t cells, edges, vertices;
};

/// Holds where the diagram goes, as Voronoi2d has it.
struct DiagramArrays {
  double* sites;                               ///< two each; null: the caller has them
  std::int32_t *site_of, *cell_places;         ///< by site
  std::int32_t *cell_sites, *cell_offsets;     ///< by cell; offsets have one more
  std::int32_t *corner_vertices, *side_edges;  ///< twice the edges
  std::int32_t *edges, *edge_sites;            ///< two each
  double* vertices;                            ///< two each
};

/// A vertex of a weighted diagram that takes the processor's arithmetic, and the sites about it, from the one whose
/// cell comes first on, counter-clockwise.
struct RoughVertex {
  std::int32_t vertex, sites[3];
};

/// Holds what the CUDA module asks of its caller. No call throws.
struct DiagramCaller {
  void* self = nullptr;
  /// Tells the share done; false: stop.
  bool (*keep_going)(void* self, double fraction) = nullptr;
  /// Sorts the sites along the curve; `order` receives them, `places` where they lie. False: stop.
  bool (*sort)(void* self, std::uint32_t* places, std::int32_t* order) = nullptr;
  /// Makes room for a diagram of at most these sizes, while the device is at work. False: stop.
  bool (*make_room)(void* self, const DiagramSizes& most, DiagramArrays* arrays) = nullptr;
  /// Places vertices, while the room is as it was made. False: stop.
  bool (*place)(void* self, const RoughVertex* vertices, std::int32_t count) = nullptr;
  /// Says how much of that is used. False: stop.
  bool (*cut)(void* self, const DiagramSizes& sizes) = nullptr;
};

}  // namespace saddleback
