# SPDX-License-Identifier: MIT
"""Chapter 5 of [ying2014]: centroidal Voronoi tessellations of meshes."""

from __future__ import annotations

import numpy as np

import saddleback as sb
from tests import meshes
from tests.bench._thesis.drawing import draw, draw_cells, draw_values, picture
from tests.bench._thesis.items import Answer, graph_of, item, percent, sources_of, surface

BIMBA = "bimba-9k"
STEPS = (1, 2, 4, 8, 16, 32, 64, 100)


def relaxed(
    name: str, count: int, iterations: int = 40, method: str = "lbfgs", **options: object
) -> sb.CentroidalVoronoi:
    """Relax sites from a random sample, as the thesis does; ours begin from coarser cells unless told so."""
    return sb.centroidal_voronoi(
        graph_of(name), count=count, max_iterations=iterations, tolerance=0.0, method=method, start="sample", **options
    )


def normalized(result: sb.CentroidalVoronoi, mesh: sb.Mesh) -> np.ndarray:
    """Return energies in the unit of figure 5.6: times m over the squared area."""
    return np.asarray(result.energy) * len(result.sites) / mesh.area**2


def said_of(quality: sb.Quality) -> str:
    """As in table 5.1."""
    angle = float(np.degrees(quality.least_angle.mean()))
    return f"{quality.min_quality:.3f} {quality.mean_quality:.3f} {np.degrees(quality.min_angle):.1f}° {angle:.1f}°"


def quality_of(cells: sb.GeodesicVoronoi) -> sb.Quality:
    dual = cells.dual()
    return sb.triangle_quality(dual.vertices, dual.triangles)


@item("Figure 5.1", "Pegaso, genus 5, 3,000 sites.")
def figure_5_1() -> Answer:
    result = relaxed("pegaso-32k", 3000, 30)
    with picture("5/1.jpg", 1, 5.0) as (axes,):
        draw_cells(axes, result.cells, view=(30, 15))
    return Answer(
        f"Genus {graph_of('pegaso-32k').mesh.genus}, 3,000 cells, areas sum to the mesh's but for "
        f"{abs(result.cells.areas.sum() / graph_of('pegaso-32k').mesh.area - 1):.0e}. Least and mean quality, least "
        f"and mean least angle: {said_of(quality_of(result.cells))}.",
        "A mesh with a tenth of the vertices.",
        ("5/1.jpg",),
    )


@item(
    "Figure 5.2",
    "Energies after 1 2 4 8 16 32 64 100 steps, over the first: Lloyd 1 .662 .587 .529 .507 .496 .491 .489; L-BFGS 1 "
    ".658 .559 .508 .492 .487 .486 .485.".replace(" .", " 0."),
)
def figure_5_2() -> Answer:
    said = []
    graph, sites = graph_of(BIMBA), sources_of(graph_of(BIMBA).mesh, 500)
    for method in ("lloyd", "lbfgs"):
        energy = sb.centroidal_voronoi(graph, sites=sites, method=method, tolerance=0.0).energy
        said.append(f"{method} " + " ".join(f"{energy[min(s - 1, len(energy) - 1)] / energy[0]:.3f}" for s in STEPS))
    with picture("5/2.jpg", 3) as panels:
        for axes, steps in zip(panels, (0, 4, 64), strict=True):
            draw_cells(axes, sb.centroidal_voronoi(graph, sites=sites, max_iterations=steps).cells)
            axes.set_title(f"{steps} steps", fontsize=9)
    return Answer(
        "; ".join(said) + ".",
        "Another Bimba and number of sites (500), from random vertices, on whose unevenness the ratios depend; L-BFGS "
        "is below Lloyd from the second step on, as there.",
        ("5/2.jpg",),
    )


