#include <algorithm>
#include <cmath>

#include "saddleback/error.h"
#include "saddleback/shapes/shape.h"

#include "predicates/planar_loops.h"
#include "shapes/mask_outlines.h"
#include "shapes/simplify_outward.h"

namespace saddleback {
namespace {

/// Corners that add less than this many pixels go, however few there are.
constexpr double k_free_area = 0.1;
constexpr Index k_most_rows = 16'384;  // names of grid edges are 32 bits

/// Values come by the hundred million.
void check_values(const MaskImage& image, const JobStage& stage) {
  std::size_t inside = 0;
  for (Index row = 0; row < image.rows; ++row) {
    stage.update(static_cast<double>(row) / image.rows);
    const auto values = image.values.subspan(static_cast<std::size_t>(row) * image.columns, image.columns);
    const auto bad = std::find_if(values.begin(), values.end(), [](double v) { return !std::isfinite(v); });
    if (bad != values.end())
      throw InputError(message("image: value ", *bad, " at [", row, ", ", bad - values.begin(), "] is not finite"));
    inside += std::count_if(values.begin(), values.end(), [](double v) { return v >= 0.5; });
  }
  if (inside == 0)
    throw InputError("image: no clear mask, no pixel is over one half; raise those of the shape above it");
  if (inside == image.values.size())
    throw InputError("image: no clear mask, every pixel is over one half; lower those around the shape below it");
}

void check(const MaskImage& image, Index max_corners, const JobStage& stage) {
  if (image.rows < 1 || image.columns < 1 || image.rows > k_most_rows || image.columns > k_most_rows)
    throw InputError(
        message("image has ", image.rows, " x ", image.columns, " pixels, wanted 1 to ", k_most_rows, " either way"));
  if (image.values.size() != static_cast<std::size_t>(image.rows) * image.columns)
    throw InputError(message("image has ", image.values.size(), " values, wanted ", image.rows, " x ", image.columns));
  if (max_corners < 8) throw InputError(message("max_corners is ", max_corners, ", but must be at least 8"));
  check_values(image, stage);
}

InputError too_many(std::size_t loops, Index max_corners) {
  return InputError(message("image: no clear mask, it has ", loops, " parts and holes, for which ", max_corners,
                            " corners are too few; smooth the image or raise max_corners"));
}

/// Holes may be filled, but every outline keeps three corners.
void check_outlines(const std::vector<Shape::Loop>& loops, Index max_corners) {
  const auto outlines = std::count_if(loops.begin(), loops.end(),
                                      [](const Shape::Loop& loop) { return predicates::twice_area(loop) > 0; });
  if (3 * outlines > max_corners) throw too_many(loops.size(), max_corners);
}

}  // namespace

Shape shape_from_mask(const MaskImage& image, Index max_corners, bool centered, Job* job) {
  const JobStage stage(job, "Outlines");
  check(image, max_corners, stage.part(0, 0.1));
  std::vector<Shape::Loop> loops = distribution::mask_outlines(image, stage.part(0.1, 0.5));
  const std::size_t count = loops.size();
  check_outlines(loops, max_corners);
  distribution::simplify_outward(loops, max_corners, k_free_area, stage.part(0.5, 1));
  std::size_t corners = 0;
  for (const Shape::Loop& loop : loops) corners += loop.size();
  if (corners > static_cast<std::size_t>(max_corners)) throw too_many(count, max_corners);
  const Shape shape(distribution::parts_of(std::move(loops), stage));
  stage.update(1);  // and a last look whether to go on
  return centered ? shape.centered() : shape;
}

}  // namespace saddleback
