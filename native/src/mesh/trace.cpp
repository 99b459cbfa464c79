// Straightest geodesics by unfolding one face at a time [polthier1998].
//
// The state is a half-edge h of the face being crossed, and the position and direction in the chart of h: from(h) at
// the origin, to(h) on the positive x axis, the apex above it. Which edge the line leaves by is decided by the side of
// a corner on which it passes (orient_2d); where it crosses is then an interpolation between the two ends of that edge,
// so that points lie exactly on their edges and no error of position can change the order of the faces.
//
// A line that passes a corner nearer than rounding can tell (k_snap) goes through that vertex and leaves it with half
// of the total angle on either side. So lines along edges and diagonals of regular grids meet their vertices exactly,
// and every line that is left to cross an edge does so at an angle that is certainly not zero: the walk always gets on.

#include "saddleback/mesh/trace.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "saddleback/error.h"

#include "mesh/tables/flat_face.h"
#include "mesh/tables/outgoing.h"
#include "support/planar.h"

namespace saddleback {
namespace {

/// A bound on the faces that a curve crosses, so that every finite length ends: more than any useful curve has, and
/// about a quarter of a second of work. It cannot be derived from length and mean edge, because a curve may go around a
/// thin tube any number of times for each of them.
constexpr std::int64_t k_max_faces = 1'000'000;
/// Radians by which a straight border may bend away from a curve that runs along it: rounding of angles.
constexpr double k_along_border = 1e-9;
constexpr std::int64_t k_faces_a_look = 1024;  ///< at the job: a quarter of a millisecond

/// Components of v in the frame whose x axis is the unit vector `axis`.
Vec2 rotated_into(const Vec2& axis, const Vec2& v) { return {axis.dot(v), cross(axis, v)}; }

/// Holds what the walk writes down, every point or nothing, and whom it tells what share of its length it has gone.
struct Polyline {
  GeodesicPath path;
  JobStage stage;
  void went(double share) const { stage.update(share); }
  void add(const Mesh& mesh, const SurfacePoint& point) {
    path.surface.push_back(point);
    path.points.push_back(position(mesh, point));
  }
};
struct NoPolyline {
  void went(double) const {}
  void add(const Mesh&, const SurfacePoint&) {}
};

/// Half-edge of point.face that leaves the vertex which the point is.
Index outgoing(const SurfacePoint& point) {
  int corner = 0;
  for (int i = 0; i < 3; ++i)
    if (point.barycentric[i] == 1.0) corner = i;
  return 3 * point.face + corner;
}

/// Angle from first_halfedge(vertex) to h, an outgoing half-edge of the same vertex.
double fan_angle(const Mesh& mesh, Index h) {
  double sum = 0;
  for (Index g = mesh.first_halfedge(mesh.from(h)); g != h; g = mesh.rotate(g)) sum += mesh.corner_angle(g);
  return sum;
}

/// Angle in the chart of h's face of the direction along h.
double axis_angle(const Mesh& mesh, Index h) {
  const FaceChart chart(mesh, Mesh::face_of(h));
  const Vec2 axis = chart.corner[(h % 3 + 1) % 3] - chart.corner[h % 3];
  return std::atan2(axis.y(), axis.x());
}

/// The direction `angle` about the vertex that `point` is, in the chart of its face.
double chart_angle_at(const Mesh& mesh, const SurfacePoint& point, double angle) {
  const Index h = outgoing(point);
  return std::remainder(angle - fan_angle(mesh, h) + axis_angle(mesh, h), 2 * std::numbers::pi);
}

template <class Record>
class Walk {
 public:
  Walk(const Mesh& mesh, double length, Record& record, std::int64_t most_faces)
      : mesh_(mesh), length_(length), record_(record), most_faces_(most_faces) {}

  /// True where the curve crosses more faces than it may.
  bool gave_up() const { return gave_up_; }
  double traveled() const { return traveled_; }

  TraceEnd from_point(const SurfacePoint& start, double angle) {
    enter(3 * start.face);
    const FlatFace chart = this->chart();
    const Vec3 b = normalized_barycentric(start.barycentric);
    place_ = b[0] * chart.corner[0] + b[1] * chart.corner[1] + b[2] * chart.corner[2];
    direction_ = Vec2(std::cos(angle), std::sin(angle));
    record_.add(mesh_, {start.face, b});
    if (length_ == 0) return {{start.face, b}, angle, 0, false};
    return run(&Walk::leave_inside);
  }

