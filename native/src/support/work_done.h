#pragma once
// The progress of work that goes through a known number of things.

#include <atomic>

#include "saddleback/job.h"

namespace saddleback {

/// Counts what any thread has done of a known amount of work and tells it a stage, at most k_steps times in all.
class WorkDone {
 public:
  WorkDone(const JobStage& stage, double all) : stage_(stage), all_(all > 0 ? all : 1), next_(all_ / k_steps) {}

  /// \throw Cancelled.
  void add(double more) {
    const double done = done_.fetch_add(more, std::memory_order_relaxed) + more;
    if (done < next_.load(std::memory_order_relaxed)) return stage_.check();
    next_.store(done + all_ / k_steps, std::memory_order_relaxed);
    stage_.update(done / all_);
  }

 private:
  static constexpr double k_steps = 512;
  const JobStage stage_;
  const double all_;
  std::atomic<double> done_{0}, next_;
};

}  // namespace saddleback
