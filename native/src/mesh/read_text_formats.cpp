// OBJ and OFF.

#include "saddleback/error.h"

#include "mesh/read_format.h"

namespace saddleback {

// Lines "v x y z ..." and "f corner ...", a corner being "vertex/texture/normal" of which only the vertex counts: from
// 1, or negative from the last one so far. Everything else is passed over.
void read_obj(std::string_view text, PolygonSoup& soup) {
  Scanner scanner(text, '#');
  std::vector<Index> corners;
  for (std::string_view key = scanner.word(); !key.empty(); key = scanner.word()) {
    if (key == "v") {
      double xyz[3];
      for (double& x : xyz) x = scanner.to_real(scanner.word_in_line(), "a coordinate");
      soup.add_vertex(xyz[0], xyz[1], xyz[2]);
    } else if (key == "f") {
      corners.clear();
      for (std::string_view corner = scanner.word_in_line(); !corner.empty(); corner = scanner.word_in_line()) {
        if (corner == "\\") {  // the face goes on in the next line
          scanner.skip_line();
          continue;
        }
        const std::int64_t number = scanner.to_integer(corner.substr(0, corner.find('/')), "a vertex number");
        if (number == 0) scanner.fail("vertex number 0, but OBJ counts from 1");
        corners.push_back(to_index(number > 0 ? number - 1 : soup.vertex_count() + number));
      }
      soup.add_polygon(corners);
    }
    scanner.skip_line();
  }
}

// "OFF", the counts, then a line a vertex and a line a face: "n v1 ... vn". What follows on a line (normals, colours)
// is passed over.
void read_off(std::string_view text, PolygonSoup& soup) {
  Scanner scanner(text, '#');
  const std::string_view magic = scanner.word();
  if (magic.size() < 3 || magic.substr(magic.size() - 3) != "OFF") scanner.fail("an OFF file begins with OFF");
  if (magic.find_first_of("4n") != magic.npos) scanner.fail("only OFF files of three dimensions can be read");
  const std::string_view first = scanner.word();
  if (first == "BINARY") scanner.fail("binary OFF files cannot be read; save it as text or as PLY");
  const std::int64_t vertices = scanner.to_integer(first, "the number of vertices");
  const std::int64_t faces = scanner.integer("the number of faces");
  scanner.skip_line();
  for (std::int64_t v = 0; v < vertices; ++v) {
    double xyz[3];
    for (double& x : xyz) x = scanner.real("a coordinate");
    soup.add_vertex(xyz[0], xyz[1], xyz[2]);
    scanner.skip_line();
  }
  std::vector<Index> corners;
  for (std::int64_t f = 0; f < faces; ++f) {
    const std::int64_t count = scanner.integer("the number of a face's corners");
    corners.clear();
    for (std::int64_t i = 0; i < count; ++i) corners.push_back(to_index(scanner.integer("a vertex number")));
    soup.add_polygon(corners);
    scanner.skip_line();
  }
}

}  // namespace saddleback
