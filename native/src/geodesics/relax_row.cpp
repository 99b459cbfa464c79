// An arc costs three integer operations to decode, an addition and a comparison with a distance gathered from memory;
// few arcs of a row lower anything, and only those are stored, compressed.

#include "geodesics/relax_row.h"

#include <bit>

#if defined(__x86_64__) && defined(__GNUC__)
#define SADDLEBACK_X86 1
#include <immintrin.h>
#endif

namespace saddleback {
namespace {

void take(LoweredNodes& lowered, Index node, double distance) {
  lowered.nodes[lowered.count] = node;
  lowered.distances[lowered.count++] = distance;
}

void relax_plain(const ArcCodec& codec, const std::uint64_t* words, int count, const RowOffer& offer,
                 LoweredNodes& lowered) {
  for (int i = 0; i < count; ++i) {
    const Index target = codec.target(words[i]);
    const double distance = offer.distance + codec.length(words[i]), known = offer.distances[target];
    if (distance > known) continue;
    if (distance == known && !(offer.labels && offer.label < offer.labels[target])) continue;
    offer.distances[target] = distance;
    take(lowered, target, distance);
  }
}

#ifdef SADDLEBACK_X86

__attribute__((target("avx512f,avx512vl,avx512dq"))) void relax_avx512(const ArcCodec& codec,
                                                                       const std::uint64_t* words, int count,
                                                                       const RowOffer& offer, LoweredNodes& lowered) {
  const __m512i target_mask = _mm512_set1_epi64(static_cast<long long>(codec.target_mask()));
  const __m512i length_mask = _mm512_set1_epi64(static_cast<long long>(codec.length_mask()));
  const __m512i bias = _mm512_set1_epi64(static_cast<long long>(codec.length_bias()));
  const __m512d start = _mm512_set1_pd(offer.distance);
  const __m256i label = _mm256_set1_epi32(offer.label);
  int taken = 0;
  for (int i = 0; i < count; i += 8) {
    const auto lanes = static_cast<__mmask8>(count - i >= 8 ? 0xFF : (1 << (count - i)) - 1);
    const __m512i word = _mm512_maskz_loadu_epi64(lanes, words + i);
    const __m512i target = _mm512_and_epi64(word, target_mask);
    // Forms with a full mask where g++ 12 warns of the plain ones: they start from a register left undefined.
    const __m512i length = _mm512_add_epi64(
        _mm512_maskz_srli_epi64(0xFF, _mm512_and_epi64(word, length_mask), ArcCodec::k_length_shift), bias);
    const __m512d distance = _mm512_add_pd(start, _mm512_castsi512_pd(length));
    const __m512d known = _mm512_mask_i64gather_pd(start, lanes, target, offer.distances, 8);
    __mmask8 wins = _mm512_mask_cmp_pd_mask(lanes, distance, known, _CMP_LT_OQ);
    if (offer.labels) {
      const __mmask8 ties = _mm512_mask_cmp_pd_mask(lanes, distance, known, _CMP_EQ_OQ);
      if (ties) {
        const __m256i others = _mm512_mask_i64gather_epi32(label, ties, target, offer.labels, 4);
        wins = static_cast<__mmask8>(wins | _mm256_mask_cmplt_epi32_mask(ties, label, others));
      }
    }
    if (!wins) continue;
    _mm512_mask_i64scatter_pd(offer.distances, wins, target, distance, 8);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(lowered.nodes + taken),
                        _mm512_maskz_cvtepi64_epi32(0xFF, _mm512_maskz_compress_epi64(wins, target)));
    _mm512_storeu_pd(lowered.distances + taken, _mm512_maskz_compress_pd(wins, distance));
    taken += std::popcount(static_cast<unsigned>(wins));
  }
  lowered.count = taken;
}

__attribute__((target("avx2"))) void relax_avx2(const ArcCodec& codec, const std::uint64_t* words, int count,
                                                const RowOffer& offer, LoweredNodes& lowered) {
  const __m256i target_mask = _mm256_set1_epi64x(static_cast<long long>(codec.target_mask()));
  const __m256i length_mask = _mm256_set1_epi64x(static_cast<long long>(codec.length_mask()));
  const __m256i bias = _mm256_set1_epi64x(static_cast<long long>(codec.length_bias()));
  const __m256d start = _mm256_set1_pd(offer.distance);
  lowered.count = 0;
  alignas(32) double distances[4];
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    const __m256i word = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(words + i));
    const __m256i target = _mm256_and_si256(word, target_mask);
    const __m256i length =
        _mm256_add_epi64(_mm256_srli_epi64(_mm256_and_si256(word, length_mask), ArcCodec::k_length_shift), bias);
    const __m256d distance = _mm256_add_pd(start, _mm256_castsi256_pd(length));
    const __m256d known = _mm256_i64gather_pd(offer.distances, target, 8);
    const __m256d within = _mm256_cmp_pd(distance, known, _CMP_LE_OQ);
    auto candidates = static_cast<unsigned>(_mm256_movemask_pd(within));
    if (!candidates) continue;
    _mm256_store_pd(distances, distance);
    for (; candidates; candidates &= candidates - 1) {
      const int lane = std::countr_zero(candidates);
      const Index node = codec.target(words[i + lane]);
      if (distances[lane] == offer.distances[node] && !(offer.labels && offer.label < offer.labels[node])) continue;
      offer.distances[node] = distances[lane];
      take(lowered, node, distances[lane]);
    }
  }
  relax_plain(codec, words + i, count - i, offer, lowered);
}

#endif

}  // namespace

RelaxRow relax_row_plain() {
  return
      [](const ArcCodec& codec, const std::uint64_t* words, int count, const RowOffer& offer, LoweredNodes& lowered) {
        lowered.count = 0;
        relax_plain(codec, words, count, offer, lowered);
      };
}

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
