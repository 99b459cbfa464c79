#include "mesh/read/read_format.h"

#include <algorithm>
#include <charconv>
#include <limits>
#ifndef __cpp_lib_to_chars
#include <cerrno>
#include <cmath>
#include <stdlib.h>
#include <xlocale.h>
#endif

#include "saddleback/error.h"

#include "mesh/read/triangulate_polygon.h"

namespace saddleback {
namespace {

// Most characters are beyond all of these: one comparison tells.
bool is_blank(char c) {
  return static_cast<unsigned char>(c) <= ' ' && (c == ' ' || c == '\t' || c == '\v' || c == '\f');
}
bool is_line_end(char c) { return static_cast<unsigned char>(c) <= '\r' && (c == '\n' || c == '\r'); }

#ifdef __cpp_lib_to_chars
using std::from_chars;
#else
/// Replaces the standard's, which libc++ has for real numbers only in the newest systems: what it takes, and no
/// locale's comma.
std::from_chars_result from_chars(const char* begin, const char* end, double& value) {
  static const locale_t plain = newlocale(LC_ALL_MASK, "C", nullptr);
  const std::string word(begin, end);
  if (is_blank(word[0]) || is_line_end(word[0]) || word[0] == '+' || word.find_first_of("xX") != word.npos)
    return {begin, std::errc::invalid_argument};
  errno = 0;
  char* rest = nullptr;
  const double found = strtod_l(word.c_str(), &rest, plain);
  if (rest == word.c_str()) return {begin, std::errc::invalid_argument};
  const char* const after = begin + (rest - word.c_str());
  if (errno == ERANGE && (found == 0 || std::isinf(found))) return {after, std::errc::result_out_of_range};
  value = found;
  return {after, std::errc()};
}
#endif

}  // namespace

std::string quoted(std::string_view word) {
  constexpr std::size_t k_shown = 20;
  std::string text;
  for (const char c : word.substr(0, k_shown)) text += c >= ' ' && c <= '~' ? c : '?';
  return "\"" + text + (word.size() > k_shown ? "...\"" : "\"");
}

std::string lower_case(std::string_view word) {
  std::string result(word);
  for (char& c : result) c = small_letter(c);
  return result;
}

std::string no_such_vertex(std::int64_t number, std::int64_t count) {
  return message("vertex ", number, " is out of range; the file has ", count);
}

void PolygonSoup::add_vertex(double x, double y, double z) {
  stage_.check();
  if (vertex_count() == std::numeric_limits<Index>::max() / 3) throw MeshError("too many vertices for 32-bit indices");
  xyz_.insert(xyz_.end(), {x, y, z});
}

void PolygonSoup::add_polygon(std::span<const Index> corners) {
  stage_.check();
  if (corners.size() < 3) return;
  if (corners_.size() + corners.size() > std::numeric_limits<Index>::max() / 3)
    throw MeshError("too many faces for 32-bit indices");
  corners_.insert(corners_.end(), corners.begin(), corners.end());
  begins_.push_back(static_cast<Index>(corners_.size()));
}

MeshArrays PolygonSoup::triangulate() && {
  MeshArrays result;
  PolygonTriangulator triangulator;
  std::size_t crossing = 0, first = 0;
  for (std::size_t p = 0; p + 1 < begins_.size(); ++p) {
    stage_.check();
    const auto corners = std::span<const Index>(corners_).subspan(begins_[p], begins_[p + 1] - begins_[p]);
    if (triangulator.triangulate(corners, xyz_, result.triangles, stage_)) continue;
    if (crossing++ == 0) first = p;
  }
  if (crossing > 0) {
    result.warning = message("face ", first, crossing > 1 ? message(" and ", crossing - 1, " more") : "",
                             crossing > 1 ? " cross themselves or have" : " crosses itself or has",
                             " no area: their triangles may overlap");
  }
  result.xyz = std::move(xyz_);
  return result;
}

Scanner::Scanner(std::string_view text, char comment, char continuation)
    : text_(text), comment_(comment), continuation_(continuation) {
  const std::string_view begin = text.substr(0, 2);
  if (begin == "\xff\xfe" || begin == "\xfe\xff") fail("the text is UTF-16, which is not read; save it as UTF-8");
  if (text.substr(0, 3) == "\xef\xbb\xbf") at_ = 3;
}

void Scanner::end_line() {
  ++line_;
  at_ += text_.substr(at_, 2) == "\r\n" ? 2 : 1;
}

void Scanner::skip_to_line_end() {
  const char* at = text_.data() + at_;
  const char* const end = text_.data() + text_.size();
  while (at != end && !is_line_end(*at)) ++at;
  at_ = static_cast<std::size_t>(at - text_.data());
}

// Tells whether a continuation stands there, the last of its line.
bool Scanner::is_continued(std::size_t at) const {
  return continuation_ && text_[at] == continuation_ && at + 1 < text_.size() && is_line_end(text_[at + 1]);
}

// False at the end of the text or, within a line, of the line.
bool Scanner::skip_blanks(bool over_lines) {
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (is_line_end(c)) {
      if (!over_lines) return false;
      end_line();
    } else if (is_blank(c)) {
      ++at_;
    } else if (comment_ && c == comment_) {
      skip_to_line_end();
    } else if (is_continued(at_)) {
      ++at_;
      end_line();
    } else {
      return true;
    }
  }
  return false;
}

