// Systematic sampling of a surface.
//
// The faces are laid end to end along a Hilbert curve, each as long as its mass (the integral of the density over it),
// and the count points are put at equal steps along that line from one random offset. A run of faces between two points
// is a compact patch that holds exactly one point's worth of mass, so the points are stratified over the surface
// whatever the size of the faces. Within a face that holds several points they follow a Fibonacci lattice, carried from
// the unit square onto the triangle by the inverse of the density's distribution function, so that large faces are
// covered evenly as well. Only + - * / sqrt and integers are used: the same seed gives the same bits everywhere.

#include "saddleback/mesh/sample.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "saddleback/error.h"

#include "mesh/tables/hilbert.h"
#include "support/key_order.h"
#include "support/random_numbers.h"

namespace saddleback {
namespace {

constexpr std::size_t k_chunk = 1 << 12;  ///< points or faces between two looks at the job

/// The share of a linear function's mass that lies in [0, x] of [0, 1] is u: x. The function goes from a to b.
double inverse_linear(double a, double b, double u) {
  if (a + b <= 0) return u;
  return u * (a + b) / (a + std::sqrt(std::max(0.0, a * a + u * (b * b - a * a))));
}

/// r in [0, 1] at which the distribution of density r ((1 - r) a + r b) reaches the share u. The density is the face's,
/// summed along lines of equal distance r from corner 0; a is its value there, b the mean of the other two corners.
double inverse_from_corner(double a, double b, double u) {
  const double total = a / 6 + b / 3;
  const auto mass = [&](double r) { return r * r * (a * (0.5 - r / 3) + b * r / 3); };
  double low = 0, high = 1, r = std::sqrt(u);
  for (int i = 0; i < 64; ++i) {
    const double excess = mass(r) - u * total;
    (excess > 0 ? high : low) = r;
    const double slope = r * ((1 - r) * a + r * b);
    double next = slope > 0 ? r - excess / slope : 0.5 * (low + high);
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (next == r) break;
    r = next;
  }
  return r;
}

/// The unit square onto a triangle so that uniform points become points of the linear density f.
Vec3 to_triangle(const Vec3& f, double u, double v) {
  const double r = inverse_from_corner(f[0], 0.5 * (f[1] + f[2]), u);
  const double at_second = (1 - r) * f[0] + r * f[1], at_third = (1 - r) * f[0] + r * f[2];
  const double t = std::clamp(inverse_linear(at_second, at_third, v), 0.0, 1.0);
  return normalized_barycentric({1 - r, r * (1 - t), r * t});
}

class Sampler {
 public:
  Sampler(const Mesh& mesh, std::span<const double> density, const SampleOptions& options, const JobStage& stage)
      : mesh_(mesh), density_(density), seed_(options.seed), total_(options.count), stage_(stage) {
    // Ratios matter, so the largest is made 1: masses neither overflow nor vanish.
    if (!density.empty()) largest_ = *std::max_element(density.begin(), density.end());
  }

  /// Linear density at the corners of a face.
  Vec3 corners(Index face) const {
    if (density_.empty()) return Vec3::Ones();
    const Triangle& t = mesh_.triangles()[face];
    return Vec3(density_[t[0]], density_[t[1]], density_[t[2]]) / largest_;
  }

  double mass(Index face) const { return mesh_.face_area(face) * (corners(face).sum() / 3); }

  /// Adds `count` points on faces in the order given, whose masses sum to more than 0.
  void add(std::span<const Index> faces, Index count, SurfacePoints& points) const {
    double total = 0;
    for (const Index face : faces) total += mass(face);
    const double step = total / count;
    const double offset = uniform(seed_, static_cast<std::uint64_t>(faces.front()));
    double passed = 0;
    Index done = 0, last = k_none;
    for (const Index face : faces) {
      const double own = mass(face);
      if (own <= 0) continue;
      last = face;
      passed += own;
      Index here = 0;
      while (done + here < count && (done + here + offset) * step < passed) ++here;
      place(face, here, points);
      done += here;
    }
    place(last, count - done, points);  // rounding of the sum
  }

 private:
  /// `count` points in one face: a Fibonacci lattice, shifted at random.
  void place(Index face, Index count, SurfacePoints& points) const {
    if (count == 0) return;
    constexpr double k_golden = 0.61803398874989485;
    const std::uint64_t key = mixed(seed_, static_cast<std::uint64_t>(face) + (std::uint64_t{1} << 32));
    const double shift_u = uniform(key, 0), shift_v = uniform(key, 1);
    const Vec3 f = corners(face);
    for (Index i = 0; i < count; ++i) {
      if (points.size() % k_chunk == 0) stage_.update(static_cast<double>(points.size()) / total_);
      const double v = shift_v + i * k_golden;
      points.push_back({face, to_triangle(f, (i + shift_u) / count, v - std::floor(v))});
    }
  }

