#pragma once
// Sixteen lanes of AVX-512 (F, DQ).

#include <immintrin.h>

#include "support/simd/simd_vectors.h"

namespace saddleback {
namespace {

struct Simd : Vectors<16> {
  static constexpr const char* name = "avx512";

  static bool any(Mask mask) { return bits(mask) != 0; }
  /// Tells which of `width` words from here on hold a number in the bits of a mask, a bit each.
  static unsigned matches(const std::uint64_t* words, std::uint64_t mask, std::uint64_t number) {
    const auto eight = [&](const std::uint64_t* from) {
      const __m512i bits = _mm512_set1_epi64(static_cast<std::int64_t>(mask));
      const __m512i wanted = _mm512_set1_epi64(static_cast<std::int64_t>(number));
      return static_cast<unsigned>(_mm512_cmpeq_epi64_mask(_mm512_and_si512(_mm512_loadu_si512(from), bits), wanted));
    };
    return eight(words) | eight(words + 8) << 8;
  }
  static Floats sqrt(Floats a) { return _mm512_sqrt_ps(a); }
  static Floats narrow(Doubles a) {
    return _mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(a.low)), _mm512_cvtpd_ps(a.high), 1);
  }
  /// The values at table[index[0]], table[index[1]] and so on.
  static Floats look_up(const std::int32_t* table, const std::int32_t* index) {
    return _mm512_i32gather_ps(_mm512_loadu_si512(index), table, 4);
  }
  /// The values at table[index].
  static Floats look_up(const float* table, Ints index) {
    return _mm512_i32gather_ps(reinterpret_cast<__m512i>(index), table, 4);
  }
  static Doubles look_up(const double* table, Ints index) {
    const auto indices = reinterpret_cast<__m512i>(index);
    return {_mm512_i32gather_pd(_mm512_castsi512_si256(indices), table, 8),
            _mm512_i32gather_pd(_mm512_extracti32x8_epi32(indices, 1), table, 8)};
  }
  static Doubles sqrt(Doubles a) { return {_mm512_sqrt_pd(a.low), _mm512_sqrt_pd(a.high)}; }
  /// The values at table[edge % 8].
  static Floats look_up_lane(const float* table, Ints edge) {
    const __m512i lane = _mm512_and_si512(reinterpret_cast<__m512i>(edge), _mm512_set1_epi32(7));
    return _mm512_permutexvar_ps(lane, _mm512_castps256_ps512(_mm256_loadu_ps(table)));
  }
  /// Writes the lanes of a mask one after the other; entries behind them are spoilt, up to a vector's width. Packed in
  /// the register: packing into memory is slow on some machines.
  struct Packing {
    __mmask16 mask;
    int kept, kept_low;
    int count() const { return kept; }
    void store(float* to, Floats values) const { _mm512_storeu_ps(to, _mm512_maskz_compress_ps(mask, values)); }
    void store(std::int32_t* to, Ints values) const {
      _mm512_storeu_si512(to, _mm512_maskz_compress_epi32(mask, reinterpret_cast<__m512i>(values)));
    }
    void store(double* to, Doubles values) const {
      _mm512_storeu_pd(to, _mm512_maskz_compress_pd(static_cast<__mmask8>(mask), values.low));
      _mm512_storeu_pd(to + kept_low, _mm512_maskz_compress_pd(static_cast<__mmask8>(mask >> 8), values.high));
    }
  };
  static Packing packing(Mask mask) {
    const __mmask16 lanes = bits(mask);
    return {lanes, __builtin_popcount(lanes), __builtin_popcount(lanes & 255)};
  }
  /// Each record as two registers' quarters, transposed: fewer instructions than gathers.
  template <class Record>
  static void load_records(const Record* records, const std::int32_t* edges, Doubles& a, Doubles& b, Ints& left,
                           Ints& right, Ints& apex, Ints& clearances) {
    const auto four = [&](int p, int q, int r, int s, int part) {
      const auto quarter = [&](int lane) {
        const char* const record = reinterpret_cast<const char*>(records + (edges[lane] >> 3));
        return _mm_load_si128(reinterpret_cast<const __m128i*>(record + 16 * part));
      };
      const __m512i low = _mm512_inserti32x4(_mm512_castsi128_si512(quarter(p)), quarter(q), 1);
      return _mm512_inserti32x4(_mm512_inserti32x4(low, quarter(r), 2), quarter(s), 3);
    };
    const auto doubles = [](__m512i values) { return _mm512_castsi512_pd(values); };
    const __m512d even = doubles(four(0, 2, 4, 6, 0)), odd = doubles(four(1, 3, 5, 7, 0));
    const __m512d high_even = doubles(four(8, 10, 12, 14, 0)), high_odd = doubles(four(9, 11, 13, 15, 0));
    a = {_mm512_unpacklo_pd(even, odd), _mm512_unpacklo_pd(high_even, high_odd)};
    b = {_mm512_unpackhi_pd(even, odd), _mm512_unpackhi_pd(high_even, high_odd)};
    const __m512i p = four(0, 4, 8, 12, 1), q = four(1, 5, 9, 13, 1), r = four(2, 6, 10, 14, 1),
                  s = four(3, 7, 11, 15, 1);
    const __m512i pq = _mm512_unpacklo_epi32(p, q), rs = _mm512_unpacklo_epi32(r, s);
    left = reinterpret_cast<Ints>(_mm512_unpacklo_epi64(pq, rs));
    right = reinterpret_cast<Ints>(_mm512_unpackhi_epi64(pq, rs));
    const __m512i high_pq = _mm512_unpackhi_epi32(p, q), high_rs = _mm512_unpackhi_epi32(r, s);
    apex = reinterpret_cast<Ints>(_mm512_unpacklo_epi64(high_pq, high_rs));
    clearances = reinterpret_cast<Ints>(_mm512_unpackhi_epi64(high_pq, high_rs));
  }

 private:
  static __mmask16 bits(Mask mask) { return _mm512_movepi32_mask(reinterpret_cast<__m512i>(mask)); }
};

}  // namespace
}  // namespace saddleback
