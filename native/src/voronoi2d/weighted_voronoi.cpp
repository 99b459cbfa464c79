// Leads from weighted sites to the numbered diagram: orders them, finds the cells, numbers what these share.

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "saddleback/error.h"
#include "saddleback/voronoi2d/voronoi_2d.h"

#include "support/threads/parallel.h"
#include "voronoi2d/sites/check_options.h"
#include "voronoi2d/sites/for_pieces.h"
#include "voronoi2d/sites/site_order.h"
#include "voronoi2d/voronoi_2d_cuda.h"
#include "voronoi2d/weighted/weighted_cells.h"
#include "voronoi2d/weighted/weighted_sites.h"

namespace saddleback {
namespace {

using namespace voronoi2d;

/// Numbers edges by the lower rank beside them, vertices by the lowest about them, then counter-clockwise. Cells in a
/// row, a piece, are read and counted first: where a piece's numbers begin follows from those before it.
class Numberer {
 public:
  Numberer(const WeightedCells& cells, const WeightedSites& sites, int threads, Voronoi2d& result,
           const JobStage& stage)
      : stage_(stage),
        cells_(cells),
        sites_(sites),
        threads_(threads),
        result_(result),
        pieces_((static_cast<std::size_t>(sites.count()) + k_piece - 1) / k_piece),
        edge_at_(cells.edge_place_count()),
        vertex_at_(cells.vertex_place_count()) {}

  void run() {
    const Index count = sites_.count();
    result_.cell_offsets.resize(static_cast<std::size_t>(count) + 1);
    make_room({6 * count, 2 * count, 3 * count});  // by Euler's formula
    for_pieces(stage_.part(0, 0.1), [&](Index i) { clear(i); });
    if (thread_count(threads_) == 1) {  // all at once while a piece is in the core's cache: lower cells have numbers
      for_pieces(stage_.part(0.1, 1), [&](Index i) {
        if (i > 0) pieces_[i].sides.swap(pieces_[i - 1].sides);
        read(i);
        start(i);
        number(i);
        write(i);
      });
    } else {
      for_pieces(stage_.part(0.1, 0.5), [&](Index i) { read(i); });
      for (std::size_t i = 0; i < pieces_.size(); ++i) start(static_cast<Index>(i));
      for_pieces(stage_.part(0.5, 0.8), [&](Index i) { number(i); });
      for_pieces(stage_.part(0.8, 1), [&](Index i) { write(i); });
    }
    result_.cell_offsets.back() = next_.sides;
    make_room(next_);
  }

 private:
  using Side = WeightedCells::Side;
  static constexpr Index k_piece = 1024;  ///< cells, whose sides stay in a core's cache
  struct Counts {
    Index sides = 0, vertices = 0, edges = 0;
  };
  struct alignas(k_apart) Piece {
    LargeArray<Side> sides{};  ///< of all its cells
    Counts own{}, first{};     ///< `own`: numbers given here
  };

  [[noreturn]] static void fail() { throw Error("voronoi_2d: the cells of weighted sites do not fit together"); }

  void make_room(const Counts& counts) {
    result_.corner_vertices.resize(counts.sides);
    result_.side_edges.resize(counts.sides);
    result_.vertices.resize(counts.vertices);
    result_.edges.resize(counts.edges);
    result_.edge_sites.resize(counts.edges);
  }

  template <class Work>
  void for_pieces(const JobStage& stage, Work&& work) {
    const Index count = static_cast<Index>(pieces_.size());
    parallel_for(count, threads_, 1, [&](Index i, int) {
      stage.update(i / static_cast<double>(count));
      work(i);
    });
    stage.update(1);
  }

  Index end_of(Index i) const { return std::min(sites_.count(), (i + 1) * k_piece); }
  bool is_own_vertex(Index cell, const Side& side) const {
    return side.vertex != k_none && cell < side.neighbor && cells_.lowest_about(side.vertex) == cell;
  }