@item("Figure 5.3", "The distance field of many sources, and the diagram that it induces, on a double torus.")
def figure_5_3() -> Answer:
    graph = graph_of("double-torus-14k")
    sites = sb.sample(graph.mesh, 60, seed=2)
    cells = sb.geodesic_voronoi(graph, sites)
    exact, owner = sb.exact_nearest(graph.mesh, sites)
    error = np.abs(cells.vertex_distance[exact > 0] / exact[exact > 0] - 1).mean()
    with picture("5/3.jpg", 2) as (left, right):
        draw_values(left, graph.mesh, cells.vertex_distance)
        draw_cells(right, cells)
    return Answer(
        f"60 sites: {percent(float((cells.vertex_cell == owner).mean()))} of the vertices in the cell of the exactly "
        f"nearest site, mean error of distances {percent(error)}.",
        "Boundaries are found within faces, as lower envelopes, not by labels of edges.",
        ("5/3.jpg",),
    )


@item("Figure 5.4", "The Riemannian center of a cell's corners in two steps; the center of mass about it.")
def figure_5_4() -> Answer:
    graph = graph_of(BIMBA)
    cells = relaxed(BIMBA, 200, 5).cells
    worst = np.inf
    for cell in range(3):
        corners = cells.corners(cell)
        center = sb.geodesic_center(graph, corners)
        field = sb.ExactField(graph.mesh, corners[0])
        size = float(field.distance_to(center)[0])

        def energy(point: sb.SurfacePoints, corners: sb.SurfacePoints = corners) -> float:
            return sum(float(sb.ExactField(graph.mesh, c).distance_to(point)[0]) ** 2 for c in corners)

        least = energy(center)
        for angle in range(8):
            uv = 0.2 * size * np.array([[np.cos(angle * np.pi / 4), np.sin(angle * np.pi / 4)]])
            worst = min(worst, energy(sb.exp_map(graph.mesh, center, uv)) / least - 1)
    return Answer(
        f"Three cells, eight moves by a fifth of the radius from each center: the sum of squared exact distances rises "
        f"by {percent(worst)} or more.",
        "No picture of the steps: `geodesic_center` returns where they end. Lloyd's step goes to the center of mass "
        "at once.",
    )


@item(
    "Table 5.1",
    "Qmin Qavg θmin θavg: Armadillo 1,500 sites 0.555 0.914 23.5 52.9; Bimba 1,500 0.639 0.926 35.4 53.9; Bunny 5,000 "
    "0.665 "
    "0.918 32.2 53.4; double torus 500 0.651 0.935 29.8 54.6; Dragon 1,500 0.445 0.901 21.9 51.9; Sculpture 2,000 "
    "0.658 0.923 "
    "35.7 54.1; Pegaso 3,000 0.401 0.913 23.4 52.7; Spring 20,000 0.455 0.904 22.6 52.1.",
)
def table_5_1() -> Answer:
    said = []
    for name, count in (
        ("armadillo-loop1-173k", 1500),
        (BIMBA, 1500),
        ("bunny-35k-closed", 5000),
        ("double-torus-14k", 500),
        ("dragon-50k", 1500),
        ("sculpture-8k", 2000),
    ):
        said.append(f"{name} {count:,}: {said_of(quality_of(relaxed(name, count).cells))}")
    return Answer(
        "; ".join(said) + ".",
        "Forty steps of L-BFGS from a random sample; meshes are coarser ones of the same models, the Bimba with 6 "
        "vertices "
        "a cell. Smallest values are those of one triangle. Pegaso is in figure 5.1, the Spring with 2,000 in figure "
        "5.7; Happy "
        "Buddha and Knotty-bottle are not at hand.",
    )


@item("Figure 5.5", "Convergence of Lloyd and L-BFGS on four models.")
def figure_5_5() -> Answer:
    said = []
    cases = ((BIMBA, 500), ("bunny-35k-closed", 1000), ("double-torus-14k", 500), ("sculpture-8k", 2000))
    with picture("5/5.png", 4, 2.4) as panels:
        for axes, (name, count) in zip(panels, cases, strict=True):
            ends = []
            for method in ("lloyd", "lbfgs"):
                energy = normalized(relaxed(name, count, 60, method), graph_of(name).mesh)
                axes.plot(energy, label=method)
                ends.append(energy)
            reached = int((ends[1] <= ends[0][-1]).argmax())
            said.append(f"{name} {count:,}: {reached} steps")
            axes.set_title(f"{name}, {count:,}", fontsize=7)
            axes.legend(fontsize=7)
    return Answer(
        "L-BFGS is where Lloyd is after 60 steps after: " + "; ".join(said) + ".",
        "Bimba with 500 sites in place of 5,000, for a mesh of 9K vertices.",
        ("5/5.png",),
    )


