#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "saddleback/error.h"
#include "saddleback/mesh/triangle_arrays.h"

#include "support/threads/parallel.h"
#include "support/work_done.h"

namespace saddleback {
namespace {

void check_groups(const char* name, std::span<const Index> groups, std::size_t wanted) {
  if (groups.size() != wanted) throw InputError(message(name, ": wanted ", wanted, ", got ", groups.size()));
  for (std::size_t i = 0; i < groups.size(); ++i)
    if (groups[i] < 0) throw InputError(message(name, "[", i, "] is ", groups[i], ", but must be 0 or more"));
}

struct Segment {
  Vec3 from, along;
  double inverse;  ///< of the squared length; 0 without one
};

}  // namespace

std::vector<double> segment_distances(std::span<const Vec3> points, std::span<const Index> point_group,
                                      std::span<const std::array<Vec3, 2>> ends, std::span<const Index> segment_group,
                                      const JobStage& stage) {
  constexpr Index k_at_once = 256;
  check_groups("point_group", point_group, points.size());
  check_groups("segment_group", segment_group, ends.size());
  std::vector<Index> order(ends.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](Index i) { return segment_group[i]; });
  std::vector<Segment> segments;
  segments.reserve(ends.size());
  for (const Index i : order) {
    const Vec3 along = ends[i][1] - ends[i][0];
    const double squared = along.squaredNorm();
    segments.push_back({ends[i][0], along, squared > 0 ? 1 / squared : 0});
  }
  std::vector<double> distances(points.size());
  WorkDone done(stage, static_cast<double>(points.size()));
  parallel_for(static_cast<Index>(points.size()), 0, k_at_once, [&](Index i, int) {
    if (i % k_at_once == 0) done.add(k_at_once);
    const auto own = std::ranges::equal_range(order, point_group[i], {}, [&](Index s) { return segment_group[s]; });
    double least = std::numeric_limits<double>::infinity();
    for (auto place = own.begin() - order.begin(); place < own.end() - order.begin(); ++place) {
      const Segment& segment = segments[place];
      const Vec3 way = points[i] - segment.from;
      const double share = std::clamp(way.dot(segment.along) * segment.inverse, 0.0, 1.0);
      least = std::min(least, (way - share * segment.along).squaredNorm());
    }
    distances[i] = std::sqrt(least);
  });
  return distances;
}

}  // namespace saddleback
