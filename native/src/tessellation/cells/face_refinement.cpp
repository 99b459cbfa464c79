#include "tessellation/cells/face_refinement.h"

#include <algorithm>
#include <tuple>

#include "mesh/tables/flat_face.h"

namespace saddleback {

FaceRefinement::FaceRefinement(const Mesh& mesh) : mesh_(&mesh) {
  for (Index face = 0; face < mesh.face_count(); ++face) {
    Part part{face, mesh.triangles()[face], {Vec3::Unit(0), Vec3::Unit(1), Vec3::Unit(2)}, {},
              {},   mesh.face_area(face)};
    for (int i = 0; i < 3; ++i) {
      const Index twin = mesh.twin(3 * face + i);
      part.beyond[i] = twin == k_none ? k_none : Mesh::face_of(twin);
      part.length[i] = mesh.length(3 * face + i);
    }
    parts_.push_back(part);
  }
}

/// Returns the longest edge, the same one from both sides: edges of equal length are told apart by their ends.
int FaceRefinement::longest_edge(const Part& part) const {
  const auto key = [&](int i) {
    const Index a = part.corner[i], b = part.corner[(i + 1) % 3];
    return std::tuple(part.length[i], std::min(a, b), std::max(a, b));
  };
  int longest = key(0) < key(1) ? 1 : 0;
  if (key(longest) < key(2)) longest = 2;
  return longest;
}

int FaceRefinement::edge_towards(Index part, Index other) const {
  const auto& beyond = parts_[part].beyond;
  return static_cast<int>(std::find(beyond.begin(), beyond.end(), other) - beyond.begin());
}

void FaceRefinement::halve(Index part, std::vector<Index>& changed) {
  const int edge = longest_edge(parts_[part]);
  while (true) {
    const Index other = parts_[part].beyond[edge];
    if (other == k_none || parts_[other].beyond[longest_edge(parts_[other])] == part) break;
    halve(other, changed);
  }
  const Index other = parts_[part].beyond[edge], middle = vertex_count();
  const int other_edge = other == k_none ? 0 : edge_towards(other, part);
  const auto middle_in = [&](const Part& p, int i) {
    return SurfacePoint{p.face, 0.5 * (p.place[i] + p.place[(i + 1) % 3])};
  };
  Added added{{middle_in(parts_[part], edge), {}}, {part, other}, 1};
  if (other != k_none && parts_[other].face != parts_[part].face) {
    added.at[1] = middle_in(parts_[other], other_edge);
    added.faces = 2;
  }
  added_.push_back(added);
  const Index second = cut(part, edge, middle);
  changed.insert(changed.end(), {part, second});
  if (other == k_none) return;
  const Index other_second = cut(other, other_edge, middle);
  changed.insert(changed.end(), {other, other_second});
  // The edge runs the other way in the part beyond: first halves lie beside second ones.
  parts_[part].beyond[0] = other_second;
  parts_[other_second].beyond[0] = part;
  parts_[second].beyond[0] = other;
  parts_[other].beyond[0] = second;
}

/// Cuts a part in two, from the middle of an edge to the corner opposite; returns the new one. Of both, edge 0 is the
/// half of that edge.
Index FaceRefinement::cut(Index index, int edge, Index middle) {
  const Part whole = parts_[index];
  const int a = edge, b = (edge + 1) % 3, c = (edge + 2) % 3;
  const auto second = static_cast<Index>(parts_.size());
  const double half = whole.length[a] / 2, right = whole.length[b], left = whole.length[c];
  const Vec3 place = 0.5 * (whole.place[a] + whole.place[b]);
  const double across = FlatFace(mesh_->corners(3 * whole.face)).vector(whole.place[c] - place).norm();
  parts_[index] = {whole.face,
                   {whole.corner[a], middle, whole.corner[c]},
                   {whole.place[a], place, whole.place[c]},
                   {k_none, second, whole.beyond[c]},
                   {half, across, left},
                   whole.area / 2};
  parts_.push_back({whole.face,
                    {middle, whole.corner[b], whole.corner[c]},
                    {place, whole.place[b], whole.place[c]},
                    {k_none, whole.beyond[b], index},
                    {half, right, across},
                    whole.area / 2});
  if (whole.beyond[b] != k_none) parts_[whole.beyond[b]].beyond[edge_towards(whole.beyond[b], index)] = second;
  return second;
}

}  // namespace saddleback
