#pragma once

#include <optional>

#include "saddleback/tessellation/centroidal_voronoi.h"

#include "tessellation/cells/face_candidates.h"

namespace saddleback {

/// The cells of these sites, their boundaries and areas, without what `locate` asks and without positions.
/// \throw Cancelled.
GeodesicVoronoi subdivision(const FaceCandidates& candidates, const SurfacePoints& sites, int threads,
                            const JobStage& stage);

/// The public diagram of these sites' cells, on the mesh's faces. \throw Cancelled.
GeodesicVoronoi make_diagram(const Mesh& mesh, const FaceCandidates& candidates, const SurfacePoints& sites,
                             int threads, const JobStage& stage);

/// geodesic_voronoi as a part of other work; the sites are checked. \throw Cancelled, DeviceError.
GeodesicVoronoi find_cells(const SaddleVertexGraph& graph, const SurfacePoints& sites, int threads, int cuda_device,
                           const JobStage& stage);

/// \throw InputError for a density of wrong length, with a negative, infinite or not-a-number value, or zero
/// everywhere; an empty one is uniform.
void check_density(const Mesh& mesh, std::span<const double> density);

/// CentroidalVoronoi's, of an energy. O(F).
double normalized_energy(const Mesh& mesh, std::span<const double> density, double energy, std::size_t count);

/// centroidal_voronoi as a part of other work; the cells of the result are left to find. Sites that are relaxed are
/// only exchanged.
CentroidalVoronoi relax_sites(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                              const CentroidalVoronoiOptions& options, const JobStage& stage, bool is_relaxed = false);

/// The cells of such sites.
GeodesicVoronoi relaxed_cells(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                              const CentroidalVoronoiOptions& options, const JobStage& stage);

/// A start for `count` cells from relaxed cells of a quarter of the number, and so on down. \throw as initial_sites;
/// Cancelled.
SurfacePoints coarse_to_fine_sites(const SaddleVertexGraph& graph, Index count, const CentroidalVoronoiOptions& options,
                                   std::uint64_t seed, const JobStage& stage);

/// centroidal_voronoi of a number of cells as a part of other work, from one start; see relax_sites.
CentroidalVoronoi relax_count(const SaddleVertexGraph& graph, Index count, std::uint64_t seed,
                              const CentroidalVoronoiOptions& options, const JobStage& stage);

/// A start for `count` cells from cells relaxed on a mesh of fewer vertices. None where the graph's mesh is not much
/// finer than that, has lengths of its own, or parts too thin for it, and where sites are fixed. \throw as
/// initial_sites; Cancelled.
std::optional<SurfacePoints> coarse_mesh_sites(const SaddleVertexGraph& graph, Index count,
                                               const CentroidalVoronoiOptions& options, std::uint64_t seed,
                                               const JobStage& stage);

}  // namespace saddleback
