#include "saddleback/tessellation/bake_cells.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <numeric>

#include "saddleback/error.h"

#include "support/threads/parallel.h"
#include "tessellation/baking/margin.h"
#include "tessellation/baking/texels_of_cells.h"

namespace saddleback {
namespace {

constexpr Index k_most_texels = 16384, k_widest_margin = 1024;
constexpr std::size_t k_texels_at_once = std::size_t{1} << 24;
// A thread takes so many texels of a cell at a time, or as many as make it worth sending rays through the cell again.
constexpr std::size_t k_task = std::size_t{1} << 17, k_task_per_face = 16;
// Shares of the time.
constexpr double k_prepared = 0.05, k_drawn = 0.15, k_measured = 0.9;

void check(const Mesh& mesh, const GeodesicVoronoi& cells, const UvTriangles& given, const BakeOptions& options) {
  const auto wanted = [](const char* what, Index least, Index most, Index got) {
    if (got < least || got > most) throw InputError(message(what, ": wanted ", least, " to ", most, ", got ", got));
  };
  wanted("width", 1, k_most_texels, options.width);
  wanted("height", 1, k_most_texels, options.height);
  wanted("margin", 0, k_widest_margin, options.margin);
  if (given.faces.size() != given.uv.size())
    throw InputError(
        message("uv: wanted one triangle for each of the ", given.faces.size(), " faces, got ", given.uv.size()));
  if (given.channels < 0 || given.values.size() != 3 * given.faces.size() * given.channels)
    throw InputError(message("values: wanted ", given.channels, " for each of the ", 3 * given.faces.size(),
                             " corners, got ", given.values.size()));
  if (!options.axes.empty() && options.axes.size() != cells.sites.size())
    throw InputError(
        message("axes: wanted one for each of the ", cells.sites.size(), " sites, got ", options.axes.size()));
  if (static_cast<Index>(cells.face_cell.size()) != mesh.face_count())
    throw InputError(message("cells: wanted cells of the graph's mesh of ", mesh.face_count(), " faces, got ",
                             cells.face_cell.size()));
  for (std::size_t t = 0; t < given.faces.size(); ++t) {
    if (given.faces[t] < 0 || given.faces[t] >= mesh.face_count())
      throw InputError(message("faces: number ", t, " is ", given.faces[t], "; wanted 0 to ", mesh.face_count() - 1));
    for (const Vec2& corner : given.uv[t])
      if (!corner.allFinite()) throw InputError(message("uv: triangle ", t, " has a place that is not finite"));
  }
}

void refuse_overlaps(const BakedCells& baked) {
  if (baked.overlapping.empty()) return;
  throw InputError(message("uv: ", baked.overlapping.size(), " triangles overlap others, number ",
                           baked.overlapping.front(), " is the first; lay them side by side, or allow overlaps"));
}

/// Finds what the texels of some rows show, in tasks of texels of one cell.
class Baker {
 public:
  Baker(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, const UvTriangles& given,
        const BakeOptions& options, const UvRaster& raster, BakedCells& baked, const JobStage& stage)
      : graph_(graph),
        cells_(cells),
        given_(given),
        options_(options),
        raster_(raster),
        baked_(baked),
        borders_(graph.mesh(), cells, stage),
        reaches_(reaches_of(graph.mesh(), cells)),
        face_count_(cells.areas.size(), 0),
        measures_(thread_count(options.threads)) {
    for (const Index cell : cells.face_cell)
      if (cell != k_none) ++face_count_[cell];
    for (const GeodesicVoronoi::Piece& piece : cells.pieces) ++face_count_[piece.cell];
  }

  void bake(std::size_t begin, std::size_t end, const JobStage& stage) {
    sort_texels(begin, end, stage);
    struct Task {
      Index cell;
      std::size_t begin, end;
    };
    std::vector<Task> tasks;
    for (Index cell = 0; cell + 1 < static_cast<Index>(first_.size()); ++cell) {
      const std::size_t most = std::max(k_task, k_task_per_face * face_count_[cell]);
      for (std::size_t i = first_[cell]; i < first_[cell + 1]; i += most)
        tasks.push_back({cell, i, std::min(first_[cell + 1], i + most)});
    }
    std::atomic<std::size_t> done{0};
    parallel_for(static_cast<Index>(tasks.size()), options_.threads, 1, [&](Index i, int thread) {
      const Task& task = tasks[i];
      bake_task(task.cell, std::span(texels_).subspan(task.begin, task.end - task.begin), thread, stage);
      const std::size_t size = task.end - task.begin;
      stage.update(static_cast<double>(done.fetch_add(size, std::memory_order_relaxed) + size) /
                   static_cast<double>(texels_.size()));
    });
  }

