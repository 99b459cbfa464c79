// An edge that turns with its shape by a small angle stays within the hull of its first and last place, but for the
// bulge of the arcs that its ends run on. The fronts of a hull are those of the segments between its corners.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "saddleback/distribution/safe_distance.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr double k_range = 2 * std::numbers::pi / FrontProfiles::k_angles;
/// Angles are reduced to one turn with rounding of some 1e-16; ranges overlap by more.
constexpr double k_half_range = 0.5 * k_range + 1e-12;
/// Bounds by how much arcs of that half angle bulge over their chord, and rounding, as a share of the radius.
constexpr double k_rounding = 1e-12;
const double k_bulge = (1 - std::cos(k_half_range)) + k_rounding;

/// The nearest float or the next above it.
float rounded_up(double value) {
  constexpr double k_share = std::numeric_limits<float>::epsilon();
  return static_cast<float>(value + k_share * std::abs(value) + std::numeric_limits<float>::denorm_min());
}

/// The strips of one range of angles.
class Strips {
 public:
  Strips(float* fronts, double half_width, double pad)
      : fronts_(fronts), half_width_(half_width), per_unit_(FrontProfiles::k_columns / (2 * half_width)), pad_(pad) {}

  /// Raises the strips that the segment between the two meets: x is along the view, y across. \pre low.y <= high.y
  void add(const Vec2& low, const Vec2& high) const {
    const double first = (low.y() - pad_ + half_width_) * per_unit_, last = (high.y() + pad_ + half_width_) * per_unit_;
    if (last < 0 || first >= FrontProfiles::k_columns) return;
    const auto begin = static_cast<Index>(std::max(0.0, first));
    const Index end = std::min(FrontProfiles::k_columns - 1, static_cast<Index>(last));
    const double rise = high.y() - low.y(), farthest = std::max(low.x(), high.x()) + pad_;
    if (!(rise > pad_)) {
      for (Index k = begin; k <= end; ++k) fronts_[k] = std::max(fronts_[k], rounded_up(farthest));
      return;
    }
    // The segment is farthest at one of the ends of its part over the strip, which the pad widens on either side.
    const double slope = (high.x() - low.x()) / rise, width = 1 / per_unit_;
    const double ahead = (slope > 0 ? width + pad_ : -pad_) - half_width_ - low.y();
    for (Index k = begin; k <= end; ++k) {
      const double x = low.x() + slope * (k * width + ahead) + pad_;
      fronts_[k] = std::max(fronts_[k], rounded_up(std::min(farthest, x)));
    }
  }

 private:
  float* fronts_;
  double half_width_, per_unit_, pad_;
};

/// Points as seen along a direction.
class View {
 public:
  explicit View(double angle) : cosine_(std::cos(angle)), sine_(std::sin(angle)) {}
  Vec2 operator()(const Vec2& point) const {
    return {cosine_ * point.x() + sine_ * point.y(), cosine_ * point.y() - sine_ * point.x()};
  }

 private:
  double cosine_, sine_;
};

/// The point in views at the begin and the end of a range.
struct Swept {
  Vec2 first, last;
};

/// The front of the hull of an edge in both views: of its corners those that are farthest, from right to left.
void add_hull(const Strips& strips, const Swept& p, const Swept& q) {
  std::array<Vec2, 4> corners{p.first, p.last, q.first, q.last};
  const auto sort = [&](int i, int j) {
    if (corners[j].y() < corners[i].y()) std::swap(corners[i], corners[j]);
  };
  sort(0, 1), sort(2, 3), sort(0, 2), sort(1, 3), sort(1, 2);
  std::array<Vec2, 4> front;
  int count = 0;
  for (const Vec2& corner : corners) {
    const auto is_behind = [&](const Vec2& before, const Vec2& middle) {
      return (middle.y() - before.y()) * (corner.x() - before.x()) >=
             (middle.x() - before.x()) * (corner.y() - before.y());
    };
    while (count > 1 && is_behind(front[count - 2], front[count - 1])) --count;
    front[count++] = corner;
  }
  for (int i = 0; i + 1 < count; ++i) strips.add(front[i], front[i + 1]);
}

}  // namespace

FrontProfiles::FrontProfiles(const Shape& shape, double half_width, int threads, const JobStage& stage)
    : half_width_(half_width) {
  fronts_.assign(static_cast<std::size_t>(k_angles) * k_columns, -std::numeric_limits<float>::infinity());
  const double pad = k_bulge * shape.circumradius(), level = k_rounding * shape.circumradius();
  constexpr Index k_chunk = 16;
  parallel_for(k_angles, threads, k_chunk, [&](Index range, int) {
    stage.update(static_cast<double>(range) / k_angles);
    const Strips strips(fronts_.data() + static_cast<std::size_t>(range) * k_columns, half_width, pad);
    const double angle = (range + 0.5) * k_range;
    const View first(angle - k_half_range), last(angle + k_half_range);
    for (const Shape::Loop& loop : shape.loops()) {
      Swept before{first(loop.back()), last(loop.back())};
      for (const Vec2& corner : loop) {
        const Swept here{first(corner), last(corner)};
        // The shape is to the left of its edges: those that run to the right are behind others all over the range.
        if (here.first.y() - before.first.y() > -level || here.last.y() - before.last.y() > -level)
          add_hull(strips, before, here);
        before = here;
      }
    }
  });
}

Index FrontProfiles::range_of(double angle) {
  double turns = angle / (2 * std::numbers::pi);
  turns -= std::floor(turns);
  return std::min(k_angles - 1, static_cast<Index>(turns * k_angles));
}

}  // namespace saddleback
