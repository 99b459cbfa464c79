#pragma once
// All faces laid out flat, each in its own plane (FaceChart), once: they are asked for again and again.

#include <Eigen/Core>
#include <vector>

#include "saddleback/mesh/mesh.h"
#include "saddleback/mesh/surface_points.h"

#include "support/threads/parallel.h"

namespace saddleback::distribution {

class FlatFaces {
 public:
  FlatFaces(const Mesh& mesh, int threads) : corners_(static_cast<std::size_t>(mesh.face_count())) {
    parallel_for(mesh.face_count(), threads, 4096, [&](Index f, int) {
      const FaceChart chart(mesh, f);
      corners_[f] = {chart.corner[1].x(), chart.corner[2].x(), chart.corner[2].y()};
    });
  }

  /// The point with these weights of corners 1 and 2.
  Vec2 place(Index face, const Vec2& weights) const {
    const Corners& at = corners_[face];
    return {weights.x() * at.first + weights.y() * at.x, weights.y() * at.y};
  }
  Vec2 place(const SurfacePoint& point) const {
    return place(point.face, {point.barycentric[1], point.barycentric[2]});
  }
  /// The linear map of the face's plane that takes its edges from corner 0 to the ones given.
  Eigen::Matrix2d turn_to(Index face, const Vec2& to_first, const Vec2& to_second) const {
    const Corners& at = corners_[face];
    Eigen::Matrix2d turn;
    turn.col(0) = to_first / at.first;
    turn.col(1) = (to_second - turn.col(0) * at.x) / at.y;
    return turn;
  }

 private:
  struct Corners {
    double first;  ///< corner 1 on the x axis
    double x, y;   ///< corner 2
  };
  std::vector<Corners> corners_;
};

}  // namespace saddleback::distribution
