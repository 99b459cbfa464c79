#include "geodesics/part_bytes.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "saddleback/error.h"

#include "geodesics/graph/graph_arcs.h"
#include "support/crc32.h"

namespace saddleback {
namespace {

constexpr const char* k_remedy = "; find the arcs of that part again";

std::uint64_t words_of(const PartHeader& header) {
  return header.arc_count + (header.kind == PartKind::found ? k_row_padding : 0);
}
std::uint64_t numbers_of(const PartHeader& header) {
  return header.kind == PartKind::across ? header.arc_count : static_cast<std::uint64_t>(header.node_count);
}
std::uint64_t sectors_of(const PartHeader& header) { return header.kind == PartKind::found ? header.arc_count : 0; }

/// Does not overflow for counts no larger than what is in memory.
std::uint64_t expected_bytes(const PartHeader& header) {
  return sizeof(PartHeader) + words_of(header) * sizeof(std::uint64_t) + numbers_of(header) * sizeof(std::int32_t) +
         sectors_of(header) + sizeof(std::uint32_t);
}

const char* name_of(PartKind kind) {
  switch (kind) {
    case PartKind::found:
      return "arcs that find_arcs returned";
    case PartKind::across:
      return "arcs that arcs_across returned";
    default:
      return "arcs that unite_arcs returned";
  }
}

std::string options_of(const PartHeader& header) {
  return header.k > 0 ? message("k=", header.k) : message("accuracy=", header.accuracy);
}

std::string text_of(const std::array<char, 16>& version) { return {version.begin(), std::ranges::find(version, '\0')}; }

}  // namespace

PartRange range_of(Index part, Index parts, Index node_count) {
  const std::int64_t blocks = block_count(node_count);
  const auto begin = [&](std::int64_t which) {
    return static_cast<Index>(std::min<std::int64_t>(blocks * which / parts * k_nodes_a_block, node_count));
  };
  return {begin(part), begin(part + std::int64_t{1}) - begin(part)};
}

std::array<char, 16> library_version() {
  std::array<char, 16> version{};
  constexpr std::string_view k_text = SADDLEBACK_VERSION;
  static_assert(k_text.size() <= version.size());
  std::ranges::copy(k_text, version.begin());
  return version;
}

PartView::PartView(std::span<const std::byte> bytes, PartKind kind, std::string name)
    : PartView(bytes, kind, kind, std::move(name)) {}

PartView::PartView(std::span<const std::byte> bytes, PartKind kind, PartKind or_else, std::string name)
    : name_(std::move(name)) {
  header_.magic = 0;
  if (bytes.size() >= sizeof header_.magic) std::memcpy(&header_, bytes.data(), std::min(bytes.size(), sizeof header_));
  if (header_.magic != PartHeader::k_magic)
    throw InputError(message(name_, ": these bytes are no part of a graph; give ", name_of(kind)));
  check_size(bytes.size());
  const auto content = bytes.first(bytes.size() - sizeof(std::uint32_t));
  std::uint32_t crc = 0;
  std::memcpy(&crc, bytes.data() + content.size(), sizeof crc);
  if (crc32(content) != crc) refuse("these bytes are damaged: their checksum is wrong");
  if (header_.kind != kind && header_.kind != or_else)
    throw InputError(message(name_, ": these are ", name_of(header_.kind), "; give ", name_of(kind)));
  if (header_.library != library_version()) {
    throw VersionError(message(name_, ": found by version ", text_of(header_.library), " of the library, and this is ",
                               text_of(library_version()), ", which may find other arcs", k_remedy));
  }
  const std::byte* start = bytes.data() + sizeof(PartHeader);
  if (reinterpret_cast<std::uintptr_t>(start) % alignof(std::uint64_t) != 0) {
    aligned_.resize((content.size() - sizeof(PartHeader)) / sizeof(std::uint64_t) + 1);
    std::memcpy(aligned_.data(), start, content.size() - sizeof(PartHeader));
    start = reinterpret_cast<const std::byte*>(aligned_.data());
  }
  words_ = {reinterpret_cast<const std::uint64_t*>(start), header_.arc_count};
  start += words_of(header_) * sizeof(std::uint64_t);
  numbers_ = {reinterpret_cast<const std::int32_t*>(start), numbers_of(header_)};
  start += numbers_.size_bytes();
  back_sectors_ = {reinterpret_cast<const std::uint8_t*>(start), sectors_of(header_)};
  check_numbers();
}

void PartView::check_size(std::size_t size) const {
  if (size < sizeof(PartHeader)) refuse(message("these bytes are cut off after ", size));
  if (header_.version > PartHeader::k_version) {
    throw VersionError(message(name_, ": these bytes have version ", header_.version, " of the format, newer than the ",
                               PartHeader::k_version, " that this library reads; update it"));
  }
  if (size < header_.byte_count) refuse(message("these bytes are cut off after ", size, " of ", header_.byte_count));
  const bool fits = header_.header_bytes == sizeof(PartHeader) && header_.kind <= PartKind::united &&
                    header_.arc_count <= size && header_.node_count >= 0;
  if (!fits || size != header_.byte_count || expected_bytes(header_) != size)
    refuse(message("these ", size, " bytes do not hold ", header_.arc_count, " arcs"));
}

/// Checks that what is used as an index is in range, and that rows are what they say.
void PartView::check_numbers() const {
  const auto vertex_count = static_cast<Index>(header_.vertex_count);
  const bool is_counted = header_.vertex_count > 0 && header_.vertex_count <= ArcCodec::k_most_vertices &&
                          header_.parts > 0 && header_.part >= 0 && header_.part < header_.parts && header_.from >= 0 &&
                          header_.from < header_.parts &&
                          header_.codec.target_bits == ArcCodec::bits_of_targets(vertex_count);
  if (!is_counted) refuse("these bytes are damaged: their header makes no sense");
  const PartRange range = range_of(header_.part, header_.parts, vertex_count);
  bool is_right = range.first == header_.first_node && range.count == header_.node_count;
  const auto is_in = [&](std::int32_t number, std::int32_t first, std::int32_t count) {
    return number >= first && number - first < count;
  };
  if (header_.kind == PartKind::across) {
    for (const std::int32_t node : numbers_) is_right &= is_in(node, range.first, range.count);
  } else {
    std::int64_t total = 0;
    for (const std::int32_t degree : numbers_) {
      is_right &= degree >= 0;
      total += degree;
    }
    is_right &= total == static_cast<std::int64_t>(header_.arc_count);
  }
  const ArcCodec codec(header_.codec);
  for (const std::uint64_t word : words_) is_right &= codec.target(word) < vertex_count;
  if (!is_right) refuse("these bytes are damaged: they hold numbers out of range");
}

std::vector<KeptArcs> PartView::blocks() const {
  std::vector<KeptArcs> result;
  std::size_t arc = 0;
  for (std::size_t row = 0; row < numbers_.size(); row += k_nodes_a_block) {
    const auto degrees = numbers_.subspan(row, std::min<std::size_t>(k_nodes_a_block, numbers_.size() - row));
    const auto count = static_cast<std::size_t>(std::accumulate(degrees.begin(), degrees.end(), std::int64_t{0}));
    result.emplace_back(header_.first_node + static_cast<Index>(row), degrees, words_.subspan(arc, count),
                        back_sectors_.subspan(arc, count));
    arc += count;
  }
  return result;
}

void PartView::check_same_graph(const PartView& other) const {
  const PartHeader &here = header_, &there = other.header_;
  const auto of_another = [&](const std::string& what) {
    throw InputError(message(name_, ": ", what, "; give the parts of one graph"));
  };
  if (here.vertex_count != there.vertex_count || here.face_count != there.face_count ||
      here.fingerprint != there.fingerprint)
    of_another(message("its arcs are of another mesh than those of ", other.name_));
  if (here.k != there.k || here.accuracy != there.accuracy) {
    of_another(message("its arcs were found with ", options_of(here), ", those of ", other.name_, " with ",
                       options_of(there)));
  }
  if (here.parts != there.parts)
    of_another(message("it is one of ", here.parts, " parts, ", other.name_, " one of ", there.parts));
  if (here.codec != there.codec) refuse("these bytes are damaged: their lengths are in another unit");
}

void PartView::refuse(const std::string& what) const { throw InputError(message(name_, ": ", what, k_remedy)); }

PartWriter::PartWriter(PartHeader header, std::uint64_t arc_count) {
  header.header_bytes = sizeof(PartHeader);
  header.arc_count = arc_count;
  header.byte_count = expected_bytes(header);
  header.library = library_version();
  bytes_.resize(header.byte_count);
  append(std::span<const PartHeader>(&header, 1));
}

void PartWriter::append_padding() {
  constexpr std::array<std::uint64_t, k_row_padding> k_zeros{};
  append(std::span<const std::uint64_t>(k_zeros));
}

PartBytes PartWriter::finish() {
  const std::uint32_t crc = crc32(std::span(bytes_).first(used_));
  append(std::span<const std::uint32_t>(&crc, 1));
  return std::move(bytes_);
}

}  // namespace saddleback
