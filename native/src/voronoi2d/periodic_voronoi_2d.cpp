// Copies of the sites lie around the box, as far out as the circles about its vertices reach. No site of a cell's
// neighbors, and none on the circle of one of its vertices, is more than a period away in either direction: its own
// copies keep each cell within half a period of its site. So at most all eight boxes around are needed.

#include "saddleback/voronoi2d/periodic_voronoi_2d.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "saddleback/error.h"
#include "saddleback/voronoi2d/power_diagram_2d.h"

#include "voronoi2d/sites/site_weights.h"

namespace saddleback {
namespace {

Shift operator+(const Shift& a, const Shift& b) { return {a[0] + b[0], a[1] + b[1]}; }
Shift operator-(const Shift& a, const Shift& b) { return {a[0] - b[0], a[1] - b[1]}; }

/// The box in a unit of which all coordinates of its own and of its neighbors' sites are multiples.
struct Box {
  Vec2 low, size;
  double unit;

  Box(const Vec2& from, const Vec2& to) {
    if (!from.allFinite() || !to.allFinite())
      throw InputError(
          message("box: wanted finite corners, got (", from.x(), ", ", from.y(), ") and (", to.x(), ", ", to.y(), ")"));
    if (!(to.x() > from.x() && to.y() > from.y()))
      throw InputError(message("box: wanted a lower left and an upper right corner, got (", from.x(), ", ", from.y(),
                               ") and (", to.x(), ", ", to.y(), ")"));
    const Vec2 reach = from.cwiseAbs().cwiseMax(to.cwiseAbs()) + (to - from);
    constexpr double k_largest = 1e60;
    if (!(reach.maxCoeff() <= k_largest)) throw InputError("box: wanted coordinates up to 1e60");
    unit = std::ldexp(1, std::ilogb(reach.maxCoeff()) - 51);
    low = rounded(from);
    size = rounded(to) - low;
    constexpr double k_least = 1024;  // units
    if (!(size.minCoeff() >= k_least * unit))
      throw InputError(message("box: it is ", size.x(), " by ", size.y(),
                               ", too thin for coordinates as large as its own, or for its other side"));
  }

  Vec2 rounded(const Vec2& place) const { return (place / unit).array().round() * unit; }
  /// Brings a place into the box; exact where it is there already.
  Vec2 wrapped(const Vec2& place) const {
    Vec2 result = place;
    for (int k = 0; k < 2; ++k) {
      if (place[k] >= low[k] && place[k] < low[k] + size[k]) continue;
      double within = std::fmod(place[k] - low[k], size[k]);
      if (within < 0) within += size[k];
      if (within >= size[k]) within = 0;
      result[k] = low[k] + within;
    }
    return result;
  }
  Vec2 site(const Vec2& place) const {
    Vec2 result = rounded(wrapped(place));
    for (int k = 0; k < 2; ++k)
      if (result[k] >= low[k] + size[k]) result[k] = low[k];
    return result;
  }
  Vec2 moved(const Vec2& place, const Shift& shift) const {
    return {place.x() + shift[0] * size.x(), place.y() + shift[1] * size.y()};
  }
};

/// The sites in the box, in their order, and copies as far as `margin` around it.
struct Copies {
  std::vector<Vec2> places;
  std::vector<Index> sites;
  std::vector<Shift> shifts;
  std::vector<double> weights;

