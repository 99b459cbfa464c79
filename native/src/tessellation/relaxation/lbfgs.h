#pragma once
// The L-BFGS direction on a product of tangent planes.

#include <deque>
#include <span>

#include "tessellation/log_map/tangent_moves.h"

namespace saddleback {

/// Remembers how the gradient changed along the last steps. Pairs are carried along when sites move: rotations of
/// tangent planes leave their products as they are.
///
/// After [nocedal1980]; on manifolds, with transported pairs, after [huang2015].
class LbfgsMemory {
 public:
  /// Minus the approximate inverse Hessian times the gradient. `stiffness` is the Hessian's diagonal to begin with, one
  /// a site: for a centroidal tessellation twice the cell's mass, with which the first direction is Lloyd's step.
  TangentField direction(const TangentField& gradient, std::span<const double> stiffness) const;

  /// Takes the pairs along, then adds the one of this step: the step made and by how much the gradient changed, both in
  /// the new tangent planes. Pairs without positive curvature tell nothing and are dropped.
  void add(const Moved& moved, TangentField gradient_change);
  void forget() { pairs_.clear(); }
  bool empty() const { return pairs_.empty(); }

 private:
  static constexpr std::size_t k_pairs = 7;
  struct Pair {
    TangentField step, change;
    double curvature;  ///< their product
  };
  std::deque<Pair> pairs_;  ///< oldest first
};

}  // namespace saddleback
