#pragma once
// CRC-32 as in zip, PNG and Ethernet (IEEE 802.3): any damage of up to 32 neighboring bits is seen, any other but for
// one in four thousand million.

#include <cstddef>
#include <cstdint>
#include <span>

namespace saddleback {

/// Goes on from the CRC of what came before (0 at the beginning), so that a file can be summed while it streams.
std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t crc = 0);

}  // namespace saddleback
