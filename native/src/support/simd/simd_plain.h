#pragma once
// Four lanes in plain C++: SSE2 on any x86-64 and NEON on ARM, by the compiler.

#include "support/simd/simd_vectors.h"

namespace saddleback {
namespace {

struct Simd : Vectors<4> {
#if defined(__aarch64__)
  static constexpr const char* name = "neon";
#else
  static constexpr const char* name = "plain";
#endif

  static bool any(Mask mask) { return (mask[0] | mask[1] | mask[2] | mask[3]) != 0; }
  /// Tells which of `width` words from here on hold a number in the bits of a mask, a bit each.
  static unsigned matches(const std::uint64_t* words, std::uint64_t mask, std::uint64_t number) {
    unsigned here = 0;
    for (unsigned i = 0; i < 4; ++i) here |= static_cast<unsigned>((words[i] & mask) == number) << i;
    return here;
  }
  static Floats sqrt(Floats a) {
    return Floats{__builtin_sqrtf(a[0]), __builtin_sqrtf(a[1]), __builtin_sqrtf(a[2]), __builtin_sqrtf(a[3])};
  }
  static Floats narrow(Doubles a) {
    return Floats{static_cast<float>(a.low[0]), static_cast<float>(a.low[1]), static_cast<float>(a.high[0]),
                  static_cast<float>(a.high[1])};
  }
  /// The values at table[index[0]], table[index[1]] and so on.
  static Floats look_up(const std::int32_t* table, const std::int32_t* index) {
    return floats_of(Ints{table[index[0]], table[index[1]], table[index[2]], table[index[3]]});
  }
  /// The values at table[index].
  static Floats look_up(const float* table, Ints index) {
    return Floats{table[index[0]], table[index[1]], table[index[2]], table[index[3]]};
  }
  static Doubles look_up(const double* table, Ints index) {
    return {Half{table[index[0]], table[index[1]]}, Half{table[index[2]], table[index[3]]}};
  }
  static Doubles sqrt(Doubles a) {
    return {Half{__builtin_sqrt(a.low[0]), __builtin_sqrt(a.low[1])},
            Half{__builtin_sqrt(a.high[0]), __builtin_sqrt(a.high[1])}};
  }
  /// The values at table[edge % 8].
  static Floats look_up_lane(const float* table, Ints edge) {
    return Floats{table[edge[0] & 7], table[edge[1] & 7], table[edge[2] & 7], table[edge[3] & 7]};
  }
  /// Writes the lanes of a mask one after the other; entries behind them are spoilt, up to a vector's width.
  struct Packing {
    int lanes[4], kept;
    int count() const { return kept; }
    template <class Number, class Vector>
    void store(Number* to, Vector values) const {
      for (int i = 0; i < kept; ++i) to[i] = values[lanes[i]];
    }
    void store(double* to, Doubles values) const {
      for (int i = 0; i < kept; ++i) to[i] = lanes[i] < 2 ? values.low[lanes[i]] : values.high[lanes[i] - 2];
    }
  };
  static Packing packing(Mask mask) {
    Packing result{{0, 0, 0, 0}, 0};
    for (int i = 0; i < 4; ++i) {
      result.lanes[result.kept] = i;
      result.kept += mask[i] & 1;
      if (result.kept == 4) break;
    }
    return result;
  }
  template <class Record>
  static void load_records(const Record* records, const std::int32_t* edges, Doubles& a, Doubles& b, Ints& left,
                           Ints& right, Ints& apex, Ints& clearances) {
    const Record &p = records[edges[0] >> 3], &q = records[edges[1] >> 3], &r = records[edges[2] >> 3],
                 &s = records[edges[3] >> 3];
    a = {Half{p.a, q.a}, Half{r.a, s.a}};
    b = {Half{p.b, q.b}, Half{r.b, s.b}};
    left = Ints{p.left, q.left, r.left, s.left};
    right = Ints{p.right, q.right, r.right, s.right};
    apex = Ints{p.apex, q.apex, r.apex, s.apex};
    const auto bits = [](const Record& record) { return static_cast<std::int32_t>(record.clearances); };
    clearances = Ints{bits(p), bits(q), bits(r), bits(s)};
  }
};

}  // namespace
}  // namespace saddleback
