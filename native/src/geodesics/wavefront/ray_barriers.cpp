#include "geodesics/wavefront/ray_barriers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/planar.h"

namespace saddleback {
namespace {

constexpr double k_infinity = std::numeric_limits<double>::infinity();
// Relative to the face: a piece this near to where rays set out is one that they set out from.
constexpr double k_touch = 1e-12;

struct Stretch {
  Vec2 begin, end;
};

/// Leaves the part of the stretch where a linear function, known at its ends, is positive; false when there is none.
bool keep_positive(Stretch& s, double at_begin, double at_end) {
  if (at_begin <= 0 && at_end <= 0) return false;
  const Vec2 zero = s.begin + (at_begin / (at_begin - at_end)) * (s.end - s.begin);
  if (at_begin <= 0) s.begin = zero;
  if (at_end <= 0) s.end = zero;
  return true;
}

}  // namespace

void RayBarriers::clear() {
  for (const Index face : faces_) first_[face] = k_none;
  faces_.clear();
  pieces_.clear();
}

void RayBarriers::add(Index face, const Vec3& begin, const Vec3& end) {
  if (first_.empty()) first_.assign(mesh_.face_count(), k_none);
  if (first_[face] == k_none) faces_.push_back(face);
  pieces_.push_back({begin, end, first_[face]});
  first_[face] = static_cast<Index>(pieces_.size()) - 1;
}

/// Returns the place in the frame of the window's half-edge.
Vec2 RayBarriers::place(const Vec3& b, Index half, Side side) const {
  const double length = mesh_.length(half);
  const Vec2 own = b[(half + 1) % 3] * Vec2(length, 0) + b[(half + 2) % 3] * unfolding_.apex(half);
  return side == Side::entered ? own : Vec2(length - own.x(), -own.y());
}

/// Returns what the pieces of a face hide of a window, as intervals in order, which do not overlap.
RayBarriers::Intervals RayBarriers::shadows(const RayWindow& window, Index half, Side side) const {
  const double size = mesh_.length(half) + unfolding_.apex(half).norm(), touch = k_touch * size;
  const bool is_parallel = window.rays == Rays::perpendicular;
  const Vec2& source = window.source;
  Intervals result;
  for (Index i = first_[Mesh::face_of(half)]; i != k_none; i = pieces_[i].next) {
    Stretch s{place(pieces_[i].begin, half, side), place(pieces_[i].end, half, side)};
    double from = 0, to = 0;
    if (is_parallel) {
      const auto height = [&](const Vec2& p) { return window.offset + source.dot(p) - touch; };
      if (!keep_positive(s, height(s.begin), height(s.end))) continue;
      const auto met = [&](const Vec2& p) { return p.x() - source.x() * (p.y() / source.y()); };
      from = met(s.begin);
      to = met(s.end);
    } else {
      const Vec2 begin = s.begin - source, end = s.end - source;
      if (std::abs(cross(begin, end)) <= touch * (end - begin).norm()) continue;
      if (!keep_positive(s, begin.y(), end.y())) continue;
      const auto met = [&](const Vec2& p) {
        const Vec2 ray = p - source;
        return ray.y() > touch ? source.x() - ray.x() * (source.y() / ray.y()) : std::copysign(k_infinity, ray.x());
      };
      from = met(s.begin);
      to = met(s.end);
    }
    if (from > to) std::swap(from, to);
    from = std::max(from, window.b0);
    to = std::min(to, window.b1);
    if (from < to) result.emplace_back(from, to);
  }
  std::ranges::sort(result);
  std::size_t kept = 0;
  for (const auto& interval : result) {
    if (kept > 0 && interval.first <= result[kept - 1].second) {
      result[kept - 1].second = std::max(result[kept - 1].second, interval.second);
    } else {
      result[kept++] = interval;
    }
  }
  result.resize(kept);
  return result;
}

}  // namespace saddleback
