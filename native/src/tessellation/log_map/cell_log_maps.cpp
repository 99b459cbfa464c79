#include "tessellation/log_map/cell_log_maps.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace saddleback {
namespace {

// Straight lines are shorter than paths in a graph by its error; more than this is no straight line on the surface.
constexpr double k_least_slack = 1e-2;

bool is_rolled_disk(const Mesh& mesh) {
  constexpr double k_flat = 1e-12;  // radians, of roundings of a vertex's angles
  if (mesh.component_count() > 1 || mesh.genus() > 0 || mesh.boundary_loops().size() != 1) return false;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (!mesh.is_boundary(v) && std::abs(mesh.total_angle(v) - 2 * std::numbers::pi) > k_flat) return false;
  return true;
}

}  // namespace

CellLogMaps::CellLogMaps(const SaddleVertexGraph& graph, const VertexRings& rings, CellLengths lengths, int cuda_device)
    : graph_(graph),
      rings_(rings),
      lengths_(lengths),
      slack_(std::max(2 * graph.accuracy(), k_least_slack)),
      is_flat_disk_(is_rolled_disk(graph.mesh())),
      seen_(graph, rings),
      labels_(graph, rings, cuda_device),
      places_(graph.mesh().vertex_count()) {}

void CellLogMaps::label_nodes(const SurfacePoints& sites, std::span<const double> reaches,
                              const std::optional<std::vector<Index>>& others, int threads, const JobStage& stage) {
  labels_.begin(sites, others);
  seen_.find({labels_.sites(), labels_.sites_along_curve(), labels_.kept(), labels_.keeps_any(), reaches}, threads,
             stage.part(0, 0.5));
  labels_.find(seen_, others, threads, stage.part(0.5, 1));
}

void CellLogMaps::renumber(std::span<const Index> before) {
  labels_.renumber(before);
  seen_.renumber(before);
}

SiteVector CellLogMaps::vector_of(const VertexPlace& place) const {
  if (place.found_by == VertexPlace::k_straight || place.found_by == VertexPlace::k_center)
    return {place.at, place.distance};
  const Vec2 towards = place.anchor == k_none ? place.at : Vec2(vector_of(places_[place.anchor]).log);
  double length = place.distance;
  if (is_smooth()) {
    const double in_plane = anchor_distance(place) + place.at.norm();
    if (std::abs(in_plane - length) <= slack_ * length) length = in_plane;
  }
  return {length * towards.normalized(), length};
}

}  // namespace saddleback
