// Leads from sites with powers to the numbered diagram: orders them, triangulates those with a cell, and numbers these.

#include "saddleback/voronoi2d/power_diagram_2d.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "saddleback/error.h"

#include "voronoi2d/diagram/half_edges.h"
#include "voronoi2d/power/power_triangulation.h"
#include "voronoi2d/sites/check_options.h"
#include "voronoi2d/sites/site_order.h"
#include "voronoi2d/sites/site_weights.h"

namespace saddleback {
namespace {

using namespace voronoi2d;

// As the coordinates' squares may be, 53 digits below the smallest included.
double scaled_weight(std::span<const double> weights, Index site, double scale) {
  constexpr double k_largest = 0x1p500, k_smallest = 0x1p-480;
  const double weight = weights[site], scaled = weight * scale * scale, size = std::fabs(scaled);
  if (weight != 0 && !(size >= k_smallest && size <= k_largest))
    throw InputError(message("weights: weight ", site, " is ", weight,
                             ", too different in size from the squares of the sites' coordinates to be told exactly"));
  return scaled;
}

}  // namespace

Voronoi2d power_diagram_2d(std::span<const Vec2> sites, std::span<const double> weights, int threads, Job* job) {
  return power_diagram_2d(sites, weights, threads, JobStage(job, "Power diagram"));
}

Voronoi2d power_diagram_2d(std::span<const Vec2> sites, std::span<const double> weights, int threads,
                           const JobStage& stage) {
  check_options({.threads = threads}, sites.size());
  check_weights(sites, weights);
  OrderedSites ordered = order_sites(sites, threads, stage.part(0, 0.1));
  const Heaviest heaviest = heaviest_by_place(ordered, weights);
  ordered.weights.resize(ordered.count());
  for (Index rank = 0; rank < ordered.count(); ++rank)
    ordered.weights[rank] = scaled_weight(weights, heaviest.original[rank], ordered.scale);
  Voronoi2d result;
  result.site_of = smallest_equal(ordered, weights);
  ordered.original = heaviest.original;

  PowerTriangulation found = triangulate_by_powers(ordered, stage.part(0.1, 0.85));
  Numbering numbering = number(std::move(found.triangulation), found.visible, threads, stage.part(0.85, 1));
  result.sites = copy_of(sites, threads, stage.part(0.99, 1));
  result.powers.assign(weights.begin(), weights.end());
  result.vertices = std::move(numbering.vertices);
  result.edges = std::move(numbering.edge_vertices);
  result.edge_sites = std::move(numbering.edge_sites);
  result.cell_sites = std::move(found.visible.original);
  result.cell_offsets = std::move(numbering.offsets);
  result.corner_vertices = std::move(numbering.corner_vertices);
  result.side_edges = std::move(numbering.side_edges);
  result.cell_places.assign(sites.size(), k_none);
  for (std::size_t place = 0; place < result.cell_sites.size(); ++place)
    result.cell_places[result.cell_sites[place]] = static_cast<Index>(place);
  for (std::size_t i = 0; i < sites.size(); ++i) {
    result.cell_places[i] = result.cell_places[result.site_of[i]];
    if (result.cell_places[i] == k_none) result.hidden.push_back(static_cast<Index>(i));
  }
  stage.update(1);
  return result;
}

}  // namespace saddleback
