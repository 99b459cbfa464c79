// STL: triangles without shared vertices. Binary: 80 bytes of anything, the count, then 50 bytes a face. Text: "facet
// normal ... outer loop", three times "vertex x y z", "endloop endfacet". Text files begin with "solid", but so do some
// binary ones.

#include <array>
#include <bit>
#include <cstring>

#include "saddleback/error.h"

#include "mesh/read/read_format.h"

namespace saddleback {
namespace {

constexpr std::size_t k_header = 84, k_face = 50;

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

// Returns the count that the header says; where it says none (0), the one that there is room for. Other bytes may
// follow the faces, but whole faces more mean that the count is wrong.
std::size_t face_count(std::string_view bytes) {
  if (bytes.size() < k_header) throw MeshError(message("it is no STL file: ", bytes.size(), " bytes"));
  const std::size_t count = little_endian(bytes, 80), expected = k_header + k_face * count;
  if (count == 0) return (bytes.size() - k_header) / k_face;
  if (bytes.size() == expected || (bytes.size() > expected && (bytes.size() - expected) % k_face != 0)) return count;
  throw MeshError(message("it is neither text nor a binary STL file of ", count, " faces: ", bytes.size(),
                          " bytes instead of ", expected));
}

void read_binary(std::string_view bytes, PolygonSoup& soup) {
  const std::size_t count = face_count(bytes);
  for (std::size_t f = 0; f < count; ++f) {
    const Index first = soup.vertex_count();
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::size_t at = k_header + k_face * f + 12 * (corner + 1);  // the normal comes first
      const auto coordinate = [&](std::size_t i) { return std::bit_cast<float>(little_endian(bytes, at + 4 * i)); };
      soup.add_vertex(coordinate(0), coordinate(1), coordinate(2));
    }
    soup.add_polygon(std::array<Index, 3>{first, first + 1, first + 2});
  }
}

void read_text(Scanner& scanner, PolygonSoup& soup) {
  scanner.skip_line();  // solid and its name
  std::vector<Index> loop;
  bool complete = false;
  for (std::string_view word = scanner.word(); !word.empty(); word = scanner.word()) {
    if (is_word(word, "vertex")) {
      loop.push_back(soup.vertex_count());
      double xyz[3];
      for (double& x : xyz) x = scanner.real("a coordinate");
      soup.add_vertex(xyz[0], xyz[1], xyz[2]);
    } else if (is_word(word, "endloop")) {
      soup.add_polygon(loop);
      loop.clear();
    } else if (!loop.empty()) {
      scanner.fail(message("wanted vertex or endloop, got ", quoted(word)));
    } else if (is_word(word, "normal")) {  // whatever it is: some write no numbers for faces without area
      for (int i = 0; i < 3; ++i) scanner.word();
    } else if (is_word(word, "solid") || is_word(word, "endsolid")) {
      complete = is_word(word, "endsolid");
      scanner.skip_line();
    } else if (!is_word(word, "facet") && !is_word(word, "outer") && !is_word(word, "loop") &&
               !is_word(word, "endfacet")) {
      scanner.fail(message(quoted(word), " is no keyword of STL"));
    }
  }
  if (!complete) scanner.fail("the file ends before endsolid");
}

// Binary files are full of zeros, and text has none.
bool is_text(std::string_view bytes) {
  if (bytes.size() >= k_header && bytes.size() == k_header + k_face * std::size_t{little_endian(bytes, 80)})
    return false;
  return bytes.find('\0') == bytes.npos;
}

}  // namespace

void read_stl(std::string_view text, PolygonSoup& soup) {
  if (!is_text(text)) return read_binary(text, soup);
  Scanner scanner(text, 0);
  if (!is_word(scanner.word(), "solid")) scanner.fail("an STL file of text begins with solid");
  read_text(scanner, soup);
}

}  // namespace saddleback
