// Hilbert keys after [skilling2004]. There each bit of the axes turns all lower bits of them; what has been turned so
// far is one of few frames, so that a table tells each octant's place and the next frame.

#include "mesh/tables/hilbert.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace saddleback {
namespace {

constexpr int k_bits = 20;

/// Holds how the curve lies in an octant: the axis that is read as each of three, which of those are upside down, and
/// whether the curve runs backwards.
struct Frame {
  std::array<int, 3> axis{}, flipped{};
  int backwards = 0;

  static constexpr int k_count = 96;
  static constexpr Frame at(int number) {
    const int first = number >> 5, lower = first == 0 ? 1 : 0, upper = 3 - first - lower;
    const bool swapped = number >> 4 & 1;
    return {{first, swapped ? upper : lower, swapped ? lower : upper},
            {number >> 3 & 1, number >> 2 & 1, number >> 1 & 1},
            number & 1};
  }
  constexpr int number() const {
    return axis[0] << 5 | (axis[1] > axis[2]) << 4 | flipped[0] << 3 | flipped[1] << 2 | flipped[2] << 1 | backwards;
  }
};

/// Holds what an octant in a frame adds to the key, and the frame inside it.
struct Step {
  std::uint16_t digit, frame;
};

constexpr Step step_into(Frame frame, int octant) {
  std::array<int, 3> bit{};
  for (int i = 0; i < 3; ++i) bit[i] = (octant >> (2 - frame.axis[i]) & 1) ^ frame.flipped[i];
  const int gray[3] = {bit[0], bit[0] ^ bit[1], bit[0] ^ bit[1] ^ bit[2]};
  const int digit = (gray[0] << 2 | gray[1] << 1 | gray[2]) ^ (frame.backwards ? 7 : 0);
  for (int i = 0; i < 3; ++i) {
    if (bit[i]) {
      frame.flipped[0] ^= 1;
    } else {
      std::swap(frame.axis[0], frame.axis[i]);
      std::swap(frame.flipped[0], frame.flipped[i]);
    }
  }
  frame.backwards ^= gray[2];
  return {static_cast<std::uint16_t>(digit), static_cast<std::uint16_t>(frame.number())};
}

constexpr auto k_steps = [] {
  std::array<std::array<Step, 8>, Frame::k_count> steps{};
  for (int frame = 0; frame < Frame::k_count; ++frame)
    for (int octant = 0; octant < 8; ++octant) steps[frame][octant] = step_into(Frame::at(frame), octant);
  return steps;
}();

/// The lowest k_bits bits, two zeros before each.
std::uint64_t spread(std::uint64_t bits) {
  bits = (bits | bits << 32) & 0x1f00000000ffff;
  bits = (bits | bits << 16) & 0x1f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

std::uint64_t hilbert_key(const std::array<std::uint32_t, 3>& cell) {
  const std::uint64_t octants = spread(cell[0]) << 2 | spread(cell[1]) << 1 | spread(cell[2]);
  std::uint64_t key = 0;
  std::uint32_t frame = Frame{{0, 1, 2}}.number();
  for (int shift = 3 * (k_bits - 1); shift >= 0; shift -= 3) {
    const Step step = k_steps[frame][octants >> shift & 7];
    key = key << 3 | step.digit;
    frame = step.frame;
  }
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
