#include "saddleback/shapes/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/error.h"

#include "predicates/planar_loops.h"
#include "shapes/enclosing_circle.h"

namespace saddleback {
namespace {

using Loop = Shape::Loop;
using Box = Eigen::AlignedBox2d;

/// Bounds what counts as rounding when half a turn is looked for, as a share of the circumradius.
constexpr double k_symmetry_tolerance = 1e-9;
/// Squares of areas stay among the doubles, whatever the scale of a placement.
constexpr double k_largest_coordinate = 1e30;

double distance_to_segment(const Vec2& a, const Vec2& b) {
  const Vec2 along = b - a;
  const double share = std::clamp(-a.dot(along) / along.squaredNorm(), 0.0, 1.0);
  return (a + share * along).norm();
}

/// Tells whether half a turn carries one loop onto the other, corner by corner.
bool is_half_turn(const Loop& loop, const Loop& other, double tolerance) {
  if (loop.size() != other.size()) return false;
  const std::size_t count = loop.size();
  for (std::size_t shift = 0; shift < count; ++shift) {
    std::size_t i = 0;
    while (i < count && (loop[i] + other[(i + shift) % count]).norm() <= tolerance) ++i;
    if (i == count) return true;
  }
  return false;
}

void check_loop(const Loop& loop, std::size_t part, std::size_t index) {
  const auto where = [&] { return message("shape: loop ", index, " of part ", part); };
  for (std::size_t i = 0; i < loop.size(); ++i)
    if (!(loop[i].array().abs() <= k_largest_coordinate).all())
      throw InputError(message(where(), " has (", loop[i].x(), ", ", loop[i].y(), ") at corner ", i,
                               ", wanted finite numbers up to 1e30"));
  if (loop.size() < 3) throw InputError(message(where(), " has ", loop.size(), " corners, wanted 3 or more"));
}

/// The part that a loop belongs to, and its place there.
std::pair<Index, Index> place_of(std::span<const Index> part_begins, Index loop) {
  const auto part = std::upper_bound(part_begins.begin(), part_begins.end(), loop) - part_begins.begin() - 1;
  return {static_cast<Index>(part), loop - part_begins[part]};
}

}  // namespace

Shape::Shape(Loop outline) : Shape(std::vector<Part>{Part{std::move(outline)}}) {}

Shape::Shape(std::vector<Part> parts) {
  if (parts.empty()) throw InputError("shape: wanted an outline, got nothing");
  for (std::size_t p = 0; p < parts.size(); ++p) {
    if (parts[p].empty()) throw InputError(message("shape: part ", p, " has no outline"));
    part_begins_.push_back(static_cast<Index>(loops_.size()));
    for (std::size_t l = 0; l < parts[p].size(); ++l) {
      Loop& loop = parts[p][l];
      if (loop.size() > 1 && loop.front() == loop.back()) loop.pop_back();
      check_loop(loop, p, l);
      loops_.push_back(std::move(loop));
    }
  }
  part_begins_.push_back(static_cast<Index>(loops_.size()));
  check();
  measure();
}

void Shape::check() const {
  const auto name = [&](Index loop) {
    const auto [part, place] = place_of(part_begins_, loop);
    return message("loop ", place, " of part ", part);
  };
  if (const auto meeting = predicates::first_meeting(loops_))
    throw InputError(message("shape: the edge after corner ", meeting->corner, " of ", name(meeting->loop),
                             " meets the edge after corner ", meeting->other_corner, " of ",
                             name(meeting->other_loop)));
  // No two loops touch, so that one corner tells on which side of another loop a loop is.
  std::vector<Box> boxes(loops_.size());
  for (std::size_t l = 0; l < loops_.size(); ++l)
    for (const Vec2& corner : loops_[l]) boxes[l].extend(corner);
  const auto is_within = [&](Index inner, Index outer) {
    const Vec2& corner = loops_[inner][0];
    return boxes[outer].contains(corner) && predicates::is_inside(loops_[outer], corner);
  };
  for (Index part = 0; part < part_count(); ++part) {
    const Index outline = part_begins_[part];
    for (Index hole = outline + 1; hole < part_begins_[part + 1]; ++hole) {
      if (!is_within(hole, outline)) throw InputError(message("shape: ", name(hole), " is a hole outside its outline"));
      for (Index other = outline + 1; other < part_begins_[part + 1]; ++other)
        if (other != hole && is_within(hole, other))
          throw InputError(message("shape: ", name(hole), " is a hole within another hole, ", name(other)));
    }
    for (Index other = 0; other < part_count(); ++other) {
      if (other == part) continue;
      bool inside = false;
      for (Index loop = part_begins_[other]; loop < part_begins_[other + 1]; ++loop) inside ^= is_within(outline, loop);
      if (inside) throw InputError(message("shape: part ", part, " lies within part ", other));
    }
  }
}

void Shape::measure() {
  double nearest = std::numeric_limits<double>::infinity();
  for (Index loop = 0; loop < static_cast<Index>(loops_.size()); ++loop) {
    const bool is_outline = place_of(part_begins_, loop).second == 0;
    Loop& corners = loops_[loop];
    if ((predicates::twice_area(corners) > 0) != is_outline) std::reverse(corners.begin(), corners.end());
    area_ += 0.5 * predicates::twice_area(corners);
    for (std::size_t i = 0; i < corners.size(); ++i) {
      circumradius_ = std::max(circumradius_, corners[i].norm());
      nearest = std::min(nearest, distance_to_segment(corners[i], corners[(i + 1) % corners.size()]));
    }
  }
  if (!(area_ > 0)) throw InputError("shape: the outline has no area");
  inradius_ = contains(Vec2::Zero()) ? nearest : 0.0;
  has_half_turn_ = std::all_of(loops_.begin(), loops_.end(), [&](const Loop& loop) {
    return std::any_of(loops_.begin(), loops_.end(), [&](const Loop& other) {
      return is_half_turn(loop, other, k_symmetry_tolerance * circumradius_);
    });
  });
}

Index Shape::corner_count() const {
  std::size_t count = 0;
  for (const Loop& loop : loops_) count += loop.size();
  return static_cast<Index>(count);
}

bool Shape::contains(const Vec2& point) const {
  bool inside = false;
  for (const Loop& loop : loops_) inside ^= predicates::is_inside(loop, point);
  return inside;
}

Shape Shape::mirrored() const {
  Shape result = *this;
  for (Loop& loop : result.loops_) {
    for (Vec2& corner : loop) corner.y() = -corner.y();
    std::reverse(loop.begin(), loop.end());
  }
  return result;
}

/// The shape with every corner sent elsewhere.
template <class Move>
Shape Shape::with_corners(Move move) const {
  std::vector<Part> parts;
  for (Index part = 0; part < part_count(); ++part) {
    parts.emplace_back(loops_.begin() + part_begins_[part], loops_.begin() + part_begins_[part + 1]);
    for (Loop& loop : parts.back())
      for (Vec2& corner : loop) corner = move(corner);
  }
  return Shape(std::move(parts));
}

Shape Shape::centered(double radius) const {
  if (!(radius > 0) || !std::isfinite(radius))
    throw InputError(message("radius is ", radius, ", but must be positive and finite"));
  std::vector<Vec2> corners;
  for (const Loop& loop : loops_) corners.insert(corners.end(), loop.begin(), loop.end());
  const distribution::Circle circle = distribution::enclosing_circle(corners);
  return with_corners([&](const Vec2& corner) -> Vec2 { return (corner - circle.center) * (radius / circle.radius); });
}

Shape Shape::moved(double scale, double angle, const Vec2& shift) const {
  if (!(scale > 0) || !std::isfinite(scale) || !std::isfinite(angle))
    throw InputError(message("scale ", scale, " and angle ", angle, " must be finite, the scale positive"));
  const double c = std::cos(angle), s = std::sin(angle);
  return with_corners([&](const Vec2& corner) -> Vec2 {
    return shift + scale * Vec2(c * corner.x() - s * corner.y(), s * corner.x() + c * corner.y());
  });
}

bool Shape::overlaps(const Shape& other) const {
  for (const Loop& loop : loops_)
    for (const Loop& others : other.loops_)
      for (std::size_t i = 0; i < loop.size(); ++i)
        for (std::size_t j = 0; j < others.size(); ++j)
          if (predicates::segments_touch(loop[i], loop[(i + 1) % loop.size()], others[j],
                                         others[(j + 1) % others.size()]))
            return true;
  const auto holds_part_of = [](const Shape& outer, const Shape& inner) {
    for (Index part = 0; part < inner.part_count(); ++part)
      if (outer.contains(inner.loops_[inner.part_begins_[part]][0])) return true;
    return false;
  };
  return holds_part_of(*this, other) || holds_part_of(other, *this);
}

}  // namespace saddleback
