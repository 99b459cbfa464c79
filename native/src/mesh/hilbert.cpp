// Hilbert keys after Skilling, "Programming the Hilbert curve" (2004): the axes' bits are transposed in place. The keys
// are sorted by their bytes, last byte first.

#include "hilbert.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

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

std::vector<Index> order_of(std::span<const std::uint64_t> keys, const JobStage& stage) {
  const std::size_t count = keys.size();
  std::vector<Index> order(count), sorted(count);
  std::iota(order.begin(), order.end(), 0);
  std::uint64_t differing = 0;
  for (const std::uint64_t key : keys) differing |= key ^ keys.front();
  constexpr int k_digit = 11;
  constexpr std::uint64_t k_mask = (1u << k_digit) - 1;
  for (int shift = 0; shift < 64; shift += k_digit) {
    if ((differing >> shift & k_mask) == 0) continue;
    stage.check();
    std::vector<std::size_t> start(k_mask + 2, 0);
    for (const std::uint64_t key : keys) ++start[(key >> shift & k_mask) + 1];
    std::partial_sum(start.begin(), start.end(), start.begin());
    for (const Index i : order) sorted[start[keys[i] >> shift & k_mask]++] = i;
    order.swap(sorted);
  }
  return order;
}

}  // namespace saddleback
