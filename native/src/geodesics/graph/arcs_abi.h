#pragma once
// The interface between a graph's construction and the CUDA module: plain data and calls back, since the two belong to
// modules that are not linked with one another.

#include <cstddef>
#include <cstdint>

#include "geodesics/graph/arc_packing.h"
#include "geodesics/graph/window_batches.h"
#include "support/cuda/cuda_module.h"

namespace saddleback {

/// Holds where and how arcs are to be found. Arrays are the caller's and live through the call.
struct ArcsRequest {
  const int* devices = nullptr;  ///< the driver's numbers; one that is named twice takes two parts
  int device_count = 0;
  std::uint64_t most_bytes = 0;  ///< of each device's memory; 0: what is free

  // The rule, as DiskRule and WaveScene have it.
  std::int32_t k = 0;
  float detour = 1, per_detour = 1, excess = 0;
  double slack = 1;

  // The mesh, as Mesh and Unfolding hold it.
  std::int32_t node_count = 0, edge_count = 0;                ///< vertices and half-edges
  const std::int32_t *triangles = nullptr, *twins = nullptr;  ///< per half-edge
  const double *lengths = nullptr, *polars = nullptr;         ///< per half-edge
  const double* face_areas = nullptr;                         ///< per face
  const std::int32_t* first_halfedges = nullptr;              ///< per vertex
  const double* total_angles = nullptr;                       ///< per vertex
  const std::uint8_t* saddles = nullptr;                      ///< per vertex
  const std::int32_t *nodes = nullptr, *vertices = nullptr;   ///< of the vertices, and of the nodes
  double unit = 1;
  int sector_count = 0;  ///< of a full turn

  bool is_callers =
      false;  ///< whether the device leaves all nodes to the caller: there are strips that it does not know
};

/// Rows of arcs that the caller found.
struct FoundRows {
  const std::int32_t* counts;        ///< per node asked for
  const std::uint64_t* words;        ///< row after row
  const std::uint8_t* back_sectors;  ///< per word
  std::size_t word_count;
};

/// Holds what the CUDA module asks of its caller, from any thread, one call at a time. No call throws.
struct ArcsCaller {
  void* self = nullptr;
  /// Tells the share done; false: stop.
  bool (*keep_going)(void* self, double fraction) = nullptr;
  /// Tells how arcs are packed, once; false: stop. It takes the caller a while, so that it had better be asked while
  /// the mesh is on its way.
  bool (*choose_packing)(void* self, ArcPacking* packing) = nullptr;
  /// Finds the arcs of nodes that are too much for the device; false: stop.
  bool (*find_rows)(void* self, const std::int32_t* nodes, std::int32_t count, FoundRows* rows) = nullptr;
  /// Makes room for the graph's offsets (node_count + 1) and words, whose number may be a guess the first time; what
  /// was there is lost; false: stop.
  bool (*make_room)(void* self, std::int64_t words, std::int64_t** offsets_to, std::uint64_t** words_to) = nullptr;
};

}  // namespace saddleback
