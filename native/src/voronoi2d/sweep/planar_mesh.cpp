#include "voronoi2d/sweep/planar_mesh.h"

#include <algorithm>
#include <numeric>

namespace saddleback::voronoi2d {

using predicates::Sign;

Sign circle_test(const PlanarMesh& mesh, Index half) {
  const Index twin = mesh.twins[half];
  return predicates::in_circle_by_steps(mesh.point(mesh.triangles[half]), mesh.point(mesh.triangles[next_half(half)]),
                                        mesh.point(mesh.triangles[previous_half(half)]),
                                        mesh.point(mesh.triangles[previous_half(twin)]));
}

namespace {

void set_twins(PlanarMesh& mesh, Index a, Index b) {
  mesh.twins[a] = b;
  if (b != k_none) mesh.twins[b] = a;
}

}  // namespace

void exchange_pair(PlanarMesh& mesh, Index half) {
  const Index twin = mesh.twins[half];
  const Index half_next = next_half(half), half_last = previous_half(half);
  const Index twin_next = next_half(twin), twin_last = previous_half(twin);
  const Index r = mesh.triangles[half_last], s = mesh.triangles[twin_last];
  mesh.triangles[half_next] = s;
  mesh.triangles[twin_next] = r;
  const Index beyond_half = mesh.twins[half_next], beyond_twin = mesh.twins[twin_next];
  set_twins(mesh, half, beyond_twin);
  set_twins(mesh, twin, beyond_half);
  set_twins(mesh, half_next, twin_next);
}

namespace {

/// The convex hull that grows to the right, as a ring of sites with the half-edge that leaves each.
struct Hull {
  std::vector<Index> next, previous, half;
};

Index add_triangle(PlanarMesh& mesh, Index a, Index b, Index c) {
  const Index half = 4 * mesh.triangle_count++;
  mesh.triangles[half] = a;
  mesh.triangles[half + 1] = b;
  mesh.triangles[half + 2] = c;
  std::fill(mesh.twins + half, mesh.twins + half + 3, k_none);
  return half;
}

/// Covers the hull's edge that leaves `from` by a triangle with the site; returns the half-edge from the site.
Index cover(PlanarMesh& mesh, const Hull& hull, Index from, Index site) {
  const Index half = add_triangle(mesh, hull.next[from], from, site);
  set_twins(mesh, half, hull.half[from]);
  return half;
}

/// Joins a site that is to the right of all others to every edge of the hull that it sees.
void join_to_hull(PlanarMesh& mesh, Hull& hull, Index latest, Index site) {
  const auto sees = [&](Index from) {
    return predicates::orient_2d(mesh.point(from), mesh.point(hull.next[from]), mesh.point(site)) == Sign::negative;
  };
  Index first = latest, last = latest, first_half = k_none, last_half = k_none;
  while (sees(last)) {  // half + 1 comes from the ring to the site, half + 2 goes back
    const Index half = cover(mesh, hull, last, site);
    if (last_half != k_none) set_twins(mesh, last_half + 2, half + 1);
    if (first_half == k_none) first_half = half;
    last_half = half;
    last = hull.next[last];
  }
  while (sees(hull.previous[first])) {
    first = hull.previous[first];
    const Index half = cover(mesh, hull, first, site);
    if (first_half != k_none) set_twins(mesh, half + 2, first_half + 1);
    if (last_half == k_none) last_half = half;
    first_half = half;
  }
  hull.next[first] = site;
  hull.previous[site] = first;
  hull.next[site] = last;
  hull.previous[last] = site;
  hull.half[first] = first_half + 1;
  hull.half[site] = last_half + 2;
}

}  // namespace

void triangulate_from_left(PlanarMesh& mesh) {
  mesh.triangle_count = 0;
  std::vector<Index> order(mesh.site_count);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](Index a, Index b) { return mesh.x[a] != mesh.x[b] ? mesh.x[a] < mesh.x[b] : mesh.y[a] < mesh.y[b]; });
  const auto turn = [&](Index a, Index b, Index c) {
    return predicates::orient_2d(mesh.point(a), mesh.point(b), mesh.point(c));
  };
  Index apex = 2;  // the first that is not in line with those before
  while (apex < mesh.site_count && turn(order[0], order[1], order[apex]) == Sign::zero) ++apex;
  if (apex >= mesh.site_count) return;

  // The line of the first, there and back, is a hull without inside: the apex sees one way of it.
  Hull hull{std::vector<Index>(mesh.site_count, k_none), std::vector<Index>(mesh.site_count, k_none),
            std::vector<Index>(mesh.site_count, k_none)};
  const bool is_left = turn(order[0], order[1], order[apex]) == Sign::positive;
  Index last_half = k_none;
  const Index top = order[apex];
  for (Index i = 0; i + 1 < apex; ++i) {
    const Index a = is_left ? order[i] : order[apex - 1 - i], b = is_left ? order[i + 1] : order[apex - 2 - i];
    const Index half = add_triangle(mesh, a, b, top);
    if (last_half != k_none) set_twins(mesh, last_half + 1, half + 2);
    if (last_half == k_none) hull.half[top] = half + 2;
    last_half = half;
    hull.next[a] = b;
    hull.previous[b] = a;
    hull.half[a] = half;
    if (i == 0) hull.next[top] = a, hull.previous[a] = top;
    hull.next[b] = top, hull.previous[top] = b, hull.half[b] = half + 1;
  }
  for (Index i = apex + 1; i < mesh.site_count; ++i) join_to_hull(mesh, hull, order[i - 1], order[i]);
}

}  // namespace saddleback::voronoi2d
