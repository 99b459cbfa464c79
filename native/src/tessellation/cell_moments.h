#pragma once
// Mass, centre and energy of cells.

#include <array>
#include <span>
#include <vector>

#include "tessellation/cell_claims.h"

namespace saddleback {

/// Integrals over a cell with weight density^2.
struct CellMoments {
  double area = 0;  ///< without the weight
  double mass = 0;
  Vec2 moment = Vec2::Zero();  ///< of the position in the site's tangent plane
  double energy = 0;           ///< of the squared distance to the site
};

/// What integrals over whole faces need, for a density that does not change while sites move: density^2 integrated
/// with the barycentric coordinates, and with what squared distances fall short of their corners' interpolation.
class FaceWeights {
 public:
  /// `density` (V,) or empty for 1; must outlive the weights. O(F).
  FaceWeights(const Mesh& mesh, std::span<const double> density, int threads);

  struct Weights {
    std::array<double, 3> corner;  ///< their sum is the mass
    double bulge;
  };
  const Weights& operator[](Index face) const { return weights_[face]; }
  std::span<const double> density() const { return density_; }

 private:
  std::span<const double> density_;
  std::vector<Weights> weights_;
};

/// Per cell. Integrals of density^2 times squared distance (both quadratic in a flat face) are exact. The same for any
/// thread count. \throw Cancelled. O(V + pieces).
std::vector<CellMoments> cell_moments(const CellClaims& claims, const FaceWeights& weights, int threads,
                                      const JobStage& stage);

}  // namespace saddleback
