#pragma once
// The places of sites while they are being relaxed, for another thread to show.

#include <memory>
#include <mutex>

#include "saddleback/mesh/surface_points.h"

namespace saddleback {

/// The sites after some iteration.
struct RelaxationStep {
  SurfacePoints sites;
  int iterations = 0;  ///< 0: before the first one
  double energy = 0;   ///< as in CentroidalVoronoi
};

/// Keeps the latest step of a relaxation. One thread computes and shows, any other looks: neither waits for more than
/// the exchange of a pointer.
class RelaxationWatch {
 public:
  virtual ~RelaxationWatch() = default;
  /// Shows a relaxation after each iteration that was accepted: the energy never rises, but where the iterations begin
  /// again. O(sites).
  virtual void show(RelaxationStep step);
  /// Null before the first step.
  std::shared_ptr<const RelaxationStep> latest() const;

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const RelaxationStep> latest_;
};

}  // namespace saddleback