  const Mesh& mesh_;
  std::span<const double> density_;
  std::uint64_t seed_;
  Index total_;
  const JobStage& stage_;
  double largest_ = 1;
};

void check(const Mesh& mesh, const SampleOptions& options) {
  if (options.count < 1) throw InputError(message("count is ", options.count, ", but must be at least 1"));
  const std::span<const double> density = options.density;
  if (!density.empty()) {
    if (density.size() != static_cast<std::size_t>(mesh.vertex_count()))
      throw InputError(
          message("density has ", density.size(), " values, but the mesh has ", mesh.vertex_count(), " vertices"));
    double largest = 0;
    for (std::size_t i = 0; i < density.size(); ++i) {
      if (!std::isfinite(density[i]))
        throw InputError(message("density: value ", density[i], " at [", i, "] is not finite"));
      if (density[i] < 0) throw InputError(message("density: value ", density[i], " at [", i, "] is negative"));
      largest = std::max(largest, density[i]);
    }
    if (largest == 0) throw InputError("density is zero everywhere: no place is left for a point");
  }
  if (options.one_per_component && options.count < mesh.component_count())
    throw InputError(message("count is ", options.count, ", fewer than the ", mesh.component_count(),
                             " connected components that are to get a point each"));
}

/// Faces along a Hilbert curve through their centers.
std::vector<Index> ordered_faces(const Mesh& mesh, const JobStage& stage) {
  const HilbertCurve curve(mesh.positions());
  std::vector<std::uint64_t> keys(static_cast<std::size_t>(mesh.face_count()));
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (f % k_chunk == 0) stage.check();
    keys[f] = curve.key(position(mesh, {f, Vec3::Constant(1.0 / 3)}));
  }
  return order_of(keys, 1, stage);
}

/// Whole numbers of at least 1 that sum to count, as near to proportion as that allows (largest remainders).
std::vector<Index> shares(const std::vector<double>& masses, Index count) {
  const std::size_t parts = masses.size();
  std::vector<std::uint8_t> raised(parts, 0);  // parts whose proportion is less than one point
  double mass = 0;
  Index left = count;
  for (bool changed = true; changed;) {
    changed = false;
    mass = 0;
    for (std::size_t i = 0; i < parts; ++i) mass += raised[i] ? 0.0 : masses[i];
    const Index shared = left;
    for (std::size_t i = 0; i < parts; ++i) {
      if (raised[i] || masses[i] * shared >= mass) continue;
      raised[i] = 1, changed = true, --left;
    }
  }
  std::vector<Index> result(parts, 1);
  std::vector<std::pair<double, std::size_t>> behind;  // what rounding down took, most first
  Index given = count - left;
  for (std::size_t i = 0; i < parts; ++i) {
    const double quota = raised[i] ? 1.0 : std::max(1.0, masses[i] / mass * left);
    result[i] = static_cast<Index>(quota);
    given += raised[i] ? 0 : result[i];
    behind.push_back({result[i] - quota, i});
  }
  std::sort(behind.begin(), behind.end());
  for (std::size_t k = 0; given < count; ++k, ++given) ++result[behind[k % parts].second];
  return result;
}

SurfacePoints sample_components(const Mesh& mesh, const SampleOptions& options, const std::vector<Index>& faces,
                                const JobStage& stage) {
  const auto component_of = [&](Index face) { return mesh.component_of(mesh.triangles()[face][0]); };
  std::vector<std::vector<Index>> parts(static_cast<std::size_t>(mesh.component_count()));
  for (const Index face : faces) parts[component_of(face)].push_back(face);
  const Sampler painted(mesh, options.density, options, stage), plain(mesh, {}, options, stage);
  std::vector<double> masses(parts.size(), 0.0);
  for (std::size_t c = 0; c < parts.size(); ++c)
    for (const Index face : parts[c]) masses[c] += painted.mass(face);
  const std::vector<Index> counts = shares(masses, options.count);
  SurfacePoints points;
  points.reserve(static_cast<std::size_t>(options.count));
  for (std::size_t c = 0; c < parts.size(); ++c) (masses[c] > 0 ? painted : plain).add(parts[c], counts[c], points);
  return points;
}

}  // namespace

SurfacePoints sample(const Mesh& mesh, const SampleOptions& options) {
  check(mesh, options);
  const JobStage whole(options.job, "Sampling"), stage = whole.part(0.2, 1);
  const std::vector<Index> faces = ordered_faces(mesh, whole);
  SurfacePoints points;
  if (options.one_per_component && mesh.component_count() > 1) {
    points = sample_components(mesh, options, faces, stage);
  } else {
    points.reserve(static_cast<std::size_t>(options.count));
    Sampler(mesh, options.density, options, stage).add(faces, options.count, points);
  }
  whole.update(1);
  return points;
}

SurfacePoints sample(const Mesh& mesh, Index count, std::span<const double> density, std::uint64_t seed) {
  return sample(mesh, {.count = count, .density = density, .seed = seed});
}

}  // namespace saddleback
