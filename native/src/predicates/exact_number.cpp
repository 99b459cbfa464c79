#include "predicates/exact_number.h"

#include <algorithm>
#include <cmath>

namespace saddleback::predicates {
namespace {

constexpr int k_bits = 32;

}  // namespace

ExactNumber::ExactNumber(double value) {
  if (value == 0) return;
  sign_ = value > 0 ? 1 : -1;
  int exponent;
  auto mantissa = static_cast<std::uint64_t>(std::ldexp(std::frexp(std::fabs(value), &exponent), 53));
  exponent -= 53;
  exponent_ = exponent >= 0 ? exponent / k_bits : -((-exponent + k_bits - 1) / k_bits);
  const int shift = exponent - k_bits * exponent_;
  const std::uint64_t low = mantissa << shift;
  const std::uint64_t high = shift == 0 ? 0 : mantissa >> (64 - shift);
  limbs_ = {static_cast<std::uint32_t>(low), static_cast<std::uint32_t>(low >> k_bits),
            static_cast<std::uint32_t>(high)};
  trim();
}

void ExactNumber::trim() {
  while (!limbs_.empty() && limbs_.back() == 0) limbs_.pop_back();
  const auto first = std::find_if(limbs_.begin(), limbs_.end(), [](std::uint32_t limb) { return limb != 0; });
  exponent_ += static_cast<int>(first - limbs_.begin());
  limbs_.erase(limbs_.begin(), first);
  if (limbs_.empty()) sign_ = exponent_ = 0;
}

std::uint32_t ExactNumber::limb(int place) const {
  return place >= exponent_ && place < end() ? limbs_[place - exponent_] : 0;
}

double ExactNumber::to_double() const {
  double result = 0;
  const int size = static_cast<int>(limbs_.size());
  for (int k = std::max(0, size - 4); k < size; ++k)
    result += std::ldexp(static_cast<double>(limbs_[k]), k_bits * (k + exponent_));
  return sign_ * result;
}

ExactNumber ExactNumber::operator-() const {
  ExactNumber result = *this;
  result.sign_ = -sign_;
  return result;
}

ExactNumber ExactNumber::sum(const ExactNumber& a, const ExactNumber& b, int b_sign) {
  if (b_sign == 0) return a;
  if (a.sign_ == 0) {
    ExactNumber result = b;
    result.sign_ = b_sign;
    return result;
  }
  ExactNumber result;
  result.exponent_ = std::min(a.exponent_, b.exponent_);
  const int end = std::max(a.end(), b.end());
  result.limbs_.reserve(end - result.exponent_ + 1);
  bool b_is_larger = false;
  if (a.sign_ != b_sign) {
    int place = end - 1;
    while (place > result.exponent_ && a.limb(place) == b.limb(place)) --place;
    b_is_larger = b.limb(place) > a.limb(place);
  }
  const ExactNumber &large = b_is_larger ? b : a, &small = b_is_larger ? a : b;
  std::int64_t carry = 0;
  for (int place = result.exponent_; place < end; ++place) {
    const std::int64_t x = large.limb(place), y = small.limb(place);
    carry += a.sign_ == b_sign ? x + y : x - y;
    result.limbs_.push_back(static_cast<std::uint32_t>(carry));
    carry >>= k_bits;
  }
  result.limbs_.push_back(static_cast<std::uint32_t>(carry));
  result.sign_ = b_is_larger ? b_sign : a.sign_;
  result.trim();
  return result;
}

ExactNumber operator*(const ExactNumber& a, const ExactNumber& b) {
  ExactNumber result;
  result.sign_ = a.sign_ * b.sign_;
  if (result.sign_ == 0) return result;
  result.exponent_ = a.exponent_ + b.exponent_;
  result.limbs_.assign(a.limbs_.size() + b.limbs_.size(), 0);
  for (std::size_t i = 0; i < a.limbs_.size(); ++i) {
    std::uint64_t carry = 0;
    for (std::size_t j = 0; j < b.limbs_.size(); ++j) {
      carry += static_cast<std::uint64_t>(a.limbs_[i]) * b.limbs_[j] + result.limbs_[i + j];
      result.limbs_[i + j] = static_cast<std::uint32_t>(carry);
      carry >>= k_bits;
    }
    result.limbs_[i + b.limbs_.size()] = static_cast<std::uint32_t>(carry);
  }
  result.trim();
  return result;
}

}  // namespace saddleback::predicates
