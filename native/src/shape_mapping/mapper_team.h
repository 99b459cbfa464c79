#pragma once
// One mapper for each thread, made when it is first needed.

#include <memory>

#include "shape_mapping/outline_mapper.h"
#include "support/threads/parallel.h"

namespace saddleback {

class MapperTeam {
 public:
  MapperTeam(const Mesh& mesh, int threads) : mesh_(mesh), mappers_(static_cast<std::size_t>(thread_count(threads))) {}
  int threads() const { return static_cast<int>(mappers_.size()); }
  OutlineMapper& of(int thread) {
    if (!mappers_[thread]) mappers_[thread] = std::make_unique<OutlineMapper>(mesh_);
    return *mappers_[thread];
  }

 private:
  const Mesh& mesh_;
  std::vector<std::unique_ptr<OutlineMapper>> mappers_;
};

/// \throw InputError for what map_shapes refuses.
void check_mapping(const Mesh& mesh, std::span<const Shape> shapes, std::span<const Placement> placements,
                   const MapShapesOptions& options);

}  // namespace saddleback
