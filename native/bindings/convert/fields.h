#pragma once
// The fields of the library's results, for state.h. A structured binding has to name all of them: whoever adds one is
// told here.

#include <tuple>

#include "saddleback/charts/lifted_voronoi.h"
#include "saddleback/distribution/check_distribution.h"
#include "saddleback/distribution/distribution.h"
#include "saddleback/geodesics/geodesic_paths.h"
#include "saddleback/geodesics/log_map.h"
#include "saddleback/geodesics/polar_coordinates.h"
#include "saddleback/mesh/hausdorff_distance.h"
#include "saddleback/shape_mapping/bent_copies.h"
#include "saddleback/shape_mapping/conform.h"
#include "saddleback/shape_mapping/cut_shapes.h"
#include "saddleback/shape_mapping/shape_attributes.h"
#include "saddleback/tessellation/bake_cells.h"
#include "saddleback/tessellation/cell_polygons.h"
#include "saddleback/tessellation/centroidal_voronoi.h"
#include "saddleback/tessellation/triangle_quality.h"
#include "saddleback/voronoi2d/balance_2d.h"
#include "saddleback/voronoi2d/periodic_voronoi_2d.h"
#include "saddleback/voronoi2d/relax_2d.h"
#include "saddleback/voronoi2d/stepped_sweep.h"

