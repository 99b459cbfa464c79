// Patches as triangles: that none is turned over, that they are the whole shape, and that no sample lies in two.

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "distribution/check/check_parts.h"
#include "predicates/predicates.h"
#include "shape_mapping/sight.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

/// Areas in a shape's plane carry the rounding of corners to 2^-40 of a face, which may be larger than the shape.
constexpr double k_area_rounding = 1e-6;
/// Triangles of less than this share of their face tell nothing about stretch.
constexpr double k_sliver = 1e-6;
/// A sample nearer to a triangle's rim than this may lie on either side.
constexpr double k_rim = 1e-9;
constexpr Index k_chunk = 4096;

struct PatchTriangle {
  Index shape;
  std::array<Vec2, 3> weights;  ///< of corners 1 and 2 of the face
};

/// Triangles of all patches by face.
struct PatchTriangles {
  std::vector<PatchTriangle> triangles;
  FaceBoxes boxes;
};

std::uint64_t mixed(std::uint64_t x) {  // splitmix64 [steele2014]
  x += 0x9e3779b97f4a7c15;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9;
  x = (x ^ (x >> 27)) * 0x94d049bb133111eb;
  return x ^ (x >> 31);
}

double unit_random(std::uint64_t seed, std::uint64_t index) {
  return static_cast<double>(mixed(mixed(seed) ^ index) >> 11) * 0x1p-53;
}

Vec2 weights_in(const Mesh& mesh, const SurfacePoint& point, Index face) {
  const std::optional<Vec3> b = barycentric_in(mesh, point, face);
  return b ? Vec2((*b)[1], (*b)[2]) : Vec2(-1, -1);
}

