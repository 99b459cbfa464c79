#include "tessellation/relaxation/relaxation_run.h"

#include <algorithm>

#include "saddleback/error.h"

namespace saddleback {
namespace {

/// Small falls, one after the other, that end a run. A quasi-Newton step may be poor and the next one good.
int patience(RelaxationMethod method) { return method == RelaxationMethod::lbfgs ? 3 : 1; }

void end(RelaxationLog& log, bool converged, const char* reason) {
  log.converged = converged;
  log.stop_reason = reason;
}

}  // namespace

RelaxationLog log_of_start(const Relaxation& relaxation) {
  RelaxationLog log;
  log.energy.push_back(relaxation.state().energy);
  return log;
}

void take_step(Relaxation& relaxation, const CentroidalVoronoiOptions& options, const JobStage& stage,
               RelaxationLog& log) {
  if (log.iterations >= options.stop.max_iterations) return end(log, false, "max_iterations");
  const double part = 1.0 / options.stop.max_iterations;
  const JobStage step =
      stage.part(log.iterations * part, (log.iterations + 1) * part,
                 message("Relaxing cells, step ", log.iterations + 1, " of ", options.stop.max_iterations));
  if (!relaxation.advance(step))
    return end(log, true, relaxation.is_at_rest() ? "least_move" : "no step lowers the energy");
  const double energy = relaxation.state().energy, fall = log.energy.back() - energy;
  log.energy.push_back(energy);
  ++log.iterations;
  log.small_falls = fall <= options.stop.tolerance * energy ? log.small_falls + 1 : 0;
  if (log.small_falls >= patience(options.method)) end(log, true, "tolerance");
}

void show(const Relaxation& relaxation, const CentroidalVoronoiOptions& options, const RelaxationLog& log) {
  if (options.watch) options.watch->show({relaxation.state().sites, log.iterations, relaxation.state().energy});
}

void relax(Relaxation& relaxation, const CentroidalVoronoiOptions& options, const JobStage& stage, RelaxationLog& log) {
  while (log.stop_reason.empty()) {
    const int before = log.iterations;
    take_step(relaxation, options, stage, log);
    if (log.iterations > before) show(relaxation, options, log);
  }
}

}  // namespace saddleback
