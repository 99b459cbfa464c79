#include "geodesics/queries/point_search.h"

#include <algorithm>

#include "geodesics/queries/arc_scale.h"
#include "geodesics/queries/relax_row.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
// Of a short arc: narrower than for fields, as nodes beyond the target's own key are expanded for nothing, and nodes
// out of order are expanded again. On graded meshes it is the short edges that count: most nodes are there.
constexpr double k_bucket_width = 1.0 / 16;
constexpr double k_short_share = 0.1;
// Arcs are rounded to 22 bits or more, as the number of vertices leaves: a path may fall short of the straight line by
// this part of it.
constexpr double k_straight_line = 1 - 2e-7;
constexpr double k_rounding = 1 - 1e-12;
constexpr std::int64_t k_arcs_a_check = 1 << 18;

}  // namespace

class PointSearch::Run {
 public:
  Run(PointSearch& memory, const SaddleVertexGraph& graph, const Landmarks& landmarks, const Landmarks::Target& target,
      double upper)
      : memory_(memory), graph_(graph), landmarks_(landmarks), target_(target), best_(upper) {}

  void set_target(Index node, double distance) { meet(node).to_target = distance; }

  void offer(Index node, double distance) {
    const Met& met = meet(node);
    best_ = std::min(best_, distance + met.to_target);
    if (distance + met.bound < best_) memory_.queue_.push(node, distance + met.bound);
  }

  PointDistance search(const JobStage& stage) {
    const ArcRows& arcs = graph_.arcs();
    const std::uint64_t* const words = arcs.words().data();
    BucketQueue& queue = memory_.queue_;
    const RelaxRow relax = relax_row();
    RowOffer row{0, memory_.distances_.data(), nullptr, k_none};
    Index settled = 0;
    std::int64_t arcs_to_check = k_arcs_a_check;
    // Along a path keys rise but for the rounding of bounds, so that a bucket may hold keys a little below its own.
    const double slack = landmarks_.slack();
    for (BucketQueue::Entry entry{}; queue.pop(entry) && queue.least_key() * k_rounding - slack < best_;) {
      row.distance = memory_.distances_[entry.node];
      const double key = row.distance + memory_.met_[entry.node].bound;
      if (!queue.is_current(entry, key) || key >= best_) continue;
      ++settled;
      const std::int64_t end = arcs.first(entry.node + 1);
      arcs_to_check -= end - arcs.first(entry.node);
      if (arcs_to_check < 0) {
        arcs_to_check = k_arcs_a_check;
        stage.check();
      }
      arcs.look_at(entry.node);
      for (std::int64_t first = arcs.first(entry.node); first < end; first += LoweredNodes::k_most) {
        const auto count = static_cast<int>(std::min<std::int64_t>(end - first, LoweredNodes::k_most));
        relax(arcs.codec(), words + first, count, row, lowered_);
        for (int i = 0; i < lowered_.count; ++i) offer(lowered_.nodes[i], lowered_.distances[i]);
      }
    }
    return {best_, settled};
  }

 private:
  Met& meet(Index node) {
    Met& met = memory_.met_[node];
    if (met.bound >= 0) return met;
    memory_.touched_.push_back(node);
    const Vec3& place = graph_.mesh().position(graph_.vertex_of(node));
    const double straight = graph_.mesh().bird((place - target_.position).norm()) * k_straight_line - rounding_of_arcs_;
    met.bound = std::max({0.0, straight, landmarks_.bound(node, target_)});
    return met;
  }

  PointSearch& memory_;
  const SaddleVertexGraph& graph_;
  const Landmarks& landmarks_;
  const Landmarks::Target& target_;
  /// A path has fewer arcs than there are nodes, each rounded by half a quantum.
  const double rounding_of_arcs_ = graph_.arcs().codec().quantum() * graph_.mesh().vertex_count();
  double best_;
  LoweredNodes lowered_;
};

PointDistance PointSearch::run(const SaddleVertexGraph& graph, const Landmarks& landmarks, const PointFan& from,
                               const PointFan& to, const Vec3& position, double upper, const JobStage& stage) {
  const auto count = static_cast<std::size_t>(graph.arcs().node_count());
  distances_.resize(count, k_infinity);
  met_.resize(count);
  if (width_ == 0) width_ = k_bucket_width * shortest_arcs_below(graph.arcs(), k_short_share);
  const Landmarks::Target target = landmarks.target(to, position);
  Run work(*this, graph, landmarks, target, upper);
  struct Cleaner {
    PointSearch& memory;
    ~Cleaner() { memory.clean(); }
  } const cleaner{*this};
  for (const PointFan::Arc& arc : to.arcs) work.set_target(graph.node_of(arc.vertex), arc.length);
  // Keys rise by at most two arcs a step.
  double least = k_infinity;
  for (const PointFan::Arc& arc : from.arcs) least = std::min(least, arc.length);
  const double longest = std::max(graph.arcs().longest(), from.reach);
  queue_.reset(width_, 3 * longest, least);
  for (const PointFan::Arc& arc : from.arcs) {
    const Index node = graph.node_of(arc.vertex);
    distances_[node] = arc.length;
    work.offer(node, arc.length);
  }
  return work.search(stage);
}

void PointSearch::clean() {
  for (const Index node : touched_) {
    distances_[node] = k_infinity;
    met_[node] = {};
  }
  touched_.clear();
}

}  // namespace saddleback
