// A walk from face to face with the position in the chart of the face. The field has no value at vertices themselves:
// a curve that would meet one passes beside it, nearer than anything that counts.

#include "saddleback/field/streamline.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "saddleback/error.h"
#include "saddleback/mesh/surface_curve.h"

#include "field/connection/surface_connection.h"
#include "mesh/tables/outgoing.h"
#include "support/planar.h"

namespace saddleback {
namespace {

constexpr double k_pi = std::numbers::pi;
constexpr std::int64_t k_max_faces = 1'000'000, k_max_steps = 8'000'000;
constexpr double k_step = 0.25;            // of a face's size
constexpr double k_thin = 0.1;             // of the longest edge, a face's size at least: along slivers there is no end
constexpr double k_most_turn = k_pi;       // within a face; where it is more, steps are shorter
constexpr double k_straight = 0.8;         // of its length, how far a step must lead: of a whole turn nothing is left
constexpr double k_beside = 1e-9;          // share of an edge by which curves keep off its ends
constexpr double k_inward = 1e-6;          // share of a step by which it leaves the edge that it starts on
constexpr double k_at_singularity = 0.02;  // share of the edges about it within which a curve has come to a vertex
constexpr double k_bend = 0.1;             // radians a step, of curves whose bending is limited

Vec2 unit(double angle) { return {std::cos(angle), std::sin(angle)}; }

class Walk {
 public:
  /// `backwards`: against the field's directions.
  Walk(const DirectionField& field, const StreamlineOptions& options, double length, bool backwards,
       const JobStage& stage)
      : field_(field),
        mesh_(field.mesh()),
        length_(length),
        max_curvature_(options.max_curvature),
        stage_(stage),
        quantum_(2 * k_pi / field.symmetry()),
        offset_(backwards ? k_pi : 0) {}

  /// Goes on from inside a face, along the direction nearest to that angle of its chart.
  StreamlineEnd from_face(const SurfacePoint& start, double heading) {
    record(start);
    enter(start.face, k_none);
    place_ = chart_->to_plane(start.barycentric);
    heading_ = direction(place_, heading);
    return run();
  }

  /// Goes on from a vertex along that half-edge's corner, at that angle from the half-edge.
  StreamlineEnd from_vertex(const SurfacePoint& start, Index h, double angle) {
    record(start);
    enter(Mesh::face_of(h), k_none);
    heading_ = chart_angle(mesh_, h) + angle;
    const double size = std::min(mesh_.length(h), mesh_.length(Mesh::prev(h)));
    place_ = chart_->corner[h % 3] + k_beside * size * unit(heading_);
    return run();
  }

  GeodesicPath take_path() { return std::move(path_); }

 private:
  void record(const SurfacePoint& point) {
    if (!path_.points.empty()) path_.length += step_length(mesh_, path_.surface.back(), point);
    path_.points.push_back(position(mesh_, point));
    path_.surface.push_back(point);
  }

  /// `edge`: the half-edge of the face that the place lies on, or none.
  void enter(Index face, Index edge) {
    face_ = face;
    edge_ = edge;
    chart_.emplace(mesh_, face);
    share_ = k_step / std::max(1.0, turn_within(face) / k_most_turn);
    const Index h = 3 * face;
    const double longest = std::max({mesh_.length(h), mesh_.length(h + 1), mesh_.length(h + 2)});
    step_ = share_ * std::max(std::sqrt(2 * mesh_.face_area(face)), k_thin * longest);
    singular_ = false;
    for (const Index v : mesh_.triangles()[face]) singular_ = singular_ || field_.units_at(v) != 0;
  }

  /// Returns by how much the field's angles at the corners of a face differ.
  double turn_within(Index face) const {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      const auto [along, before] = field_.about_corner(h);
      low = std::min({low, along, before});
      high = std::max({high, along, before});
    }
    return high - low;
  }

  SurfacePoint point_at(const Vec2& place) const {
    return {face_, normalized_barycentric(chart_->to_barycentric(place))};
  }

