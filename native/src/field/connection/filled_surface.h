#pragma once
// The surface with each of its holes filled by one vertex: closed, so that indices sum to 2 - 2 genus.

#include <string>
#include <vector>

#include "saddleback/mesh/mesh.h"

#include "field/connection/surface_connection.h"

namespace saddleback {

/// Nodes are the interior vertices and, in place of its vertices, each boundary loop. Boundary edges are no edges of
/// it.
struct FilledSurface {
  struct Component {
    Index genus = 0;
    std::vector<Index> loops;  ///< indices into Mesh::boundary_loops
    /// Euler characteristic of the component itself, holes open.
    Index euler_characteristic() const { return 2 - 2 * genus - static_cast<Index>(loops.size()); }
  };

  explicit FilledSurface(const Mesh& mesh);

  Index node_count = 0;
  std::vector<Index> node_of;       ///< per vertex; those of one loop share a node
  std::vector<Index> loop_nodes;    ///< per boundary loop
  std::vector<double> curvature;    ///< per node, radians: angle defect; of a loop that of the hole filled
  std::vector<Index> component_of;  ///< per node
  std::vector<Component> components;

  /// "component 2 (genus 1, 0 boundary loops)".
  std::string name(Index component) const;
};

/// A half-edge for each edge of the filled surface, of two twins the one of the smaller face.
std::vector<Index> inner_edges(const Mesh& mesh);

}  // namespace saddleback