  Copies(const Box& box, std::span<const Vec2> in_box, std::span<const double> given, const Vec2& margin) {
    const Vec2 low = box.low - margin, high = box.low + box.size + margin;
    for (const Shift shift : {Shift{0, 0}, Shift{-1, -1}, Shift{0, -1}, Shift{1, -1}, Shift{-1, 0}, Shift{1, 0},
                              Shift{-1, 1}, Shift{0, 1}, Shift{1, 1}}) {
      for (std::size_t i = 0; i < in_box.size(); ++i) {
        const Vec2 place = box.moved(in_box[i], shift);
        if ((place.array() < low.array()).any() || (place.array() > high.array()).any()) continue;
        places.push_back(place);
        sites.push_back(static_cast<Index>(i));
        shifts.push_back(shift);
        if (!given.empty()) weights.push_back(given[i]);
      }
    }
  }
};

/// Tells whether no site farther out than the margin can have a part in the cells of the box's sites: none is on or in
/// the circles about their vertices, nor nearer to a place in the box than its nearest site.
bool is_enough(const Box& box, const Voronoi2d& diagram, Index count, const Vec2& margin) {
  constexpr double k_slack = 1 + 1e-9;
  const double heaviest = diagram.powers.empty() ? 0 : *std::max_element(diagram.powers.begin(), diagram.powers.end());
  for (Index site = 0; site < count; ++site) {
    if (diagram.site_of[site] != site) continue;
    for (const Index vertex : diagram.cell_vertices(site)) {
      if (vertex == k_none) return false;
      const Vec2& center = diagram.vertices[vertex];
      const double power =
          (center - diagram.sites[site]).squaredNorm() - (diagram.powers.empty() ? 0 : diagram.powers[site]);
      const double reach = k_slack * std::sqrt(std::max(0.0, power + heaviest));
      for (int k = 0; k < 2; ++k) {
        if (margin[k] >= box.size[k]) continue;  // all copies that matter are there
        const double low = box.low[k] - margin[k], high = box.low[k] + box.size[k] + margin[k];
        if (!(center[k] - reach > low && center[k] + reach < high && reach < margin[k])) return false;
      }
    }
  }
  return true;
}

/// Numbers what the cells of the box's sites share, seen from cell to cell.
class Numberer {
 public:
  Numberer(const Box& box, const Copies& copies, PeriodicVoronoi2d& result, const JobStage& stage)
      : box_(box), copies_(copies), result_(result), stage_(stage) {}

  void run() {
    list_sides();
    find_twins();
    number_vertices();
    number_edges();
  }

 private:
  struct Side {
    Index cell, other;
    Shift shift;         ///< of the other site
    Index edge, vertex;  ///< of the diagram around: the side, and where it ends
  };

  Index before(Index side) const {
    const Index cell = sides_[side].cell;
    return side == result_.cell_offsets[cell] ? result_.cell_offsets[cell + 1] - 1 : side - 1;
  }

  void list_sides() {
    const Voronoi2d& around = result_.around;
    const Index count = static_cast<Index>(result_.sites.size());
    result_.cell_offsets.push_back(0);
    for (Index site = 0; site < count; ++site) {
      stage_.check();
      if (around.site_of[site] == site) {
        const std::span<const Index> edges = around.cell_edges(site), corners = around.cell_vertices(site);
        for (std::size_t k = 0; k < edges.size(); ++k) {
          const auto [left, right] = around.edge_sites[edges[k]];
          const Index copy = left == site ? right : left;
          sides_.push_back({site, copies_.sites[copy], copies_.shifts[copy], edges[k], corners[k]});
        }
      }
      result_.cell_offsets.push_back(static_cast<Index>(sides_.size()));
    }
  }

  /// Returns what a side is found by; its twin, seen from beyond, is the same with `from` and `to` exchanged.
  static std::array<Index, 4> key(Index from, Index to, const Shift& shift) { return {from, to, shift[0], shift[1]}; }

  // Of two sites in the box both see the same edge; one that sees a copy is seen as a copy.
  void find_twins() {
    twins_.assign(sides_.size(), k_none);
    std::vector<Index> seen(result_.around.edges.size(), k_none);
    std::vector<std::pair<std::array<Index, 4>, Index>> keys;
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      const Side& side = sides_[i];
      const Index number = static_cast<Index>(i);
      if (side.shift != Shift{0, 0}) {
        keys.emplace_back(key(side.cell, side.other, side.shift), number);
      } else if (seen[side.edge] == k_none) {
        seen[side.edge] = number;
      } else {
        twins_[number] = seen[side.edge];
        twins_[seen[side.edge]] = number;
      }
    }
    std::sort(keys.begin(), keys.end());
    for (const auto& [from, number] : keys) {
      stage_.check();
      const Side& side = sides_[number];
      const std::array<Index, 4> wanted = key(side.other, side.cell, Shift{0, 0} - side.shift);
      const auto found = std::lower_bound(keys.begin(), keys.end(), std::pair(wanted, Index{0}));
      if (found != keys.end() && found->first == wanted) twins_[number] = found->second;
    }
    if (std::find(twins_.begin(), twins_.end(), k_none) != twins_.end())
      throw Error("periodic_voronoi_2d: the cells do not fit together");
  }