std::string_view Scanner::word() { return skip_blanks(true) ? take_word() : std::string_view(); }

std::string_view Scanner::word_in_line() { return skip_blanks(false) ? take_word() : std::string_view(); }

std::string_view Scanner::take_word() {
  const char* const begin = text_.data() + at_;
  const char* const text_end = text_.data() + text_.size();
  const char* end = begin;
  while (end != text_end && (static_cast<unsigned char>(*end) > ' ' || !(is_blank(*end) || is_line_end(*end)))) ++end;
  if (continuation_ && end[-1] == continuation_ && end != text_end && is_line_end(*end)) --end;
  at_ = static_cast<std::size_t>(end - text_.data());
  return {begin, end};
}

void Scanner::skip_line() {
  skip_to_line_end();
  if (at_ < text_.size()) end_line();
}

void Scanner::skip_continued() {
  for (bool continued = true; continued && at_ < text_.size();) {
    const std::size_t begin = at_;
    skip_to_line_end();
    continued = at_ > begin && is_continued(at_ - 1) && text_.substr(begin, at_ - begin).find(comment_) == text_.npos;
    if (at_ < text_.size()) end_line();
  }
}

double Scanner::real(const char* what) { return to_real(word(), what); }

std::int64_t Scanner::integer(const char* what) { return to_integer(word(), what); }

std::int64_t Scanner::count(const char* what) { return to_count(word(), what); }

double Scanner::to_real(std::string_view word, const char* what) const {
  if (word.empty()) fail(message("the ", at_ < text_.size() ? "line" : "text", " ends where ", what, " should be"));
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error == std::errc::invalid_argument)
    fail(message("wanted ", what, ", got ", quoted(word)));
  if (error == std::errc::result_out_of_range) {
    // Too small is 0; too large must not pass for a place.
    const bool tiny = word.find("e-") != word.npos || word.find("E-") != word.npos;
    return tiny ? 0.0 : std::numeric_limits<double>::infinity();
  }
  return value;
}

std::int64_t Scanner::to_integer(std::string_view word, const char* what) const {
  if (word.empty()) fail(message("the ", at_ < text_.size() ? "line" : "text", " ends where ", what, " should be"));
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error != std::errc()) fail(message("wanted ", what, ", got ", quoted(word)));
  return value;
}

std::int64_t Scanner::to_count(std::string_view word, const char* what) const {
  const std::int64_t value = to_integer(word, what);
  if (value < 0) fail(message("wanted ", what, ", got ", value));
  return value;
}

void Scanner::fail_at(Index line, const std::string& problem) {
  throw MeshError(message("line ", line, ": ", problem));
}

}  // namespace saddleback
