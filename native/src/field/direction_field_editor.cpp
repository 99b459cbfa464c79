// Two ways to a field. With given singularities: a trivial connection, integrated over a tree of faces, then turned by
// a single-valued angle per face so as to follow strokes. Without: powers of directions, which are linear.

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <span>

#include "saddleback/error.h"
#include "saddleback/field/direction_field.h"

#include "field/connection/prescribed_indices.h"
#include "field/connection/shape_operator.h"
#include "field/connection/sharp_loops.h"
#include "field/connection/untangle_turns.h"
#include "field/linear/row_blocks.h"
#include "field/smoothing/given_directions.h"
#include "field/smoothing/smooth_powers.h"
#include "field/smoothing/stroke_targets.h"

namespace saddleback {
namespace {

using Complex = std::complex<double>;

constexpr double k_turn = 2 * std::numbers::pi;
/// Accuracy of the solver, which only decides how smooth fields are: they close, and meet fixed faces, exactly at any.
constexpr MultigridSolver<double>::Accuracy k_stroke_accuracy{.residual = 1e-7};
constexpr MultigridSolver<Complex>::Accuracy k_power_accuracy{.residual = 1e-6};
/// Counts how often the branches of wanted directions are chosen anew after the field has turned onto them.
constexpr int k_branch_rounds = 3;

void check_options(const DirectionFieldOptions& options, int symmetry) {
  if (options.align == FieldAlignment::curvature && symmetry == 1)
    throw InputError("align: curvature has no head and tail, take symmetry 2 or 4");
  if (!(options.align_weight > 0) || !std::isfinite(options.align_weight))
    throw InputError(message("align_weight is ", options.align_weight, ", but must be positive and finite"));
  if (!options.singularities && !options.loop_units.empty())
    throw InputError("loop_indices: only together with singularities");
}

/// Angles that the field has when it turns so (empty: nowhere) from the smallest face of each component.
std::vector<double> integrate(const Mesh& mesh, const SurfaceConnection& connection, const DualLoops& tree,
                              std::span<const double> turns) {
  std::vector<double> angles(mesh.face_count(), 0.0);
  for (const Index f : tree.order) {
    const Index h = tree.entered_by[f];
    if (h == k_none) continue;
    const double turn = turns.empty() ? 0 : turns[h];
    angles[f] = std::remainder(angles[Mesh::face_of(h)] + connection.transport[h] + turn, k_turn);
  }
  return angles;
}

/// Makes turns fit angles to rounding.
void fit(const Mesh& mesh, const SurfaceConnection& connection, int symmetry, std::span<const double> angles,
         std::vector<double>& turns) {
  for_rows(0, mesh.halfedge_count(), 0, [&](Index h) {
    const Index twin = mesh.twin(h);
    if (twin < h) return;
    const double turn = angles[Mesh::face_of(twin)] - angles[Mesh::face_of(h)] - connection.transport[h] - turns[h];
    turns[h] += std::remainder(turn, k_turn / symmetry);
    turns[twin] = -turns[h];
  });
}

/// Powers of directions that curvature asks for, their sizes the stiffness that they deserve.
std::vector<Complex> curvature_powers(const Mesh& mesh, int symmetry, double weight, const JobStage& stage) {
  const std::vector<FaceBending> bending = bending_of_faces(mesh, shape_operator(mesh, stage));
  stage.check();
  std::vector<Complex> result(mesh.face_count());
  for_rows(0, mesh.face_count(), 0, [&](Index f) {
    const Complex& difference = bending[f].difference;
    result[f] =
        weight * mesh.face_area(f) * (symmetry == 2 ? -bending[f].sum * difference : times(difference, difference));
  });
  return result;
}

/// Powers of the directions that curvature and givers want, their sizes the stiffness; none where nobody does.
std::vector<Complex> wanted_powers(const Mesh& mesh, int symmetry, const DirectionFieldOptions& options,
                                   const JobStage& stage) {
  std::vector<Complex> result;
  if (options.directions) result = powers_of_directions(mesh, symmetry, *options.directions);
  if (options.align != FieldAlignment::curvature) return result;
  std::vector<Complex> bent = curvature_powers(mesh, symmetry, weight_within_bounds(options.align_weight), stage);
  if (result.empty()) return bent;
  for (Index f = 0; f < mesh.face_count(); ++f) result[f] += bent[f];
  return result;
}

}  // namespace

struct DirectionFieldEditor::Kept {
  Kept(const Mesh& its_mesh, int its_symmetry) : mesh(its_mesh), symmetry(its_symmetry) {}