  TraceEnd from_vertex(SurfacePoint start, Index vertex, double angle) {
    start.barycentric = Vec3::Unit(outgoing(start) % 3);
    record_.add(mesh_, start);
    const double total = mesh_.total_angle(vertex);
    if (!mesh_.is_boundary(vertex)) {
      angle = std::fmod(angle, total);
      if (angle < 0) angle += total;
    } else if (angle < -k_snap || angle > total + k_snap) {
      return {start, chart_angle_at(mesh_, start, angle), 0, true};
    }
    if (length_ == 0) return {start, chart_angle_at(mesh_, start, angle), 0, false};
    set_out(mesh_.first_halfedge(vertex), angle);
    return run(&Walk::leave_corner);
  }

 private:
  using Step = bool (Walk::*)();

  TraceEnd run(Step first) {
    bool going = (this->*first)();
    for (std::int64_t faces = 1; going; ++faces) {
      if (gave_up_ = faces > most_faces_; gave_up_) break;
      if (faces % k_faces_a_look == 0) record_.went(traveled_ / length_);
      going = at_corner_ ? leave_corner() : leave_through();
    }
    return end_;
  }

  /// Makes h the half-edge whose chart is used.
  void enter(Index h) { halfedge_ = h; }

  FlatFace chart() const { return FlatFace(mesh_.corners(halfedge_)); }

  /// Leaves from anywhere in the closed face, in any direction.
  bool leave_inside() {
    const FlatFace c = chart();
    double side[3], ahead[3];
    int vertex = -1;
    for (int i = 0; i < 3; ++i) {
      side[i] = cross(direction_, c.corner[i] - place_);
      ahead[i] = direction_.dot(c.corner[i] - place_);
      const bool on_line = std::abs(side[i]) <= k_snap * c.size && ahead[i] > k_snap * c.size;
      if (on_line && (vertex < 0 || ahead[i] > ahead[vertex])) vertex = i;
    }
    if (vertex >= 0) return meet_vertex(c, vertex);
    for (int i = 0; i < 3; ++i)
      if (side[i] < 0 && side[(i + 1) % 3] >= 0) return cross_edge(c, i, side[i], side[(i + 1) % 3]);
    // The point is on the rim up to rounding and the line passes outside: it leaves where it stands, by the edge that
    // it reaches first.
    return cross_edge_at_rim(c);
  }

  bool cross_edge_at_rim(const FlatFace& c) {
    int best = 0;
    double best_reach = 0;
    bool found = false;
    for (int i = 0; i < 3; ++i) {
      const Vec2 edge = c.corner[(i + 1) % 3] - c.corner[i];
      const double speed = cross(direction_, edge);
      if (speed <= 0) continue;
      const double reach = cross(edge, place_ - c.corner[i]) / speed;
      if (!found || reach < best_reach) best = i, best_reach = reach, found = true;
    }
    const Vec2 edge = c.corner[(best + 1) % 3] - c.corner[best];
    const double t = std::clamp(edge.dot(place_ - c.corner[best]) / edge.squaredNorm(), 0.0, 1.0);
    return cross_edge(c, best, -t, 1 - t);
  }

  /// Leaves from a point of the chart's own edge, into the face: only the side of the apex is to be decided.
  bool leave_through() {
    const FlatFace c = chart();
    const Vec2 to_apex = c.corner[2] - place_;
    const double side = cross(direction_, to_apex);
    if (std::abs(side) <= k_snap * c.size && direction_.dot(to_apex) > 0) return meet_vertex(c, 2);
    // The signs at the edge's own ends are known: 0 and 1 lie left and right of a line that enters the face.
    if (side > 0) return cross_edge(c, 1, cross(direction_, c.corner[1] - place_), side);
    return cross_edge(c, 2, side, cross(direction_, c.corner[0] - place_));
  }

