#include "tessellation/relaxation/cells_across_curves.h"

#include <algorithm>
#include <cmath>

namespace saddleback {
namespace {

/// A stretch of a curve that one cell has.
struct Stretch {
  double length = 0;
  Index curve = k_none;
  SurfacePoint middle;
};

/// A curve at points so near to each other that hardly a cell is missed.
class Walk {
 public:
  Walk(const SurfaceCurve& curve, double step) {
    for (const CurveSegment& segment : curve.segments()) {
      const auto parts = std::max(1, static_cast<int>(std::ceil(segment.length / step)));
      for (int i = 0; i < parts; ++i) {
        const double share = (i + 0.5) / parts;
        points_.push_back({segment.face, normalized_barycentric((1 - share) * segment.begin + share * segment.end)});
        lengths_.push_back(segment.length / parts);
      }
    }
  }
  /// Calls visit(cell, stretch) for the cells in the order in which the curve runs through them.
  template <class Visit>
  void for_each_cell(const Mesh& mesh, const GeodesicVoronoi& cells, Index curve, Visit&& visit) const {
    for (std::size_t i = 0; i < points_.size();) {
      const Index cell = cells.cell_at(mesh, points_[i]);
      const std::size_t begin = i;
      double length = 0;
      for (; i < points_.size() && (i == begin || cells.cell_at(mesh, points_[i]) == cell); ++i) length += lengths_[i];
      visit(cell, Stretch{length, curve, points_[(begin + i) / 2]});
    }
  }

 private:
  SurfacePoints points_;
  std::vector<double> lengths_;
};

}  // namespace

bool hold_stray_sites(const Mesh& mesh, const GeodesicVoronoi& cells, std::span<const SurfaceCurve* const> curves,
                      std::span<const Index> fixed, SurfacePoints& sites, std::vector<Index>& held) {
  constexpr double k_steps_a_cell = 20;
  const double step = std::sqrt(mesh.area() / static_cast<double>(sites.size())) / k_steps_a_cell;
  std::vector<std::uint8_t> is_free(sites.size());
  for (std::size_t i = 0; i < sites.size(); ++i) is_free[i] = held[i] == k_none;
  for (const Index site : fixed) is_free[site] = 0;
  std::vector<Stretch> longest(sites.size());
  for (Index curve = 0; curve < static_cast<Index>(curves.size()); ++curve) {
    Walk(*curves[curve], step).for_each_cell(mesh, cells, curve, [&](Index cell, const Stretch& stretch) {
      if (is_free[cell] && stretch.length > longest[cell].length) longest[cell] = stretch;
    });
  }
  bool found = false;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (longest[i].curve == k_none) continue;
    sites[i] = longest[i].middle;
    held[i] = longest[i].curve;
    found = true;
  }
  return found;
}

}  // namespace saddleback
