// A vertex is a fan of corners that hang together over glued edges. A fan keeps the smallest of its corners' own
// vertices that no fan before it took, so that repairing a repaired mesh gives every copy its number back; where all
// are taken it gets a new copy. Two fans may then still be joined by several edges, which index triples cannot express:
// all but one of those are divided in their middle.

#include <unordered_map>
#include <utility>

#include "saddleback/mesh/mesh.h"

#include "mesh/repair/repair_steps.h"
#include "mesh/tables/edge_table.h"

namespace saddleback {
namespace {

// Reverses the corners of the faces that are to be turned over: half-edge i becomes 2 - i.
void turn_faces(Sheets& sheets) {
  const auto renumber = [&](Index h) {
    return h == k_none ? k_none : sheets.turned[h / 3] ? h / 3 * 3 + 2 - h % 3 : h;
  };
  std::vector<Index> twins(sheets.twins.size());
  for (Index h = 0; h < static_cast<Index>(twins.size()); ++h) twins[renumber(h)] = renumber(sheets.twins[h]);
  sheets.twins = std::move(twins);
  for (std::size_t i = 0; i < sheets.faces.size(); ++i) {
    if (!sheets.turned[i]) continue;
    std::swap(sheets.fine[i][1], sheets.fine[i][2]);
    std::swap(sheets.coarse[i][1], sheets.coarse[i][2]);
  }
}

class FanSeparator {
 public:
  FanSeparator(RepairState& state, Sheets& sheets, const JobStage& stage)
      : state_(state),
        sheets_(sheets),
        stage_(stage),
        taken_(state.positions.size(), 0),
        homes_(state.positions.size(), k_none),
        cluster_homes_(state.positions.size(), k_none) {}

  std::vector<Index> run() {
    const Index corners = static_cast<Index>(sheets_.twins.size());
    std::vector<Triangle> result(sheets_.fine.size(), {k_none, k_none, k_none});
    std::vector<Index> fan;
    for (Index corner = 0; corner < corners; ++corner) {
      stage_.check();
      if (result[corner / 3][corner % 3] != k_none) continue;
      collect(corner, fan);
      const Index vertex = take_vertex(fan);
      for (const Index c : fan) result[c / 3][c % 3] = vertex;
    }
    // Vertices whose faces all fell away stand where their cluster stands.
    for (std::size_t v = 0; v < homes_.size(); ++v)
      if (homes_[v] == k_none) homes_[v] = cluster_homes_[state_.cluster[v]];
    sheets_.fine = std::move(result);
    return std::move(homes_);
  }

 private:
  Index fine(Index corner) const { return sheets_.fine[corner / 3][corner % 3]; }

  // All corners of the fan, counter-clockwise from its clockwise end.
  void collect(Index corner, std::vector<Index>& fan) const {
    Index start = corner;
    for (Index h = sheets_.twins[corner]; h != k_none; h = sheets_.twins[start]) {
      start = Mesh::next(h);
      if (start == corner) break;
    }
    fan.clear();
    for (Index h = start; h != k_none; h = sheets_.twins[Mesh::prev(h)]) {
      if (h == start && !fan.empty()) break;
      fan.push_back(h);
    }
  }

  Index take_vertex(const std::vector<Index>& fan) {
    Index vertex = k_none;
    for (const Index c : fan)
      if (!taken_[fine(c)] && (vertex == k_none || fine(c) < vertex)) vertex = fine(c);
    const Index leader = sheets_.coarse[fan[0] / 3][fan[0] % 3];
    if (vertex == k_none) {
      vertex = state_.add_vertex(state_.positions[leader], fine(fan[0]));
      state_.count("vertices_split");
    } else {
      taken_[vertex] = 1;
      state_.positions[vertex] = state_.positions[leader];
      homes_[vertex] = vertex;
    }
    for (const Index c : fan)
      if (homes_[fine(c)] == k_none) homes_[fine(c)] = vertex;
    if (cluster_homes_[leader] == k_none) cluster_homes_[leader] = vertex;
    return vertex;
  }

