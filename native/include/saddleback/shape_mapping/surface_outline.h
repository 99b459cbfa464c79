#pragma once
// Outlines of shapes on the surface: closed chains of straight pieces, each within one face.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "saddleback/mesh/surface_points.h"

namespace saddleback {

/// The reason for which a piece of the plane could not be laid on the surface.
enum class MapFailure : std::uint8_t {
  none,
  boundary,   ///< it leaves the surface
  fold,       ///< the surface would be covered twice, or turned over
  stretched,  ///< somewhere it is longer or shorter than the limits allow
};

/// Bounds by how much lengths may change from the plane to the surface: the singular values of the map.
struct MapLimits {
  double smallest = 0.5, largest = 2;
};

/// A straight piece of an outline inside one face, the shape on its left. Points are given by the weights of the face's
/// corners 1 and 2. On an edge these are exact (the third weight is 1 minus them without rounding), equal in both
/// faces, and never at an end; elsewhere all three weights are positive.
struct OutlinePiece {
  Index face;
  Index corner;  ///< of the given outline, counted through all loops: the piece is of the edge that begins there
  Index exit;    ///< half-edge of `face` that the piece ends on, k_none when it ends at a corner of the outline
  Vec2 begin, end;
  Vec2 plane_end;  ///< where the end comes from in the shape's plane, in its own units
};

/// Holds what one shape covers.
struct SurfaceOutline {
  std::vector<OutlinePiece> pieces;      ///< loop by loop, in order
  std::vector<std::size_t> loop_begins;  ///< and at the end the number of pieces
  std::vector<Index> faces;              ///< that the shape touches, once each
  std::vector<Index> inside;             ///< vertices within the shape
  std::vector<Vec2> inside_plane;        ///< where they come from in the shape's plane
  double smallest = 1, largest = 1;      ///< singular values of the map in these faces
};

/// The surface point of an end of a piece.
inline SurfacePoint outline_point(Index face, const Vec2& weights) {
  return {face, {1 - weights.x() - weights.y(), weights.x(), weights.y()}};
}

}  // namespace saddleback
