#include "saddleback/tessellation/geodesic_center.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "saddleback/error.h"
#include "saddleback/geodesics/log_map.h"
#include "saddleback/mesh/surface_curve.h"

#include "geodesics/wavefront/log_about.h"
#include "tessellation/log_map/tangent_moves.h"

namespace saddleback {
namespace {

// A step is done when it is this short, relative to the spread of the points.
constexpr double k_tolerance = 1e-9;
// The least share that a step must bring of what it would if the sum fell on as at its start.
constexpr double k_least_gain = 0.1;
// The sum is known to such a share of it.
constexpr double k_rounding = 1e-12;
// Positive curvature makes steps fall short by less than a half where a center is unique; far fewer are made.
constexpr int k_most_steps = 100;
// So many steps from a place in vain are few elsewhere.
constexpr int k_vain_before_vertices = 4;

std::vector<double> checked_weights(std::span<const double> weights, std::size_t count) {
  if (weights.empty()) return std::vector<double>(count, 1.0);
  if (weights.size() != count)
    throw InputError(message("weights: wanted one for each of the ", count, " points, got ", weights.size()));
  const auto bad = std::ranges::find_if(weights, [](double w) { return !(w >= 0) || std::isinf(w); });
  if (bad != weights.end()) {
    throw InputError(
        message("weights: wanted finite numbers of 0 or more, got ", *bad, " for point ", bad - weights.begin()));
  }
  if (std::ranges::all_of(weights, [](double w) { return w == 0; })) throw InputError("weights: all are 0");
  return {weights.begin(), weights.end()};
}

/// Points with their logarithms about a center that moves.
class Gathering {
 public:
  Gathering(const SaddleVertexGraph& graph, const SurfacePoints& points, std::vector<double> weights)
      : graph_(graph),
        mesh_(graph.mesh()),
        points_(points),
        weights_(std::move(weights)),
        places_(points),
        are_vertices_(
            std::ranges::all_of(points, [&](const SurfacePoint& point) { return vertex_at(mesh_, point) != k_none; })) {
    for (const SurfacePoint& point : points_) {
      const Triangle& t = mesh_.triangles()[point.face];
      corners_.insert(corners_.end(), t.begin(), t.end());
    }
    std::ranges::sort(corners_);
    corners_.erase(std::unique(corners_.begin(), corners_.end()), corners_.end());
  }

  /// The given point nearest in space to the weighted mean; the first where lengths were given.
  SurfacePoint start() {
    for (const SurfacePoint& point : points_)
      for (int i = 0; i < 3; ++i) radius_ = std::max(radius_, 2 * mesh_.length(3 * point.face + i));
    if (mesh_.is_intrinsic()) return points_[0];  // space does not tell what is near
    Vec3 mean = Vec3::Zero();
    double sum = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      mean += weights_[i] * position(mesh_, points_[i]);
      sum += weights_[i];
    }
    mean /= sum;
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const double distance = (position(mesh_, points_[i]) - mean).norm();
      if (distance < least) least = distance, best = i;
    }
    for (const SurfacePoint& point : points_)
      radius_ = std::max(radius_, 2 * (position(mesh_, point) - position(mesh_, points_[best])).norm());
    return points_[best];
  }

