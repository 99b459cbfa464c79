#pragma once
// Pieces of faces, so that lists of what lies there stay short on faces that are larger than what lies on them.

#include <algorithm>
#include <cmath>
#include <vector>

#include "saddleback/mesh/mesh.h"

namespace saddleback::distribution {

/// Every face is cut into n * n cells by its weights of corners 1 and 2 (half of the cells are beyond the face), n = 1
/// for most meshes.
class FaceBuckets {
 public:
  /// n is the least for which a cell's sides are at most `longest`, within limits.
  FaceBuckets(const Mesh& mesh, double longest) {
    first_.reserve(static_cast<std::size_t>(mesh.face_count()) + 1);
    std::int64_t count = 0;
    for (Index f = 0; f < mesh.face_count(); ++f) {
      first_.push_back(static_cast<Index>(count));
      const Index n = divisions(mesh, f, longest);
      count += static_cast<std::int64_t>(n) * n;
    }
    first_.push_back(static_cast<Index>(count));
  }

  Index count() const { return first_.back(); }
  Index divisions(Index face) const {
    const Index cells = first_[face + 1] - first_[face];
    return cells == 1 ? 1 : static_cast<Index>(std::lround(std::sqrt(static_cast<double>(cells))));
  }
  Index at(Index face, const Vec2& weights) const {
    const Index n = divisions(face);
    if (n == 1) return first_[face];
    // A point of the edge between corners 1 and 2 may be on a cell's corner, beyond which no cell is of the face.
    const Index j = place(weights.y(), n), i = std::min(place(weights.x(), n), n - 1 - j);
    return first_[face] + j * n + i;
  }
  /// Calls visit(bucket) for those that meet the box from low to high.
  template <class Visit>
  void visit(Index face, const Vec2& low, const Vec2& high, Visit&& visit) const {
    visit_cells(face, low, high, [&](Index bucket, const Vec2&, double) { visit(bucket); });
  }
  /// Calls visit(bucket, middle, share), too: no point of the cell is farther from the one of weights `middle` than the
  /// sum of the lengths of the face's edges from corner 0, times `share`.
  template <class Visit>
  void visit_cells(Index face, const Vec2& low, const Vec2& high, Visit&& visit) const {
    const Index n = divisions(face);
    if (n == 1) return visit(first_[face], Vec2(1.0 / 3, 1.0 / 3), 2.0 / 3);
    const Index left = place(low.x(), n), right = place(high.x(), n), top = place(high.y(), n);
    for (Index j = place(low.y(), n); j <= top; ++j)
      for (Index i = left; i <= right && i + j < n; ++i)
        visit(first_[face] + j * n + i, Vec2(i + 0.5, j + 0.5) / n, 0.5 / n);
  }

 private:
  static Index place(double weight, Index n) { return std::clamp(static_cast<Index>(weight * n), Index{0}, n - 1); }

  static Index divisions(const Mesh& mesh, Index face, double longest) {
    constexpr double k_most = 512, k_most_per_square = 8;  // needles get no more cells than their area is worth
    const double edge = std::max({mesh.length(3 * face), mesh.length(3 * face + 1), mesh.length(3 * face + 2)});
    const double worth = 1 + std::sqrt(k_most_per_square * mesh.face_area(face)) / longest;
    const double most = std::clamp(std::min(worth, std::sqrt(2e7 / mesh.face_count())), 1.0, k_most);
    return static_cast<Index>(std::clamp(std::ceil(edge / longest), 1.0, most));
  }

  std::vector<Index> first_;  ///< per face
};

}  // namespace saddleback::distribution