  // The side's end is, seen from beyond it, where its twin begins; there the twin's cell goes on.
  void number_vertices() {
    const std::size_t count = sides_.size();
    result_.corner_vertices.assign(count, k_none);
    result_.corner_shifts.resize(count);
    std::vector<std::pair<Index, Shift>> about;
    for (std::size_t first = 0; first < count; ++first) {
      stage_.check();
      if (result_.corner_vertices[first] != k_none) continue;
      const Vec2& place = result_.around.vertices[sides_[first].vertex];
      Shift in_box;
      Vec2 within;
      for (int k = 0; k < 2; ++k) {
        in_box[k] = static_cast<Index>(std::floor((place[k] - box_.low[k]) / box_.size[k]));
        within[k] = std::max(box_.low[k], place[k] - in_box[k] * box_.size[k]);
        if (within[k] < box_.low[k] + box_.size[k]) continue;
        within[k] = box_.low[k];  // just below a side, to rounding
        ++in_box[k];
      }
      const Index vertex = static_cast<Index>(result_.vertices.size());
      result_.vertices.push_back(within);
      about.clear();
      Shift away{0, 0};
      Index corner = static_cast<Index>(first);
      do {
        result_.corner_vertices[corner] = vertex;
        result_.corner_shifts[corner] = in_box - away;
        about.emplace_back(sides_[corner].cell, away);
        away = away + sides_[corner].shift;
        corner = before(twins_[corner]);
      } while (corner != static_cast<Index>(first));
      for (std::size_t i = 1; i + 1 < about.size(); ++i) {
        result_.triangles.push_back({about[0].first, about[i].first, about[i + 1].first});
        result_.triangle_shifts.push_back({Shift{0, 0}, about[i].second, about[i + 1].second});
      }
    }
  }

  void number_edges() {
    result_.side_edges.assign(sides_.size(), k_none);
    for (std::size_t i = 0; i < sides_.size(); ++i) {
      if (result_.side_edges[i] != k_none) continue;
      const Index side = static_cast<Index>(i), from = before(side);
      result_.side_edges[side] = result_.side_edges[twins_[side]] = static_cast<Index>(result_.edges.size());
      result_.edges.push_back({result_.corner_vertices[from], result_.corner_vertices[side]});
      result_.edge_shifts.push_back(result_.corner_shifts[side] - result_.corner_shifts[from]);
      result_.edge_sites.push_back({sides_[side].cell, sides_[side].other});
      result_.edge_site_shifts.push_back(sides_[side].shift);
    }
  }

  const Box& box_;
  const Copies& copies_;
  PeriodicVoronoi2d& result_;
  JobStage stage_;
  std::vector<Side> sides_;
  std::vector<Index> twins_;
};

/// Calls visit(site, area, centroid) for the cells, in coordinates that count from their sites.
template <class Visit>
void for_cells(const PeriodicVoronoi2d& diagram, const Visit& visit) {
  const std::vector<Vec2> places = diagram.corner_places();
  for (std::size_t i = 0; i < diagram.sites.size(); ++i) {
    const Index begin = diagram.cell_offsets[i], end = diagram.cell_offsets[i + 1];
    if (begin == end) continue;
    double twice_area = 0;
    Vec2 moment(0, 0), last = places[end - 1] - diagram.sites[i];
    for (Index k = begin; k < end; ++k) {
      const Vec2 here = places[k] - diagram.sites[i];
      const double cross = last.x() * here.y() - last.y() * here.x();
      twice_area += cross;
      moment += cross * (last + here);
      last = here;
    }
    visit(i, std::max(0.0, 0.5 * twice_area), twice_area > 0 ? Vec2(moment / (3 * twice_area)) : Vec2(0, 0));
  }
}

}  // namespace

