#pragma once
// The bytes in which parts of a graph travel, version 1: a header, then what its kind holds, aligned and not
// compressed.
//
//   found    words uint64 an arc and k_row_padding more, degrees int32 a node, directions back uint8 an arc
//   across   words uint64 an arc, as it goes back; node int32 an arc that it goes back from
//   united   words uint64 an arc, degrees int32 a node
//   CRC-32   uint32, of all bytes before
//
// Bytes are believed nothing: their length, their checksum and their numbers are looked at before they are used.

#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>

#include "saddleback/geodesics/graph_parts.h"

#include "geodesics/graph/arc_symmetry.h"

namespace saddleback {

enum class PartKind : std::uint32_t { found, across, united };

struct PartHeader {
  // As in PNG: bytes that are no text, a name, line ends; and it tells in what order a machine puts bytes.
  static constexpr std::uint64_t k_magic = 0x1A0A0D7263415389;
  static constexpr std::uint32_t k_version = 1;
  std::uint64_t magic = k_magic;
  std::uint32_t version = k_version, header_bytes = 0;
  std::uint64_t byte_count = 0;
  std::uint64_t fingerprint = 0, vertex_count = 0, face_count = 0;  // of the mesh
  std::uint64_t arc_count = 0;
  std::uint32_t k = 0;
  PartKind kind = PartKind::found;
  double accuracy = 0;
  CodecParts codec{};
  std::int32_t part = 0, parts = 1;
  std::int32_t from = 0;  ///< part that arcs come across from; otherwise the same part
  std::int32_t first_node = 0, node_count = 0;
  std::uint32_t spare = 0;
  std::array<char, 16> library{};  ///< version of the library: another one might find other arcs
};
static_assert(sizeof(PartHeader) == 136);

/// A part's nodes: whole blocks.
struct PartRange {
  Index first, count;
};
PartRange range_of(Index part, Index parts, Index node_count);

/// The version of this library, as headers hold it.
std::array<char, 16> library_version();

/// Bytes that were looked at. They must outlive it.
class PartView {
 public:
  /// `name` of the argument that they are: "parts[3]". \throw InputError, VersionError.
  PartView(std::span<const std::byte> bytes, PartKind kind, std::string name);
  /// Looks at bytes of either of two kinds.
  PartView(std::span<const std::byte> bytes, PartKind kind, PartKind or_else, std::string name);
  const PartHeader& header() const { return header_; }
  const std::string& name() const { return name_; }
  std::span<const std::uint64_t> words() const { return words_; }     ///< without padding
  std::span<const std::int32_t> numbers() const { return numbers_; }  ///< degrees, or nodes of arcs across
  std::span<const std::uint8_t> back_sectors() const { return back_sectors_; }
  /// The arcs of found parts by blocks.
  std::vector<KeptArcs> blocks() const;
  /// \throw InputError unless both are parts of the same graph.
  void check_same_graph(const PartView& other) const;
  [[noreturn]] void refuse(const std::string& what) const;

 private:
  void check_size(std::size_t size) const;
  void check_numbers() const;

  std::string name_;
  PartHeader header_;
  std::vector<std::uint64_t> aligned_;  ///< a copy where the bytes are not
  std::span<const std::uint64_t> words_;
  std::span<const std::int32_t> numbers_;
  std::span<const std::uint8_t> back_sectors_;
};

/// Makes the bytes of a part. Lengths in the header are filled in. Words, numbers and directions may come in pieces.
class PartWriter {
 public:
  PartWriter(PartHeader header, std::uint64_t arc_count);
  template <class Number>
  void append(std::span<const Number> numbers) {
    if (!numbers.empty()) std::memcpy(bytes_.data() + used_, numbers.data(), numbers.size_bytes());
    used_ += numbers.size_bytes();
  }
  /// Words of found parts are followed by this.
  void append_padding();
  PartBytes finish();

 private:
  PartBytes bytes_;
  std::size_t used_ = 0;
};

}  // namespace saddleback