  /// Leaves from corner 0 into the face.
  bool leave_corner() {
    at_corner_ = false;
    const FlatFace c = chart();
    const double side_1 = cross(direction_, c.corner[1]), side_2 = cross(direction_, c.corner[2]);
    if (side_1 >= -k_snap * c.size) return meet_vertex(c, 1);
    if (side_2 <= k_snap * c.size) return meet_vertex(c, 2);
    return cross_edge(c, 1, side_1, side_2);
  }

  /// Leaves by local edge i, whose ends lie `side_from` (<= 0, right) and `side_to` (>= 0, left) of the line.
  bool cross_edge(const FlatFace& c, int i, double side_from, double side_to) {
    const int j = (i + 1) % 3;
    const double width = side_to - side_from;
    const double weight_from = width > 0 ? side_to / width : 0.0;
    const double weight_to = width > 0 ? -side_from / width : 1.0;
    const Vec2 exit = weight_from * c.corner[i] + weight_to * c.corner[j];
    const double step = std::max(0.0, direction_.dot(exit - place_));
    if (traveled_ + step >= length_) return finish(c);
    traveled_ += step;

    Vec3 b = Vec3::Zero();
    b[corner_index(i)] = weight_from;
    b[corner_index(j)] = weight_to;
    const SurfacePoint point{Mesh::face_of(halfedge_), b};
    record_.add(mesh_, point);
    const Index exit_halfedge = 3 * point.face + corner_index(i);
    const Index twin = mesh_.twin(exit_halfedge);
    if (twin == k_none) return stop(point, c, true);

    // The twin runs from corner j to corner i.
    const Vec2 back = i == 1 ? Vec2(-c.last) : Vec2(c.corner[i] - c.corner[j]);
    const double edge_length = back.norm();
    Vec2 turned = rotated_into(back / edge_length, direction_);
    turned *= 1.5 - 0.5 * turned.squaredNorm();  // a Newton step back to unit length
    direction_ = turned;
    place_ = Vec2(weight_from * edge_length, 0);
    enter(twin);
    return true;
  }

  /// Goes straight to local corner i of the face, then on through that vertex.
  bool meet_vertex(const FlatFace& c, int i) {
    const double step = std::max(0.0, (c.corner[i] - place_).norm());
    if (traveled_ + step >= length_) return finish(c);
    traveled_ += step;
    const SurfacePoint point{Mesh::face_of(halfedge_), Vec3::Unit(corner_index(i))};
    record_.add(mesh_, point);
    const Index out = 3 * point.face + corner_index(i);
    const Index vertex = mesh_.from(out);
    const Vec2 axis = i == 1 ? c.last : Vec2(c.corner[(i + 1) % 3] - c.corner[i]);
    const double back_angle = std::atan2(cross(axis, -direction_), axis.dot(-direction_));
    const double back = std::clamp(back_angle, 0.0, mesh_.corner_angle(out)), total = mesh_.total_angle(vertex);
    if (!mesh_.is_boundary(vertex)) {
      set_out(out, back + 0.5 * total);
      return true;
    }
    // The surface lies on one side only, or more of it on one: straight on is half a turn on that side.
    const double right = fan_angle(mesh_, out) + back, left = total - right;
    if (std::max(left, right) < std::numbers::pi - k_along_border) return stop(point, c, true);
    set_out(mesh_.first_halfedge(vertex),
            std::clamp(right + std::copysign(std::numbers::pi, left - right), 0.0, total));
    return true;
  }

  /// Leaves the vertex from(h) at `angle` counter-clockwise from h: finds the face and sets place and direction.
  void set_out(Index h, double angle) {
    const Index first = h;
    while (angle > mesh_.corner_angle(h)) {
      const Index following = mesh_.rotate(h);
      if (following == k_none || following == first) {  // rounding at the end of the fan
        angle = mesh_.corner_angle(h);
        break;
      }
      angle -= mesh_.corner_angle(h);
      h = following;
    }
    enter(h);
    place_ = Vec2(0, 0);
    direction_ = Vec2(std::cos(std::max(0.0, angle)), std::sin(std::max(0.0, angle)));
    at_corner_ = true;
  }

