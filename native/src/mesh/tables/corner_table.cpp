#include "mesh/tables/corner_table.h"

#include "saddleback/error.h"

namespace saddleback {

void check_corners(std::span<const Triangle> triangles, Index vertex_count) {
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (const Index v : triangles[t]) {
      if (v >= 0 && v < vertex_count) continue;
      throw InputError(message("triangles: triangle ", t, " names vertex ", v, ", but there are ", vertex_count));
    }
  }
}

CornerTable::CornerTable(std::span<const Triangle> triangles, Index vertex_count)
    : first_(vertex_count + 1, 0), corners_(3 * triangles.size()) {
  check_corners(triangles, vertex_count);
  for (const Triangle& t : triangles)
    for (const Index v : t) ++first_[v + 1];
  for (Index v = 0; v < vertex_count; ++v) first_[v + 1] += first_[v];
  std::vector<Index> cursor(first_.begin(), first_.end() - 1);
  for (Index i = 0; i < static_cast<Index>(triangles.size()); ++i) {
    const Triangle& t = triangles[i];
    for (int k = 0; k < 3; ++k) corners_[cursor[t[k]]++] = {i, t[(k + 1) % 3], t[(k + 2) % 3]};
  }
}

}  // namespace saddleback
