#include "geodesics/node_order.h"

#include <cstdint>

#include "mesh/tables/hilbert.h"
#include "support/key_order.h"
#include "support/threads/parallel.h"

namespace saddleback {

NodeOrder::NodeOrder(const Mesh& mesh, int threads, const JobStage& stage) : nodes(mesh.vertex_count()) {
  const HilbertCurve curve(mesh.positions());
  std::vector<std::uint64_t> keys(mesh.vertex_count());
  parallel_for(mesh.vertex_count(), threads, 4096, [&](Index v, int) {
    stage.check();
    keys[v] = curve.key(mesh.position(v));
  });
  vertices = order_of(keys, threads, stage);
  parallel_for(mesh.vertex_count(), threads, 4096, [&](Index node, int) { nodes[vertices[node]] = node; });
}

}  // namespace saddleback