@item("Figure 5.6", "Energy falls, mean quality and least angle rise with the iterations of Lloyd.")
def figure_5_6() -> Answer:
    graph, sites = graph_of(BIMBA), sb.sample(graph_of(BIMBA).mesh, 500, seed=1)
    rows = []
    for steps in (0, 1, 1, 2, 4, 8, 16, 32):
        result = sb.centroidal_voronoi(graph, sites=sites, max_iterations=steps, method="lloyd", tolerance=0.0)
        sites, quality = result.sites, quality_of(result.cells)
        done = rows[-1][0] + steps if rows else 0
        rows.append(
            (done, normalized(result, graph.mesh)[-1], quality.mean_quality, np.degrees(quality.least_angle.mean()))
        )
    with picture("5/6.png", 3, 2.6) as panels:
        columns = list(zip(*rows, strict=True))
        for axes, values, title in zip(
            panels, columns[1:], ("m F / A²", "mean quality", "mean least angle"), strict=True
        ):
            axes.plot(columns[0], values, "o-", markersize=3)
            axes.set_title(title, fontsize=9)
    (_, e0, q0, a0), (_, e1, q1, a1) = rows[0], rows[-1]
    return Answer(
        f"Bimba, 500 sites, 0 to {rows[-1][0]} iterations: energy {e0:.4f} to {e1:.4f} (regular hexagons "
        f"{5 / 18 / 3**0.5:.4f}), quality {q0:.3f} "
        f"to {q1:.3f}, angle {a0:.1f}° to {a1:.1f}°.",
        "Nothing.",
        ("5/6.png",),
    )


@item(
    "Figure 5.7",
    "A coil that nearly touches itself: intrinsic cells keep its windings apart, restricted ones (RVD) do not.",
)
def figure_5_7() -> Answer:
    name = "spring-32k"
    mesh = graph_of(name).mesh
    result = sb.centroidal_voronoi(graph_of(name), count=2000, max_iterations=20)
    dual = result.cells.dual()
    parts = len(np.unique(sb.connected_parts(dual.triangles, len(dual.vertices))))
    with picture("5/7.jpg", 2) as (left, right):
        draw(left, mesh.vertices, mesh.triangles)
        draw_cells(right, result.cells)
    chi = mesh.vertex_count - mesh.edge_count + mesh.face_count
    return Answer(
        f"2,000 sites: the dual has {parts} part, Euler characteristic {dual.euler_characteristic} (the mesh {chi}), "
        f"and {dual.added} sites had to be added for it.",
        "Another spring. RVD is not run here.",
        ("5/7.jpg",),
    )


@item("Figure 5.8", "Consistent cells on the poses of a lion.")
def figure_5_8() -> Answer:
    graph = graph_of("lion-reference")
    result = sb.centroidal_voronoi(graph, count=400, max_iterations=40)
    agree = []
    with picture("5/8.jpg", 3) as panels:
        draw_cells(panels[0], result.cells)
        for axes, pose in zip(panels[1:], ("lion-pose-01", "lion-pose-05"), strict=True):
            posed = graph_of(pose)
            cells = sb.geodesic_voronoi(posed, result.sites)
            agree.append(float((cells.vertex_cell == result.cells.vertex_cell).mean()))
            draw_cells(axes, cells)
    return Answer(
        f"400 sites carried by their faces: {percent(min(agree))} or more of the vertices are in the same cell on "
        f"each pose.",
        "Relaxed anew on each pose the cells are as even, but not the same ones: a pose changes lengths. The add-on "
        "carries them.",
        ("5/8.jpg",),
    )


