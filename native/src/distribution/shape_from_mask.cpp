#include <algorithm>
#include <cmath>

#include "saddleback/error.h"
#include "saddleback/shape.h"

#include "mask_outlines.h"
#include "simplify_outward.h"

namespace saddleback {
namespace {

/// Corners that add less than this many pixels go, however few there are.
constexpr double k_free_area = 0.1;
constexpr Index k_most_rows = 16'384;  // names of grid edges are 32 bits

void check(const MaskImage& image, Index max_corners) {
  if (image.rows < 1 || image.columns < 1 || image.rows > k_most_rows || image.columns > k_most_rows)
    throw InputError(
        message("image has ", image.rows, " x ", image.columns, " pixels, wanted 1 to ", k_most_rows, " either way"));
  if (image.values.size() != static_cast<std::size_t>(image.rows) * image.columns)
    throw InputError(message("image has ", image.values.size(), " values, wanted ", image.rows, " x ", image.columns));
  const auto bad = std::find_if(image.values.begin(), image.values.end(), [](double v) { return !std::isfinite(v); });
  if (bad != image.values.end()) {
    const auto at = static_cast<Index>(bad - image.values.begin());
    throw InputError(
        message("image: value ", *bad, " at [", at / image.columns, ", ", at % image.columns, "] is not finite"));
  }
  if (max_corners < 8) throw InputError(message("max_corners is ", max_corners, ", but must be at least 8"));
  const auto count = std::count_if(image.values.begin(), image.values.end(), [](double v) { return v >= 0.5; });
  if (count == 0) throw InputError("image: no clear mask, no pixel is over one half");
  if (static_cast<std::size_t>(count) == image.values.size())
    throw InputError("image: no clear mask, every pixel is over one half");
}

}  // namespace

Shape shape_from_mask(const MaskImage& image, Index max_corners, bool centred) {
  check(image, max_corners);
  std::vector<Shape::Loop> loops = distribution::mask_outlines(image);
  const std::size_t count = loops.size();
  distribution::simplify_outward(loops, max_corners, k_free_area);
  std::size_t corners = 0;
  for (const Shape::Loop& loop : loops) corners += loop.size();
  if (corners > static_cast<std::size_t>(max_corners))
    throw InputError(message("image: no clear mask, it has ", count, " parts and holes, for which ", max_corners,
                             " corners are too few"));
  const Shape shape(distribution::parts_of(std::move(loops)));
  return centred ? shape.centred() : shape;
}

}  // namespace saddleback
