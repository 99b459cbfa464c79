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
#include "geodesics/graph_checks.h"
#include "geodesics/node_order.h"
#include "geodesics/queries/query_cache.h"
#include "geodesics/unfolding/arc_unfolding.h"
#include "support/cuda/pinned_memory.h"

namespace saddleback {
namespace {

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
  NodeOrder order(mesh, options.threads, laying.part(k_unfolded, k_ordered));
  vertices_ = std::move(order.vertices);
  nodes_ = std::move(order.nodes);
  std::optional<WaveTables> tables;
  if (on_device) check_mesh_size(mesh.face_count());
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
  arcs_ = std::make_unique<ArcRows>(
      unite_with_reverses(codec, *kernel_, found, {}, options.threads, stage.part(k_found, 1)));
  build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
}

SaddleVertexGraph::~SaddleVertexGraph() = default;
SaddleVertexGraph::SaddleVertexGraph(SaddleVertexGraph&&) noexcept = default;

const Unfolding& SaddleVertexGraph::unfolding() const { return unfolding_ ? *unfolding_ : queries_->unfolding(*mesh_); }

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
