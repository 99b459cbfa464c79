# SPDX-License-Identifier: MIT
"""Truths about what is laid on a surface: where that unrolls, all of it lies in the plane where a placement says."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import saddleback as sb
from tests import meshes
from tests.truth.outlines import distance_to_side, exact_area, least_distance
from tests.truth.registry import guards
from tests.truth.shapes import Floats, Layout, Random, Unrolled, contains, overlap, random_layout, regular, sure_overlap

Indices = NDArray[np.int32]
ROUNDING = 1e-9  # of what is about as large as 1


def filled_layout(rng: Random) -> Layout | None:
    layout = random_layout(rng, int(rng.integers(1, 5)), innocent=True)
    return layout if layout.poses else None


def on_sheet(surface: Unrolled, points: sb.SurfacePoints) -> Floats:
    """Where surface points lie in the plane that the surface was rolled up from."""
    corners = surface.plane[surface.mesh.triangles[points.faces]]
    return np.asarray(np.einsum("ni,nij->nj", points.barycentric, corners))


def by_pose(layout: Layout, i: int, uv: Floats) -> Floats:
    """Points of a shape's plane in that plane, by the definition of a placement."""
    _, center, angle, scale, mirrored = layout.poses[i]
    c, s = np.cos(angle), np.sin(angle)
    flipped = uv * (1, -1 if mirrored else 1)
    return np.asarray(center + scale * flipped @ np.array([[c, s], [-s, c]]))


