// Disks within the copies tell: where one lies deeper in the other's plane than the copy can move, all meet. What the
// flat planes foresee is believed as far as the surface bends little; elsewhere the deepest point is traced over it.

#include "distribution/coverage_test.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <ranges>

#include "saddleback/mesh/project.h"

#include "distribution/bent_cell.h"
#include "distribution/edge_distances.h"

namespace saddleback::distribution {
namespace {

/// Bounds the drift: where the tracing of a point ends differs from where the flat plane puts it by a quarter of K r^2
/// of its distance; lengths across are off by as much as K r^2. So the one tells the other.
constexpr double k_bending = 4, k_most_bent = 0.5;
/// Bounds the stretch: that of a map is a sixth of K r^2 at its rim: points are certainly not farther off than this
/// many times that, of their distance. What is deeper needs no tracing.
constexpr double k_drift = 4;
/// Ways along edges are at most so much longer than others on meshes of sound triangles.
constexpr double k_edge_excess = 1.5;
constexpr Index k_border_corners = 24;
/// Faces after which the tracing of a point of a copy is given up: many times more than a copy lies on.
constexpr std::int64_t k_most_traced = 10'000;
/// Lengths on a copy that bends are no more than so many times longer or shorter than in its plane, see MapLimits.
constexpr double k_most_stretch = 2;
/// Points of a copy that have to land in others: one alone may be led astray by a sliver.
constexpr int k_traced_points = 2;
/// Disks looked at before all of them are: the largest, which tell most cells.
constexpr std::size_t k_first_disks = 6;

Eigen::Matrix2d turn_of(const Copy& copy) {
  const double c = copy.placement.scale * std::cos(copy.placement.angle),
               s = copy.placement.scale * std::sin(copy.placement.angle);
  Eigen::Matrix2d turn;
  turn << c, -s, s, c;
  return turn;
}

/// Bounds what exact distances may decide and the grids cannot, whose distances are rounded up.
double slack_of(const Copy& a, const Copy& b) {
  return std::max(a.placement.scale * a.body->distance.slack(), b.placement.scale * b.body->distance.slack());
}

}  // namespace

CoverageTest::CoverageTest(const Mesh& mesh, const PlacingRules& rules, const PlacedShapes& settled,
                           const DistributionOptions& options)
    : mesh_(&mesh), rules_(&rules), settled_(&settled), options_(&options) {
  flag_borders();
}

void CoverageTest::flag_borders() {
  std::vector<Index> rim = mesh_->boundary_vertices(), allowed;
  if (!options_->forbidden.empty()) {
    std::vector<std::uint8_t> has_forbidden(static_cast<std::size_t>(mesh_->vertex_count()), 0);
    std::vector<std::uint8_t> has_allowed = has_forbidden;
    for (Index h = 0; h < mesh_->halfedge_count(); ++h)
      (options_->forbidden[Mesh::face_of(h)] ? has_forbidden : has_allowed)[mesh_->from(h)] = 1;
    for (Index v = 0; v < mesh_->vertex_count(); ++v) {
      if (has_forbidden[v]) rim.push_back(v);
      if (has_allowed[v]) allowed.push_back(v);
    }
    forbidden_depth_ = edge_distances(*mesh_, allowed, std::numeric_limits<double>::infinity());
    for (double& depth : forbidden_depth_) depth /= k_edge_excess;
    list_forbidden_faces();
  }
  if (rim.empty()) return;
  const std::vector<double> distances = edge_distances(*mesh_, rim, k_edge_excess * rules_->largest_radius());
  near_border_.resize(static_cast<std::size_t>(mesh_->face_count()));
  for (Index f = 0; f < mesh_->face_count(); ++f)
    for (const Index vertex : mesh_->triangles()[f])
      if (std::isfinite(distances[vertex])) near_border_[f] = 1;
  for (Index f = 0; f < mesh_->face_count(); ++f) {  // large faces reach out of the range
    const double reach = rules_->largest_radius();
    if (mesh_->length(3 * f) > reach || mesh_->length(3 * f + 1) > reach || mesh_->length(3 * f + 2) > reach)
      near_border_[f] = 1;
  }
}

void CoverageTest::list_forbidden_faces() {
  if (mesh_->is_intrinsic()) return;
  std::vector<Box<Vec3>> boxes;
  for (Index f = 0; f < mesh_->face_count(); ++f) {
    if (!options_->forbidden[f]) continue;
    const auto [a, b, c] = mesh_->corners(3 * f);
    boxes.push_back({a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)});
    forbidden_faces_.push_back(f);
  }
  forbidden_boxes_ = BoxTree<Vec3>(boxes);
}