  /// Returns of the field's directions the one nearest to `near`.
  double direction(const Vec2& place, double near) const {
    const double angle = field_.angle_at(point_at(place)) + offset_;
    return angle - quantum_ * std::round((angle - near) / quantum_);
  }

  StreamlineEnd run() {
    std::int64_t faces = 0;
    for (std::int64_t steps = 0;; ++steps) {
      if (steps > k_max_steps) throw InputError(too_long("steps", steps));
      if (steps % 64 == 0) stage_.update(traveled_ / length_);
      const double left = length_ - traveled_;
      if (left <= 0) return StreamlineEnd::length;
      if (const int corner = corner_reached(); corner != k_none) return end_at(corner, left);
      double length = std::min(left, step_here());
      Vec2 move = step(length);
      while (move.norm() < k_straight * length && length > k_inward * step_) move = step(length *= 0.5);
      if (move.norm() < k_straight * length) move = straight_step(length = std::min(left, step_here()));
      move = inward(move, length);
      Exit exit = find_exit(move);
      if (exit.share < 1) {  // once more, only so far as the edge
        length = std::max(length * exit.share, k_inward * step_);
        move = inward(step(length), length);
        exit = find_exit(move);
      }
      const double size = move.norm();
      if (exit.share > 1.05 || traveled_ + size * exit.share >= length_) {
        const double share = left <= size ? left / size : 1;
        place_ += share * move;
        traveled_ = left <= size ? length_ : traveled_ + share * size;
        heading_ = next_heading_;
        edge_ = k_none;
        record(point_at(place_));
        continue;
      }
      traveled_ += size * exit.share;
      heading_ = next_heading_;
      if (!cross_edge(exit, move)) return StreamlineEnd::boundary;
      if (++faces > k_max_faces) throw InputError(too_long("faces", faces));
    }
  }

  std::string too_long(const char* of_what, std::int64_t count) const {
    return message("length ", length_, " is too long to follow: after ", count - 1, " ", of_what, " the curve is ",
                   traveled_, " long");
  }

  double step_here() const {
    double step = std::isfinite(max_curvature_) ? std::min(step_, k_bend / max_curvature_) : step_;
    if (!singular_) return step;
    for (int i = 0; i < 3; ++i)
      if (field_.units_at(mesh_.triangles()[face_][i]) != 0)
        step = std::min(step, share_ * (place_ - chart_->corner[i]).norm());
    return step;
  }

  /// Returns which of the face's corners is singular and next to the place; k_none: none of them.
  int corner_reached() const {
    if (!singular_) return k_none;
    for (int i = 0; i < 3; ++i) {
      const Index h = 3 * face_ + i;
      const double reach = k_at_singularity * std::min(mesh_.length(h), mesh_.length(Mesh::prev(h)));
      if (field_.units_at(mesh_.from(h)) != 0 && (place_ - chart_->corner[i]).norm() < reach) return i;
    }
    return k_none;
  }

  /// Goes straight to a corner, or towards it as far as the length allows.
  StreamlineEnd end_at(int corner, double left) {
    const Vec2 move = chart_->corner[corner] - place_;
    if (move.norm() > left) {
      record(point_at(place_ + left / move.norm() * move));
      return StreamlineEnd::length;
    }
    record({face_, Vec3::Unit(corner)});
    return StreamlineEnd::singularity;
  }

  /// Returns where the curve gets to in that length if the face went on; sets the heading there.
  Vec2 step(double length) {
    if (std::isfinite(max_curvature_)) {
      const double wanted = direction(place_ + 0.5 * length * unit(heading_), heading_) - heading_;
      const double turn = std::clamp(wanted, -max_curvature_ * length, max_curvature_ * length);
      next_heading_ = heading_ + turn;
      return length * unit(heading_ + 0.5 * turn);
    }
    const double a = direction(place_, heading_);
    const double b = direction(place_ + 0.5 * length * unit(a), a);
    const double c = direction(place_ + 0.5 * length * unit(b), b);
    const double d = direction(place_ + length * unit(c), c);
    next_heading_ = d;
    return length / 6 * (unit(a) + 2 * unit(b) + 2 * unit(c) + unit(d));
  }

