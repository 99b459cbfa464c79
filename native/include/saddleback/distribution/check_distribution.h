#pragma once
// A check of what is promised about shapes on a surface, made in other ways than they were laid.

#include "saddleback/shape_mapping/cut_shapes.h"

namespace saddleback {

enum class Fault : std::uint8_t {
  not_laid,      ///< the shape could not be laid on the surface at all
  open,          ///< its outline is not a closed chain of pieces that lead from face to face
  crossing,      ///< two outlines have a point in common, or one crosses itself
  nesting,       ///< one shape lies within another
  overturned,    ///< a triangle of its patch is turned over, on the surface or in the shape's plane
  incomplete,    ///< its patch is not the whole shape once: the areas differ in the shape's plane
  covered_twice  ///< a sample of the surface lies in two shapes
};

struct FaultReport {
  Fault fault;
  Index first, second;  ///< placements; k_none where there is no second one
  SurfacePoint where;
};

struct CheckOptions {
  std::int64_t samples = 1'000'000;  ///< of the surface, even by area
  std::uint64_t seed = 0;
  std::size_t most_faults = 1000;  ///< no more are listed; all are counted
  int threads = 0;                 ///< 0: all cores; never changes the result
  Job* job = nullptr;
};

struct CheckReport {
  std::vector<FaultReport> faults;
  std::int64_t fault_count = 0;
  Index placement_count = 0;
  std::int64_t piece_count = 0;     ///< of outlines, compared with all others in their faces
  std::int64_t triangle_count = 0;  ///< of patches
  std::int64_t sample_count = 0;
  double coverage = 0;               ///< share of the surface that lies in shapes, by the samples
  double coverage_error = 0;         ///< its standard deviation
  double patch_coverage = 0;         ///< the same by the areas of the patches
  double smallest = 1, largest = 1;  ///< singular values of the map, by the triangles of the patches
};

/// Four checks, none of which knows how shapes are laid. Outlines: all pairs of pieces in each face, by exact
/// predicates; a common point is a fault. Nesting: from where outlines cross edges it spreads over the vertices which
/// shape each lies in, and a point of every other outline is brought to a corner of its face by counting crossings.
/// Orientation: of every triangle of every patch, on the surface and in the shape's plane, and the sum of their areas.
/// Multiplicity: samples even by area, each looked for in all patches of its face, without any outline.
/// `mapped` are the shapes as map_shapes laid them. \throw Cancelled. O(sum of squares of the pieces in a face +
/// samples).
CheckReport check_distribution(const Mesh& mesh, std::span<const Shape> shapes, std::span<const Placement> placements,
                               std::span<const MappedShape> mapped, const CheckOptions& options = {});

}  // namespace saddleback
