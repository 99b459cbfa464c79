#pragma once
// Many copies of shapes on a surface that never collide.

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "saddleback/field/direction_field.h"
#include "saddleback/job.h"
#include "saddleback/shapes/placement.h"
#include "saddleback/shapes/shape.h"

namespace saddleback {

struct DistributionOptions {
  /// Number of copies of each shape; empty: as many as find room. With shares: one value, the number in all.
  std::vector<Index> counts;
  /// Share of each shape in the copies, of which only ratios matter; empty: whatever finds room. No shape is ever ahead
  /// of its share by more than a hundredth and one copy, so where one finds no more room the others stop as well. With
  /// a density the shares are those of the counts.
  std::vector<double> shares;
  /// Says where shapes point: x axes along one of the field's directions, chosen at random among those that differ. One
  /// field for all shapes, or one a shape; empty: the smoothest field of lines.
  std::vector<const DirectionField*> fields;
  /// Scale of the shapes (mesh units for one unit of their planes): one value, or one a vertex; a list for all shapes,
  /// or one a shape.
  std::vector<std::vector<double>> size{{1.0}};
  /// Every copy is scaled by another factor in this range, chosen at random.
  double smallest = 1, largest = 1;
  /// Density wanted at each vertex, in copies per area, of which only ratios matter; a list for all shapes, or one a
  /// shape; empty: even. Needs counts, or maximal: then it says in which order places are tried, each class by its
  /// density's share of its own mean, and no copy is centered where that is 0; but the end is full, so it does not say
  /// how many lie on an area. Sizes do.
  std::vector<std::vector<double>> density;
  /// Copies that lie on the surface already. They come first in the result, and count as copies of their shapes.
  Placements around;
  /// Flags of the faces that nothing may touch. Empty: none.
  std::vector<std::uint8_t> forbidden;
  /// Least distance between copies, mesh units; half of it is kept to the border and to what is forbidden.
  double gap = 0;
  /// Chooses the order of candidates: 0: random order; 1: one beside the other in a front that sweeps over the surface,
  /// denser by a quarter and more.
  double packing = 0;
  bool mirror = false;  ///< half of the copies are mirrored, at random
  /// Copies bend along the field: they are laid along its curves (see center_line), as map_shapes lays them when given
  /// the field. Needs a field.
  bool bend = false;
  /// Goes on until nothing more fits wherever a shape's density is positive, and proves it: see Certificate.
  bool maximal = false;
  /// Clearance of that proof, as a share of the circumradius, and half of the gap, of the smallest copy of a kind that
  /// might lie there.
  double tolerance = 0.01;
  std::uint64_t seed = 0;
  int threads = 0;  ///< 0: all cores; the result is the same for any number
};

enum class DistributionStop : std::uint8_t {
  counts,    ///< every count is met
  full,      ///< nothing more fits, which the certificate proves
  tired,     ///< no room was found in a while
  unproven,  ///< no room was found, but of more than half of where copies may be centered no certificate can tell:
             ///< shapes or gaps are too large for how the surface bends
};

enum class Rejection : std::uint8_t {
  collision,  ///< with a copy that lies there
  boundary,   ///< beyond the rim of the surface
  forbidden,  ///< on a forbidden face
  fold,       ///< the surface bends too much there to lay the shape on it once
  stretched,  ///< it would be stretched by more than two
};
inline constexpr std::size_t k_rejection_count = 5;

/// A proof that nothing more fits. The surface is cut into cells, for each shape where its density is positive. Of each
/// cell either all placements centered in it meet a copy that lies there, or its center's does and no placement
/// centered in it differs by more than `tolerance`. So whatever is laid there comes nearer to a copy than the
/// tolerance. Placements that bend differ as those at the cell's corners do and a fifth more: curves of a field do not
/// cross.
struct Certificate {
  double tolerance = 0;  ///< mesh units; 0 without a certificate
  std::int64_t cells = 0, leaves = 0;
  /// Area of the cells for which this could not be decided: around singularities of the field, where copies that bend
  /// along its curves part, and where the surface bends too much for the shapes.
  double uncertified_area = 0;
  SurfacePoints uncertified;  ///< centers of those cells
};

struct DistributionResult {
  Placements placements;  ///< in the order in which they were laid
  DistributionStop stop = DistributionStop::tired;
  std::array<std::int64_t, k_rejection_count> rejections{};  ///< by Rejection
  Certificate certificate;
};

/// Lays copies of shapes on a surface, by the exponential map or along the field's curves, so that their outlines on
/// the mesh have no common point: every copy is accepted only after the exact test of its outline, cut at the edges of
/// the faces, against those already there. Candidates come in a random order (or that of a sweep) and each that finds
/// room stays, as if one after the other: the same result for any number of threads [blelloch2012]. Where the surface
/// is covered is found by subdivision (after [ebeida2011], for outlines instead of disks). Distances are within the
/// surface: sheets that lie close to each other know nothing of each other. \throw InputError naming the argument: no
/// shape; fields, sizes or densities of another number than shapes; counts of another number than shapes or negative; a
/// field of another mesh; sizes, density or forbidden of the wrong length, not finite, not positive (density: negative
/// or zero everywhere); a range of sizes that is none; a copy larger than the surface, alone or with half of the gap
/// around; a negative gap; packing outside 0 to 1; a tolerance outside 0.001 to 0.5; copies to lay around that meet
/// each other, or do not fit where they are; shares of another number than shapes, negative, all zero, or with maximal;
/// bend without a field; a density without counts or maximal; everything forbidden. Cancelled.
DistributionResult distribute(const Mesh& mesh, std::span<const Shape> shapes, const DistributionOptions& options,
                              Job* job = nullptr);

}  // namespace saddleback