/// Bounds from below how far a point of a forbidden face is from all that is allowed: as deep as the face, or as far as
/// its edges.
double CoverageTest::depth_at(const SurfacePoint& point) const {
  double deep = std::numeric_limits<double>::infinity(), inside = deep;
  const double area = mesh_->face_area(point.face);
  for (int i = 0; i < 3; ++i) {
    deep = std::min(deep, forbidden_depth_[mesh_->triangles()[point.face][i]]);
    inside = std::min(inside, 2 * area * point.barycentric[i] / mesh_->length(3 * point.face + (i + 1) % 3));
  }
  return std::max(deep, inside);
}

/// Returns where a point of the copy at the cell's center lies: nothing where it is lost.
std::optional<TraceEnd> CoverageTest::trace(const CellView& view, const Copy& copy, const Vec2& point) const {
  const double length = point.norm() * copy.placement.scale;
  const double angle = copy.placement.angle + std::atan2(point.y(), point.x());
  return trace_end_within(*mesh_, view.center, angle_about(*mesh_, view.center, angle), length, k_most_traced);
}

/// Tells whether a point of a copy certainly lies beyond the border, or where nothing may lie.
bool CoverageTest::is_beyond_border(const CellView& view, const Copy& copy, const Motion& motion,
                                    const Vec2& point) const {
  const double length = point.norm() * copy.placement.scale, moved = motion.of(point);
  const std::optional<TraceEnd> end = trace(view, copy, point);
  if (!end) return false;
  if (end->hit_boundary) return length - end->length > moved;
  return !forbidden_depth_.empty() && options_->forbidden[end->point.face] && depth_at(end->point) > moved;
}

bool CoverageTest::is_beyond_border(const CellView& view, const Copy& copy, const Motion& motion) const {
  const Index stride = 1 + copy.body->shape.corner_count() / k_border_corners;
  // What is forbidden may lie within a copy, too.
  constexpr std::array k_shares{1.0, 0.5, 0.25, 0.0};
  for (const double share : k_shares) {
    if (share < 1 && forbidden_depth_.empty()) break;
    Index corners = 0;
    for (const Shape::Loop& loop : copy.body->shape.loops())
      for (const Vec2& corner : loop) {
        if (corners++ % stride != 0) continue;
        const Vec2 point = share * corner;
        if (share < 1 && copy.body->distance.exact(point) > 0) continue;
        if (is_beyond_border(view, copy, motion, point)) return true;
        if (share == 0) return false;
      }
  }
  return false;
}

