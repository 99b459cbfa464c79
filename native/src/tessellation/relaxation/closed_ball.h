#pragma once
// Relaxed sites whose dual is a triangulation of the surface, without one more of them.

#include "tessellation/relaxation/relaxation_run.h"

namespace saddleback {

/// The outcome of an exchange of sites: which faults are left.
struct Exchange {
  Index moved = 0;              ///< sites
  std::vector<DualIssue> left;  ///< empty: the dual is a triangulation
};

/// Moves sites from where they are least needed to where the cells break the closed-ball property (see DualIssue), lets
/// those settle, and looks again, until nothing breaks it. Then relaxes all, as the options say, in short runs of which
/// none that breaks it is kept: the sites about such a place stay from then on where they were. The energy may be above
/// that of before; from step to step of the new relaxation, whose log replaces the given one, it never rises.
///
/// Fixed sites stay, held ones stay on their curves. Where nothing breaks the property nothing is done, and where no
/// site can be spared, or 40 rounds do not help, or ten do not leave fewer faults, all are again where they were.
/// \throw Cancelled; then, when the best is to be returned, the sites are what they were, or nothing breaks the
/// property any more, and `log` and `result` are about them.
void close_balls(Relaxation& relaxation, const CentroidalVoronoiOptions& options, const JobStage& stage,
                 RelaxationLog& log, Exchange& result);

}  // namespace saddleback
