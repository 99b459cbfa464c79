#pragma once
// How the time of a graph's build is spread.

#include <cstdint>
#include <mutex>

#include "saddleback/job.h"
#include "saddleback/mesh/mesh.h"

#include "support/work_clock.h"

namespace saddleback {

/// Vertices, and arcs that start there.
struct ArcCount {
  std::int64_t sources = 0, arcs = 0;
};

/// How much of a build is done: tables are laid, arcs are found, and then joined with their reverses. What the last two
/// take is only known from the vertices whose arcs are found, if these are from all over the mesh; until then it is
/// guessed.
class BuildProgress {
 public:
  /// What finding the arcs of a vertex is expected to take, in microseconds on one machine.
  static double by_accuracy(const Mesh& mesh, double accuracy);
  static double by_count(const Mesh& mesh, Index k);
  static double by_all(const Mesh& mesh);
  /// By the one that is not 0, or all.
  static double by_rule(const Mesh& mesh, Index k, double accuracy);

  BuildProgress(const Mesh& mesh, double expected, int threads, const JobStage& stage);

  /// For those who only have to stop when they are asked to.
  const JobStage& stage() const { return stage_; }
  /// Of the tables, from one share of their time to another.
  JobStage laying(double begin, double end) const { return stage_.part(begin * laid_, end * laid_); }
  /// They are. By the thread that made this. \throw Cancelled.
  void laid();
  /// Calls `find`, which finds the arcs of some vertices and returns how many of both; from any thread. \throw
  /// Cancelled.
  template <class Find>
  void time(Find&& find) {
    const bool is_watched = stage_.is_watched();
    const WorkClock clock(is_watched);
    const ArcCount more = find();
    if (is_watched) found(more, clock.seconds());
  }
  /// What is left when all arcs are found.
  JobStage joining() const { return stage_.part(share(), 1); }

 private:
  void found(const ArcCount& more, double seconds);
  double share() const;

  const JobStage stage_;
  const double source_count_, threads_;
  const WorkClock clock_;
  double expected_;    ///< of finding a vertex's arcs, as below
  double laid_;        ///< share of the whole
  double laying_ = 0;  ///< in seconds
  std::mutex guard_;
  ArcCount done_;
  double finding_ = 0;  ///< seconds of all threads
};

}  // namespace saddleback