PatchTriangles by_face(const Mesh& mesh, const CutMesh& patches) {
  PatchTriangles result;
  std::vector<std::size_t> begins(static_cast<std::size_t>(mesh.face_count()) + 1, 0);
  for (const Index face : patches.triangle_face) ++begins[face + 1];
  std::partial_sum(begins.begin(), begins.end(), begins.begin());
  std::vector<std::size_t> next(begins.begin(), begins.end() - 1);
  result.triangles.resize(patches.triangles.size());
  for (std::size_t t = 0; t < patches.triangles.size(); ++t) {
    const Index face = patches.triangle_face[t];
    PatchTriangle& triangle = result.triangles[next[face]++];
    triangle.shape = patches.triangle_shape[t];
    for (int i = 0; i < 3; ++i) triangle.weights[i] = weights_in(mesh, patches.vertices[patches.triangles[t][i]], face);
  }
  result.boxes = FaceBoxes(std::move(begins), [&](std::size_t i) {
    const auto& [a, b, c] = result.triangles[i].weights;
    return Box<Vec2>{a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
  });
  return result;
}

class PatchCheck {
 public:
  PatchCheck(const Mesh& mesh, std::span<const Shape> shapes, std::span<const Placement> placements,
             const CutMesh& patches, FaultList& faults, CheckReport& report)
      : mesh_(mesh), shapes_(shapes), placements_(placements), patches_(patches), faults_(faults), report_(report) {}

  void check_triangles(std::span<const MappedShape> mapped) {
    std::vector<double> areas(placements_.size(), 0);
    double covered = 0;
    report_.smallest = std::numeric_limits<double>::infinity();
    report_.largest = 0;
    for (std::size_t t = 0; t < patches_.triangles.size(); ++t) {
      const Index shape = patches_.triangle_shape[t];
      const Placement& placement = placements_[shape];
      const Vec2 uv[3] = {plane(t, 0), plane(t, 1), plane(t, 2)};
      const double area = 0.5 * cross(uv[1] - uv[0], uv[2] - uv[0]) * (placement.mirrored ? -1 : 1);
      areas[shape] += area;
      const Index face = patches_.triangle_face[t];
      Vec2 w[3];
      for (int i = 0; i < 3; ++i) w[i] = weights_in(mesh_, patches_.vertices[patches_.triangles[t][i]], face);
      const double share = cross(w[1] - w[0], w[2] - w[0]);
      const bool is_upright = predicates::orient_2d({w[0].x(), w[0].y()}, {w[1].x(), w[1].y()}, {w[2].x(), w[2].y()}) ==
                              predicates::Sign::positive;
      if (!is_upright || area < -k_area_rounding * shapes_[placement.shape].area())
        faults_.add(Fault::overturned, shape, k_none, patches_.vertices[patches_.triangles[t][0]]);
      covered += share * mesh_.face_area(face);
      if (share > k_sliver) measure_stretch(t, uv, placement.scale);
    }
    report_.patch_coverage = covered / mesh_.area();
    for (std::size_t i = 0; i < placements_.size(); ++i) {
      const double wanted = shapes_[placements_[i].shape].area();
      if (mapped[i].failure == MapFailure::none && !(std::abs(areas[i] - wanted) <= k_area_rounding * wanted))
        faults_.add(Fault::incomplete, static_cast<Index>(i), k_none, placements_[i].center);
    }
  }

  /// Checks samples that are even by area: the k-th of n samples lies in the k-th of n parts of the surface, in the
  /// order of the faces.
  void check_samples(const CheckOptions& options, const JobStage& stage) {
    const PatchTriangles triangles = by_face(mesh_, patches_);
    std::vector<double> ends(static_cast<std::size_t>(mesh_.face_count()));
    double sum = 0;
    for (Index f = 0; f < mesh_.face_count(); ++f) ends[f] = sum += mesh_.face_area(f);
    const std::int64_t count = options.samples;
    const auto chunks = static_cast<Index>((count + k_chunk - 1) / k_chunk);
    std::vector<std::int64_t> covered(static_cast<std::size_t>(chunks), 0);
    std::vector<FaultList> found(static_cast<std::size_t>(chunks));
    parallel_for(chunks, options.threads, 1, [&](Index chunk, int) {
      std::vector<std::size_t> hits;
      stage.check();
      const std::int64_t end = std::min<std::int64_t>(count, (chunk + std::int64_t{1}) * k_chunk);
      for (std::int64_t k = chunk * std::int64_t{k_chunk}; k < end; ++k) {
        const auto random = [&](std::uint64_t i) {
          return unit_random(options.seed, 3 * static_cast<std::uint64_t>(k) + i);
        };
        const double at = sum * ((static_cast<double>(k) + random(0)) / static_cast<double>(count));
        const auto face = std::min<Index>(
            static_cast<Index>(std::lower_bound(ends.begin(), ends.end(), at) - ends.begin()), mesh_.face_count() - 1);
        Vec2 w(random(1), random(2));
        if (w.x() + w.y() > 1) w = Vec2(1, 1) - w;
        covered[chunk] += look(triangles, face, w, hits, found[chunk]);
      }
    });
    std::int64_t hits = 0;
    for (const std::int64_t part : covered) hits += part;
    for (const FaultList& list : found) faults_.add(list);
    report_.sample_count = count;
    if (count == 0) return;
    report_.coverage = static_cast<double>(hits) / static_cast<double>(count);
    report_.coverage_error = std::sqrt(report_.coverage * (1 - report_.coverage) / static_cast<double>(count));
  }

 private:
  const Vec2& plane(std::size_t t, int i) const { return patches_.vertex_plane[patches_.triangles[t][i]]; }

  void measure_stretch(std::size_t t, const Vec2 (&uv)[3], double scale) {
    const Index face = patches_.triangle_face[t];
    const std::array<Vec3, 3> of_face = mesh_.corners(3 * face);
    Vec3 corner[3];
    for (int i = 0; i < 3; ++i) {
      const SurfacePoint& point = patches_.vertices[patches_.triangles[t][i]];
      const Vec2 w = weights_in(mesh_, point, face);
      corner[i] = mesh_.is_intrinsic() ? Vec3(w.x() * (of_face[1] - of_face[0]) + w.y() * (of_face[2] - of_face[0]))
                                       : position(mesh_, point);
    }
    Eigen::Matrix2d from;
    from << scale * (uv[1] - uv[0]), scale * (uv[2] - uv[0]);
    Eigen::Matrix<double, 3, 2> to;
    to << corner[1] - corner[0], corner[2] - corner[0];
    const Eigen::Matrix2d inverse = from.inverse();
    const Eigen::Matrix2d metric = (to * inverse).transpose() * (to * inverse);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> values(metric, Eigen::EigenvaluesOnly);
    report_.smallest = std::min(report_.smallest, std::sqrt(std::max(0.0, values.eigenvalues()[0])));
    report_.largest = std::max(report_.largest, std::sqrt(values.eigenvalues()[1]));
  }

  /// Returns 1 when the point lies in a patch, else 0.
  static int look(const PatchTriangles& patches, Index face, const Vec2& w, std::vector<std::size_t>& hits,
                  FaultList& found) {
    hits.clear();
    patches.boxes.visit(face, {w, w}, [&](std::size_t t) {
      for (int i = 0; i < 3; ++i) {
        const Vec2 &from = patches.triangles[t].weights[i], edge = patches.triangles[t].weights[(i + 1) % 3] - from;
        if (!(cross(edge, w - from) > k_rim * edge.norm())) return;
      }
      hits.push_back(t);
    });
    std::sort(hits.begin(), hits.end());
    Index first = k_none;
    for (const std::size_t t : hits) {
      const Index shape = patches.triangles[t].shape;
      if (first != k_none && shape != first) found.add(Fault::covered_twice, first, shape, outline_point(face, w));
      first = shape;
    }
    return first != k_none;
  }

  const Mesh& mesh_;
  std::span<const Shape> shapes_;
  std::span<const Placement> placements_;
  const CutMesh& patches_;
  FaultList& faults_;
  CheckReport& report_;
};

}  // namespace

void check_patches(const Mesh& mesh, std::span<const Shape> shapes, std::span<const Placement> placements,
                   std::span<const MappedShape> mapped, const CheckOptions& options, const JobStage& stage,
                   FaultList& faults, CheckReport& report) {
  const CutMesh patches = cut_shapes(mesh, mapped, CutPart::shapes);
  stage.update(0.3);
  report.triangle_count = static_cast<std::int64_t>(patches.triangles.size());
  PatchCheck check(mesh, shapes, placements, patches, faults, report);
  check.check_triangles(mapped);
  stage.update(0.5);
  check.check_samples(options, stage);
}

}  // namespace saddleback
