#include "tessellation/relaxation/unit_relaxation.h"

#include <deque>
#include <optional>
#include <utility>

#include "geodesics/graph/build_progress.h"
#include "geodesics/queries/query_cache.h"
#include "geodesics/queries/unit_graph.h"
#include "tessellation/relaxation/cell_cache.h"

namespace saddleback {
namespace {

constexpr double k_showing = 3;  ///< in iterations

/// What building the graph takes, in iterations of so many sites.
double cost_of_building(const SaddleVertexGraph& graph, std::size_t count) {
  constexpr double k_of_search = 0.5, k_of_vertex = 0.34, k_of_site = 4.2;  // microseconds on one machine
  const double vertices = graph.mesh().vertex_count();
  const double building = k_of_search * BuildProgress::by_rule(graph.mesh(), graph.k(), graph.accuracy()) * vertices;
  return building / (k_of_vertex * vertices + k_of_site * static_cast<double>(count));
}

/// Tells energies as they are on the mesh itself.
class WatchOfUnit : public RelaxationWatch {
 public:
  WatchOfUnit(RelaxationWatch& watch, double energy_unit) : watch_(watch), energy_unit_(energy_unit) {}
  void show(RelaxationStep step) override {
    step.energy *= energy_unit_;
    watch_.show(std::move(step));
  }

 private:
  RelaxationWatch& watch_;
  const double energy_unit_;
};

/// The same curves, through the same points of the same faces of another mesh.
class CurvesThere {
 public:
  CurvesThere(std::span<const SurfaceCurve* const> curves, const Mesh& from, const Mesh& to) {
    for (const SurfaceCurve* curve : curves) {
      if (&curve->mesh() == &from) curve = &made_.emplace_back(to, curve->points(), curve->closed(), "curves");
      all_.push_back(curve);  // of neither mesh: will be refused
    }
  }
  std::span<const SurfaceCurve* const> all() const { return all_; }

 private:
  std::deque<SurfaceCurve> made_;
  std::vector<const SurfaceCurve*> all_;
};

GeodesicVoronoi shown_cells(const SaddleVertexGraph& graph, const SurfacePoints& sites,
                            const CentroidalVoronoiOptions& options, const JobStage& stage) {
  if (!options.cache) return find_cells(graph, sites, options.threads, options.cuda_device, stage);
  const BorrowedCells cells(options.cache, CellCache::Cells::shown, graph, options.density, options.threads,
                            options.cuda_device);
  cells->match(sites);
  cells->find(sites, stage.part(0, 0.7));
  cells->look_farther(stage.part(0.7, 0.8));
  const ClaimsOfCells claims(cells->claims());
  return make_diagram(CellComplex(claims, options.threads, stage.part(0.8, 1)), sites, stage);
}

}  // namespace

CentroidalVoronoi relax_at_unit_size(const SaddleVertexGraph& graph, std::size_t count,
                                     const CentroidalVoronoiOptions& options, const JobStage& stage,
                                     const Relax& relax) {
  const double iterations = options.annealing + options.max_iterations;
  if (!options.scale_free || iterations == 0) return relax(graph, options, stage, FinalCells::found);
  QueryCache& known = graph.query_cache();
  const double building = known.has_unit_graph() ? 0 : cost_of_building(graph, count),
               whole = building + 1 + iterations + k_showing;
  const UnitGraph* const unit =
      known.unit_graph(graph, options.threads, options.cuda_device, stage.part(0, building / whole));
  if (!unit) return relax(graph, options, stage, FinalCells::found);  // to know that took no time
  const JobStage relaxing = stage.part(building / whole, 1 - k_showing / whole);
  const double area_unit = unit->size * unit->size, energy_unit = area_unit * area_unit;
  const CurvesThere curves(options.curves, graph.mesh(), unit->mesh);
  CentroidalVoronoiOptions there = options;
  there.curves = curves.all();
  std::optional<WatchOfUnit> watch;
  if (options.watch) there.watch = &watch.emplace(*options.watch, energy_unit);
  CentroidalVoronoi result = relax(unit->graph, there, relaxing, FinalCells::left_out);
  for (double& energy : result.energy) energy *= energy_unit;
  result.normalized_energy =
      normalized_energy(graph.mesh(), options.density, result.energy.back(), result.sites.size());
  const JobStage showing = options.return_when_cancelled ? JobStage() : stage.part(1 - k_showing / whole, 1);
  result.cells = shown_cells(graph, result.sites, options, showing);
  showing.update(1);
  return result;
}

}  // namespace saddleback
