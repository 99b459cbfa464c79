#include "saddleback/distribution/safe_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/error.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr Index k_angles = FrontProfiles::k_angles, k_columns = FrontProfiles::k_columns;
constexpr double k_largest = std::numeric_limits<std::uint16_t>::max();
/// Sums of floats and the unit of the table round by less than this, relative.
constexpr double k_rounding = 1e-6;

/// The largest sum of fronts of equal strips. b is seen from the other side, its strips in the opposite order.
float largest_sum(const float* a, const float* b_reversed) {
  using Fronts = Eigen::Map<const Eigen::Array<float, k_columns, 1>>;
  return (Fronts(a) + Fronts(b_reversed)).maxCoeff();
}

void check_angle(const char* name, double angle) {
  if (!std::isfinite(angle)) throw InputError(message(name, " is ", angle, ", but must be finite"));
}

void check_scale(const char* name, double scale) {
  if (!(scale > 0) || !std::isfinite(scale))
    throw InputError(message(name, " is ", scale, ", but must be positive and finite"));
}

/// The largest sum over strips of different widths: between any two ends of strips both fronts are constant.
double largest_sum(const FrontProfiles& a, Index alpha, double scale_a, const FrontProfiles& b, Index beta,
                   double scale_b) {
  const std::span<const float> fronts_a = a.columns(alpha), fronts_b = b.columns(beta);
  const double width_a = scale_a * 2 * a.half_width() / k_columns, width_b = scale_b * 2 * b.half_width() / k_columns;
  const double reach = std::min(scale_a * a.half_width(), scale_b * b.half_width());
  // The first strip that both shapes have. One before it, which meets none of the other's, would be summed as well.
  const auto first = [&](double width) {
    return std::max<Index>(0, static_cast<Index>(std::floor(k_columns / 2.0 - reach / width - k_rounding)));
  };
  Index i = first(width_a), j = first(width_b);
  double best = -std::numeric_limits<double>::infinity();
  while (i < k_columns && j < k_columns) {
    best = std::max(best, scale_a * fronts_a[i] + scale_b * fronts_b[k_columns - 1 - j]);
    // Ends of strips counted from the middle. Where rounding cannot tell which is first, both neighbors were summed.
    const double end_a = (i + 1 - 0.5 * k_columns) * width_a, end_b = (j + 1 - 0.5 * k_columns) * width_b;
    const double slack = k_rounding * (width_a + width_b);
    if (std::abs(end_a - end_b) <= slack) {
      if (i + 1 < k_columns) best = std::max(best, scale_a * fronts_a[i + 1] + scale_b * fronts_b[k_columns - 1 - j]);
      if (j + 1 < k_columns) best = std::max(best, scale_a * fronts_a[i] + scale_b * fronts_b[k_columns - 2 - j]);
      ++i, ++j;
    } else if (end_a < end_b) {
      ++i;
    } else {
      ++j;
    }
  }
  return best;
}

}  // namespace

SafeDistanceTable::SafeDistanceTable(const Shape& a, const Shape& b, int threads, Job* job)
    : SafeDistanceTable(a, b, threads, JobStage(job, "Measuring safe distances")) {}

SafeDistanceTable::SafeDistanceTable(const Shape& a, const Shape& b, int threads, const JobStage& stage)
    : table_unit_((a.circumradius() + b.circumradius()) * (1 + k_rounding) / (k_largest - 1)),
      a_(a, a.circumradius(), threads, stage.part(0, 0.2)),
      b_(b, b.circumradius(), threads, stage.part(0.2, 0.4)) {
  // At equal scales only strips that both shapes have can meet.
  const double shared = std::min(a.circumradius(), b.circumradius());
  if (a.circumradius() == b.circumradius())
    fill(a_, b_, threads, stage.part(0.8, 1));
  else
    fill(FrontProfiles(a, shared, threads, stage.part(0.4, 0.6)),
         FrontProfiles(b, shared, threads, stage.part(0.6, 0.8)), threads, stage.part(0.8, 1));
}

void SafeDistanceTable::fill(const FrontProfiles& a, const FrontProfiles& b, int threads, const JobStage& stage) {
  constexpr Index k_chunk = 16;
  table_.resize(static_cast<std::size_t>(k_angles) * k_angles);
  std::vector<float> reversed(static_cast<std::size_t>(k_angles) * k_columns);
  for (Index beta = 0; beta < k_angles; ++beta)
    std::reverse_copy(b.columns(beta).begin(), b.columns(beta).end(),
                      reversed.begin() + static_cast<std::ptrdiff_t>(beta) * k_columns);
  parallel_for(k_angles, threads, k_chunk, [&](Index alpha, int) {
    stage.update(static_cast<double>(alpha) / k_angles);
    for (Index beta = 0; beta < k_angles; ++beta) {
      const double sum = static_cast<double>(
          largest_sum(a.columns(alpha).data(), reversed.data() + static_cast<std::ptrdiff_t>(beta) * k_columns));
      const double units = std::ceil(std::max(0.0, sum) * (1 + k_rounding) / table_unit_);
      table_[static_cast<std::size_t>(alpha) * k_angles + beta] =
          static_cast<std::uint16_t>(std::min(units, k_largest));
    }
  });
  stage.update(1);
}

double SafeDistanceTable::distance(double alpha, double beta, double scale_a, double scale_b) const {
  check_angle("alpha", alpha);
  check_angle("beta", beta);
  check_scale("scale_a", scale_a);
  check_scale("scale_b", scale_b);
  const Index i = FrontProfiles::range_of(alpha), j = FrontProfiles::range_of(beta);
  const double sum = scale_a == scale_b ? scale_a * table_unit_ * table_[static_cast<std::size_t>(i) * k_angles + j]
                                        : std::max(0.0, largest_sum(a_, i, scale_a, b_, j, scale_b));
  const double reach = scale_a * a_.half_width() + scale_b * b_.half_width();
  return std::min(sum, reach) * (1 + k_rounding);
}

std::size_t SafeDistanceTable::byte_count() const {
  return a_.byte_count() + b_.byte_count() + table_.size() * sizeof(std::uint16_t);
}

}  // namespace saddleback
