#include "saddleback/geodesics/exact_distances.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/error.h"

#include "geodesics/exact/exact_path.h"
#include "geodesics/exact/exact_propagation.h"
#include "geodesics/exact/exact_windows.h"
#include "geodesics/exact/ways_to_face.h"

namespace saddleback {
namespace {

// A barycentric distance: rays from nearer to a vertex cannot be told apart from its own.
constexpr double k_at_vertex = 1e-12;
constexpr double k_infinity = std::numeric_limits<double>::infinity();
constexpr const char* k_text = "Measuring exact distances";
// Shares of the time until the surface is laid out, and until windows are propagated where they are sorted afterwards.
constexpr double k_laid_out = 0.05, k_propagated = 0.75;

SurfacePoints snapped_to_vertices(SurfacePoints points) {
  for (SurfacePoint& point : points)
    for (int i = 0; i < 3; ++i)
      if (point.barycentric[i] >= 1 - k_at_vertex) point.barycentric = Vec3::Unit(i);
  return points;
}

void check(const Mesh& mesh, const SurfacePoints& sources, double limit) {
  if (sources.empty()) throw InputError("sources: wanted at least one source, got none");
  check_surface_points(mesh, sources, "sources");
  if (std::isnan(limit) || limit < 0) throw InputError(message("limit: wanted a distance of 0 or more, got ", limit));
}

std::vector<double> distances_of(const ExactSurface& surface, const ExactPropagation& propagation) {
  std::vector<double> result(surface.mesh().vertex_count(), k_infinity);
  for (Index v = 0; v < surface.vertex_count(); ++v) result[surface.mesh_vertex(v)] = propagation.distance(v);
  return result;
}

std::vector<Index> owners_of(const ExactSurface& surface, const ExactPropagation& propagation) {
  std::vector<Index> result(surface.mesh().vertex_count(), k_none);
  for (Index v = 0; v < surface.vertex_count(); ++v)
    if (std::isfinite(propagation.distance(v))) result[surface.mesh_vertex(v)] = propagation.owner(v);
  return result;
}

}  // namespace

std::vector<double> exact_distances(const Mesh& mesh, const SurfacePoints& given, double limit, Job* job) {
  check(mesh, given, limit);
  const SurfacePoints sources = snapped_to_vertices(given);
  const JobStage stage(job, k_text);
  const ExactSurface surface(mesh, sources, stage.part(0, k_laid_out));
  ExactPropagation propagation(surface, sources, {.limit = limit});
  propagation.run(stage.part(k_laid_out, 1));
  return distances_of(surface, propagation);
}

NearestField exact_nearest(const Mesh& mesh, const SurfacePoints& given, double limit, Job* job) {
  check(mesh, given, limit);
  const SurfacePoints sources = snapped_to_vertices(given);
  const JobStage stage(job, k_text);
  const ExactSurface surface(mesh, sources, stage.part(0, k_laid_out));
  ExactPropagation propagation(surface, sources, {.limit = limit, .break_ties = sources.size() > 1});
  propagation.run(stage.part(k_laid_out, 1));
  return {distances_of(surface, propagation), owners_of(surface, propagation)};
}

struct ExactField::Parts {
  Parts(const Mesh& mesh, const SurfacePoints& given, const JobStage& stage)
      : sources(snapped_to_vertices(given)),
        surface(mesh, sources, stage.part(0, k_laid_out)),
        propagation(surface, sources, {.break_ties = sources.size() > 1, .keep_windows = true}),
        windows((propagation.run(stage.part(k_laid_out, k_propagated)),
                 KeptWindows(surface, propagation, stage.part(k_propagated, 1)))),
        tracer(surface, sources, propagation, windows),
        distances(distances_of(surface, propagation)),
        nearest(owners_of(surface, propagation)) {
    propagation.release();
  }

  const SurfacePoints sources;
  const ExactSurface surface;
  ExactPropagation propagation;
  const KeptWindows windows;
  const ExactTracer tracer;
  const std::vector<double> distances;
  const std::vector<Index> nearest;
};

ExactField::ExactField(const Mesh& mesh, const SurfacePoints& sources, Job* job)
    : ExactField(mesh, sources, JobStage(job, k_text)) {}

ExactField::ExactField(const Mesh& mesh, const SurfacePoints& sources, const JobStage& stage) {
  check(mesh, sources, k_infinity);
  parts_ = std::make_unique<Parts>(mesh, sources, stage);
}

ExactField::~ExactField() = default;
ExactField::ExactField(ExactField&&) noexcept = default;

const Mesh& ExactField::mesh() const { return parts_->surface.mesh(); }
std::span<const double> ExactField::distances() const { return parts_->distances; }
std::span<const Index> ExactField::nearest() const { return parts_->nearest; }
std::int64_t ExactField::window_count() const { return parts_->propagation.window_count(); }

std::size_t ExactField::nbytes() const {
  const std::size_t vertices = parts_->distances.size();
  return parts_->windows.nbytes() + parts_->surface.nbytes() + parts_->propagation.nbytes() +
         vertices * (sizeof(double) + sizeof(Index));
}

std::vector<double> ExactField::distance_to(const SurfacePoints& points, Job* job) const {
  check_surface_points(mesh(), points, "points");
  const JobStage stage(job, "Measuring distances of points");
  std::vector<double> result;
  result.reserve(points.size());
  for (const SurfacePoint& point : points) {
    stage.update(static_cast<double>(result.size()) / static_cast<double>(points.size()));
    result.push_back(parts_->tracer.approach(point).distance);
  }
  stage.update(1);
  return result;
}

ExactField::Sight ExactField::nearest_at(const SurfacePoint& point) const {
  const Approach approach = parts_->tracer.approach(point);
  if (!std::isfinite(approach.distance)) return {k_none, approach.distance};
  return {parts_->propagation.owner(approach.root), approach.distance};
}

WaysToFace ExactField::ways_to(Index face) const {
  return {parts_->surface, parts_->propagation, parts_->windows, parts_->nearest, face};
}

Vec2 ExactField::place_of(const SurfacePoint& point) const { return parts_->tracer.place_of(point); }

GeodesicPath ExactField::path(const SurfacePoint& target) const { return std::move(paths({target}).front()); }

std::vector<GeodesicPath> ExactField::paths(const SurfacePoints& targets, Job* job) const {
  check_surface_points(mesh(), targets, "targets");
  for (std::size_t i = 0; i < targets.size(); ++i)
    if (const Index corner = mesh().triangles()[targets[i].face][0]; !std::isfinite(parts_->distances[corner]))
      throw InputError(message("targets: point ", i, " lies in face ", targets[i].face, ", which no source reaches"));
  const JobStage stage(job, "Following shortest paths");
  std::vector<GeodesicPath> result;
  result.reserve(targets.size());
  // A path takes as long as it crosses edges, and some more.
  constexpr double k_edges_more = 20;
  const auto likely = [&](const SurfacePoint& target) {
    return k_edges_more + parts_->distances[mesh().triangles()[target.face][0]] / mesh().mean_edge_length();
  };
  double all = 0, done = 0;
  for (const SurfacePoint& target : targets) all += likely(target);
  for (const SurfacePoint& target : targets) {
    stage.update(done / all);
    result.push_back(parts_->tracer.path(target));
    done += likely(target);
  }
  stage.update(1);
  return result;
}

}  // namespace saddleback
