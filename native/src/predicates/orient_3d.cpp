#include "predicates/orient_3d.h"

#include <array>
#include <cmath>
#include <limits>

#include "predicates/exact_number.h"
#include "predicates/expansion.h"

namespace saddleback::predicates {
namespace {

using Differences = std::array<Expansion<2>, 3>;  ///< of coordinates

Differences differences(const Vec3& a, const Vec3& b) {
  return {difference(a.x(), b.x()), difference(a.y(), b.y()), difference(a.z(), b.z())};
}

/// Returns height * (a x b in the plane).
Expansion<64> volume(const Differences& a, const Differences& b, const Expansion<2>& height) {
  return product(sum(product(a[0], b[1]), product(b[0], a[1]), -1), height);
}

}  // namespace

int orient_3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  constexpr double k_epsilon = std::numeric_limits<double>::epsilon() / 2;
  constexpr double k_bound = (7 + 56 * k_epsilon) * k_epsilon;  // o3derrboundA [shewchuk1997]
  const auto rounded = [](const Vec3& u, const Vec3& v) {
    return std::array<double, 3>{u.x() - v.x(), u.y() - v.y(), u.z() - v.z()};
  };
  const auto ad = rounded(a, d), bd = rounded(b, d), cd = rounded(c, d);
  const auto minor = [](const std::array<double, 3>& u, const std::array<double, 3>& v) {
    return std::abs(u[0] * v[1]) + std::abs(u[1] * v[0]);
  };
  const double permanent =
      minor(bd, cd) * std::abs(ad[2]) + minor(cd, ad) * std::abs(bd[2]) + minor(ad, bd) * std::abs(cd[2]);
  const double value = ad[2] * (bd[0] * cd[1] - bd[1] * cd[0]) + bd[2] * (cd[0] * ad[1] - cd[1] * ad[0]) +
                       cd[2] * (ad[0] * bd[1] - ad[1] * bd[0]);
  if (value > k_bound * permanent || -value > k_bound * permanent) return sign_of(value);
  if (permanent == 0) return 0;
  const Differences of_a = differences(a, d), of_b = differences(b, d), of_c = differences(c, d);
  return sum(sum(volume(of_b, of_c, of_a[2]), volume(of_c, of_a, of_b[2])), volume(of_a, of_b, of_c[2])).sign();
}

}  // namespace saddleback::predicates