  /// Towards the center, in the tangent plane of a place.
  Vec2 step_at(const SurfacePoint& place, const JobStage& stage) {
    PlaceDistances seen;
    const LogMap map = log_of_corners(place, seen, stage);
    Vec2 sum = Vec2::Zero();
    double mass = 0;
    spread_ = energy_ = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vec2 log = log_of(map, seen, place, i);
      spread_ = std::max(spread_, log.norm());
      energy_ += weights_[i] * log.squaredNorm();
      sum += weights_[i] * log;
      mass += weights_[i];
    }
    energy_ /= mass;
    return sum / mass;
  }
  /// Where the sum falls fastest from a vertex, in its tangent plane, and as far as it leads; 0 where it rises all
  /// around. Round a saddle a way that bends there grows alike in every direction that is behind it: no mean tells
  /// that. O(points).
  Vec2 steepest_at(const SurfacePoint& vertex, const JobStage& stage) {
    constexpr int k_directions = 360;
    PlaceDistances seen;
    const LogMap map = log_of_corners(vertex, seen, stage);
    const double scale = angle_scale(mesh_, vertex), total = mesh_.total_angle(vertex_at(mesh_, vertex));
    const bool is_closed = !mesh_.is_boundary(vertex_at(mesh_, vertex));
    const double turn = total / (is_closed ? k_directions : k_directions - 1);  // both borders are directions, too
    std::vector<double> rates(k_directions, 0.0);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vec2 log = log_of(map, seen, vertex, i);
      const double angle = surface_angle(mesh_, vertex, std::atan2(log.y(), log.x()));
      for (int k = 0; k < k_directions; ++k) {
        double between = std::abs(turn * k - angle);
        if (is_closed) between = std::abs(std::remainder(between, total));
        rates[k] += weights_[i] * log.norm() * std::cos(std::min(between, std::numbers::pi));
      }
    }
    const auto best = std::ranges::max_element(rates);
    const double heading = turn / scale * static_cast<double>(best - rates.begin());
    const double mass = std::accumulate(weights_.begin(), weights_.end(), 0.0);
    return std::max(0.0, *best) / mass * Vec2(std::cos(heading), std::sin(heading));
  }
  /// Return, for the place of the last step, the distance of the farthest point, and the mean that is to be least:
  /// its gradient is the step twice, back.
  double spread() const { return spread_; }
  double energy() const { return energy_; }

 private:
  /// Wider and wider, until the map holds every corner.
  LogMap log_of_corners(const SurfacePoint& place, PlaceDistances& seen, const JobStage& stage) {
    while (true) {
      LogMap map = log_about(graph_, place, radius_, are_vertices_ ? nullptr : &places_, seen, stage);
      if (std::ranges::includes(map.vertices, corners_)) return map;
      radius_ *= 1.5;
    }
  }

  /// The shortest of the ways within a face, by a corner, and across an edge as rays have found it.
  Vec2 log_of(const LogMap& map, const PlaceDistances& seen, const SurfacePoint& place, std::size_t i) const {
    const SurfacePoint& point = points_[i];
    const FaceChart chart(mesh_, point.face);
    const Vec2 at = chart.to_plane(point.barycentric);
    double length = are_vertices_ ? std::numeric_limits<double>::infinity() : seen.values()[i];
    double angle = are_vertices_ ? 0 : seen.labels()[i];
    Vec2 between_corners = Vec2::Zero();
    for (int corner = 0; corner < 3; ++corner) {
      const auto known = std::ranges::lower_bound(map.vertices, mesh_.triangles()[point.face][corner]);
      const auto k = static_cast<std::size_t>(known - map.vertices.begin());
      between_corners += point.barycentric[corner] * map.uv[k];
      const double by_corner = map.distance[k] + (chart.corner[corner] - at).norm();
      if (by_corner <= length) length = by_corner, angle = map.angle[k];
    }
    if (const std::optional<Vec3> here = barycentric_in(mesh_, place, point.face)) {
      const double straight = (chart.to_plane(*here) - at).norm();
      if (straight <= length) return between_corners.normalized() * straight;
    }
    const double scale = angle_scale(mesh_, place);
    return length * Vec2(std::cos(angle / scale), std::sin(angle / scale));
  }

  const SaddleVertexGraph& graph_;
  const Mesh& mesh_;
  const SurfacePoints& points_;
  const std::vector<double> weights_;
  const WatchedPlaces places_;
  const bool are_vertices_;
  std::vector<Index> corners_;
  double radius_ = 0, spread_ = 0, energy_ = 0;
};

void check_points(const Mesh& mesh, const SurfacePoints& points) {
  if (points.empty()) throw InputError("points: wanted at least one, got none");
  check_surface_points(mesh, points, "points");
  const auto component = [&](const SurfacePoint& point) { return mesh.component_of(mesh.triangles()[point.face][0]); };
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (component(points[i]) != component(points[0]))
      throw InputError(message("points: 0 and ", i, " lie on separate parts of the mesh, between which no way leads"));
  }
}

/// A vector of the place that was moved to, in the tangent plane of the place before.
Vec2 carried_back(const Vec2& vector, const Moved& moved) {
  const Vec2& turn = moved.turns.front();
  return {turn.x() * vector.x() + turn.y() * vector.y(), turn.x() * vector.y() - turn.y() * vector.x()};
}

/// After a step along a share of the mean that led too far, by the mean from there: as far along it as where both would
/// agree, and across it as the other says. So a valley is gone along that would be crossed to and fro; of a sharp one
/// the share across shrinks more slowly.
Vec2 shorter_step(const Vec2& mean, double share, const Vec2& beyond) {
  const double on = mean.squaredNorm(), back = -beyond.dot(mean);
  if (!(back > 0)) return share / 2 * mean;
  const Vec2 across = beyond + back / on * mean;
  return on / (on + back) * (share * mean + std::sqrt(share) * across);
}

