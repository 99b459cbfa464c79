#include "voronoi2d/diagram/cell_block.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstring>
#include <limits>

#include "voronoi2d/sweep/planar_mesh.h"

namespace saddleback::voronoi2d {

CellBlock::CellBlock() : few_half_(k_few * (k_most + 2)), few_neighbor_(k_few * (k_most + 2)) {
  make_room(k_few * (k_most + 2), {});
}

void CellBlock::gather(const Triangulation& mesh, const Index* leaving, Index begin, Index count,
                       const JobStage& stage) {
  cell_count = count;
  size = 0;
  open.clear();
  for (Index cell = 0; cell < count; cell += k_together) {
    const Index end = std::min(count, cell + k_together);
    if (end - cell == k_together && gather_few<k_together>(mesh, leaving + cell, cell)) continue;
    for (Index one = cell; one < end; ++one) gather_few<1>(mesh, leaving + one, one);
  }
  for (Index cell = 0; cell < count; ++cell) {
    starts[cell] = size;
    if (few_size_[cell] > 0) {
      append_few(cell, begin + cell);
      continue;
    }
    lowest[cell] = k_none;
    const bool is_open = gather_any(mesh, leaving[cell], stage);
    if (is_open) open.push_back(cell);
    make_room(static_cast<Index>(any_half_.size()) + k_few * (count - cell + 1), stage);
    append_any(begin + cell, is_open, stage);
  }
  starts[count] = size;
}

void CellBlock::make_room(Index more, const JobStage& stage) {
  const std::size_t wanted = size + more;
  if (wanted <= halves.size()) return;
  for (std::vector<Index>* values : {&halves, &sites, &neighbors, &next_neighbors}) {
    stage.check();
    values->resize(2 * wanted);
  }
}

namespace {

// From a half-edge to the next and to the previous one of its triangle, by its place there.
constexpr std::ptrdiff_t k_next[4] = {1, 1, -2, 0}, k_previous[4] = {2, -1, -1, 0};

/// The twin of a half-edge that ends at the cell's site. At the border another thread may be giving it a number that is
/// negative as well, see Numberer::write_sides.
Index twin_of(const Index& there) { return std::atomic_ref(const_cast<Index&>(there)).load(std::memory_order_relaxed); }

}  // namespace

// Always as many steps, since when a walk ends cannot be predicted: what comes after is the same once more. Each step
// waits for the one before: the walks about several sites do so together.
template <Index Together>
bool CellBlock::gather_few(const Triangulation& mesh, const Index* leaving, Index cell) {
  const Index *const corners = mesh.corners.data(), *const twins = mesh.twins.data();
  std::ptrdiff_t walk[Together], count[Together], is_under_way[Together], least[Together];
  Index flags[Together];
  for (Index i = 0; i < Together; ++i) {
    walk[i] = leaving[i];
    count[i] = 0;
    is_under_way[i] = 1;
    least[i] = std::numeric_limits<std::ptrdiff_t>::max();
    flags[i] = 0;
  }
  Index *const walked = few_half_.data() + k_few * cell, *const others = few_neighbor_.data() + k_few * cell;
#ifdef __GNUC__
#pragma GCC unroll 8
#endif
  for (std::ptrdiff_t step = 0; step < k_few; ++step) {
    Index ends = 0;
#ifdef __GNUC__
#pragma GCC unroll 4
#endif
    for (Index i = 0; i < Together; ++i) {
      const std::ptrdiff_t k = walk[i] & 3, other = corners[walk[i] + k_next[k]];
      walked[k_few * i + step] = static_cast<Index>(walk[i]);
      others[k_few * i + step] = static_cast<Index>(other);
      least[i] = std::min(least[i], k_few * other + step);
      flags[i] |= twins[walk[i] | 3];
      count[i] += is_under_way[i];
      const Index twin = twin_of(twins[walk[i] + k_previous[k]]);
      ends |= twin;
      walk[i] = std::max(twin, 0);
      is_under_way[i] &= static_cast<std::ptrdiff_t>(twin != leaving[i]);
    }
    if (ends < 0) {  // of the border
      std::fill_n(few_size_.begin() + cell, Together, 0);
      return false;
    }
  }
  for (Index i = 0; i < Together; ++i) {
    few_size_[cell + i] = is_under_way[i] != 0 ? 0 : static_cast<Index>(count[i]);
    if (is_under_way[i] != 0) continue;
    few_lowest_[cell + i] = static_cast<Index>(least[i] % k_few);
    lowest[cell + i] = flags[i] == 0 ? static_cast<Index>(least[i] / k_few) : k_none;
    if (flags[i] != 0) gather_few_flat(mesh, leaving[i], cell + i);
  }
  return true;
}

/// Does the same where some triangles share their circle.
void CellBlock::gather_few_flat(const Triangulation& mesh, Index first, Index cell) {
  const Index *const corners = mesh.corners.data(), *const twins = mesh.twins.data();
  Index *const walked = few_half_.data() + k_few * cell, *const others = few_neighbor_.data() + k_few * cell;
  Index walk = first, found = 0, least = 0, lowest_neighbor = std::numeric_limits<Index>::max();
  Index is_under_way = 1;
  for (Index step = 0; step < k_few; ++step) {
    const Index k = walk & 3, other = corners[walk + k_next[k]];
    const Index is_side = is_under_way & ~(twins[walk | 3] >> k);
    walked[found] = walk;
    others[found] = other;
    const bool is_lowest = (is_side != 0) & (other < lowest_neighbor);
    least = is_lowest ? found : least;
    lowest_neighbor = is_lowest ? other : lowest_neighbor;
    found += is_side;
    walk = twins[walk + k_previous[k]];
    is_under_way &= static_cast<Index>(walk != first);
  }
  few_size_[cell] = found;
  few_lowest_[cell] = least;
}

/// Tells whether the cell is open.
bool CellBlock::gather_any(const Triangulation& mesh, Index first, const JobStage& stage) {
  any_half_.clear();
  any_neighbor_.clear();
  any_lowest_ = 0;
  const auto add = [&](Index half, Index neighbor) {
    any_half_.push_back(half);
    any_neighbor_.push_back(neighbor);
  };
  Index half = first;
  do {
    stage.check();
    const Index last = previous_half(half), neighbor = mesh.corners[next_half(half)];
    if ((mesh.twins[half | 3] >> (half & 3) & 1) == 0) {
      add(half, neighbor);
      if (neighbor < any_neighbor_[any_lowest_]) any_lowest_ = static_cast<Index>(any_half_.size()) - 1;
    }
    half = twin_of(mesh.twins[last]);
    if (half < 0) {
      add(last, mesh.corners[last]);
      any_lowest_ = 0;
      return true;
    }
  } while (half != first);
  return false;
}

namespace {

/// Copies eight at a time, whatever the size of the rest is: what lies behind it is written later.
void copy_few(Index* to, const Index* from) { std::memcpy(to, from, 8 * sizeof(Index)); }

}  // namespace

// From the lowest on, then from the first on over what that copied too much.
void CellBlock::append_few(Index cell, Index cell_site) {
  const Index count = few_size_[cell], least = few_lowest_[cell], turned = count - least, start = size;
  const Index *const walked = few_half_.data() + k_few * cell, *const others = few_neighbor_.data() + k_few * cell;
  copy_few(halves.data() + start, walked + least);
  copy_few(halves.data() + start + turned, walked);
  copy_few(neighbors.data() + start, others + least);
  copy_few(neighbors.data() + start + turned, others);
  Index* const next = next_neighbors.data() + start;
  copy_few(next, others + least + 1);
  copy_few(next + turned - 1, others);
  next[count - 1] = others[least];
  std::fill_n(sites.data() + start, k_few, cell_site);
  size = start + count;
}

void CellBlock::append_any(Index cell_site, bool is_open, const JobStage& stage) {
  const Index count = static_cast<Index>(any_half_.size()), start = size;
  Index from = any_lowest_;
  for_sides(0, count, stage, [&](Index i) {
    halves[start + i] = any_half_[from];
    neighbors[start + i] = any_neighbor_[from];
    from = from + 1 == count ? 0 : from + 1;
    next_neighbors[start + i] = any_neighbor_[from];
    sites[start + i] = cell_site;
  });
  if (is_open) next_neighbors[start + count - 1] = k_none;
  size = start + count;
}

}  // namespace saddleback::voronoi2d
