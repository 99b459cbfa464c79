#pragma once
// Distance fields on a CUDA device. A team of blocks takes a field and lets its front advance in rounds: nodes whose
// distance fell and is within the front offer it along their arcs; those beyond wait. Each arc is tried by a lane of
// the warp that has its row. Sums of arcs are exact (see ArcCodec), so that no order shows in the result.
//
// Nodes that wait are bits. Those of one word are spread over the whole mesh, and so is a front's work over the warps.
// [davidson2014] compares ways to advance a front.

#include <cstdint>
#include <type_traits>

#include "support/cuda/warp.cuh"

namespace saddleback {

struct DeviceGraph {
  const std::int64_t* offsets;
  const std::uint64_t* words;
  std::int32_t node_count;
  int word_bits;  ///< nodes wait in 2^word_bits words
  std::uint64_t target_mask, length_mask, bias;
  int length_shift;

  __device__ std::int32_t target(std::uint64_t word) const { return static_cast<std::int32_t>(word & target_mask); }
  __device__ double length(std::uint64_t word) const {
    return __longlong_as_double(static_cast<long long>(((word & length_mask) >> length_shift) + bias));
  }
  __device__ std::uint32_t word_count() const { return 1u << word_bits; }
};

/// Positive doubles are in the order of their bits.
using DistanceBits = unsigned long long;
constexpr DistanceBits k_far_away = ~DistanceBits{0};
constexpr DistanceBits k_stop = ~DistanceBits{0};  ///< on a board; the complement of a distance that none has

struct SearchSeeds {
  const std::int64_t* first;
  const std::int32_t *nodes, *sources;
  const double* distances;
};

/// Holds what a team's blocks tell one another; all of its bytes are 0 before a field.
struct TeamBoard {
  /// Holds the least distances of a round, the one before and the next: the complement of the least that waits. 0:
  /// nothing does.
  DistanceBits waiting[3];
  unsigned arrived;
};

/// The fields of one launch.
struct SearchFields {
  std::int32_t first, count;  ///< field numbers
  int team;                   ///< blocks a field
  DistanceBits* distances;    ///< (count, node_count), `bound` everywhere
  std::int32_t* sources;      ///< (count, node_count), the greatest number everywhere; or null
  unsigned* waiting;          ///< (count, 2, word_count), 0 everywhere
  TeamBoard* boards;          ///< (count,)
  double bound, step;
  const volatile unsigned* stop;  ///< host memory
};

/// A node that is to be expanded.
struct WaitingRow {
  std::int64_t begin, end;  ///< of its arcs
  DistanceBits distance;
  std::int32_t node;
};
/// The rows of a block in one round, in shared memory; more wait for the next.
struct RowList {
  static constexpr int k_most = 1024;
  WaitingRow rows[k_most];
  int count;
  DistanceBits least, told;  ///< that wait: for this block, for the team
};

/// A team's search of one field, for one block of it.
class FieldSearch {
 public:
  __device__ FieldSearch(const DeviceGraph& graph, const SearchFields& fields, RowList& list)
      : graph_(graph),
        field_(static_cast<std::int32_t>(blockIdx.x) / fields.team),
        member_(static_cast<int>(blockIdx.x) % fields.team),
        team_(fields.team),
        distances_(fields.distances + static_cast<std::size_t>(field_) * graph.node_count),
        sources_(fields.sources ? fields.sources + static_cast<std::size_t>(field_) * graph.node_count : nullptr),
        waiting_(fields.waiting + static_cast<std::size_t>(field_) * 2 * graph.word_count()),
        board_(fields.boards[field_]),
        stop_(fields.stop),
        bound_(bits_of(fields.bound)),
        list_(list) {}

  __device__ void find_distances(const SearchSeeds& seeds, double step) {
    if (threadIdx.x == 0) list_.least = k_far_away;
    __syncthreads();
    for_each_seed(seeds, [&](std::int64_t seed, std::int32_t node) {
      const DistanceBits offer = bits_of(seeds.distances[seed]);
      if (offer < atomicMin(distances_ + node, offer)) wait(node, offer);
    });
    double front = 0;
    while (end_round()) {
      const double least = __longlong_as_double(static_cast<long long>(least_));
      if (least >= front) front = least + step;
      const DistanceBits within = bits_of(front);
      for_each_waiting(within, [&](const WaitingRow& row, auto lanes) { offer_distance<lanes>(row); });
    }
  }

  /// The least source among those by which a node's distance can come about.
  __device__ void find_sources(const SearchSeeds& seeds) {
    for_each_seed(seeds, [&](std::int64_t seed, std::int32_t node) {
      if (bits_of(seeds.distances[seed]) != __ldcg(distances_ + node)) return;
      if (seeds.sources[seed] < atomicMin(sources_ + node, seeds.sources[seed])) wait(node, 0);
    });
    while (end_round())
      for_each_waiting(k_far_away, [&](const WaitingRow& row, auto lanes) { offer_source<lanes>(row); });
  }

 private:
  __device__ static DistanceBits bits_of(double value) {
    return static_cast<DistanceBits>(__double_as_longlong(value));
  }
  __device__ static int lane() { return static_cast<int>(threadIdx.x & 31); }

