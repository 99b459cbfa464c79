// Distance fields and nearest sources on a CUDA device, in a graph that is kept there. The answer is the processor's,
// to the bit.

#include <algorithm>
#include <bit>
#include <chrono>
#include <memory>
#include <span>
#include <thread>

#include "geodesics/cuda/device_search.cuh"
#include "geodesics/cuda/device_search.h"
#include "support/cuda/device_buffer.h"
#include "support/cuda/device_stream.h"
#include "support/cuda/host_copies.h"

namespace saddleback {

namespace {

/// A word of host memory that kernels look at.
class StopFlag {
 public:
  StopFlag() { check_cuda(cudaHostAlloc(&flag_, sizeof(unsigned), cudaHostAllocMapped), "asking for pinned memory"); }
  ~StopFlag() { (void)cudaFreeHost(flag_); }
  StopFlag(const StopFlag&) = delete;
  StopFlag& operator=(const StopFlag&) = delete;
  void lower() { *static_cast<volatile unsigned*>(flag_) = 0; }
  void raise() { *static_cast<volatile unsigned*>(flag_) = 1; }
  const unsigned* on_device() const {
    unsigned* pointer = nullptr;
    check_cuda(cudaHostGetDevicePointer(&pointer, flag_, 0), "asking for pinned memory");
    return pointer;
  }

 private:
  unsigned* flag_ = nullptr;
};

/// Holds what a search works with, left to the next.
struct SearchTools {
  Stream stream;
  Stopwatch watch{stream};
  StopFlag stop;
};

}  // namespace

struct CudaGraph {
  CudaGraph(const CudaGraphRequest& r)
      : device(r.device),
        node_count(r.node_count),
        offsets({r.offsets, static_cast<std::size_t>(r.node_count) + 1}, stream),
        words(static_cast<std::size_t>(r.arc_count), stream),
        nodes({r.nodes, static_cast<std::size_t>(r.node_count)}, stream),
        graph{offsets.data(),        words.data(),          r.node_count,   bits_of_words(r.node_count),
              r.packing.target_mask, r.packing.length_mask, r.packing.bias, r.packing.kept_shift} {}

  int device;
  std::int32_t node_count;
  Stream stream;
  DeviceBuffer<std::int64_t> offsets;
  DeviceBuffer<std::uint64_t> words;
  DeviceBuffer<std::int32_t> nodes;
  DeviceGraph graph;
  mutable ScratchPool<SearchTools> tools;

 private:
  /// A word has a bit for 32 nodes.
  static int bits_of_words(std::int32_t node_count) {
    return std::countr_zero(std::bit_ceil((static_cast<std::uint32_t>(node_count) + 31) / 32));
  }
};

namespace {

std::uint64_t bytes_of_field(const CudaGraph& graph, bool with_sources) {
  const auto nodes = static_cast<std::uint64_t>(graph.node_count);
  return 2 * nodes * (with_sources ? 12 : 8) + 8 * (std::uint64_t{1} << graph.graph.word_bits) + sizeof(TeamBoard);
}

/// Holds how many fields a launch finds, by how many blocks each: all run at once.
struct Teams {
  std::int32_t fields;
  int blocks;
  double steps;  ///< by how many a front advances at once
};

Teams teams(const CudaGraph& graph, const SearchRequest& request) {
  int per_processor = 0, processors = 0;
  check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&per_processor, search_fields, k_search_threads, 0),
             "asking for occupancy");
  check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, graph.device),
             "asking for the number of processors");
  std::size_t free = 0, total = 0;
  check_cuda(cudaMemGetInfo(&free, &total), "asking for free memory");
  const std::uint64_t room = request.most_bytes > 0 ? std::min<std::uint64_t>(free, request.most_bytes) : free;
  const std::uint64_t each = bytes_of_field(graph, request.sources);
  check_device_room("a distance field", each, room);
  const int blocks = std::max(1, per_processor) * processors;
  const auto fits = static_cast<std::int32_t>(std::min<std::uint64_t>(room / each, 1 << 20));
  const std::int32_t fields = std::min({request.field_count, fits, blocks});
  // A large team waits for one another longer than it works, and would rather do some of it in vain.
  const int team = std::min(blocks / fields, 2 * processors);
  return {fields, team, team >= processors ? 3.0 : 1.0};
}

class Searcher {
 public:
  Searcher(const CudaGraph& graph, const SearchRequest& request, const SearchCaller& caller, DeviceTimes& times)
      : graph_(graph), request_(request), caller_(caller), times_(times), tools_(graph.tools.lease()) {
    tools_->stop.lower();
  }

  void run() {
    const auto fields = static_cast<std::size_t>(request_.field_count);
    const auto seeds = static_cast<std::size_t>(request_.first_seed[fields]);
    watch_.start();
    const DeviceBuffer<std::int64_t> first(std::span(request_.first_seed, fields + 1), stream_);
    const DeviceBuffer<std::int32_t> nodes(std::span(request_.seed_nodes, seeds), stream_);
    const DeviceBuffer<std::int32_t> sources(std::span(request_.seed_sources, request_.sources ? seeds : 0), stream_);
    const DeviceBuffer<double> distances(std::span(request_.seed_distances, seeds), stream_);
    times_.upload += watch_.lap();
    search({first.data(), nodes.data(), sources.data(), distances.data()});
  }

