// Four pixel centers make a cell. Its corners and edges are counted counter-clockwise from the lower left one. An
// outline enters a cell over an edge that leads out of the mask and leaves over one that leads back in.

#include "shapes/mask_outlines.h"

#include <algorithm>
#include <cstdint>

#include "predicates/planar_loops.h"

namespace saddleback::distribution {
namespace {

constexpr double k_half = 0.5;
/// Outlines keep this far from pixel centers, in pixels, so that no two meet there.
constexpr double k_clear = 0.02;

class Tracer {
 public:
  explicit Tracer(const MaskImage& image) : image_(image), columns_(image.columns + 2) {}

  std::vector<Shape::Loop> run(const JobStage& stage) {
    const double rows = image_.rows + 2;
    const JobStage marching = stage.part(0, 0.7), following = stage.part(0.7, 1);
    const std::size_t row_edges = 2 * static_cast<std::size_t>(columns_);
    following_.reserve(row_edges * (image_.rows + 2));
    for (Index row = 0; row < image_.rows + 2; ++row) {
      stage.check();
      following_.insert(following_.end(), row_edges, k_none);
    }
    for (Index row = -1; row < image_.rows; ++row) {
      marching.update((row + 1) / rows);
      for (Index column = -1; column < image_.columns; ++column) march(row, column);
    }
    std::vector<Shape::Loop> loops;
    for (Index edge = 0; edge < static_cast<Index>(following_.size()); ++edge) {
      if (edge % (2 * columns_) == 0) following.update(static_cast<double>(edge) / (2.0 * columns_ * rows));
      if (following_[edge] != k_none) loops.push_back(follow(edge, stage));
    }
    return loops;
  }

 private:
  double value(Index row, Index column) const {
    if (row < 0 || column < 0 || row >= image_.rows || column >= image_.columns) return 0;
    return image_.values[static_cast<std::size_t>(row) * image_.columns + column];
  }

  /// Edges of the grid are named by their upper or left end: even ones lead right, odd ones down.
  Index edge_name(Index row, Index column, bool down) const {
    return 2 * ((row + 1) * columns_ + column + 1) + (down ? 1 : 0);
  }

  /// The cell whose upper left pixel is (row, column).
  void march(Index row, Index column) {
    const double corner[4] = {value(row + 1, column), value(row + 1, column + 1), value(row, column + 1),
                              value(row, column)};
    const Index edge[4] = {edge_name(row + 1, column, false), edge_name(row, column + 1, true),
                           edge_name(row, column, false), edge_name(row, column, true)};
    const bool is_joined = corner[0] + corner[1] + corner[2] + corner[3] >= 4 * k_half;
    for (int i = 0; i < 4; ++i) {
      if (!(corner[i] >= k_half) || corner[(i + 1) % 4] >= k_half) continue;
      // From the edge that leads out to one that leads in; of two, the nearer one about what is kept apart.
      int back = i;
      do back = (back + (is_joined ? 1 : 3)) % 4;
      while (corner[back] >= k_half || !(corner[(back + 1) % 4] >= k_half));
      following_[edge[i]] = edge[back];
    }
  }

  Vec2 place_on(Index edge) const {
    const bool down = edge % 2 == 1;
    const Index row = edge / 2 / columns_ - 1, column = edge / 2 % columns_ - 1;
    const double a = value(row, column), b = down ? value(row + 1, column) : value(row, column + 1);
    const double share = std::clamp((k_half - a) / (b - a), k_clear, 1 - k_clear);
    return down ? Vec2(column, -(row + share)) : Vec2(column + share, -row);
  }

  Shape::Loop follow(Index first, const JobStage& stage) {
    Shape::Loop loop;
    for (Index edge = first; following_[edge] != k_none;) {
      if (loop.size() % 4096 == 0) stage.check();
      loop.push_back(place_on(edge));
      const Index next = following_[edge];
      following_[edge] = k_none;
      edge = next;
    }
    return loop;
  }

  const MaskImage& image_;
  const Index columns_;
  std::vector<Index> following_;  ///< per edge of the grid that an outline crosses, the next one
};

}  // namespace

std::vector<Shape::Loop> mask_outlines(const MaskImage& image, const JobStage& stage) {
  return Tracer(image).run(stage);
}

std::vector<Shape::Part> parts_of(std::vector<Shape::Loop> loops, const JobStage& stage) {
  std::vector<Shape::Loop> outlines;
  std::vector<double> areas;
  std::vector<Shape::Loop> holes;
  for (Shape::Loop& loop : loops) (predicates::twice_area(loop) > 0 ? outlines : holes).push_back(std::move(loop));
  std::vector<Shape::Part> parts;
  for (Shape::Loop& outline : outlines) {
    areas.push_back(predicates::twice_area(outline));
    parts.push_back({std::move(outline)});
  }
  for (Shape::Loop& hole : holes) {
    stage.check();
    std::size_t best = parts.size();
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (predicates::is_inside(parts[i][0], hole[0]) && (best == parts.size() || areas[i] < areas[best])) best = i;
    parts[best].push_back(std::move(hole));
  }
  return parts;
}

}  // namespace saddleback::distribution