def signed_areas(corners: Floats) -> Floats:
    """Of triangles (n, 3, 2) of the plane."""
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.asarray((u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2)


def areas_in_space(corners: Floats) -> Floats:
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.asarray(np.linalg.norm(np.cross(u, v), axis=1) / 2)


@guards("Placements", on="nothing")
def placement_arrays(rng: Random) -> None:
    """Placements hold what they were made of; of another length, negative or not finite they are refused."""
    n = int(rng.integers(1, 6))
    centers = sb.SurfacePoints(rng.integers(0, 9, n), rng.dirichlet([1, 1, 1], n))
    given = [rng.integers(0, 4, n), rng.normal(size=n), rng.uniform(0.1, 5, n), rng.random(n) < 0.5]
    shape, angle, scale, mirrored = given
    laid = sb.Placements(shape, centers, angle, scale, mirrored)
    assert len(laid) == n
    for name, wanted in zip(("shape", "angle", "scale", "mirrored"), given, strict=True):
        assert (getattr(laid, name) == wanted).all()
    assert (laid.center.faces == centers.faces).all()
    assert (laid.center.barycentric == centers.barycentric).all()
    assert not sb.Placements(shape, centers, angle, scale).mirrored.any()
    at = int(rng.integers(n))
    bad = [array.astype(float) for array in (shape, angle, scale)]
    kind = int(rng.integers(4))
    if kind == 3:
        bad[int(rng.integers(3))] = np.ones(n + 1)
    else:
        bad[kind][at] = (-1.0, np.nan, float(rng.choice([0.0, -1.0, np.inf])))[kind]
    try:
        sb.Placements(bad[0].astype(int), centers, bad[1], bad[2])
    except sb.InputError:
        return
    raise AssertionError(f"placements were made of {bad}")


@guards("MappedShapes", "MappedShapes.outline", "MappedShapes.outline_surface", on="nothing")
def outlines_unroll(rng: Random) -> None:
    """Outlines on the surface, unrolled, run along the shape's sides, with their lengths and areas, face by face."""
    layout = filled_layout(rng)
    if layout is None:
        return
    surface, mapped = layout.surface, layout.mapped()
    assert not mapped.failures
    assert abs(mapped.stretch - 1).max() <= ROUNDING
    assert len(mapped) == len(layout.poses)
    for i in range(len(mapped)):
        rings, spatial = mapped.outline_surface(i), mapped.outline(i)
        side = -1 if layout.poses[i][-1] else 1  # outlines keep the shape on their left
        for loop, ring, line in zip(layout.loops(i), rings, spatial, strict=True):
            np.testing.assert_allclose(ring.positions(surface.mesh), line, atol=ROUNDING)
            flat = on_sheet(surface, ring)
            for a in loop:
                assert np.hypot(*(flat - a).T).min() <= ROUNDING, "a corner is missing"
            ends = np.roll(loop, -1, axis=0)
            off = max(min(distance_to_side(p, a, b) for a, b in zip(loop, ends, strict=True)) for p in flat)
            assert off <= ROUNDING, f"{off} off the shape's outline"
            around = float(np.linalg.norm(loop - ends, axis=1).sum())
            length = float(np.linalg.norm(np.diff(np.vstack([line, line[:1]]), axis=0), axis=1).sum())
            assert abs(length - around) <= ROUNDING, f"{length} around a loop of {around}"
            assert abs(exact_area([flat]) - side * exact_area([loop])) <= ROUNDING
            for k in range(len(ring)):
                corners = surface.plane[surface.mesh.triangles[ring.faces[k]]]
                for point in (flat[k], flat[(k + 1) % len(ring)]):
                    inside = signed_areas(np.stack([corners, np.roll(corners, -1, axis=0), [point] * 3], axis=1))
                    assert inside.min() >= -ROUNDING, f"piece {k} leaves its face"


@guards("MappedShapes.patch", "MappedShapes.patches", "CutSurface", on="nothing")
def patches_unroll(rng: Random) -> None:
    """Pieces of surface, unrolled: every corner where its uv says, areas those of the shapes, triangles in their faces,
    all the same side up.
    """
    layout = filled_layout(rng)
    if layout is None:
        return
    surface, mapped = layout.surface, layout.mapped()
    whole = mapped.patches()
    flat = on_sheet(surface, whole.surface)
    np.testing.assert_allclose(whole.surface.positions(surface.mesh), whole.vertices, atol=ROUNDING)
    areas = signed_areas(flat[whole.triangles])
    assert (areas >= -ROUNDING).all()
    np.testing.assert_allclose(areas_in_space(whole.vertices[whole.triangles]), areas, atol=ROUNDING)
    for face, corners in zip(whole.triangle_face, flat[whole.triangles], strict=True):
        sides = surface.plane[surface.mesh.triangles[face]]
        for point in corners:
            inside = signed_areas(np.stack([sides, np.roll(sides, -1, axis=0), [point] * 3], axis=1))
            assert inside.min() >= -ROUNDING, "a triangle leaves its face"
    for i, (shape, _, _, scale, _) in enumerate(layout.poses):
        mine = whole.triangle_shape == i
        wanted = layout.shapes[shape].area * scale**2
        assert abs(areas[mine].sum() - wanted) <= ROUNDING * wanted + 1e-12
        corners = np.unique(whole.triangles[mine])
        np.testing.assert_allclose(flat[corners], by_pose(layout, i, whole.uv[corners]), atol=ROUNDING)
        alone = mapped.patch(i)
        assert len(alone.triangles) == mine.sum()
        assert abs(areas_in_space(alone.vertices[alone.triangles]).sum() - wanted) <= ROUNDING * wanted + 1e-12


def random_solid(shape: sb.Shape, rng: Random) -> tuple[Floats, Indices]:
    """A fan over the first outline, its hub inside that, corners and hub at any heights: only what it covers counts."""
    loop = shape.loops[0]
    count = len(loop)
    vertices = np.zeros((count + 1, 3))
    vertices[:count, :2] = 0.9 * (loop - loop.mean(axis=0)) + loop.mean(axis=0)
    vertices[count, :2] = loop.mean(axis=0)
    vertices[:, 2] = rng.choice([0.0, 0.5]) * rng.normal(size=count + 1)
    here = np.arange(count, dtype=np.int32)
    return vertices, np.stack([here, (here + 1) % count, np.full(count, count)], axis=1).astype(np.int32)


def assert_stands(surface: Unrolled, feet: sb.SurfacePoints, heights: Floats, points: Floats) -> None:
    """Points are as far from their feet as they are high; on a flat sheet straight above them."""
    offset = points - feet.positions(surface.mesh)
    np.testing.assert_allclose(np.linalg.norm(offset, axis=1), abs(heights), atol=ROUNDING)
    if np.ptp(surface.mesh.vertices[:, 2]) == 0:
        np.testing.assert_allclose(offset[:, 2], heights, atol=ROUNDING)


@guards("MappedShapes.conform", "ConformedPoints", "ConformedPoints.positions", on="nothing")
def objects_unroll(rng: Random) -> None:
    """An object's feet, unrolled, are where its x and y say, its heights what z and the scale say."""
    layout = filled_layout(rng)
    if layout is None:
        return
    surface, mapped = layout.surface, layout.mapped()
    for i, (shape, _, _, scale, _) in enumerate(layout.poses):
        vertices, _ = random_solid(layout.shapes[shape], rng)
        bent = mapped.conform(vertices, i)
        assert len(bent.lost) == 0
        np.testing.assert_allclose(on_sheet(surface, bent.surface), by_pose(layout, i, vertices[:, :2]), atol=ROUNDING)
        np.testing.assert_allclose(bent.heights, scale * vertices[:, 2], atol=ROUNDING)
        assert_stands(surface, bent.surface, bent.heights, bent.points)
        np.testing.assert_allclose(bent.positions(surface.mesh), bent.points, atol=ROUNDING)
        moved = sb.Mesh(surface.mesh.vertices + (3, 4, 5), surface.mesh.triangles)
        np.testing.assert_allclose(bent.positions(moved), bent.points + (3, 4, 5), atol=1e-8)


def distances_to_segments(points: Floats, begins: Floats, ends: Floats) -> Floats:
    """Of each point to its own segment."""
    along, arm = ends - begins, points - begins
    squared = np.maximum((along * along).sum(axis=1), np.finfo(float).tiny)
    share = np.clip((arm * along).sum(axis=1) / squared, 0, 1)
    return np.asarray(np.linalg.norm(arm - share[:, None] * along, axis=1))


@guards("MappedShapes.bend", "BentCopies", "BentCopies.positions", on="nothing")
def solids_unroll(rng: Random) -> None:
    """Bent solids, unrolled: whatever they were divided into covers what the solids cover, once, and every corner is
    where its weights in the solid's triangle say.
    """
    layout = filled_layout(rng)
    if layout is None:
        return
    surface, mapped = layout.surface, layout.mapped()
    solids = [random_solid(shape, rng) for shape in layout.shapes]
    tolerance = float(rng.choice([0.0, 0.01, 0.1]))
    bent = mapped.bend(solids, tolerance, threads=1)
    assert len(bent.lost) == 0
    assert bent.begins[0] == 0
    assert bent.begins[-1] == len(bent.vertices)
    flat = on_sheet(surface, bent.surface)
    assert_stands(surface, bent.surface, bent.heights, bent.vertices)
    np.testing.assert_allclose(bent.positions(surface.mesh), bent.vertices, atol=ROUNDING)
    np.testing.assert_allclose(bent.weights.sum(axis=2), 1, atol=1e-12)
    for i, (shape, _, _, scale, _) in enumerate(layout.poses):
        vertices, triangles = solids[shape]
        mine = bent.triangle_copy == i
        corners = bent.triangles[mine]
        assert ((corners >= bent.begins[i]) & (corners < bent.begins[i + 1])).all()
        source = vertices[triangles[bent.triangle_source[mine]]]
        meant = np.einsum("tcw,twk->tck", bent.weights[mine], source)
        for corner in range(3):
            np.testing.assert_allclose(
                flat[corners[:, corner]], by_pose(layout, i, meant[:, corner, :2]), atol=ROUNDING
            )
            np.testing.assert_allclose(bent.heights[corners[:, corner]], scale * meant[:, corner, 2], atol=ROUNDING)
        pieces = np.bincount(bent.triangle_source[mine], signed_areas(flat[corners]), minlength=len(triangles))
        np.testing.assert_allclose(pieces, scale**2 * signed_areas(vertices[triangles][:, :, :2]), atol=ROUNDING)
        if tolerance == 0:
            assert len(corners) == len(triangles)
            assert bent.begins[i + 1] - bent.begins[i] == len(vertices)
            continue
        # Steep solids may keep some edges that leave the surface farther: then that is told.
        begins, ends = bent.vertices[corners].reshape(-1, 3), bent.vertices[np.roll(corners, -1, axis=1)].reshape(-1, 3)
        middles = (meant + np.roll(meant, -1, axis=1)).reshape(-1, 3) / 2
        left = distances_to_segments(mapped.conform(middles, i).points, begins, ends)
        most = max(tolerance, bent.deviations[i]) * scale * layout.shapes[shape].circumradius
        assert left.max() <= most * (1 + ROUNDING), f"an edge is {left.max()} from the surface, told was {most}"


@guards("MappedShapes.attributes", "ShapeAttributes", on="nothing")
def attributes_unroll(rng: Random) -> None:
    """What vertices know of shapes: by the sides of all outlines in the plane, as far as the reach."""
    layout = filled_layout(rng)
    if layout is None:
        return
    surface = layout.surface
    reach = float(rng.choice([0.0, 0.05, 0.3]))
    found = layout.mapped().attributes(reach, threads=1)
    table = np.empty((len(layout.poses), len(surface.plane)))
    for i in range(len(layout.poses)):
        loops = layout.loops(i)
        sides = [(a, b) for loop in loops for a, b in zip(loop, np.roll(loop, -1, axis=0), strict=True)]
        for v, place in enumerate(surface.plane):
            distance = min(distance_to_side(place, a, b) for a, b in sides)
            table[i, v] = -distance if contains(loops, place) else distance
    for v, place in enumerate(surface.plane):
        nearest = table[:, v].min()
        i = int(found.placement[v])
        if i < 0:
            assert nearest >= reach - ROUNDING, f"vertex {v} is {nearest} from a shape"
            assert np.isinf(found.distance[v])
            continue
        assert abs(found.distance[v] - table[i, v]) <= ROUNDING, f"vertex {v}: {found.distance[v]} for {table[i, v]}"
        assert table[i, v] <= nearest + ROUNDING, f"vertex {v} is nearer to another"
        assert table[i, v] <= reach + ROUNDING
        np.testing.assert_allclose(by_pose(layout, i, found.uv[[v]])[0], place, atol=ROUNDING)


@guards("MappedShapes.frames", on="nothing")
def frames_stand(rng: Random) -> None:
    """Points at the centers, axes of unit length at right angles, x along the placement's direction on flat sheets."""
    layout = filled_layout(rng)
    if layout is None:
        return
    mapped = layout.mapped()
    points, quaternions, scales = mapped.frames()
    np.testing.assert_allclose(points, mapped.placements.center.positions(layout.surface.mesh), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(quaternions, axis=1), 1, atol=1e-12)
    moved_points, moved, _ = mapped.frames(sb.Mesh(layout.surface.mesh.vertices + 2, layout.surface.mesh.triangles))
    np.testing.assert_allclose(moved_points, points + 2, atol=1e-12)
    np.testing.assert_allclose(abs((moved * quaternions).sum(axis=1)), 1, atol=1e-9)
    for i, (_, _, angle, scale, mirrored) in enumerate(layout.poses):
        np.testing.assert_allclose(scales[i], scale * np.array([1, -1 if mirrored else 1, 1]), rtol=1e-12)
        w, x, y, z = quaternions[i]
        along = np.array([1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)])
        up = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
        face = layout.surface.mesh.triangles[mapped.placements.center.faces[i]]
        a, b, c = layout.surface.mesh.vertices[face]
        assert up @ np.cross(b - a, c - a) > 0
        if np.ptp(layout.surface.mesh.vertices[:, 2]) == 0:
            np.testing.assert_allclose(along, [np.cos(angle), np.sin(angle), 0], atol=ROUNDING)
            np.testing.assert_allclose(up, [0, 0, 1], atol=1e-12)


