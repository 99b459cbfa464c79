#include "mesh/tables/edge_table.h"

#include <algorithm>
#include <cstdint>

namespace saddleback {
namespace {

struct Entry {
  Index larger, halfedge;
  bool operator<(const Entry& other) const {
    return larger != other.larger ? larger < other.larger : halfedge < other.halfedge;
  }
};

// Buckets hold about three entries: insertion sort beats std::sort there.
void sort_bucket(Entry* begin, Entry* end) {
  constexpr std::ptrdiff_t k_small = 24;
  if (end - begin > k_small) {
    std::sort(begin, end);
    return;
  }
  for (Entry* i = begin + 1; i < end; ++i) {
    const Entry entry = *i;
    Entry* place = i;
    for (; place > begin && entry < place[-1]; --place) *place = place[-1];
    *place = entry;
  }
}

}  // namespace

EdgeTable build_edge_table(std::span<const Triangle> triangles, Index vertex_count, const JobStage& stage) {
  std::vector<Index> bucket(static_cast<std::size_t>(vertex_count) + 1, 0);
  const Index face_count = static_cast<Index>(triangles.size());
  const auto for_each_halfedge = [&](auto&& visit) {
    for (Index f = 0; f < face_count; ++f) {
      stage.check();
      const Triangle& t = triangles[f];
      visit(std::min(t[0], t[1]), std::max(t[0], t[1]), 3 * f);
      visit(std::min(t[1], t[2]), std::max(t[1], t[2]), 3 * f + 1);
      visit(std::min(t[2], t[0]), std::max(t[2], t[0]), 3 * f + 2);
    }
  };
  for_each_halfedge([&](Index smaller, Index, Index) { ++bucket[smaller + 1]; });
  for (Index v = 0; v < vertex_count; ++v) bucket[v + 1] += bucket[v];
  std::vector<Entry> entries(3 * triangles.size());
  for_each_halfedge([&](Index smaller, Index larger, Index h) { entries[bucket[smaller]++] = {larger, h}; });

  EdgeTable table;
  table.halfedges.resize(entries.size());
  table.begins.reserve(entries.size() / 2 + 1);
  Index begin = 0;
  for (Index v = 0; v < vertex_count; ++v) {
    stage.check();
    const Index end = bucket[v];  // the scatter moved each bucket's start to its end
    sort_bucket(entries.data() + begin, entries.data() + end);
    for (Index i = begin; i < end; ++i) {
      table.halfedges[i] = entries[i].halfedge;
      if (i == begin || entries[i].larger != entries[i - 1].larger) table.begins.push_back(i);
    }
    begin = end;
  }
  table.begins.push_back(begin);
  return table;
}

std::vector<Index> twins_of(const EdgeTable& edges) {
  std::vector<Index> twins(edges.halfedges.size(), k_none);
  for (Index e = 0; e < edges.edge_count(); ++e) {
    const std::span<const Index> around = edges.edge(e);
    if (around.size() != 2) continue;
    twins[around[0]] = around[1];
    twins[around[1]] = around[0];
  }
  return twins;
}

}  // namespace saddleback
