#include "geodesics/exact/exact_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "geodesics/unfolding/tips.h"
#include "geodesics/unfolding/unfolding.h"
#include "mesh/tables/hilbert.h"
#include "support/key_order.h"

namespace saddleback {
namespace {

// Corner angles add up to a flat vertex's 2 pi within some 1e-15 a corner; a sharper saddle must be a bend, because the
// gap that it leaves between the windows on its two sides grows with distance.
constexpr double k_flat_tolerance = 1e-12;
// Barycentric. Rays from nearer to a vertex, which pass it on both sides, are as far as this from telling all their
// directions; what is seen from the vertex instead is no more than twice this too far.
constexpr double k_beside = 1e-8;
constexpr Index k_check = 1 << 12;  ///< vertices or half-edges: less than a millisecond

/// Returns the vertices of the components with sources, ascending.
std::vector<Index> vertices_with_sources(const Mesh& mesh, const SurfacePoints& sources) {
  std::vector<bool> is_held(mesh.component_count(), false);
  for (const SurfacePoint& source : sources) is_held[mesh.component_of(mesh.triangles()[source.face][0])] = true;
  std::vector<Index> result;
  result.reserve(mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (is_held[mesh.component_of(v)]) result.push_back(v);
  return result;
}

/// A point that is no vertex as a point of each face that it lies in.
SurfacePoints in_each_face(const Mesh& mesh, const SurfacePoint& point) {
  const Vec3 b = normalized_barycentric(point.barycentric);
  SurfacePoints result{{point.face, b}};
  for (int i = 0; i < 3; ++i) {
    if (b[i] != 0) continue;
    const Index h = 3 * point.face + (i + 1) % 3, twin = mesh.twin(h);  // the edge opposite corner i
    if (twin == k_none) continue;
    Vec3 there = Vec3::Zero();
    there[twin % 3] = b[Mesh::next(h) % 3];
    there[Mesh::next(twin) % 3] = b[h % 3];
    result.push_back({Mesh::face_of(twin), there});
  }
  return result;
}

}  // namespace

ExactSurface::ExactSurface(const Mesh& mesh, const SurfacePoints& sources, const JobStage& stage) : mesh_(&mesh) {
  constexpr double k_renumbered = 0.2;  // of the time
  renumber(sources, stage.part(0, k_renumbered));
  lay_out(stage.part(k_renumbered, 1));
  place_sources(sources);
}

std::size_t ExactSurface::nbytes() const {
  return frames_.size() * sizeof(EdgeFrame) + beside_.size() * sizeof(SourceBeside) + bends_.size() +
         tip_tangents_.size() * sizeof(double) +
         (vertex_of_.size() + face_of_.size() + mesh_vertex_.size() + mesh_face_.size() + first_beside_.size()) *
             sizeof(Index);
}

void ExactSurface::renumber(const SurfacePoints& sources, const JobStage& stage) {
  const Index faces = mesh_->face_count();
  const HilbertCurve curve(mesh_->positions());
  const std::vector<Index> held = vertices_with_sources(*mesh_, sources);
  const auto vertices = static_cast<Index>(held.size());
  std::vector<std::uint64_t> keys(vertices);
  for (Index v = 0; v < vertices; ++v) {
    if (v % k_check == 0) stage.update(0.5 * v / vertices);
    keys[v] = curve.key(mesh_->position(held[v]));
  }
  mesh_vertex_ = order_of(keys, 1, stage);
  for (Index& v : mesh_vertex_) v = held[v];
  stage.update(0.8);
  vertex_of_.assign(mesh_->vertex_count(), k_none);
  for (Index v = 0; v < vertices; ++v) vertex_of_[mesh_vertex_[v]] = v;
  // A face comes with the first of its vertices: a counting sort, stable in the mesh's order.
  const auto first_corner = [&](Index face) {
    const Triangle& t = mesh_->triangles()[face];
    return std::min({vertex_of_[t[0]], vertex_of_[t[1]], vertex_of_[t[2]]});
  };
  std::vector<Index> begins(vertices + 1, 0);
  const auto is_held = [&](Index face) { return vertex_of_[mesh_->triangles()[face][0]] != k_none; };
  for (Index f = 0; f < faces; ++f)
    if (is_held(f)) ++begins[first_corner(f) + 1];
  for (Index v = 0; v < vertices; ++v) begins[v + 1] += begins[v];
  face_of_.assign(faces, k_none);
  mesh_face_.resize(begins[vertices]);
  for (Index f = 0; f < faces; ++f) {
    if (!is_held(f)) continue;
    face_of_[f] = begins[first_corner(f)]++;
    mesh_face_[face_of_[f]] = f;
  }
}

void ExactSurface::lay_out(const JobStage& stage) {
  const Mesh& mesh = *mesh_;
  const auto halfedges = static_cast<Index>(3 * mesh_face_.size());
  frames_.reserve(halfedges);
  const auto beyond = [&](Index h) { return mesh.twin(h) == k_none ? k_none : halfedge_of(mesh.twin(h)); };
  for (Index h = 0; h < halfedges; ++h) {
    if (h % k_check == 0) stage.update(static_cast<double>(h) / halfedges);
    EdgeFrame& frame = frames_.emplace_back();
    const Index g = mesh_halfedge(h), next = Mesh::next(g), prev = Mesh::prev(g);
    frame.length = mesh.length(g);
    frame.left_length = mesh.length(prev);
    frame.right_length = mesh.length(next);
    const UnfoldedFace face = unfold(mesh, g);
    frame.apex_x = face.apex.x();
    frame.apex_y = face.apex.y();
    frame.to_end_rest = static_cast<float>((face.to_end - (frame.length - frame.apex_x)) / frame.length);
    frame.left = beyond(prev);
    frame.right = beyond(next);
    frame.from = vertex_of_[mesh.from(g)];
    frame.to = vertex_of_[mesh.to(g)];
    frame.apex = vertex_of_[mesh.apex(g)];
  }
  bends_.resize(mesh_vertex_.size());
  for (Index v = 0; v < vertex_count(); ++v) {
    const Index original = mesh_vertex_[v];
    const bool bends =
        mesh.is_boundary(original) || mesh.total_angle(original) > 2 * std::numbers::pi + k_flat_tolerance;
    bends_[v] = bends ? Bends::at_pi : Bends::never;
    const double tangent = saddleback::tangent_of_tip(mesh, original);
    if (!std::isfinite(tangent)) continue;
    tip_tangents_.resize(vertex_count(), std::numeric_limits<double>::infinity());
    tip_tangents_[v] = tangent;
  }
}

void ExactSurface::place_sources(const SurfacePoints& sources) {
  for (Index i = 0; i < static_cast<Index>(sources.size()); ++i) {
    if (vertex_at(*mesh_, sources[i]) != k_none) continue;
    for (const SurfacePoint& place : in_each_face(*mesh_, sources[i])) {
      in_faces_.push_back({face_of_[place.face], i, place.barycentric});
      for (int corner = 0; corner < 3; ++corner) {
        if (place.barycentric[corner] >= 1 - k_beside)
          bends_[vertex_of_[mesh_->triangles()[place.face][corner]]] = Bends::all_round;
      }
    }
  }
  std::stable_sort(in_faces_.begin(), in_faces_.end(),
                   [](const SourceInFace& a, const SourceInFace& b) { return a.face < b.face; });
  if (!in_faces_.empty()) first_beside_.assign(frames_.size(), k_none);
  const auto add_beside = [&](Index h, const Vec2& place, Index source) {
    beside_.push_back({place, source, first_beside_[h]});
    first_beside_[h] = static_cast<Index>(beside_.size()) - 1;
  };
  beside_.reserve(6 * in_faces_.size());
  for (const SourceInFace& place : in_faces_) {
    for (Index h = 3 * place.face; h < 3 * place.face + 3; ++h) {
      const Vec2 there = in_frame(h, place.barycentric);
      add_beside(h, there, place.source);
      if (twin(h) != k_none) add_beside(twin(h), {frames_[h].length - there.x(), -there.y()}, place.source);
    }
  }
}

std::span<const SourceInFace> ExactSurface::sources_in(Index face) const {
  if (!has_sources_beside(3 * face)) return {};
  const auto [begin, end] =
      std::equal_range(in_faces_.begin(), in_faces_.end(), SourceInFace{face, 0, {}},
                       [](const SourceInFace& a, const SourceInFace& b) { return a.face < b.face; });
  return {begin, end};
}

}  // namespace saddleback
