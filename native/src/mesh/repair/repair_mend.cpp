// Faces without area. A needle (one edge of no length next to the others) loses that edge; a cap (the apex on its long
// edge) is flipped, which puts the apex into the neighbor's edge: no crack opens and no vertex moves. Both are done
// only where OpenMesh finds them safe and they lead on: fewer faces, fewer without area, or a shorter edge between two
// of them.

#include <algorithm>
#include <array>

#include "mesh/repair/repair_steps.h"
#include "mesh/tables/face_shape.h"
#include "mesh/tables/halfedges.h"

namespace saddleback {
namespace {

using OpenMesh::EdgeHandle;
using OpenMesh::FaceHandle;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

class AreaMender {
 public:
  explicit AreaMender(RepairState& state) : state_(state), faces_(state.live_faces()) {
    std::vector<Index> number(state.positions.size(), k_none);
    std::vector<Triangle> triangles;
    for (const Index f : faces_) {
      Triangle t = state.triangles[f];
      for (Index& v : t) {
        if (number[v] == k_none) {
          number[v] = static_cast<Index>(vertices_.size());
          vertices_.push_back(v);
        }
        v = number[v];
      }
      triangles.push_back(t);
    }
    fill_halfedges(mesh_, triangles, static_cast<Index>(vertices_.size()));
  }

  void run(std::vector<Index> flat, const JobStage& stage) {
    for (int round = 0; round < k_rounds && !flat.empty(); ++round) {
      stage.check();
      longest_first(flat);
      bool progress = false;
      for (const Index f : flat) progress = (is_alive(f) && is_flat(f) && mend(FaceHandle(f))) || progress;
      flat.insert(flat.end(), disturbed_.begin(), disturbed_.end());
      disturbed_.clear();
      std::sort(flat.begin(), flat.end());
      flat.erase(std::unique(flat.begin(), flat.end()), flat.end());
      std::erase_if(flat, [&](Index f) { return !is_alive(f) || !is_flat(f); });
      if (!progress) break;
    }
    for (const Index f : flat) {
      mark(f);
      mesh_.delete_face(FaceHandle(f), false);
    }
    state_.count("faces_dropped", static_cast<Index>(flat.size()));
    write_back();
  }

  std::vector<Index> flat_faces() const {
    std::vector<Index> flat;
    for (Index f = 0; f < static_cast<Index>(faces_.size()); ++f)
      if (is_flat(f)) flat.push_back(f);
    return flat;
  }

 private:
  const Vec3& place(VertexHandle v) const { return state_.positions[vertices_[v.idx()]]; }
  bool is_alive(Index f) const { return !mesh_.status(FaceHandle(f)).deleted(); }
  bool is_flat(VertexHandle a, VertexHandle b, VertexHandle c) const {
    return is_degenerate_face(place(a), place(b), place(c));
  }
  double length(HalfedgeHandle h) const {
    return (place(mesh_.to_vertex_handle(h)) - place(mesh_.from_vertex_handle(h))).norm();
  }
  std::array<HalfedgeHandle, 3> sides(FaceHandle f) const {
    const HalfedgeHandle h = mesh_.halfedge_handle(f);
    return {h, mesh_.next_halfedge_handle(h), mesh_.prev_halfedge_handle(h)};
  }
  bool is_flat(Index f) const {
    const auto [g, h, i] = sides(FaceHandle(f));
    return is_flat(mesh_.from_vertex_handle(g), mesh_.from_vertex_handle(h), mesh_.from_vertex_handle(i));
  }

  // From the longest down: the neighbor of a cap over its long edge then has no longer one.
  void longest_first(std::vector<Index>& flat) const {
    std::vector<std::pair<double, Index>> order;
    for (const Index f : flat) {
      const auto [g, h, i] = sides(FaceHandle(f));
      order.emplace_back(-std::max({length(g), length(h), length(i)}), f);
    }
    std::sort(order.begin(), order.end());
    std::transform(order.begin(), order.end(), flat.begin(), [](const auto& entry) { return entry.second; });
  }

  void mark(Index f) {
    std::uint8_t& seen = state_.flat[faces_[f]];
    if (!seen) state_.count("faces_without_area");
    seen = 1;
  }

