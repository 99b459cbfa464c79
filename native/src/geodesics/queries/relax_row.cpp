// An arc costs three integer operations to decode, an addition and a comparison with a distance loaded from memory. Few
// arcs of a row lower anything, and no branch predictor knows which: all comparisons of a block come first, as bits,
// and then what they let through.

#include "geodesics/queries/relax_row.h"

#include <algorithm>
#include <bit>

#if defined(__x86_64__) && defined(__GNUC__)
#define SADDLEBACK_X86 1
#include <immintrin.h>
#endif

namespace saddleback {
namespace {

constexpr int k_block = 64;

/// Tells for each of the first `count` <= k_block words of a row: bit i tells whether distance + length is no more than
/// what the target has in `distances`.
using FindCandidates = std::uint64_t (*)(const ArcCodec& codec, const std::uint64_t* words, int count, double distance,
                                         const double* distances);

std::uint64_t candidates_portable(const ArcCodec& codec, const std::uint64_t* words, int count, double distance,
                                  const double* distances) {
  std::uint64_t candidates = 0;
  for (int i = 0; i < count; ++i) {
    const bool is_candidate = distance + codec.length(words[i]) <= distances[codec.target(words[i])];
    candidates |= static_cast<std::uint64_t>(is_candidate) << i;
  }
  return candidates;
}

#ifdef SADDLEBACK_X86

/// Four loads are as quick as one gather with AVX-512, and quicker than a gather without.
__attribute__((target("avx2"))) std::uint64_t candidates_avx2(const ArcCodec& codec, const std::uint64_t* words,
                                                              int count, double distance, const double* distances) {
  const __m256i length_mask = _mm256_set1_epi64x(static_cast<long long>(codec.length_mask()));
  const __m256i bias = _mm256_set1_epi64x(static_cast<long long>(codec.length_bias()));
  const __m256d start = _mm256_set1_pd(distance);
  const auto known = [&](int arc) { return distances[codec.target(words[arc])]; };
  std::uint64_t candidates = 0;
  int i = 0;
  for (; i + 4 <= count; i += 4) {
    const __m256i word = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(words + i));
    const __m256i length =
        _mm256_add_epi64(_mm256_srli_epi64(_mm256_and_si256(word, length_mask), ArcCodec::k_length_shift), bias);
    const __m256d offered = _mm256_add_pd(start, _mm256_castsi256_pd(length));
    const __m256d targets = _mm256_set_pd(known(i + 3), known(i + 2), known(i + 1), known(i));
    const int bits = _mm256_movemask_pd(_mm256_cmp_pd(offered, targets, _CMP_LE_OQ));
    candidates |= static_cast<std::uint64_t>(bits) << i;
  }
  return i < count ? candidates | candidates_portable(codec, words + i, count - i, distance, distances) << i
                   : candidates;
}

#endif

void take(const ArcCodec& codec, std::uint64_t word, const RowOffer& offer, LoweredNodes& lowered) {
  const Index target = codec.target(word);
  const double distance = offer.distance + codec.length(word), known = offer.distances[target];
  if (distance == known && !(offer.labels && offer.label < offer.labels[target])) return;
  offer.distances[target] = distance;
  lowered.nodes[lowered.count] = target;
  lowered.before[lowered.count] = known;
  lowered.distances[lowered.count++] = distance;
}

template <FindCandidates Find>
void relax(const ArcCodec& codec, const std::uint64_t* words, int count, const RowOffer& offer, LoweredNodes& lowered) {
  lowered.count = 0;
  for (int first = 0; first < count; first += k_block) {
    std::uint64_t candidates =
        Find(codec, words + first, std::min(count - first, k_block), offer.distance, offer.distances);
    for (; candidates; candidates &= candidates - 1)
      take(codec, words[first + std::countr_zero(candidates)], offer, lowered);
  }
}

}  // namespace

RelaxRow relax_row_portable() { return &relax<candidates_portable>; }

RelaxRow relax_row() {
#ifdef SADDLEBACK_X86
  static const RelaxRow best = [] {
    __builtin_cpu_init();
    return __builtin_cpu_supports("avx2") ? &relax<candidates_avx2> : relax_row_portable();
  }();
  return best;
#else
  return relax_row_portable();
#endif
}

}  // namespace saddleback
