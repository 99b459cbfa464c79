#include "tessellation/relaxation/annealing.h"

#include <cmath>
#include <numbers>

#include "saddleback/error.h"

#include "support/random_numbers.h"

namespace saddleback {
namespace {

// Less inertia or larger pushes keep the cells from settling, smaller ones let pairs rest where they are.
constexpr double k_inertia = 0.9;    // of the last step
constexpr double k_warmth = 0.02;    // first pushes, in roots of the cell's area: the deviation of either coordinate
constexpr std::uint64_t k_seed = 3;  // any

/// Two independent normal numbers of deviation 1 [box1958].
Vec2 normal_pair(std::uint64_t key, std::uint64_t counter) {
  const double radius = std::sqrt(-2 * std::log1p(-uniform(key, 2 * counter)));
  const double angle = 2 * std::numbers::pi * uniform(key, 2 * counter + 1);
  return {radius * std::cos(angle), radius * std::sin(angle)};
}

}  // namespace

void anneal(Relaxation& relaxation, int steps, const JobStage& stage) {
  const double part = 1.0 / steps;
  TangentField last(relaxation.state().sites.size(), Vec2::Zero());
  for (int step = 0; step < steps; ++step) {
    const double warmth = k_warmth * (1 - step * part);
    const std::uint64_t key = mixed(k_seed, static_cast<std::uint64_t>(step));
    TangentField next = relaxation.lloyd_direction();
    for (std::size_t i = 0; i < next.size(); ++i) {
      const double size = std::sqrt(relaxation.state().moments[i].area);
      next[i] += k_inertia * last[i] + warmth * size * normal_pair(key, i);
    }
    last = relaxation.go(std::move(next), stage.part(step * part, (step + 1) * part,
                                                     message("Annealing cells, step ", step + 1, " of ", steps)));
  }
}

}  // namespace saddleback
