// An edge that turns with its shape by a small angle stays within the hull of its first and last place, but for the
// bulge of the arcs that its ends run on. The fronts of a hull are those of the segments between its corners.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "saddleback/error.h"
#include "saddleback/safe_distance.h"

namespace saddleback {
namespace {

constexpr double k_range = 2 * std::numbers::pi / FrontProfiles::k_angles;
/// Angles are reduced to one turn with rounding of some 1e-16; ranges overlap by more.
constexpr double k_half_range = 0.5 * k_range + 1e-12;
/// By how much arcs of that half angle bulge over their chord, and rounding, as a share of the radius.
const double k_bulge = (1 - std::cos(k_half_range)) + 1e-12;

float rounded_up(double value) {
  const auto result = static_cast<float>(value);
  return result < value ? std::nextafter(result, std::numeric_limits<float>::infinity()) : result;
}

/// The strips of one range of angles.
class Strips {
 public:
  Strips(float* fronts, double half_width, double pad)
      : fronts_(fronts), half_width_(half_width), per_unit_(FrontProfiles::k_columns / (2 * half_width)), pad_(pad) {}

  /// Raises the strips that the segment from p to q meets: x is along the view, y across.
  void add(const Vec2& p, const Vec2& q) const {
    const Vec2 &low = p.y() < q.y() ? p : q, &high = p.y() < q.y() ? q : p;
    const double first = (low.y() - pad_ + half_width_) * per_unit_, last = (high.y() + pad_ + half_width_) * per_unit_;
    if (last < 0 || first >= FrontProfiles::k_columns) return;
    const auto begin = static_cast<Index>(std::max(0.0, first));
    const Index end = std::min(FrontProfiles::k_columns - 1, static_cast<Index>(last));
    const double rise = high.y() - low.y(), farthest = std::max(p.x(), q.x());
    const double slope = rise > 0 ? (high.x() - low.x()) / rise : 0;
    for (Index k = begin; k <= end; ++k) {
      // The segment is farthest at one of the ends of its part over the strip, which the pad widens on either side.
      double x = farthest;
      if (rise > pad_) {
        const double from = std::max(k / per_unit_ - half_width_ - pad_, low.y());
        const double to = std::min((k + 1) / per_unit_ - half_width_ + pad_, high.y());
        x = std::min(farthest, low.x() + slope * ((slope > 0 ? to : from) - low.y()));
      }
      const float front = rounded_up(x + pad_);
      if (front > fronts_[k]) fronts_[k] = front;
    }
  }

 private:
  float* fronts_;
  double half_width_, per_unit_, pad_;
};

/// The point in views at the begin and the end of a range.
struct Swept {
  Vec2 first, last;
};

Swept swept(const Vec2& point, double angle) {
  const auto view = [&](double at) {
    const double c = std::cos(at), s = std::sin(at);
    return Vec2(c * point.x() + s * point.y(), c * point.y() - s * point.x());
  };
  return {view(angle - k_half_range), view(angle + k_half_range)};
}

}  // namespace

FrontProfiles::FrontProfiles(const Shape& shape, double half_width) : half_width_(half_width) {
  fronts_.assign(static_cast<std::size_t>(k_angles) * k_columns, -std::numeric_limits<float>::infinity());
  const double pad = k_bulge * shape.circumradius();
  std::vector<Swept> corners;
  for (Index range = 0; range < k_angles; ++range) {
    const Strips strips(fronts_.data() + static_cast<std::size_t>(range) * k_columns, half_width, pad);
    for (const Shape::Loop& loop : shape.loops()) {
      corners.clear();
      for (const Vec2& corner : loop) corners.push_back(swept(corner, (range + 0.5) * k_range));
      const Swept* before = &corners.back();
      for (const Swept& corner : corners) {
        strips.add(corner.first, corner.last);
        strips.add(before->first, corner.first);
        strips.add(before->last, corner.last);
        strips.add(before->first, corner.last);
        strips.add(before->last, corner.first);
        before = &corner;
      }
    }
  }
}

Index FrontProfiles::range_of(double angle) {
  double turns = angle / (2 * std::numbers::pi);
  turns -= std::floor(turns);
  return std::min(k_angles - 1, static_cast<Index>(turns * k_angles));
}

}  // namespace saddleback