def poses_of(surface: Unrolled, shapes: list[sb.Shape], placements: sb.Placements) -> Layout:
    """Placements as poses in the plane."""
    layout = Layout(surface, shapes)
    centers = on_sheet(surface, placements.center)
    first = surface.plane[surface.mesh.triangles[placements.center.faces, :2]]
    along = first[:, 1] - first[:, 0]
    angles = placements.angle + np.arctan2(along[:, 1], along[:, 0])
    for i in range(len(placements)):
        pose = int(placements.shape[i]), centers[i], float(angles[i]), float(placements.scale[i])
        layout.add(*pose, bool(placements.mirrored[i]))
    return layout


@guards("distribute", "Distribution", "Distribution.outline", "Distribution.conform", on="nothing")
def laid_copies(rng: Random) -> None:
    """No two copies meet and none leaves the surface, by polygons in fractions; sizes, directions, counts and gaps are
    those asked for, of each class its own; what lies there stays.
    """
    surface = Unrolled(rng)
    shapes = [sb.Shape.star(5), sb.Shape([regular(12, 1.0), regular(12, 0.6)]), sb.Shape.needle(6)]
    size, gap = float(rng.uniform(0.05, 0.2)), float(rng.choice([0.0, 0.02]))
    counts = rng.integers(0, 4, 3)
    counts[0] += 1
    low = float(rng.uniform(0.5, 1))
    sizes = size * np.where(rng.random() < 0.5, 1.0, rng.uniform(0.5, 1, 3)) * np.ones(3)
    fields = [sb.direction_field(surface.mesh, 1).turned(float(rng.uniform(0, 7))) for _ in range(3)]
    orders = {
        "size": sizes if rng.random() < 0.5 else [np.full(surface.mesh.vertex_count, own) for own in sizes],
        "field": fields, "gap": gap, "size_range": (low, 1), "mirror": bool(rng.random() < 0.5),
        "mode": str(rng.choice(["random", "packed"])), "threads": 1,
    }  # fmt: skip
    if rng.random() < 0.3:
        orders["density"] = rng.uniform(0.1, 1, (3, surface.mesh.vertex_count))
    laid = sb.distribute(surface.mesh, shapes, counts, seed=int(rng.integers(1000)), **orders)
    if rng.random() < 0.5:
        kept = laid.placements[rng.random(len(laid)) < 0.5]
        laid = sb.distribute(surface.mesh, shapes, counts, around=kept, seed=int(rng.integers(1000)), **orders)
        assert laid.placements[: len(kept)].angle.tobytes() == kept.angle.tobytes()
        assert laid.placements[: len(kept)].center.barycentric.tobytes() == kept.center.barycentric.tobytes()
    found = np.bincount(laid.placements.shape, minlength=3)
    assert (found <= counts).all()
    assert laid.stop_reason != "counts" or (found == counts).all()
    scales, own = laid.placements.scale, sizes[laid.placements.shape]
    assert ((scales >= own * low * (1 - 1e-9)) & (scales <= own * (1 + 1e-9))).all()
    for i in range(len(laid)):
        center, angle = laid.placements.center[i], laid.placements.angle[i]
        a, b, c = surface.mesh.vertices[surface.mesh.triangles[center.faces[0]]]
        x = (b - a) / np.linalg.norm(b - a)
        y = np.cross(np.cross(x, c - a) / np.linalg.norm(np.cross(x, c - a)), x)
        along = fields[laid.placements.shape[i]].directions(center)[0]
        np.testing.assert_allclose(np.cos(angle) * x + np.sin(angle) * y, along, atol=1e-6)
    layout = poses_of(surface, shapes, laid.placements)
    for i in range(len(laid)):
        loops = layout.loops(i)
        corners = np.vstack(loops)
        edge = min(corners.min(), (surface.size - corners).min())
        assert edge >= gap / 2 - ROUNDING, f"copy {i} is {edge} from the border"
        flat = [on_sheet(surface, ring) for ring in laid.mapped.outline_surface(i)]
        assert all(a.tobytes() == b.tobytes() for a, b in zip(laid.outline(i), laid.mapped.outline(i), strict=True))
        side = -1 if layout.poses[i][-1] else 1  # outlines keep the shape on their left
        areas = side * np.array([exact_area([loop]) for loop in loops])
        np.testing.assert_allclose([exact_area([ring]) for ring in flat], areas, atol=ROUNDING)
        point = np.array([[0.1, 0.0]])
        feet = laid.mapped.conform(point, i)
        np.testing.assert_allclose(on_sheet(surface, feet.surface), by_pose(layout, i, point), atol=ROUNDING)
        assert laid.conform(point, i).tobytes() == feet.points.tobytes()
        for j in range(i):
            assert not sure_overlap(loops, layout.loops(j), ROUNDING), f"copies {j} and {i} meet"
            if gap > 0:
                between = least_distance(loops, layout.loops(j))
                assert between >= gap - ROUNDING, f"copies {j} and {i} are {between} apart, not {gap}"