@item("Figure 5.9", "Kitten, 20 sites: intrinsic cells and RVD differ visibly.")
def figure_5_9() -> Answer:
    graph = graph_of("kitten-53k")
    result = sb.centroidal_voronoi(graph, count=20, max_iterations=60)
    shares = result.cells.areas / graph.mesh.area * 20
    straight = ((graph.mesh.vertices[:, None] - result.sites.positions(graph.mesh)) ** 2).sum(axis=2).argmin(axis=1)
    with picture("5/9.jpg") as (axes,):
        draw_cells(axes, result.cells)
    return Answer(
        f"20 cells, {shares.min():.2f} to {shares.max():.2f} of the mean area. "
        f"{percent(float((straight != result.cells.vertex_cell).mean()))} of the "
        "vertices are nearer to another site through space, which is where RVD has them.",
        "RVD is stood for by straight distances from the same sites.",
        ("5/9.jpg",),
    )


@item("Figure 5.10", "Bimba and Dragon with 400 and 1,500 sites, Happy Buddha and Armadillo with 1,500.")
def figure_5_10() -> Answer:
    said = []
    cases = ((BIMBA, 400), (BIMBA, 1500), ("dragon-50k", 400), ("dragon-50k", 1500))
    with picture("5/10.jpg", 4) as panels:
        for axes, (name, count) in zip(panels, cases, strict=True):
            result = sb.centroidal_voronoi(graph_of(name), count=count, max_iterations=40)
            said.append(f"{name} {count:,}: {result.normalized_energy:.3f}")
            draw_cells(axes, result.cells)
    return Answer(
        "Energy over that of flat regular hexagons: " + "; ".join(said) + ".",
        "The Dragon has 50K vertices; the Buddha is not at hand. A bent cell may have less energy than a flat one.",
        ("5/10.jpg",),
    )


@item("Figure 5.11", "High genus: 8 (5,000 sites), 47 (4,000), knot and skull of genus 2 (1,000).")
def figure_5_11() -> Answer:
    said = []
    cases = (("tube-lattice-genus22", 4000), ("turbine-9k-genus11", 1000), ("skull-20k", 1000))
    with picture("5/11.jpg", 3) as panels:
        for axes, (name, count) in zip(panels, cases, strict=True):
            graph = graph_of(name)
            cells = sb.centroidal_voronoi(graph, count=count, max_iterations=20).cells
            dual = cells.dual()
            mesh = graph.mesh
            chi = mesh.vertex_count - mesh.edge_count + mesh.face_count
            said.append(
                f"genus {mesh.genus}, {count:,} sites: the dual's Euler characteristic {dual.euler_characteristic} "
                f"(the mesh {chi})"
            )
            draw_cells(axes, cells, view=(-50, 25))
    return Answer("; ".join(said) + ".", "Other meshes, of genus up to 22.", ("5/11.jpg",))


@item(
    "Figure 5.12",
    "θavg and irregular vertices N: ours 54.57° 161, 53.83° 370, 52.77° 306; RVD 54.52° 163; UCS 52.33° 234.",
)
def figure_5_12() -> Answer:
    said = []
    for name, count in (("double-torus-14k", 1000), (BIMBA, 1500)):
        cells = sb.centroidal_voronoi(graph_of(name), count=count).cells
        quality = quality_of(cells)
        irregular = int((quality.valence != 6).sum())
        said.append(f"{name} {count:,}: {np.degrees(quality.least_angle.mean()):.2f}° {irregular}")
    round_ = sb.Mesh(*meshes.icosphere(5))
    result = sb.centroidal_voronoi(sb.SaddleVertexGraph(round_), count=500, max_iterations=100)
    quality = quality_of(result.cells)
    return Answer(
        "; ".join(said)
        + f"; a sphere, 500: {np.degrees(quality.least_angle.mean()):.2f}° {int((quality.valence != 6).sum())}.",
        f"The thesis names neither models nor numbers of sites; RVD and UCS are not run. "
        f"{surface(BIMBA).vertex_count:,} vertices of Bimba.",
    )