/// The part of a vector that leads along the border, for a place on an edge of it; the vector itself anywhere else.
Vec2 along_border(const Mesh& mesh, const SurfacePoint& place, const Vec2& vector) {
  if (vertex_at(mesh, place) != k_none) return vector;
  const FaceChart chart(mesh, place.face);
  for (int i = 0; i < 3; ++i) {
    const int from = (i + 1) % 3, to = (i + 2) % 3;
    if (place.barycentric[i] != 0 || mesh.twin(3 * place.face + from) != k_none) continue;
    const Vec2 edge = chart.corner[to] - chart.corner[from];
    const double heading = tangent_heading(mesh, place, std::atan2(edge.y(), edge.x()));
    const Vec2 way(std::cos(heading), std::sin(heading));
    return way.dot(vector) * way;
  }
  return vector;
}

/// Goes from place to place where the sum is less.
class Descent {
 public:
  Descent(Gathering& gathering, const Mesh& mesh, const JobStage& stage) : gathering_(gathering), mesh_(mesh) {
    const SurfacePoint start = gathering.start();
    arrive(start, gathering.step_at(start, stage));
  }

  const SurfacePoint& center() const { return center_; }
  bool is_there() const { return !(step_.norm() > k_tolerance * gathering_.spread()); }

  void go_on(const JobStage& stage) {
    const Moved moved = move_sites(mesh_, {center_}, {step_}, 1);
    const Vec2 next_mean = gathering_.step_at(moved.sites.front(), stage);
    const bool is_held = !(moved.steps.front().norm() > k_tolerance * gathering_.spread());  // by the border
    const double least = energy_ * (1 + k_rounding) - k_least_gain * 2 * mean_.dot(step_);
    if (!is_held && gathering_.energy() <= least) return arrive(moved.sites.front(), next_mean);
    const Vec2 slide = is_held ? along_border(mesh_, center_, mean_) : mean_;
    if ((mean_ - slide).norm() > k_tolerance * mean_.norm()) return set_out(slide);
    // Round saddles the mean bends more than in a plane.
    step_ = is_along_ ? shorter_step(mean_, share_, carried_back(next_mean, moved)) : Vec2((share_ /= 2) * mean_);
    is_along_ = !is_along_;
    if (++vain_ != k_vain_before_vertices) return;
    if (vertex_at(mesh_, center_) != k_none)
      set_out(gathering_.steepest_at(center_, stage));
    else
      try_corners(stage);
  }

 private:
  /// At the place that has just been looked at.
  void arrive(const SurfacePoint& place, const Vec2& mean) {
    center_ = place;
    energy_ = gathering_.energy();
    vain_ = 0;
    set_out(mean);
  }
  void set_out(const Vec2& mean) {
    step_ = mean_ = mean;
    share_ = 1;
    is_along_ = true;
  }
  /// At a saddle that ways bend at the sum has a sharp least, which no step meets.
  void try_corners(const JobStage& stage) {
    for (int i = 0; i < 3; ++i) {
      const SurfacePoint corner{center_.face, Vec3::Unit(i)};
      const Vec2 mean = gathering_.step_at(corner, stage);
      if (gathering_.energy() < energy_ * (1 - k_rounding)) arrive(corner, mean);
    }
  }

  Gathering& gathering_;
  const Mesh& mesh_;
  SurfacePoint center_;
  Vec2 mean_, step_;  ///< from the center; the step may be shorter and turned
  double energy_ = 0, share_ = 1;
  bool is_along_ = true;
  int vain_ = 0;  ///< steps from the center
};

}  // namespace

SurfacePoint geodesic_center(const SaddleVertexGraph& graph, const SurfacePoints& points,
                             std::span<const double> weights, Job* job) {
  const Mesh& mesh = graph.mesh();
  check_points(mesh, points);
  Gathering gathering(graph, points, checked_weights(weights, points.size()));
  const JobStage stage(job, "Finding a center");
  Descent descent(gathering, mesh, stage.part(0, 0));
  for (int i = 0; i < k_most_steps && !descent.is_there(); ++i) {
    const double done = 1 - 1.0 / (i + 1);
    stage.update(done);
    descent.go_on(stage.part(done, done));
  }
  stage.update(1);
  return descent.center();
}

}  // namespace saddleback
