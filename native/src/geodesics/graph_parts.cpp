// A range's windows run on tables for its nodes and a halo about them. Which windows go how far is not known before: a
// block whose windows left the tables is found again, on tables for such blocks and a halo twice as wide, until the
// last is found. So every arc is found on the very numbers that tables for the whole mesh hold.

#include "saddleback/geodesics/graph_parts.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <numeric>
#include <utility>

#include "saddleback/error.h"

#include "geodesics/graph/disk_arcs.h"
#include "geodesics/graph/graph_arcs.h"
#include "geodesics/graph/lattice.h"
#include "geodesics/graph/path_bound.h"
#include "geodesics/graph_checks.h"
#include "geodesics/node_order.h"
#include "geodesics/part_bytes.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

// Shares of the time, until then: nodes ordered, paths bounded.
constexpr double k_ordered = 0.02, k_bounded = 0.06;
// And of the rest: tables laid, the first search.
constexpr double k_laid = 0.1, k_searched = 0.9;
// Rings of LaidNodes. From an eighth of the blocks windows went further than 6, from one in 300 further than 12: for
// those tables are laid again.
constexpr int k_first_halo = 12;

void check_threads(int threads) {
  if (threads < 0) throw InputError(message("threads: wanted 0 (all) or more, got ", threads));
}

std::vector<Index> nodes_of(std::span<const Index> blocks, Index node_count) {
  std::vector<Index> nodes;
  for (const Index block : blocks) {
    const Index end = std::min(node_count, (block + 1) * k_nodes_a_block);
    for (Index node = block * k_nodes_a_block; node < end; ++node) nodes.push_back(node);
  }
  return nodes;
}

PartBytes bytes_of(PartHeader header, std::span<const KeptArcs> blocks) {
  std::uint64_t arc_count = 0;
  for (const KeptArcs& block : blocks) arc_count += block.back_sectors.size();
  PartWriter writer(header, arc_count);
  for (const KeptArcs& block : blocks) writer.append(block.words.first(block.back_sectors.size()));
  writer.append_padding();
  for (const KeptArcs& block : blocks) writer.append(block.counts);
  for (const KeptArcs& block : blocks) writer.append(block.back_sectors);
  return writer.finish();
}

/// Finds the arcs of the range's blocks.
std::vector<KeptArcs> find_blocks(const ArcSearch& search, const ArcCodec& codec, const DiskRule& rule,
                                  const PartRange& range, JobStage stage) {
  std::vector<Index> blocks(block_count(range.count));
  std::iota(blocks.begin(), blocks.end(), range.first / k_nodes_a_block);
  std::vector<KeptArcs> found(blocks.size());
  for (int halo = k_first_halo; !blocks.empty(); halo *= 2) {
    const LaidNodes laid(search.unfolding.mesh(), search.nodes, search.vertices,
                         nodes_of(blocks, static_cast<Index>(search.nodes.size())), halo);
    const WaveTables tables(search.unfolding, laid, search.nodes, search.vertices, search.threads,
                            stage.part(0, k_laid));
    auto some = disk_arcs_of(blocks, search, codec, tables, rule, stage.part(k_laid, k_searched));
    std::vector<Index> left;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
      if (some[i].counts.empty()) {
        left.push_back(blocks[i]);
      } else {
        found[blocks[i] - range.first / k_nodes_a_block] = std::move(some[i]);
      }
    }
    blocks = std::move(left);
    stage = stage.part(k_searched, 1);
  }
  return found;
}

/// The parts in order. \throw InputError unless each of them is there once.
std::vector<const PartView*> in_order(std::span<const PartView> views) {
  std::vector<const PartView*> ordered(views.front().header().parts, nullptr);
  for (const PartView& view : views) {
    view.check_same_graph(views.front());
    if (view.header().kind != views.front().header().kind) {
      throw InputError(message(view.name(), ": found and united arcs do not go together; unite all parts or none"));
    }
    const PartView*& place = ordered[view.header().part];
    if (place) {
      throw InputError(message("parts: part ", view.header().part, " of ", ordered.size(), " is given twice, as ",
                               place->name(), " and ", view.name(), "; give each once"));
    }
    place = &view;
  }
  const auto missing = std::ranges::find(ordered, nullptr);
  if (missing != ordered.end()) {
    throw InputError(message("parts: part ", missing - ordered.begin(), " of ", ordered.size(),
                             " is missing; give the arcs of all parts"));
  }
  return ordered;
}

