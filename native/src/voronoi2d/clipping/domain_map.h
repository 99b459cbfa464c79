#pragma once
// A map of the parts of the plane that are far from a domain's edges.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "saddleback/voronoi2d/planar_domain.h"

namespace saddleback::voronoi2d {

/// Squares over the domain's box, marked where an edge may pass; the others lie inside or outside.
class DomainMap {
 public:
  DomainMap(const PlanarDomain& domain, Index size) : size_(size) {
    for (const Vec2& p : domain.loops()[0]) {
      lower_ = lower_.cwiseMin(p);
      upper_ = upper_.cwiseMax(p);
    }
    scale_ = (upper_ - lower_).cwiseInverse() * size;
    sums_.assign(static_cast<std::size_t>(size + 1) * (size + 1), 0);
    for (const auto& loop : domain.loops())
      for (std::size_t i = 0; i < loop.size(); ++i) mark(loop[i], loop[(i + 1) % loop.size()]);
    for (Index y = 1; y <= size; ++y)
      for (Index x = 1; x <= size; ++x) sum(x, y) += sum(x - 1, y) + sum(x, y - 1) - sum(x - 1, y - 1);
    find_inside(domain);
  }

  enum class Place { outside, inside, at_edge };
  /// Returns where a box lies; `at_edge` when in doubt.
  Place place(const Vec2& low, const Vec2& high) const {
    if ((high.array() < lower_.array()).any() || (low.array() > upper_.array()).any()) return Place::outside;
    if ((low.array() < lower_.array()).any() || (high.array() > upper_.array()).any()) return Place::at_edge;
    const Index x = column(low.x()), y = row(low.y()), end_x = column(high.x()) + 1, end_y = row(high.y()) + 1;
    if (sum(end_x, end_y) - sum(x, end_y) - sum(end_x, y) + sum(x, y) > 0) return Place::at_edge;
    return is_inside_[place_of(x, y)] != 0 ? Place::inside : Place::outside;
  }

 private:
  Index column(double x) const { return std::clamp(static_cast<Index>((x - lower_.x()) * scale_.x()), 0, size_ - 1); }
  Index row(double y) const { return std::clamp(static_cast<Index>((y - lower_.y()) * scale_.y()), 0, size_ - 1); }
  Index& sum(Index x, Index y) { return sums_[static_cast<std::size_t>(y) * (size_ + 1) + x]; }
  Index sum(Index x, Index y) const { return sums_[static_cast<std::size_t>(y) * (size_ + 1) + x]; }

  // One square more on every side than the edge meets, for the sake of rounding.
  void mark(Vec2 a, Vec2 b) {
    if (a.y() > b.y()) std::swap(a, b);
    const Index first = std::max(0, row(a.y()) - 1), last = std::min(size_ - 1, row(b.y()) + 1);
    for (Index y = first; y <= last; ++y) {
      const auto x_at = [&](Index line) {
        const double share = (lower_.y() + line / scale_.y() - a.y()) / (b.y() - a.y());
        return a.x() + (share > 0 ? std::min(share, 1.0) : 0.0) * (b.x() - a.x());
      };
      const bool is_level = row(a.y()) == row(b.y());
      const double from = is_level ? a.x() : x_at(y - 1), to = is_level ? b.x() : x_at(y + 2);
      const Index begin = std::max(0, column(std::min(from, to)) - 1),
                  end = std::min(size_ - 1, column(std::max(from, to)) + 1);
      for (Index x = begin; x <= end; ++x) sum(x + 1, y + 1) = 1;
    }
  }

  /// Tells of all squares that no edge comes near, which rounding cannot mistake, whether they are inside: by how often
  /// the line through a row's middle has crossed the domain's edges before.
  void find_inside(const PlanarDomain& domain) {
    is_inside_.assign(static_cast<std::size_t>(size_) * size_, 0);
    const auto middle = [&](Index y) { return lower_.y() + (y + 0.5) / scale_.y(); };
    for (const auto& loop : domain.loops())
      for (std::size_t i = 0; i < loop.size(); ++i) {
        Vec2 a = loop[i], b = loop[(i + 1) % loop.size()];
        if (a.y() > b.y()) std::swap(a, b);
        for (Index y = row(a.y()); y <= row(b.y()); ++y)
          if (a.y() <= middle(y) && middle(y) < b.y())
            is_inside_[place_of(column(a.x() + (middle(y) - a.y()) / (b.y() - a.y()) * (b.x() - a.x())), y)] ^= 1;
      }
    for (Index y = 0; y < size_; ++y)
      for (Index x = 1; x < size_; ++x) is_inside_[place_of(x, y)] ^= is_inside_[place_of(x - 1, y)];
  }

  std::size_t place_of(Index x, Index y) const { return static_cast<std::size_t>(y) * size_ + x; }

  Index size_;
  Vec2 lower_ = Vec2::Constant(std::numeric_limits<double>::infinity());
  Vec2 upper_ = -lower_;
  Vec2 scale_;  ///< squares by length
  std::vector<Index> sums_;
  std::vector<std::uint8_t> is_inside_;
};

}  // namespace saddleback::voronoi2d
