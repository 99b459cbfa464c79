#include "voronoi2d/clipping/raster_moments.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "saddleback/error.h"

#include "support/threads/parallel.h"

namespace saddleback::voronoi2d {

RasterIntegral::RasterIntegral(const PlanarDomain& domain, const DensityRaster& density, int power)
    : rows_(density.values.empty() ? 1 : density.rows), columns_(density.values.empty() ? 1 : density.columns) {
  const std::vector<Vec2>& outline = domain.loops()[0];
  Vec2 low = outline[0], high = low;
  for (const Vec2& corner : outline) {
    low = low.cwiseMin(corner);
    high = high.cwiseMax(corner);
  }
  middle_ = 0.5 * low + 0.5 * high;
  left_ = low.x() - middle_.x();
  bottom_ = low.y() - middle_.y();
  width_ = (high.x() - low.x()) / columns_;
  height_ = (high.y() - low.y()) / rows_;
  weights_.assign(static_cast<std::size_t>(rows_) * columns_, 1);
  const auto greatest = std::max_element(density.values.begin(), density.values.end());
  if (greatest != density.values.end() && *greatest > 0) exponent_ = std::ilogb(*greatest);
  std::transform(density.values.begin(), density.values.end(), weights_.begin(), [&](double d) {
    const double scaled = std::ldexp(d, -exponent_);
    return power == 1 ? scaled : scaled * scaled;
  });
  sums_.resize(weights_.size());
  for (Index row = 0; row < rows_; ++row)
    for (Index column = 1; column < columns_; ++column)
      sums_[static_cast<std::size_t>(row) * columns_ + column] = left_of(row, column - 1, line(column));
}

RasterIntegral::Sums RasterIntegral::left_of(Index row, Index column, double x) const {
  const std::size_t cell = static_cast<std::size_t>(row) * columns_ + column;
  const double weight = weights_[cell], begin = line(column), length = x - begin;
  Sums sums = sums_[cell];
  sums.zeroth += weight * length;
  sums.first += weight * length * (x + begin) / 2;
  sums.second += weight * length * (x * x + x * begin + begin * begin) / 3;
  return sums;
}

void RasterIntegral::add_piece(Index row, Index column, const Vec2& from, const Vec2& to,
                               RasterMoments& moments) const {
  const Vec2 between = 0.5 * (from + to);
  const double sixth = (to.y() - from.y()) / 6;
  for (const auto& [place, share] : {std::pair(&from, 1.0), std::pair(&between, 4.0), std::pair(&to, 1.0)}) {
    const Sums sums = left_of(row, column, place->x());
    const double weight = share * sixth, y = place->y();
    moments.mass += weight * sums.zeroth;
    moments.first += weight * Vec2(sums.first, y * sums.zeroth);
    moments.squared += weight * (sums.second + y * y * sums.zeroth);
  }
}

// From cell to cell of the raster. Places outside the box, by rounding, belong to the cells at its sides.
template <class Visit>
void RasterIntegral::for_pieces(const Vec2& from, const Vec2& to, const Visit& visit) const {
  const Vec2 step = to - from;
  const auto cell_at = [](double place, Index count) {
    return static_cast<Index>(std::clamp(std::floor(place), 0.0, static_cast<double>(count - 1)));
  };
  Index column = cell_at((from.x() - left_) / width_, columns_), row = cell_at((from.y() - bottom_) / height_, rows_);
  const auto share_to = [](double line, double begin, double length) { return (line - begin) / length; };
  constexpr double k_never = std::numeric_limits<double>::infinity();
  double share = 0;
  Vec2 here = from;
  while (share < 1) {
    double across_x = k_never, across_y = k_never;
    if (step.x() > 0 && column + 1 < columns_) across_x = share_to(line(column + 1), from.x(), step.x());
    if (step.x() < 0 && column > 0) across_x = share_to(line(column), from.x(), step.x());
    if (step.y() > 0 && row + 1 < rows_) across_y = share_to(bottom_ + (row + 1) * height_, from.y(), step.y());
    if (step.y() < 0 && row > 0) across_y = share_to(bottom_ + row * height_, from.y(), step.y());
    const double next = std::min({across_x, across_y, 1.0});
    if (next > share) {
      const Vec2 there = next < 1 ? Vec2(from + next * step) : to;
      visit(row, column, here, there);
      share = next;
      here = there;
    }
    if (next >= 1) break;
    if (across_x <= next) column += step.x() > 0 ? 1 : -1;
    if (across_y <= next) row += step.y() > 0 ? 1 : -1;
  }
}

RasterMoments RasterIntegral::along(std::span<const Vec2> loop) const {
  RasterMoments moments;
  Vec2 before = loop.back() - middle_;
  for (const Vec2& corner : loop) {
    const Vec2 here = corner - middle_;
    if (here.y() != before.y())
      for_pieces(before, here, [&](Index row, Index column, const Vec2& from, const Vec2& to) {
        add_piece(row, column, from, to, moments);
      });
    before = here;
  }
  return moments;
}

double RasterIntegral::mass_between(const Vec2& from, const Vec2& to) const {
  double mass = 0;
  for_pieces(from - middle_, to - middle_, [&](Index row, Index column, const Vec2& a, const Vec2& b) {
    mass += weights_[static_cast<std::size_t>(row) * columns_ + column] * (b - a).norm();
  });
  return mass;
}

std::vector<RasterMoments> moments_of(const ClippedCells& cells, Index count, const RasterIntegral& integral,
                                      int threads, const JobStage& stage) {
  const auto loop_count = static_cast<Index>(cells.loop_sites.size());
  std::vector<RasterMoments> of_loops(loop_count), result(count);
  parallel_for(loop_count, threads, 64, [&](Index loop, int) {
    stage.check();
    const Index begin = cells.loop_offsets[loop], end = cells.loop_offsets[loop + 1];
    of_loops[loop] = integral.along(std::span(cells.points).subspan(begin, end - begin));
  });
  for (Index loop = 0; loop < loop_count; ++loop) result[cells.loop_sites[loop]] += of_loops[loop];
  return result;
}

double energy_of(std::span<const Vec2> sites, std::span<const RasterMoments> cells, const RasterIntegral& integral) {
  double energy = 0;
  for (std::size_t i = 0; i < sites.size(); ++i) {
    const Vec2 site = sites[i] - integral.middle();
    energy += cells[i].squared - 2 * site.dot(cells[i].first) + site.squaredNorm() * cells[i].mass;
  }
  return energy;
}

void check_density(const DensityRaster& density) {
  if (density.values.empty()) return;
  const auto& values = density.values;
  if (density.rows < 1 || density.columns < 1 ||
      values.size() != static_cast<std::size_t>(density.rows) * density.columns)
    throw InputError(message("density: wanted ", density.rows, " rows of ", density.columns, " values, got ",
                             values.size(), " values"));
  const auto bad = std::find_if(values.begin(), values.end(), [](double d) { return !(d >= 0) || std::isinf(d); });
  if (bad == values.end()) return;
  const auto place = bad - values.begin();
  throw InputError(message("density: wanted finite values of 0 or more, got ", *bad, " in row ",
                           place / density.columns, ", column ", place % density.columns));
}

}  // namespace saddleback::voronoi2d
