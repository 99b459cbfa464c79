#pragma once
// Eight lanes of AVX2.

#include <immintrin.h>

#include "support/simd/simd_vectors.h"

namespace saddleback {
namespace {

/// Holds, for every mask of 8 lanes, the lanes it holds one after the other, then the first of them again: what is
/// written behind the end will be read, too, and must be no worse than what is kept.
struct PackingTable {
  alignas(64) std::int32_t lanes[256][8];
  constexpr PackingTable() : lanes{} {
    for (int mask = 0; mask < 256; ++mask) {
      int kept = 0;
      for (int lane = 0; lane < 8; ++lane)
        if (mask >> lane & 1) lanes[mask][kept++] = lane;
      for (; kept < 8; ++kept) lanes[mask][kept] = lanes[mask][0];
    }
  }
};
constexpr PackingTable k_packing;

/// Holds the same for 4 lanes of 64 bits, as pairs of 32.
struct PairPackingTable {
  alignas(64) std::int32_t lanes[16][8];
  constexpr PairPackingTable() : lanes{} {
    for (int mask = 0; mask < 16; ++mask) {
      int kept = 0;
      for (int lane = 0; lane < 4; ++lane) {
        if (mask >> lane & 1) {
          lanes[mask][2 * kept] = 2 * lane;
          lanes[mask][2 * kept + 1] = 2 * lane + 1;
          ++kept;
        }
      }
    }
  }
};
constexpr PairPackingTable k_pair_packing;

struct Simd : Vectors<8> {
  static constexpr const char* name = "avx2";

  static bool any(Mask mask) { return _mm256_movemask_ps(reinterpret_cast<__m256>(mask)) != 0; }
  /// Tells which of `width` words from here on hold a number in the bits of a mask, a bit each.
  static unsigned matches(const std::uint64_t* words, std::uint64_t mask, std::uint64_t number) {
    const auto four = [&](const std::uint64_t* from) {
      const __m256i bits = _mm256_set1_epi64x(static_cast<std::int64_t>(mask));
      const __m256i wanted = _mm256_set1_epi64x(static_cast<std::int64_t>(number));
      const __m256i read = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
      return static_cast<unsigned>(
          _mm256_movemask_pd(reinterpret_cast<__m256d>(_mm256_cmpeq_epi64(_mm256_and_si256(read, bits), wanted))));
    };
    return four(words) | four(words + 4) << 4;
  }
  static Floats min(Floats a, Floats b) { return _mm256_min_ps(a, b); }
  static Floats max(Floats a, Floats b) { return _mm256_max_ps(a, b); }
  static Floats pick(Mask mask, Floats yes, Floats no) {
    return _mm256_blendv_ps(no, yes, reinterpret_cast<__m256>(mask));
  }
  static Ints pick(Mask mask, Ints yes, Ints no) {
    return reinterpret_cast<Ints>(_mm256_blendv_epi8(reinterpret_cast<__m256i>(no), reinterpret_cast<__m256i>(yes),
                                                     reinterpret_cast<__m256i>(mask)));
  }
  static Floats sqrt(Floats a) { return _mm256_sqrt_ps(a); }
  static Floats narrow(Doubles a) { return _mm256_set_m128(_mm256_cvtpd_ps(a.high), _mm256_cvtpd_ps(a.low)); }
  /// The values at table[index[0]], table[index[1]] and so on; one by one, which is quicker than a gather.
  static Floats look_up(const std::int32_t* table, const std::int32_t* index) {
    return floats_of(Ints{table[index[0]], table[index[1]], table[index[2]], table[index[3]], table[index[4]],
                          table[index[5]], table[index[6]], table[index[7]]});
  }
  /// The values at table[index].
  static Floats look_up(const float* table, Ints index) {
    return _mm256_i32gather_ps(table, reinterpret_cast<__m256i>(index), 4);
  }
  static Doubles look_up(const double* table, Ints index) {
    const auto indices = reinterpret_cast<__m256i>(index);
    return {_mm256_i32gather_pd(table, _mm256_castsi256_si128(indices), 8),
            _mm256_i32gather_pd(table, _mm256_extracti128_si256(indices, 1), 8)};
  }
  static Doubles sqrt(Doubles a) { return {_mm256_sqrt_pd(a.low), _mm256_sqrt_pd(a.high)}; }
  /// The values at table[edge % 8].
  static Floats look_up_lane(const float* table, Ints edge) {
    return _mm256_permutevar8x32_ps(_mm256_loadu_ps(table), reinterpret_cast<__m256i>(edge));
  }
  /// Writes the lanes of a mask one after the other; entries behind them are spoilt, up to a vector's width.
  struct Packing {
    int mask, kept, kept_low;
    int count() const { return kept; }
    void store(float* to, Floats values) const { _mm256_storeu_ps(to, _mm256_permutevar8x32_ps(values, order())); }
    void store(std::int32_t* to, Ints values) const {
      const __m256i packed = _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(values), order());
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), packed);
    }
    void store(double* to, Doubles values) const {
      store_half(to, values.low, mask & 15);
      store_half(to + kept_low, values.high, mask >> 4);
    }

