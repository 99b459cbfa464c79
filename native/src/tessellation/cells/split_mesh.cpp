#include "tessellation/cells/split_mesh.h"

#include <algorithm>

namespace saddleback {
namespace {

/// Twice the signed area, as a share of the face, of a triangle given in barycentric coordinates.
double double_area(const Vec3& a, const Vec3& b, const Vec3& c) { return a.dot(b.cross(c)); }

/// Cuts a convex loop into triangles from the corner that leaves the fattest ones.
void triangulate(const Index* loop, const Vec3* place, Index count, std::vector<Triangle>& triangles) {
  Index apex = 0;
  double best = -1;
  for (Index a = 0; a < count && count > 3; ++a) {
    double least = 1;
    for (Index i = 1; i + 1 < count; ++i) {
      least = std::min(least, double_area(place[a], place[(a + i) % count], place[(a + i + 1) % count]));
    }
    if (least > best) best = least, apex = a;
  }
  for (Index i = 1; i + 1 < count; ++i) {
    triangles.push_back({loop[apex], loop[(apex + i) % count], loop[(apex + i + 1) % count]});
  }
}

}  // namespace

SplitMesh split_mesh(const Mesh& mesh, const CutFaces& faces) {
  SplitMesh result;
  result.vertices.assign(mesh.positions().begin(), mesh.positions().end());
  result.vertices.insert(result.vertices.end(), faces.positions.begin(), faces.positions.end());
  result.vertex_origin.assign(result.vertices.size(), k_none);
  for (Index v = 0; v < mesh.vertex_count(); ++v) result.vertex_origin[v] = v;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (faces.face_cell[f] == k_none) continue;
    result.triangles.push_back(mesh.triangles()[f]);
    result.triangle_cell.push_back(faces.face_cell[f]);
  }
  for (const GeodesicVoronoi::Piece& piece : faces.pieces) {
    triangulate(&faces.piece_vertices[piece.first], &faces.piece_barycentric[piece.first], piece.count,
                result.triangles);
    result.triangle_cell.resize(result.triangles.size(), piece.cell);
  }
  return result;
}

}  // namespace saddleback
