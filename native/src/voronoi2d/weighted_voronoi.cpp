// Leads from weighted sites to the numbered diagram: orders them, finds the cells, numbers what these share.

#include <algorithm>
#include <cmath>
#include <optional>

#include "saddleback/error.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

#include "voronoi2d/sites/check_options.h"
#include "voronoi2d/sites/site_order.h"
#include "voronoi2d/voronoi_2d_cuda.h"
#include "voronoi2d/weighted/weighted_cells.h"
#include "voronoi2d/weighted/weighted_sites.h"

namespace saddleback {
namespace {

using namespace voronoi2d;

/// Numbers edges by the lower rank beside them, vertices by the lowest about them, then counter-clockwise.
class Numberer {
 public:
  Numberer(const WeightedCells& cells, const WeightedSites& sites, Voronoi2d& result, const JobStage& stage)
      : stage_(stage),
        cells_(cells),
        sites_(sites),
        result_(result),
        edge_at_(cells.edge_place_count(), k_none),
        vertex_at_(cells.vertex_place_count(), k_none) {}

  void run() {
    const Index count = sites_.count();
    const std::size_t most = 3 * static_cast<std::size_t>(count);  // edges, by Euler's formula
    result_.cell_offsets.reserve(count + 1);
    result_.corner_vertices.reserve(2 * most);
    result_.side_edges.reserve(2 * most);
    result_.edges.reserve(most);
    result_.edge_sites.reserve(most);
    result_.vertices.reserve(2 * static_cast<std::size_t>(count));
    result_.cell_offsets.push_back(0);
    std::vector<Side> sides;
    for (Index cell = 0; cell < count; ++cell) {
      if (cell % k_block == 0) stage_.update(cell / static_cast<double>(count));
      cells_.read(cell, sides);
      add_corners(cell, sides);
      add_sides(cell, sides);
      result_.cell_offsets.push_back(static_cast<Index>(result_.side_edges.size()));
    }
    stage_.update(1);
  }

 private:
  using Side = WeightedCells::Side;
  static constexpr Index k_block = 4096;

  [[noreturn]] static void fail() { throw Error("voronoi_2d: the cells of weighted sites do not fit together"); }

  void add_corners(Index cell, const std::vector<Side>& sides) {
    for (std::size_t k = 0; k < sides.size(); ++k) {
      stage_.check();  // some vertices take microseconds
      if (sides[k].vertex == k_none) {
        result_.corner_vertices.push_back(k_none);
        continue;
      }
      Index& vertex = vertex_at_[sides[k].vertex];
      const Index next = sides[k + 1 == sides.size() ? 0 : k + 1].neighbor;
      if (vertex == k_none) {
        if (sides[k].neighbor < cell || next < cell) fail();
        vertex = static_cast<Index>(result_.vertices.size());
        result_.vertices.push_back(cells_.position(sides[k].vertex) / sites_.scale);
      }
      result_.corner_vertices.push_back(vertex);
    }
  }

  void add_sides(Index cell, const std::vector<Side>& sides) {
    const Index first = static_cast<Index>(result_.side_edges.size());
    Index before = first + static_cast<Index>(sides.size()) - 1, corner = first;
    for (const Side& side : sides) {
      Index& edge = edge_at_[side.edge];
      if ((edge == k_none) != (cell < side.neighbor)) fail();
      if (edge == k_none) {
        edge = static_cast<Index>(result_.edges.size());
        add_edge(result_.corner_vertices[before], result_.corner_vertices[corner], sites_.original[cell],
                 sites_.original[side.neighbor]);
      }
      result_.side_edges.push_back(edge);
      before = corner++;
    }
  }

  void add_edge(Index from, Index to, Index left, Index right) {
    if (from == k_none) {
      std::swap(from, to);
      std::swap(left, right);
    }
    result_.edges.push_back({from, to});
    result_.edge_sites.push_back({left, right});
  }

  JobStage stage_;
  const WeightedCells& cells_;
  const WeightedSites& sites_;
  Voronoi2d& result_;
  LargeArray<Index> edge_at_, vertex_at_;
};

/// Returns the diagram found on the device; none where it takes the processor, which then also says what is wrong.
std::optional<Voronoi2d> found_on_device(std::span<const Vec2> sites, std::span<const double> weights,
                                         const Voronoi2dOptions& options, const JobStage& stage) {
  constexpr std::size_t k_fewest = 3;
  constexpr double k_largest = 0x1p250;  // as coordinates that need no scale
  if (options.cuda_devices.empty() || sites.size() < k_fewest || weights.size() != sites.size() ||
      !std::all_of(weights.begin(), weights.end(), [](double weight) { return std::fabs(weight) < k_largest; }))
    return std::nullopt;
  std::optional<Voronoi2d> result = cuda_voronoi(sites, weights, options, stage);
  if (!result) return std::nullopt;
  result->weights.assign(weights.begin(), weights.end());
  for (std::size_t i = 0; i < sites.size(); ++i)
    if (result->cell_places[i] == k_none) result->hidden.push_back(static_cast<Index>(i));
  stage.update(1);
  return result;
}

bool all_equal(std::span<const double> weights) {
  return std::all_of(weights.begin(), weights.end(), [&](double weight) { return weight == weights[0]; });
}

}  // namespace

Voronoi2d voronoi_2d(std::span<const Vec2> sites, std::span<const double> weights, const Voronoi2dOptions& options,
                     Job* job) {
  return voronoi_2d(sites, weights, options, JobStage(job, "Weighted Voronoi diagram"));
}

Voronoi2d voronoi_2d(std::span<const Vec2> sites, std::span<const double> weights, const Voronoi2dOptions& options,
                     const JobStage& stage) {
  check_options(options, sites.size());
  if (weights.size() == sites.size() && all_equal(weights) && (weights.empty() || std::isfinite(weights[0])))
    return voronoi_2d(sites, options, stage);
  if (std::optional<Voronoi2d> found = found_on_device(sites, weights, options, stage)) return std::move(*found);
  WeightedSites ordered = order_weighted_sites(sites, weights, options.threads, stage.part(0, 0.2));
  constexpr Index k_good = 2000;  // few enough for a core's cache
  const Index tile_size = options.circles > 0 ? std::max<Index>(1, ordered.count() / options.circles) : k_good;
  Voronoi2d result;
  {
    const WeightedCells cells(ordered, tile_size, options.threads, stage.part(0.2, 0.9));
    Numberer(cells, ordered, result, stage.part(0.9, 1)).run();
  }
  result.sites = copy_of(sites, options.threads, stage.part(0.99, 1));
  result.weights.assign(weights.begin(), weights.end());
  result.cell_places.assign(sites.size(), k_none);
  for (Index rank = 0; rank < ordered.count(); ++rank) result.cell_places[ordered.original[rank]] = rank;
  for (std::size_t i = 0; i < sites.size(); ++i) result.cell_places[i] = result.cell_places[ordered.site_of[i]];
  result.site_of = std::move(ordered.site_of);
  result.hidden = std::move(ordered.hidden);
  result.cell_sites = std::move(ordered.original);
  stage.update(1);
  return result;
}

}  // namespace saddleback
