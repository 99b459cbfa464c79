// Building the graph: a window propagation from every vertex, then the union of arcs and reverse arcs in flat arrays.

#include "saddleback/geodesics/saddle_vertex_graph.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>

#include "saddleback/error.h"

#include "geodesics/graph/arc_symmetry.h"
#include "geodesics/graph/graph_arcs.h"
#include "geodesics/graph/graph_arcs_cuda.h"
#include "geodesics/graph/lattice.h"
#include "geodesics/graph/path_bound.h"
#include "geodesics/queries/query_cache.h"
#include "geodesics/unfolding/arc_unfolding.h"
#include "mesh/tables/hilbert.h"
#include "mesh/tables/key_order.h"
#include "support/cuda/pinned_memory.h"
#include "support/threads/parallel.h"

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

// Shares of the time in which tables are laid, until the end of each: angles unfolded, nodes ordered, tables for waves,
// the bound of paths. The rest takes the search for a lattice.
constexpr double k_unfolded = 0.1, k_ordered = 0.16, k_laid_for_waves = 0.86, k_bounded = 0.93;

// Shares of the time of a build, until tables are laid and until arcs are found; the rest joins them with their
// reverses.
constexpr double k_laid = 0.15, k_found = 0.85;

}  // namespace

SaddleVertexGraph::SaddleVertexGraph(const Mesh& mesh, const SaddleVertexGraphOptions& options, Job* job)
    : SaddleVertexGraph(mesh, options, JobStage(job, "Building the saddle vertex graph")) {}

SaddleVertexGraph::SaddleVertexGraph(const Mesh& mesh, const SaddleVertexGraphOptions& options, const JobStage& stage)
    : mesh_(&mesh), k_(options.k), accuracy_(options.accuracy), exact_(options.exact) {
  check_options(mesh, options);
  if (k_ == 0 && accuracy_ == 0 && !exact_) accuracy_ = SaddleVertexGraphOptions::k_default_accuracy;
  const bool on_device = !options.cuda_devices.empty();  // which lays tables of its own
  if (on_device && exact_)
    throw DeviceError("device: exact graphs are built on the CPU only; use device=\"auto\" or \"cpu\"");
  kernel_ = &wave_kernel(options.instructions);
  const auto started = std::chrono::steady_clock::now();
  const JobStage laying = stage.part(0, k_laid);
  unfolding_ = std::make_unique<Unfolding>(mesh, options.threads, laying.part(0, k_unfolded));
  order_nodes(options.threads, laying.part(k_unfolded, k_ordered));
  std::optional<WaveTables> tables;
  if (on_device) check_mesh_size(mesh);
  if (!exact_ && !on_device)
    tables.emplace(*unfolding_, nodes_, vertices_, options.threads, laying.part(k_ordered, k_laid_for_waves));
  const JobStage bounding = laying.part(tables ? k_laid_for_waves : k_ordered, k_bounded);
  const auto choose_codec = [&] {
    const PathBounds bounds = tables ? path_bounds(tables->mesh, options.threads, bounding)
                                     : path_bounds(mesh, nodes_, vertices_, options.threads, bounding);
    bounding.update(1);
    return ArcCodec(mesh.vertex_count(), mesh.mean_edge_length(), bounds);
  };
  const DiskRule rule =
      disk_rule(k_, accuracy_, accuracy_ > 0 ? lattice_of(*unfolding_, options.threads, stage) : Lattice::none);
  const ArcSearch search{*unfolding_, nodes_, vertices_, *kernel_, options.threads};
  if (on_device) {
    ArcWords room(options.is_pinned ? &pinned_memory() : nullptr);
    arcs_ = std::make_unique<ArcRows>(cuda_arcs(search, choose_codec, rule, options.cuda_devices, std::move(room),
                                                device_times_, stage.part(k_laid, 1)));
    built_by_cuda_ = true;
    stage.update(1);
    build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
    return;
  }
  const ArcCodec codec = choose_codec();
  const JobStage finding = stage.part(k_laid, k_found);
  auto found = exact_ ? exact_arcs(search, codec, finding) : disk_arcs(search, codec, *tables, rule, finding);
  tables.reset();
  arcs_ =
      std::make_unique<ArcRows>(unite_with_reverses(codec, *kernel_, found, options.threads, stage.part(k_found, 1)));
  build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
}

void SaddleVertexGraph::order_nodes(int threads, const JobStage& stage) {
  const HilbertCurve curve(mesh_->positions());
  std::vector<std::uint64_t> keys(mesh_->vertex_count());
  parallel_for(mesh_->vertex_count(), threads, 4096, [&](Index v, int) {
    stage.check();
    keys[v] = curve.key(mesh_->position(v));
  });
  vertices_ = order_of(keys, threads, stage);
  nodes_.resize(mesh_->vertex_count());
  parallel_for(mesh_->vertex_count(), threads, 4096, [&](Index node, int) { nodes_[vertices_[node]] = node; });
}

SaddleVertexGraph::~SaddleVertexGraph() = default;
SaddleVertexGraph::SaddleVertexGraph(SaddleVertexGraph&&) noexcept = default;

std::int64_t SaddleVertexGraph::arc_count() const { return arcs_->count(); }

std::size_t SaddleVertexGraph::nbytes() const {
  return arcs_->nbytes() + (nodes_.size() + vertices_.size()) * sizeof(Index);
}

ArcHint SaddleVertexGraph::hint(Index node, std::int64_t arc) const {
  // The angle was known to this many radians and rounded down to a sector: it may lie on the other side of the border.
  constexpr double k_margin = 3e-5;
  const Index vertex = vertices_[node];
  const double sector = arcs_->sector(arc), width = mesh_->total_angle(vertex) / ArcCodec::k_sectors;
  ArcHint hint{vertex, vertices_[arcs_->target(arc)], arcs_->length(arc), sector * width - k_margin,
               (sector + 1) * width + k_margin};
  hint.tolerance = std::max(hint.tolerance, arcs_->codec().shortest() / hint.length);
  return hint;
}

}  // namespace saddleback