 private:
  /// Texels by cell, and in each by rows.
  void sort_texels(std::size_t begin, std::size_t end, const JobStage& stage) {
    first_.assign(cells_.areas.size() + 1, 0);
    for (std::size_t texel = begin; texel < end; ++texel) {
      if (texel % k_task == 0) stage.check();
      if (baked_.cell[texel] != k_none) ++first_[baked_.cell[texel] + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    texels_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t texel = begin; texel < end; ++texel) {
      if (texel % k_task == 0) stage.check();
      if (baked_.cell[texel] != k_none) texels_[next[baked_.cell[texel]]++] = static_cast<Index>(texel);
    }
  }

  void bake_task(Index cell, std::span<const Index> texels, int thread, const JobStage& stage) {
    stage.check();
    CellTexels found;
    found.cell = cell;
    std::vector<std::pair<Index, Index>> by_triangle;
    by_triangle.reserve(texels.size());
    for (const Index texel : texels) by_triangle.emplace_back(baked_.triangle[texel], texel);
    std::ranges::sort(by_triangle, {},
                      [&](const auto& each) { return std::tuple(given_.faces[each.first], each.first, each.second); });
    for (std::size_t begin = 0, end = 0; begin < by_triangle.size(); begin = end) {
      const Index triangle = by_triangle[begin].first;
      stage.check();
      const UvPlace place(raster_.corners_of(triangle));
      for (; end < by_triangle.size() && by_triangle[end].first == triangle; ++end) {
        const Index texel = by_triangle[end].second;
        const Vec2 at(texel % options_.width, texel / options_.width);
        found.texels.push_back(texel);
        found.places.push_back({given_.faces[triangle], *place.barycentric(at)});
        interpolate(triangle, found.places.back().barycentric, texel);
      }
    }
    if (!options_.edge_distance && !options_.local_uv) return;
    auto& measure = measures_[thread];
    if (!measure) measure = std::make_unique<CellMeasure>(graph_, cells_, borders_, reaches_);
    if (options_.edge_distance) measure->find_edge_distances(found, baked_, stage);
    const Vec3* const axis = options_.axes.empty() ? nullptr : &options_.axes[cell];
    if (options_.local_uv) measure->find_local_uv(found, axis, baked_, stage);
  }

  void interpolate(Index triangle, const Vec3& weights, Index texel) {
    const auto channels = static_cast<std::size_t>(given_.channels);
    const double* const corners = given_.values.data() + 3 * channels * triangle;
    for (std::size_t k = 0; k < channels; ++k) {
      const double value =
          weights[0] * corners[k] + weights[1] * corners[channels + k] + weights[2] * corners[2 * channels + k];
      baked_.values[channels * texel + k] = static_cast<float>(value);
    }
  }

  const SaddleVertexGraph& graph_;
  const GeodesicVoronoi& cells_;
  const UvTriangles& given_;
  const BakeOptions& options_;
  const UvRaster& raster_;
  BakedCells& baked_;
  const CellBorders borders_;
  const std::vector<double> reaches_;
  std::vector<std::size_t> face_count_;  ///< of each cell
  std::vector<std::unique_ptr<CellMeasure>> measures_;
  LargeArray<Index> texels_;
  std::vector<std::size_t> first_;  ///< of each cell, in texels_
};

BakedCells empty_image(const UvTriangles& given, const BakeOptions& options) {
  BakedCells baked;
  baked.width = options.width;
  baked.height = options.height;
  baked.channels = given.channels;
  const std::size_t count = std::size_t(options.width) * options.height;
  baked.triangle.resize(count);
  baked.cell.resize(count);
  // Pages of zeros.
  if (options.edge_distance) baked.edge_distance.assign(count, 0);
  if (options.local_uv) baked.local_uv.assign(2 * count, 0);
  baked.values.assign(given.channels * count, 0);
  return baked;
}

void find_farthest(BakedCells& baked, std::size_t cell_count, const JobStage& stage) {
  baked.farthest.assign(cell_count, 0);
  for (std::size_t texel = 0; texel < baked.edge_distance.size(); ++texel) {
    if (texel % k_task == 0) stage.check();
    if (baked.cell[texel] == k_none || std::isinf(baked.edge_distance[texel])) continue;
    float& farthest = baked.farthest[baked.cell[texel]];
    farthest = std::max(farthest, baked.edge_distance[texel]);
  }
}

void add_margin(BakedCells& baked, const BakeOptions& options, const JobStage& stage) {
  const auto channels = static_cast<std::size_t>(baked.channels);
  const auto copy = [&](std::size_t to, std::size_t from) {
    baked.cell[to] = baked.cell[from];
    if (options.edge_distance) baked.edge_distance[to] = baked.edge_distance[from];
    if (options.local_uv) std::copy_n(&baked.local_uv[2 * from], 2, &baked.local_uv[2 * to]);
    if (channels) std::copy_n(&baked.values[channels * from], channels, &baked.values[channels * to]);
  };
  fill_margin(
      baked.width, baked.height, options.margin, options.threads,
      [&](std::size_t texel) { return baked.triangle[texel] != k_none; }, copy, stage);
}

}  // namespace

BakedCells bake_cells(const SaddleVertexGraph& graph, const GeodesicVoronoi& cells, const UvTriangles& triangles,
                      const BakeOptions& options, Job* job) {
  check(graph.mesh(), cells, triangles, options);
  const JobStage stage(job, "Baking");
  BakedCells baked = empty_image(triangles, options);
  UvRaster raster(graph.mesh(), cells, triangles, options, baked, stage);
  raster.draw(stage.part(k_prepared, k_drawn));
  if (!options.allow_overlaps) refuse_overlaps(baked);
  Baker baker(graph, cells, triangles, options, raster, baked, stage);
  const std::size_t count = baked.cell.size();
  const std::size_t rows = std::max<std::size_t>(1, k_texels_at_once / options.width) * options.width;
  const JobStage measuring = stage.part(k_drawn, k_measured);
  for (std::size_t begin = 0; begin < count; begin += rows) {
    const std::size_t end = std::min(count, begin + rows);
    const auto share = [&](std::size_t texel) { return static_cast<double>(texel) / static_cast<double>(count); };
    baker.bake(begin, end, measuring.part(share(begin), share(end)));
  }
  find_farthest(baked, cells.areas.size(), stage);
  add_margin(baked, options, stage.part(k_measured, 1));
  stage.update(1);
  return baked;
}

}  // namespace saddleback