   private:
    __m256i order() const { return _mm256_load_si256(reinterpret_cast<const __m256i*>(k_packing.lanes[mask])); }
    static void store_half(double* to, Half values, int half_mask) {
      const __m256i pairs = _mm256_load_si256(reinterpret_cast<const __m256i*>(k_pair_packing.lanes[half_mask]));
      const __m256 packed = _mm256_permutevar8x32_ps(reinterpret_cast<__m256>(values), pairs);
      _mm256_storeu_ps(reinterpret_cast<float*>(to), packed);
    }
  };
  static Packing packing(Mask mask) {
    const int bits = _mm256_movemask_ps(reinterpret_cast<__m256>(mask));
    return {bits, __builtin_popcount(static_cast<unsigned>(bits)),
            __builtin_popcount(static_cast<unsigned>(bits & 15))};
  }
  /// Each record as two registers' quarters, transposed: fewer instructions than gathers.
  template <class Record>
  static void load_records(const Record* records, const std::int32_t* edges, Doubles& a, Doubles& b, Ints& left,
                           Ints& right, Ints& apex, Ints& clearances) {
    const auto quarter = [&](int lane, int part) {
      const char* const record = reinterpret_cast<const char*>(records + (edges[lane] >> 3));
      return _mm_load_ps(reinterpret_cast<const float*>(record + 16 * part));
    };
    const auto pair = [&](int low, int high, int part) {
      return _mm256_insertf128_ps(_mm256_castps128_ps256(quarter(low, part)), quarter(high, part), 1);
    };
    const auto doubles = [](__m256 values) { return reinterpret_cast<__m256d>(values); };
    const __m256d even = doubles(pair(0, 2, 0)), odd = doubles(pair(1, 3, 0));
    const __m256d high_even = doubles(pair(4, 6, 0)), high_odd = doubles(pair(5, 7, 0));
    a = {_mm256_unpacklo_pd(even, odd), _mm256_unpacklo_pd(high_even, high_odd)};
    b = {_mm256_unpackhi_pd(even, odd), _mm256_unpackhi_pd(high_even, high_odd)};
    const __m256 p = pair(0, 4, 1), q = pair(1, 5, 1), r = pair(2, 6, 1), s = pair(3, 7, 1);
    const __m256d pq = doubles(_mm256_unpacklo_ps(p, q)), rs = doubles(_mm256_unpacklo_ps(r, s));
    left = reinterpret_cast<Ints>(_mm256_unpacklo_pd(pq, rs));
    right = reinterpret_cast<Ints>(_mm256_unpackhi_pd(pq, rs));
    const __m256d high_pq = doubles(_mm256_unpackhi_ps(p, q)), high_rs = doubles(_mm256_unpackhi_ps(r, s));
    apex = reinterpret_cast<Ints>(_mm256_unpacklo_pd(high_pq, high_rs));
    clearances = reinterpret_cast<Ints>(_mm256_unpackhi_pd(high_pq, high_rs));
  }
};

}  // namespace
}  // namespace saddleback
