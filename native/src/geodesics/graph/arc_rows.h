#pragma once
// The arcs of a graph in flat arrays: one 64-bit word an arc.

#include <atomic>
#include <bit>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "saddleback/support/large_array.h"
#include "saddleback/types.h"

#include "geodesics/graph/arc_packing.h"
#include "support/mapped_file.h"

namespace saddleback {

/// Holds how long the ways on a mesh are.
struct PathBounds {
  double longest;        ///< bounds every finite distance from above
  double shortest_edge;  ///< no edge is shorter
};

/// Holds what a codec follows from.
struct CodecParts {
  int target_bits;
  std::int32_t least_exponent;
  double quantum, longest;
  bool operator==(const CodecParts&) const = default;
};

/// Packs an arc into 64 bits, from the low end: target, direction and length.
///
/// The direction is the 256th part of the full angle about the vertex in which the arc leaves: enough to find the
/// arc's faces again, see unfold_arc. The length takes the bits that the target leaves, as a floating-point number with
/// its own exponent: a relative error of at most 2e-9 for two million vertices, 2.4e-10 for 200,000 and fewer.
///
/// Lengths are rounded up, so that no distance is shorter than the truth, to multiples of a quantum so small a part of
/// the longest path that sums of arcs are exact in double precision: a path is equally long from both ends and by every
/// method, to the bit. Where edges are shorter than the 2^-27th part of the longest path, the quantum is smaller, lest
/// they be rounded by more than 1.2e-7.
/// Sums of arcs so unlike may be rounded then, which shows only between the two ends of a path: the least of the sums
/// from a source on is the same by every method all the same, since a sum never falls where one of its terms rises.
class ArcCodec {
 public:
  static constexpr int k_sectors = 256;
  static constexpr Index k_most_vertices = 1 << 28;

  ArcCodec() = default;
  /// \throw InputError where lengths differ by more than their exponents hold.
  ArcCodec(Index vertex_count, double mean_edge, const PathBounds& bounds);
  explicit ArcCodec(const CodecParts& parts);
  CodecParts parts() const { return {packing_.target_bits, least_exponent_, quantum_, longest_}; }
  static int bits_of_targets(Index vertex_count);

  /// Rounds a length that is no arc's up to a multiple of the quantum; never zero. Lengths of arcs stay as they are.
  double round(double length) const {
    // Long arcs take the coarser quantum of meshes without short edges: sums of long ones are exact on any mesh.
    constexpr double k_long = 1.0 / (1 << 20);
    return length < k_long * longest_ ? packing_.round(length) : ArcPacking::round_up(length, longest_);
  }
  std::uint64_t pack(Index target, int sector, double length) const { return packing_.pack(target, sector, length); }
  const ArcPacking& packing() const { return packing_; }

  Index target(std::uint64_t word) const { return static_cast<Index>(word & packing_.target_mask); }
  int sector(std::uint64_t word) const { return static_cast<int>(word >> packing_.target_bits & 0xFF); }
  /// The length's bits are an exponent and a mantissa: put in their places they are a double.
  double length(std::uint64_t word) const {
    return std::bit_cast<double>(((word & packing_.length_mask) >> k_length_shift) + packing_.bias);
  }
  std::uint64_t length_bits(std::uint64_t word) const { return word & packing_.length_mask; }  ///< order as lengths do
  /// Tells whether a word is as `pack` leaves a word: nothing in its spare bits; a length of whole quanta, no longer
  /// than paths are.
  bool is_packed(std::uint64_t word) const;
  std::uint64_t target_mask() const { return packing_.target_mask; }

  /// Serves loops over whole rows: a double's bits are ((word & length_mask) >> k_length_shift) + length_bias.
  static constexpr int k_exponent_bits = 6;  ///< at the top of the word, where a double has a sign and 11
  static constexpr int k_length_shift = 12 - k_exponent_bits;
  std::uint64_t length_mask() const { return packing_.length_mask; }
  std::uint64_t length_bias() const { return packing_.bias; }

  double quantum() const { return quantum_; }
  double shortest() const { return packing_.least; }  ///< no length is shorter, nor any rounded by more
  double longest() const { return longest_; }         ///< nor longer
  int target_bits() const { return packing_.target_bits; }
  std::int32_t least_exponent() const { return least_exponent_; }

 private:
  ArcPacking packing_;
  std::int32_t least_exponent_ = 0;
  double quantum_ = 1, longest_ = 1;
};

/// Words of arcs, in memory that the threads that fill it touch first; huge pages make scattered look-ups cheaper.
using ArcWords = LargeArray<std::uint64_t>;

/// Words in a mapped file, which are looked at before they are read for the first time.
struct MappedRows {
  static constexpr Index k_block = 256;  ///< nodes that are looked at together
  std::string path;
  MappedFile file;
  std::span<const std::uint64_t> words;
  std::unique_ptr<std::atomic<bool>[]> seen;  ///< per block
  MappedRows(const std::string& the_path, std::uint64_t node_count)
      : path(the_path), file(the_path), seen(std::make_unique<std::atomic<bool>[]>(node_count / k_block + 1)) {}
};

/// Rows of arcs, a row a node, in compressed sparse rows.
class ArcRows {
 public:
  ArcRows() = default;
  ArcRows(const ArcCodec& codec, std::vector<std::int64_t> offsets, ArcWords words);
  ArcRows(const ArcCodec& codec, std::vector<std::int64_t> offsets, std::shared_ptr<MappedRows> mapped, double longest);
  ArcRows(ArcRows&&) noexcept = default;
  ArcRows& operator=(ArcRows&&) noexcept = default;

  Index node_count() const { return static_cast<Index>(offsets_.size()) - 1; }
  std::int64_t count() const { return static_cast<std::int64_t>(words_.size()); }
  std::int64_t first(Index node) const { return offsets_[node]; }  ///< row of a node: [first(node), first(node + 1))
  Index target(std::int64_t arc) const { return codec_.target(words_[arc]); }
  /// Returns an arc's length, equal to the bit for its reverse.
  double length(std::int64_t arc) const { return codec_.length(words_[arc]); }
  int sector(std::int64_t arc) const { return codec_.sector(words_[arc]); }
  /// The arc from one node to another, -1 when they are not linked. O(degree).
  std::int64_t find(Index from, Index to) const;
  double longest() const { return longest_; }
  double find_longest() const;
  /// Checks a node's row before its targets are read: in a file they may be anything. \throw InputError.
  void look_at(Index node) const {
    if (mapped_ && !mapped_->seen[node / MappedRows::k_block].load(std::memory_order_relaxed)) look_at_block_of(node);
  }
  void look_at_all() const;
  const MappedRows* mapped() const { return mapped_.get(); }
  const ArcCodec& codec() const { return codec_; }
  std::span<const std::uint64_t> words() const { return words_; }
  std::span<const std::int64_t> offsets() const { return offsets_; }
  std::size_t nbytes() const;

 private:
  void look_at_block_of(Index node) const;

  ArcCodec codec_;
  std::vector<std::int64_t> offsets_{0};
  ArcWords own_words_;
  std::span<const std::uint64_t> words_;  ///< own ones, or mapped
  std::shared_ptr<MappedRows> mapped_;
  double longest_ = 0;
};

}  // namespace saddleback
