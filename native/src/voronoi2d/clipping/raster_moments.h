#pragma once
// Exact integrals of a raster over polygons.

#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/voronoi2d/planar_domain.h"
#include "saddleback/voronoi2d/relax_2d.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

namespace saddleback::voronoi2d {

/// Integrals of a power of the density, in the unit of `RasterIntegral::exponent`: mass, first moments, and the moment
/// of squared distance. Places count from the raster's middle.
struct RasterMoments {
  double mass = 0, squared = 0;
  Vec2 first = Vec2::Zero();
  RasterMoments& operator+=(const RasterMoments& other) {
    mass += other.mass;
    squared += other.squared;
    first += other.first;
    return *this;
  }
};

/// Integrates over a polygon by its border: by Gauss's theorem an integral over a polygon is one along its border, of
/// what lies to the left in the row: sums from the raster's left side, made once. Within a cell of the raster they are
/// cubic along a straight border, which Simpson's rule integrates exactly.
class RasterIntegral {
 public:
  /// The raster lies over the domain's bounding box. `power`: of the density, 1 or 2.
  RasterIntegral(const PlanarDomain& domain, const DensityRaster& density, int power);

  const Vec2& middle() const { return middle_; }
  /// Returns the exponent of the power of two that the density is divided by, so that its squares stay among the
  /// doubles.
  int exponent() const { return exponent_; }
  /// Integrates along the border of a loop in the box: positive inside when it turns counter-clockwise. O(raster cells
  /// crossed).
  RasterMoments along(std::span<const Vec2> loop) const;
  /// Integrates the mass along a straight way in the box. O(raster cells crossed).
  double mass_between(const Vec2& from, const Vec2& to) const;

 private:
  struct Sums {
    double zeroth = 0, first = 0, second = 0;  ///< integrals over x, from the left side on
  };
  double line(Index column) const { return left_ + static_cast<double>(column) * width_; }
  Sums left_of(Index row, Index column, double x) const;
  void add_piece(Index row, Index column, const Vec2& from, const Vec2& to, RasterMoments& moments) const;
  /// Calls visit(row, column, from, to) for the pieces of a straight way in cells of the raster.
  template <class Visit>
  void for_pieces(const Vec2& from, const Vec2& to, const Visit& visit) const;

  Vec2 middle_;
  double left_, bottom_, width_, height_;  ///< the box's, from its middle; of one cell of the raster
  Index rows_, columns_;
  int exponent_ = 0;
  std::vector<double> weights_;
  std::vector<Sums> sums_;  ///< at the left of each cell of the raster
};

/// Returns the moments of each of `count` sites' cells. \throw Cancelled
std::vector<RasterMoments> moments_of(const ClippedCells& cells, Index count, const RasterIntegral& integral,
                                      int threads, const JobStage& stage);

/// Integrates the squared distance to the site of each cell.
double energy_of(std::span<const Vec2> sites, std::span<const RasterMoments> cells, const RasterIntegral& integral);

/// \throw InputError for a wrong number of values, and for values that are negative or not finite.
void check_density(const DensityRaster& density);

}  // namespace saddleback::voronoi2d