  RepairState& state_;
  Sheets& sheets_;
  const JobStage& stage_;
  std::vector<std::uint8_t> taken_;
  std::vector<Index> homes_, cluster_homes_;
};

// One edge as it is glued: a pair of half-edges or a single one.
struct Seam {
  Index a, b;                  // its vertices
  std::array<Index, 2> faces;  // in the state; the second may be k_none
};

// Returns, of each set of edges with the same two vertices, all but the first.
std::vector<Seam> surplus_edges(const Sheets& sheets, Index vertex_count, const JobStage& stage) {
  std::vector<Seam> result;
  const EdgeTable edges = build_edge_table(sheets.fine, vertex_count, stage);
  for (Index e = 0; e < edges.edge_count(); ++e) {
    const std::span<const Index> around = edges.edge(e);
    if (around.size() == 1 || (around.size() == 2 && sheets.twins[around[0]] == around[1])) continue;
    const Index a = halfedge_from(sheets.fine, around[0]), b = halfedge_to(sheets.fine, around[0]);
    // Two boundaries that run in opposite directions close by themselves.
    if (around.size() == 2 && halfedge_from(sheets.fine, around[1]) == b) continue;
    bool first = true;
    for (const bool glued : {true, false})
      for (const Index h : around) {
        const Index twin = sheets.twins[h];
        if (glued != (twin != k_none) || (glued && twin < h)) continue;
        if (!std::exchange(first, false))
          result.push_back({a, b, {sheets.faces[h / 3], glued ? sheets.faces[twin / 3] : k_none}});
      }
  }
  return result;
}

// Divides edges; a face may be divided at several, so its parts are remembered.
class Divider {
 public:
  explicit Divider(RepairState& state) : state_(state) {}

  void divide(const Seam& seam) {
    const Vec3 middle = 0.5 * state_.positions[seam.a] + 0.5 * state_.positions[seam.b];
    const Index vertex = state_.add_vertex(middle, k_none);
    state_.count("edges_divided");
    for (const Index face : seam.faces)
      if (face != k_none) divide_face(face, seam.a, seam.b, vertex);
  }

 private:
  static int side_between(const Triangle& t, Index a, Index b) {
    for (int i = 0; i < 3; ++i)
      if ((t[i] == a && t[(i + 1) % 3] == b) || (t[i] == b && t[(i + 1) % 3] == a)) return i;
    return -1;
  }

  void divide_face(Index face, Index a, Index b, Index middle) {
    std::vector<Index>& parts = parts_.try_emplace(face, 1, face).first->second;
    for (std::size_t p = 0; p < parts.size(); ++p) {
      const Triangle t = state_.triangles[parts[p]];
      const int side = side_between(t, a, b);
      if (side < 0) continue;
      Triangle near = t, far = t;
      near[(side + 1) % 3] = middle;
      far[side] = middle;
      state_.triangles[parts[p]] = near;
      parts.push_back(state_.add_face(far));
      return;
    }
  }

  RepairState& state_;
  std::unordered_map<Index, std::vector<Index>> parts_;
};

}  // namespace

std::vector<Index> separate_fans(RepairState& state, Sheets sheets, bool divide, const JobStage& stage) {
  turn_faces(sheets);
  std::vector<Index> homes = FanSeparator(state, sheets, stage).run();
  for (std::size_t i = 0; i < sheets.faces.size(); ++i) state.triangles[sheets.faces[i]] = sheets.fine[i];
  Divider divider(state);
  for (const Seam& seam : surplus_edges(sheets, state.vertex_count(), stage)) {
    if (divide) {
      divider.divide(seam);
      continue;
    }
    for (const Index face : seam.faces)
      if (face != k_none && std::exchange(state.alive[face], std::uint8_t{0})) state.count("faces_dropped");
  }
  for (Index v = 0; v < state.vertex_count(); ++v) state.cluster[v] = v;
  return homes;
}

}  // namespace saddleback
