#include "geodesics/graph/arc_symmetry.h"

#include <algorithm>
#include <atomic>

#include "saddleback/error.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

/// An arc that only its target's end has, or has with a shorter length. Its node is counted from the range's first.
class MissingArc {
 public:
  enum class Kind { added, replaces };  ///< what replaces another has the same ends and is shorter
  MissingArc() = default;
  MissingArc(Index node, Kind kind, std::uint64_t word) : node_(kind == Kind::added ? node : ~node), word_(word) {}
  Index node() const { return replaces() ? ~node_ : node_; }
  bool replaces() const { return node_ < 0; }
  std::uint64_t word() const { return word_; }
  bool operator<(const MissingArc& other) const {
    return node() != other.node() ? node() < other.node() : word_ < other.word_;
  }

 private:
  Index node_;
  std::uint64_t word_;
};

/// The arcs found out of a node.
struct Row {
  const std::uint64_t* words;
  std::int64_t first;  ///< number of arcs of the range's nodes before it
};
// Arcs whose rows are asked for ahead, and rows whose words are.
constexpr int k_row_ahead = 12, k_words_ahead = 6;
static_assert(k_row_ahead <= k_row_padding);

double share_of(Index done, std::int64_t count) { return static_cast<double>(done) / static_cast<double>(count); }

/// Unites the arcs of a range of nodes. Within, nodes are counted from its first.
class Union {
 public:
  Union(const ArcCodec& codec, const WaveKernel& kernel, std::vector<KeptArcs>& found, std::size_t across, int threads,
        const JobStage& stage)
      : codec_(codec),
        packing_(codec.packing()),
        kernel_(kernel),
        found_(found),
        block_size_(static_cast<Index>(found.front().counts.size())),
        first_node_(found.front().first_node),
        missing_(found.size() + across) {
    const KeptArcs& last = found.back();
    node_count_ = last.first_node + static_cast<Index>(last.counts.size()) - first_node_;
    std::vector<std::int64_t> firsts(found.size() + 1, 0);
    for (std::size_t b = 0; b < found.size(); ++b) firsts[b + 1] = firsts[b] + std::ssize(found[b].back_sectors);
    rows_.resize(node_count_ + 1);
    paired_.resize(firsts.back());
    parallel_for(static_cast<Index>(found.size()), threads, 4, [&](Index b, int) {
      stage.check();
      Row row{found[b].words.data(), firsts[b]};
      Row* next = rows_.data() + (found[b].first_node - first_node_);
      for (const std::int32_t count : found[b].counts) {
        *next++ = row;
        row.words += count;
        row.first += count;
      }
      std::fill(paired_.begin() + firsts[b], paired_.begin() + firsts[b + 1], std::uint8_t{0});
    });
    rows_.back() = {nullptr, firsts.back()};
  }

  /// Looks for the reverses of arcs to later nodes of the range; where one of the two is longer, it is marked to be
  /// replaced, and where there is none, to be added. Writes nothing but marks of arcs that no other block marks.
  void pair_with_later(Index block_index) {
    const KeptArcs& block = found_[block_index];
    const std::uint64_t* const words = block.words.data();
    std::int64_t i = 0;
    for (std::size_t row = 0; row < block.counts.size(); ++row) {
      const Index own = block.first_node + static_cast<Index>(row), node = own - first_node_;
      for (const std::int64_t end = i + block.counts[row]; i < end; ++i) {
        __builtin_prefetch(&rows_[target_within(words[i + k_row_ahead])]);
        __builtin_prefetch(rows_[target_within(words[i + k_words_ahead])].words);
        const std::uint64_t word = words[i];
        const Index target = target_within(word);
        if (target < node || target == node_count_) continue;
        const Row& there = rows_[target];
        const int at = find(target, own);
        if (at < 0) {
          missing_[block_index].push_back(
              {target, MissingArc::Kind::added, packing_.reversed(own, block.back_sectors[i], word)});
          continue;
        }
        paired_[there.first + at] = 1;
        const std::uint64_t back = there.words[at];
        // The shorter one replaces its reverse: then that leaves in another direction.
        if (codec_.length_bits(word) < codec_.length_bits(back))
          missing_[block_index].push_back(
              {target, MissingArc::Kind::replaces, packing_.reversed(own, block.back_sectors[i], word)});
        if (codec_.length_bits(back) < codec_.length_bits(word))
          missing_[block_index].push_back({node, MissingArc::Kind::replaces,
                                           packing_.reversed(target + first_node_, back_sector(target, at), back)});
      }
    }
  }

