#pragma once
// The densities that copies follow: of each class its own, or one for all.

#include <algorithm>
#include <vector>

#include "saddleback/mesh/surface_points.h"
#include "saddleback/support/one_or_each.h"

namespace saddleback::distribution {

/// Densities (V,) that are linear within faces.
class ClassDensities {
 public:
  /// `lists`: one, or one a shape; empty: even. They must outlive this.
  ClassDensities(const Mesh& mesh, const std::vector<std::vector<double>>& lists) : mesh_(mesh), lists_(lists) {
    masses_.resize(lists.size(), 0);
    for (std::size_t i = 0; i < masses_.size(); ++i)
      for (Index f = 0; f < mesh.face_count(); ++f)
        masses_[i] += mesh.face_area(f) * of_list(i, f, Vec3::Constant(1.0 / 3));
  }

  bool is_even() const { return lists_.empty(); }
  /// Returns the integrals of the lists over the surface.
  const std::vector<double>& masses() const { return masses_; }
  double of_list(std::size_t i, Index face, const Vec3& weights) const {
    const Triangle& t = mesh_.triangles()[face];
    return lists_[i][t[0]] * weights[0] + lists_[i][t[1]] * weights[1] + lists_[i][t[2]] * weights[2];
  }

  double at(Index shape, const SurfacePoint& point) const {
    return of_list(list_of(shape), point.face, point.barycentric);
  }
  /// Returns a shape's density as a share of its mean over the surface; 1 where it is even.
  double relative(Index shape, const SurfacePoint& point) const {
    return is_even() ? 1 : at(shape, point) * mesh_.area() / masses_[list_of(shape)];
  }
  /// Returns the largest share of its mean that a shape's density comes to in a face. Where that is 0 it is all over
  /// the face, and else nowhere within.
  double most_relative(Index shape, Index face) const {
    if (is_even()) return 1;
    double most = 0;
    for (const Index vertex : mesh_.triangles()[face]) most = std::max(most, lists_[list_of(shape)][vertex]);
    return most * mesh_.area() / masses_[list_of(shape)];
  }

 private:
  std::size_t list_of(Index shape) const { return lists_.size() == 1 ? 0 : static_cast<std::size_t>(shape); }

  const Mesh& mesh_;
  const std::vector<std::vector<double>>& lists_;
  std::vector<double> masses_;
};

}  // namespace saddleback::distribution
