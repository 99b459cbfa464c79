#pragma once
// How the time of a graph's build is spread.

#include <cstdint>
#include <mutex>

#include "saddleback/job.h"
#include "saddleback/mesh.h"

namespace saddleback {

/// What finding the arcs of some vertices took, and how many there are.
struct ArcWork {
  std::int64_t sources = 0, windows = 0, arcs = 0;
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

  BuildProgress(const Mesh& mesh, double expected, const JobStage& stage);

  /// For those who only have to stop when they are asked to.
  const JobStage& stage() const { return stage_; }
  /// Of the tables. \throw Cancelled.
  void laid(double share) const { stage_.update(share * laid_); }
  /// More arcs are found; from any thread. \throw Cancelled.
  void found(const ArcWork& more);
  /// What is left when all arcs are found.
  JobStage joining() const { return stage_.part(share(), 1); }

 private:
  double share() const;

  const JobStage stage_;
  const double source_count_, expected_;
  double laid_;  ///< share of the whole
  std::mutex guard_;
  ArcWork done_;
};

}  // namespace saddleback