  template <class Visit>
  __device__ void for_each_seed(const SearchSeeds& seeds, Visit&& visit) {
    const std::int64_t stride = static_cast<std::int64_t>(team_) * blockDim.x;
    const std::int64_t begin = seeds.first[field_], end = seeds.first[field_ + 1];
    for (std::int64_t i = begin + member_ * blockDim.x + threadIdx.x; i < end; i += stride) visit(i, seeds.nodes[i]);
  }

  /// Lets it wait in the next round.
  __device__ void wait(std::int32_t node, DistanceBits distance) {
    const std::uint32_t words = graph_.word_count(), word = static_cast<std::uint32_t>(node) & (words - 1);
    atomicOr(waiting_ + ((round_ + 1) & 1) * words + word, 1u << (node >> graph_.word_bits));
    least_mine_ = min(least_mine_, max(distance, DistanceBits{1}));
  }

  /// Tells whether any node waits: all of the team are here then, and know the least distance of those.
  __device__ bool end_round() {
    for (int step = 16; step > 0; step /= 2) least_mine_ = min(least_mine_, __shfl_xor_sync(k_warp, least_mine_, step));
    if (lane() == 0 && least_mine_ != k_far_away) atomicMin(&list_.least, least_mine_);
    least_mine_ = k_far_away;
    __syncthreads();
    ++round_;
    if (threadIdx.x == 0) {
      list_.told = share_least();
      list_.least = k_far_away;
      list_.count = 0;
    }
    __syncthreads();
    least_ = list_.told;
    return least_ != k_far_away;
  }

  /// Returns it for the first thread. \return the team's.
  __device__ DistanceBits share_least() {
    constexpr unsigned k_rounds_between_looks = 16;
    const int slot = static_cast<int>(round_ % 3), next = static_cast<int>((round_ + 1) % 3);
    if (member_ == 0) {
      __stcg(&board_.waiting[next], DistanceBits{0});
      if (round_ % k_rounds_between_looks == 0 && *stop_) atomicMax(&board_.waiting[slot], k_stop);
    }
    if (list_.least != k_far_away) atomicMax(&board_.waiting[slot], ~list_.least);
    __threadfence();
    atomicAdd(&board_.arrived, 1u);
    const unsigned wanted = round_ * static_cast<unsigned>(team_);
    while (static_cast<int>(*static_cast<volatile unsigned*>(&board_.arrived) - wanted) < 0) {}
    __threadfence();
    const DistanceBits told = __ldcg(&board_.waiting[slot]);
    return told == k_stop ? k_far_away : ~told;
  }

  /// Visits nodes that wait and lie within a distance, each by some lanes; the others go on waiting.
  template <class Visit>
  __device__ void for_each_waiting(DistanceBits within, Visit&& visit) {
    gather_rows(within);
    __syncthreads();
    const int count = min(list_.count, RowList::k_most);
    // A row is a chain of waits for memory: many at a time where there are many, all lanes on one where there are few.
    if (count > static_cast<int>(blockDim.x) / 32) {
      visit_rows<8>(count, visit);
    } else {
      visit_rows<32>(count, visit);
    }
  }

  __device__ void gather_rows(DistanceBits within) {
    constexpr int k_at_a_time = 4;
    const std::uint32_t words = graph_.word_count(), stride = static_cast<std::uint32_t>(team_) * blockDim.x;
    unsigned* const waiting = waiting_ + (round_ & 1) * words;
    for (std::uint32_t first = threadIdx.x * static_cast<std::uint32_t>(team_) + static_cast<std::uint32_t>(member_);
         first < words; first += stride * k_at_a_time) {
      unsigned bits[k_at_a_time];
#pragma unroll
      for (int i = 0; i < k_at_a_time; ++i)
        bits[i] = first + stride * i < words ? __ldcg(waiting + first + stride * i) : 0;
#pragma unroll
      for (int i = 0; i < k_at_a_time; ++i) {
        if (!bits[i]) continue;
        const std::uint32_t word = first + stride * i;
        __stcg(waiting + word, 0u);
        for (unsigned left = bits[i]; left; left &= left - 1) {
          const auto bit = static_cast<std::uint32_t>(__ffs(static_cast<int>(left)) - 1);
          gather_row(static_cast<std::int32_t>(bit << graph_.word_bits | word), within);
        }
      }
    }
  }

  __device__ void gather_row(std::int32_t node, DistanceBits within) {
    const DistanceBits distance = __ldcg(distances_ + node);
    const std::int64_t begin = graph_.offsets[node], end = graph_.offsets[node + 1];
    const int place = distance < within ? atomicAdd(&list_.count, 1) : RowList::k_most;
    if (place < RowList::k_most) {
      list_.rows[place] = {begin, end, distance, node};
    } else {
      wait(node, distance);
    }
  }

  template <int Lanes, class Visit>
  __device__ void visit_rows(int count, Visit&& visit) const {
    const int part = static_cast<int>(threadIdx.x) / Lanes, parts = static_cast<int>(blockDim.x) / Lanes;
    for (int i = part; i < count; i += parts) visit(list_.rows[i], std::integral_constant<int, Lanes>());
  }