  bool mend(FaceHandle f) {
    std::array<HalfedgeHandle, 3> by_length = sides(f);
    std::sort(by_length.begin(), by_length.end(),
              [&](HalfedgeHandle g, HalfedgeHandle h) { return length(g) < length(h); });
    const double longest = length(by_length[2]);
    const bool is_needle = length(by_length[0]) <= std::max(k_smallest_edge, k_degenerate_height * longest);
    mark(f.idx());
    return is_needle ? collapse(by_length[0]) : flip(by_length[2]);
  }

  // Keeps a boundary vertex where it is, otherwise the smaller number.
  bool collapse(HalfedgeHandle h) {
    const HalfedgeHandle back = mesh_.opposite_halfedge_handle(h);
    const VertexHandle a = mesh_.from_vertex_handle(h), b = mesh_.to_vertex_handle(h);
    const bool away_from_a = mesh_.is_boundary(a) == mesh_.is_boundary(b) ? a.idx() > b.idx() : mesh_.is_boundary(b);
    for (const HalfedgeHandle way : {away_from_a ? h : back, away_from_a ? back : h}) {
      if (!mesh_.is_collapse_ok(way)) continue;
      const VertexHandle gone = mesh_.from_vertex_handle(way), kept = mesh_.to_vertex_handle(way);
      mesh_.collapse(way);
      state_.moved_to[vertices_[gone.idx()]] = vertices_[kept.idx()];
      for (auto face = mesh_.vf_iter(kept); face.is_valid(); ++face) disturbed_.push_back(face->idx());
      return true;
    }
    return false;
  }

  bool flip(HalfedgeHandle h) {
    const EdgeHandle edge = mesh_.edge_handle(h);
    const FaceHandle f = mesh_.face_handle(h), g = mesh_.face_handle(mesh_.opposite_halfedge_handle(h));
    if (!g.is_valid()) {  // on the boundary its other two edges take over
      mesh_.delete_face(f, false);
      return true;
    }
    if (!mesh_.is_flip_ok(edge)) return false;
    const VertexHandle a = mesh_.from_vertex_handle(h), b = mesh_.to_vertex_handle(h);
    const VertexHandle c = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(h));
    const VertexHandle d = mesh_.to_vertex_handle(mesh_.next_halfedge_handle(mesh_.opposite_halfedge_handle(h)));
    const bool neighbor_flat = is_flat(b, a, d);
    const int before = 1 + neighbor_flat, after = is_flat(a, d, c) + is_flat(d, b, c);
    const bool shorter = neighbor_flat && (place(c) - place(d)).norm() < length(h);
    if (after > before || (after == before && !shorter)) return false;
    mesh_.flip(edge);
    disturbed_.push_back(f.idx());
    disturbed_.push_back(g.idx());
    return true;
  }

  void write_back() {
    for (Index f = 0; f < static_cast<Index>(faces_.size()); ++f) {
      if (!is_alive(f)) {
        state_.alive[faces_[f]] = 0;
        continue;
      }
      Triangle& t = state_.triangles[faces_[f]];
      Triangle now;
      const std::array<HalfedgeHandle, 3> side = sides(FaceHandle(f));
      for (int i = 0; i < 3; ++i) now[i] = vertices_[mesh_.from_vertex_handle(side[i]).idx()];
      // Keep the first corner first if it is still there.
      const auto first = std::find(now.begin(), now.end(), t[0]);
      if (first != now.end()) std::rotate(now.begin(), first, now.end());
      t = now;
    }
  }

  static constexpr int k_rounds = 64;
  RepairState& state_;
  std::vector<Index> faces_, vertices_;  // OpenMesh's numbers -> the state's
  std::vector<Index> disturbed_;         // faces whose shape changed in this round
  OpenMesh::TriConnectivity mesh_;
};

bool drop_flat(RepairState& state, const std::vector<Index>& flat) {
  for (const Index f : flat) {
    state.alive[f] = 0;
    if (!state.flat[f]) state.count("faces_without_area");
    state.flat[f] = 1;
    state.count("faces_dropped");
  }
  return !flat.empty();
}

}  // namespace

bool mend_areas(RepairState& state, bool patient, const JobStage& stage) {
  std::vector<Index> flat;
  for (const Index f : state.live_faces()) {
    const Triangle& t = state.triangles[f];
    if (is_degenerate_face(state.positions[t[0]], state.positions[t[1]], state.positions[t[2]])) flat.push_back(f);
  }
  if (flat.empty()) return false;
  if (!patient) return drop_flat(state, flat);
  stage.check();
  AreaMender mender(state);
  mender.run(mender.flat_faces(), stage);
  return true;
}

}  // namespace saddleback
