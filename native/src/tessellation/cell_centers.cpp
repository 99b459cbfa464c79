// Centers of cells: the cell's faces are placed in the tangent plane of a point, which moves to the mean of the cell
// there, until it stays.

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "saddleback/tessellation/geodesic_center.h"

#include "support/only_ratios.h"
#include "support/threads/parallel.h"
#include "tessellation/cells/quadrature.h"
#include "tessellation/log_map/patch_log.h"
#include "tessellation/log_map/tangent_moves.h"
#include "tessellation/relaxation/diagram.h"

namespace saddleback {
namespace {

// The tolerance of a step, relative to the size of the cell: the maps themselves are right to 1e-4 or so.
constexpr double k_tolerance = 1e-6;
constexpr int k_most_steps = 50;
// A step this short, relative to the size of the cell, leaves the ways to all corners but a few as they are.
constexpr double k_short_step = 2e-3;
// Steps shrink several times each, until they are what the maps from two places differ by.
constexpr double k_least_shrinking = 0.5;

/// The triangles of every cell, in the faces that they lie in.
class CellTriangles {
 public:
  explicit CellTriangles(const GeodesicVoronoi& cells) : cells_(cells), first_(cells.areas.size() + 1, 0) {
    const auto faces = static_cast<Index>(cells.face_cell.size());
    const auto each = [&](auto&& visit) {
      for (Index face = 0; face < faces; ++face)
        if (cells.face_cell[face] != k_none) visit(cells.face_cell[face], face);
      for (Index i = 0; i < static_cast<Index>(cells.pieces.size()); ++i) visit(cells.pieces[i].cell, ~i);
    };
    each([&](Index cell, Index) { ++first_[cell + 1]; });
    for (std::size_t cell = 0; cell < cells.areas.size(); ++cell) first_[cell + 1] += first_[cell];
    parts_.resize(first_.back());
    std::vector<Index> next(first_.begin(), first_.end() - 1);
    each([&](Index cell, Index part) { parts_[next[cell]++] = part; });
  }

  /// Visits (face, a, b, c) with barycentric coordinates.
  template <class Visit>
  void visit(Index cell, Visit&& visit) const {
    for (Index i = first_[cell]; i < first_[cell + 1]; ++i) {
      if (parts_[i] >= 0) {
        visit(parts_[i], Vec3(Vec3::Unit(0)), Vec3(Vec3::Unit(1)), Vec3(Vec3::Unit(2)));
        continue;
      }
      const GeodesicVoronoi::Piece& piece = cells_.pieces[~parts_[i]];
      const Vec3* const corner = &cells_.piece_barycentric[piece.first];
      for (Index j = 1; j + 1 < piece.count; ++j) visit(piece.face, corner[0], corner[j], corner[j + 1]);
    }
  }

 private:
  const GeodesicVoronoi& cells_;
  std::vector<Index> first_, parts_;  ///< of each cell: a face, or ~ of a piece
};

/// One cell as weighted barycentric sums: its mean in a tangent plane is that of the corners of its faces.
class CellMass {
 public:
  /// Begins with another cell, in the memory of the last.
  void begin(const Mesh& mesh, const CellTriangles& triangles, Index cell, std::span<const double> density) {
    parts_.clear();
    order_.clear();
    mass_ = 0;
    triangles.visit(cell, [&](Index face, const Vec3& a, const Vec3& b, const Vec3& c) {
      order_.emplace_back(face, static_cast<Index>(parts_.size()));
      parts_.push_back(share(mesh, face, density, a, b, c));
      mass_ += parts_.back().sum();
    });
    merge();
  }

  double mass() const { return mass_; }
  const std::vector<Index>& faces() const { return faces_; }
  Vec2 mean(const PatchLog& log) const {
    Vec2 sum = Vec2::Zero();
    for (std::size_t i = 0; i < faces_.size(); ++i)
      for (int corner = 0; corner < 3; ++corner) sum += shares_[i][corner] * log.log(static_cast<Index>(i), corner);
    return sum / mass_;
  }
  Vec3 mean_in_space(const Mesh& mesh) const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const Triangle& corners = mesh.triangles()[faces_[i]];
      for (int corner = 0; corner < 3; ++corner) sum += shares_[i][corner] * mesh.positions()[corners[corner]];
    }
    return sum / mass_;
  }

 private:
  static Vec3 share(const Mesh& mesh, Index face, std::span<const double> density, const Vec3& a, const Vec3& b,
                    const Vec3& c) {
    const double area = mesh.face_area(face) * a.dot(b.cross(c));
    if (density.empty()) return area / 3 * (a + b + c);
    const Triangle& t = mesh.triangles()[face];
    const Vec3 painted(density[t[0]], density[t[1]], density[t[2]]);
    Vec3 sum = Vec3::Zero();
    for (const QuadraturePoint& q : k_quartic) {
      const Vec3 x = at(q, a, b, c);
      const double value = painted.dot(x);
      sum += area * q.weight * value * value * x;
    }
    return sum;
  }

