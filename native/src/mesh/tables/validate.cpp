#include "mesh/tables/validate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/tables/face_shape.h"
#include "mesh/tables/offenders.h"

namespace saddleback {
namespace {

const char* const k_repair = "saddleback.repair mends this";

std::string name_face(Index f, const Triangle& t) {
  return message("face ", f, " (", t[0], ", ", t[1], ", ", t[2], ")");
}

void check_sizes(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  constexpr std::size_t k_max = std::numeric_limits<Index>::max();
  if (triangles.empty()) throw MeshError("the mesh has no faces; give it at least one triangle");
  if (positions.size() >= k_max || triangles.size() >= k_max / 3)
    throw MeshError(message("the mesh has ", positions.size(), " vertices and ", triangles.size(),
                            " faces, but 32-bit indices allow only ", k_max, " and ", k_max / 3, "; decimate it"));
}

void check_indices(Index vertex_count, std::span<const Triangle> triangles) {
  Offenders out_of_range, repeated;
  std::vector<std::uint8_t> used(vertex_count, 0);
  for (Index f = 0; f < static_cast<Index>(triangles.size()); ++f) {
    const Triangle& t = triangles[f];
    bool in_range = true;
    for (const Index v : t) {
      if (v >= 0 && v < vertex_count) {
        used[v] = 1;
        continue;
      }
      in_range = false;
      out_of_range.add([&] { return message("face ", f, " has vertex ", v); });
    }
    if (in_range && (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])) repeated.add([&] { return name_face(f, t); });
  }
  out_of_range.throw_if_any(
      "vertex index out of range", "vertex indices out of range",
      message("the mesh has ", vertex_count, " vertices, so give indices from 0 to ", vertex_count - 1));
  repeated.throw_if_any("face uses a vertex twice", "faces use a vertex twice", k_repair);
  Offenders unused;
  for (Index v = 0; v < vertex_count; ++v)
    if (!used[v]) unused.add([&] { return message("vertex ", v); });
  unused.throw_if_any("vertex belongs to no face", "vertices belong to no face", k_repair);
}

void check_positions(std::span<const Vec3> positions) {
  Offenders not_finite, too_large;
  for (Index v = 0; v < static_cast<Index>(positions.size()); ++v) {
    const Vec3& p = positions[v];
    const auto name = [&] { return message("vertex ", v, " (", p[0], ", ", p[1], ", ", p[2], ")"); };
    if (!p.allFinite()) {
      not_finite.add(name);
    } else if (p.cwiseAbs().maxCoeff() > k_largest_coordinate) {
      too_large.add(name);
    }
  }
  not_finite.throw_if_any("vertex is not finite", "vertices are not finite", k_repair);
  too_large.throw_if_any("vertex has a coordinate beyond 1e60", "vertices have coordinates beyond 1e60",
                         "scale the mesh down");
}

void check_areas(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  Offenders flat;
  for (Index f = 0; f < static_cast<Index>(triangles.size()); ++f) {
    const Triangle& t = triangles[f];
    if (is_degenerate_face(positions[t[0]], positions[t[1]], positions[t[2]]))
      flat.add([&] { return name_face(f, t); });
  }
  flat.throw_if_any("face has no area", "faces have no area", k_repair);
}

}  // namespace

void check_faces(std::span<const Vec3> positions, std::span<const Triangle> triangles) {
  check_sizes(positions, triangles);
  check_indices(static_cast<Index>(positions.size()), triangles);
  check_positions(positions);
  check_areas(positions, triangles);
}

void check_edges(std::span<const Triangle> triangles, const EdgeTable& edges) {
  Offenders duplicate, crowded, opposed;
  for (Index e = 0; e < edges.edge_count(); ++e) {
    const std::span<const Index> around = edges.edge(e);
    if (around.size() == 1) continue;
    const Index a = halfedge_from(triangles, around[0]), b = halfedge_to(triangles, around[0]);
    for_each_duplicate(triangles, around, [&](Index f, Index g) {
      duplicate.add([&] { return message(name_face(g, triangles[g]), " repeats face ", f); });
    });
    if (around.size() > 2) {
      crowded.add([&] { return message("edge (", a, ", ", b, ") has ", around.size(), " faces"); });
    } else if (halfedge_from(triangles, around[1]) == a) {
      opposed.add(
          [&] { return message("faces ", around[0] / 3, " and ", around[1] / 3, " at edge (", a, ", ", b, ")"); });
    }
  }
  duplicate.throw_if_any("duplicate face", "duplicate faces", k_repair);
  crowded.throw_if_any("non-manifold edge", "non-manifold edges", k_repair);
  opposed.throw_if_any("pair of neighbors has opposite orientation", "pairs of neighbors have opposite orientation",
                       k_repair);
}

}  // namespace saddleback