  /// Calls visit(cell, sides) for a piece's cells.
  template <class Visit>
  void for_cells(Index i, Visit&& visit) const {
    const Piece& piece = pieces_[i];
    const std::span<const Side> sides = piece.sides;
    for (Index cell = i * k_piece; cell < end_of(i); ++cell) {
      const Index begin = result_.cell_offsets[cell] - piece.first.sides,
                  end = cell + 1 == end_of(i) ? static_cast<Index>(sides.size())
                                              : result_.cell_offsets[cell + 1] - piece.first.sides;
      visit(cell, sides.subspan(begin, end - begin));
    }
  }

  void clear(Index i) {
    for (LargeArray<Index>* const places : {&edge_at_, &vertex_at_}) {
      const std::size_t count = places->size(), pieces = pieces_.size();
      std::fill(places->begin() + count * i / pieces, places->begin() + count * (i + 1) / pieces, k_none);
    }
  }

  void read(Index i) {
    Piece& piece = pieces_[i];
    piece.sides.clear();
    piece.sides.reserve(8 * k_piece);
    for (Index cell = i * k_piece; cell < end_of(i); ++cell) {
      stage_.check();
      const std::size_t first = piece.sides.size();
      result_.cell_offsets[cell] = static_cast<Index>(first);
      cells_.read(cell, piece.sides);
      for (const Side& side : std::span(piece.sides).subspan(first)) {
        piece.own.vertices += static_cast<Index>(is_own_vertex(cell, side));
        piece.own.edges += static_cast<Index>(cell < side.neighbor);
      }
    }
    piece.own.sides = static_cast<Index>(piece.sides.size());
  }

  void start(Index i) {
    Piece& piece = pieces_[i];
    piece.first = next_;
    next_.sides += piece.own.sides, next_.vertices += piece.own.vertices, next_.edges += piece.own.edges;
    if (static_cast<std::size_t>(next_.sides) > result_.side_edges.size() ||
        static_cast<std::size_t>(next_.vertices) > result_.vertices.size() ||
        static_cast<std::size_t>(next_.edges) > result_.edges.size())
      fail();
  }

  void number(Index i) {
    const Piece& piece = pieces_[i];
    Index vertex = piece.first.vertices, edge = piece.first.edges;
    for (Index cell = i * k_piece; cell < end_of(i); ++cell) result_.cell_offsets[cell] += piece.first.sides;
    for_cells(i, [&](Index cell, std::span<const Side> sides) {
      for (const Side& side : sides) {
        if (is_own_vertex(cell, side)) {
          stage_.check();  // some vertices take microseconds
          result_.vertices[vertex] = cells_.position(side.vertex) / sites_.scale;
          give(vertex_at_[side.vertex], vertex++);
        }
        if (cell < side.neighbor) give(edge_at_[side.edge], edge++);
      }
    });
  }

  static void give(Index& place, Index number) {
    if (place != k_none) fail();
    place = number;
  }
  static Index given(Index number) {
    if (number == k_none) fail();
    return number;
  }

  void write(Index i) {
    Index edge = pieces_[i].first.edges;
    for_cells(i, [&](Index cell, std::span<const Side> sides) {
      const Index first = result_.cell_offsets[cell];
      const auto number_of = [&](const Side& side) {
        return side.vertex == k_none ? k_none : given(vertex_at_[side.vertex]);
      };
      Index before = sides.empty() ? k_none : number_of(sides.back());
      for (std::size_t k = 0; k < sides.size(); ++k) {
        const Index corner = number_of(sides[k]);
        result_.corner_vertices[first + k] = corner;
        result_.side_edges[first + k] = given(edge_at_[sides[k].edge]);
        if (cell < sides[k].neighbor)
          set_edge(edge++, before, corner, sites_.original[cell], sites_.original[sides[k].neighbor]);
        before = corner;
      }
    });
  }

  void set_edge(Index edge, Index from, Index to, Index left, Index right) {
    if (from == k_none) {
      std::swap(from, to);
      std::swap(left, right);
    }
    result_.edges[edge] = {from, to};
    result_.edge_sites[edge] = {left, right};
  }

