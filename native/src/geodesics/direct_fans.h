#pragma once
// The arcs of points that are no vertices.

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/surface_points.h"

#include "geodesics/disk_finder.h"
#include "geodesics/window_propagation.h"
#include "support/scratch_pool.h"

namespace saddleback {

class SaddleVertexGraph;

/// Arcs from points to vertices, a row a point, in compressed sparse rows.
struct DirectFans {
  std::vector<std::int64_t> offsets{0};  ///< (n + 1,)
  std::vector<DirectArc> arcs;           ///< each row by vertex

  std::size_t size() const { return offsets.size() - 1; }
  std::span<const DirectArc> operator[](std::size_t i) const {
    return std::span(arcs).subspan(offsets[i], offsets[i + 1] - offsets[i]);
  }
  void clear() {
    offsets.resize(1);
    arcs.clear();
  }
};

/// Whether the angles of arcs are wanted, which are as much work as all else about an arc.
enum class FanAngles { none, both };

/// Finds fans by the rule that the graph's own arcs were found by: to the k nearest vertices, to those that no way over
/// another serves within the accuracy or, for the exact graph, to twice as many as a vertex has. One a thread.
class DirectFanFinder {
 public:
  /// Appends a row for every point: lengths as they are, not yet rounded as the graph's arcs are; nothing for a point
  /// that is a vertex. What a point sees does not depend on the others. \throw Cancelled.
  /// `limits`: for each point the length from which on arcs, but those to its face's corners, are not wanted; empty:
  /// none (nor for the exact graph).
  void find(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, std::span<const double> limits,
            FanAngles angles, DirectFans& fans, const JobStage& stage);

 private:
  using Batch = std::span<const std::size_t>;
  bool see(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, std::span<const double> limits,
           Batch batch, const JobStage& stage);
  void append_arcs(const SaddleVertexGraph& graph, int lane, FanAngles angles, std::vector<DirectArc>& arcs);
  void append_row(std::vector<DirectArc>& arcs);
  void find_exactly(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, DirectFans& fans,
                    const JobStage& stage);

  const FanMesh* mesh_ = nullptr;
  std::unique_ptr<DiskFinder> waves_;
  std::unique_ptr<WindowPropagator> propagator_;  ///< for the exact graph
  std::vector<std::size_t> batch_;
  std::vector<DirectArc> row_;
};

/// How many fans could be found in the time that the first ones wait for what all need; 0 when that is there.
double fans_a_fan_mesh_costs(const SaddleVertexGraph& graph);

/// Finders for the threads of one call, and what they share.
class FanTeam {
 public:
  /// \throw Cancelled. O(V) at the first points that are no vertices.
  FanTeam(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, int threads, const JobStage& stage);
  DirectFanFinder& operator[](int thread) { return *finders_[thread]; }

 private:
  std::vector<ScratchPool<DirectFanFinder>::Lease> finders_;
};

/// Takes the fan of the point of an index. May be called by several threads at once.
using UseFan = std::function<void(Index, std::span<const DirectArc>)>;
/// Calls use(i, fan) once for every point that is no vertex, in no particular order; what it is called with is the same
/// for any number of threads (0: all cores). `limits` as for DirectFanFinder. \throw Cancelled.
void for_each_fan(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, std::span<const double> limits,
                  FanAngles angles, int threads, const JobStage& stage, const UseFan& use);

/// All fans at once, with their angles. \throw Cancelled.
DirectFans direct_fans(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, int threads,
                       const JobStage& stage);

}  // namespace saddleback
