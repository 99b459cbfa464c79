#include "geodesics/arc_symmetry.h"

#include <algorithm>

#include "support/parallel.h"

namespace saddleback {
namespace {

/// An arc that only its target's end was told of, or told of better.
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

class Union {
 public:
  Union(const ArcCodec& codec, const WaveKernel& kernel, std::vector<FoundArcs>& found, Index block_size)
      : codec_(codec),
        packing_(codec.packing()),
        kernel_(kernel),
        found_(found),
        block_size_(block_size),
        missing_(found.size()),
        paired_(found.size()) {
    const FoundArcs& last = found.back();
    node_count_ = last.first_node + static_cast<Index>(last.counts.size());
    starts_.resize(node_count_ + 1);
    for (const FoundArcs& block : found) {
      Index begin = 0;
      for (std::size_t i = 0; i < block.counts.size(); ++i) {
        starts_[block.first_node + static_cast<Index>(i)] = begin;
        begin += block.counts[i];
      }
      paired_[block.first_node / block_size_].resize(block.words.size());
    }
  }

  /// Looks for the reverses of arcs to later nodes; where one of the two is longer, it is marked to be replaced, and
  /// where there is none, to be added. Writes nothing but marks of arcs that no other block marks.
  void pair_with_later(Index block_index) {
    const FoundArcs& block = found_[block_index];
    std::int64_t i = 0;
    for (std::size_t row = 0; row < block.counts.size(); ++row) {
      const Index node = block.first_node + static_cast<Index>(row);
      for (const std::int64_t end = i + block.counts[row]; i < end; ++i) {
        const std::uint64_t word = block.words[i];
        const Index target = codec_.target(word);
        if (target < node) continue;
        const Place reverse = find(target, node);
        if (reverse.arc < 0) {
          missing_[block_index].push_back(
              {target, MissingArc::Kind::added, packing_.reversed(node, block.back_sectors[i], word)});
          continue;
        }
        paired_[reverse.block][reverse.arc] = 1;
        const FoundArcs& other = found_[reverse.block];
        const std::uint64_t back = other.words[reverse.arc];
        // The shorter one replaces its reverse: then that leaves in another direction.
        if (codec_.length_bits(word) < codec_.length_bits(back))
          missing_[block_index].push_back(
              {target, MissingArc::Kind::replaces, packing_.reversed(node, block.back_sectors[i], word)});
        if (codec_.length_bits(back) < codec_.length_bits(word))
          missing_[block_index].push_back(
              {node, MissingArc::Kind::replaces, packing_.reversed(target, other.back_sectors[reverse.arc], back)});
      }
    }
  }

  /// Arcs to earlier nodes that no reverse was paired with have none. To be called when all blocks are paired.
  void add_unpaired(Index block_index) {
    const FoundArcs& block = found_[block_index];
    std::int64_t i = 0;
    for (std::size_t row = 0; row < block.counts.size(); ++row) {
      const Index node = block.first_node + static_cast<Index>(row);
      for (const std::int64_t end = i + block.counts[row]; i < end; ++i) {
        const Index target = codec_.target(block.words[i]);
        if (target > node || paired_[block_index][i]) continue;
        missing_[block_index].push_back(
            {target, MissingArc::Kind::added, packing_.reversed(node, block.back_sectors[i], block.words[i])});
      }
    }
  }

  /// Empties the found arcs.
  ArcRows assemble(int threads, const JobStage& stage) {
    paired_ = {};
    sort_missing(threads, stage);
    std::vector<std::int64_t> offsets(node_count_ + 1, 0);
    parallel_for(static_cast<Index>(found_.size()), threads, 4, [&](Index b, int) {
      stage.check();
      for_each_row(b, [&](Index node, std::span<const std::uint64_t> own, std::span<const MissingArc> others) {
        const auto added = std::ranges::count_if(others, [](const MissingArc& arc) { return !arc.replaces(); });
        offsets[node + 1] = static_cast<std::int64_t>(own.size()) + added;
      });
    });
    for (Index v = 0; v < node_count_; ++v) offsets[v + 1] += offsets[v];
    ArcWords words(offsets.back());
    parallel_for(static_cast<Index>(found_.size()), threads, 4, [&](Index b, int) {
      stage.check();
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

  struct Place {
    Index block;
    std::int64_t arc;  ///< in the block's words; negative: nowhere
  };
  Place find(Index node, Index target) const {
    const Index b = node / block_size_;
    const FoundArcs& block = found_[b];
    const int i =
        kernel_.find_target(block.words.data() + starts_[node], block.counts[node - block.first_node],
                            static_cast<std::uint32_t>(codec_.target_mask()), static_cast<std::uint32_t>(target));
    return {b, i < 0 ? -1 : starts_[node] + i};
  }

  /// Into the blocks of their nodes, each sorted: the order in which they were found does not matter.
  void sort_missing(int threads, const JobStage& stage) {
    first_missing_.assign(found_.size() + 1, 0);
    for (const auto& list : missing_)
      for (const MissingArc& arc : list) ++first_missing_[arc.node() / block_size_ + 1];
    for (std::size_t b = 0; b < found_.size(); ++b) first_missing_[b + 1] += first_missing_[b];
    all_missing_.resize(first_missing_.back());
    std::vector<std::int64_t> next(first_missing_.begin(), first_missing_.end() - 1);
    for (auto& list : missing_) {
      for (const MissingArc& arc : list) all_missing_[next[arc.node() / block_size_]++] = arc;
      list = {};
    }
    parallel_for(static_cast<Index>(found_.size()), threads, 4, [&](Index b, int) {
      stage.check();
      std::sort(all_missing_.begin() + first_missing_[b], all_missing_.begin() + first_missing_[b + 1]);
    });
  }

  template <class Use>
  void for_each_row(Index b, Use&& use) const {
    const FoundArcs& block = found_[b];
    const MissingArc* other = all_missing_.data() + first_missing_[b];
    const MissingArc* const last = all_missing_.data() + first_missing_[b + 1];
    for (std::size_t row = 0; row < block.counts.size(); ++row) {
      const Index node = block.first_node + static_cast<Index>(row);
      const MissingArc* const begin = other;
      while (other != last && other->node() == node) ++other;
      use(node, std::span(block.words.data() + starts_[node], block.counts[row]), std::span(begin, other));
    }
  }

  const ArcCodec& codec_;
  const ArcPacking& packing_;
  const WaveKernel& kernel_;
  std::vector<FoundArcs>& found_;
  Index block_size_, node_count_ = 0;
  std::vector<Index> starts_;  ///< of each node's row in its block
  std::vector<std::vector<MissingArc>> missing_;
  std::vector<std::vector<std::uint8_t>> paired_;  ///< per block and arc: its reverse was found
  std::vector<MissingArc> all_missing_;
  std::vector<std::int64_t> first_missing_;  ///< per block
};

}  // namespace

ArcRows unite_with_reverses(const ArcCodec& codec, const WaveKernel& kernel, std::vector<FoundArcs>& found,
                            Index block_size, int threads, const JobStage& stage) {
  Union work(codec, kernel, found, block_size);
  const auto for_each_block = [&](auto&& use) {
    parallel_for(static_cast<Index>(found.size()), threads, 4, [&](Index b, int) {
      stage.check();
      use(b);
    });
  };
  for_each_block([&](Index b) { work.pair_with_later(b); });
  for_each_block([&](Index b) { work.add_unpaired(b); });
  stage.update(0.6);
  ArcRows arcs = work.assemble(threads, stage.part(0.6, 1));
  stage.update(1);
  return arcs;
}

}  // namespace saddleback
