#pragma once
// Wanted singularities as numbers of the filled surface's nodes, checked.

#include <vector>

#include "saddleback/field/direction_field.h"

#include "field/connection/trivial_connection.h"

namespace saddleback {

/// Units per node of the filled surface: what TrivialConnection takes. Free loops share what the Euler characteristic
/// leaves over, as little turning as possible. \throw InputError as DirectionFieldEditor::field tells; Cancelled.
std::vector<Index> prescribed_units(const Mesh& mesh, const FilledSurface& filled, int symmetry,
                                    const DirectionFieldOptions& options, const TrivialConnection& connection,
                                    const JobStage& stage);

}  // namespace saddleback