  /// The length is used up inside this face.
  bool finish(const FlatFace& c) {
    const Vec2 xy = place_ + (length_ - traveled_) * direction_;
    traveled_ = length_;
    const Vec3 local = snapped(c, c.to_barycentric(xy));
    Vec3 b;
    for (int i = 0; i < 3; ++i) b[corner_index(i)] = local[i];
    const SurfacePoint point{Mesh::face_of(halfedge_), b};
    record_.add(mesh_, point);
    return stop(point, c, false);
  }

  bool stop(const SurfacePoint& point, const FlatFace& c, bool hit_boundary) {
    if (hit_boundary && length_ - traveled_ <= k_snap * c.size) {  // what is left is rounding
      hit_boundary = false;
      traveled_ = length_;
    }
    // From this chart to the face's: edge 0 of the face is an edge of ours, on which the angle is measured.
    const int zero = (3 - halfedge_ % 3) % 3;
    const Vec2 axis = (zero == 1 ? c.last : Vec2(c.corner[(zero + 1) % 3] - c.corner[zero])).normalized();
    const Vec2 turned = rotated_into(axis, direction_);
    end_ = {point, std::atan2(turned.y(), turned.x()), traveled_, hit_boundary};
    return false;
  }

  /// Corner index in the face's own order of this chart's corner i.
  int corner_index(int i) const { return (halfedge_ % 3 + i) % 3; }

