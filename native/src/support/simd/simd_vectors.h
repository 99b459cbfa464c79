#pragma once
// Vectors of a given width by the compiler's own vector types: what is the same on every instruction set.
//
// Everything here and in simd_*.h has internal linkage: sources compiled for different machines include it, and the
// linker must not take one's functions for another's.

#include <cstdint>

namespace saddleback {
namespace {

constexpr std::int32_t k_lane_numbers[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};

template <int Width>
struct Vectors {
  static constexpr int width = Width;
  using Floats [[gnu::vector_size(4 * Width)]] = float;
  using Ints [[gnu::vector_size(4 * Width)]] = std::int32_t;
  using Mask = Ints;                                    ///< all bits of a lane, or none
  using Half [[gnu::vector_size(4 * Width)]] = double;  ///< half as many lanes
  using Indices [[gnu::vector_size(4 * Width)]] = std::int64_t;

  struct Doubles {
    Half low, high;
    friend Doubles operator+(Doubles a, Doubles b) { return {a.low + b.low, a.high + b.high}; }
    friend Doubles operator-(Doubles a, Doubles b) { return {a.low - b.low, a.high - b.high}; }
    friend Doubles operator*(Doubles a, Doubles b) { return {a.low * b.low, a.high * b.high}; }
  };

  static Floats fill(float value) { return value - Floats{}; }
  static Ints fill_int(std::int32_t value) { return value - Ints{}; }
  static Floats load(const float* from) { return read<Floats>(from); }
  static Ints load(const std::int32_t* from) { return read<Ints>(from); }
  static Doubles load(const double* from) { return {read<Half>(from), read<Half>(from + Width / 2)}; }
  static void store(float* to, Floats values) { write(to, values); }
  static void store(std::int32_t* to, Ints values) { write(to, values); }
  static void store(double* to, Doubles values) {
    write(to, values.low);
    write(to + Width / 2, values.high);
  }
  /// Lanes below `count`.
  static Mask first(int count) { return load(k_lane_numbers) < fill_int(count); }
  static Mask negative(Ints values) { return values < Ints{}; }
  static Floats pick(Mask mask, Floats yes, Floats no) { return mask ? yes : no; }
  static Ints pick(Mask mask, Ints yes, Ints no) { return mask ? yes : no; }
  static Floats share(Floats a, Floats b) { return a / (a + b); }
  static Floats quotient(Floats a, Floats b) { return a / b; }
  static Floats min(Floats a, Floats b) { return a < b ? a : b; }
  static Floats max(Floats a, Floats b) { return a > b ? a : b; }
  static Ints bits_of(Floats values) { return reinterpret_cast<Ints>(values); }
  static Floats floats_of(Ints bits) { return reinterpret_cast<Floats>(bits); }

 protected:
  template <class Vector, class Number>
  static Vector read(const Number* from) {
    Vector result;
    __builtin_memcpy(&result, from, sizeof result);
    return result;
  }
  template <class Vector, class Number>
  static void write(Number* to, Vector values) {
    __builtin_memcpy(to, &values, sizeof values);
  }
};

}  // namespace
}  // namespace saddleback
