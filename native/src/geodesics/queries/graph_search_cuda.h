#pragma once
// Queries of a graph on a CUDA device.

#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "saddleback/geodesics/saddle_vertex_graph.h"

#include "geodesics/queries/graph_search.h"
#include "support/cuda/cuda_module.h"

namespace saddleback {

/// A graph's arcs on a CUDA device, from the first query there to the graph's end. Safe to use from any number of
/// threads.
class DeviceGraphs {
 public:
  struct Kept {
    int device;
    double step;  ///< for a front to advance by
    std::shared_ptr<const CudaGraph> graph;
  };
  /// Puts the graph there unless it is; `times` gets the upload. \throw DeviceError
  Kept on(int device, const SaddleVertexGraph& graph, DeviceTimes& times);

  void tell(const DeviceTimes& times);
  std::optional<DeviceTimes> last_times() const;
  bool any() const;

 private:
  mutable std::mutex mutex_;
  std::optional<Kept> kept_;
  std::optional<DeviceTimes> last_;
};

/// Holds where fields go: in the order of the vertices, one after the other.
struct FieldsTo {
  double* distances;
  Index* sources;  ///< or null
};

/// Seeds in flat arrays, as a device takes them.
struct FlatSeeds {
  std::vector<std::int32_t> nodes, sources;
  std::vector<double> distances;

  void resize(std::size_t count);
  void set(std::size_t i, const NodeSeed& seed);
};

/// Least distance and, among equals, least source of every node: what nearest_sources finds. \throw DeviceError,
/// Cancelled.
void cuda_nearest_sources(const SaddleVertexGraph& graph, int device, const FlatSeeds& seeds, const JobStage& stage,
                          std::vector<double>& distances, std::vector<Index>& sources);

/// A field for each list of seeds: the same bits as GraphSearch. \throw DeviceError, Cancelled.
void cuda_search(const SaddleVertexGraph& graph, std::span<const std::vector<Seed>> seeds, const QueryOptions& options,
                 const FieldsTo& to, const JobStage& stage);

}  // namespace saddleback