/// Tells whether all copies certainly hold a place of a forbidden face: such faces may be smaller than the copies and
/// lie between the points of them that is_beyond_border looks at. Looks for the places nearest to the middles of the
/// copy's largest disks.
bool CoverageTest::is_on_forbidden(const CellView& view, const Copy& copy, const Motion& motion) const {
  if (forbidden_faces_.empty()) return false;
  const double scale = copy.placement.scale, right = 0.5 * std::numbers::pi;
  const Vec3 center = position(*mesh_, view.center);
  const Vec3 x = direction_in_space(*mesh_, view.center.face, copy.placement.angle);
  const Vec3 y = direction_in_space(*mesh_, view.center.face, copy.placement.angle + right);
  for (const Disk& disk : copy.body->disks) {
    const double room = scale * disk.radius - motion.of(disk.center);
    if (room <= 0) continue;
    const Vec3 about = center + scale * (disk.center.x() * x + disk.center.y() * y);
    const Vec3 half = Vec3::Constant(room);
    SurfacePoint nearest{k_none, Vec3::Zero()};
    double least = room * room;
    forbidden_boxes_.visit({about - half, about + half}, [&](Index number) {
      const SurfacePoint place = nearest_on_face(*mesh_, forbidden_faces_[number], about);
      const double square = (position(*mesh_, place) - about).squaredNorm();
      if (square < least) least = square, nearest = place;
    });
    if (nearest.face == k_none) continue;
    constexpr double k_inward = 0.1;  // off the rim, where tracings may end on either side
    nearest.barycentric = (1 - k_inward) * nearest.barycentric + Vec3::Constant(k_inward / 3);
    if (is_certainly_on(nearest, view, copy, motion, x, y)) return true;
  }
  return false;
}

/// Finds the point of the copy at the cell's center that lies on a place, and whether it is deeper in the copy than
/// that moves. x, y: the copy's axes in space.
bool CoverageTest::is_certainly_on(const SurfacePoint& place, const CellView& view, const Copy& copy,
                                   const Motion& motion, const Vec3& x, const Vec3& y) const {
  constexpr int k_steps = 3;
  const double scale = copy.placement.scale, rounded = k_rounding * copy.radius();
  const Vec3 wanted = position(*mesh_, place);
  Vec3 off = wanted - position(*mesh_, view.center);
  Vec2 point = Vec2::Zero();
  for (int step = 0; step < k_steps; ++step) {
    point += Vec2(x.dot(off), y.dot(off)) / scale;
    const double length = point.norm() * scale;
    if (!(length <= copy.radius())) return false;
    const std::optional<TraceEnd> end = trace(view, copy, point);
    if (!end || end->hit_boundary) return false;
    off = wanted - position(*mesh_, end->point);
    if (end->point.face != place.face) continue;
    const double depth = -scale * copy.body->distance.exact(point);
    if (depth - motion.of(point) - k_most_stretch * off.norm() > rounded) return true;
  }
  return false;
}

/// Returns where a point of the copy at the cell's center lies in the plane of another: it is traced over the surface.
bool CoverageTest::trace_to(const CellView& view, const Copy& copy, const Vec2& point, Index other, Traced& traced,
                            Vec2& place) const {
  // Where the surface bends much a plane may be laid on another with hardly a width: what that foresees lies nowhere.
  if (!(point.norm() * copy.placement.scale <= 2 * copy.radius())) return false;
  auto known = std::ranges::find(traced, point, &Traced::value_type::first);
  if (known == traced.end()) known = traced.insert(known, {point, trace(view, copy, point)});
  const std::optional<TraceEnd>& end = known->second;
  if (!end || end->hit_boundary) return false;
  const Vec2 in_face = rules_->flat().place(end->point);
  return settled_->visit(end->point.face, {end->point.barycentric[1], end->point.barycentric[2]}, copy.radius(),
                         [&](Index number, const Vec2& origin, const Eigen::Matrix2d& turn) {
                           if (number != other) return false;
                           place = origin + turn * in_face;
                           return true;
                         });
}

