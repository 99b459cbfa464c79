#include "tessellation/relaxation/sites_on_curves.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <queue>

#include "saddleback/error.h"
#include "saddleback/geodesics/exact_distances.h"
#include "saddleback/mesh/sample.h"

#include "geodesics/exact/ways_to_face.h"
#include "support/box_tree.h"

namespace saddleback {
namespace {

Vec2 polar(double length, double angle) { return {length * std::cos(angle), length * std::sin(angle)}; }

Vec3 space(const Mesh& mesh, Index face, const Vec3& barycentric) { return position(mesh, {face, barycentric}); }

/// Arc length of the curve's point nearest in space.
double nearest_along(const SurfaceCurve& curve, const Vec3& place) {
  double least = std::numeric_limits<double>::infinity(), along = 0;
  for (const CurveSegment& segment : curve.segments()) {
    const Vec3 begin = space(curve.mesh(), segment.face, segment.begin);
    const Vec3 step = space(curve.mesh(), segment.face, segment.end) - begin;
    const double share = std::clamp((place - begin).dot(step) / step.squaredNorm(), 0.0, 1.0);
    const double squared = (begin + share * step - place).squaredNorm();
    if (squared < least) least = squared, along = segment.start + share * segment.length;
  }
  return along;
}

/// The foot of a point on a segment: how far along it, and the square of how far away.
struct Foot {
  double share, squared;
};

Foot foot_of(const Vec2& place, const Vec2& begin, const Vec2& end) {
  const Vec2 step = end - begin;
  const double share = std::clamp((place - begin).dot(step) / step.squaredNorm(), 0.0, 1.0);
  return {share, (begin + share * step - place).squaredNorm()};
}

/// The curve's point that is nearest to a site, as far as was looked.
struct NearestOnCurve {
  double distance = std::numeric_limits<double>::infinity(), along = 0;
  void take(const CurveSegment& segment, double share, double other) {
    if (other < distance) *this = {other, segment.start + share * segment.length};
  }
};

/// Looks in the faces that the site lies on; infinitely far where the curve passes none. In edges of the face.
NearestOnCurve nearest_in_faces(const SurfaceCurve& curve, const SurfacePoint& site) {
  NearestOnCurve nearest;
  for (const CurveSegment& segment : curve.segments()) {
    const std::optional<Vec3> inside = barycentric_in(curve.mesh(), site, segment.face, k_barycentric_tolerance);
    if (!inside) continue;
    const FaceChart chart(curve.mesh(), segment.face);
    const Foot foot = foot_of(chart.to_plane(*inside), chart.to_plane(segment.begin), chart.to_plane(segment.end));
    nearest.take(segment, foot.share, std::sqrt(foot.squared) / curve.mesh().length(3 * segment.face));
  }
  return nearest;
}

/// Looks from a segment along the ways to the site, whose feet are where they are shortest. Ways change as they pass
/// other vertices, so halves are looked at as well, where by the distances at their ends the site may be nearer.
void look_from(const CurveSegment& segment, const ExactField& field, NearestOnCurve& nearest) {
  constexpr double k_finest = 1.0 / 4096;  // of the segment
  struct Part {
    double begin, end, at_begin, at_end;  // shares, and the distances there
  };
  const auto at = [&](double share) {
    return SurfacePoint{segment.face, (1 - share) * segment.begin + share * segment.end};
  };
  const auto take = [&](double share) {
    const double distance = field.nearest_at(at(share)).distance;
    nearest.take(segment, share, distance);
    return distance;
  };
  WaysToFace to_face;
  std::vector<ExactField::Way> ways;
  std::vector<Part> parts{{0, 1, take(0), take(1)}};
  while (!parts.empty()) {
    const Part part = parts.back();
    parts.pop_back();
    const double width = part.end - part.begin, least = (part.at_begin + part.at_end - width * segment.length) / 2;
    if (width < k_finest || !(least < nearest.distance)) continue;
    const double middle = part.begin + width / 2, at_middle = take(middle);
    if (to_face.size() == 0) to_face = field.ways_to(segment.face);
    to_face.at(at(middle).barycentric, ways);
    take(foot_of(ways.front().image, field.place_of(at(0)), field.place_of(at(1))).share);
    parts.push_back({part.begin, middle, part.at_begin, at_middle});
    parts.push_back({middle, part.end, at_middle, part.at_end});
  }
}

/// Arc length of the curve's point that is nearest along the surface, of a mesh that its places do not show.
double nearest_along_surface(const SurfaceCurve& curve, const SurfacePoint& site, const JobStage& stage) {
  constexpr double k_on_curve = 1e-9;
  NearestOnCurve nearest = nearest_in_faces(curve, site);
  if (nearest.distance <= k_on_curve) return nearest.along;
  nearest = {};
  const ExactField field(curve.mesh(), {site}, stage);
  for (const CurveSegment& segment : curve.segments()) look_from(segment, field, nearest);
  return nearest.along;
}

/// Round a closed curve; up to the ends of an open one.
double on_curve(const SurfaceCurve& curve, double along) {
  if (!curve.closed()) return std::clamp(along, 0.0, curve.length());
  along = std::fmod(along, curve.length());
  return along < 0 ? along + curve.length() : along;
}

const CurveSegment& segment_at(const SurfaceCurve& curve, double along) {
  const auto segments = curve.segments();
  const auto next = std::ranges::upper_bound(segments, along, {}, &CurveSegment::start);
  return next == segments.begin() ? segments.front() : *(next - 1);
}

SurfacePoint point_on(const CurveSegment& segment, double along) {
  constexpr double k_rounding = 1e-12;  // ends are points of the curve to the bit
  const double share = (along - segment.start) / segment.length;
  if (share < k_rounding) return {segment.face, segment.begin};
  if (share > 1 - k_rounding) return {segment.face, segment.end};
  return {segment.face, normalized_barycentric((1 - share) * segment.begin + share * segment.end)};
}

}  // namespace

HeldSites::HeldSites(const Mesh& mesh, std::span<const SurfaceCurve* const> curves, std::span<const Index> held,
                     std::size_t site_count)
    : mesh_(mesh), curves_(curves) {
  for (std::size_t i = 0; i < curves.size(); ++i)
    if (&curves[i]->mesh() != &mesh) throw InputError(message("curves: curve ", i, " lies on another mesh"));
  if (held.empty()) return;
  if (held.size() != site_count)
    throw InputError(message("held: wanted a curve or -1 for each of the ", site_count, " sites, got ", held.size()));
  for (std::size_t i = 0; i < held.size(); ++i) {
    if (held[i] < k_none || held[i] >= static_cast<Index>(curves.size()))
      throw InputError(
          message("held: wanted -1 to ", static_cast<Index>(curves.size()) - 1, ", got ", held[i], " for site ", i));
  }
  if (std::ranges::any_of(held, [](Index curve) { return curve != k_none; }))
    curve_of_.assign(held.begin(), held.end());
}

HeldSites::Place HeldSites::place_at(const SurfaceCurve& curve, double along) const {
  const CurveSegment& segment = segment_at(curve, along);
  const FaceChart chart(mesh_, segment.face);
  const Vec2 step = chart.to_plane(segment.end) - chart.to_plane(segment.begin);
  const SurfacePoint point = point_on(segment, along);
  return {point, tangent_heading(mesh_, point, std::atan2(step.y(), step.x()))};
}

std::vector<double> HeldSites::bring(SurfacePoints& sites, const JobStage& stage) const {
  std::vector<double> along(any() ? sites.size() : 0);
  for (std::size_t i = 0; i < along.size(); ++i) {
    if (!is_held(i)) continue;
    stage.check();
    const SurfaceCurve& curve = *curves_[curve_of_[i]];
    along[i] = mesh_.is_intrinsic() ? nearest_along_surface(curve, sites[i], stage.part(0, 0))
                                    : nearest_along(curve, position(mesh_, sites[i]));
    sites[i] = place_at(curve, along[i]).point;
  }
  return along;
}

void HeldSites::project(const std::vector<double>& along, const SurfacePoints& sites, TangentField& field) const {
  if (!any()) return;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (!is_held(i)) continue;
    const Vec2 tangent = polar(1, place_at(*curves_[curve_of_[i]], along[i]).heading);
    field[i] = field[i].dot(tangent) * tangent;
  }
}