  JobStage stage_;
  const WeightedCells& cells_;
  const WeightedSites& sites_;
  int threads_;
  Voronoi2d& result_;
  std::vector<Piece> pieces_;
  Counts next_;
  LargeArray<Index> edge_at_, vertex_at_;
};

/// Returns the diagram found on the device; none where it takes the processor, which then also says what is wrong.
std::optional<Voronoi2d> found_on_device(std::span<const Vec2> sites, std::span<const double> weights,
                                         const Voronoi2dOptions& options, const JobStage& stage) {
  constexpr std::size_t k_fewest = 3;
  constexpr double k_largest = 0x1p250;  // as coordinates that need no scale
  if (options.cuda_devices.empty() || sites.size() < k_fewest || weights.size() != sites.size() ||
      !std::all_of(weights.begin(), weights.end(), [](double weight) { return std::fabs(weight) < k_largest; }))
    return std::nullopt;
  std::optional<Voronoi2d> result = cuda_voronoi(sites, weights, options, stage);
  if (!result) return std::nullopt;
  result->weights.assign(weights.begin(), weights.end());
  for (std::size_t i = 0; i < sites.size(); ++i)
    if (result->cell_places[i] == k_none) result->hidden.push_back(static_cast<Index>(i));
  stage.update(1);
  return result;
}

bool all_equal(std::span<const double> weights) {
  return std::all_of(weights.begin(), weights.end(), [&](double weight) { return weight == weights[0]; });
}

}  // namespace

Voronoi2d voronoi_2d(std::span<const Vec2> sites, std::span<const double> weights, const Voronoi2dOptions& options,
                     Job* job) {
  return voronoi_2d(sites, weights, options, JobStage(job, "Weighted Voronoi diagram"));
}

Voronoi2d voronoi_2d(std::span<const Vec2> sites, std::span<const double> weights, const Voronoi2dOptions& options,
                     const JobStage& stage) {
  check_options(options, sites.size());
  if (weights.size() == sites.size() && all_equal(weights) && (weights.empty() || std::isfinite(weights[0])))
    return voronoi_2d(sites, options, stage);
  if (std::optional<Voronoi2d> found = found_on_device(sites, weights, options, stage)) return std::move(*found);
  WeightedSites ordered = order_weighted_sites(sites, weights, options.threads, stage.part(0, 0.2));
  constexpr Index k_good = 2000;  // few enough for a core's cache
  const Index tile_size = options.circles > 0 ? std::max<Index>(1, ordered.count() / options.circles) : k_good;
  Voronoi2d result;
  {
    const WeightedCells cells(ordered, tile_size, options.threads, stage.part(0.2, 0.9));
    Numberer(cells, ordered, options.threads, result, stage.part(0.9, 1)).run();
  }
  result.sites = copy_of(sites, options.threads, stage.part(0.99, 1));
  result.weights.assign(weights.begin(), weights.end());
  result.cell_places.resize(sites.size());
  for_pieces(sites.size(), options.threads, {}, [&](Index, std::size_t begin, std::size_t end) {
    std::fill(result.cell_places.begin() + begin, result.cell_places.begin() + end, k_none);
  });
  for_pieces(ordered.points.size(), options.threads, {}, [&](Index, std::size_t begin, std::size_t end) {
    for (std::size_t rank = begin; rank < end; ++rank)
      result.cell_places[ordered.original[rank]] = static_cast<Index>(rank);
  });
  for_pieces(sites.size(), options.threads, {}, [&](Index, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      if (const Index same = ordered.site_of[i]; same != static_cast<Index>(i))
        result.cell_places[i] = result.cell_places[same];
  });
  result.site_of = std::move(ordered.site_of);
  result.hidden = std::move(ordered.hidden);
  result.cell_sites = std::move(ordered.original);
  stage.update(1);
  return result;
}

}  // namespace saddleback