/// Tells whether what the flat planes foresee holds: first of the whole disk, whose width the surface may bend, then of
/// the point of it alone that is deepest in both.
bool CoverageTest::is_certain(const CellView& view, const Copy& copy, const Motion& motion, const Overlap& found,
                              const Pose& pose, Index other, Traced& traced) const {
  const Copy& there = settled_->copies()[other];
  const double scale = copy.placement.scale, other_scale = there.placement.scale;
  const double rounded = k_rounding * (copy.radius() + there.radius());
  const auto bending = [&](const Vec2& point, const Vec2& place) {
    const double length = point.norm() * scale;
    return length > 0 ? std::min(k_most_bent, k_bending * (place - pose(point)).norm() / length) : 0;
  };
  Vec2 place = pose.at;
  if (found.point != Vec2::Zero() && !trace_to(view, copy, found.point, other, traced, place)) return false;
  const Eigen::Matrix2d back = pose.turn.inverse();
  const Vec2 own = found.is_of_other ? Vec2(found.point + back * (found.other_point - place)) : found.point;
  const double distance = found.is_of_other ? scale * copy.body->distance.exact(own)
                                            : other_scale * there.body->distance.exact(place / other_scale);
  const double bent = bending(found.point, place), overlap = found.radius - distance;
  if (found.radius * (1 - bent) - distance - motion.of(own) * (1 + bent) > rounded) return true;
  if (overlap - motion.of(own) <= rounded || found.radius == 0) return false;
  // Most of the overlap is on the other's side, where moving matters.
  const Vec2 deepest =
      found.is_of_other ? Vec2(own + std::max(0.0, distance + 0.1 * overlap) / scale * copy.body->distance.way_in(own))
                        : Vec2(own + std::max(0.0, distance + 0.9 * overlap) *
                                         (back * there.body->distance.way_in(place / other_scale)));
  if (!trace_to(view, copy, deepest, other, traced, place)) return false;
  const double depth = -other_scale * there.body->distance.exact(place / other_scale);
  return depth - motion.of(deepest) * (1 + bending(deepest, place)) > rounded;
}

/// Tells whether points of the copies certainly lie in copies that are there: each is traced over the surface, to a
/// face which that copy touches. Where the surface bends much planes foresee little. For leaves: it takes a tenth of
/// the time that laying a copy there takes, but more than to foresee.
bool CoverageTest::is_traced_into_another(const CellView& view, const Copy& copy, const Motion& motion) const {
  int within = 0;
  for (const Disk& disk : std::views::reverse(copy.body->disks)) {  // the tips first
    const std::optional<TraceEnd> end = trace(view, copy, disk.center);
    if (!end || end->hit_boundary) continue;
    const double moved = (1 + k_most_bent) * motion.of(disk.center);
    const auto is_within = [&](Index number, const Vec2& place) {
      const Copy& there = settled_->copies()[number];
      const double depth = -there.placement.scale * there.body->distance.exact(place / there.placement.scale);
      return depth - moved > k_rounding * (copy.radius() + there.radius());
    };
    const Vec2 weights(end->point.barycentric[1], end->point.barycentric[2]);
    if (settled_->visit_touching(end->point.face, weights, is_within) && ++within == k_traced_points) return true;
  }
  return false;
}

void CoverageTest::find_neighbors(const Cell& cell, const CellView& view, Neighbors& near) const {
  near.clear();
  const SurfacePoint& center = view.center;
  const double reach = rules_->reach_at(cell.face, cell.center());
  settled_->visit(center.face, {center.barycentric[1], center.barycentric[2]}, reach,
                  [&](Index other, const Vec2& origin, const Eigen::Matrix2d& turn) {
                    const Copy& there = settled_->copies()[other];
                    const double away = (origin + turn * view.place).norm() - there.radius();
                    if (away < reach) near.push_back({other, away, origin, turn});
                    return false;
                  });
  std::sort(near.begin(), near.end(),
            [](const Neighbor& a, const Neighbor& b) { return a.away != b.away ? a.away < b.away : a.copy < b.copy; });
}

