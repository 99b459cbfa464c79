// STL: triangles without shared vertices. Binary: 80 bytes, a count, 50 bytes a face. Text: "vertex x y z" lines within
// "outer loop" ... "endloop". Text files begin with "solid", but so do some binary ones: the size decides.

#include <bit>
#include <cstring>

#include "saddleback/error.h"

#include "mesh/read_format.h"

namespace saddleback {
namespace {

constexpr std::size_t k_header = 84, k_face = 50;

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

void read_binary(std::string_view bytes, std::size_t count, PolygonSoup& soup) {
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

void read_text(std::string_view text, PolygonSoup& soup) {
  Scanner scanner(text, 0);
  scanner.skip_line();  // solid and its name
  std::vector<Index> loop;
  bool complete = false;
  for (std::string_view word = scanner.word(); !word.empty(); word = scanner.word()) {
    if (word == "vertex") {
      loop.push_back(soup.vertex_count());
      double xyz[3];
      for (double& x : xyz) x = scanner.real("a coordinate");
      soup.add_vertex(xyz[0], xyz[1], xyz[2]);
    } else if (word == "endloop") {
      soup.add_polygon(loop);
      loop.clear();
    } else if (word == "solid" || word == "endsolid") {
      complete = word == "endsolid";
      scanner.skip_line();
    }
  }
  if (!complete) scanner.fail("the file ends before endsolid");
}

}  // namespace

void read_stl(std::string_view text, PolygonSoup& soup) {
  const std::size_t count = text.size() >= k_header ? little_endian(text, 80) : 0;
  if (text.size() >= k_header && text.size() == k_header + k_face * count) {
    read_binary(text, count, soup);
  } else if (text.substr(0, 5) == "solid") {
    read_text(text, soup);
  } else {
    throw MeshError(message("it is neither text nor a binary STL file of ", count, " faces: ", text.size(),
                            " bytes instead of ", k_header + k_face * count));
  }
}

}  // namespace saddleback
