#pragma once
// The code that the readers of all file formats share: the text of a file, word by word, and the polygons that come out
// of it.
//
// OpenMesh has readers for the same formats, but they keep coordinates in single precision, share state between
// threads, print to stderr and trust the counts that a file claims.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "saddleback/job.h"
#include "saddleback/mesh/read_mesh.h"

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

/// Words and lines of a text, a line ending with \n, \r\n or \r. Every failure is a MeshError that names the line.
class Scanner {
 public:
  /// `comment`: the character that hides the rest of its line, `continuation`: the one that joins the next line when it
  /// is the last of its own; 0 for none. A byte order mark is passed over. \throw MeshError for UTF-16.
  Scanner(std::string_view text, char comment, char continuation = 0);

  /// Next word on any line; empty at the end of the text.
  std::string_view word();
  /// Next word on this line; empty at its end.
  std::string_view word_in_line();
  /// Goes on to the next line, whatever this one holds; it is never continued.
  void skip_line();
  /// Goes on to the next line that does not continue this one.
  void skip_continued();
  /// The next word as a number. `what` says what was wanted.
  double real(const char* what);
  std::int64_t integer(const char* what);
  /// Does the same of a number that must be 0 or more.
  std::int64_t count(const char* what);
  /// The next number on this line.
  double real_in_line(const char* what) { return to_real(word_in_line(), what); }
  /// Parses a word that was already taken.
  double to_real(std::string_view word, const char* what) const;
  std::int64_t to_integer(std::string_view word, const char* what) const;
  std::int64_t to_count(std::string_view word, const char* what) const;
  std::size_t position() const { return at_; }
  Index line() const { return line_; }
  [[noreturn]] void fail(const std::string& problem) const { fail_at(line_, problem); }
  [[noreturn]] static void fail_at(Index line, const std::string& problem);

 private:
  bool skip_blanks(bool over_lines);
  std::string_view take_word();
  void skip_to_line_end();
  bool is_continued(std::size_t at) const;
  void end_line();

  std::string_view text_;
  std::size_t at_ = 0;
  Index line_ = 1;
  char comment_, continuation_;
};

/// The beginning of a word for a message, what is not ASCII shown as a question mark.
std::string quoted(std::string_view word);

/// A word in small letters, A to Z alone.
std::string lower_case(std::string_view word);

inline char small_letter(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; }

/// Tells whether a word is this one, which is in small letters, but for capitals.
inline bool is_word(std::string_view word, std::string_view wanted) {
  if (word.size() != wanted.size()) return false;
  for (std::size_t i = 0; i < word.size(); ++i)
    if (small_letter(word[i]) != wanted[i]) return false;
  return true;
}

/// Returns what to say of a vertex that a file does not have.
std::string no_such_vertex(std::int64_t number, std::int64_t count);

void read_obj(std::string_view text, PolygonSoup& soup);
void read_off(std::string_view text, PolygonSoup& soup);
void read_ply(std::string_view text, PolygonSoup& soup);
void read_stl(std::string_view text, PolygonSoup& soup);

}  // namespace saddleback
