#pragma once
// The arcs of points that are no vertices.

#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/surface_points.h"

#include "geodesics/graph/geodesic_disks.h"
#include "geodesics/graph/visible_vertices.h"
#include "support/memory/scratch_pool.h"

namespace saddleback {

class SaddleVertexGraph;

/// A vertex that a point sees, without the angles of a DirectArc, which are as much work as all else about it.
struct SeenNode {
  Index node;
  Index edge;     ///< of the waves' mesh, across which it is seen; k_none: `from` is no place but the direction back, 0
  bool is_arc;    ///< else the way over another vertex serves as well, within the accuracy
  double length;  ///< as it is
  Vec2 place;     ///< in the chart of the point's face, from the point
  Vec2 from;      ///< the start of `edge` in the same plane
};

/// Holds what points see, a row a point, in compressed sparse rows.
template <class Arc>
struct FanRows {
  std::vector<std::int64_t> offsets{0};  ///< (n + 1,)
  std::vector<Arc> arcs;

  std::size_t size() const { return offsets.size() - 1; }
  std::span<const Arc> operator[](std::size_t i) const {
    return std::span(arcs).subspan(offsets[i], offsets[i + 1] - offsets[i]);
  }
  void clear() {
    offsets.resize(1);
    arcs.clear();
  }
};
using DirectFans = FanRows<DirectArc>;  ///< each row by vertex

/// Holds what one point sees, where it was found: arcs first, else in no particular order.
class SeenView {
 public:
  /// The source in a lane of waves that have run; the view lasts until they run again.
  SeenView(GeodesicDisks& waves, int lane)
      : chosen_(waves.chosen(lane)), served_(waves.served(lane)), rows_(waves.sightings()), unit_(waves.unit(lane)) {}
  /// Arcs all.
  explicit SeenView(std::span<const SeenNode> listed) : listed_(listed) {}

  std::size_t size() const { return listed_.size() + chosen_.size() + served_.size(); }
  std::size_t arc_count() const { return listed_.size() + chosen_.size(); }
  /// Calls visit(i, node) for all.
  template <class Visit>
  void visit(Visit&& visit) const {
    std::size_t next = 0;
    for (const SeenNode& node : listed_) visit(next++, node);
    for (const std::int32_t i : chosen_) visit(next++, seen_node(i, true));
    for (const std::int32_t i : served_) visit(next++, seen_node(i, false));
  }

 private:
  SeenNode seen_node(std::int32_t i, bool is_arc) const {
    const Vec2 place = unit_ * Vec2(rows_.x[i], rows_.y[i]), from = unit_ * Vec2(rows_.from_x[i], rows_.from_y[i]);
    return {rows_.slot[i] / k_batch, rows_.edge[i] / k_batch, is_arc, place.norm(), place, from};
  }
  std::span<const SeenNode> listed_;
  std::span<const std::int32_t> chosen_, served_;
  SightingRows rows_{};
  double unit_ = 0;
};
/// Takes what the point of an index sees. May be called by several threads at once.
using UseSeen = std::function<void(Index, const SeenView&)>;

/// Says whether the angles of arcs are wanted, which are as much work as all else about an arc.
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
  /// Calls use(i, view) for every point that is no vertex.
  void view(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, std::span<const double> limits,
            const JobStage& stage, const UseSeen& use);

 private:
  using Batch = std::span<const std::size_t>;
  bool see(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, std::span<const double> limits,
           Batch batch, const JobStage& stage);
  void append_arcs(const SaddleVertexGraph& graph, int lane, FanAngles angles, std::vector<DirectArc>& arcs);
  void append_row(std::vector<DirectArc>& arcs);
  /// Calls each(i, lane) for every point in order, while what it sees is at hand: in a lane of the waves or, for the
  /// exact graph, in row_. Lane -1: it is a vertex.
  template <class Each>
  void see_each(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, std::span<const double> limits,
                const JobStage& stage, Each&& each);
  template <class Each>
  void see_each_exactly(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, const JobStage& stage,
                        Each&& each);

  const FanMesh* mesh_ = nullptr;
  std::unique_ptr<GeodesicDisks> waves_;
  std::unique_ptr<VisibleVertices> propagator_;  ///< for the exact graph
  std::vector<std::size_t> batch_;
  std::vector<DirectArc> row_;
  std::vector<SeenNode> listed_;
};

/// Returns how many fans could be found in the time that the first ones wait for what all need; 0 when that is there.
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

/// Does the same for what points see. No point is a vertex, and those that lie together on the surface best come
/// together.
void for_each_view(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, std::span<const double> limits,
                   int threads, const JobStage& stage, const UseSeen& use);

/// Direction, at the vertex from first_halfedge, back to the point that sees it.
double direction_back(const SaddleVertexGraph& graph, const SeenNode& seen);

/// All fans at once, with their angles. \throw Cancelled.
DirectFans direct_fans(const SaddleVertexGraph& graph, std::span<const SurfacePoint> points, int threads,
                       const JobStage& stage);

}  // namespace saddleback