  /// Offers along a row's arcs, several at a time: what a lane waits for is memory. `lower` gets a target, what it is
  /// offered and what it has, and answers with what the target had when it took the offer, or 0.
  template <int Lanes, class Before, class Lower, class IsWon>
  __device__ void offer_along(const WaitingRow& row, Lower&& lower, IsWon&& is_won) {
    constexpr int k_at_a_time = Lanes == 32 ? 3 : 5;
    const double from = __longlong_as_double(static_cast<long long>(row.distance));
    const auto lane = static_cast<int>(threadIdx.x) % Lanes;
    for (std::int64_t first = row.begin + lane; first < row.end; first += Lanes * k_at_a_time) {
      std::uint64_t words[k_at_a_time];
      DistanceBits known[k_at_a_time], offers[k_at_a_time];
      Before before[k_at_a_time];
#pragma unroll
      for (int i = 0; i < k_at_a_time; ++i)
        if (first + Lanes * i < row.end) words[i] = graph_.words[first + Lanes * i];
#pragma unroll
      for (int i = 0; i < k_at_a_time; ++i)
        known[i] = first + Lanes * i < row.end ? distances_[graph_.target(words[i])] : 0;
#pragma unroll
      for (int i = 0; i < k_at_a_time; ++i) {
        offers[i] = bits_of(from + graph_.length(words[i]));
        before[i] = first + Lanes * i < row.end ? lower(graph_.target(words[i]), offers[i], known[i]) : Before(0);
      }
#pragma unroll
      for (int i = 0; i < k_at_a_time; ++i)
        if (is_won(before[i], offers[i])) wait(graph_.target(words[i]), offers[i]);
    }
  }

  template <int Lanes>
  __device__ void offer_distance(const WaitingRow& row) {
    offer_along<Lanes, DistanceBits>(
        row,
        [&](std::int32_t target, DistanceBits offer, DistanceBits known) {
          // What is known may be old, and then too long: the atomic operation knows.
          return offer < known ? atomicMin(distances_ + target, offer) : 0;
        },
        [](DistanceBits before, DistanceBits offer) { return offer < before; });
  }

  template <int Lanes>
  __device__ void offer_source(const WaitingRow& row) {
    const std::int32_t source = __ldcg(sources_ + row.node);
    offer_along<Lanes, std::int32_t>(
        row,
        [&](std::int32_t target, DistanceBits offer, DistanceBits known) {
          const bool is_tight = offer == known && offer < bound_;
          return is_tight && source < sources_[target] ? atomicMin(sources_ + target, source) : -1;
        },
        [&](std::int32_t before, DistanceBits) { return source < before; });
  }

  const DeviceGraph& graph_;
  std::int32_t field_;
  int member_, team_;
  DistanceBits* distances_;
  std::int32_t* sources_;
  unsigned* waiting_;
  TeamBoard& board_;
  const volatile unsigned* stop_;
  DistanceBits bound_;
  RowList& list_;
  DistanceBits least_mine_ = k_far_away, least_ = k_far_away;
  unsigned round_ = 0;
};

constexpr int k_search_threads = 512;

__global__ void __launch_bounds__(k_search_threads)
    search_fields(DeviceGraph graph, SearchSeeds seeds, SearchFields fields) {
  __shared__ RowList list;
  FieldSearch search(graph, fields, list);
  seeds.first += fields.first;
  search.find_distances(seeds, fields.step);
  if (fields.sources) search.find_sources(seeds);
}

__global__ void clear_fields(SearchFields fields, std::size_t count) {
  const auto bound = static_cast<DistanceBits>(__double_as_longlong(fields.bound));
  for (std::size_t i = blockIdx.x * static_cast<std::size_t>(blockDim.x) + threadIdx.x; i < count;
       i += static_cast<std::size_t>(gridDim.x) * blockDim.x) {
    fields.distances[i] = bound;
    if (fields.sources) fields.sources[i] = 0x7fffffff;
  }
}

/// Writes them in the order of the vertices, of the nodes where those of the vertices are null; infinity for what
/// nothing reached.
__global__ void write_fields(SearchFields fields, const std::int32_t* nodes, std::int32_t node_count, double* distances,
                             std::int32_t* sources) {
  const auto bound = static_cast<DistanceBits>(__double_as_longlong(fields.bound));
  const std::size_t row = static_cast<std::size_t>(blockIdx.y) * node_count;
  for (std::int32_t vertex = static_cast<std::int32_t>(blockIdx.x * blockDim.x + threadIdx.x); vertex < node_count;
       vertex += static_cast<std::int32_t>(gridDim.x * blockDim.x)) {
    const std::int32_t node = nodes ? nodes[vertex] : vertex;
    const DistanceBits distance = fields.distances[row + node];
    const bool is_reached = distance != bound;
    distances[row + vertex] = __longlong_as_double(is_reached ? static_cast<long long>(distance) : 0x7ff0000000000000);
    if (sources) sources[row + vertex] = is_reached ? fields.sources[row + node] : -1;
  }
}

}  // namespace saddleback
