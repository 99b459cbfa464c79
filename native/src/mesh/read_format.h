#pragma once
// What the readers of all file formats share: the text of a file, word by word, and the polygons that come out of it.
//
// OpenMesh has readers for the same formats, but they keep coordinates in single precision, share state between
// threads, print to stderr and trust the counts that a file claims.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/read_mesh.h"

namespace saddleback {

/// Collects vertices and polygons; cuts the polygons into triangles at the end, when all vertices are known.
class PolygonSoup {
 public:
  explicit PolygonSoup(JobStage stage) : stage_(stage) {}
  void add_vertex(double x, double y, double z);
  /// Polygons of fewer than three corners are passed over.
  void add_polygon(std::span<const Index> corners);
  Index vertex_count() const { return static_cast<Index>(xyz_.size() / 3); }
  const JobStage& stage() const { return stage_; }
  MeshArrays triangulate() &&;

 private:
  JobStage stage_;
  std::vector<double> xyz_;
  std::vector<Index> corners_, begins_{0};
};

/// Words and lines of a text. Every failure is a MeshError that names the line.
class Scanner {
 public:
  /// `comment`: the character that hides the rest of its line, or 0.
  Scanner(std::string_view text, char comment) : text_(text), comment_(comment) {}

  /// Next word on any line; empty at the end of the text.
  std::string_view word();
  /// Next word on this line; empty at its end.
  std::string_view word_in_line();
  void skip_line();
  /// The next word as a number. `what` says what was wanted.
  double real(const char* what);
  std::int64_t integer(const char* what);
  /// Parses a word that was already taken.
  double to_real(std::string_view word, const char* what) const;
  std::int64_t to_integer(std::string_view word, const char* what) const;
  bool at_end() const { return at_ >= text_.size(); }
  std::size_t position() const { return at_; }
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  bool skip_blanks(bool over_lines);

  std::string_view text_;
  std::size_t at_ = 0;
  Index line_ = 1;
  char comment_;
};

/// The beginning of a word for a message, what is not ASCII shown as a question mark.
std::string quoted(std::string_view word);

/// A file's index as ours; what does not fit 32 bits becomes k_none, which no mesh accepts.
Index to_index(std::int64_t value);

void read_obj(std::string_view text, PolygonSoup& soup);
void read_off(std::string_view text, PolygonSoup& soup);
void read_ply(std::string_view text, PolygonSoup& soup);
void read_stl(std::string_view text, PolygonSoup& soup);

}  // namespace saddleback
