#include "mesh/read_format.h"

#include <charconv>
#include <limits>

#include "saddleback/error.h"

namespace saddleback {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

}  // namespace

std::string quoted(std::string_view word) {
  constexpr std::size_t k_shown = 20;
  std::string text;
  for (const char c : word.substr(0, k_shown)) text += c >= ' ' && c <= '~' ? c : '?';
  return "\"" + text + (word.size() > k_shown ? "...\"" : "\"");
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

namespace {

// The first corner from which no triangle of the fan folds over, seen along the polygon's mean normal (Newell): any
// corner of a convex polygon, the reflex one of a concave quad. 0 where there is none or the polygon is very large.
std::size_t fan_apex(std::span<const Index> corners, std::span<const double> xyz) {
  constexpr std::size_t k_largest = 64;  // trying all corners is quadratic
  const std::size_t n = corners.size();
  if (n == 3 || n > k_largest) return 0;
  std::vector<Vec3> points;
  for (const Index v : corners) {
    if (v < 0 || 3 * static_cast<std::size_t>(v) >= xyz.size()) return 0;
    points.emplace_back(xyz[3 * v], xyz[3 * v + 1], xyz[3 * v + 2]);
  }
  Vec3 normal = Vec3::Zero();
  for (std::size_t i = 1; i + 1 < n; ++i) normal += (points[i] - points[0]).cross(points[i + 1] - points[0]);
  for (std::size_t apex = 0; apex < n; ++apex) {
    bool folds = false;
    for (std::size_t i = 1; i + 1 < n && !folds; ++i) {
      const Vec3 &a = points[apex], &b = points[(apex + i) % n], &c = points[(apex + i + 1) % n];
      folds = !((b - a).cross(c - a).dot(normal) > 0);
    }
    if (!folds) return apex;
  }
  return 0;
}

}  // namespace

MeshArrays PolygonSoup::triangulate() && {
  MeshArrays result;
  for (std::size_t p = 0; p + 1 < begins_.size(); ++p) {
    const auto corners = std::span<const Index>(corners_).subspan(begins_[p], begins_[p + 1] - begins_[p]);
    const std::size_t n = corners.size(), apex = fan_apex(corners, xyz_);
    for (std::size_t i = 1; i + 1 < n; ++i)
      result.triangles.insert(result.triangles.end(),
                              {corners[apex], corners[(apex + i) % n], corners[(apex + i + 1) % n]});
  }
  result.xyz = std::move(xyz_);
  return result;
}

// False at the end of the text or, within a line, of the line.
bool Scanner::skip_blanks(bool over_lines) {
  while (at_ < text_.size()) {
    const char c = text_[at_];
    if (comment_ && c == comment_) {
      while (at_ < text_.size() && text_[at_] != '\n') ++at_;
    } else if (c == '\n') {
      if (!over_lines) return false;
      ++line_;
      ++at_;
    } else if (is_blank(c)) {
      ++at_;
    } else {
      return true;
    }
  }
  return false;
}

std::string_view Scanner::word() { return skip_blanks(true) ? word_in_line() : std::string_view(); }

std::string_view Scanner::word_in_line() {
  if (!skip_blanks(false)) return {};
  const std::size_t begin = at_;
  while (at_ < text_.size() && !is_blank(text_[at_]) && text_[at_] != '\n') ++at_;
  return text_.substr(begin, at_ - begin);
}

void Scanner::skip_line() {
  while (at_ < text_.size() && text_[at_] != '\n') ++at_;
  if (at_ < text_.size()) {
    ++line_;
    ++at_;
  }
}

double Scanner::real(const char* what) { return to_real(word(), what); }

std::int64_t Scanner::integer(const char* what) { return to_integer(word(), what); }

double Scanner::to_real(std::string_view word, const char* what) const {
  if (word.empty()) fail(message("the text ends where ", what, " should be"));
  if (word.size() > 1 && word[0] == '+' && word[1] != '-') word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
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
  if (word.empty()) fail(message("the text ends where ", what, " should be"));
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error != std::errc()) fail(message("wanted ", what, ", got ", quoted(word)));
  return value;
}

void Scanner::fail(const std::string& problem) const { throw MeshError(message("line ", line_, ": ", problem)); }

Index to_index(std::int64_t value) {
  return value >= 0 && value <= std::numeric_limits<Index>::max() ? static_cast<Index>(value) : k_none;
}

}  // namespace saddleback
