// Building the graph: a window propagation from every vertex, then the union of arcs and reverse arcs in flat arrays.

#include "saddleback/saddle_vertex_graph.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "saddleback/error.h"

#include "geodesics/arc_symmetry.h"
#include "geodesics/arc_unfolding.h"
#include "geodesics/graph_arcs.h"
#include "geodesics/lattice.h"
#include "geodesics/path_bound.h"
#include "geodesics/twin_arcs.h"
#include "mesh/hilbert.h"
#include "support/parallel.h"

namespace saddleback {
namespace {

void check_options(const Mesh& mesh, const SaddleVertexGraphOptions& options) {
  if ((options.k != 0) + (options.accuracy != 0) + options.exact > 1)
    throw InputError("k, accuracy, exact: give one of them; each says how the graph is built");
  if (options.k < 0) throw InputError(message("k: wanted at least 1 vertex per geodesic disk, got ", options.k));
  if (options.k > mesh.vertex_count()) {
    throw InputError(message("k: ", options.k, " vertices per geodesic disk are more than the mesh has (",
                             mesh.vertex_count(), ")"));
  }
  if (!(options.accuracy >= 0 && options.accuracy < 1)) {
    throw InputError(
        message("accuracy: wanted a relative error above 0 and below 1, such as 0.005 for half a percent, "
                "got ",
                options.accuracy));
  }
  if (options.threads < 0) throw InputError(message("threads: wanted 0 (all) or more, got ", options.threads));
}

/// How the time of a build is spread: shares at which the tables are laid and all arcs found.
struct BuildTimes {
  double laid = 0, found = 0.99;
};
// Microseconds a vertex on one machine, of which only ratios matter; nothing is much beside exact disks.
BuildTimes build_times(Index k, double accuracy, bool exact) {
  if (exact) return {};
  constexpr double k_laying = 0.75;
  const double fineness = SaddleVertexGraphOptions::k_default_accuracy / accuracy;
  const double finding = k > 0 ? 0.25 * k : 9.5 * std::pow(fineness, 0.65);
  const double joining = k > 0 ? 0.014 * k : 0.65 * std::pow(fineness, 0.45);
  const double all = k_laying + finding + joining;
  return {k_laying / all, (k_laying + finding) / all};
}

}  // namespace

SaddleVertexGraph::SaddleVertexGraph(const Mesh& mesh, const SaddleVertexGraphOptions& options, Job* job)
    : mesh_(&mesh), k_(options.k), accuracy_(options.accuracy), exact_(options.exact) {
  check_options(mesh, options);
  if (k_ == 0 && accuracy_ == 0 && !exact_) accuracy_ = SaddleVertexGraphOptions::k_default_accuracy;
  kernel_ = &wave_kernel(options.instructions);
  const auto started = std::chrono::steady_clock::now();
  const JobStage stage(job, "Building the saddle vertex graph");
  const BuildTimes times = build_times(k_, accuracy_, exact_);
  unfolding_ = std::make_unique<Unfolding>(mesh, options.threads, stage);
  stage.update(times.laid / 4);
  order_nodes(options.threads, stage);
  stage.update(times.laid / 2);
  std::optional<WaveTables> tables;
  if (!exact_) tables.emplace(*unfolding_, nodes_, vertices_, options.threads, stage.part(0, 0));
  const double longest = tables ? longest_path_bound(tables->mesh, options.threads, stage)
                                : longest_path_bound(mesh, nodes_, vertices_, options.threads, stage);
  const ArcCodec codec(mesh.vertex_count(), mesh.mean_edge_length(), longest);
  const DiskRule rule = disk_rule(k_, accuracy_, accuracy_ > 0 ? lattice_of(*unfolding_, stage) : Lattice::none);
  const ArcSearch search{*unfolding_, nodes_, vertices_, codec, *kernel_, options.threads};
  if (!options.cuda_devices.empty()) {
    if (exact_) throw DeviceError("device: exact graphs are built on the CPU only; use device=\"auto\" or \"cpu\"");
    arcs_ = twin_arcs(search, *tables, rule, options.cuda_devices, device_times_, stage);
    built_by_cuda_ = true;
    build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    return;
  }
  const JobStage finding = stage.part(times.laid, times.found);
  auto found = exact_ ? exact_arcs(search, finding) : disk_arcs(search, *tables, rule, finding);
  tables.reset();
  arcs_ = unite_with_reverses(codec, *kernel_, found, k_block, options.threads, stage.part(times.found, 1));
  build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
}

void SaddleVertexGraph::order_nodes(int threads, const JobStage& stage) {
  const HilbertCurve curve(mesh_->positions());
  std::vector<std::uint64_t> keys(mesh_->vertex_count());
  parallel_for(mesh_->vertex_count(), threads, 4096, [&](Index v, int) {
    stage.check();
    keys[v] = curve.key(mesh_->position(v));
  });
  vertices_ = order_of(keys, stage);
  nodes_.resize(mesh_->vertex_count());
  for (Index node = 0; node < mesh_->vertex_count(); ++node) nodes_[vertices_[node]] = node;
}

SaddleVertexGraph::~SaddleVertexGraph() = default;
SaddleVertexGraph::SaddleVertexGraph(SaddleVertexGraph&&) noexcept = default;

std::size_t SaddleVertexGraph::nbytes() const {
  return arcs_.nbytes() + (nodes_.size() + vertices_.size()) * sizeof(Index);
}

ArcHint SaddleVertexGraph::hint(Index node, std::int64_t arc) const {
  // The angle was known to this many radians and rounded down to a sector: it may lie on the other side of the border.
  constexpr double k_margin = 3e-5;
  const Index vertex = vertices_[node];
  const double sector = arcs_.sector(arc), width = mesh_->total_angle(vertex) / ArcCodec::k_sectors;
  return {vertex, vertices_[arcs_.target(arc)], arcs_.length(arc), sector * width - k_margin,
          (sector + 1) * width + k_margin};
}

}  // namespace saddleback
