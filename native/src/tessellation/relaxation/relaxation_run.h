#pragma once
// The steps of a relaxation, from its start to one of its ends.

#include <string>
#include <vector>

#include "tessellation/relaxation/relaxation.h"

namespace saddleback {

/// The record of a relaxation so far.
struct RelaxationLog {
  std::vector<double> energy;  ///< of the start and after each step
  int iterations = 0;
  int small_falls = 0;  ///< of the energy, one after the other
  bool converged = false;
  std::string stop_reason;  ///< as CentroidalVoronoi's; empty while there may be another step
};

/// Returns the log of sites that have not moved yet.
RelaxationLog log_of_start(const Relaxation& relaxation);
/// One step, or the reason why there is none. \throw Cancelled, nothing changed.
void take_step(Relaxation& relaxation, const CentroidalVoronoiOptions& options, const JobStage& stage,
               RelaxationLog& log);
/// Shows the sites to the watch.
void show(const Relaxation& relaxation, const CentroidalVoronoiOptions& options, const RelaxationLog& log);
/// All steps, each shown. \throw Cancelled, the log as of the last step.
void relax(Relaxation& relaxation, const CentroidalVoronoiOptions& options, const JobStage& stage, RelaxationLog& log);

}  // namespace saddleback