@guards("Certificate", "distribute", on="nothing")
def nothing_more_fits(rng: Random) -> None:
    """Where a certificate says that nothing more fits, copies laid at random come nearer than its tolerance to others,
    or to the border, wherever their density is positive; and none lies where it is 0.
    """
    surface = Unrolled(rng, 1.0, 1.0)
    if np.ptp(surface.mesh.vertices[:, 2]) > 0:
        return
    heading = float(rng.uniform(0, 7))
    direction = np.array([np.cos(heading), np.sin(heading), 0])
    field = sb.DirectionField.from_vectors(surface.mesh, np.tile(direction, (surface.mesh.face_count, 1)), 1)
    shapes = [sb.Shape(regular(int(rng.integers(3, 7)), 1.0)) for _ in range(int(rng.integers(1, 3)))]
    sizes, turns = rng.uniform(0.1, 0.3, len(shapes)), rng.uniform(0, 7, len(shapes))
    fields = [field.turned(float(turn)) for turn in turns]
    density, bend = None, bool(rng.random() < 0.3)  # of straight curves
    if rng.random() < 0.5:
        density = rng.random((len(shapes), surface.mesh.vertex_count)) * (rng.random(surface.mesh.vertex_count) < 0.3)
        density[:, int(rng.integers(surface.mesh.vertex_count))] = 1
    laid = sb.distribute(
        surface.mesh, shapes, None, fields, density, size=sizes, bend=bend, maximal=True, tolerance=0.05, threads=1
    )

    def wanted(which: int, points: sb.SurfacePoints, i: int) -> bool:
        if density is None:
            return True
        corners = surface.mesh.triangles[points.faces[i]]
        return bool(density[which][corners] @ points.barycentric[i] > 0)

    assert all(wanted(int(which), laid.placements.center, i) for i, which in enumerate(laid.placements.shape))
    proof = laid.certificate
    assert proof is not None
    assert proof.leaves <= proof.cells
    assert len(proof.uncertified) == 0 or proof.uncertified_area > 0
    if laid.stop_reason != "full" or proof.uncertified_area > 0:
        return
    assert 0 < proof.tolerance <= 0.05 * sizes.max() * (1 + 1e-9)
    layout = poses_of(surface, shapes, laid.placements)
    loops = [layout.loops(i) for i in range(len(laid))]
    others = np.array([center for _, center, *_ in layout.poses])
    for center in rng.random((60, 2)):
        which = int(rng.integers(len(shapes)))
        if not wanted(which, sb.project(surface.mesh, [[*center, 0.0]]), 0):
            continue
        angle = heading + turns[which]
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        tried = center + sizes[which] * shapes[which].loops[0] @ turn
        if min(tried.min(), (1 - tried).min()) < proof.tolerance:
            continue
        near = np.flatnonzero(np.hypot(*(others - center).T) < 2 * sizes.max() + proof.tolerance).tolist()
        meets = any(
            overlap([tried], loops[k]) or least_distance([tried], loops[k]) < proof.tolerance + ROUNDING for k in near
        )
        assert meets, f"another one fits at {center.tolist()}"