  const Mesh& mesh_;
  const double length_;
  Record& record_;
  const std::int64_t most_faces_;
  bool gave_up_ = false;
  Index halfedge_ = 0;
  Vec2 place_ = Vec2::Zero(), direction_ = Vec2::UnitX();
  bool at_corner_ = false;
  double traveled_ = 0;
  TraceEnd end_;
};

void check_trace(const Mesh& mesh, const SurfacePoint& start, double length) {
  check_surface_point(mesh, start, "point");
  if (!(length >= 0) || !std::isfinite(length))
    throw InputError(message("length is ", length, ", but must be finite and not negative"));
}

/// Nothing where there are too many faces; then the length that was gone is told.
template <class Record>
std::optional<TraceEnd> walk_within(const Mesh& mesh, const SurfacePoint& start, double angle, double length,
                                    std::int64_t most_faces, Record& record, double& gone) {
  if (!std::isfinite(angle)) throw InputError(message("direction is ", angle, ", but must be finite"));
  check_trace(mesh, start, length);
  Walk<Record> walk(mesh, length, record, most_faces);
  const Index vertex = vertex_at(mesh, start);
  const TraceEnd end = vertex == k_none ? walk.from_point(start, angle) : walk.from_vertex(start, vertex, angle);
  gone = walk.traveled();
  return walk.gave_up() ? std::nullopt : std::optional(end);
}

template <class Record>
TraceEnd walk(const Mesh& mesh, const SurfacePoint& start, double angle, double length, Record& record) {
  double gone = 0;
  const std::optional<TraceEnd> end = walk_within(mesh, start, angle, length, k_max_faces, record, gone);
  if (!end)
    throw InputError(message("length ", length, " is too long to follow: after ", k_max_faces, " faces the curve is ",
                             gone, " long"));
  return *end;
}

/// The direction among those of the closed corner at h that is nearest to a unit vector.
struct NearestDirection {
  double angle;       ///< from h, 0 to the corner's angle
  double cosine;      ///< with the vector
  double free_angle;  ///< as if the face's plane went on beyond the corner
  double share;       ///< length of the vector's part in that plane
};
NearestDirection nearest_in_corner(const Mesh& mesh, Index h, const Vec3& direction) {
  const Vec3& origin = mesh.position(mesh.from(h));
  const Vec3 x = (mesh.position(mesh.to(h)) - origin).normalized();
  const Vec3 last = mesh.position(mesh.apex(h)) - origin;
  const Vec3 y = x.cross(last).normalized().cross(x);
  const Vec2 flat(direction.dot(x), direction.dot(y));
  const double corner = mesh.corner_angle(h), angle = std::atan2(flat.y(), flat.x());
  if (angle >= 0 && angle <= corner) return {angle, flat.norm(), angle, flat.norm()};
  const double at_first = flat.x(), at_last = direction.dot(last.normalized());
  constexpr double k_turn = 2 * std::numbers::pi;
  if (at_first >= at_last) return {0, at_first, angle < 0 ? angle : angle - k_turn, flat.norm()};
  return {corner, at_last, angle > corner ? angle : angle + k_turn, flat.norm()};
}

/// The angle about a vertex for a unit vector, and how much of the vector lies along the surface.
struct VertexDirection {
  double angle, share;
};
VertexDirection direction_at_vertex(const Mesh& mesh, Index vertex, const Vec3& unit) {
  NearestDirection best{0, -2, 0, 0};
  double best_fan = 0, fan = 0;
  for (const Index h : outgoing(mesh, vertex)) {
    const NearestDirection found = nearest_in_corner(mesh, h, unit);
    if (found.cosine > best.cosine) best = found, best_fan = fan;
    fan += mesh.corner_angle(h);
  }
  // Off the rim of the surface: keep the direction that leaves it rather than bend it along the rim.
  const bool off_the_rim = mesh.is_boundary(vertex) && best.angle != best.free_angle &&
                           (best_fan + best.angle == 0 || best_fan + best.angle == fan);
  if (off_the_rim) return {best_fan + best.free_angle, best.share};
  return {best_fan + best.angle, best.cosine};
}

}  // namespace

double start_angle(const Mesh& mesh, const SurfacePoint& start, const Vec3& direction) {
  check_surface_point(mesh, start, "point");
  mesh.require_space("direction: a vector");
  const double longest = direction.cwiseAbs().maxCoeff();
  if (!direction.allFinite() || longest == 0)
    throw InputError(message("direction is (", direction.x(), ", ", direction.y(), ", ", direction.z(),
                             "), but must be finite and not zero"));
  const Vec3 unit = (direction / longest).normalized();
  const auto along_surface = [&](double share) {
    if (share <= k_snap)
      throw InputError(message("direction (", direction.x(), ", ", direction.y(), ", ", direction.z(),
                               ") has no part along the surface at the point"));
  };
  const Index vertex = vertex_at(mesh, start);
  if (vertex == k_none) {
    const Vec3 x = direction_in_space(mesh, start.face, 0);
    const Vec3 y = direction_in_space(mesh, start.face, std::numbers::pi / 2);
    const Vec2 flat(unit.dot(x), unit.dot(y));
    along_surface(flat.norm());
    return std::atan2(flat.y(), flat.x());
  }
  const VertexDirection found = direction_at_vertex(mesh, vertex, unit);
  along_surface(found.share);
  return found.angle;
}

double angle_about(const Mesh& mesh, const SurfacePoint& point, double chart_angle) {
  const Index vertex = vertex_at(mesh, point);
  if (vertex == k_none) return chart_angle;
  const Index h = outgoing(point);
  double offset = std::remainder(chart_angle - axis_angle(mesh, h), 2 * std::numbers::pi);
  if (offset < -k_snap && !mesh.is_boundary(vertex)) offset += mesh.total_angle(vertex);
  return fan_angle(mesh, h) + offset;
}

TraceEnd trace_end(const Mesh& mesh, const SurfacePoint& start, double angle, double length) {
  NoPolyline nothing;
  return walk(mesh, start, angle, length, nothing);
}

std::optional<TraceEnd> trace_end_within(const Mesh& mesh, const SurfacePoint& start, double angle, double length,
                                         std::int64_t most_faces) {
  NoPolyline nothing;
  double gone = 0;
  return walk_within(mesh, start, angle, length, most_faces, nothing, gone);
}

TraceEnd trace_end(const Mesh& mesh, const SurfacePoint& start, const Vec3& direction, double length) {
  return trace_end(mesh, start, start_angle(mesh, start, direction), length);
}

TraceResult trace(const Mesh& mesh, const SurfacePoint& start, double angle, double length, Job* job) {
  Polyline polyline{{}, JobStage(job, "Walking straight on")};
  const TraceEnd end = walk(mesh, start, angle, length, polyline);
  polyline.went(1);
  polyline.path.length = end.length;
  return {std::move(polyline.path), end.angle, end.hit_boundary};
}

TraceResult trace(const Mesh& mesh, const SurfacePoint& start, const Vec3& direction, double length, Job* job) {
  return trace(mesh, start, start_angle(mesh, start, direction), length, job);
}

}  // namespace saddleback