std::vector<double> HeldSites::move(const std::vector<double>& along, const SurfacePoints& sites,
                                    const TangentField& steps, Moved& moved) const {
  std::vector<double> next = along;
  if (!any()) return next;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (!is_held(i)) continue;
    const SurfaceCurve& curve = *curves_[curve_of_[i]];
    const double before = place_at(curve, along[i]).heading, wanted = steps[i].dot(polar(1, before));
    next[i] = on_curve(curve, along[i] + wanted);
    const Place place = place_at(curve, next[i]);
    moved.sites[i] = place.point;
    moved.turns[i] = polar(1, place.heading - before);
    moved.steps[i] = polar(curve.closed() ? wanted : next[i] - along[i], place.heading);
  }
  return next;
}

namespace {

/// Returns positions along a curve, at the ends of its segments, in units of the distance of neighbors in even cells.
std::vector<double> wanted_spacings(const SurfaceCurve& curve, std::span<const double> density, double mass,
                                    Index count) {
  const Mesh& mesh = curve.mesh();
  const auto density_at = [&](Index face, const Vec3& x) {
    if (density.empty()) return 1.0;
    const Triangle& t = mesh.triangles()[face];
    return x[0] * density[t[0]] + x[1] * density[t[1]] + x[2] * density[t[2]];
  };
  // A regular hexagon of area a has neighbors at the square root of 2 a / sqrt(3).
  const double cells_a_mass = count / mass, shape = std::sqrt(std::sqrt(3.0) / 2);
  std::vector<double> sums{0};
  for (const CurveSegment& segment : curve.segments()) {
    const double painted = density_at(segment.face, 0.5 * (segment.begin + segment.end));
    sums.push_back(sums.back() + segment.length * shape * std::sqrt(painted * cells_a_mass));
  }
  return sums;
}

double along_at(const SurfaceCurve& curve, const std::vector<double>& sums, double sum) {
  const auto next = std::ranges::upper_bound(sums, sum);
  if (next == sums.end()) return curve.length();
  const auto i = static_cast<std::size_t>(next - sums.begin()) - 1;
  const CurveSegment& segment = curve.segments()[i];
  return segment.start + segment.length * (sum - sums[i]) / (sums[i + 1] - sums[i]);
}

/// The places of points, as boxes without a size.
std::vector<Box<Vec3>> boxes_of(const Mesh& mesh, const SurfacePoints& points) {
  std::vector<Box<Vec3>> boxes;
  for (const SurfacePoint& point : points) boxes.push_back({position(mesh, point), position(mesh, point)});
  return boxes;
}

/// Returns how far points are from the nearest site: squared, in space; along the surface where that does not show it.
std::vector<double> ranks_by_distance(const Mesh& mesh, const SurfacePoints& sites, const SurfacePoints& points,
                                      const JobStage& stage) {
  if (mesh.is_intrinsic()) return ExactField(mesh, sites, stage).distance_to(points);
  const std::vector<Box<Vec3>> places = boxes_of(mesh, sites);
  const BoxTree<Vec3> tree(places, stage);
  std::vector<double> ranks;
  for (const SurfacePoint& point : points) {
    stage.check();
    const Vec3 place = position(mesh, point);
    double least = std::numeric_limits<double>::infinity();
    tree.visit_nearest(place, least, [&](Index i) { least = std::min(least, (places[i].low - place).squaredNorm()); });
    ranks.push_back(least);
  }
  return ranks;
}

/// Each site takes the place of a point: those nearest to any site are left out, but none that its part has no other
/// instead of. \throw InputError where that leaves too many.
SurfacePoints away_from(const Mesh& mesh, const SurfacePoints& sites, const SurfacePoints& points,
                        const JobStage& stage) {
  const std::vector<double> ranks = ranks_by_distance(mesh, sites, points, stage);
  std::vector<std::pair<double, Index>> nearest;
  for (Index i = 0; i < static_cast<Index>(points.size()); ++i) nearest.emplace_back(ranks[i], i);
  std::ranges::sort(nearest);
  const auto part_of = [&](const SurfacePoint& point) { return mesh.component_of(mesh.triangles()[point.face][0]); };
  std::vector<Index> in_part(mesh.component_count(), 0);
  for (const SurfacePoint& site : sites) ++in_part[part_of(site)];
  for (const SurfacePoint& point : points) ++in_part[part_of(point)];
  std::size_t surplus = sites.size();
  std::erase_if(nearest, [&](const auto& point) {
    Index& others = in_part[part_of(points[point.second])];
    if (surplus == 0 || others == 1) return false;
    --surplus;
    --others;
    return true;
  });
  if (surplus > 0)
    throw InputError(message("count: the curves and the parts without any need ", points.size() + surplus,
                             " sites; got ", points.size()));
  std::ranges::sort(nearest, {}, &std::pair<double, Index>::second);
  SurfacePoints rest;
  for (const auto& [distance, i] : nearest) rest.push_back(points[i]);
  return rest;
}

double mass_of(const Mesh& mesh, std::span<const double> density) {
  if (density.empty()) return mesh.area();
  double sum = 0;
  for (Index face = 0; face < mesh.face_count(); ++face) {
    const Triangle& t = mesh.triangles()[face];
    sum += mesh.face_area(face) * (density[t[0]] + density[t[1]] + density[t[2]]) / 3;
  }
  return sum;
}

/// The ends of open curves, those that several share once. Of ends that are less than half a cell apart along curves
/// one is kept, rather one at which long curves meet: two sites there would have cells that no dual mesh can be made
/// of.
class CurveEnds {
 public:
  /// `sums`: of each curve as `wanted_spacings` has them.
  CurveEnds(const Mesh& mesh, std::span<const SurfaceCurve* const> curves, const std::vector<std::vector<double>>& sums,
            const JobStage& stage) {
    number_ends(mesh, curves, stage);
    near_.resize(places_.size());
    std::vector<Index> long_curves(places_.size(), 0);
    for (std::size_t i = 0; i < curves.size(); ++i) {
      if (curves[i]->closed()) continue;
      const Index a = ends_[2 * i], b = ends_[2 * i + 1];
      if (const double size = sums[i].back(); size < k_near)
        near_[a].emplace_back(b, size), near_[b].emplace_back(a, size);
      else
        ++long_curves[a], ++long_curves[b];
    }
    std::vector<Index> order(places_.size());
    std::iota(order.begin(), order.end(), 0);
    std::ranges::stable_sort(order, std::ranges::greater(), [&](Index end) { return long_curves[end]; });
    is_kept_.assign(places_.size(), 0);
    distance_.assign(places_.size(), k_far);
    for (const Index end : order) is_kept_[end] = has_kept_near(end) ? 0 : 1;
  }

