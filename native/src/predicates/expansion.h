#pragma once
// Exact sums and products of doubles: an expansion is a sum of doubles that do not overlap, the largest last. After
// [shewchuk1997]. No allocation; plain functions, so that device code can use them as well. Exact unless a product
// over- or underflows.

#include <bit>
#include <cmath>
#include <cstdint>

#include "support/cuda/host_device.h"

namespace saddleback::predicates {

// Device compilers may fuse a product into a sum, which would void the error terms; these never are.
SADDLEBACK_HOST_DEVICE inline double plus(double a, double b) {
#ifdef __CUDA_ARCH__
  return __dadd_rn(a, b);
#else
  return a + b;
#endif
}
SADDLEBACK_HOST_DEVICE inline double times(double a, double b) {
#ifdef __CUDA_ARCH__
  return __dmul_rn(a, b);
#else
  return a * b;
#endif
}

/// a + b = sum + rest, exactly.
SADDLEBACK_HOST_DEVICE inline void two_sum(double a, double b, double& sum, double& rest) {
  sum = plus(a, b);
  const double b_part = plus(sum, -a), a_part = plus(sum, -b_part);
  rest = plus(plus(a, -a_part), plus(b, -b_part));
}

#if defined(_WIN32) && !defined(__CUDA_ARCH__)
/// Returns a to 26 digits; so many are enough for the rest of it, which may be negative.
inline double upper_half(double a) {
  constexpr std::uint64_t k_half_digit = 1ull << 26;
  return std::bit_cast<double>((std::bit_cast<std::uint64_t>(a) + k_half_digit) & ~(2 * k_half_digit - 1));
}
#endif

/// a * b = product + rest, exactly.
SADDLEBACK_HOST_DEVICE inline void two_product(double a, double b, double& product, double& rest) {
  product = times(a, b);
#if defined(_WIN32) && !defined(__CUDA_ARCH__)
  // The fma of MinGW-w64 counts on 64 digits of long double, of which Windows leaves 53: in halves, as in
  // [shewchuk1997].
  const double a_high = upper_half(a), a_low = a - a_high, b_high = upper_half(b), b_low = b - b_high;
  rest = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
#else
  rest = fma(a, b, -product);
#endif
}

// SADDLEBACK_RARE: in line, nvcc 13.0 leaves out stores to small arrays whose places are counted, and decisions come
// out wrong (tests/parity/test_signs_cuda.py).

template <int N>
struct Expansion {
  double terms[N];
  int size = 0;

  SADDLEBACK_HOST_DEVICE void push(double term) {
    if (term != 0) terms[size++] = term;
  }
  /// The sign of the whole is that of its largest term.
  SADDLEBACK_HOST_DEVICE int sign() const { return size == 0 ? 0 : terms[size - 1] > 0 ? 1 : -1; }
};

/// a - b.
SADDLEBACK_RARE inline Expansion<2> difference(double a, double b) {
  double sum, rest;
  two_sum(a, -b, sum, rest);
  const bool has_rest = rest != 0;
  return {{has_rest ? rest : sum, sum}, has_rest ? 2 : sum != 0 ? 1 : 0};
}

/// Returns a + factor * b for a factor of 1 or -1: the terms of both in the order of size, summed up (fast expansion
/// sum [shewchuk1997]).
template <int A, int B>
SADDLEBACK_RARE Expansion<A + B> sum(const Expansion<A>& a, const Expansion<B>& b, double factor = 1) {
  Expansion<A + B> result;
  double total = 0;
  int i = 0, j = 0;
  while (i < a.size || j < b.size) {
    const bool from_a = j == b.size || (i < a.size && fabs(a.terms[i]) < fabs(b.terms[j]));
    const double next = from_a ? a.terms[i++] : factor * b.terms[j++];
    double rest;
    two_sum(total, next, total, rest);
    result.push(rest);
  }
  result.push(total);
  return result;
}

/// a * factor.
template <int A>
SADDLEBACK_RARE Expansion<2 * A> scaled(const Expansion<A>& a, double factor) {
  Expansion<2 * A> result;
  double total = 0;
  for (int i = 0; i < a.size; ++i) {
    double product, product_rest, rest;
    two_product(a.terms[i], factor, product, product_rest);
    two_sum(total, product_rest, total, rest);
    result.push(rest);
    two_sum(product, total, total, rest);
    result.push(rest);
  }
  result.push(total);
  return result;
}

template <int A, int B>
SADDLEBACK_RARE Expansion<2 * A * B> product(const Expansion<A>& a, const Expansion<B>& b) {
  Expansion<2 * A * B> result;
  for (int j = 0; j < b.size; ++j) {
    const auto longer = sum(result, scaled(a, b.terms[j]));
    result.size = 0;  // zeros are left out, so the sum of all parts fits
    for (int i = 0; i < longer.size; ++i) result.push(longer.terms[i]);
  }
  return result;
}

}  // namespace saddleback::predicates
