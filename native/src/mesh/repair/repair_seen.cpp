// Finds which way open bodies face: the side of which more is seen from outside [takayama2014], here in depth buffers.
// All faces hide each other, whichever way they face, so that no body waits for another.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "mesh/repair/repair_steps.h"

namespace saddleback {
namespace {

/// Factor by which more must be seen of the back before a body is turned: of a bowl that much more is seen from without
/// where it is deeper than half of its radius. A flat sheet shows as much of both sides, and stays as it came.
constexpr double k_decided = 1.25;
constexpr int k_least_side = 64, k_most_side = 1024;  ///< pixels
constexpr double k_most_drawn = 1 << 24;              ///< pixels in a view, about: many layers need no more time

/// Directions of lines: through the middles of a cube's sides and edges, and through its corners.
constexpr std::array<std::array<double, 3>, 13> k_directions{{{1, 0, 0},
                                                              {0, 1, 0},
                                                              {0, 0, 1},
                                                              {1, 1, 0},
                                                              {1, -1, 0},
                                                              {1, 0, 1},
                                                              {1, 0, -1},
                                                              {0, 1, 1},
                                                              {0, 1, -1},
                                                              {1, 1, 1},
                                                              {1, 1, -1},
                                                              {1, -1, 1},
                                                              {1, -1, -1}}};

struct Seen {
  double depth;
  Index face = k_none;
};

/// Faces seen along a line, from its beginning and from its end.
class View {
 public:
  View(const RepairState& state, const Sheets& sheets, int side, const Vec3& along, const JobStage& stage)
      : state_(state), sheets_(sheets), side_(side), along_(along), x_(along.unitOrthogonal()), y_(along.cross(x_)) {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Triangle& face : sheets.coarse)
      for (const Index v : face) {
        low = low.cwiseMin(seen_from(v));
        high = high.cwiseMax(seen_from(v));
      }
    begin_ = low;
    const double extent = std::max(high.x() - low.x(), high.y() - low.y());
    to_pixels_ = extent > 0 ? side / extent : 0;
    first_.assign(static_cast<std::size_t>(side) * side, {std::numeric_limits<double>::infinity()});
    last_.assign(first_.size(), {-std::numeric_limits<double>::infinity()});
    for (Index i = 0; i < static_cast<Index>(sheets.coarse.size()); ++i) {
      stage.check();
      draw(i);
    }
  }

  /// Adds the area of which each body is seen from the front, and from the back: views are of different scales.
  void add(const std::vector<Index>& labels, std::vector<std::array<double, 2>>& seen) const {
    const double pixel = to_pixels_ > 0 ? 1 / (to_pixels_ * to_pixels_) : 0;
    for (std::size_t i = 0; i < first_.size(); ++i) {
      if (first_[i].face == k_none) continue;
      seen[labels[first_[i].face]][faces_along(first_[i].face) ? 1 : 0] += pixel;
      seen[labels[last_[i].face]][faces_along(last_[i].face) ? 0 : 1] += pixel;
    }
  }

 private:
  /// A position as seen along the line.
  Vec3 seen_from(Index vertex) const {
    const Vec3& p = state_.positions[vertex];
    return {p.dot(x_), p.dot(y_), p.dot(along_)};
  }

  Vec3 in_pixels(Index vertex) const {
    Vec3 p = seen_from(vertex) - begin_;
    p.head<2>() *= to_pixels_;
    return p;
  }

  bool faces_along(Index face) const {
    const Triangle& t = sheets_.coarse[face];
    const Vec3 a = in_pixels(t[0]), p = in_pixels(t[1]) - a, q = in_pixels(t[2]) - a;
    return (p.x() * q.y() - p.y() * q.x() > 0) != (sheets_.turned[face] != 0);
  }