  /// Each face once, in increasing order: those that the cell owns whole, and then those of its pieces, are so already.
  void merge() {
    const auto middle = std::ranges::is_sorted_until(order_);
    std::ranges::inplace_merge(order_, middle);
    if (!std::ranges::is_sorted(order_)) std::ranges::sort(order_);
    faces_.clear();
    shares_.clear();
    for (const auto& [face, part] : order_) {
      if (faces_.empty() || faces_.back() != face) {
        faces_.push_back(face);
        shares_.push_back(parts_[part]);
      } else {
        shares_.back() += parts_[part];
      }
    }
  }

  std::vector<Vec3> parts_;                     ///< shares of a triangle each
  std::vector<std::pair<Index, Index>> order_;  ///< their faces and numbers
  std::vector<Index> faces_;
  std::vector<Vec3> shares_;  ///< by corner
  double mass_ = 0;
};

/// The vertex that a point of a face is as good as at: past one as near as that the ways to all others are told apart
/// from those by it by rounding alone, and would take its direction. The point where there is none.
SurfacePoint at_vertex_within(const Mesh& mesh, const SurfacePoint& point, double reach) {
  const FaceChart chart(mesh, point.face);
  const Vec2 at = chart.to_plane(point.barycentric);
  for (int i = 0; i < 3; ++i)
    if ((chart.corner[i] - at).norm() <= reach) return {point.face, Vec3::Unit(i)};
  return point;
}

/// Returns where the search for the center begins: as far from the site as the cell's mean in space is, which mostly
/// makes a map of the cell unnecessary; the site if that place is not in the cell.
SurfacePoint first_place(const Mesh& mesh, const CellMass& cell, const SurfacePoint& site, double size) {
  if (mesh.is_intrinsic() || vertex_at(mesh, site) != k_none) return site;
  const Vec2 step = in_chart(mesh, site.face, cell.mean_in_space(mesh) - position(mesh, site));
  if (!(step.norm() < size)) return site;
  const SurfacePoint moved = move_sites(mesh, {site}, {step}, 1).sites.front();
  return std::ranges::binary_search(cell.faces(), moved.face) ? moved : site;
}

SurfacePoint center_of(const Mesh& mesh, const CellMass& cell, PatchLog& log, const SurfacePoint& site, double size,
                       const JobStage& stage) {
  if (!(cell.mass() > 0)) return site;
  log.begin(cell.faces());
  const double reach = k_tolerance * size / 2;
  SurfacePoint place = at_vertex_within(mesh, first_place(mesh, cell, site, size), reach);
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i < k_most_steps; ++i) {
    stage.check();
    const bool is_near = before <= k_short_step * size;
    if (!(is_near && log.run_again(place)) && !log.run(place)) break;
    const Vec2 step = cell.mean(log);
    const double length = step.norm();
    if (length <= k_tolerance * size || length > k_least_shrinking * before) break;
    const double next_length = length * (length / before);  // as long as the next step will be, going by these two
    before = length;
    const SurfacePoint next = move_sites(mesh, {place}, {step}, 1).sites.front();
    if (!std::ranges::binary_search(cell.faces(), next.face)) break;  // the cell bends round what is not its own
    place = at_vertex_within(mesh, next, reach);
    if (i > 0 && next_length <= k_tolerance * size) break;
  }
  return place;
}

}  // namespace

SurfacePoints cell_centers(const Mesh& mesh, const GeodesicVoronoi& cells, std::span<const double> density, int threads,
                           Job* job) {
  check_density(mesh, density);
  const OnlyRatios weights(density);
  const JobStage stage(job, "Finding the centers of cells");
  const CellTriangles triangles(cells);
  const auto count = static_cast<Index>(cells.areas.size());
  SurfacePoints centers(count);
  struct alignas(k_apart) Worker {
    explicit Worker(const Mesh& mesh) : log(mesh) {}
    CellMass mass;
    PatchLog log;
  };
  std::vector<Worker> workers(thread_count(threads), Worker(mesh));
  parallel_for(count, threads, 8, [&](Index cell, int thread) {
    stage.check();
    auto& [mass, log] = workers[thread];
    mass.begin(mesh, triangles, cell, weights.values());
    centers[cell] = center_of(mesh, mass, log, cells.sites[cell], std::sqrt(cells.areas[cell]), stage);
  });
  stage.update(1);
  return centers;
}

}  // namespace saddleback
