#pragma once
// The half-edges out of a vertex, for range-based loops.

#include <array>
#include <iterator>

#include "saddleback/mesh/mesh.h"

namespace saddleback {

/// Half-edges out of a vertex, counter-clockwise from its first one; one face lies on the left of each.
class Outgoing {
 public:
  Outgoing(const Mesh& mesh, Index vertex) : mesh_(&mesh), first_(mesh.first_halfedge(vertex)) {}

  class Iterator {
   public:
    Iterator(const Mesh& mesh, Index first) : mesh_(&mesh), first_(first), halfedge_(first) {}
    Index operator*() const { return halfedge_; }
    Iterator& operator++() {
      halfedge_ = mesh_->rotate(halfedge_);
      if (halfedge_ == first_) halfedge_ = k_none;
      return *this;
    }
    bool operator==(std::default_sentinel_t) const { return halfedge_ == k_none; }

   private:
    const Mesh* mesh_;
    Index first_, halfedge_;
  };

  Iterator begin() const { return {*mesh_, first_}; }
  static std::default_sentinel_t end() { return {}; }

 private:
  const Mesh* mesh_;
  Index first_;
};

inline Outgoing outgoing(const Mesh& mesh, Index vertex) { return {mesh, vertex}; }

/// A half-edge of the edge number `number` that a caller gives by its vertices. \throw InputError naming it where these
/// are out of range or no edge joins them.
Index given_edge(const Mesh& mesh, const std::array<Index, 2>& edge, std::size_t number);

}  // namespace saddleback
