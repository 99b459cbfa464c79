#pragma once
// Exact geodesic distances: windows from every source and from every vertex where a shortest path may bend.

#include <cstdint>
#include <limits>
#include <memory>
#include <unordered_map>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/surface_points.h"

#include "geodesics/exact/exact_queue.h"
#include "geodesics/exact/exact_surface.h"

namespace saddleback {

/// Holds how a shortest path comes to a vertex: straight from its root (see Window::root).
struct Arrival {
  /// Stands instead of a half-edge: not reached, from the vertex `root` along an edge, or the vertex is source number
  /// `root`.
  static constexpr Index k_unreached = -1, k_along_edge = -2, k_at_source = -3;
  double x, y;     ///< from the root to the vertex, in the frame of the half-edge
  Index halfedge;  ///< through whose face it comes, to the apex
  Index root;
};

struct ExactPropagationOptions {
  double limit = std::numeric_limits<double>::infinity();
  bool break_ties = false;    ///< of sources at the same distance, up to rounding, the smaller number owns a vertex
  bool keep_windows = false;  ///< for `kept`
};

/// Window propagation after [chen1990] with the filters of [xin2009]: see exact_propagation.cpp.
class ExactPropagation {
 public:
  /// `sources` are checked and outlive this object.
  ExactPropagation(const ExactSurface& surface, const SurfacePoints& sources, const ExactPropagationOptions& options);

  /// \throw Cancelled, InputError where the windows to be kept take more memory than there is. Once.
  void run(const JobStage& stage);

  /// Infinity where no source reaches, or only beyond the limit.
  double distance(Index vertex) const { return distances_[vertex] <= options_.limit ? distances_[vertex] : k_far; }
  const Arrival& arrival(Index vertex) const { return arrivals_[vertex]; }
  /// Tells which source the root belongs to.
  Index owner(Index root) const;
  std::int64_t window_count() const { return window_count_; }
  /// All windows that were propagated, as blocks.
  const std::vector<WindowBlock*>& kept() const { return kept_; }
  /// Gives back the memory that only propagating needs, the kept windows too.
  void release();
  std::size_t nbytes() const;

 private:
  static constexpr double k_far = std::numeric_limits<double>::infinity();
  /// The nearest window that covered the angle opposite a half-edge, and where its ray to the apex crosses.
  struct Occupant {
    double distance, split;
  };

  void start(const JobStage& stage);
  void start_in_face(const SourceInFace& place);
  void fetch(Index halfedge) const;
  void drain(WindowBlock* block, const JobStage& stage);
  void keep(WindowBlock* block);
  double share_done() const;
  void offer(Index vertex, double distance, const Arrival& arrival);
  bool owns_before(const Arrival& a, const Arrival& b) const;
  bool cover_again();
  void cone(const Window& window);
  void pass_sources(const Window& window);
  Window left_by_sources(Window window) const;
  bool is_beaten_by_corners(const Window& window) const;
  bool circles_tip(const Window& window) const;
  bool goes_round(const Window& window);
  void propagate(const Window& window);
  void bend(Index vertex);
  void cone_opposite(Index vertex, Index out, double begin, double end);
  double arrival_angle(Index vertex) const;

  const ExactSurface& surface_;
  const SurfacePoints& sources_;
  const ExactPropagationOptions options_;
  std::unique_ptr<WindowQueue> queue_;
  std::vector<double> distances_, bent_at_;
  std::vector<Arrival> arrivals_;
  std::vector<Occupant> occupants_;
  std::vector<std::uint16_t> passed_;  ///< how many windows went through a needle; empty without needles
  std::unordered_map<std::uint64_t, Window> earlier_;  ///< by root and half-edge, where many did
  std::vector<Index> due_;
  std::vector<WindowBlock*> kept_;
  std::int64_t window_count_ = 0, block_count_ = 0;  ///< done
  Index reached_count_ = 0;                          ///< vertices
};

}  // namespace saddleback