  void draw(Index face) {
    // In an order of their own, so that rounding is the same whichever way the face came.
    Triangle sorted = sheets_.coarse[face];
    std::sort(sorted.begin(), sorted.end(), [&](Index v, Index w) {
      const Vec3 &p = state_.positions[v], &q = state_.positions[w];
      return std::lexicographical_compare(p.data(), p.data() + 3, q.data(), q.data() + 3);
    });
    const Vec3 a = in_pixels(sorted[0]), b = in_pixels(sorted[1]), c = in_pixels(sorted[2]);
    const Vec3 p = b - a, q = c - a;
    const double area = p.x() * q.y() - p.y() * q.x();
    const auto pixel = [&](double at) { return std::clamp(static_cast<int>(std::ceil(at - 0.5)), 0, side_); };
    const int left = pixel(std::min({a.x(), b.x(), c.x()})), right = pixel(std::max({a.x(), b.x(), c.x()}));
    const int low = pixel(std::min({a.y(), b.y(), c.y()})), high = pixel(std::max({a.y(), b.y(), c.y()}));
    if (area == 0 || left == right || low == high) return;
    for (int row = low; row < high; ++row) {
      const auto [begin, end] = columns_of({a, b, c}, row + 0.5);
      for (int column = std::max(left, begin); column < std::min(right, end); ++column) {
        const double dx = column + 0.5 - a.x(), dy = row + 0.5 - a.y();
        const double s = (dx * q.y() - dy * q.x()) / area, t = (p.x() * dy - p.y() * dx) / area;
        if (s < 0 || t < 0 || s + t > 1) continue;
        const double depth = a.z() + s * p.z() + t * q.z();
        const std::size_t i = static_cast<std::size_t>(row) * side_ + column;
        if (depth < first_[i].depth) first_[i] = {depth, face};
        if (depth > last_[i].depth) last_[i] = {depth, face};
      }
    }
  }

  /// Returns which columns a triangle may cover in a row, one more on both sides: of a needle's box it covers few.
  std::pair<int, int> columns_of(const std::array<Vec3, 3>& corner, double y) const {
    constexpr double k_level = 1e-6;  // pixels
    double left = side_, right = 0;
    for (int i = 0; i < 3; ++i) {
      const Vec3 &p = corner[i], &q = corner[(i + 1) % 3];
      const double rise = q.y() - p.y();
      if (y < std::min(p.y(), q.y()) - k_level || y > std::max(p.y(), q.y()) + k_level) continue;
      const bool is_level = std::abs(rise) < k_level;
      const double at = is_level ? p.x() : p.x() + std::clamp((y - p.y()) / rise, 0.0, 1.0) * (q.x() - p.x());
      left = std::min({left, at, is_level ? q.x() : at});
      right = std::max({right, at, is_level ? q.x() : at});
    }
    return {static_cast<int>(left) - 1, static_cast<int>(right) + 2};
  }

  const RepairState& state_;
  const Sheets& sheets_;
  int side_;
  Vec3 along_, x_, y_, begin_;
  double to_pixels_ = 0;
  std::vector<Seen> first_, last_;  ///< per pixel
};

std::vector<std::uint8_t> open_bodies(const Sheets& sheets, const std::vector<Index>& labels, Index label_count) {
  std::vector<std::uint8_t> open(label_count, 0);
  for (std::size_t h = 0; h < sheets.twins.size(); ++h)
    if (sheets.twins[h] == k_none) open[labels[h / 3]] = 1;
  return open;
}

/// Returns how many faces lie behind a pixel, about: seen aslant they cover half of their area.
double layers(const RepairState& state, const Sheets& sheets) {
  Eigen::AlignedBox3d box;
  double area = 0;
  for (const Triangle& t : sheets.coarse) {
    const Vec3 &a = state.positions[t[0]], &b = state.positions[t[1]], &c = state.positions[t[2]];
    box.extend(a).extend(b).extend(c);
    area += 0.5 * (b - a).cross(c - a).norm();
  }
  const double extent = box.diagonal().norm();
  return extent > 0 ? 0.5 * area / (extent * extent) : 0;
}

}  // namespace

void turn_seen_outward(const RepairState& state, Sheets& sheets, const std::vector<Index>& labels, Index label_count,
                       const JobStage& stage) {
  const std::vector<std::uint8_t> open = open_bodies(sheets, labels, label_count);
  if (std::find(open.begin(), open.end(), 1) == open.end()) return;
  const double detail = 4 * std::sqrt(static_cast<double>(labels.size()));
  const double affordable = std::sqrt(k_most_drawn / std::max(layers(state, sheets), 1e-9));
  const int side = static_cast<int>(std::clamp<double>(std::min(detail, affordable), k_least_side, k_most_side));
  std::vector<std::array<double, 2>> seen(label_count, {0, 0});
  for (const std::array<double, 3>& d : k_directions) {
    View(state, sheets, side, Vec3(d[0], d[1], d[2]).normalized(), stage).add(labels, seen);
  }
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const auto& [front, back] = seen[labels[i]];
    sheets.turned[i] ^= open[labels[i]] && back > k_decided * front;
  }
}

}  // namespace saddleback
