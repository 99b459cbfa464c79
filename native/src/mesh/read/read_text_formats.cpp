// OBJ and OFF.

#include <algorithm>
#include <array>
#include <limits>

#include "saddleback/error.h"

#include "mesh/read/read_format.h"

namespace saddleback {
namespace {

// Lines that say nothing about the surface: of numbers, which may go on in the next line, and of names, which may well
// end with a backslash. Curves are lines of the first kind, for they bound nothing.
constexpr std::array<std::string_view, 13> k_numbers{"vt",    "vn",  "vp",   "l",    "p",  "parm", "curv",
                                                     "curv2", "deg", "bmat", "step", "sp", "con"};
constexpr std::array<std::string_view, 17> k_names{
    "g",   "o",     "s",        "usemtl",   "mtllib",     "usemap",    "maplib", "mg",   "lod",
    "end", "bevel", "c_interp", "d_interp", "shadow_obj", "trace_obj", "cstype", "ctech"};

bool is_one_of(std::span<const std::string_view> words, std::string_view word) {
  return std::any_of(words.begin(), words.end(), [&](std::string_view known) { return is_word(word, known); });
}

class ObjReader {
 public:
  ObjReader(std::string_view text, PolygonSoup& soup) : scanner_(text, '#', '\\'), soup_(soup) {}

  void read() {
    for (std::string_view key = scanner_.word(); !key.empty(); key = scanner_.word()) {
      soup_.stage().check();
      read_line(key);
    }
    if (last_ >= soup_.vertex_count()) Scanner::fail_at(last_line_, no_such_vertex(last_ + 1, soup_.vertex_count()));
  }

 private:
  void read_line(std::string_view key) {
    if (is_word(key, "v")) {
      double xyz[3];
      for (double& x : xyz) x = scanner_.real_in_line("a coordinate");
      soup_.add_vertex(xyz[0], xyz[1], xyz[2]);
      // A weight or a color may follow.
      for (std::string_view word = scanner_.word_in_line(); !word.empty(); word = scanner_.word_in_line())
        scanner_.to_real(word, "a number");
    } else if (is_word(key, "f") || is_word(key, "fo")) {
      corners_.clear();
      for (std::string_view corner = scanner_.word_in_line(); !corner.empty(); corner = scanner_.word_in_line())
        corners_.push_back(vertex_of(corner));
      soup_.add_polygon(corners_);
    } else if (is_one_of(k_numbers, key)) {
      scanner_.skip_continued();
    } else if (is_one_of(k_names, key)) {
      scanner_.skip_line();
    } else if (is_word(key, "surf")) {
      scanner_.fail("free-form surfaces are not read; save them as polygons");
    } else {
      scanner_.fail(message(quoted(key), " is no keyword of OBJ that can be read"));
    }
  }

  // Numbers may run ahead of the vertices, so the largest is looked at in the end.
  Index vertex_of(std::string_view corner) {
    std::size_t slash = 0;
    while (slash < corner.size() && corner[slash] != '/') ++slash;
    for (const char c : corner.substr(slash))
      if (c < '-' || c > '9') scanner_.fail(message("wanted vertex/texture/normal, got ", quoted(corner)));
    const std::int64_t number = scanner_.to_integer(corner.substr(0, slash), "a vertex number");
    const Index count = soup_.vertex_count();
    if (number == 0) scanner_.fail("vertex number 0, but OBJ counts from 1");
    if (number > std::numeric_limits<Index>::max()) scanner_.fail(message("vertex ", number, " is out of range"));
    if (number < -static_cast<std::int64_t>(count))
      scanner_.fail(message("vertex ", number, " is out of range; ", count, " come before"));
    const auto vertex = static_cast<Index>(number > 0 ? number - 1 : count + number);
    if (vertex > last_) {
      last_ = vertex;
      last_line_ = scanner_.line();
    }
    return vertex;
  }

  Scanner scanner_;
  PolygonSoup& soup_;
  std::vector<Index> corners_;
  Index last_ = k_none, last_line_ = 0;
};

// Of the counts; the scanner stands behind the magic.
std::string_view first_count(Scanner& scanner) {
  const std::string_view first = scanner.word();
  const std::string magic = lower_case(first);
  const std::size_t off = magic.find("off");
  if (off == magic.npos) {  // the magic may be left out
    if (first.empty() || first.find_first_not_of("0123456789") != first.npos)
      scanner.fail("an OFF file begins with OFF");
    return first;
  }
  if (magic.find_first_not_of("stcn4") < off) scanner.fail("an OFF file begins with OFF");
  const std::string_view prefix = std::string_view(magic).substr(0, off);
  if (prefix.find('4') != prefix.npos || magic.compare(off + 3, 1, "n") == 0)
    scanner.fail("only OFF files of three dimensions can be read");
  const std::string_view rest = first.substr(off + 3);  // "OFF8 12 0"
  const std::string_view count = rest.empty() ? scanner.word() : rest;
  if (lower_case(count) == "binary") scanner.fail("binary OFF files cannot be read; save it as text or as PLY");
  return count;
}

}  // namespace

// Lines "v x y z ..." and "f corner ...", a corner being "vertex/texture/normal" of which only the vertex counts: from
// 1, or negative from the last one so far. What else OBJ knows is passed over.
void read_obj(std::string_view text, PolygonSoup& soup) { ObjReader(text, soup).read(); }

// "OFF", the counts, then a line a vertex and a line a face: "n v1 ... vn". What follows on a line (normals, colors) is
// passed over.
void read_off(std::string_view text, PolygonSoup& soup) {
  Scanner scanner(text, '#');
  const std::int64_t vertices = scanner.to_count(first_count(scanner), "the number of vertices");
  const std::int64_t faces = scanner.count("the number of faces");
  scanner.skip_line();
  for (std::int64_t v = 0; v < vertices; ++v) {
    const double x = scanner.real("a coordinate"), y = scanner.real_in_line("a coordinate"),
                 z = scanner.real_in_line("a coordinate");
    soup.add_vertex(x, y, z);
    scanner.skip_line();
  }
  std::vector<Index> corners;
  for (std::int64_t f = 0; f < faces; ++f) {
    const std::int64_t count = scanner.count("the number of a face's corners");
    corners.clear();
    for (std::int64_t i = 0; i < count; ++i) {
      const std::int64_t vertex = scanner.integer("a vertex number");
      if (vertex < 0 || vertex >= vertices) scanner.fail(no_such_vertex(vertex, vertices));
      corners.push_back(static_cast<Index>(vertex));
    }
    soup.add_polygon(corners);
    scanner.skip_line();
  }
  if (const std::string_view more = scanner.word(); !more.empty())
    scanner.fail(message(quoted(more), " follows the last of ", faces, " faces"));
}

}  // namespace saddleback