  /// Steps through faces so thin that no step is short enough.
  Vec2 straight_step(double length) {
    next_heading_ = direction(place_, heading_);
    return length * unit(next_heading_);
  }

  /// A step that starts on an edge leads into the face: where the field runs along the edge rounding must not decide.
  Vec2 inward(const Vec2& move, double length) const {
    if (edge_ == k_none) return move;
    const Vec2 along = (chart_->corner[(edge_ % 3 + 1) % 3] - chart_->corner[edge_ % 3]).normalized();
    const Vec2 into(-along.y(), along.x());
    const double depth = move.dot(into);
    return depth >= k_inward * length ? move : move + (k_inward * length - depth) * into;
  }

  struct Exit {
    int edge = 0;
    double share = std::numeric_limits<double>::infinity();  ///< of the move
  };
  Exit find_exit(const Vec2& move) const {
    Exit result;
    for (int i = 0; i < 3; ++i) {
      if (3 * face_ + i == edge_) continue;
      const Vec2 edge = chart_->corner[(i + 1) % 3] - chart_->corner[i];
      const double outward = -cross(edge, move), depth = cross(edge, place_ - chart_->corner[i]);
      if (outward <= 0) continue;
      const double share = std::max(0.0, depth / outward);
      if (share < result.share) result = {i, share};
    }
    return result;
  }

  bool cross_edge(const Exit& exit, const Vec2& move) {
    const int i = exit.edge, j = (i + 1) % 3;
    const Vec2 edge = chart_->corner[j] - chart_->corner[i];
    const double along = std::clamp((place_ + exit.share * move - chart_->corner[i]).dot(edge) / edge.squaredNorm(),
                                    k_beside, 1 - k_beside);
    Vec3 b = Vec3::Zero();
    b[i] = 1 - along;
    b[j] = along;
    record({face_, b});
    const Index h = 3 * face_ + i, twin = mesh_.twin(h);
    if (twin == k_none) return false;
    heading_ += chart_angle(mesh_, twin) + k_pi - chart_angle(mesh_, h);
    enter(Mesh::face_of(twin), twin);
    place_ = along * chart_->corner[twin % 3] + (1 - along) * chart_->corner[(twin % 3 + 1) % 3];
    return true;
  }

