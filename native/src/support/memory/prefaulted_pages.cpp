#include "support/memory/prefaulted_pages.h"

namespace saddleback {
namespace {

constexpr std::size_t k_chunk = std::size_t{1} << 22;  ///< smaller ones are kept for arrays of their own size only
constexpr std::size_t k_page = std::size_t{1} << 12;   ///< where the system has no larger ones to give

}  // namespace

void PrefaultedPages::extend(std::size_t bytes) {
  const std::size_t had = chunks_.size() * k_chunk;
  if (had >= bytes || had + k_chunk > most_kept_large()) return;
  LargeArray<std::byte>& chunk = chunks_.emplace_back(k_chunk);
  for (std::size_t i = 0; i < k_chunk; i += k_page) chunk[i] = std::byte{1};
}

}  // namespace saddleback