  const Mesh& mesh;
  const int symmetry;
  SurfaceConnection connection;
  std::unique_ptr<FilledSurface> filled;  // made, as connection and loops, when first needed
  DualLoops loops;
  std::unique_ptr<TrivialConnection> trivial;
  // The last trivial connection and what strokes turned it by.
  std::vector<Index> units;
  std::vector<double> given, angles, turns, shift;  // shift: over vertices

  void prepare(const JobStage& stage);
  void find_loops(const JobStage& stage);
  DirectionField designed(const DirectionFieldOptions& options, const JobStage& stage);
  DirectionField automatic(const DirectionFieldOptions& options, const JobStage& stage);

 private:
  std::vector<std::vector<Index>> eager_loops(const std::vector<double>& some_turns) const;
  std::vector<double> gentle_turns(const std::vector<Index>& wanted, const JobStage& stage) const;
  std::vector<double> turns_given(const std::vector<Complex>& wanted) const;
  void connect(const DirectionFieldOptions& options, const std::vector<Complex>& powers, const JobStage& stage);
  std::vector<double> turn_onto(const std::vector<Complex>& wanted, const FaceSprings<double>& springs,
                                std::vector<double> turned, const JobStage& stage) const;
  std::vector<double> best_constants(const std::vector<Complex>& wanted) const;
};

void DirectionFieldEditor::Kept::prepare(const JobStage& stage) {
  if (connection.weight.empty()) connection = surface_connection(mesh, stage);
}

void DirectionFieldEditor::Kept::find_loops(const JobStage& stage) {
  if (filled) return;
  auto made = std::make_unique<FilledSurface>(mesh);
  stage.check();
  loops = dual_loops(mesh, *made);
  stage.check();
  filled = std::move(made);
}

/// Loops along which the field turns too fast for its faces to tell, and need not: they go round handles.
std::vector<std::vector<Index>> DirectionFieldEditor::Kept::eager_loops(const std::vector<double>& some_turns) const {
  if (loops.loops.empty()) return {};
  std::vector<std::vector<Index>> result = sharp_loops(mesh, symmetry, some_turns);
  std::erase_if(result, [this](const std::vector<Index>& loop) {
    const std::vector<double> windings = trivial->windings_of(loop);
    return std::all_of(windings.begin(), windings.end(), [](double winding) { return winding == 0; });
  });
  return result;
}

/// Returns the turns of least turning, with other whole turns around handles where that leaves fewer loops that turn
/// fast.
std::vector<double> DirectionFieldEditor::Kept::gentle_turns(const std::vector<Index>& wanted,
                                                             const JobStage& stage) const {
  constexpr int k_rounds = 12;
  std::vector<double> best = trivial->turns(wanted, symmetry, given, {}, stage.part(0, 0.9)), last = best;
  std::vector<std::vector<Index>> eager = eager_loops(best), gentle;
  std::size_t fewest = eager.size();
  for (int round = 0; round < k_rounds && !eager.empty(); ++round) {
    gentle.insert(gentle.end(), eager.begin(), eager.end());
    std::vector<double> next = trivial->turns(wanted, symmetry, given, gentle, stage.part(0.9, 1));
    if (next == last) break;
    last = std::move(next);
    eager = eager_loops(last);
    if (eager.size() >= fewest) continue;
    fewest = eager.size();
    best = last;
  }
  return best;
}

/// Returns for each half-edge how far the directions wanted on its two sides turn, less what a usual tie resists.
std::vector<double> DirectionFieldEditor::Kept::turns_given(const std::vector<Complex>& wanted) const {
  std::vector<double> result;
  if (wanted.empty() || loops.loops.empty()) return result;
  result.assign(mesh.halfedge_count(), 0.0);
  for (const Index h : inner_edges(mesh)) {
    const Complex from = wanted[Mesh::face_of(h)], to = wanted[Mesh::face_of(mesh.twin(h))];
    const double stiffness = std::min(std::abs(from), std::abs(to));
    if (stiffness == 0) continue;
    const double turn =
        std::remainder((std::arg(to) - std::arg(from)) / symmetry - connection.transport[h], k_turn / symmetry);
    result[h] = turn * stiffness / (stiffness + 2 * k_usual_tie);
    result[mesh.twin(h)] = -result[h];
  }
  return result;
}

void DirectionFieldEditor::Kept::connect(const DirectionFieldOptions& options, const std::vector<Complex>& powers,
                                         const JobStage& stage) {
  if (!trivial) trivial = std::make_unique<TrivialConnection>(mesh, connection, *filled, loops, stage.part(0, 0.1));
  std::vector<Index> wanted = prescribed_units(mesh, *filled, symmetry, options, *trivial, stage.part(0.1, 0.15));
  std::vector<double> now_given = turns_given(powers);
  if (wanted == units && now_given == given) return;
  units.clear();
  given = std::move(now_given);
  turns = gentle_turns(wanted, stage.part(0.15, 1));
  stage.check();
  angles = integrate(mesh, connection, loops, turns);
  fit(mesh, connection, symmetry, angles, turns);
  shift.clear();
  units = std::move(wanted);
}

/// Returns for each face the one angle of its component by which the field best fits those powers.
std::vector<double> DirectionFieldEditor::Kept::best_constants(const std::vector<Complex>& wanted) const {
  std::vector<Complex> sums(mesh.component_count());
  for (Index f = 0; f < mesh.face_count(); ++f)
    sums[mesh.component_of(mesh.triangles()[f][0])] += times(wanted[f], std::polar(1.0, -symmetry * angles[f]));
  std::vector<double> result(mesh.face_count());
  for (Index f = 0; f < mesh.face_count(); ++f)
    result[f] = std::arg(sums[mesh.component_of(mesh.triangles()[f][0])]) / symmetry;
  return result;
}

/// Turns the field, by what it has turned already, onto the directions of those powers too.
std::vector<double> DirectionFieldEditor::Kept::turn_onto(const std::vector<Complex>& wanted,
                                                          const FaceSprings<double>& springs,
                                                          std::vector<double> turned, const JobStage& stage) const {
  std::vector<double> vertices;
  if (turned.empty()) turned = best_constants(wanted);
  for (int round = 0; round < k_branch_rounds; ++round) {
    FaceSprings<double> both = springs;
    for (Index f = 0; f < mesh.face_count(); ++f) {
      const double stiffness = std::abs(wanted[f]);
      if (both.stiffness[f] == k_fixed || stiffness == 0) continue;
      const double angle = std::arg(wanted[f]) / symmetry - angles[f];
      const double target = turned[f] + std::remainder(angle - turned[f], k_turn / symmetry);
      both.target[f] = (both.stiffness[f] * both.target[f] + stiffness * target) / (both.stiffness[f] + stiffness);
      both.stiffness[f] += stiffness;
    }
    const JobStage part =
        stage.part(static_cast<double>(round) / k_branch_rounds, static_cast<double>(round + 1) / k_branch_rounds);
    turned = relax_angles(mesh, connection, both, vertices, k_stroke_accuracy, part);
  }
  return turned;
}

DirectionField DirectionFieldEditor::Kept::designed(const DirectionFieldOptions& options, const JobStage& stage) {
  const bool along_boundary = options.align == FieldAlignment::boundary;
  const std::vector<StrokeFaces> strokes = stroke_faces(mesh, symmetry, options.strokes, along_boundary);
  const std::vector<Complex> wanted = wanted_powers(mesh, symmetry, options, stage);
  find_loops(stage);
  connect(options, wanted, stage.part(0, 0.6));

  std::vector<double> turned_angles = angles, turned_turns = turns;
  std::vector<bool> fixed(mesh.face_count(), false);
  if (!strokes.empty() || !wanted.empty()) {
    FaceSprings<double> springs = turning_springs(mesh, symmetry, angles, strokes);
    stage.check();
    std::vector<double> turned;
    if (options.directions) {
      turned = turns_towards(mesh, connection, symmetry, angles, wanted, springs, k_power_accuracy, stage);
      // Strokes chose among equal angles without the directions; theirs are now those next to what both ask for.
      for (Index f = 0; f < mesh.face_count(); ++f)
        springs.target[f] = turned[f] + std::remainder(springs.target[f] - turned[f], k_turn / symmetry);
    } else if (!strokes.empty()) {
      turned = relax_angles(mesh, connection, springs, shift, k_stroke_accuracy,
                            stage.part(0.6, wanted.empty() ? 0.95 : 0.75));
    }
    if (!wanted.empty()) turned = turn_onto(wanted, springs, std::move(turned), stage.part(0.75, 0.95));
    for (Index f = 0; f < mesh.face_count(); ++f) {
      turned_angles[f] += turned[f];
      fixed[f] = springs.stiffness[f] == k_fixed;
      for (Index h = 3 * f; h < 3 * f + 3; ++h)
        if (mesh.twin(h) != k_none) turned_turns[h] += turned[Mesh::face_of(mesh.twin(h))] - turned[f];
    }
  }
  stage.check();
  untangle_turns(mesh, symmetry, fixed, turned_angles, turned_turns);
  for (double& angle : turned_angles) angle = std::remainder(angle, k_turn);
  return {mesh, symmetry, std::move(turned_angles), std::move(turned_turns), stage};
}

DirectionField DirectionFieldEditor::Kept::automatic(const DirectionFieldOptions& options, const JobStage& stage) {
  const std::vector<StrokeFaces> strokes =
      stroke_faces(mesh, symmetry, options.strokes, options.align == FieldAlignment::boundary);
  FaceSprings<Complex> springs = power_springs(mesh, symmetry, strokes);
  if (const std::vector<Complex> wanted = wanted_powers(mesh, symmetry, options, stage); !wanted.empty()) {
    for_rows(0, mesh.face_count(), 0, [&](Index f) {
      const double stiffness = std::abs(wanted[f]), both = stiffness + springs.stiffness[f];
      if (stiffness == 0 || both == k_fixed) return;
      springs.target[f] = (springs.stiffness[f] * springs.target[f] + wanted[f]) / both;
      springs.stiffness[f] = both;
    });
  }
  std::vector<bool> is_drawn(mesh.component_count(), false);
  const auto component = [&](Index f) { return mesh.component_of(mesh.triangles()[f][0]); };
  for (Index f = 0; f < mesh.face_count(); ++f)
    if (springs.stiffness[f] > 0) is_drawn[component(f)] = true;

  const PowerGraph graph{connection, symmetry};
  const bool any_drawn = std::find(is_drawn.begin(), is_drawn.end(), true) != is_drawn.end();
  const bool any_free = std::find(is_drawn.begin(), is_drawn.end(), false) != is_drawn.end();
  std::vector<Complex> powers;
  if (any_drawn) powers = relax_powers(mesh, graph, springs, k_power_accuracy, stage.part(0, any_free ? 0.4 : 1));
  if (any_free) {
    find_loops(stage);
    std::vector<Complex> start(mesh.face_count());
    const std::vector<double> parallel = integrate(mesh, connection, loops, {});
    for_rows(0, mesh.face_count(), 0, [&](Index f) { start[f] = std::polar(1.0, symmetry * parallel[f]); });
    std::vector<Complex> smooth = smoothest_powers(mesh, graph, start, stage.part(any_drawn ? 0.4 : 0, 1));
    std::vector<Complex> unit(mesh.component_count(), Complex(0));  // turns the first face's angle to 0
    for (Index f = 0; f < mesh.face_count(); ++f)
      if (unit[component(f)] == Complex(0)) unit[component(f)] = std::polar(1.0, -std::arg(smooth[f]));
    if (!any_drawn) powers.resize(mesh.face_count());
    for_rows(0, mesh.face_count(), 0, [&](Index f) {
      if (!is_drawn[component(f)]) powers[f] = times(unit[component(f)], smooth[f]);
    });
  }
  std::vector<double> own(mesh.face_count()), turned(mesh.halfedge_count(), 0.0);
  for_rows(0, mesh.face_count(), 0, [&](Index f) { own[f] = std::arg(powers[f]) / symmetry; });
  for_rows(0, mesh.halfedge_count(), 0, [&](Index h) {
    const Index twin = mesh.twin(h);
    if (twin < h) return;
    const double turn = own[Mesh::face_of(twin)] - own[Mesh::face_of(h)] - connection.transport[h];
    turned[h] = std::remainder(turn, k_turn / symmetry);
    turned[twin] = -turned[h];
  });
  return {mesh, symmetry, std::move(own), std::move(turned), stage};
}

DirectionFieldEditor::DirectionFieldEditor(const Mesh& mesh, int symmetry) {
  if (symmetry != 1 && symmetry != 2 && symmetry != 4)
    throw InputError(message("symmetry is ", symmetry, ", but must be 1 (vectors), 2 (lines) or 4 (crosses)"));
  kept_ = std::make_unique<Kept>(mesh, symmetry);
}
DirectionFieldEditor::~DirectionFieldEditor() = default;
DirectionFieldEditor::DirectionFieldEditor(DirectionFieldEditor&&) noexcept = default;
DirectionFieldEditor& DirectionFieldEditor::operator=(DirectionFieldEditor&&) noexcept = default;

DirectionField DirectionFieldEditor::field(const DirectionFieldOptions& options, Job* job) {
  return field(options, JobStage(job, "Turning directions"));
}

DirectionField DirectionFieldEditor::field(const DirectionFieldOptions& options, const JobStage& stage) {
  check_options(options, kept_->symmetry);
  kept_->prepare(stage);
  DirectionField result = options.singularities ? kept_->designed(options, stage) : kept_->automatic(options, stage);
  stage.update(1);
  return result;
}

DirectionField direction_field(const Mesh& mesh, int symmetry, const DirectionFieldOptions& options, Job* job) {
  return DirectionFieldEditor(mesh, symmetry).field(options, job);
}

DirectionField direction_field(const Mesh& mesh, int symmetry, const DirectionFieldOptions& options,
                               const JobStage& stage) {
  return DirectionFieldEditor(mesh, symmetry).field(options, stage);
}

}  // namespace saddleback
