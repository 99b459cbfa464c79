// Bellman and Ford's rounds: what a round reads it does not write, so that threads need not wait for each other but
// between rounds, and offers to another thread's nodes wait in lists. Where nearly all distances are the least from the
// start there are three or four rounds, and all but the first are short.

#include "geodesics/queries/nearest_sweep.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

// Nodes: threads with less to do wait for each other.
constexpr Index k_least_part = 4096;
// Nodes between two looks at the job.
constexpr Index k_nodes_a_check = 4096;
constexpr std::ptrdiff_t k_block = 64;

constexpr double k_infinity = std::numeric_limits<double>::infinity();

}  // namespace

NearestSweep::NearestSweep(const SaddleVertexGraph& graph, int threads, const JobStage& stage)
    : graph_(graph),
      threads_(threads),
      find_candidates_(find_candidates()),
      near_(static_cast<std::size_t>(k_near) * graph.arcs().node_count()),
      left_out_(graph.arcs().node_count()),
      waits_(graph.arcs().node_count(), 0) {
  const Index count = graph.arcs().node_count();
  const Index parts = std::clamp<Index>(count / k_least_part, 1, thread_count(threads));
  const auto end = [&](Index part) { return static_cast<Index>(std::int64_t{count} * part / parts); };
  for (Index part = 0; part < parts; ++part)
    parts_.push_back({end(part), end(part + 1), {}, std::vector<std::vector<Offer>>(parts)});
  parallel_for(count, threads, k_nodes_a_check, [&](Index node, int) {
    if (node % k_nodes_a_check == 0) stage.check();
    list_nearest(node);
  });
}

/// Rows that are shorter are filled up with arcs that lead back to their node, which serve nothing.
void NearestSweep::list_nearest(Index node) {
  const ArcRows& arcs = graph_.arcs();
  const ArcCodec& codec = arcs.codec();
  arcs.look_at(node);
  const auto row = arcs.words().subspan(arcs.first(node), arcs.first(node + 1) - arcs.first(node));
  std::vector<std::uint64_t> words(row.begin(), row.end());
  left_out_[node] = k_infinity;
  if (std::ssize(words) > k_near) {
    std::ranges::nth_element(words, words.begin() + k_near, {},
                             [&](std::uint64_t word) { return codec.length_bits(word); });
    left_out_[node] = codec.length(words[k_near]);
  }
  words.resize(k_near, codec.pack(node, 0, codec.quantum()));
  std::ranges::copy(words, near_.begin() + static_cast<std::ptrdiff_t>(node) * k_near);
}

bool NearestSweep::run(std::span<double> distances, std::span<Index> sources, const JobStage& stage) {
  distances_ = distances;
  sources_ = sources;
  farthest_ = -k_infinity;  // the shortest arcs alone
  for_each_part([&](Index i) {
    Part& part = parts_[i];
    part.front.resize(part.last - part.first);
    std::iota(part.front.begin(), part.front.end(), part.first);
  });
  expand_until_none_falls(stage);
  if (!find_farthest()) return false;
  for_each_part([&](Index i) {
    Part& part = parts_[i];
    for (Index node = part.first; node < part.last; ++node)
      if (!(distances_[node] + left_out_[node] > farthest_)) part.front.push_back(node);
  });
  expand_until_none_falls(stage);
  return true;
}

/// False where a node is out of reach.
bool NearestSweep::find_farthest() {
  std::vector<double> farthest(parts_.size());
  for_each_part([&](Index i) {
    const Part& part = parts_[i];
    const auto own = distances_.subspan(part.first, part.last - part.first);
    farthest[i] = own.empty() ? 0 : *std::ranges::max_element(own);
  });
  farthest_ = std::ranges::max(farthest);
  return farthest_ < k_infinity;
}

void NearestSweep::expand_until_none_falls(const JobStage& stage) {
  while (std::ranges::any_of(parts_, [](const Part& part) { return !part.front.empty(); })) {
    for_each_part([&](Index i) { expand(parts_[i], stage); });
    for_each_part([&](Index i) { take_offers(i); });
  }
}

std::span<const std::uint64_t> NearestSweep::useful_arcs(Index node, double distance) const {
  if (distance + left_out_[node] > farthest_) return std::span(near_).subspan(std::size_t{k_near} * node, k_near);
  const ArcRows& arcs = graph_.arcs();
  return arcs.words().subspan(arcs.first(node), arcs.first(node + 1) - arcs.first(node));
}

void NearestSweep::expand(Part& part, const JobStage& stage) {
  const ArcCodec& codec = graph_.arcs().codec();
  Index until_check = 0;
  for (const Index node : part.front) {
    if (--until_check < 0) {
      stage.check();
      until_check = k_nodes_a_check;
    }
    waits_[node] = 0;
    const double distance = distances_[node];
    const Index source = sources_[node];
    if (source == k_none) continue;
    const auto words = useful_arcs(node, distance);
    for (std::ptrdiff_t first = 0; first < std::ssize(words); first += k_block) {
      const auto count = static_cast<int>(std::min(std::ssize(words) - first, k_block));
      const std::uint64_t* const block = words.data() + first;
      for (std::uint64_t bits = find_candidates_(codec, block, count, distance, distances_.data()); bits;
           bits &= bits - 1) {
        const std::uint64_t word = block[std::countr_zero(bits)];
        const Index target = codec.target(word);
        const double offered = distance + codec.length(word);
        if (offered == distances_[target] && source >= sources_[target]) continue;
        part.offers[part_of(target)].push_back({target, source, offered});
      }
    }
  }
  part.front.clear();
}

/// Takes the offers of all threads to the nodes of one.
void NearestSweep::take_offers(Index i) {
  for (Part& from : parts_) {
    for (const auto& [node, source, distance] : from.offers[i]) {
      if (distance > distances_[node] || (distance == distances_[node] && source >= sources_[node])) continue;
      distances_[node] = distance;
      sources_[node] = source;
      if (std::exchange(waits_[node], 1) == 0) parts_[i].front.push_back(node);
    }
    from.offers[i].clear();
  }
}

Index NearestSweep::part_of(Index node) const {
  const auto parts = static_cast<std::int64_t>(parts_.size());
  return static_cast<Index>(((node + std::int64_t{1}) * parts - 1) / graph_.arcs().node_count());
}

template <class Body>
void NearestSweep::for_each_part(Body&& body) {
  parallel_for(static_cast<Index>(parts_.size()), threads_, 1, [&](Index part, int) { body(part); });
}

}  // namespace saddleback
