#pragma once
// Shapes laid on a surface, as the bindings hand them round.

#include <memory>
#include <mutex>

#include "saddleback/field/direction_field.h"
#include "saddleback/shape_mapping/conform.h"

#include "convert/shapes.h"

namespace saddleback::bindings {

/// Vertex normals of a mesh, which all shapes laid on it share while some are left.
struct SharedNormals {
  const Mesh* mesh;
  std::mutex mutex;
  std::vector<Vec3> found;  ///< empty until somebody asks
};

/// The shapes with all that they were laid with, so that they can be laid again.
struct MappedShapes {
  py::object mesh_object, field_object;
  std::vector<Shape> shapes;
  Placements placements;
  MapLimits limits;
  std::vector<MappedShape> mapped;
  mutable py::object failures;  ///< a dict, once somebody has asked: loops ask for every shape
  std::shared_ptr<SharedNormals> shared_normals;
  std::mutex mutex;  ///< of the conformer
  std::unique_ptr<Conformer> conformer;

  const Mesh& mesh() const;
  std::vector<const DirectionField*> fields() const { return as_fields(field_object); }
  /// The vertex normals of the mesh, which is given as this may be asked without the GIL. \throw InputError for a mesh
  /// without space.
  const std::vector<Vec3>& normals(const Mesh& own) const;
  const Shape& shape(Index i) const { return shapes[placements[i].shape]; }
  /// An index, negative from the end. \throw IndexError out of range.
  Index checked(const py::object& index) const;
  /// The index of a shape that lies on the surface. \throw InputError for one that could not be laid.
  Index laid(const py::object& index) const;
};

std::unique_ptr<MappedShapes> make_mapped(const py::object& mesh_object, const py::object& shapes,
                                          const py::object& placements, const py::object& field,
                                          const py::object& limits, const py::object& threads, const py::object& job);

}  // namespace saddleback::bindings
