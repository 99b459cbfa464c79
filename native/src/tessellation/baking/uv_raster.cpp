#include "tessellation/baking/uv_raster.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "support/planar.h"
#include "support/threads/parallel.h"

namespace saddleback {
namespace {

constexpr Index k_band = 32;  ///< rows that a thread draws at a time
// Texels. UV places come as float32, of which one step is 0.001 texels at most; triangles that overlap by less touch.
constexpr double k_touching = 0.01;
// Of the square of the longest edge: less area than this is rounding.
constexpr double k_no_area = 1e-12;

/// Returns where the edge crosses the middle of a row, the same from both its sides; none where it does not. The upper
/// end of an edge belongs to the next one.
std::optional<double> crossing(Vec2 a, Vec2 b, double y) {
  if (std::pair(b.y(), b.x()) < std::pair(a.y(), a.x())) std::swap(a, b);
  if (y < a.y() || y >= b.y()) return std::nullopt;
  return a.x() + (y - a.y()) * ((b.x() - a.x()) / (b.y() - a.y()));
}

Index first_at(double x, Index least, Index most) {
  return static_cast<Index>(std::ceil(std::clamp(x, static_cast<double>(least), static_cast<double>(most))));
}

/// Calls `visit(y, x0, x1)` with the texels [x0, x1) of each row whose centers a convex polygon holds.
template <class Visit>
void for_each_row(std::span<const Vec2> polygon, Index begin, Index end, Index width, Visit&& visit) {
  double lowest = polygon[0].y(), highest = lowest;
  for (const Vec2& corner : polygon) lowest = std::min(lowest, corner.y()), highest = std::max(highest, corner.y());
  const Index first = first_at(lowest, begin, end), last = first_at(highest, begin, end);
  for (Index y = first; y < last; ++y) {
    double left = std::numeric_limits<double>::infinity(), right = -left;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const auto x = crossing(polygon[i], polygon[(i + 1) % polygon.size()], y);
      if (x) left = std::min(left, *x), right = std::max(right, *x);
    }
    if (left >= right) continue;
    const Index x0 = first_at(left, 0, width), x1 = first_at(right, 0, width);
    if (x0 < x1) visit(y, x0, x1);
  }
}

}  // namespace

UvPlace::UvPlace(const std::array<Vec2, 3>& corners) : corners_(corners) {
  double longest = 0;
  for (int i = 0; i < 3; ++i) longest = std::max(longest, (corners[(i + 1) % 3] - corners[i]).squaredNorm());
  const double doubled = cross(corners[1] - corners[0], corners[2] - corners[0]);
  if (std::abs(doubled) > k_no_area * longest) inverse_ = 1 / doubled;
}

std::optional<Vec3> UvPlace::barycentric(const Vec2& place) const {
  if (!has_area()) return std::nullopt;
  const double b = cross(place - corners_[0], corners_[2] - corners_[0]) * inverse_;
  const double c = cross(corners_[1] - corners_[0], place - corners_[0]) * inverse_;
  return normalized_barycentric(Vec3(1 - b - c, b, c));
}

double UvPlace::depth(const Vec2& place) const {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const Vec2 side = corners_[(i + 1) % 3] - corners_[i];
    least = std::min(least, std::abs(cross(side, place - corners_[i])) / side.norm());
  }
  return least;
}

UvRaster::UvRaster(const Mesh& mesh, const GeodesicVoronoi& cells, const UvTriangles& triangles,
                   const BakeOptions& options, BakedCells& baked, const JobStage& stage)
    : mesh_(mesh),
      cells_(cells),
      triangles_(triangles),
      options_(options),
      baked_(baked),
      bands_((options.height + k_band - 1) / k_band),
      first_piece_(mesh.face_count(), k_none) {
  for (auto i = static_cast<Index>(cells.pieces.size()) - 1; i >= 0; --i) first_piece_[cells.pieces[i].face] = i;
  const auto count = static_cast<Index>(triangles.faces.size());
  for (Index t = 0; t < count; ++t) {
    if (t % 1024 == 0) stage.check();
    const std::array<Vec2, 3> corners = corners_of(t);
    const auto [low_x, high_x] = std::minmax({corners[0].x(), corners[1].x(), corners[2].x()});
    const auto [low_y, high_y] = std::minmax({corners[0].y(), corners[1].y(), corners[2].y()});
    if (high_x < -0.5 || low_x > options.width - 0.5 || high_y < -0.5 || low_y > options.height - 0.5) {
      baked.outside.push_back(t);
      continue;
    }
    if (!UvPlace(corners).has_area()) {
      baked.without_area.push_back(t);
      continue;
    }
    const Index first = first_at(low_y, 0, options.height), last = first_at(high_y, 0, options.height);
    for (Index band = first / k_band; first < last && band <= (last - 1) / k_band; ++band) bands_[band].push_back(t);
  }
}