ArcRows rows_of_found(const ArcCodec& codec, const WaveKernel& kernel, std::span<const PartView* const> parts,
                      int threads, const JobStage& stage) {
  std::vector<KeptArcs> blocks;
  for (const PartView* part : parts) std::ranges::move(part->blocks(), std::back_inserter(blocks));
  return unite_with_reverses(codec, kernel, blocks, {}, threads, stage);
}

ArcRows rows_of_united(const ArcCodec& codec, std::span<const PartView* const> parts, int threads,
                       const JobStage& stage) {
  std::vector<std::int64_t> offsets{0};
  std::vector<std::int64_t> firsts;
  for (const PartView* part : parts) {
    firsts.push_back(offsets.back());
    for (const std::int32_t degree : part->numbers()) offsets.push_back(offsets.back() + degree);
  }
  ArcWords words(offsets.back());
  parallel_for(static_cast<Index>(parts.size()), threads, 1, [&](Index i, int) {
    stage.check();
    std::ranges::copy(parts[i]->words(), words.begin() + firsts[i]);
  });
  return {codec, std::move(offsets), std::move(words)};
}

}  // namespace

void check_graph_size(std::int64_t triangle_count) { check_mesh_size(triangle_count); }

PartBytes find_arcs(const Mesh& mesh, Index part, Index parts, const SaddleVertexGraphOptions& options, Job* job) {
  if (parts < 1) throw InputError(message("parts: wanted at least 1, got ", parts));
  if (part < 0 || part >= parts)
    throw InputError(message("part: wanted 0 to ", parts - 1, ", since there are ", parts, " parts, got ", part));
  check_options(mesh, options);
  if (options.exact || !options.cuda_devices.empty())
    throw InputError("exact, device: parts are found by k or accuracy, on the processor");
  check_graph_size(mesh.face_count());
  const JobStage stage(job, "Finding arcs");
  PartHeader header;
  header.fingerprint = mesh.fingerprint();
  header.vertex_count = static_cast<std::uint64_t>(mesh.vertex_count());
  header.face_count = static_cast<std::uint64_t>(mesh.face_count());
  header.k = static_cast<std::uint32_t>(options.k);
  header.accuracy =
      options.k == 0 && options.accuracy == 0 ? SaddleVertexGraphOptions::k_default_accuracy : options.accuracy;
  header.part = header.from = part;
  header.parts = parts;
  const PartRange range = range_of(part, parts, mesh.vertex_count());
  header.first_node = range.first;
  header.node_count = range.count;

  const Unfolding unfolding(mesh);
  const NodeOrder order(mesh, options.threads, stage.part(0, k_ordered));
  const ArcCodec codec(
      mesh.vertex_count(), mesh.mean_edge_length(),
      path_bounds(mesh, order.nodes, order.vertices, options.threads, stage.part(k_ordered, k_bounded)));
  header.codec = codec.parts();
  const ArcSearch search{unfolding, order.nodes, order.vertices, wave_kernel(options.instructions), options.threads};
  const Lattice lattice = header.accuracy > 0 ? lattice_of(unfolding, options.threads, stage) : Lattice::none;
  const auto found =
      find_blocks(search, codec, disk_rule(options.k, header.accuracy, lattice), range, stage.part(k_bounded, 1));
  PartBytes bytes = bytes_of(header, found);
  stage.update(1);
  return bytes;
}

PartBytes arcs_across(std::span<const std::byte> arcs, Index part) {
  const PartView view(arcs, PartKind::found, "arcs");
  PartHeader header = view.header();
  if (part < 0 || part >= header.parts || part == header.part) {
    throw InputError(message("part: wanted one of the ", header.parts, " parts other than that of the arcs (",
                             header.part, "), got ", part));
  }
  const ArcCodec codec(header.codec);
  const PartRange range = range_of(part, header.parts, static_cast<Index>(header.vertex_count));
  std::vector<std::uint64_t> words;
  std::vector<std::int32_t> nodes;
  std::size_t arc = 0;
  for (std::size_t row = 0; row < view.numbers().size(); ++row) {
    for (const std::size_t end = arc + static_cast<std::size_t>(view.numbers()[row]); arc < end; ++arc) {
      const std::uint64_t word = view.words()[arc];
      const Index target = codec.target(word);
      if (target < range.first || target - range.first >= range.count) continue;
      const Index node = view.header().first_node + static_cast<Index>(row);
      words.push_back(codec.packing().reversed(node, view.back_sectors()[arc], word));
      nodes.push_back(target);
    }
  }
  header.kind = PartKind::across;
  header.part = part;
  header.first_node = range.first;
  header.node_count = range.count;
  PartWriter writer(header, words.size());
  writer.append(std::span<const std::uint64_t>(words));
  writer.append(std::span<const std::int32_t>(nodes));
  return writer.finish();
}

