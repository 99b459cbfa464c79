#pragma once
// The packing of an arc into one word, for the processor and for CUDA devices alike; see ArcCodec.

#include <bit>
#include <cstdint>

#include "support/cuda/host_device.h"

namespace saddleback {

struct ArcPacking {
  std::uint64_t target_mask = 0, length_mask = 0, bias = 0;
  int target_bits = 1, length_shift = 9;
  int kept_shift = 6;  ///< that brings a double's exponent to the top of the word
  double least = 1, rounder = 1;

  /// Rounds up, so that no distance is shorter than the truth.
  SADDLEBACK_HOST_DEVICE double round(double length) const {
    const double rounded = round_up(length, rounder);
    return rounded < least ? least : rounded;
  }
  /// Rounds up to a multiple of the last bit of `rounder`, a power of two that is no shorter: their sum has room for no
  /// less.
  SADDLEBACK_HOST_DEVICE static double round_up(double length, double rounder) {
    const double nearest = (length + rounder) - rounder;
    return nearest < length ? nearest + rounder * 0x1p-52 : nearest;
  }
  SADDLEBACK_HOST_DEVICE std::uint64_t pack(std::int32_t target, int sector, double length) const {
    // A length that is greater by rounding alone must not go up to the next number: on regular meshes many are equally
    // long.
    constexpr double k_as_long = 1 - 0x1p-43;
    const std::uint64_t bits = (bits_of(round(k_as_long * length)) - bias) << kept_shift;
    // A carry into the exponent is what rounding up means.
    return ((bits + ~length_mask) & length_mask) | directed(target, sector);
  }
  /// Returns the same arc from its other end, where it leaves in `sector`.
  SADDLEBACK_HOST_DEVICE std::uint64_t reversed(std::int32_t source, int sector, std::uint64_t word) const {
    return (word & length_mask) | directed(source, sector);
  }

 private:
  SADDLEBACK_HOST_DEVICE std::uint64_t directed(std::int32_t target, int sector) const {
    return static_cast<std::uint64_t>(sector) << target_bits | static_cast<std::uint64_t>(target);
  }
  SADDLEBACK_HOST_DEVICE static std::uint64_t bits_of(double value) {
#if defined(__CUDA_ARCH__)
    return static_cast<std::uint64_t>(__double_as_longlong(value));
#else
    return std::bit_cast<std::uint64_t>(value);
#endif
  }
};

}  // namespace saddleback
