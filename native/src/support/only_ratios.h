#pragma once
// Values of which only ratios matter, such as densities.

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace saddleback {

/// The values as they are, unless their squares or sums of those may overflow or vanish: then the largest is made 1 to
/// 2, by a power of two, so that ratios stay what they are.
class OnlyRatios {
 public:
  /// `values` are finite, not negative, and must outlive this.
  explicit OnlyRatios(std::span<const double> values) : values_(values) {
    constexpr int k_most = 200;
    const double largest = values.empty() ? 0 : *std::max_element(values.begin(), values.end());
    if (largest == 0 || std::abs(std::ilogb(largest)) <= k_most) return;
    for (const double value : values) scaled_.push_back(std::ldexp(value, -std::ilogb(largest)));
    values_ = scaled_;
  }
  OnlyRatios(const OnlyRatios&) = delete;
  OnlyRatios& operator=(const OnlyRatios&) = delete;

  std::span<const double> values() const { return values_; }

 private:
  std::vector<double> scaled_;
  std::span<const double> values_;
};

}  // namespace saddleback
