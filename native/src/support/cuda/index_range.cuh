#pragma once
// A part of an array: the numbers from `begin` on, before `end`.

#include <cstdint>

namespace saddleback {

struct IndexRange {
  std::int32_t begin, end;
  __host__ __device__ std::int32_t count() const { return end - begin; }
  __host__ __device__ bool holds(std::int32_t number) const { return begin <= number && number < end; }
};

}  // namespace saddleback