namespace saddleback {

// NOLINTBEGIN(readability-identifier-naming)
inline auto fields_of(DeviceTimes& of) {
  auto& [upload, order, find, unite, download, second_pass, by_processor] = of;
  return std::tie(upload, order, find, unite, download, second_pass, by_processor);
}
inline auto fields_of(GeodesicPath& of) {
  auto& [points, surface, length] = of;
  return std::tie(points, surface, length);
}
inline auto fields_of(GeodesicPaths& of) {
  auto& [points, surface, offsets, lengths, sources] = of;
  return std::tie(points, surface, offsets, lengths, sources);
}
inline auto fields_of(LogMap& of) {
  auto& [vertices, distance, angle, uv, shadowed] = of;
  return std::tie(vertices, distance, angle, uv, shadowed);
}
inline auto fields_of(PolarCoordinates& of) {
  auto& [vertices, distance, along, shadowed] = of;
  return std::tie(vertices, distance, along, shadowed);
}
inline auto fields_of(FarthestPoint& of) {
  auto& [point, distance] = of;
  return std::tie(point, distance);
}
inline auto fields_of(GeodesicVoronoi::Candidate& of) {
  auto& [cell, squared_distance] = of;
  return std::tie(cell, squared_distance);
}
inline auto fields_of(GeodesicVoronoi::Piece& of) {
  auto& [face, cell, first, count] = of;
  return std::tie(face, cell, first, count);
}
inline auto fields_of(SplitMesh& of) {
  auto& [vertices, triangles, triangle_cell, vertex_origin] = of;
  return std::tie(vertices, triangles, triangle_cell, vertex_origin);
}
inline auto fields_of(CellPolygons& of) {
  auto& [points, vertices, corners, offsets, polygon_cell, missing, sites, added, is_barrier] = of;
  return std::tie(points, vertices, corners, offsets, polygon_cell, missing, sites, added, is_barrier);
}
inline auto fields_of(DualIssue& of) {
  auto& [kind, cell, other, place] = of;
  return std::tie(kind, cell, other, place);
}
inline auto fields_of(TriangleQuality& of) {
  auto& [quality, least_angle, greatest_angle, valence, at_boundary, irregular] = of;
  return std::tie(quality, least_angle, greatest_angle, valence, at_boundary, irregular);
}
inline auto fields_of(BakedCells& of) {
  auto& [width, height, channels, triangle, cell, edge_distance, local_uv, values, farthest, overlapping, without_area,
         outside] = of;
  return std::tie(width, height, channels, triangle, cell, edge_distance, local_uv, values, farthest, overlapping,
                  without_area, outside);
}
inline auto fields_of(RelaxationStep& of) {
  auto& [sites, iterations, energy] = of;
  return std::tie(sites, iterations, energy);
}
inline auto fields_of(LiftedVoronoi& of) {
  auto& [areas, centroids, points, positions, edge_points, edge_offsets, edge_of, edge_cells, face_cell, pieces,
         piece_vertices, piece_barycentric] = of;
  return std::tie(areas, centroids, points, positions, edge_points, edge_offsets, edge_of, edge_cells, face_cell,
                  pieces, piece_vertices, piece_barycentric);
}
inline auto fields_of(ClippedCells& of) {
  auto& [points, loop_offsets, loop_sites, areas, centroids] = of;
  return std::tie(points, loop_offsets, loop_sites, areas, centroids);
}
inline auto fields_of(AreaWeights& of) {
  auto& [weights, shares, error, lacks, iterations, converged, stop_reason] = of;
  return std::tie(weights, shares, error, lacks, iterations, converged, stop_reason);
}
inline auto fields_of(Balance2d& of) {
  auto& [sites, weights, shares, capacity_error, energy, iterations, converged, stop_reason] = of;
  return std::tie(sites, weights, shares, capacity_error, energy, iterations, converged, stop_reason);
}
inline auto fields_of(Relaxation2d& of) {
  auto& [sites, energy, iterations, converged, stop_reason] = of;
  return std::tie(sites, energy, iterations, converged, stop_reason);
}
inline auto fields_of(SteppedSweep::Event& of) {
  auto& [is_touch, radius, sites, point] = of;
  return std::tie(is_touch, radius, sites, point);
}
inline auto fields_of(Placement& of) {
  auto& [shape, center, angle, scale, mirrored] = of;
  return std::tie(shape, center, angle, scale, mirrored);
}
inline auto fields_of(MapLimits& of) {
  auto& [smallest, largest] = of;
  return std::tie(smallest, largest);
}
inline auto fields_of(Certificate& of) {
  auto& [tolerance, cells, leaves, uncertified_area, uncertified] = of;
  return std::tie(tolerance, cells, leaves, uncertified_area, uncertified);
}
inline auto fields_of(DistributionResult& of) {
  auto& [placements, stop, rejections, certificate] = of;
  return std::tie(placements, stop, rejections, certificate);
}
inline auto fields_of(ConformedPoints& of) {
  auto& [failure, anchors, heights, lost] = of;
  return std::tie(failure, anchors, heights, lost);
}
inline auto fields_of(BentCopies& of) {
  auto& [anchors, heights, begins, triangles, triangle_copy, triangle_source, weights, deviations, lost] = of;
  return std::tie(anchors, heights, begins, triangles, triangle_copy, triangle_source, weights, deviations, lost);
}
inline auto fields_of(CutMesh& of) {
  auto& [vertices, vertex_origin, vertex_plane, triangles, triangle_face, triangle_shape] = of;
  return std::tie(vertices, vertex_origin, vertex_plane, triangles, triangle_face, triangle_shape);
}
inline auto fields_of(ShapeAttributes& of) {
  auto& [placement, distance, plane] = of;
  return std::tie(placement, distance, plane);
}
inline auto fields_of(FaultReport& of) {
  auto& [fault, first, second, where] = of;
  return std::tie(fault, first, second, where);
}
inline auto fields_of(CheckReport& of) {
  auto& [faults, fault_count, placement_count, piece_count, triangle_count, sample_count, coverage, coverage_error,
         patch_coverage, smallest, largest] = of;
  return std::tie(faults, fault_count, placement_count, piece_count, triangle_count, sample_count, coverage,
                  coverage_error, patch_coverage, smallest, largest);
}
/// All but the field of exact cells, which is found again.
inline auto fields_of(GeodesicVoronoi& of) {
  auto& [sites, vertex_cell, vertex_distance, areas, points, positions, point_distance, edge_points, edge_offsets,
         edge_cells, edge_closed, branch_points, face_cell, pieces, piece_vertices, piece_barycentric, candidates,
         face_candidates, exact_field, exact_sites] = of;
  static_cast<void>(exact_field);
  return std::tie(sites, vertex_cell, vertex_distance, areas, points, positions, point_distance, edge_points,
                  edge_offsets, edge_cells, edge_closed, branch_points, face_cell, pieces, piece_vertices,
                  piece_barycentric, candidates, face_candidates, exact_sites);
}
/// All but the cells after repair, which the binding adds.
inline auto fields_of(DualMesh& of) {
  auto& [sites, vertices, triangles, edges, issues, added, euler_characteristic, repaired] = of;
  static_cast<void>(repaired);
  return std::tie(sites, vertices, triangles, edges, issues, added, euler_characteristic);
}
/// All but the cells, a Python object of their own.
inline auto fields_of(CentroidalVoronoi& of) {
  auto& [sites, held, cells, energy, iterations, converged, stop_reason, normalized_energy, exchanged, issues] = of;
  static_cast<void>(cells);
  return std::tie(sites, held, energy, iterations, converged, stop_reason, normalized_energy, exchanged, issues);
}
/// All but the device's times, which do not belong to the result.
inline auto fields_of(Voronoi2d& of) {
  auto& [sites, weights, powers, site_of, hidden, vertices, edges, edge_sites, device_times, cell_sites, cell_places,
         cell_offsets, corner_vertices, side_edges] = of;
  static_cast<void>(device_times);
  return std::tie(sites, weights, powers, site_of, hidden, vertices, edges, edge_sites, cell_sites, cell_places,
                  cell_offsets, corner_vertices, side_edges);
}
inline auto fields_of(PeriodicVoronoi2d& of) {
  auto& [low, size, sites, powers, site_of, hidden, vertices, edges, edge_shifts, edge_sites, edge_site_shifts,
         cell_offsets, corner_vertices, corner_shifts, side_edges, triangles, triangle_shifts, around, around_sites] =
      of;
  return std::tie(low, size, sites, powers, site_of, hidden, vertices, edges, edge_shifts, edge_sites, edge_site_shifts,
                  cell_offsets, corner_vertices, corner_shifts, side_edges, triangles, triangle_shifts, around,
                  around_sites);
}
// NOLINTEND(readability-identifier-naming)

}  // namespace saddleback