  /// Arcs to earlier nodes of the range that no reverse was paired with have none. To be called when all blocks are
  /// paired.
  void add_unpaired(Index block_index) {
    const KeptArcs& block = found_[block_index];
    const std::uint8_t* const paired = paired_.data() + rows_[block.first_node - first_node_].first;
    std::int64_t i = 0;
    for (std::size_t row = 0; row < block.counts.size(); ++row) {
      const Index own = block.first_node + static_cast<Index>(row), node = own - first_node_;
      for (const std::int64_t end = i + block.counts[row]; i < end; ++i) {
        if (paired[i]) continue;
        const Index target = target_within(block.words[i]);
        if (target > node) continue;
        missing_[block_index].push_back(
            {target, MissingArc::Kind::added, packing_.reversed(own, block.back_sectors[i], block.words[i])});
      }
    }
  }

  /// Takes reverses from another range where this one has none, or a longer arc.
  void take_across(Index list, const ArcsAcross& across) {
    std::vector<MissingArc>& missing = missing_[found_.size() + static_cast<std::size_t>(list)];
    for (std::size_t i = 0; i < across.words.size(); ++i) {
      const std::uint64_t word = across.words[i];
      const Index node = across.nodes[i] - first_node_;
      const int at = find(node, codec_.target(word));
      if (at < 0) {
        missing.push_back({node, MissingArc::Kind::added, word});
      } else if (codec_.length_bits(word) < codec_.length_bits(rows_[node].words[at])) {
        missing.push_back({node, MissingArc::Kind::replaces, word});
      }
    }
  }

  /// Empties the found arcs.
  ArcRows assemble(int threads, const JobStage& stage) {
    constexpr double k_counting = 0.35, k_copying = 0.4;  // of the time, from there on
    paired_ = {};
    sort_missing(threads, stage.part(0, k_counting));
    std::vector<std::int64_t> offsets(node_count_ + 1, 0);
    const JobStage counting = stage.part(k_counting, k_copying);
    parallel_for(static_cast<Index>(found_.size()), threads, 4, [&](Index b, int) {
      counting.update(share_of(b, std::ssize(found_)));
      for_each_row(b, [&](Index node, std::span<const std::uint64_t> own, std::span<const MissingArc> others) {
        const auto added = std::ranges::count_if(others, [](const MissingArc& arc) { return !arc.replaces(); });
        offsets[node + 1] = static_cast<std::int64_t>(own.size()) + added;
      });
    });
    for (Index v = 0; v < node_count_; ++v) offsets[v + 1] += offsets[v];
    ArcWords words(offsets.back());
    const JobStage copying = stage.part(k_copying, 1);
    parallel_for(static_cast<Index>(found_.size()), threads, 4, [&](Index b, int) {
      copying.update(share_of(b, std::ssize(found_)));
      for_each_row(b, [&](Index node, std::span<const std::uint64_t> own, std::span<const MissingArc> others) {
        const auto row = words.begin() + offsets[node];
        auto end = std::copy(own.begin(), own.end(), row);
        for (const MissingArc& other : others) {
          if (other.replaces()) {
            *std::find_if(row, end, same_target(other.word())) = other.word();
          } else {
            *end++ = other.word();
          }
        }
      });
      found_[b] = {};
    });
    return ArcRows(codec_, std::move(offsets), std::move(words));
  }

 private:
  struct SameTarget {
    std::uint64_t mask, wanted;
    bool operator()(std::uint64_t word) const { return (word & mask) == wanted; }
  };
  SameTarget same_target(std::uint64_t word) const { return {codec_.target_mask(), word & codec_.target_mask()}; }

  /// Returns the range's end for a target elsewhere.
  Index target_within(std::uint64_t word) const {
    const auto place = static_cast<std::uint32_t>(codec_.target(word) - first_node_);
    return static_cast<Index>(std::min(place, static_cast<std::uint32_t>(node_count_)));
  }
  std::int32_t count_of(Index node) const {
    return static_cast<std::int32_t>(rows_[node + 1].first - rows_[node].first);
  }
  /// Returns which arc of a node of the range leads to a node of any, -1 for none.
  int find(Index node, Index target) const {
    return kernel_.find_target(rows_[node].words, count_of(node), codec_.target_mask(),
                               static_cast<std::uint64_t>(target));
  }

  std::uint8_t back_sector(Index node, int at) const {
    const KeptArcs& block = found_[node / block_size_];
    return block.back_sectors[rows_[node].first - rows_[block.first_node - first_node_].first + at];
  }