  const DirectionField& field_;
  const Mesh& mesh_;
  const double length_, max_curvature_;
  const JobStage stage_;
  const double quantum_, offset_;
  GeodesicPath path_;
  Index face_ = 0, edge_ = k_none;
  std::optional<FaceChart> chart_;
  Vec2 place_ = Vec2::Zero();
  double heading_ = 0, next_heading_ = 0, share_ = 0, step_ = 0, traveled_ = 0;
  bool singular_ = false;
};

/// A direction in which the field leaves a vertex: at an angle from a half-edge, inside its corner; where lengths were
/// given, of a plane about the vertex, not of space.
struct Departure {
  Index halfedge = k_none;
  double angle = 0;
  Vec3 direction = Vec3::Zero();
};

/// The first one, or that nearest to the heading.
Departure departure(const DirectionField& field, Index vertex, double offset, const Vec3* heading) {
  const Mesh& mesh = field.mesh();
  const double quantum = 2 * k_pi / field.symmetry();
  Departure best;
  double best_cosine = -2, turned = 0;
  for (const Index h : outgoing(mesh, vertex)) {
    const double corner = mesh.corner_angle(h);
    // About the vertex the field is linear in the angle: where is it that angle itself?
    const auto [begin, end] = field.about_corner(h);
    const double at_begin = begin + offset - chart_angle(mesh, h), slope = (end - begin) / corner;
    for (double k = std::floor((-at_begin - 2 * k_pi) / quantum); std::abs(1 - slope) > 1e-9; ++k) {
      const double angle = (at_begin + k * quantum) / (1 - slope);
      if (at_begin + k * quantum > 4 * k_pi) break;
      if (angle < -1e-12 || angle > corner + 1e-12) continue;
      const double about = 2 * k_pi / mesh.total_angle(vertex) * (turned + angle);
      const Vec3 direction = mesh.is_intrinsic()
                                 ? Vec3(std::cos(about), std::sin(about), 0)
                                 : direction_in_space(mesh, Mesh::face_of(h), chart_angle(mesh, h) + angle);
      const double cosine = heading ? direction.dot(*heading) : -1;
      if (cosine <= best_cosine) continue;
      best = {h, std::clamp(angle, 0.0, corner), direction};
      best_cosine = cosine;
    }
    turned += corner;
  }
  return best;
}

void check(const DirectionField& field, const SurfacePoint& start, const StreamlineOptions& options) {
  check_surface_point(field.mesh(), start, "start");
  if (!(options.length > 0) || !std::isfinite(options.length))
    throw InputError(message("length is ", options.length, ", but must be positive and finite"));
  if (!(options.max_curvature > 0))
    throw InputError(message("max_curvature is ", options.max_curvature, ", but must be positive"));
  if (options.heading) field.mesh().require_space("heading");
  if (options.heading && !(options.heading->allFinite() && options.heading->norm() > 0))
    throw InputError("heading: a direction must be finite and not zero");
}

struct Side {
  GeodesicPath path;
  StreamlineEnd reason;
};
Side one_side(const DirectionField& field, const SurfacePoint& start, const StreamlineOptions& options, double length,
              bool backwards, const JobStage& stage) {
  Walk walk(field, options, length, backwards, stage);
  const Index vertex = vertex_at(field.mesh(), start);
  StreamlineEnd reason{};
  if (vertex == k_none) {
    const double angle = options.heading ? start_angle(field.mesh(), start, *options.heading) : field.angle_at(start);
    reason = walk.from_face(start, backwards ? angle + k_pi : angle);
  } else {
    const bool is_singular = field.units_at(vertex) != 0;
    Departure out;
    if (!is_singular) out = departure(field, vertex, 0, options.heading ? &*options.heading : nullptr);
    if (!is_singular && backwards) {
      const Vec3 back = options.heading ? Vec3(-*options.heading) : Vec3(-out.direction);
      out = departure(field, vertex, k_pi, &back);
    }
    if (out.halfedge == k_none) {
      const GeodesicPath alone{{position(field.mesh(), start)}, {start}, 0};
      return {alone, is_singular ? StreamlineEnd::singularity : StreamlineEnd::boundary};
    }
    reason = walk.from_vertex(start, out.halfedge, out.angle);
  }
  return {walk.take_path(), reason};
}

}  // namespace

Streamline streamline(const DirectionField& field, const SurfacePoint& start, const StreamlineOptions& options) {
  check(field, start, options);
  SurfacePoint from = start;
  from.barycentric = normalized_barycentric(start.barycentric);
  const double length = options.both ? 0.5 * options.length : options.length;
  const JobStage stage(options.job, "Stream line");
  Streamline result;
  Side ahead = one_side(field, from, options, length, false, options.both ? stage.part(0, 0.5) : stage);
  result.path = std::move(ahead.path);
  result.end_reason = ahead.reason;
  if (!options.both) {
    stage.update(1);
    return result;
  }
  Side behind = one_side(field, from, options, length, true, stage.part(0.5, 1));
  result.begin_reason = behind.reason;
  result.start = behind.path.points.size() - 1;
  std::reverse(behind.path.points.begin(), behind.path.points.end());
  std::reverse(behind.path.surface.begin(), behind.path.surface.end());
  behind.path.points.insert(behind.path.points.end(), result.path.points.begin() + 1, result.path.points.end());
  behind.path.surface.insert(behind.path.surface.end(), result.path.surface.begin() + 1, result.path.surface.end());
  behind.path.length += result.path.length;
  result.path = std::move(behind.path);
  stage.update(1);
  return result;
}

}  // namespace saddleback
