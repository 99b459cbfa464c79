#include "predicates/orient_3d.h"

#include <array>
#include <cmath>
#include <limits>

#include "predicates/exact_number.h"

namespace saddleback::predicates {
namespace {

/// The determinant of a - d, b - d and c - d.
template <class Number>
Number determinant(const std::array<Number, 3>& a, const std::array<Number, 3>& b, const std::array<Number, 3>& c) {
  return a[2] * (b[0] * c[1] - b[1] * c[0]) + b[2] * (c[0] * a[1] - c[1] * a[0]) + c[2] * (a[0] * b[1] - a[1] * b[0]);
}

std::array<ExactNumber, 3> exact_difference(const Vec3& a, const Vec3& b) {
  return {ExactNumber(a.x()) - b.x(), ExactNumber(a.y()) - b.y(), ExactNumber(a.z()) - b.z()};
}

}  // namespace

int orient_3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  constexpr double k_epsilon = std::numeric_limits<double>::epsilon() / 2;
  constexpr double k_bound = (7 + 56 * k_epsilon) * k_epsilon;  // o3derrboundA [shewchuk1997]
  const auto difference = [](const Vec3& u, const Vec3& v) {
    return std::array<double, 3>{u.x() - v.x(), u.y() - v.y(), u.z() - v.z()};
  };
  const auto ad = difference(a, d), bd = difference(b, d), cd = difference(c, d);
  const auto minor = [](const std::array<double, 3>& u, const std::array<double, 3>& v) {
    return std::abs(u[0] * v[1]) + std::abs(u[1] * v[0]);
  };
  const double permanent =
      minor(bd, cd) * std::abs(ad[2]) + minor(cd, ad) * std::abs(bd[2]) + minor(ad, bd) * std::abs(cd[2]);
  const double value = determinant(ad, bd, cd);
  if (value > k_bound * permanent || -value > k_bound * permanent) return sign_of(value);
  if (permanent == 0) return 0;
  return sign_of(determinant(exact_difference(a, d), exact_difference(b, d), exact_difference(c, d)));
}

}  // namespace saddleback::predicates
