#include "predicates/weighted_2d.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

#include "predicates/exact_number.h"

namespace saddleback::predicates {
namespace {

Sign to_sign(int sign) { return static_cast<Sign>(sign); }

ExactNumber exact_difference(double a, double b) { return ExactNumber(a) - ExactNumber(b); }

/// Another site as the first one sees it; q = (x, y, e) / n.
template <class Number>
struct Seen {
  Number x, y, e, n;
};

template <class Number>
Seen<Number> seen_from(const Number& x, const Number& y, const Number& e) {
  return {x, y, e, x * x + y * y - e * e};
}

/// The sign of p + q sqrt(s), s > 0, where `difference()` has the sign of p^2 - q^2 s.
template <class Difference>
int sign_with_root(int p, int q, Difference&& difference) {
  if (p * q >= 0) return p != 0 ? p : q;
  return p * difference();
}

/// Difference of two q's, times a positive number.
template <class Number>
std::array<Number, 3> from_to(const Seen<Number>& a, const Seen<Number>& b) {
  return {a.n * b.x - b.n * a.x, a.n * b.y - b.n * a.y, a.n * b.e - b.n * a.e};
}

// With m = q_b - q_a and n = q_c - q_b the direction is u = (-m_z m - sqrt(s) m') / m^2, m' being m turned left and
// s = m_x^2 + m_y^2 - m_z^2. With X = m x n, then, m^2 n.(u, 1) = m_y X_x - m_x X_y - X_z sqrt(s), and the squares
// of both terms differ by m^2 (X_x^2 + X_y^2 - X_z^2).
template <class Number>
int compare_heights(const Seen<Number>& a, const Seen<Number>& b, const Seen<Number>& c) {
  const auto cross = [&](Number Seen<Number>::*u, Number Seen<Number>::*v) -> Number {
    return c.n * (a.*u * (b.*v) - a.*v * (b.*u)) + a.n * (b.*u * (c.*v) - b.*v * (c.*u)) +
           b.n * (c.*u * (a.*v) - c.*v * (a.*u));
  };
  using S = Seen<Number>;
  const Number x = cross(&S::y, &S::e), y = cross(&S::e, &S::x), z = cross(&S::x, &S::y);
  const std::array<Number, 3> m = from_to(a, b);
  return sign_with_root(sign_of(m[1] * x - m[0] * y), -sign_of(z), [&] { return sign_of(x * x + y * y - z * z); });
}

// The turn is m_z (n x m) + sqrt(s) m.n over m^2.
template <class Number>
int turn(const std::array<Number, 3>& m, const std::array<Number, 3>& n) {
  const Number cross = n[0] * m[1] - n[1] * m[0], dot = m[0] * n[0] + m[1] * n[1];
  return sign_with_root(sign_of(m[2]) * sign_of(cross), sign_of(dot),
                        [&] { return sign_of(m[2] * m[2] * (n[0] * n[0] + n[1] * n[1]) - dot * dot); });
}

/// Four sites at most: what may be null is infinitely far away.
using Others = std::array<const WeightedPoint2*, 4>;

template <class Number>
using AllSeen = std::array<Seen<Number>, 4>;

AllSeen<ExactNumber> exactly_seen(const WeightedPoint2& site, const Others& others) {
  AllSeen<ExactNumber> result;
  for (std::size_t k = 0; k < others.size(); ++k) {
    const WeightedPoint2* const p = others[k];
    if (p == nullptr) {
      result[k].n = 1.0;
    } else {
      result[k] = seen_from(exact_difference(p->x, site.x), exact_difference(p->y, site.y),
                            exact_difference(p->weight, site.weight));
    }
  }
  return result;
}

/// Differences as integers up to a limit, times a power of two: then doubles multiply them without rounding. Such are
/// the sites of grids, which have the most ties.
std::optional<AllSeen<double>> seen_as_integers(const WeightedPoint2& site, const Others& others, double limit) {
  std::array<double, 12> values{};
  double largest = 0;
  int lowest = 2000;
  for (std::size_t k = 0; k < others.size(); ++k) {
    if (others[k] == nullptr) continue;
    const WeightedPoint2& p = *others[k];
    const std::array<std::array<double, 2>, 3> pairs{{{p.x, site.x}, {p.y, site.y}, {p.weight, site.weight}}};
    for (std::size_t i = 0; i < 3; ++i) {
      double rest;
      two_sum(pairs[i][0], -pairs[i][1], values[3 * k + i], rest);
      const double value = std::fabs(values[3 * k + i]);
      if (rest != 0) return std::nullopt;
      if (value == 0) continue;
      int exponent;
      const auto mantissa = static_cast<std::uint64_t>(std::ldexp(std::frexp(value, &exponent), 53));
      lowest = std::min(lowest, exponent - 53 + std::countr_zero(mantissa));
      largest = std::max(largest, value);
    }
  }
  if (largest == 0 || std::ilogb(largest) - lowest > 52 || std::ldexp(largest, -lowest) > limit) return std::nullopt;
  AllSeen<double> result;
  for (std::size_t k = 0; k < others.size(); ++k) {
    const auto value = [&](std::size_t i) { return std::ldexp(values[3 * k + i], -lowest); };
    result[k] = others[k] ? seen_from(value(0), value(1), value(2)) : Seen<double>{0, 0, 0, 1};
  }
  return result;
}

template <class Number>
int compare_seen(const AllSeen<Number>& seen, int fixed) {
  if (fixed < 0) return compare_heights(seen[0], seen[1], seen[2]);
  const FixedDirection& u = k_fixed_directions[fixed];
  const std::array<Number, 3> n = from_to(seen[1], seen[2]);
  return sign_of(n[0] * Number(u.x) + n[1] * Number(u.y) + n[2] * Number(u.z));
}

template <class Number>
int turn_seen(const AllSeen<Number>& seen, int fixed) {
  const std::array<Number, 3> n = from_to(seen[2], seen[3]);
  if (fixed < 0) return turn(from_to(seen[0], seen[1]), n);
  const FixedDirection& u = k_fixed_directions[fixed];
  return sign_of(Number(u.x) * n[1] - Number(u.y) * n[0]);
}

double largest_of(const Seen<ExactNumber>& seen) {
  return std::max({std::fabs(seen.x.to_double()), std::fabs(seen.y.to_double()), std::fabs(seen.e.to_double())});
}

}  // namespace

bool hides(const WeightedPoint2& a, const WeightedPoint2& b) {
  if (a.weight < b.weight) return false;
  const double x = a.x - b.x, y = a.y - b.y, e = a.weight - b.weight;
  const double away = x * x + y * y, reach = e * e;
  if (std::fabs(away - reach) > 8 * detail::k_epsilon * (away + reach)) return away < reach;
  return seen_from(exact_difference(a.x, b.x), exact_difference(a.y, b.y), exact_difference(a.weight, b.weight))
             .n.sign() <= 0;
}

Sign compare_weighted_distances(const Point2& p, const WeightedPoint2& a, const WeightedPoint2& b) {
  const double ax = a.x - p.x, ay = a.y - p.y, bx = b.x - p.x, by = b.y - p.y, e = a.weight - b.weight;
  const double to_a = std::sqrt(ax * ax + ay * ay), to_b = std::sqrt(bx * bx + by * by);
  const double value = to_a - to_b - e;
  if (std::fabs(value) > 8 * detail::k_epsilon * (to_a + to_b + std::fabs(e))) return detail::to_sign(value);
  // With e >= 0: sqrt(A) against sqrt(B) + e, hence A - B - e^2 against 2 e sqrt(B).
  if (e < 0) return to_sign(-static_cast<int>(compare_weighted_distances(p, b, a)));
  const auto squared = [&](const WeightedPoint2& c) {
    const ExactNumber x = exact_difference(c.x, p.x), y = exact_difference(c.y, p.y);
    return x * x + y * y;
  };
  const ExactNumber from_b = squared(b), weight = exact_difference(a.weight, b.weight);
  const ExactNumber rest = squared(a) - from_b - weight * weight;
  const int root = from_b.sign() * weight.sign();
  return to_sign(sign_with_root(rest.sign(), -root,
                                [&] { return (rest * rest - ExactNumber(4) * weight * weight * from_b).sign(); }));
}

Sign compare_at_crossing(const WeightedPoint2& site, const Crossing& crossing, const WeightedPoint2* other) {
  const Others others{crossing.before, crossing.after, other, nullptr};
  constexpr double k_limit = 40;  // coordinates of X are up to 12 k^4: 432 k^8 < 2^53
  if (const auto small = seen_as_integers(site, others, k_limit)) return to_sign(compare_seen(*small, crossing.fixed));
  return to_sign(compare_seen(exactly_seen(site, others), crossing.fixed));
}

Sign turn_from_crossing(const WeightedPoint2& site, const Crossing& crossing, const WeightedPoint2* a,
                        const WeightedPoint2* b) {
  const Others others{crossing.before, crossing.after, a, b};
  constexpr double k_limit = 10;  // m and n are up to 4 k^3: 1024 k^12 < 2^53
  if (const auto small = seen_as_integers(site, others, k_limit)) return to_sign(turn_seen(*small, crossing.fixed));
  return to_sign(turn_seen(exactly_seen(site, others), crossing.fixed));
}

// At the crossing f_a = f_b = s, or D_a.u = N_a s - e_a and D_b.u = N_b s - e_b. Solved for u this is linear in s, and
// u^2 = 1 a quadratic equation, whose coefficients are exact before they are rounded.
CrossingPlace crossing_place(const WeightedPoint2& site, const Crossing& crossing) {
  AllSeen<ExactNumber> seen = exactly_seen(site, {crossing.before, crossing.after, nullptr, nullptr});
  auto &a = seen[0], &b = seen[1];
  const double scale = std::ldexp(1, -std::ilogb(std::max(largest_of(a), largest_of(b))));
  if (crossing.before) a = seen_from(a.x * scale, a.y * scale, a.e * scale);
  if (crossing.after) b = seen_from(b.x * scale, b.y * scale, b.e * scale);
  const std::array<ExactNumber, 3> m = from_to(a, b);
  const double x = m[0].to_double(), y = m[1].to_double(), z = m[2].to_double();
  const double root = std::sqrt(std::max(0.0, (m[0] * m[0] + m[1] * m[1] - m[2] * m[2]).to_double()));
  const double square = x * x + y * y, u = (-z * x + root * y) / square, v = (-z * y - root * x) / square;
  const ExactNumber slope[2] = {a.n * b.y - b.n * a.y, b.n * a.x - a.n * b.x};
  const ExactNumber offset[2] = {b.e * a.y - a.e * b.y, a.e * b.x - b.e * a.x};
  const ExactNumber det = a.x * b.y - a.y * b.x;
  const ExactNumber p = slope[0] * slope[0] + slope[1] * slope[1], q = slope[0] * offset[0] + slope[1] * offset[1],
                    r = offset[0] * offset[0] + offset[1] * offset[1] - det * det;
  // The direction is the one from which `after` is nearer, counter-clockwise: the root is (-q + sqrt(q^2 - p r)) / p,
  // or with - where the sites turn the other way. Whichever way adds two numbers of one sign is free from cancellation.
  const double turned = det.sign() * std::sqrt(std::max(0.0, (q * q - p * r).to_double())), to_q = -q.to_double();
  const double s = to_q * turned >= 0 ? (to_q + turned) / p.to_double() : r.to_double() / (to_q - turned);
  return {u, v, s * scale};
}

}  // namespace saddleback::predicates