  Index count() const { return static_cast<Index>(places_.size()); }
  /// The number of an end of an open curve.
  Index of(Index curve, bool is_last) const { return ends_[2 * curve + (is_last ? 1 : 0)]; }
  bool is_kept(Index end) const { return is_kept_[end] != 0; }

 private:
  static constexpr double k_near = 0.5;  ///< of the distance of neighbors in even cells
  static constexpr double k_far = std::numeric_limits<double>::infinity();

  /// Gives each end the number of the first place that it is at, else of a new one.
  void number_ends(const Mesh& mesh, std::span<const SurfaceCurve* const> curves, const JobStage& stage) {
    constexpr double k_same = 1e-9;  // relative to the curve
    ends_.assign(2 * curves.size(), k_none);
    SurfacePoints points;
    for (const SurfaceCurve* curve : curves)
      for (const double along : {0.0, curve->length()}) points.push_back(point_on(segment_at(*curve, along), along));
    const std::vector<Box<Vec3>> boxes = mesh.is_intrinsic() ? std::vector<Box<Vec3>>() : boxes_of(mesh, points);
    const BoxTree<Vec3> tree(boxes, stage);
    for (std::size_t i = 0; i < points.size(); ++i) {
      stage.check();
      if (curves[i / 2]->closed()) continue;
      const double reach = k_same * curves[i / 2]->length();
      Index found = count();
      const auto look_at = [&](Index number) {
        if (number != k_none && number < found && step_length(mesh, points[i], places_[number]) <= reach)
          found = number;
      };
      if (boxes.empty()) {  // places in space say nothing there
        for (Index number = 0; number < count(); ++number) look_at(number);
      } else {
        tree.visit_nearest(boxes[i].low, 2 * reach * reach, [&](Index end) { look_at(ends_[end]); });
      }
      if (found == count()) places_.push_back(points[i]);
      ends_[i] = found;
    }
  }

