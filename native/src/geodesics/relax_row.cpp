// An arc costs three integer operations to decode, an addition and a comparison with a distance loaded from memory. Few
// arcs of a row lower anything, and no branch predictor knows which: the comparisons are made for a whole row first.

#include "geodesics/relax_row.h"

#include <algorithm>
#include <bit>

#if defined(__x86_64__) && defined(__GNUC__)
#define SADDLEBACK_X86 1
#include <immintrin.h>
#endif

namespace saddleback {
namespace {

void relax_arc(const ArcCodec& codec, std::uint64_t word, const RowOffer& offer, LoweredNodes& lowered) {
  const Index target = codec.target(word);
  const double distance = offer.distance + codec.length(word), known = offer.distances[target];
  if (distance > known) return;
  if (distance == known && !(offer.labels && offer.label < offer.labels[target])) return;
  offer.distances[target] = distance;
  lowered.nodes[lowered.count] = target;
  lowered.distances[lowered.count++] = distance;
}

void relax_plain(const ArcCodec& codec, const std::uint64_t* words, int count, const RowOffer& offer,
                 LoweredNodes& lowered) {
  lowered.count = 0;
  for (int i = 0; i < count; ++i) relax_arc(codec, words[i], offer, lowered);
}

#ifdef SADDLEBACK_X86

// Both first find which arcs may win, as bits, without a branch; then they take those, one after the other.
constexpr int k_bits = 64;

__attribute__((target("avx512f,avx512vl,avx512dq"))) void relax_avx512(const ArcCodec& codec,
                                                                       const std::uint64_t* words, int count,
                                                                       const RowOffer& offer, LoweredNodes& lowered) {
  const __m512i target_mask = _mm512_set1_epi64(static_cast<long long>(codec.target_mask()));
  const __m512i length_mask = _mm512_set1_epi64(static_cast<long long>(codec.length_mask()));
  const __m512i bias = _mm512_set1_epi64(static_cast<long long>(codec.length_bias()));
  const __m512d start = _mm512_set1_pd(offer.distance);
  lowered.count = 0;
  for (int first = 0; first < count; first += k_bits) {
    std::uint64_t candidates = 0;
    for (int i = first; i < std::min(count, first + k_bits); i += 8) {
      const auto lanes = static_cast<__mmask8>(count - i >= 8 ? 0xFF : (1 << (count - i)) - 1);
      const __m512i word = _mm512_maskz_loadu_epi64(lanes, words + i);
      const __m512i target = _mm512_and_epi64(word, target_mask);
      // Forms with a full mask where g++ 12 warns of the plain ones: they start from a register left undefined.
      const __m512i length = _mm512_add_epi64(
          _mm512_maskz_srli_epi64(0xFF, _mm512_and_epi64(word, length_mask), ArcCodec::k_length_shift), bias);
      const __m512d distance = _mm512_add_pd(start, _mm512_castsi512_pd(length));
      const __m512d known = _mm512_mask_i64gather_pd(start, lanes, target, offer.distances, 8);
      const __mmask8 within = _mm512_mask_cmp_pd_mask(lanes, distance, known, _CMP_LE_OQ);
      candidates |= static_cast<std::uint64_t>(within) << (i - first);
    }
    for (; candidates; candidates &= candidates - 1)
      relax_arc(codec, words[first + std::countr_zero(candidates)], offer, lowered);
  }
}

/// Four loads are quicker than the gather of processors without AVX-512.
__attribute__((target("avx2"))) void relax_avx2(const ArcCodec& codec, const std::uint64_t* words, int count,
                                                const RowOffer& offer, LoweredNodes& lowered) {
  const __m256i length_mask = _mm256_set1_epi64x(static_cast<long long>(codec.length_mask()));
  const __m256i bias = _mm256_set1_epi64x(static_cast<long long>(codec.length_bias()));
  const __m256d start = _mm256_set1_pd(offer.distance);
  const auto known = [&](int arc) { return offer.distances[codec.target(words[arc])]; };
  lowered.count = 0;
  for (int first = 0; first < count; first += k_bits) {
    const int end = std::min(count, first + k_bits);
    std::uint64_t candidates = 0;
    int i = first;
    for (; i + 4 <= end; i += 4) {
      const __m256i word = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(words + i));
      const __m256i length =
          _mm256_add_epi64(_mm256_srli_epi64(_mm256_and_si256(word, length_mask), ArcCodec::k_length_shift), bias);
      const __m256d distance = _mm256_add_pd(start, _mm256_castsi256_pd(length));
      const __m256d within =
          _mm256_cmp_pd(distance, _mm256_set_pd(known(i + 3), known(i + 2), known(i + 1), known(i)), _CMP_LE_OQ);
      candidates |= static_cast<std::uint64_t>(_mm256_movemask_pd(within)) << (i - first);
    }
    for (; i < end; ++i) {
      const bool within = offer.distance + codec.length(words[i]) <= known(i);
      candidates |= static_cast<std::uint64_t>(within) << (i - first);
    }
    for (; candidates; candidates &= candidates - 1)
      relax_arc(codec, words[first + std::countr_zero(candidates)], offer, lowered);
  }
}

#endif

}  // namespace

RelaxRow relax_row_plain() { return &relax_plain; }

RelaxRow relax_row() {
#ifdef SADDLEBACK_X86
  static const RelaxRow best = [] {
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
      return &relax_avx512;
    return __builtin_cpu_supports("avx2") ? &relax_avx2 : relax_row_plain();
  }();
  return best;
#else
  return relax_row_plain();
#endif
}

}  // namespace saddleback
