// Radix sort: all threads cut the keys into buckets by their first digit, and then each bucket is sorted in the cache
// of the thread that takes it, by a few shorter digits, last digit first. What these leave equal is rare.

#include "support/key_order.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "saddleback/support/large_array.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr Index k_chunk = 1 << 14;

/// Items by their first digit, and otherwise in the order of their indices.
template <class Key>
class Buckets {
 public:
  using Item = Keyed<Key>;
  Buckets(std::span<const Item> from, int threads, const JobStage& stage)
      : items_(from.size()), first_((Index{1} << bits_for(from.size())) + 1) {
    Key differing = 0;
    for (const Item& item : from) differing |= item.key ^ from.front().key;
    shift_ = std::max(0, static_cast<int>(std::bit_width(differing)) - bits_for(from.size()));
    const Index chunks = (static_cast<Index>(from.size()) + k_chunk - 1) / k_chunk;
    std::vector<Index> places(static_cast<std::size_t>(chunks) * count());
    const auto in_chunks = [&](auto&& visit) {
      parallel_for(chunks, threads, 1, [&](Index chunk, int) {
        stage.check();
        Index* const own = places.data() + static_cast<std::size_t>(chunk) * count();
        const std::size_t begin = static_cast<std::size_t>(chunk) * k_chunk;
        for (const Item& item : from.subspan(begin, std::min<std::size_t>(k_chunk, from.size() - begin)))
          visit(item, own[item.key >> shift_ & (count() - 1)]);
      });
    };
    in_chunks([](const Item&, Index& place) { ++place; });
    Index place = 0;
    for (Index bucket = 0; bucket < count(); ++bucket) {
      first_[bucket] = place;
      for (std::size_t at = bucket; at < places.size(); at += count()) place += std::exchange(places[at], place);
    }
    first_[count()] = place;
    in_chunks([&](const Item& item, Index& at) { items_[at++] = item; });
  }

  Index count() const { return static_cast<Index>(first_.size()) - 1; }
  Index begin(Index bucket) const { return first_[bucket]; }
  std::span<Item> items(Index bucket) { return {items_.data() + first_[bucket], items_.data() + first_[bucket + 1]}; }
  int bits_left() const { return shift_; }  ///< those in which the keys of a bucket may differ

 private:
  /// Returns how many bits tell buckets of some hundred items apart.
  static int bits_for(std::size_t count) {
    constexpr int k_most = 12, k_inside = 9;
    return std::clamp(static_cast<int>(std::bit_width(count)) - k_inside, 1, k_most);
  }

  LargeArray<Item> items_;
  std::vector<Index> first_;
  int shift_ = 0;
};

/// Puts the items into the order of `bits` bits of their keys above `shift`; those that agree keep theirs.
template <class Item>
void sort_by_digit(std::span<const Item> from, Item* to, int shift, int bits) {
  constexpr int k_most_bits = 8;
  std::array<Index, 1 << k_most_bits> places{};
  const std::size_t mask = (std::size_t{1} << bits) - 1;
  for (const Item& item : from) ++places[item.key >> shift & mask];
  Index place = 0;
  for (Index& count : places) place += std::exchange(count, place);
  for (const Item& item : from) to[places[item.key >> shift & mask]++] = item;
}

/// Sorts items that are in the order of their indices and differ in the last `bits_left` bits at most.
/// \return where they are: `items` or `spare`.
template <class Item>
std::span<const Item> sort_bucket(std::span<Item> items, std::vector<Item>& spare, int bits_left) {
  constexpr std::size_t k_small = 128;
  constexpr int k_digit = 8, k_digits = 3;
  if (items.size() < k_small) {
    std::ranges::sort(items, std::less());
    return items;
  }
  if (spare.size() < items.size()) spare.resize(items.size());
  std::span<Item> from = items, to(spare.data(), items.size());
  const int last = std::max(0, bits_left - k_digits * k_digit);
  for (int shift = last; shift < bits_left; shift += k_digit) {
    sort_by_digit<Item>(from, to.data(), shift, std::min(k_digit, bits_left - shift));
    std::swap(from, to);
  }
  if (last == 0) return from;
  for (std::size_t i = 0; i < from.size();) {
    std::size_t end = i + 1;
    while (end < from.size() && from[end].key >> last == from[i].key >> last) ++end;
    if (end > i + 1) std::ranges::sort(from.subspan(i, end - i), std::less());
    i = end;
  }
  return from;
}

}  // namespace

template <class Key>
void sort_by_key(std::span<Keyed<Key>> items, int threads, const JobStage& stage) {
  constexpr Index k_at_a_time = 16;
  Buckets<Key> buckets(items, threads, stage);
  std::vector<std::vector<Keyed<Key>>> spare(thread_count(threads));
  parallel_for(buckets.count(), threads, k_at_a_time, [&](Index bucket, int thread) {
    if (bucket % k_at_a_time == 0) stage.check();
    std::ranges::copy(sort_bucket(buckets.items(bucket), spare[thread], buckets.bits_left()),
                      items.begin() + buckets.begin(bucket));
  });
}

template void sort_by_key(std::span<Keyed<std::uint32_t>>, int, const JobStage&);
template void sort_by_key(std::span<Keyed<std::uint64_t>>, int, const JobStage&);

std::vector<Index> order_of(std::span<const std::uint64_t> keys, int threads, const JobStage& stage) {
  LargeArray<Keyed<std::uint64_t>> items(keys.size());
  parallel_for(static_cast<Index>(keys.size()), threads, k_chunk, [&](Index i, int) { items[i] = {keys[i], i}; });
  sort_by_key<std::uint64_t>(items, threads, stage);
  std::vector<Index> order(keys.size());
  parallel_for(static_cast<Index>(keys.size()), threads, k_chunk, [&](Index i, int) { order[i] = items[i].index; });
  return order;
}

}  // namespace saddleback
