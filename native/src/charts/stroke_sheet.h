#pragma once
// The triangles about a curve: cut along it and across its ends, small beside the radius, with distances.

#include <array>
#include <cstdint>
#include <functional>
#include <unordered_set>
#include <vector>

#include "saddleback/mesh/surface_curve.h"

namespace saddleback::charts {

/// The part of a mesh near a curve, as a mesh of its own about the curve: far from the origin of the whole one, places
/// on a narrow map would be rounded to more than a ten-thousandth of the radius.
struct NearPart {
  Mesh mesh;
  std::vector<Index> faces;  ///< of the whole mesh, whose corners keep their order
};

/// The faces within `radius` of the curve in space, and few beyond, that hang together with it.
NearPart near_part(const Mesh& whole, const SurfaceCurve& curve, double radius, const JobStage& stage);

/// Triangles of nodes.
struct Sheet {
  std::vector<Triangle> triangles;
  std::vector<Index> faces;  ///< of the near part, by triangle
  SurfacePoints points;      ///< of nodes, on the near part
  std::vector<Vec3> positions;
  std::vector<double> distance;              ///< from the curve
  std::vector<double> along;                 ///< arc length of the nearest point of the curve; NaN where there are two
  std::vector<std::int8_t> side;             ///< 1 left of the curve, -1 right, 0 on it or on both
  std::unordered_set<std::uint64_t> walls;   ///< edge keys across which triangles do not hang together
  std::vector<Index> curve;                  ///< nodes in order
  std::array<std::vector<Index>, 4> across;  ///< from the ends: start left, start right, end left, end right
};

/// Cuts faces along the curve and, at right angles, across its ends as far as `radius` (across a closed one where it
/// starts); then divides triangles within the radius whose edges are longer than `size`. Without distances.
Sheet cut_sheet(const Mesh& whole, const NearPart& part, const SurfaceCurve& curve, double radius, double size,
                const JobStage& stage);

/// Finds distances up to `reach`, infinity beyond; lines across the ends are walls only as far as they are shortest.
void measure(Sheet& sheet, bool closed, double length, double reach, const JobStage& stage);

/// Cuts along the cut locus: between nodes whose nearest points lie far apart on the curve, or on its two sides.
void cut_at_cut_locus(Sheet& sheet, const Mesh& near, bool closed, double length, const JobStage& stage);

/// Cuts at the radius and drops what is beyond.
void cut_at_radius(Sheet& sheet, const Mesh& near, bool closed, double length, double radius, const JobStage& stage);

}  // namespace saddleback::charts