def about_circle(loop: Floats, radius: float, place: Floats) -> Floats:
    """An outline of a shape's plane laid along a circle about the origin that runs counter-clockwise through a place:
    what is left of the curve is nearer to the origin.
    """
    ways = np.linspace(0, 1, 16, endpoint=False)[:, None, None]
    x, y = (loop + ways * (np.roll(loop, -1, axis=0) - loop)).transpose(1, 0, 2).reshape(-1, 2).T
    angle = np.arctan2(place[1], place[0]) + x / radius
    return np.asarray((radius - y)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]))


@guards("distribute")
def laid_on_any_surface(mesh: sb.Mesh, rng: Random) -> None:
    """However rough the mesh is, and whatever is forbidden: not refused, and no two copies meet by the checker, which
    has truths of its own.
    """
    shape = [sb.Shape.needle(4), sb.Shape.star(), sb.Shape.disk(12)][rng.integers(3)]
    count = int(rng.integers(1, 40))
    forbidden = rng.random(mesh.face_count) < rng.random()
    forbidden[rng.integers(mesh.face_count)] = False
    orders = {"forbidden": forbidden} if rng.random() < 0.3 else {}
    try:
        laid = sb.distribute(
            mesh, shape, count, sb.direction_field(mesh, int(rng.choice([1, 2, 4]))), threads=1,
            size=float(np.sqrt(rng.uniform(0.1, 0.6) * mesh.area / count / shape.area)), **orders,
        )  # fmt: skip
    except sb.InputError as error:
        raise AssertionError("a usual laying was refused") from error
    assert sb.check_distribution(mesh, laid, samples=2_000, threads=1).ok