std::array<Vec2, 3> UvRaster::corners_of(Index triangle) const {
  const Vec2 size(options_.width, options_.height), begin(options_.tile_u, options_.tile_v);
  std::array<Vec2, 3> corners;
  for (int i = 0; i < 3; ++i) corners[i] = (triangles_.uv[triangle][i] - begin).cwiseProduct(size) - Vec2(0.5, 0.5);
  return corners;
}

void UvRaster::draw(const JobStage& stage) {
  std::vector<std::vector<Index>> overlapping(bands_.size());
  std::atomic<Index> done{0};
  parallel_for(static_cast<Index>(bands_.size()), options_.threads, 1, [&](Index band, int) {
    stage.check();
    draw_band(band, overlapping[band]);
    stage.update(static_cast<double>(done.fetch_add(1, std::memory_order_relaxed) + 1) /
                 static_cast<double>(bands_.size()));
  });
  for (const auto& found : overlapping) baked_.overlapping.insert(baked_.overlapping.end(), found.begin(), found.end());
  std::ranges::sort(baked_.overlapping);
  baked_.overlapping.erase(std::unique(baked_.overlapping.begin(), baked_.overlapping.end()), baked_.overlapping.end());
}

void UvRaster::draw_band(Index band, std::vector<Index>& overlapping) {
  const Index width = options_.width;
  const Rows rows{band * k_band, std::min(options_.height, (band + 1) * k_band)};
  std::fill(&baked_.triangle[0] + std::size_t(rows.begin) * width, &baked_.triangle[0] + std::size_t(rows.end) * width,
            k_none);
  std::fill(&baked_.cell[0] + std::size_t(rows.begin) * width, &baked_.cell[0] + std::size_t(rows.end) * width, k_none);
  for (const Index t : bands_[band]) {
    const std::array<Vec2, 3> corners = corners_of(t);
    const UvPlace place(corners);
    const Index cell = cells_.face_cell[triangles_.faces[t]];
    const auto overlaps = [&](Index other, const Vec2& at) {
      if (place.depth(at) < k_touching || UvPlace(corners_of(other)).depth(at) < k_touching) return;
      if (overlapping.empty() || overlapping.back() != t) overlapping.push_back(t);
      overlapping.push_back(other);
      overlapping.push_back(t);
    };
    for_each_row(corners, rows.begin, rows.end, width, [&](Index y, Index x0, Index x1) {
      for (Index x = x0; x < x1; ++x) {
        const std::size_t texel = std::size_t(y) * width + x;
        if (baked_.triangle[texel] != k_none) {
          if (baked_.triangle[texel] != t) overlaps(baked_.triangle[texel], Vec2(x, y));
          continue;
        }
        baked_.triangle[texel] = t;
        baked_.cell[texel] = cell;
      }
    });
    if (cell == k_none) {
      draw_pieces(t, rows);
      find_left_over(t, rows);
    }
  }
}

/// The parts of a face by their cells.
void UvRaster::draw_pieces(Index triangle, Rows rows) {
  const Index face = triangles_.faces[triangle], width = options_.width;
  if (first_piece_[face] == k_none) return;
  const std::array<Vec2, 3> corners = corners_of(triangle);
  std::vector<Vec2> polygon;
  for (auto i = static_cast<std::size_t>(first_piece_[face]); i < cells_.pieces.size(); ++i) {
    const GeodesicVoronoi::Piece& piece = cells_.pieces[i];
    if (piece.face != face) break;
    polygon.clear();
    for (Index k = piece.first; k < piece.first + piece.count; ++k) {
      const Vec3& weights = cells_.piece_barycentric[k];
      polygon.emplace_back(weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2]);
    }
    for_each_row(polygon, rows.begin, rows.end, width, [&](Index y, Index x0, Index x1) {
      for (Index x = x0; x < x1; ++x) {
        const std::size_t texel = std::size_t(y) * width + x;
        if (baked_.triangle[texel] == triangle && baked_.cell[texel] == k_none) baked_.cell[texel] = piece.cell;
      }
    });
  }
}

/// Centers on the face's border, that rounding puts into no part of it.
void UvRaster::find_left_over(Index triangle, Rows rows) {
  const std::array<Vec2, 3> corners = corners_of(triangle);
  const UvPlace place(corners);
  for_each_row(corners, rows.begin, rows.end, options_.width, [&](Index y, Index x0, Index x1) {
    for (Index x = x0; x < x1; ++x) {
      const std::size_t texel = std::size_t(y) * options_.width + x;
      if (baked_.triangle[texel] != triangle || baked_.cell[texel] != k_none) continue;
      baked_.cell[texel] = cells_.cell_at(mesh_, {triangles_.faces[triangle], *place.barycentric(Vec2(x, y))});
    }
  });
}

}  // namespace saddleback
