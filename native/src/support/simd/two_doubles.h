#pragma once
// Two doubles side by side in one register, by the compiler's own vector types where it has them: compilers alone pack
// such pairs only now and then.

#include <cmath>

#include "support/cuda/host_device.h"

namespace saddleback {

#if defined(__GNUC__) && !defined(__CUDACC__)

struct TwoDoubles {
  using Pair [[gnu::vector_size(16)]] = double;
  using Bits [[gnu::vector_size(16)]] = long long;
  Pair pair;

  static TwoDoubles both(double value) { return {Pair{value, value}}; }
  static TwoDoubles of(double first, double second) { return {Pair{first, second}}; }
  /// Reads from two places in a row.
  static TwoDoubles at(const double* place) {
    Pair pair;
    __builtin_memcpy(&pair, place, sizeof pair);
    return {pair};
  }
  double operator[](int k) const { return pair[k]; }
  friend TwoDoubles operator+(TwoDoubles a, TwoDoubles b) { return {a.pair + b.pair}; }
  friend TwoDoubles operator-(TwoDoubles a, TwoDoubles b) { return {a.pair - b.pair}; }
  friend TwoDoubles operator*(TwoDoubles a, TwoDoubles b) { return {a.pair * b.pair}; }
  friend TwoDoubles operator/(TwoDoubles a, TwoDoubles b) { return {a.pair / b.pair}; }
  /// The first ones, and the second ones, of two pairs.
  static TwoDoubles firsts(TwoDoubles a, TwoDoubles b) { return {Pair{a.pair[0], b.pair[0]}}; }
  static TwoDoubles seconds(TwoDoubles a, TwoDoubles b) { return {Pair{a.pair[1], b.pair[1]}}; }
  static TwoDoubles size(TwoDoubles a) { return {(Pair)((Bits)a.pair & ~(Bits)(Pair{-0.0, -0.0}))}; }
  static TwoDoubles root(TwoDoubles a) { return {Pair{std::sqrt(a.pair[0]), std::sqrt(a.pair[1])}}; }
  /// The second of two numbers also where the first is none.
  static TwoDoubles smaller(TwoDoubles a, TwoDoubles b) { return {a.pair < b.pair ? a.pair : b.pair}; }
  static TwoDoubles larger(TwoDoubles a, TwoDoubles b) { return {a.pair > b.pair ? a.pair : b.pair}; }
  static TwoDoubles if_positive(TwoDoubles a, TwoDoubles yes, TwoDoubles no) {
    return {a.pair > 0.0 ? yes.pair : no.pair};
  }
  static bool are_positive(TwoDoubles a) { return a.pair[0] > 0 && a.pair[1] > 0; }
};

#else

struct TwoDoubles {
  double pair[2];

  SADDLEBACK_HOST_DEVICE static TwoDoubles both(double value) { return {{value, value}}; }
  SADDLEBACK_HOST_DEVICE static TwoDoubles of(double first, double second) { return {{first, second}}; }
  SADDLEBACK_HOST_DEVICE static TwoDoubles at(const double* place) { return {{place[0], place[1]}}; }
  SADDLEBACK_HOST_DEVICE double operator[](int k) const { return pair[k]; }
  SADDLEBACK_HOST_DEVICE friend TwoDoubles operator+(TwoDoubles a, TwoDoubles b) {
    return {{a[0] + b[0], a[1] + b[1]}};
  }
  SADDLEBACK_HOST_DEVICE friend TwoDoubles operator-(TwoDoubles a, TwoDoubles b) {
    return {{a[0] - b[0], a[1] - b[1]}};
  }
  SADDLEBACK_HOST_DEVICE friend TwoDoubles operator*(TwoDoubles a, TwoDoubles b) {
    return {{a[0] * b[0], a[1] * b[1]}};
  }
  SADDLEBACK_HOST_DEVICE friend TwoDoubles operator/(TwoDoubles a, TwoDoubles b) {
    return {{a[0] / b[0], a[1] / b[1]}};
  }
  SADDLEBACK_HOST_DEVICE static TwoDoubles firsts(TwoDoubles a, TwoDoubles b) { return {{a[0], b[0]}}; }
  SADDLEBACK_HOST_DEVICE static TwoDoubles seconds(TwoDoubles a, TwoDoubles b) { return {{a[1], b[1]}}; }
  SADDLEBACK_HOST_DEVICE static TwoDoubles size(TwoDoubles a) { return {{fabs(a[0]), fabs(a[1])}}; }
  SADDLEBACK_HOST_DEVICE static TwoDoubles root(TwoDoubles a) { return {{sqrt(a[0]), sqrt(a[1])}}; }
  SADDLEBACK_HOST_DEVICE static TwoDoubles smaller(TwoDoubles a, TwoDoubles b) {
    return {{a[0] < b[0] ? a[0] : b[0], a[1] < b[1] ? a[1] : b[1]}};
  }
  SADDLEBACK_HOST_DEVICE static TwoDoubles larger(TwoDoubles a, TwoDoubles b) {
    return {{a[0] > b[0] ? a[0] : b[0], a[1] > b[1] ? a[1] : b[1]}};
  }
  SADDLEBACK_HOST_DEVICE static TwoDoubles if_positive(TwoDoubles a, TwoDoubles yes, TwoDoubles no) {
    return {{a[0] > 0 ? yes[0] : no[0], a[1] > 0 ? yes[1] : no[1]}};
  }
  SADDLEBACK_HOST_DEVICE static bool are_positive(TwoDoubles a) { return a[0] > 0 && a[1] > 0; }
};

#endif

}  // namespace saddleback