PartBytes unite_arcs(std::span<const std::byte> arcs, std::span<const std::span<const std::byte>> across, int threads,
                     Job* job) {
  check_threads(threads);
  const JobStage stage(job, "Uniting arcs");
  const PartView own(arcs, PartKind::found, "arcs");
  PartHeader header = own.header();
  std::vector<PartView> others;
  others.reserve(across.size());
  std::vector<bool> is_there(header.parts, false);
  is_there[header.part] = true;
  std::vector<ArcsAcross> reverses;
  for (const std::span<const std::byte> bytes : across) {
    const PartView& other = others.emplace_back(bytes, PartKind::across, message("across[", others.size(), "]"));
    stage.check();
    other.check_same_graph(own);
    const PartHeader& there = other.header();
    if (there.part != header.part) {
      throw InputError(message(other.name(), ": its arcs lead into part ", there.part, ", and this is part ",
                               header.part, "; give arcs_across(other, ", header.part, ") of each other part"));
    }
    if (is_there[there.from]) {
      throw InputError(message("across: the arcs from part ", there.from,
                               " are given twice, or are the part's own; give those of each other part once"));
    }
    is_there[there.from] = true;
    reverses.push_back({other.numbers(), other.words()});
  }
  if (const auto missing = std::ranges::find(is_there, false); missing != is_there.end()) {
    throw InputError(message("across: the arcs from part ", missing - is_there.begin(), " of ", header.parts,
                             " are missing; give those of each other part"));
  }
  const ArcCodec codec(header.codec);
  auto blocks = own.blocks();
  const ArcRows rows =
      blocks.empty() ? ArcRows()
                     : unite_with_reverses(codec, wave_kernel("auto"), blocks, reverses, threads, stage.part(0, 0.9));
  header.kind = PartKind::united;
  std::vector<std::int32_t> degrees(static_cast<std::size_t>(header.node_count));
  for (Index row = 0; row < header.node_count; ++row)
    degrees[row] = static_cast<std::int32_t>(rows.first(row + 1) - rows.first(row));
  PartWriter writer(header, static_cast<std::uint64_t>(rows.count()));
  writer.append(rows.words());
  writer.append(std::span<const std::int32_t>(degrees));
  PartBytes bytes = writer.finish();
  stage.update(1);
  return bytes;
}

SaddleVertexGraph SaddleVertexGraph::from_parts(const Mesh& mesh, std::span<const std::span<const std::byte>> parts,
                                                int threads, Job* job) {
  check_threads(threads);
  const JobStage stage(job, "Joining the graph");
  const auto started = std::chrono::steady_clock::now();
  if (parts.empty()) throw InputError("parts: wanted the arcs of all parts, got none");
  std::vector<PartView> views;
  views.reserve(parts.size());
  for (const std::span<const std::byte> bytes : parts) {
    stage.check();
    views.emplace_back(bytes, PartKind::found, PartKind::united, message("parts[", views.size(), "]"));
  }
  const auto ordered = in_order(views);
  const PartHeader& header = views.front().header();
  if (header.fingerprint != mesh.fingerprint() ||
      header.vertex_count != static_cast<std::uint64_t>(mesh.vertex_count()) ||
      header.face_count != static_cast<std::uint64_t>(mesh.face_count())) {
    throw InputError(message("parts: these are the arcs of another mesh (with ", header.vertex_count, " vertices and ",
                             header.face_count, " faces; this one has ", mesh.vertex_count(), " and ",
                             mesh.face_count(), "); give that mesh"));
  }
  SaddleVertexGraph graph;
  graph.mesh_ = &mesh;
  graph.k_ = static_cast<Index>(header.k);
  graph.accuracy_ = header.accuracy;
  NodeOrder order(mesh, threads, stage.part(0, 0.1));
  graph.vertices_ = std::move(order.vertices);
  graph.nodes_ = std::move(order.nodes);
  const ArcCodec codec = graph.codec_of_mesh(stage.part(0.1, 0.2));
  if (codec.parts() != header.codec) views.front().refuse("these bytes are damaged: their lengths are in another unit");
  graph.unfolding_ = std::make_unique<Unfolding>(mesh, threads, stage.part(0.2, 0.3));
  const JobStage joining = stage.part(0.3, 1);
  graph.arcs_ = std::make_unique<ArcRows>(header.kind == PartKind::found
                                              ? rows_of_found(codec, *graph.kernel_, ordered, threads, joining)
                                              : rows_of_united(codec, ordered, threads, joining));
  graph.build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  stage.update(1);
  return graph;
}

}  // namespace saddleback
