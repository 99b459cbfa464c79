#include "geodesics/arc_symmetry.h"

#include <algorithm>

#include "support/parallel.h"

namespace saddleback {
namespace {

/// An arc that only its target's end was told of.
struct MissingArc {
  Index node;
  std::uint64_t word;
  bool operator<(const MissingArc& other) const { return node != other.node ? node < other.node : word < other.word; }
};

class Union {
 public:
  Union(const ArcCodec& codec, const WaveKernel& kernel, std::vector<FoundArcs>& found, Index block_size)
      : codec_(codec), kernel_(kernel), found_(found), block_size_(block_size), missing_(found.size()) {
    const FoundArcs& last = found.back();
    node_count_ = last.first_node + static_cast<Index>(last.counts.size());
    starts_.resize(node_count_ + 1);
    for (const FoundArcs& block : found) {
      Index begin = 0;
      for (std::size_t i = 0; i < block.counts.size(); ++i) {
        starts_[block.first_node + static_cast<Index>(i)] = begin;
        begin += block.counts[i];
      }
    }
  }

  /// Lists the reverses that their rows lack; where both are there and differ, the longer one of this block's arcs is
  /// marked to be replaced. Only reads words, so that blocks may go at the same time.
  void look_for_reverses(Index block_index) {
    const FoundArcs& block = found_[block_index];
    std::int64_t i = 0;
    for (std::size_t row = 0; row < block.counts.size(); ++row) {
      const Index node = block.first_node + static_cast<Index>(row);
      for (const std::int64_t end = i + block.counts[row]; i < end; ++i) {
        const std::uint64_t word = block.words[i];
        const std::uint64_t* reverse = find(codec_.target(word), node);
        // A shorter arc replaces its reverse, too: then it leaves in another direction.
        if (reverse && codec_.length_bits(*reverse) <= codec_.length_bits(word)) continue;
        missing_[block_index].push_back({codec_.target(word), reversed(node, block.back_sectors[i], word)});
      }
    }
  }

  /// Empties the found arcs.
  ArcRows assemble(int threads, const JobStage& stage) {
    sort_missing();
    std::vector<std::int64_t> offsets(node_count_ + 1, 0);
    parallel_for(static_cast<Index>(found_.size()), threads, 4, [&](Index b, int) {
      stage.check();
      for_each_row(b, [&](Index node, std::span<const std::uint64_t> own, std::span<const MissingArc> others) {
        std::int64_t count = static_cast<std::int64_t>(own.size());
        for (const MissingArc& other : others) count += std::ranges::none_of(own, same_target(other.word));
        offsets[node + 1] = count;
      });
    });
    for (Index v = 0; v < node_count_; ++v) offsets[v + 1] += offsets[v];
    std::vector<std::uint64_t> words(offsets.back());
    parallel_for(static_cast<Index>(found_.size()), threads, 4, [&](Index b, int) {
      stage.check();
      for_each_row(b, [&](Index node, std::span<const std::uint64_t> own, std::span<const MissingArc> others) {
        const auto row = words.begin() + offsets[node];
        auto end = std::copy(own.begin(), own.end(), row);
        for (const MissingArc& other : others) {
          const auto known = std::find_if(row, end, same_target(other.word));
          *known = other.word;
          end = std::max(end, known + 1);
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

  const std::uint64_t* find(Index node, Index target) const {
    const FoundArcs& block = found_[node / block_size_];
    const std::uint64_t* const row = block.words.data() + starts_[node];
    const int i =
        kernel_.find_target(row, block.counts[node - block.first_node],
                            static_cast<std::uint32_t>(codec_.target_mask()), static_cast<std::uint32_t>(target));
    return i >= 0 ? row + i : nullptr;
  }

  std::uint64_t reversed(Index node, std::uint8_t sector, std::uint64_t word) const {
    return codec_.length_bits(word) | static_cast<std::uint64_t>(sector) << codec_.target_bits() |
           static_cast<std::uint64_t>(node);
  }

  void sort_missing() {
    for (auto& list : missing_) {
      all_missing_.insert(all_missing_.end(), list.begin(), list.end());
      list = {};
    }
    std::sort(all_missing_.begin(), all_missing_.end());
    first_missing_.assign(found_.size() + 1, 0);
    for (const MissingArc& arc : all_missing_) ++first_missing_[arc.node / block_size_ + 1];
    for (std::size_t b = 0; b < found_.size(); ++b) first_missing_[b + 1] += first_missing_[b];
  }

  template <class Use>
  void for_each_row(Index b, Use&& use) const {
    const FoundArcs& block = found_[b];
    const MissingArc* other = all_missing_.data() + first_missing_[b];
    const MissingArc* const last = all_missing_.data() + first_missing_[b + 1];
    for (std::size_t row = 0; row < block.counts.size(); ++row) {
      const Index node = block.first_node + static_cast<Index>(row);
      const MissingArc* const begin = other;
      while (other != last && other->node == node) ++other;
      use(node, std::span(block.words.data() + starts_[node], block.counts[row]), std::span(begin, other));
    }
  }

  const ArcCodec& codec_;
  const WaveKernel& kernel_;
  std::vector<FoundArcs>& found_;
  Index block_size_, node_count_ = 0;
  std::vector<Index> starts_;  ///< of each node's row in its block
  std::vector<std::vector<MissingArc>> missing_;
  std::vector<MissingArc> all_missing_;
  std::vector<std::int64_t> first_missing_;  ///< per block
};

}  // namespace

ArcRows unite_with_reverses(const ArcCodec& codec, const WaveKernel& kernel, std::vector<FoundArcs>& found,
                            Index block_size, int threads, const JobStage& stage) {
  Union work(codec, kernel, found, block_size);
  parallel_for(static_cast<Index>(found.size()), threads, 4, [&](Index b, int) {
    stage.check();
    work.look_for_reverses(b);
  });
  stage.update(0.6);
  ArcRows arcs = work.assemble(threads, stage.part(0.6, 1));
  stage.update(1);
  return arcs;
}

}  // namespace saddleback
