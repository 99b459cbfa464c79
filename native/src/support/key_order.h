#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/types.h"

namespace saddleback {

template <class Key>
struct Keyed {
  Key key;
  Index index;
  bool operator<(const Keyed& other) const { return key != other.key ? key < other.key : index < other.index; }
};

/// Sorts items, which come by ascending index, by key, then by index. `Key`: 32 or 64 bits without a sign. \throw
/// Cancelled. O(n), unless many keys agree in their first three dozen bits that differ at all.
template <class Key>
void sort_by_key(std::span<Keyed<Key>> items, int threads, const JobStage& stage);

/// The indices 0 to n-1 in ascending order of key, then of index, found in the same way.
std::vector<Index> order_of(std::span<const std::uint64_t> keys, int threads = 1, const JobStage& stage = {});

}  // namespace saddleback
