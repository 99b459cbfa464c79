#include "tessellation/relaxation/closed_ball.h"

#include <algorithm>
#include <limits>

#include "saddleback/error.h"

#include "tessellation/cells/cell_topology.h"
#include "tessellation/relaxation/diagram.h"
#include "tessellation/relaxation/removable_sites.h"

namespace saddleback {
namespace {

// Sites are moved in rounds: those that mend one cell may show what is wrong beside it.
constexpr int k_most_rounds = 40;
// Rounds without fewer faults than ever before, after which it is no use.
constexpr int k_vain_rounds = 10;
// Those that were moved find their middles by a few of Lloyd's steps, the others as they are: longer steps, and all at
// once, break as much as they mend.
constexpr int k_settling_steps = 3;
// Steps between two looks at the cells, which cost as much as some steps.
constexpr int k_steps_a_look = 5;
// Runs that are not kept, after which all stays as it is.
constexpr int k_most_vain_runs = 20;
// Share of the time until nothing breaks the property, of the whole.
constexpr double k_exchange = 0.3;

/// Sites as they were.
struct Places {
  explicit Places(const Relaxation& relaxation) : sites(relaxation.state().sites), along(relaxation.state().along) {}
  void restore(Relaxation& relaxation, const JobStage& stage) const { relaxation.go_to(sites, along, stage); }
  SurfacePoints sites;
  std::vector<double> along;
};

GeodesicVoronoi look_at_cells(const Relaxation& relaxation, const CentroidalVoronoiOptions& options,
                              const JobStage& stage) {
  return find_cells(relaxation.graph(), relaxation.state().sites, options.threads, options.cuda_device, stage);
}

void mark(const std::vector<DualIssue>& issues, std::vector<std::uint8_t>& marked) {
  for (const DualIssue& issue : issues) {
    marked[issue.cell] = 1;
    if (issue.other != k_none) marked[issue.other] = 1;
  }
}

std::vector<std::uint8_t> others_than(std::vector<std::uint8_t> sites) {
  for (std::uint8_t& is_among : sites) is_among = is_among ? 0 : 1;
  return sites;
}

/// Marks the cells with issues, and their neighbors where all of them were marked before.
void mark_more(const GeodesicVoronoi& cells, const std::vector<DualIssue>& issues, std::vector<std::uint8_t>& marked) {
  const std::vector<std::uint8_t> before = marked;
  mark(issues, marked);
  if (marked != before) return;
  std::vector<std::uint8_t> faulty(marked.size(), 0);
  mark(issues, faulty);
  for (const auto& [a, b] : cells.edge_cells)
    if (faulty[a] || faulty[b]) marked[a] = marked[b] = 1;
}

struct Exchanged {
  Exchange told;
  std::vector<std::uint8_t> is_around;  ///< (n,) sites put around thin parts: they stay
};

/// Moves spare sites to where they are missed, round by round. Tells what was wrong at first where that does not help.
Exchanged exchange(Relaxation& relaxation, const CentroidalVoronoiOptions& options, const JobStage& stage) {
  const Mesh& mesh = relaxation.mesh();
  const auto count = static_cast<Index>(relaxation.state().sites.size());
  std::vector<std::uint8_t> is_moved(count, 0), settles(count, 0);
  Exchanged result{{}, std::vector<std::uint8_t>(count, 0)};
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  for (int round = 0, vain = 0; round <= k_most_rounds && vain <= k_vain_rounds; ++round) {
    const double part = 1.0 / (k_most_rounds + 1);
    const JobStage here = stage.part(round * part, (round + 1) * part, message("Moving sites, round ", round + 1));
    const GeodesicVoronoi cells = look_at_cells(relaxation, options, here.part(0, 0.1));
    const std::vector<DualIssue> issues = find_dual_issues(mesh, cells, here);
    if (issues.empty()) {
      result.told = {static_cast<Index>(std::ranges::count(is_moved, 1)), {}};
      return result;
    }
    if (round == 0) result.told.left = issues;
    vain = issues.size() < fewest ? 0 : vain + 1;
    fewest = std::min(fewest, issues.size());
    std::vector<std::uint8_t> is_needed = is_moved;
    for (Index site = 0; site < count; ++site)
      if (!relaxation.is_free(site)) is_needed[site] = 1;
    mark(issues, is_needed);
    const std::vector<PlaceToMend> places = places_to_mend(mesh, cells, issues);
    const std::vector<Index> spare = spare_sites(cells, relaxation.state().moments, is_needed, places.size());
    if (spare.empty()) break;
    Places next(relaxation);
    for (std::size_t i = 0; i < spare.size(); ++i) {
      next.sites[spare[i]] = places[i].point;
      is_moved[spare[i]] = 1;
      settles[spare[i]] = places[i].is_around || is_on_boundary(mesh, places[i].point) ? 0 : 1;
      result.is_around[spare[i]] = places[i].is_around ? 1 : 0;
    }
    next.restore(relaxation, here.part(0.1, 0.3));
    relaxation.rest(others_than(settles));
    for (int step = 0; step < k_settling_steps && relaxation.advance_to_centers(here.part(0.3, 1)); ++step) {}
  }
  return result;
}

/// Relaxes as far as nothing breaks the property, all but the sites that are to stay.
void relax_closed(Relaxation& relaxation, const CentroidalVoronoiOptions& options, const JobStage& stage,
                  std::vector<std::uint8_t> stays, RelaxationLog& log) {
  relaxation.rest(stays);
  Places whole(relaxation);
  show(relaxation, options, log);
  for (int vain = 0; log.stop_reason.empty() && vain < k_most_vain_runs;) {
    RelaxationLog longer = log;
    const double done = static_cast<double>(log.iterations) / std::max(options.stop.max_iterations, 1);
    const JobStage looking = stage.part(done, done);
    try {
      for (int i = 0; i < k_steps_a_look && longer.stop_reason.empty(); ++i)
        take_step(relaxation, options, stage, longer);
      if (longer.iterations == log.iterations) {
        log = std::move(longer);
        break;
      }
      const GeodesicVoronoi cells = look_at_cells(relaxation, options, looking);
      const std::vector<DualIssue> issues = find_dual_issues(relaxation.mesh(), cells, looking);
      if (issues.empty()) {
        log = std::move(longer);
        whole = Places(relaxation);
        show(relaxation, options, log);
        continue;
      }
      mark_more(cells, issues, stays);
    } catch (const Cancelled&) {
      if (options.stop.return_when_cancelled) whole.restore(relaxation, JobStage());
      throw;
    }
    whole.restore(relaxation, looking);
    relaxation.rest(stays);
    ++vain;
  }
  if (!log.stop_reason.empty()) return;
  log.converged = true;
  log.stop_reason = "closed_ball";
}

}  // namespace

void close_balls(Relaxation& relaxation, const CentroidalVoronoiOptions& options, const JobStage& stage,
                 RelaxationLog& log, Exchange& result) {
  const Places before(relaxation);
  Exchanged exchanged;
  try {
    exchanged = exchange(relaxation, options, stage.part(0, k_exchange));
  } catch (const Cancelled&) {
    if (options.stop.return_when_cancelled) before.restore(relaxation, JobStage());
    throw;
  }
  result = std::move(exchanged.told);
  if (!result.left.empty()) before.restore(relaxation, stage.part(k_exchange, 1));
  if (result.moved == 0) return;
  log = log_of_start(relaxation);
  relax_closed(relaxation, options, stage.part(k_exchange, 1), std::move(exchanged.is_around), log);
}

}  // namespace saddleback
