#include "geodesics/joined_paths.h"

#include <algorithm>
#include <utility>

namespace saddleback {
namespace {

/// Room for as many items as there will be, about: a list that grows little by little is copied again and again.
template <class T>
void make_room(std::vector<T>& items, std::size_t more, double share) {
  constexpr double k_margin = 1.1, k_growth = 1.5;
  const std::size_t wanted = items.size() + more;
  if (wanted <= items.capacity()) return;
  const double likely = k_margin * static_cast<double>(wanted) / std::min(1.0, share);
  items.reserve(std::max({wanted, static_cast<std::size_t>(likely),
                          static_cast<std::size_t>(k_growth * static_cast<double>(items.capacity()))}));
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
