// What results are made of, for those that are plain structs; classes of one binding alone say so there.

#include "saddleback/mesh/repair.h"

#include "convert/cells.h"
#include "convert/dual.h"
#include "convert/fields.h"
#include "convert/shapes.h"
#include "convert/state.h"

namespace saddleback::bindings {
namespace {

/// Points as they are: what made them has normalized them.
void bind_points_state(const py::module_& m) {
  let_travel<SurfacePoints>(
      m, "SurfacePoints",
      [](const py::object& self) { return py::make_tuple(self.attr("faces"), self.attr("barycentric")); },
      [](const py::tuple& state) {
        const py::tuple parts = as_state(state, 2);
        std::vector<Index> faces;
        std::vector<Vec3> weights;
        restore(parts[0], faces);
        restore(parts[1], weights);
        if (faces.size() != weights.size()) refuse_state(message(faces.size(), " rows"), parts[1]);
        SurfacePoints points(faces.size());
        for (std::size_t i = 0; i < points.size(); ++i) points[i] = {faces[i], weights[i]};
        return points;
      });
}

void bind_placements_state(const py::module_& m) {
  let_travel<Placements>(
      m, "Placements",
      [](const py::object& self) { return py::tuple(state_of_items(py::cast<const Placements&>(self))); },
      [](const py::tuple& state) {
        Placements placements;
        restore_items(state, placements);
        return placements;
      });
}

void bind_report_state(const py::module_& m) {
  let_travel<RepairReport>(
      m, "RepairReport",
      [](const py::object& self) {
        const auto& report = py::cast<const RepairReport&>(self);
        const CloseBorders& close = report.close_borders;
        return py::make_tuple(self.attr("changes"), state_of(report.vertex_map), state_of(report.face_map),
                              close.near_vertices, close.weld_distance, close.vertices_amid_edges);
      },
      [](const py::tuple& state) {
        const py::tuple parts = as_state(state, 6);
        RepairReport report;
        for (const auto& [kind, count] : py::cast<py::dict>(parts[0]))
          report.changes[py::cast<std::string>(kind)] = py::cast<Index>(count);
        restore(parts[1], report.vertex_map);
        restore(parts[2], report.face_map);
        restore(parts[3], report.close_borders.near_vertices);
        restore(parts[4], report.close_borders.weld_distance);
        restore(parts[5], report.close_borders.vertices_amid_edges);
        return report;
      });
}

void bind_dual_state(const py::module_& m) {
  let_travel<Dual>(
      m, "DualMesh",
      [](const py::object& self) {
        const auto& dual = py::cast<const Dual&>(self);
        const DualMesh& mesh = dual;
        return py::make_tuple(dual.owner, state_of(mesh), mesh.repaired ? state_of(*mesh.repaired) : py::none());
      },
      [](const py::tuple& state) {
        const py::tuple parts = as_state(state, 3);
        const CellsIn cells = as_cells(parts[0], "state");
        DualMesh mesh;
        restore(parts[1], mesh);
        if (!parts[2].is_none()) {
          GeodesicVoronoi repaired;
          restore(parts[2], repaired);
          mesh.repaired = std::make_shared<const GeodesicVoronoi>(std::move(repaired));
        }
        const GeodesicVoronoi* const diagram = mesh.repaired ? mesh.repaired.get() : &cells.diagram;
        const py::object graph = py::cast(cells.graph, py::return_value_policy::reference);  // that of the cells
        return Dual{std::move(mesh), parts[0], graph, &cells.graph.mesh(), diagram, std::nullopt};
      });
}

}  // namespace

void bind_states(py::module_& m) {
  bind_points_state(m);
  bind_placements_state(m);
  bind_report_state(m);
  bind_dual_state(m);
  let_travel<GeodesicPath>(m, "GeodesicPath");
  let_travel<GeodesicPaths>(m, "GeodesicPaths");
  let_travel<LogMap>(m, "LogMap");
  let_travel<PolarCoordinates>(m, "PolarCoordinates");
  let_travel<SplitMesh>(m, "SplitMesh");
  let_travel<CellPolygons>(m, "CellPolygons");
  let_travel<DualIssue>(m, "DualIssue");
  let_travel<TriangleQuality>(m, "Quality");
  let_travel<BakedCells>(m, "BakedCells");
  let_travel<RelaxationStep>(m, "RelaxationStep");
  let_travel<ClippedCells>(m, "ClippedCells");
  let_travel<AreaWeights>(m, "AreaWeights");
  let_travel<Balance2d>(m, "Balance2d");
  let_travel<Relaxation2d>(m, "Relaxation2d");
  let_travel<SteppedSweep::Event>(m, "SweepEvent");
  let_travel<Certificate>(m, "Certificate");
  let_travel<ShapeAttributes>(m, "ShapeAttributes");
}

}  // namespace saddleback::bindings
