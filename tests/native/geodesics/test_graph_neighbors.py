# SPDX-License-Identifier: MIT
"""The graph opened: neighbors, arcs and tiers."""

from __future__ import annotations

import numpy as np
import pytest

import saddleback as sb
from tests import meshes


@pytest.mark.parametrize("options", [{"k": 30}, {"accuracy": 5e-3}, {"exact": True}])
def test_arcs_lead_in_their_directions_to_their_ends(options: dict[str, object]) -> None:
    mesh = sb.Mesh(*meshes.icosphere(3))
    graph = sb.SaddleVertexGraph(mesh, **options)  # type: ignore[arg-type]
    for vertex in (0, 7, 300):
        for target, length, angle in zip(*graph.neighbors(vertex), strict=True):
            end = sb.trace(mesh, vertex, float(angle), float(length))
            assert np.linalg.norm(end.points[-1] - mesh.vertices[target]) < 1e-6 * length


def test_kinds_are_signs_of_the_curvature() -> None:
    flat = sb.Mesh(*meshes.grid(5, 5))
    assert set(flat.vertex_kinds[flat.boundary_vertices]) == {-1}
    assert set(np.delete(flat.vertex_kinds, flat.boundary_vertices)) == {0}
    torus = sb.Mesh(*meshes.torus())
    ring = np.linalg.norm(torus.vertices[:, :2], axis=1)
    assert torus.vertex_kinds[ring.argmax()] == 1
    assert torus.vertex_kinds[ring.argmin()] == -1
    assert torus.vertex_kinds.dtype == np.int8


def test_tiers_count_each_arc_once() -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.torus()), k=20)
    assert list(graph.tiers) == ["S-S", "N-S", "N-N"]
    assert 2 * sum(graph.tiers.values()) == graph.arc_count


def test_a_vertex_out_of_range_is_refused() -> None:
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.grid(4, 4)), k=8)
    with pytest.raises(sb.InputError, match=r"^vertex: wanted 0 to 15, got 16"):
        graph.neighbors(16)


def test_a_cancelled_listing_raises() -> None:
    job = sb.Job()
    job.cancel()
    graph = sb.SaddleVertexGraph(sb.Mesh(*meshes.grid(4, 4)), k=8)
    with pytest.raises(sb.Cancelled):
        graph.arcs(job=job)
