#include "voronoi2d/half_edges.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "saddleback/error.h"

namespace saddleback::voronoi2d {
namespace {

// A half-edge that leaves each site, at the border the first one counter-clockwise.
std::vector<Index> leaving(const PlanarMesh& mesh) {
  std::vector<Index> result(mesh.site_count, k_none);
  for (Index half = 0; half < mesh.half_count(); ++half) {
    Index& mine = result[mesh.triangles[half]];
    if (mine == k_none || mesh.twins[half] == k_none) mine = half;
  }
  return result;
}

}  // namespace

Cells cells_of(const PlanarMesh& mesh, std::span<const std::uint8_t> is_flat) {
  const std::vector<Index> first = leaving(mesh);
  Cells cells;
  cells.offsets.reserve(mesh.site_count + 1);
  cells.offsets.push_back(0);
  cells.neighbours.reserve(static_cast<std::size_t>(6) * mesh.site_count);
  cells.is_open.resize(mesh.site_count);
  for (Index site = 0; site < mesh.site_count; ++site) {
    const std::size_t begin = cells.neighbours.size();
    Index half = first[site];
    cells.is_open[site] = mesh.twins[half] == k_none;
    do {
      if (!is_flat[half]) cells.neighbours.push_back(mesh.triangles[next_half(half)]);
      const Index last = previous_half(half);
      half = mesh.twins[last];
      if (half == k_none) cells.neighbours.push_back(mesh.triangles[last]);
    } while (half != k_none && half != first[site]);
    const auto list = cells.neighbours.begin() + static_cast<std::ptrdiff_t>(begin);
    if (!cells.is_open[site]) std::rotate(list, std::min_element(list, cells.neighbours.end()), cells.neighbours.end());
    cells.offsets.push_back(static_cast<Index>(cells.neighbours.size()));
  }
  return cells;
}

Cells strips_of(const OrderedSites& sites) {
  const Index count = sites.count();
  std::vector<Index> along(count), place(count);
  std::iota(along.begin(), along.end(), 0);
  std::sort(along.begin(), along.end(), [&](Index a, Index b) {
    return sites.x[a] != sites.x[b] ? sites.x[a] < sites.x[b] : sites.y[a] < sites.y[b];
  });
  for (Index i = 0; i < count; ++i) place[along[i]] = i;
  Cells cells;
  cells.are_strips = true;
  cells.is_open.assign(count, 1);
  cells.offsets.push_back(0);
  for (Index site = 0; site < count; ++site) {
    const Index i = place[site];
    if (i > 0) cells.neighbours.push_back(along[i - 1]);
    if (i + 1 < count) cells.neighbours.push_back(along[i + 1]);
    cells.offsets.push_back(static_cast<Index>(cells.neighbours.size()));
  }
  return cells;
}

namespace {

class Stitcher {
 public:
  explicit Stitcher(const Cells& cells) : cells_(cells) {
    owner_.resize(cells.neighbours.size());
    for (Index cell = 0; cell < cells.cell_count(); ++cell)
      std::fill(owner_.begin() + cells.offsets[cell], owner_.begin() + cells.offsets[cell + 1], cell);
    find_twins();
  }

  Numbering number() {
    numbering_.corner_vertices.assign(twins_.size(), k_none);
    numbering_.side_edges.assign(twins_.size(), k_none);
    for (Index side = 0; side < static_cast<Index>(twins_.size()); ++side) {
      if (numbering_.corner_vertices[side] == k_none && !is_infinite(side)) add_vertex(side);
    }
    for (Index side = 0; side < static_cast<Index>(twins_.size()); ++side)
      if (numbering_.side_edges[side] == k_none) add_edge(side);
    return std::move(numbering_);
  }

 private:
  void find_twins() {
    twins_.assign(cells_.neighbours.size(), k_none);
    for (Index side = 0; side < static_cast<Index>(twins_.size()); ++side) {
      if (twins_[side] != k_none) continue;
      const Index mine = owner_[side], other = cells_.neighbours[side];
      Index twin = cells_.offsets[other];
      while (twin < cells_.offsets[other + 1] && cells_.neighbours[twin] != mine) ++twin;
      if (twin == cells_.offsets[other + 1]) throw Error("voronoi_2d: cells do not fit together");
      twins_[side] = twin;
      twins_[twin] = side;
    }
  }

  bool is_infinite(Index side) const {
    const Index cell = owner_[side];
    return cells_.are_strips || (cells_.is_open[cell] && side + 1 == cells_.offsets[cell + 1]);
  }
  Index previous(Index side) const {
    const Index cell = owner_[side];
    return side == cells_.offsets[cell] ? cells_.offsets[cell + 1] - 1 : side - 1;
  }

  void add_vertex(Index corner) {
    const Index vertex = static_cast<Index>(numbering_.vertex_sites.size());
    Index size = 0, walk = corner;
    do {
      numbering_.corner_vertices[walk] = vertex;
      walk = previous(twins_[walk]);
      ++size;
    } while (walk != corner);
    std::array<Index, 3> sites;  // evenly around the vertex, so that their circle is well determined
    for (Index k = 0, step = 0; k < 3; ++k) {
      for (; step < k * size / 3; ++step) walk = previous(twins_[walk]);
      sites[k] = owner_[walk];
    }
    numbering_.vertex_sites.push_back(sites);
  }

  void add_edge(Index side) {
    const Index twin = twins_[side], edge = static_cast<Index>(numbering_.edge_vertices.size());
    numbering_.side_edges[side] = numbering_.side_edges[twin] = edge;
    std::array<Index, 2> ends{numbering_.corner_vertices[previous(side)], numbering_.corner_vertices[side]};
    std::array<Index, 2> sites{owner_[side], owner_[twin]};
    if (ends[0] == k_none) {
      std::swap(ends[0], ends[1]);
      std::swap(sites[0], sites[1]);
    }
    numbering_.edge_vertices.push_back(ends);
    numbering_.edge_sites.push_back(sites);
  }

  const Cells& cells_;
  std::vector<Index> owner_, twins_;
  Numbering numbering_;
};

}  // namespace

Numbering number(const Cells& cells) { return Stitcher(cells).number(); }

}  // namespace saddleback::voronoi2d
