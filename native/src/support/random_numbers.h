#pragma once
// Random numbers by counter: any of them at any time, the same everywhere.

#include <cstdint>

namespace saddleback {

/// A well mixed 64-bit number for each pair (splitmix64 [steele2014]).
inline std::uint64_t mixed(std::uint64_t seed, std::uint64_t counter) {
  std::uint64_t z = seed + (counter + 1) * 0x9E3779B97F4A7C15u;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return z ^ (z >> 31);
}

/// Uniform in [0, 1), 53 bits.
inline double uniform(std::uint64_t key, std::uint64_t counter) {
  return static_cast<double>(mixed(key, counter) >> 11) * 0x1p-53;
}

}  // namespace saddleback
