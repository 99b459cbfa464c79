#include "mesh/tables/validate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "mesh/tables/face_shape.h"
#include "mesh/tables/offenders.h"

namespace saddleback {
namespace {

const char* const k_repair = "saddleback.repair mends this";

std::string name_face(Index f, const Triangle& t) {
  return message("face ", f, " (", t[0], ", ", t[1], ", ", t[2], ")");
}

void check_sizes(std::size_t vertex_count, std::span<const Triangle> triangles) {
  constexpr std::size_t k_max = std::numeric_limits<Index>::max();
  if (triangles.empty()) throw MeshError("the mesh has no faces; give it at least one triangle");
  if (vertex_count >= k_max || triangles.size() >= k_max / 3)
    throw MeshError(message("the mesh has ", vertex_count, " vertices and ", triangles.size(),
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

void check_positions(std::span<const double> coordinates, int dimension) {
  Offenders not_finite, too_large;
  for (std::size_t first = 0; first < coordinates.size(); first += dimension) {
    const std::span<const double> p = coordinates.subspan(first, dimension);
    const auto name = [&] {
      std::string text = message("vertex ", first / dimension, " (", p[0]);
      for (const double x : p.subspan(1)) text += message(", ", x);
      return text + ")";
    };
    if (!std::ranges::all_of(p, [](double x) { return std::isfinite(x); })) {
      not_finite.add(name);
    } else if (std::ranges::any_of(p, [](double x) { return std::abs(x) > k_largest_coordinate; })) {
      too_large.add(name);
    }
  }
  not_finite.throw_if_any("vertex is not finite", "vertices are not finite", k_repair);
  too_large.throw_if_any("vertex has a coordinate beyond 1e60", "vertices have coordinates beyond 1e60",
                         "scale the mesh down");
}

}  // namespace

void check_faces(std::span<const double> coordinates, int dimension, std::span<const Triangle> triangles) {
  const std::size_t count = coordinates.size() / dimension;
  check_sizes(count, triangles);
  check_indices(static_cast<Index>(count), triangles);
  check_positions(coordinates, dimension);
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

void check_lengths(std::span<const double> lengths, std::span<const Triangle> triangles, std::span<const Index> twins) {
  constexpr double k_rounding = 1e-12;  // of lengths that are computed for each face
  const auto count = static_cast<Index>(lengths.size());
  Offenders wrong, too_large, different, broken;
  for (Index h = 0; h < count; ++h) {
    const double length = lengths[h];
    const auto name = [&] {
      return message("face ", h / 3, " has ", length, " from vertex ", halfedge_from(triangles, h), " to ",
                     halfedge_to(triangles, h));
    };
    if (!(length > 0 && std::isfinite(length))) wrong.add(name);
    if (length > k_largest_coordinate) too_large.add(name);
    const Index twin = twins[h];
    if (twin == k_none || twin < h || std::abs(length - lengths[twin]) <= k_rounding * length) continue;
    different.add([&] { return message(name(), ", but face ", twin / 3, " has ", lengths[twin]); });
  }
  wrong.throw_if_any("length is not finite and positive", "lengths are not finite and positive",
                     "give lengths of a metric");
  too_large.throw_if_any("length is beyond 1e60", "lengths are beyond 1e60", "scale them down");
  different.throw_if_any("edge has two lengths", "edges have two lengths", "give both of its faces the same");
  for (Index f = 0; f < count / 3; ++f) {
    const std::span<const double, 3> l(lengths.data() + 3 * static_cast<std::size_t>(f), 3);
    if (is_degenerate_face(l))
      broken.add([&] { return message(name_face(f, triangles[f]), " has ", l[0], ", ", l[1], ", ", l[2]); });
  }
  broken.throw_if_any("face has lengths of no triangle", "faces have lengths of no triangle",
                      "each side must be shorter than the other two together");
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
