#pragma once

#include <algorithm>
#include <cmath>

namespace saddleback {

/// The length sqrt(x^2 + y^2) of finite numbers to within one unit of the last place, without overflow on the way: what
/// std::hypot is, but the same to the bit on every system, and in no need of a new one. After [borges2020].
inline double hypotenuse(double x, double y) {
  constexpr double k_large = 0x1p511, k_small = 0x1p-459, k_scale = 0x1p-600, k_negligible = 0x1p-54;
  const auto corrected = [](double a, double b) {
    const double length = std::sqrt(a * a + b * b);
    if (length <= 2 * b) {
      const double excess = length - b;
      return length - (a * (2 * excess - a) + (excess - 2 * (a - b)) * excess) / (2 * length);
    }
    const double excess = length - a;
    return length - (2 * excess * (a - 2 * b) + ((4 * excess - b) * b + excess * excess)) / (2 * length);
  };
  const double a = std::max(std::fabs(x), std::fabs(y)), b = std::min(std::fabs(x), std::fabs(y));
  if (b <= a * k_negligible) return a + b;
  if (a > k_large) return corrected(a * k_scale, b * k_scale) / k_scale;
  if (b < k_small) return corrected(a / k_scale, b / k_scale) * k_scale;
  return corrected(a, b);
}

}  // namespace saddleback