@guards("Certificate", "distribute", on="nothing")
def nothing_more_fits_along_circles(rng: Random) -> None:
    """Copies that bend along circles in the plane: none meets another, and where a certificate says that nothing more
    fits, those laid at random, larger by a tenth, meet one or the border. All by the polar coordinates that they have.
    """
    mesh = sb.Mesh(*meshes.grid(31, 31))
    beyond = rng.uniform(0.6, 2)  # so far that curves through copies are no tighter than they can follow
    middle = np.array([rng.uniform(-0.3, 1.3), rng.choice([-beyond, 1 + beyond])])
    away = mesh.vertices[mesh.triangles].mean(axis=1)[:, :2] - middle
    field = sb.DirectionField.from_vectors(mesh, np.column_stack([-away[:, 1], away[:, 0], 0 * away[:, 0]]), 1)
    loop = regular(int(rng.integers(3, 7)), 1.0) * (1, rng.uniform(0.3, 1))
    size = float(rng.uniform(0.1, 0.2))
    laid = sb.distribute(
        mesh, sb.Shape(loop), None, field, size=size, bend=True, maximal=True, tolerance=0.02, threads=1
    )

    def copy(place: Floats, scale: float) -> Floats:
        return middle + about_circle(scale * loop, float(np.linalg.norm(place - middle)), place - middle)

    centers = laid.placements.center.positions(mesh)[:, :2]
    copies, smaller = ([copy(center, size * share) for center in centers] for share in (1, 0.98))
    for i in range(len(copies)):
        for k in range(i):
            if np.linalg.norm(centers[i] - centers[k]) < 2 * size:
                assert not overlap([smaller[i]], [smaller[k]]), f"copies {k} and {i} meet"
    if laid.stop_reason != "full" or laid.certificate is None or laid.certificate.uncertified_area > 0:
        return
    for center in rng.random((60, 2)):
        tried = copy(center, size * 1.1)
        if min(tried.min(), (1 - tried).min()) < 0:
            continue
        near = np.flatnonzero(np.hypot(*(centers - center).T) < 2.2 * size).tolist()
        assert any(overlap([tried], [copies[k]]) for k in near), f"another one fits at {center.tolist()}"


