#include "geodesics/graph/graph_arcs_cuda.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include "geodesics/graph/arcs_abi.h"
#include "geodesics/graph/disk_arcs.h"
#include "support/cuda/cuda_callbacks.h"
#include "support/cuda/pinned_memory.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

/// Answers the calls of the CUDA module.
class Caller {
 public:
  Caller(const ArcSearch& search, const std::function<ArcCodec()>& choose_codec, const DiskRule& rule, ArcWords room,
         const JobStage& stage)
      : search_(search), choose_codec_(choose_codec), rule_(rule), stage_(stage), words_(std::move(room)) {}

  ArcsCaller calls() {
    return {this,
            [](void* self, double fraction) {
              auto& caller = *static_cast<Caller*>(self);
              return caller.guard_.run([&] { caller.stage_.update(fraction); });
            },
            [](void* self, ArcPacking* packing) {
              auto& caller = *static_cast<Caller*>(self);
              return caller.guard_.run([&] { *packing = caller.codec_.emplace(caller.choose_codec_()).packing(); });
            },
            [](void* self, const std::int32_t* nodes, std::int32_t count, FoundRows* rows) {
              auto& caller = *static_cast<Caller*>(self);
              return caller.guard_.run([&] { *rows = caller.find_rows({nodes, static_cast<std::size_t>(count)}); });
            },
            [](void* self, std::int64_t words, std::int64_t** offsets_to, std::uint64_t** words_to) {
              auto& caller = *static_cast<Caller*>(self);
              return caller.guard_.run([&] {
                caller.offsets_.resize(caller.search_.vertices.size() + 1);
                caller.make_room(static_cast<std::size_t>(words));
                *offsets_to = caller.offsets_.data();
                *words_to = caller.words_.data();
              });
            }};
  }
  const CudaGuard& guard() const { return guard_; }
  ArcRows take() { return {*codec_, std::move(offsets_), std::move(words_)}; }

 private:
  void make_room(std::size_t words) {
    if (words > words_.capacity()) {
      words_ = ArcWords(words_.get_allocator());  // nothing is to be copied
      if (words_.get_allocator().source == &pinned_memory())
        make_pinned_room(words * sizeof words_[0], search_.threads, stage_.part(0, 0));
    }
    words_.resize(words);
  }

  /// Finds the rows in the batches in which disk_arcs finds them: what ends the windows of one is the same then.
  FoundRows find_rows(std::span<const Index> nodes) {
    if (!tables_)
      tables_.emplace(search_.unfolding, search_.nodes, search_.vertices, search_.threads, stage_.part(0, 0));
    std::vector<std::span<const Index>> batches;
    for (std::size_t i = 0; i < nodes.size();) {
      std::size_t end = i + 1;
      while (end < nodes.size() && nodes[end] / k_batch == nodes[i] / k_batch) ++end;
      batches.push_back(nodes.subspan(i, end - i));
      i = end;
    }
    std::vector<FoundArcs> found(batches.size());
    std::vector<std::unique_ptr<DiskRows>> finders(thread_count(search_.threads));
    parallel_for(static_cast<Index>(batches.size()), search_.threads, 1, [&](Index b, int thread) {
      if (!finders[thread]) finders[thread] = std::make_unique<DiskRows>(search_, *tables_, *codec_, rule_);
      const Index first = batches[b].front() / k_batch * k_batch;
      const Index count = std::min(k_batch, static_cast<Index>(search_.vertices.size()) - first);
      found[b].first_node = first;
      finders[thread]->find(first, count, found[b], stage_);
    });
    counts_.clear();
    row_words_.clear();
    back_sectors_.clear();
    for (std::size_t b = 0; b < batches.size(); ++b) append_rows(found[b], batches[b]);
    return {counts_.data(), row_words_.data(), back_sectors_.data(), row_words_.size()};
  }

  void append_rows(const FoundArcs& found, std::span<const Index> nodes) {
    std::size_t begin = 0, next = 0;
    for (std::size_t i = 0; i < found.counts.size() && next < nodes.size(); ++i) {
      const std::size_t end = begin + static_cast<std::size_t>(found.counts[i]);
      if (found.first_node + static_cast<Index>(i) == nodes[next]) {
        ++next;
        counts_.push_back(found.counts[i]);
        row_words_.insert(row_words_.end(), found.words.begin() + begin, found.words.begin() + end);
        back_sectors_.insert(back_sectors_.end(), found.back_sectors.begin() + begin, found.back_sectors.begin() + end);
      }
      begin = end;
    }
  }

  const ArcSearch& search_;
  const std::function<ArcCodec()>& choose_codec_;
  std::optional<WaveTables> tables_;  ///< the device has its own
  const DiskRule& rule_;
  const JobStage& stage_;
  CudaGuard guard_;
  std::optional<ArcCodec> codec_;
  std::vector<std::int64_t> offsets_;
  ArcWords words_;
  std::vector<std::int32_t> counts_;
  std::vector<std::uint64_t> row_words_;
  std::vector<std::uint8_t> back_sectors_;
};

}  // namespace

ArcRows cuda_arcs(const ArcSearch& search, const std::function<ArcCodec()>& choose_codec, const DiskRule& rule,
                  std::span<const int> devices, ArcWords room, DeviceTimes& times, const JobStage& stage) {
  const CudaModule& cuda = loaded_cuda_module();
  const Mesh& mesh = search.unfolding.mesh();
  const WaveScene scene = wave_scene(nullptr, rule);
  ArcsRequest request;
  request.devices = devices.data();
  request.device_count = static_cast<int>(devices.size());
  request.most_bytes = cuda_memory_limit();
  request.k = rule.k;
  request.detour = scene.detour;
  request.per_detour = scene.per_detour;
  request.excess = scene.excess;
  request.slack = arc_slack(rule);
  request.node_count = mesh.vertex_count();
  request.edge_count = mesh.halfedge_count();
  request.triangles = mesh.triangles().front().data();
  request.twins = mesh.twins().data();
  request.lengths = mesh.lengths().data();
  request.polars = search.unfolding.polars().data();
  request.face_areas = mesh.face_areas().data();
  request.first_halfedges = mesh.first_halfedges().data();
  request.total_angles = mesh.total_angles().data();
  request.saddles = mesh.saddles().data();
  request.nodes = search.nodes.data();
  request.vertices = search.vertices.data();
  request.unit = mesh.mean_edge_length();
  request.sector_count = ArcCodec::k_sectors;
  request.is_callers = rule.k == 0 && !border_rows(mesh).empty();

  Caller caller(search, choose_codec, rule, std::move(room), stage);
  CudaReason reason;
  caller.guard().check(cuda.find_arcs(request, caller.calls(), times, reason), reason);
  return caller.take();
}

}  // namespace saddleback
