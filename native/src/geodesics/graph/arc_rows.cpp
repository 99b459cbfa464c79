#include "geodesics/graph/arc_rows.h"

#include <algorithm>
#include <cmath>

#include "saddleback/error.h"

#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr int k_double_exponent_bias = 1023, k_double_mantissa_bits = 52;
// More bits would only tell apart what is equally long but for rounding, and spoil ties on regular meshes.
constexpr int k_most_mantissa_bits = 32;
constexpr Index k_rows_at_once = 1024;
constexpr std::size_t k_words_apart = k_apart / sizeof(std::uint64_t);
// Lengths from 2^-40 to 2^24 mean edges, and some less where edges are as short as that: shorter arcs count as the
// shortest, longer ones do not occur.
constexpr int k_octaves = 1 << ArcCodec::k_exponent_bits, k_octaves_below_mean = 40, k_octaves_below_shortest = 8;
// The digits that rounding leaves of the shortest edge.
constexpr int k_bits_of_shortest = 24;

/// The lengths' exponents begin there.
int lowest_exponent(double mean_edge, const PathBounds& bounds) {
  const int usual = std::ilogb(mean_edge) - k_octaves_below_mean, shortest = std::ilogb(bounds.shortest_edge);
  if (shortest - k_octaves_below_shortest >= usual) return usual;
  const int least = std::max(shortest - k_octaves_below_shortest, std::ilogb(bounds.longest) + 2 - k_octaves);
  if (least < shortest) return least;
  throw InputError(message("mesh: its shortest edge (", bounds.shortest_edge,
                           ") is so small a part of its longest paths (up to ", bounds.longest,
                           ") that no graph holds both; make a mesh and a graph of each part"));
}

}  // namespace

int ArcCodec::bits_of_targets(Index vertex_count) {
  return std::max(1, static_cast<int>(std::bit_width(static_cast<std::uint32_t>(vertex_count - 1))));
}

ArcCodec::ArcCodec(Index vertex_count, double mean_edge, const PathBounds& bounds)
    : ArcCodec([&] {
        const double longest = std::ldexp(1.0, std::ilogb(bounds.longest) + 1);
        const double quantum = std::min(std::ldexp(longest, -k_double_mantissa_bits),
                                        std::ldexp(1.0, std::ilogb(bounds.shortest_edge) - k_bits_of_shortest));
        return CodecParts{bits_of_targets(vertex_count), lowest_exponent(mean_edge, bounds), quantum, longest};
      }()) {}

ArcCodec::ArcCodec(const CodecParts& parts)
    : least_exponent_(parts.least_exponent), quantum_(parts.quantum), longest_(parts.longest) {
  packing_.target_bits = parts.target_bits;
  packing_.target_mask = (std::uint64_t{1} << packing_.target_bits) - 1;
  packing_.length_shift = std::max(packing_.target_bits + 8, 64 - k_exponent_bits - k_most_mantissa_bits);
  packing_.length_mask = ~((std::uint64_t{1} << packing_.length_shift) - 1);
  packing_.kept_shift = k_length_shift;
  packing_.bias = static_cast<std::uint64_t>(std::int64_t{least_exponent_} + k_double_exponent_bias)
                  << k_double_mantissa_bits;
  packing_.least = std::max(quantum_, std::ldexp(1.0, least_exponent_));
  packing_.rounder = std::ldexp(quantum_, k_double_mantissa_bits);
}

ArcRows::ArcRows(const ArcCodec& codec, std::vector<std::int64_t> offsets, ArcWords words)
    : codec_(codec), offsets_(std::move(offsets)), own_words_(std::move(words)), words_(own_words_) {
  longest_ = find_longest();
}

ArcRows::ArcRows(const ArcCodec& codec, std::vector<std::int64_t> offsets, std::shared_ptr<MappedRows> mapped,
                 double longest)
    : codec_(codec),
      offsets_(std::move(offsets)),
      words_(mapped->words),
      mapped_(std::move(mapped)),
      longest_(longest) {}

double ArcRows::find_longest() const {
  if (words_.empty()) return 0;
  const Index rows = node_count();
  std::vector<std::uint64_t> longest(static_cast<std::size_t>(thread_count(0)) * k_words_apart);
  parallel_for(rows, 0, k_rows_at_once, [&](Index row, int thread) {
    std::uint64_t& seen = longest[thread * k_words_apart];
    for (std::int64_t i = offsets_[row]; i < offsets_[row + 1]; ++i)
      seen = std::max(seen, codec_.length_bits(words_[i]));
  });
  return codec_.length(*std::max_element(longest.begin(), longest.end()));
}

bool ArcCodec::is_packed(std::uint64_t word) const {
  const double quanta = length(word) / quantum_;
  if (!(quanta >= 1 && length(word) <= longest_)) return false;
  const std::uint64_t all = length_bits(word) | static_cast<std::uint64_t>(sector(word)) << target_bits() |
                            static_cast<std::uint64_t>(target(word));
  return word == all && std::floor(quanta) == quanta;
}

void ArcRows::look_at_block_of(Index node) const {
  const Index block = node / MappedRows::k_block, begin = block * MappedRows::k_block;
  const Index end = std::min(node_count(), begin + MappedRows::k_block);
  for (std::int64_t arc = first(begin); arc < first(end); ++arc) {
    if (target(arc) < node_count() && length(arc) <= longest_ && codec_.is_packed(words_[arc])) continue;
    throw InputError(message("path: ", mapped_->path, " is a damaged graph file: an arc of the nodes ", begin, " to ",
                             end - 1,
                             " is no arc, or leads to a node that there is not; build and save the graph again"));
  }
  mapped_->seen[block].store(true, std::memory_order_relaxed);
}

void ArcRows::look_at_all() const {
  for (Index node = 0; mapped_ && node < node_count(); node += MappedRows::k_block) look_at(node);
}

std::int64_t ArcRows::find(Index from, Index to) const {
  const auto row = words_.begin() + offsets_[from], end = words_.begin() + offsets_[from + 1];
  const auto found = std::find_if(row, end, [&](std::uint64_t word) { return codec_.target(word) == to; });
  return found != end ? found - words_.begin() : -1;
}

std::size_t ArcRows::nbytes() const {
  return offsets_.size() * sizeof(std::int64_t) + words_.size() * sizeof(std::uint64_t);
}

}  // namespace saddleback
