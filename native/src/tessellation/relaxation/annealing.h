#pragma once
// Sites that are shaken, less and less, until few cells are irregular.

#include "tessellation/relaxation/relaxation.h"

namespace saddleback {

/// Moves the sites by steps that each keep most of the last one, go on to the centers of the cells, and add a random
/// push that fades to nothing. A relaxation alone ends where cells with five and seven neighbors face each other
/// across cells that are even; with inertia and warmth such pairs wander, meet and vanish. The pushes depend on nothing
/// but the numbers of steps and sites.
///
/// Simulated annealing [kirkpatrick1983] by Langevin's equation of motion [langevin1908]; [lu2012] has random
/// displacements and relaxations in turn for the same aim. \throw Cancelled, the sites as after the last step.
void anneal(Relaxation& relaxation, int steps, const JobStage& stage);

}  // namespace saddleback