PeriodicVoronoi2d periodic_voronoi_2d(std::span<const Vec2> sites, const Vec2& low, const Vec2& high,
                                      std::span<const double> weights, int threads, Job* job) {
  if (sites.empty()) throw InputError("sites: wanted at least one site, got none");
  constexpr std::size_t k_most = 30'000'000;  // nine copies are counted in 32 bits
  if (sites.size() > k_most) throw InputError(message("sites: wanted up to ", k_most, ", got ", sites.size()));
  const Box box(low, high);
  if (!weights.empty()) voronoi2d::check_weights(sites, weights);
  const JobStage stage(job, "Periodic diagram");
  PeriodicVoronoi2d result;
  result.low = box.low;
  result.size = box.size;
  result.powers.assign(weights.begin(), weights.end());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    if (!sites[i].allFinite())
      throw InputError(message("sites: coordinates of site ", i, " are ", sites[i].x(), ", ", sites[i].y(),
                               ", wanted finite numbers"));
    result.sites.push_back(box.site(sites[i]));
  }
  const Index count = static_cast<Index>(sites.size());
  constexpr double k_spacings = 4;  // of even sites: their circles reach half as far
  double reach = k_spacings * std::sqrt(box.size.x() * box.size.y() / count);
  for (double part = 0;; part = 0.5 * (1 + part), reach *= 4) {
    const Vec2 margin = box.size.cwiseMin(Vec2::Constant(reach));
    Copies copies(box, result.sites, weights, margin);
    const JobStage find = stage.part(0.85 * part, 0.425 * (1 + part));
    result.around = weights.empty() ? voronoi_2d(copies.places, {.threads = threads}, find)
                                    : power_diagram_2d(copies.places, copies.weights, threads, find);
    if (margin != box.size && !is_enough(box, result.around, count, margin)) continue;
    Numberer(box, copies, result, stage).run();
    result.around_sites = std::move(copies.sites);
    break;
  }
  result.site_of.assign(result.around.site_of.begin(), result.around.site_of.begin() + count);
  for (const Index site : result.around.hidden)
    if (site < count) result.hidden.push_back(site);
  stage.update(1);
  return result;
}

std::vector<Vec2> PeriodicVoronoi2d::corner_places() const {
  std::vector<Vec2> result(corner_vertices.size());
  for (std::size_t k = 0; k < result.size(); ++k)
    result[k] = vertices[corner_vertices[k]] + Vec2(corner_shifts[k][0] * size.x(), corner_shifts[k][1] * size.y());
  return result;
}

std::vector<double> PeriodicVoronoi2d::areas() const {
  std::vector<double> result(sites.size(), 0);
  for_cells(*this, [&](std::size_t site, double area, const Vec2&) { result[site] = area; });
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = result[site_of[i]];
  return result;
}

std::vector<Vec2> PeriodicVoronoi2d::centroids() const {
  std::vector<Vec2> result(sites.size(), Vec2::Constant(std::numeric_limits<double>::quiet_NaN()));
  for_cells(*this, [&](std::size_t site, double, const Vec2& centroid) { result[site] = sites[site] + centroid; });
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = result[site_of[i]];
  return result;
}

std::vector<Index> PeriodicVoronoi2d::locate(std::span<const Vec2> points, int threads, Job* job) const {
  const Box box(low, low + size);
  std::vector<Vec2> within(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    within[i] = points[i].allFinite() ? box.wrapped(points[i]) : points[i];
  std::vector<Index> found = around.locate(within, threads, job);
  for (Index& site : found) site = around_sites[site];
  return found;
}

}  // namespace saddleback