  /// Sorts them by their nodes, each node's sorted: the order in which they were found does not matter.
  void sort_missing(int threads, const JobStage& stage) {
    first_missing_.resize(node_count_ + 1);
    std::vector<std::atomic<std::int32_t>> counts(node_count_);
    const auto lists = static_cast<Index>(missing_.size());
    constexpr double k_filling = 0.3, k_sorting = 0.6;  // of the time, from there on
    const JobStage counting = stage.part(0, k_filling), filling = stage.part(k_filling, k_sorting);
    parallel_for(lists, threads, 4, [&](Index b, int) {
      counting.update(share_of(b, lists));
      for (const MissingArc& arc : missing_[b]) counts[arc.node()].fetch_add(1, std::memory_order_relaxed);
    });
    first_missing_[0] = 0;
    for (Index node = 0; node < node_count_; ++node)
      first_missing_[node + 1] = first_missing_[node] + counts[node].load(std::memory_order_relaxed);
    all_missing_.resize(first_missing_.back());
    parallel_for(lists, threads, 4, [&](Index b, int) {
      filling.update(share_of(b, lists));
      for (const MissingArc& arc : missing_[b]) {
        const std::int32_t left = counts[arc.node()].fetch_sub(1, std::memory_order_relaxed) - 1;
        all_missing_[first_missing_[arc.node()] + left] = arc;
      }
      missing_[b] = {};
    });
    const JobStage sorting = stage.part(k_sorting, 1);
    parallel_for(node_count_, threads, 4 * block_size_, [&](Index node, int) {
      if (node % block_size_ == 0) sorting.update(share_of(node, node_count_));
      std::sort(all_missing_.begin() + first_missing_[node], all_missing_.begin() + first_missing_[node + 1]);
    });
  }

  template <class Use>
  void for_each_row(Index b, Use&& use) const {
    const KeptArcs& block = found_[b];
    for (std::size_t row = 0; row < block.counts.size(); ++row) {
      const Index node = block.first_node - first_node_ + static_cast<Index>(row);
      const std::int64_t begin = first_missing_[node], end = first_missing_[node + 1];
      use(node, std::span(rows_[node].words, block.counts[row]),
          std::span(all_missing_.data() + begin, static_cast<std::size_t>(end - begin)));
    }
  }

  const ArcCodec& codec_;
  const ArcPacking& packing_;
  const WaveKernel& kernel_;
  std::vector<KeptArcs>& found_;
  Index block_size_, first_node_, node_count_ = 0;
  LargeArray<Row> rows_;  ///< per node, and the number of all arcs at the end
  std::vector<std::vector<MissingArc>> missing_;
  LargeArray<std::uint8_t> paired_;  ///< per arc: its reverse was found
  LargeArray<MissingArc> all_missing_;
  LargeArray<std::int64_t> first_missing_;  ///< per node
};

}  // namespace

KeptArcs::KeptArcs(const FoundArcs& found, ReturnedPieces& memory) : first_node(found.first_node) {
  const std::size_t word_count = found.words.size(), padded = word_count + k_row_padding;
  const std::size_t of_words = padded * sizeof(std::uint64_t), of_counts = found.counts.size() * sizeof(std::int32_t);
  memory_ = memory.take(of_words + of_counts + word_count);
  auto* const start = static_cast<std::byte*>(memory_.get());
  auto* const own_words = reinterpret_cast<std::uint64_t*>(start);
  auto* const own_counts = reinterpret_cast<std::int32_t*>(start + of_words);
  auto* const own_sectors = reinterpret_cast<std::uint8_t*>(start + of_words + of_counts);
  std::fill(std::copy(found.words.begin(), found.words.end(), own_words), own_words + padded, 0);
  std::copy(found.counts.begin(), found.counts.end(), own_counts);
  std::copy(found.back_sectors.begin(), found.back_sectors.end(), own_sectors);
  words = {own_words, padded};
  counts = {own_counts, found.counts.size()};
  back_sectors = {own_sectors, word_count};
}

ArcRows unite_with_reverses(const ArcCodec& codec, const WaveKernel& kernel, std::vector<KeptArcs>& found,
                            std::span<const ArcsAcross> across, int threads, const JobStage& stage) {
  std::atomic<Index> done{0};
  const auto for_each_block = [&](const JobStage& part, auto&& use) {
    done = 0;
    parallel_for(static_cast<Index>(found.size()), threads, 4, [&](Index b, int) {
      part.update(share_of(done++, std::ssize(found)));
      use(b);
    });
  };
  try {
    Union work(codec, kernel, found, across.size(), threads, stage);
    for_each_block(stage.part(0, 0.5), [&](Index b) { work.pair_with_later(b); });
    for_each_block(stage.part(0.5, 0.6), [&](Index b) { work.add_unpaired(b); });
    parallel_for(static_cast<Index>(across.size()), threads, 1, [&](Index list, int) {
      stage.check();
      work.take_across(list, across[list]);
    });
    ArcRows arcs = work.assemble(threads, stage.part(0.6, 1));
    stage.update(1);
    return arcs;
  } catch (const Cancelled&) {
    free_in_background(std::move(found));
    throw;
  }
}

}  // namespace saddleback