 private:
  void search(const SearchSeeds& seeds) {
    const Teams teams = saddleback::teams(graph_, request_);
    const auto nodes = static_cast<std::size_t>(graph_.node_count), most = static_cast<std::size_t>(teams.fields);
    const std::size_t labeled = request_.sources ? most : 0, words = std::size_t{2} << graph_.graph.word_bits;
    DeviceBuffer<DistanceBits> distances(most * nodes, stream_);
    DeviceBuffer<std::int32_t> sources(labeled * nodes, stream_), ordered_sources(labeled * nodes, stream_);
    DeviceBuffer<double> ordered(most * nodes, stream_);
    DeviceBuffer<unsigned> waiting(most * words, stream_);
    DeviceBuffer<TeamBoard> boards(most, stream_);
    HostCopies copies(stream_);
    for (std::int32_t begin = 0; begin < request_.field_count; begin += teams.fields) {
      const std::int32_t count = std::min(teams.fields, request_.field_count - begin);
      waiting.fill_bytes(0);
      boards.fill_bytes(0);
      const SearchFields fields{begin,
                                count,
                                teams.blocks,
                                distances.data(),
                                sources.data(),
                                waiting.data(),
                                boards.data(),
                                request_.bound,
                                request_.step * teams.steps,
                                tools_->stop.on_device()};
      search(seeds, fields);
      copies.finish();
      watch_.start();
      write(fields, ordered.data(), ordered_sources.data());
      times_.unite += watch_.lap();
      const std::size_t size = static_cast<std::size_t>(count) * nodes, to = static_cast<std::size_t>(begin) * nodes;
      copies.to_host(ordered.data(), size, request_.distances ? request_.distances + to : nullptr);
      if (request_.sources) copies.to_host(ordered_sources.data(), size, request_.sources + to);
    }
    watch_.start();
    copies.finish([&](double) {
      if (!keep_going(request_.field_count)) throw Stopped();
    });
    times_.download += watch_.lap();
  }

  void search(SearchSeeds seeds, SearchFields fields) {
    watch_.start();
    const std::size_t values = static_cast<std::size_t>(fields.count) * static_cast<std::size_t>(graph_.node_count);
    constexpr int k_threads = 256;
    const auto blocks = static_cast<unsigned>(std::min<std::size_t>((values + k_threads - 1) / k_threads, 1 << 14));
    clear_fields<<<blocks, k_threads, 0, stream_>>>(fields, values);
    check_cuda(cudaGetLastError(), "clearing fields");
    DeviceGraph graph = graph_.graph;
    void* arguments[] = {&graph, &seeds, &fields};
    check_cuda(cudaLaunchCooperativeKernel(search_fields, dim3(static_cast<unsigned>(fields.count * fields.team)),
                                           dim3(k_search_threads), arguments, 0, stream_),
               "searching the graph");
    watch_.end();
    wait_for_device(fields.first);
    times_.find += watch_.read();
  }

  /// Lets the caller stop what runs.
  void wait_for_device(std::int32_t done) {
    using Clock = std::chrono::steady_clock;
    using namespace std::chrono_literals;
    const auto start = Clock::now();
    bool is_stopped = false;
    while (true) {
      const cudaError_t state = cudaStreamQuery(stream_);
      if (state == cudaSuccess) break;
      if (state != cudaErrorNotReady) check_cuda(state, "searching the graph");
      if (Clock::now() - start < 3ms) continue;
      if (!is_stopped && !keep_going(done)) {
        is_stopped = true;
        tools_->stop.raise();
      }
      std::this_thread::sleep_for(500us);
    }
    if (is_stopped || !keep_going(done)) throw Stopped();
  }
  bool keep_going(std::int32_t done) const {
    return caller_.keep_going(caller_.self, static_cast<double>(done) / request_.field_count);
  }

  void write(const SearchFields& fields, double* distances, std::int32_t* sources) const {
    constexpr int k_threads = 256;
    const auto blocks = static_cast<unsigned>((graph_.node_count + k_threads - 1) / k_threads);
    write_fields<<<dim3(blocks, static_cast<unsigned>(fields.count)), k_threads, 0, stream_>>>(
        fields, request_.by_node ? nullptr : graph_.nodes.data(), graph_.node_count, distances,
        request_.sources ? sources : nullptr);
    check_cuda(cudaGetLastError(), "writing fields");
  }

  const CudaGraph& graph_;
  const SearchRequest& request_;
  const SearchCaller& caller_;
  DeviceTimes& times_;
  ScratchPool<SearchTools>::Lease tools_;
  const cudaStream_t stream_ = tools_->stream;
  Stopwatch& watch_ = tools_->watch;
};

}  // namespace

CudaStatus put_graph_on_device(const CudaGraphRequest& r, CudaGraph** graph, double* seconds, CudaReason& reason) {
  return cuda_status(reason, [&] {
    check_cuda(cudaSetDevice(r.device), "choosing the device");
    const auto arcs = static_cast<std::uint64_t>(r.arc_count), nodes = static_cast<std::uint64_t>(r.node_count);
    check_device_room("the graph", 8 * arcs + 12 * nodes + (1 << 20), r.most_bytes);
    keep_freed_memory(r.device);
    auto kept = std::make_unique<CudaGraph>(r);
    Stopwatch watch(kept->stream);
    HostCopies copies(kept->stream);
    copies.to_device(r.words, static_cast<std::size_t>(arcs), kept->words.data());
    copies.finish();
    *seconds = watch.lap();
    *graph = kept.release();
  });
}

void drop_graph_on_device(CudaGraph* graph) {
  if (cudaSetDevice(graph->device) != cudaSuccess) (void)cudaGetLastError();
  delete graph;
}

CudaStatus search_on_device(const CudaGraph& graph, const SearchRequest& request, const SearchCaller& caller,
                            DeviceTimes& times, CudaReason& reason) {
  return cuda_status(reason, [&] {
    check_cuda(cudaSetDevice(graph.device), "choosing the device");
    Searcher(graph, request, caller, times).run();
  });
}

}  // namespace saddleback
