// Hilbert keys after Skilling, "Programming the Hilbert curve" (2004): the axes' bits are transposed in place.

#include "hilbert.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace saddleback {
namespace {

constexpr int k_bits = 20;

std::uint64_t hilbert_key(std::array<std::uint32_t, 3> x) {
  constexpr std::uint32_t k_top = 1u << (k_bits - 1);
  for (std::uint32_t q = k_top; q > 1; q >>= 1) {
    const std::uint32_t p = q - 1;
    for (int i = 0; i < 3; ++i) {
      if (x[i] & q) {
        x[0] ^= p;
      } else {
        const std::uint32_t t = (x[0] ^ x[i]) & p;
        x[0] ^= t;
        x[i] ^= t;
      }
    }
  }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t t = 0;
  for (std::uint32_t q = k_top; q > 1; q >>= 1)
    if (x[2] & q) t ^= q - 1;
  std::uint64_t key = 0;
  for (int bit = k_bits - 1; bit >= 0; --bit)
    for (int i = 0; i < 3; ++i) key = key << 1 | ((x[i] ^ t) >> bit & 1u);
  return key;
}

}  // namespace

HilbertCurve::HilbertCurve(std::span<const Vec3> points) {
  if (points.empty()) return;
  Vec3 highest = lowest_ = points.front();
  for (const Vec3& point : points) {
    lowest_ = lowest_.cwiseMin(point);
    highest = highest.cwiseMax(point);
  }
  const double extent = (highest - lowest_).maxCoeff();
  if (extent > 0 && std::isfinite(extent)) scale_ = ((1 << k_bits) - 1) / extent;
}

std::uint64_t HilbertCurve::key(const Vec3& point) const {
  std::array<std::uint32_t, 3> cell{};
  for (int i = 0; i < 3; ++i) {
    const double place = (point[i] - lowest_[i]) * scale_;
    cell[i] = static_cast<std::uint32_t>(std::clamp(place, 0.0, static_cast<double>((1 << k_bits) - 1)));
  }
  return hilbert_key(cell);
}

}  // namespace saddleback