  /// Searches along short curves, as Dijkstra does.
  bool has_kept_near(Index end) {
    std::priority_queue<std::pair<double, Index>, std::vector<std::pair<double, Index>>, std::greater<>> queue;
    std::vector<Index> reached{end};
    bool found = false;
    for (queue.emplace(distance_[end] = 0, end); !queue.empty() && !found; queue.pop()) {
      const auto [distance, at] = queue.top();
      if (found = is_kept_[at] != 0; found || distance > distance_[at]) continue;
      for (const auto& [next, size] : near_[at]) {
        if (!(distance + size < std::min(k_near, distance_[next]))) continue;
        distance_[next] = distance + size;
        reached.push_back(next);
        queue.emplace(distance_[next], next);
      }
    }
    for (const Index other : reached) distance_[other] = k_far;
    return found;
  }

  std::vector<Index> ends_;  ///< by curve, first and last; k_none of closed ones
  SurfacePoints places_;
  std::vector<std::vector<std::pair<Index, double>>> near_;  ///< ends along short curves, and how far
  std::vector<double> distance_;                             ///< of a search
  std::vector<std::uint8_t> is_kept_;
};

}  // namespace

HeldStart held_start(const Mesh& mesh, Index count, std::span<const SurfaceCurve* const> curves,
                     std::span<const double> density, std::uint64_t seed, const JobStage& stage) {
  HeldStart start;
  const double mass = mass_of(mesh, density);
  std::vector<std::vector<double>> sums;
  for (const SurfaceCurve* curve : curves) sums.push_back(wanted_spacings(*curve, density, mass, count));
  const auto add = [&](Index curve, double along) {
    start.sites.push_back(point_on(segment_at(*curves[curve], along), along));
    start.held.push_back(curve);
  };
  const CurveEnds ends(mesh, curves, sums, stage);
  std::vector<std::uint8_t> is_added(ends.count(), 0);
  for (Index i = 0; i < static_cast<Index>(curves.size()); ++i) {
    const SurfaceCurve& curve = *curves[i];
    const double size = sums[i].back();
    const Index least = curve.closed() ? 3 : 1, gaps = std::max(least, static_cast<Index>(std::lround(size)));
    for (const bool is_last : {false, true}) {
      if (curve.closed()) break;
      const Index end = ends.of(i, is_last);
      if (!ends.is_kept(end) || is_added[end]) continue;
      is_added[end] = 1;
      start.fixed.push_back(static_cast<Index>(start.sites.size()));
      add(i, is_last ? curve.length() : 0);
    }
    for (Index gap = curve.closed() ? 0 : 1; gap < gaps; ++gap) add(i, along_at(curve, sums[i], size * gap / gaps));
  }
  const auto on_curves = static_cast<Index>(start.sites.size());
  if (on_curves > count) {
    throw InputError(message("count: the curves need ", on_curves,
                             " sites, so that their cells are as large as the others; got ", count));
  }
  const SurfacePoints rest = away_from(
      mesh, start.sites,
      sample(mesh, {.count = count, .density = density, .seed = seed, .one_per_component = mesh.component_count() > 1}),
      stage);
  start.sites.insert(start.sites.end(), rest.begin(), rest.end());
  start.held.resize(start.sites.size(), k_none);
  return start;
}

}  // namespace saddleback
