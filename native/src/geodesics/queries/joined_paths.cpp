#include "geodesics/queries/joined_paths.h"

#include <algorithm>
#include <utility>

namespace saddleback {
namespace {

/// Room for as many items as there will be, about, and early: a list that turns out too short near the end is copied
/// whole, which takes as long as much of the work.
template <class T>
void make_room(std::vector<T>& items, std::size_t more, double share) {
  constexpr double k_margin = 1.2, k_doubt = 1.05, k_early = 0.5, k_growth = 1.5;
  const std::size_t wanted = items.size() + more;
  const double likely = static_cast<double>(wanted) / std::min(1.0, share);
  const auto capacity = static_cast<double>(items.capacity());
  const bool has_room = wanted <= items.capacity();
  if (has_room && (share > k_early || k_doubt * likely <= capacity)) return;
  const double room = std::max(k_margin * likely, has_room ? 0 : k_growth * capacity);
  items.reserve(std::max(wanted, static_cast<std::size_t>(room)));
}

template <class T>
void append_all(std::vector<T>& items, const std::vector<T>& more, double share) {
  make_room(items, more.size(), share);
  items.insert(items.end(), more.begin(), more.end());
}

}  // namespace

void JoinedPaths::add(std::size_t block, double share, GeodesicPaths& part) {
  {
    const std::lock_guard lock(guard_);
    ready_[block] = Block{std::exchange(part, {}), share};
    if (is_joining_) return;
    is_joining_ = true;
  }
  while (const std::optional<Block> ready = next()) append(*ready);
}

/// The next block if it is ready; else nobody joins any more.
std::optional<JoinedPaths::Block> JoinedPaths::next() {
  const std::lock_guard lock(guard_);
  is_joining_ = next_ < ready_.size() && ready_[next_].has_value();
  return is_joining_ ? std::exchange(ready_[next_++], std::nullopt) : std::nullopt;
}

void JoinedPaths::append(const Block& block) {
  share_ += block.share;
  const std::int64_t start = paths_.offsets.back();
  append_all(paths_.points, block.paths.points, share_);
  append_all(paths_.surface, block.paths.surface, share_);
  append_all(paths_.lengths, block.paths.lengths, share_);
  append_all(paths_.sources, block.paths.sources, share_);
  make_room(paths_.offsets, block.paths.count(), share_);
  for (std::size_t i = 1; i < block.paths.offsets.size(); ++i) paths_.offsets.push_back(start + block.paths.offsets[i]);
}

}  // namespace saddleback
