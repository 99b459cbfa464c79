// Eight bytes at a time by eight tables [kounavis2008].

#include "support/crc32.h"

#include <array>

namespace saddleback {
namespace {

constexpr std::uint32_t k_polynomial = 0xEDB88320;  // reflected
constexpr std::size_t k_slices = 8;
using Tables = std::array<std::array<std::uint32_t, 256>, k_slices>;

constexpr Tables make_tables() {
  Tables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? crc >> 1 ^ k_polynomial : crc >> 1;
    tables[0][byte] = crc;
  }
  for (std::size_t slice = 1; slice < k_slices; ++slice) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[slice - 1][byte];
      tables[slice][byte] = before >> 8 ^ tables[0][before & 0xFF];
    }
  }
  return tables;
}

constexpr Tables k_tables = make_tables();

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t crc) {
  crc = ~crc;
  std::size_t i = 0;
  const auto at = [&](std::size_t offset) { return std::to_integer<std::uint32_t>(bytes[i + offset]); };
  for (; i + k_slices <= bytes.size(); i += k_slices) {
    const std::uint32_t low = crc ^ (at(0) | at(1) << 8 | at(2) << 16 | at(3) << 24);
    crc = k_tables[7][low & 0xFF] ^ k_tables[6][low >> 8 & 0xFF] ^ k_tables[5][low >> 16 & 0xFF] ^
          k_tables[4][low >> 24] ^ k_tables[3][at(4)] ^ k_tables[2][at(5)] ^ k_tables[1][at(6)] ^ k_tables[0][at(7)];
  }
  for (; i < bytes.size(); ++i) crc = crc >> 8 ^ k_tables[0][(crc & 0xFF) ^ at(0)];
  return ~crc;
}

}  // namespace saddleback
