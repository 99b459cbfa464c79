// Radix sort: all threads cut the keys into buckets by their first digit, and then each bucket is sorted in the cache
// of the thread that takes it, by a few shorter digits, last digit first. What these leave equal is rare.

#include "mesh/tables/key_order.h"

#include <algorithm>
#include <array>
#include <bit>

#include "saddleback/support/large_array.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

struct Entry {
  std::uint64_t key;
  Index index;
  bool operator<(const Entry& other) const { return key != other.key ? key < other.key : index < other.index; }
};

constexpr int k_bucket_bits = 12;
constexpr Index k_buckets = 1 << k_bucket_bits;
constexpr Index k_chunk = 1 << 14;

/// Entries by their first digit, and otherwise in the order of their indices.
class Buckets {
 public:
  Buckets(std::span<const std::uint64_t> keys, int threads, const JobStage& stage)
      : keys_(keys), entries_(keys.size()), first_(k_buckets + 1) {
    std::uint64_t differing = 0;
    for (const std::uint64_t key : keys) differing |= key ^ keys.front();
    shift_ = std::max(0, static_cast<int>(std::bit_width(differing)) - k_bucket_bits);
    const Index chunks = (count() + k_chunk - 1) / k_chunk;
    std::vector<std::array<Index, k_buckets>> places(chunks);
    parallel_for(chunks, threads, 1, [&](Index chunk, int) {
      stage.check();
      each(chunk, [&](Index i) { ++places[chunk][bucket_of(keys_[i])]; });
    });
    Index place = 0;
    for (Index bucket = 0; bucket < k_buckets; ++bucket) {
      first_[bucket] = place;
      for (auto& counts : places) place += std::exchange(counts[bucket], place);
    }
    first_[k_buckets] = place;
    parallel_for(chunks, threads, 1, [&](Index chunk, int) {
      stage.check();
      each(chunk, [&](Index i) { entries_[places[chunk][bucket_of(keys_[i])]++] = {keys_[i], i}; });
    });
  }

  Index begin(Index bucket) const { return first_[bucket]; }
  std::span<Entry> entries(Index bucket) {
    return {entries_.data() + first_[bucket], entries_.data() + first_[bucket + 1]};
  }
  int bits_left() const { return shift_; }  ///< those in which the keys of a bucket may differ

 private:
  Index count() const { return static_cast<Index>(keys_.size()); }
  std::uint64_t bucket_of(std::uint64_t key) const { return key >> shift_ & (k_buckets - 1); }
  template <class Use>
  void each(Index chunk, Use&& use) const {
    for (Index i = chunk * k_chunk; i < std::min(count(), (chunk + 1) * k_chunk); ++i) use(i);
  }

  std::span<const std::uint64_t> keys_;
  LargeArray<Entry> entries_;
  std::vector<Index> first_;
  int shift_ = 0;
};

/// Puts the entries into the order of `bits` bits of their keys above `shift`; those that agree keep theirs.
void sort_by_digit(std::span<const Entry> from, Entry* to, int shift, int bits) {
  constexpr int k_most_bits = 8;
  std::array<Index, 1 << k_most_bits> places{};
  const std::uint64_t mask = (std::uint64_t{1} << bits) - 1;
  for (const Entry& entry : from) ++places[entry.key >> shift & mask];
  Index place = 0;
  for (Index& count : places) place += std::exchange(count, place);
  for (const Entry& entry : from) to[places[entry.key >> shift & mask]++] = entry;
}

/// Sorts entries that are in the order of their indices and differ in the last `bits_left` bits at most.
/// \return where they are: `entries` or `spare`.
std::span<const Entry> sort_bucket(std::span<Entry> entries, std::vector<Entry>& spare, int bits_left) {
  constexpr std::size_t k_small = 128;
  constexpr int k_digit = 8, k_digits = 3;
  if (entries.size() < k_small) {
    std::ranges::sort(entries, std::less());
    return entries;
  }
  if (spare.size() < entries.size()) spare.resize(entries.size());
  std::span<Entry> from = entries, to(spare.data(), entries.size());
  const int last = std::max(0, bits_left - k_digits * k_digit);
  for (int shift = last; shift < bits_left; shift += k_digit) {
    sort_by_digit(from, to.data(), shift, std::min(k_digit, bits_left - shift));
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

std::vector<Index> order_of(std::span<const std::uint64_t> keys, int threads, const JobStage& stage) {
  constexpr Index k_at_a_time = 16;
  Buckets buckets(keys, threads, stage);
  std::vector<Index> order(keys.size());
  std::vector<std::vector<Entry>> spare(thread_count(threads));
  parallel_for(k_buckets, threads, k_at_a_time, [&](Index bucket, int thread) {
    if (bucket % k_at_a_time == 0) stage.check();
    Index* place = order.data() + buckets.begin(bucket);
    for (const Entry& entry : sort_bucket(buckets.entries(bucket), spare[thread], buckets.bits_left()))
      *place++ = entry.index;
  });
  return order;
}

}  // namespace saddleback
