#pragma once
// How an arc becomes one word, for the processor and for CUDA devices alike; see ArcCodec.

#include <bit>
#include <cstdint>

#include "saddleback/host_device.h"

namespace saddleback {

struct ArcPacking {
  std::uint64_t target_mask = 0, length_mask = 0, bias = 0;
  int target_bits = 1, length_shift = 9;
  int kept_shift = 6;  ///< that brings a double's exponent to the top of the word
  double least = 1, rounder = 1;

  SADDLEBACK_HOST_DEVICE double round(double length) const {
    // No path is as long as the rounder, whose own last bit is the quantum: the sum has room for no smaller ones.
    const double rounded = (length + rounder) - rounder;
    return rounded < least ? least : rounded;
  }
  SADDLEBACK_HOST_DEVICE std::uint64_t pack(std::int32_t target, int sector, double length) const {
    // Half a unit in the last place that is kept; a carry into the exponent is what rounding up means.
    const std::uint64_t bits = (bits_of(round(length)) - bias) << kept_shift;
    const std::uint64_t half = std::uint64_t{1} << (length_shift - 1);
    return ((bits + half) & length_mask) | directed(target, sector);
  }
  /// The same arc from its other end, where it leaves in `sector`.
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
