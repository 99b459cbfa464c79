# SPDX-License-Identifier: GPL-3.0-or-later
"""Surfaces parted along barriers are those of the library's own barriers."""

import numpy as np
import pytest

import saddleback as sb
from saddleback_blender.core.surfaces.parts import lonely_edge, part
from tests.meshes import icosphere


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