@guards("density_match", "DensityMatch", on="nothing")
def copies_by_density(rng: Random) -> None:
    """Copies in the halves of a strip, counted; only ratios of densities count, and the order of copies does not."""
    columns = 2 * int(rng.integers(2, 6))
    vertices, triangles = meshes.grid(columns + 1, 3)
    mesh = sb.Mesh(vertices * (4, 1, 1), triangles)
    density = 1 + rng.random() * vertices[:, 0]
    places = sb.sample(mesh, int(rng.integers(1, 40)), density, seed=int(rng.integers(1000)))
    n = len(places)
    copies = sb.Placements(np.zeros(n, int), places, np.zeros(n), np.ones(n))
    match = sb.density_match(mesh, copies, density, 2)
    on_left = int((places.positions(mesh)[:, 0] < 2).sum())
    assert match.found.tolist() == [on_left, n - on_left]
    half = density[vertices[:, 0] == 0.5][0]
    left, right = (density[0] + half) / 2, (half + density.max()) / 2  # of a density that grows evenly
    np.testing.assert_allclose(match.wanted, n * np.array([left, right]) / (left + right), rtol=1e-9)
    order = rng.permutation(n)
    again = sb.density_match(
        mesh,
        sb.Placements(
            np.zeros(n, int),
            sb.SurfacePoints(places.faces[order], places.barycentric[order]),
            np.zeros(n),
            np.ones(n),
        ),
        density * 1e-3,
        2,
    )
    np.testing.assert_allclose(again.wanted, match.wanted, rtol=1e-9)
    assert (again.found == match.found).all()
    if 2 * on_left != n:
        assert match.correlation == (1 if on_left < n - on_left else -1) or abs(abs(match.correlation) - 1) < 1e-9
        assert (match.correlation > 0) == (on_left < n - on_left)