std::uint64_t CoverageTest::centrally_covered(const Cell& cell, const CellView& view, std::uint64_t kinds,
                                              const Neighbors& near) const {
  std::array<double, k_most_kinds> inradii;
  double largest = 0;
  for (std::uint64_t rest = kinds; rest; rest &= rest - 1) {
    const auto kind = static_cast<Index>(std::countr_zero(rest));
    const double size = rules_->size_at(rules_->kinds()[kind].shape, cell.face, cell.center());
    inradii[kind] = rules_->smallest_factor() * size * rules_->inradius(kind);
    if (proves_bent()) inradii[kind] /= k_most_stretch;
    largest = std::max(largest, inradii[kind]);
  }
  std::uint64_t covered = 0;
  for (const Neighbor& neighbor : near) {
    if (neighbor.away > largest) break;
    const Copy& there = settled_->copies()[neighbor.copy];
    Vec2 place = neighbor.origin + neighbor.turn * view.place;
    if (proves_bent() && !settled_->place_within(neighbor.copy, view.center, place)) continue;
    double distance = there.placement.scale * there.body->distance.upper(place / there.placement.scale);
    if (proves_bent()) distance *= distance > 0 ? k_most_stretch : 1 - there.bend;
    for (std::uint64_t rest = kinds & ~covered; rest; rest &= rest - 1) {
      const auto kind = static_cast<Index>(std::countr_zero(rest));
      if (inradii[kind] - view.radius > distance) covered |= std::uint64_t{1} << kind;
    }
    if (covered == kinds) break;
  }
  return covered;
}

bool CoverageTest::meets_border(const CellView& view, const Copy& copy, const Motion& motion) const {
  if (near_border_.empty() || !near_border_[view.center.face]) return false;
  return is_on_forbidden(view, copy, motion) || is_beyond_border(view, copy, motion);
}

CoverageTest::Cover CoverageTest::cover(const Cell& cell, const CellView& view, Index kind, const Copy& copy,
                                        const Neighbors& near, double tolerance) const {
  return proves_bent() ? bent_cover(cell, view, kind, copy, tolerance) : straight_cover(view, copy, near, tolerance);
}

CoverageTest::Cover CoverageTest::straight_cover(const CellView& view, const Copy& copy, const Neighbors& near,
                                                 double tolerance) const {
  const Motion motion = rules_->motion(view, rules_->smallest_factor());
  const double scale = copy.placement.scale;
  const Eigen::Matrix2d own = turn_of(copy);
  Traced traced;
  const auto is_met = [&](const Motion& moved) {
    for (const std::size_t disks : {k_first_disks, std::numeric_limits<std::size_t>::max()})
      for (const Neighbor& neighbor : near) {
        const Copy& there = settled_->copies()[neighbor.copy];
        const Pose pose{neighbor.origin + neighbor.turn * view.place, neighbor.turn * own};
        const double slack = slack_of(copy, there), drift = k_drift * there.bend * scale;
        const Overlap found = find_overlap(
            *copy.body, scale, pose, moved, *there.body, there.placement.scale,
            {.least = -slack, .enough = slack + drift * copy.body->shape.circumradius(), .most_disks = disks});
        if (found.depth > drift * found.point.norm()) return true;
        if (found.depth > -slack && is_certain(view, copy, moved, found, pose, neighbor.copy, traced)) return true;
      }
    return meets_border(view, copy, moved);
  };
  if (is_met(motion)) return {.is_whole = true};
  const double moved = motion.base + motion.per_length * copy.body->shape.circumradius();
  const bool is_leaf = moved <= tolerance && !options_->bend;
  return {.is_central = is_met({}) || (is_leaf && is_traced_into_another(view, copy, motion)), .motion = moved};
}

CoverageTest::Cover CoverageTest::bent_cover(const Cell& cell, const CellView& view, Index kind, const Copy& copy,
                                             double tolerance) const {
  BentCell copies(*rules_, *settled_, cell, kind, copy);
  Cover cover;
  cover.is_whole = copies.is_covered(view.radius, cover.is_central) ||
                   (!near_border_.empty() && near_border_[cell.face] &&
                    copies.is_beyond_border(options_->forbidden, forbidden_depth_, cover.is_central));
  // The center itself moves by the cell's radius.
  if (!cover.is_whole) cover.motion = view.radius > tolerance ? view.radius : copies.motion();
  return cover;
}

}  // namespace saddleback::distribution
