#pragma once
// Cuts a mesh along the boundaries of cells.

#include "saddleback/tessellation/geodesic_voronoi.h"

namespace saddleback {

/// The parts of a diagram that cutting needs, as in GeodesicVoronoi.
struct CutFaces {
  const std::vector<Vec3>& positions;
  const std::vector<Index>& face_cell;
  const std::vector<GeodesicVoronoi::Piece>& pieces;
  const std::vector<Index>& piece_vertices;
  const std::vector<Vec3>& piece_barycentric;
};

/// The mesh's vertices and the diagram's points, whole faces and pieces cut into triangles. O(V + F).
SplitMesh split_mesh(const Mesh& mesh, const CutFaces& faces);

}  // namespace saddleback
