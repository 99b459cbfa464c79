#pragma once
// Sites that are shaken, less and less, until few cells are irregular.

#include "tessellation/relaxation/relaxation.h"

namespace saddleback {

/// Moves the sites by steps that each keep most of the last one, go on to the centers of the cells, and add a random
/// push that fades to nothing. A relaxation alone ends where cells with five and seven neighbors face each other
/// across cells that are even; with inertia and warmth such pairs wander, meet and vanish. The pushes depend on nothing
/// but the numbers of steps and sites.
///
/// S. Kirkpatrick, C. Gelatt, M. Vecchi: Optimization by simulated annealing (1983), by Langevin's equation of motion
/// (P. Langevin: Sur la theorie du mouvement brownien, 1908); for the same aim by random displacements and relaxations
/// in turn: L. Lu, F. Sun, H. Pan, W. Wang: Global optimization of centroidal Voronoi tessellation with Monte Carlo
/// approach (2012). \throw Cancelled, the sites as after the last step.
void anneal(Relaxation& relaxation, int steps, const JobStage& stage);

}  // namespace saddleback
