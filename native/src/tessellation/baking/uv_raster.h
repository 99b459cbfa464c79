#pragma once
// Which triangle of a UV map, and which cell, holds the center of a texel.

#include <optional>
#include <vector>

#include "saddleback/tessellation/bake_cells.h"

namespace saddleback {

/// Tells of a place in the UV plane where it is in a triangle there.
class UvPlace {
 public:
  /// `corners` in texels.
  explicit UvPlace(const std::array<Vec2, 3>& corners);
  /// None where the triangle has no area.
  std::optional<Vec3> barycentric(const Vec2& place) const;
  bool has_area() const { return inverse_ != 0; }
  /// How far a place is from the nearest edge's line, in texels.
  double depth(const Vec2& place) const;

 private:
  const std::array<Vec2, 3> corners_;
  double inverse_ = 0;  ///< of twice the area, 0 for none
};

/// Draws triangles into an image's arrays of triangles and cells.
class UvRaster {
 public:
  /// The arguments outlive it. Fills `baked.without_area` and `baked.outside`. \throw Cancelled.
  UvRaster(const Mesh& mesh, const GeodesicVoronoi& cells, const UvTriangles& triangles, const BakeOptions& options,
           BakedCells& baked, const JobStage& stage);
  /// Fills both arrays and `overlapping`. \throw Cancelled.
  void draw(const JobStage& stage);

  /// The corners of a triangle in texels, whose centers have whole coordinates.
  std::array<Vec2, 3> corners_of(Index triangle) const;

 private:
  struct Rows {
    Index begin, end;
  };
  void draw_band(Index band, std::vector<Index>& overlapping);
  void draw_pieces(Index triangle, Rows rows);
  void find_left_over(Index triangle, Rows rows);

  const Mesh& mesh_;
  const GeodesicVoronoi& cells_;
  const UvTriangles& triangles_;
  const BakeOptions& options_;
  BakedCells& baked_;
  std::vector<std::vector<Index>> bands_;  ///< triangles that may touch each
  std::vector<Index> first_piece_;         ///< of each face, k_none: none
};

}  // namespace saddleback
