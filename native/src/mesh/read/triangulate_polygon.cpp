// Ears are cut off [meisters1975] until a triangle is left; then edges are exchanged until all are Delaunay's
// [lawson1977]. A disk of triangles that are all turned alike covers what its rim encloses, each place once when the
// rim does not cross itself: so it is enough that no triangle is ever turned over.

#include "mesh/read/triangulate_polygon.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

namespace saddleback {
namespace {

// Triangles of a fan thinner than this (as the sine of an angle) are not taken: rounding may have turned them over, and
// other triangulations have better ones.
constexpr double k_needle = 1e-12;
// Of the largest coordinate: what rounding may have moved a corner that lay on an edge. First none; then as if the file
// had been written in double precision, in single precision, or with six digits.
constexpr std::array k_roundings{0.0, 0x1p-46, 0x1p-22, 0x1p-18};
constexpr Index k_leaf = 8;  // corners in a box that is not divided

Index next_in_face(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }
Index prev_in_face(Index h) { return h % 3 == 0 ? h + 2 : h - 1; }

}  // namespace

bool PolygonTriangulator::triangulate(std::span<const Index> corners, std::span<const double> xyz,
                                      std::vector<Index>& triangles, const JobStage& stage) {
  const auto n = static_cast<Index>(corners.size());
  if (n == 3) {
    triangles.insert(triangles.end(), corners.begin(), corners.end());
    return true;
  }
  const auto add = [&](Index a, Index b, Index c) {
    triangles.insert(triangles.end(), {corners[a], corners[b], corners[c]});
  };
  lay_out(corners, xyz);
  const Vec3 normal = mean_normal();
  const bool has_plane = normal.squaredNorm() > 0;
  if (const Index apex = has_plane ? fan_apex(normal) : 0; apex != k_none) {
    for (Index i = 1; i + 1 < n; ++i) add(apex, (apex + i) % n, (apex + i + 1) % n);
    return has_plane;
  }
  project(normal);
  bool is_simple = false;
  for (const double share : k_roundings) {
    slack_ = share * largest_;
    is_simple = clip_ears(stage);
    if (is_simple) break;
  }
  if (is_simple) make_delaunay(stage);
  for (std::size_t h = 0; h < origins_.size(); h += 3) {
    const Index a = origins_[h], b = origins_[h + 1], c = origins_[h + 2];
    if (corners[a] != corners[b] && corners[b] != corners[c] && corners[c] != corners[a]) add(a, b, c);
  }
  return is_simple;
}

// Relative to the first corner and, by a power of two, of the size of 1: so products neither over- nor underflow.
void PolygonTriangulator::lay_out(std::span<const Index> corners, std::span<const double> xyz) {
  const auto at = [&](Index v) { return Vec3(xyz[3 * v], xyz[3 * v + 1], xyz[3 * v + 2]); };
  const Vec3 first = at(corners[0]);
  points_.clear();
  double size = 0;
  largest_ = 0;
  for (const Index v : corners) {
    largest_ = std::max(largest_, at(v).cwiseAbs().maxCoeff());
    points_.push_back(at(v) - first);
    size = std::max(size, points_.back().cwiseAbs().maxCoeff());
  }
  if (size > 0x1p-10 && size < 0x1p10) return;
  int exponent = 0;
  std::frexp(size, &exponent);
  const double scale = std::ldexp(1.0, std::clamp(-exponent, -1000, 1000));
  largest_ *= scale;
  for (Vec3& point : points_) point *= scale;
}

// Newell's: zero where no more area is left than rounding may leave.
Vec3 PolygonTriangulator::mean_normal() const {
  Vec3 sum = Vec3::Zero();
  double area = 0;
  for (std::size_t i = 1; i + 1 < points_.size(); ++i) {
    const Vec3 part = points_[i].cross(points_[i + 1]);
    sum += part;
    area += part.norm();
  }
  return sum.norm() > k_needle * area ? Vec3(sum.normalized()) : Vec3(Vec3::Zero());
}

bool PolygonTriangulator::fans_out(Index apex, const Vec3& normal) const {
  const Index n = count();
  const Vec3& a = points_[apex];
  for (Index i = 1; i + 1 < n; ++i) {
    const Vec3 b = points_[(apex + i) % n] - a, c = points_[(apex + i + 1) % n] - a;
    if (!(b.cross(c).dot(normal) > k_needle * std::sqrt(b.squaredNorm() * c.squaredNorm()))) return false;
  }
  return true;
}

// The first corner whose fan will do, or k_none.
Index PolygonTriangulator::fan_apex(const Vec3& normal) const {
  constexpr Index k_largest = 64;  // trying all corners is quadratic
  const Index tries = count() > k_largest ? 1 : count();
  for (Index apex = 0; apex < tries; ++apex)
    if (fans_out(apex, normal)) return apex;
  return k_none;
}

// Into the plane across the normal. Exact for polygons across an axis, and lines along an axis stay straight.
void PolygonTriangulator::project(const Vec3& normal) {
  int axis = 0;
  normal.cwiseAbs().minCoeff(&axis);
  const Vec3 right = Vec3(Vec3::Unit(axis).cross(normal)).normalized(), up = normal.cross(right);
  plane_.clear();
  for (const Vec3& point : points_) plane_.push_back({point.dot(right), point.dot(up)});
}

PolygonTriangulator::Sign PolygonTriangulator::turn(const Point& a, const Point& b, const Point& c) const {
  if (slack_ == 0) return predicates::orient_2d(a, b, c);
  const Vec2 p(a.x, a.y), q(b.x, b.y), r(c.x, c.y);
  const double longest = std::max({(q - p).norm(), (r - q).norm(), (p - r).norm()});
  const double area = (q.x() - p.x()) * (r.y() - p.y()) - (q.y() - p.y()) * (r.x() - p.x());
  if (std::abs(area) <= slack_ * longest) return Sign::zero;
  return area > 0 ? Sign::positive : Sign::negative;
}

// False when a triangle had to be turned over.
bool PolygonTriangulator::clip_ears(const JobStage& stage) {
  begin_clipping();
  Index start = 0;
  bool is_simple = true;
  for (Index left = count(); left > 3; --left) {
    Index ear = is_simple ? next_ear(start, stage) : k_none;
    if (ear == k_none && is_simple) ear = flat_corner(start);
    if (ear == k_none) {  // edges cross: a fan of what is left
      is_simple = false;
      ear = next_[start];
    }
    start = prev_[ear];
    cut(ear);
  }
  const Index a = start, b = next_[a], c = next_[b];
  add_triangle(a, b, c);
  join(static_cast<Index>(origins_.size()) - 1, behind_[c]);
  return is_simple && turn(a, b, c) != Sign::negative;
}

void PolygonTriangulator::begin_clipping() {
  const Index n = count();
  prev_.resize(n);
  next_.resize(n);
  for (Index i = 0; i < n; ++i) {
    next_[i] = i + 1 < n ? i + 1 : 0;
    prev_[next_[i]] = i;
  }
  behind_.assign(n, k_none);
  origins_.clear();
  twins_.clear();
  queue_.clear();
  head_ = 0;
  tickets_.assign(n, 0);
  grow_boxes();
}

void PolygonTriangulator::grow_boxes() {
  const Index n = count();
  first_leaf_ = static_cast<Index>(std::bit_ceil(static_cast<std::uint32_t>((n + k_leaf - 1) / k_leaf)));
  constexpr double k_far = std::numeric_limits<double>::infinity();
  boxes_.assign(2 * static_cast<std::size_t>(first_leaf_), {k_far, k_far, -k_far, -k_far, 0});
  const auto stretch = [](Box& box, const Box& other) {
    box = {std::min(box.low_x, other.low_x), std::min(box.low_y, other.low_y), std::max(box.high_x, other.high_x),
           std::max(box.high_y, other.high_y), box.left + other.left};
  };
  for (Index i = 0; i < n; ++i) {
    const auto [x, y] = plane_[i];
    stretch(boxes_[first_leaf_ + i / k_leaf], {x, y, x, y, 1});
  }
  for (Index i = first_leaf_; i-- > 1;) {
    stretch(boxes_[i], boxes_[2 * i]);
    stretch(boxes_[i], boxes_[2 * i + 1]);
  }
}

// The corners next to an ear wait behind all others, which spreads the cuts evenly. Only they can have become ears, but
// for edges that touch: so all are asked once more before giving up.
Index PolygonTriangulator::next_ear(Index start, const JobStage& stage) {
  for (bool asked_all = false;; asked_all = true) {
    while (head_ < queue_.size()) {
      stage.check();
      const auto [corner, ticket] = queue_[head_++];
      if (ticket == tickets_[corner] && is_ear(corner)) return corner;
    }
    if (asked_all) return k_none;
    queue_.clear();
    head_ = 0;
    Index corner = start;
    do {
      queue(corner);
      corner = next_[corner];
    } while (corner != start);
  }
}

bool PolygonTriangulator::is_ear(Index corner) const {
  const std::array<Index, 3> ear{prev_[corner], corner, next_[corner]};
  return turn(ear[0], ear[1], ear[2]) == Sign::positive && is_free(1, ear);
}

// Tells whether no corner in the box is in the way.
bool PolygonTriangulator::is_free(Index box, const std::array<Index, 3>& ear) const {
  if (boxes_[box].left == 0 || misses(boxes_[box], ear)) return true;
  if (box < first_leaf_) return is_free(2 * box, ear) && is_free(2 * box + 1, ear);
  const Index begin = k_leaf * (box - first_leaf_), end = std::min(begin + k_leaf, count());
  for (Index corner = begin; corner < end; ++corner)
    if (next_[corner] != k_none && blocks(corner, ear)) return false;
  return true;
}

// Tells whether the box lies wholly on the outer side of a line along the ear.
bool PolygonTriangulator::misses(const Box& box, const std::array<Index, 3>& ear) const {
  for (int i = 0; i < 3; ++i) {
    const Point &a = plane_[ear[i]], &b = plane_[ear[(i + 1) % 3]];
    const Point innermost{b.y < a.y ? box.high_x : box.low_x, b.x > a.x ? box.high_y : box.low_y};
    if (turn(a, b, innermost) == Sign::negative) return true;
  }
  return false;
}

// Inside, or on the new edge, or on the rim (where edges touch, as those to a hole do) with an edge that leads inside.
bool PolygonTriangulator::blocks(Index corner, const std::array<Index, 3>& ear) const {
  std::array<Sign, 3> sides{};
  for (int i = 0; i < 3; ++i) {
    sides[i] = turn(ear[i], ear[(i + 1) % 3], corner);
    if (sides[i] == Sign::negative) return false;
  }
  if (sides[0] == Sign::positive && sides[1] == Sign::positive) return true;
  const auto leads_inside = [&](Index end) {
    for (int i = 0; i < 3; ++i)
      if (sides[i] == Sign::zero && turn(ear[i], ear[(i + 1) % 3], end) != Sign::positive) return false;
    return true;
  };
  return leads_inside(prev_[corner]) || leads_inside(next_[corner]);
}

// A corner without area, for polygons that touch themselves: the tip of a spike, or else one on a straight line.
Index PolygonTriangulator::flat_corner(Index start) const {
  const auto is_between = [](double a, double b, double c) { return (a < b && b < c) || (c < b && b < a); };
  Index straight = k_none, corner = start;
  do {
    const Index a = prev_[corner], c = next_[corner];
    if (turn(a, corner, c) == Sign::zero) {
      const Point &p = plane_[a], &q = plane_[corner], &r = plane_[c];
      if (!is_between(p.x, q.x, r.x) && !is_between(p.y, q.y, r.y)) return corner;
      straight = corner;
    }
    corner = c;
  } while (corner != start);
  return straight;
}

void PolygonTriangulator::cut(Index corner) {
  const Index a = prev_[corner], c = next_[corner];
  add_triangle(a, corner, c);
  behind_[a] = static_cast<Index>(origins_.size()) - 1;
  next_[a] = c;
  prev_[c] = a;
  next_[corner] = k_none;
  ++tickets_[corner];
  for (Index box = first_leaf_ + corner / k_leaf; box > 0; box /= 2) --boxes_[box].left;
  queue(a);
  queue(c);
}

// The third side is open.
void PolygonTriangulator::add_triangle(Index a, Index b, Index c) {
  const auto h = static_cast<Index>(origins_.size());
  origins_.insert(origins_.end(), {a, b, c});
  twins_.insert(twins_.end(), 3, k_none);
  join(h, behind_[a]);
  join(h + 1, behind_[b]);
}

void PolygonTriangulator::join(Index h, Index twin) {
  twins_[h] = twin;
  if (twin != k_none) twins_[twin] = h;
}

void PolygonTriangulator::make_delaunay(const JobStage& stage) {
  suspects_.clear();
  for (Index h = 0; h < static_cast<Index>(twins_.size()); ++h)
    if (h < twins_[h]) suspects_.push_back(h);
  while (!suspects_.empty()) {
    stage.check();
    const Index h = suspects_.back();
    suspects_.pop_back();
    if (is_better_flipped(h)) flip(h);
  }
}

bool PolygonTriangulator::is_better_flipped(Index h) const {
  const Index g = twins_[h];
  if (g == k_none) return false;
  const Index p = origins_[h], q = origins_[g], r = origins_[prev_in_face(h)], s = origins_[prev_in_face(g)];
  if (turn(p, s, r) != Sign::positive || turn(s, q, r) != Sign::positive) return false;
  if (turn(p, q, r) == Sign::zero || turn(q, p, s) == Sign::zero) return true;
  return predicates::in_circle(plane_[p], plane_[q], plane_[r], plane_[s]) == Sign::positive;
}

// Turns the triangles pqr and qps into srp and rsq.
void PolygonTriangulator::flip(Index h) {
  const Index g = twins_[h], h1 = next_in_face(h), h2 = prev_in_face(h), g1 = next_in_face(g), g2 = prev_in_face(g);
  const Index p = origins_[h], q = origins_[g], r = origins_[h2], s = origins_[g2];
  const Index qr = twins_[h1], rp = twins_[h2], ps = twins_[g1], sq = twins_[g2];
  origins_[h] = s, origins_[h1] = r, origins_[h2] = p;
  origins_[g] = r, origins_[g1] = s, origins_[g2] = q;
  join(h1, rp), join(h2, ps), join(g1, sq), join(g2, qr);
  suspects_.insert(suspects_.end(), {h1, h2, g1, g2});
}

}  // namespace saddleback
