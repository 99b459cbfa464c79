#pragma once
// Numbers without rounding: sums, differences and products of doubles of any size. For the few decisions of high degree
// that doubles cannot make; where speed matters there are expansions (`expansion.h`).

#include <cstdint>
#include <vector>

namespace saddleback::predicates {

/// A binary fraction: the sum of limbs[k] 2^(32 (k + exponent)), with a sign. Never over- or underflows.
class ExactNumber {
 public:
  ExactNumber() = default;
  explicit(false) ExactNumber(double value);  ///< \pre value is finite

  int sign() const { return sign_; }
  /// Off by a few roundings; infinite or 0 beyond the doubles.
  double to_double() const;

  friend ExactNumber operator+(const ExactNumber& a, const ExactNumber& b) { return sum(a, b, b.sign_); }
  friend ExactNumber operator-(const ExactNumber& a, const ExactNumber& b) { return sum(a, b, -b.sign_); }
  friend ExactNumber operator*(const ExactNumber& a, const ExactNumber& b);
  ExactNumber operator-() const;

 private:
  static ExactNumber sum(const ExactNumber& a, const ExactNumber& b, int b_sign);
  std::uint32_t limb(int place) const;  ///< of weight 2^(32 place)
  int end() const { return exponent_ + static_cast<int>(limbs_.size()); }
  void trim();

  int sign_ = 0, exponent_ = 0;
  std::vector<std::uint32_t> limbs_;  ///< neither the first nor the last is 0
};

inline int sign_of(const ExactNumber& value) { return value.sign(); }
inline int sign_of(double value) { return (value > 0) - (value < 0); }

}  // namespace saddleback::predicates
