# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces parted along barriers are those of the library's own barriers; both sides of surfaces in parts."""

import numpy as np
import pytest

import saddleback as sb
from saddleback_blender.core.requests import Surface
from saddleback_blender.core.surfaces.mirrors import Mirror
from saddleback_blender.core.surfaces.parts import lonely_edge, part
from tests.meshes import grid, icosphere


@pytest.mark.parametrize("seed", range(20))
def test_parts_are_those_of_the_library(seed):
    rng = np.random.default_rng(seed)
    mesh = sb.Mesh(*icosphere(2))
    edges = mesh.edges[rng.permutation(len(mesh.edges))[: rng.integers(1, 200)]]
    kept = np.sort(rng.permutation(mesh.face_count)[: rng.integers(100, mesh.face_count + 1)])
    triangles = np.ascontiguousarray(mesh.triangles[kept])
    while (lonely := lonely_edge(mesh.triangles, mesh.vertex_count, edges)) is not None:
        edges = edges[(np.sort(edges, axis=1) != np.sort(lonely)).any(axis=1)]
    parted, copies = part(triangles, mesh.vertex_count, edges)
    origin = np.concatenate([np.arange(mesh.vertex_count), copies])
    assert np.array_equal(origin[parted], triangles)
    left_out = ~np.isin(np.arange(mesh.face_count), kept)
    barred = sb.add_barriers(mesh, edges=edges, faces=left_out)
    assert len(np.unique(parted)) == barred.mesh.vertex_count
    pairs = np.unique(np.column_stack([parted.ravel(), barred.mesh.triangles.ravel()]), axis=0)
    assert len(pairs) == barred.mesh.vertex_count  # one to one


def test_a_single_edge_within_the_surface_is_lonely():
    vertices, triangles = icosphere(2)
    mesh = sb.Mesh(vertices, triangles)
    assert set(lonely_edge(mesh.triangles, mesh.vertex_count, mesh.edges[:1])) == set(mesh.edges[0].tolist())
    around = mesh.edges[(mesh.edges == mesh.edges[0, 0]).any(axis=1)][:2]
    assert lonely_edge(mesh.triangles, mesh.vertex_count, around) is None


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("side_strips", [False, True])
def test_vertices_of_seams_that_are_not_joined_have_partners_of_their_own(seed, side_strips):
    """All but the last at each place got no values on the mirrored side: as after imports, which split UV seams."""
    vertices, triangles = grid(9, 9)
    vertices = vertices - vertices.mean(axis=0)
    middle = vertices[triangles].mean(axis=1)
    strip = np.digitize(middle[:, 1], [-0.25, 0.25])
    if side_strips:
        strip += 3 * (np.abs(middle[:, 0]) > 0.25)
    numbers, corners = np.unique(strip[:, None] * len(vertices) + triangles, return_inverse=True)
    order = np.random.default_rng(seed).permutation(len(numbers)).astype(np.int32)
    places, home = np.empty((len(numbers), 3)), np.empty(len(numbers), np.int64)
    places[order], home[order] = vertices[numbers % len(vertices)], numbers // len(vertices)
    whole = Surface("Split", places, order[corners.reshape(-1, 3)], len(places))
    assert len(places) > len(vertices)
    mirror = Mirror.of(whole, whole, places, np.eye(3))
    partner = mirror.partner
    assert np.array_equal(partner[partner], np.arange(len(places)))
    np.testing.assert_allclose(places[partner], places * [-1, 1, 1], atol=1e-12)
    assert np.array_equal(home[partner], home)
    values = np.where(places[:, 0] >= -1e-9, home + np.abs(places[:, 0]), np.nan)
    assert mirror.spread(values) == pytest.approx(home + np.abs(places[:, 0]))
