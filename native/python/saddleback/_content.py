# SPDX-License-Identifier: MIT
"""Objects that travel: pickled and copied, equal where their content is, and known to Dask by it.

Compiled classes tell what is in an object by ``_state()`` and make an equal one by ``_from_state(state)``; the last
``_notes`` parts of a state tell how it was found (by which device) and do not count in comparisons.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from saddleback import _saddleback
from saddleback._saddleback import InputError, Mesh, SaddleVertexGraph, Shape, VersionError, __version__

# Raised whenever a state of this version would be misread by the one before.
_LAYOUT = 1


def restore(kind: type[Any], layout: int, version: str, state: tuple[Any, ...]) -> Any:
    """Make the object that was pickled."""
    if layout != _LAYOUT:
        raise VersionError(
            f"this {kind.__name__} was pickled by saddleback {version}, which this one ({__version__}) does not "
            "understand; use the same version on both sides"
        )
    try:
        return kind._from_state(state)
    except InputError as error:
        raise InputError(f"this pickled {kind.__name__} is damaged or of another version ({error})") from None


def restore_graph(mesh: Mesh, file: bytes) -> SaddleVertexGraph:
    """Make the graph whose file's bytes were pickled."""
    from tempfile import TemporaryDirectory  # a tenth of the time that importing us takes

    with TemporaryDirectory(prefix="saddleback-") as folder:
        path = os.path.join(folder, "pickled.graph")
        with open(path, "wb") as place:
            place.write(file)
        return SaddleVertexGraph.load(path, mesh)


def _graph_bytes(graph: SaddleVertexGraph) -> bytes:
    from tempfile import TemporaryDirectory

    with TemporaryDirectory(prefix="saddleback-") as folder:
        path = os.path.join(folder, "pickled.graph")
        graph.save(path)
        with open(path, "rb") as saved:
            return saved.read()


def _reduce(self: Any) -> tuple[Callable[..., Any], tuple[Any, ...]]:
    return restore, (type(self), _LAYOUT, __version__, self._state())


def _reduce_graph(self: SaddleVertexGraph) -> tuple[Callable[..., Any], tuple[Any, ...]]:
    return restore_graph, (self.mesh, _graph_bytes(self))


def _content(value: Any) -> tuple[Any, ...]:
    """What an object is, of objects, arrays, numbers and words."""
    if isinstance(value, SaddleVertexGraph):  # the library makes the same arcs of these
        return value.mesh, value.k, value.accuracy, value.is_exact, value.arc_count
    if isinstance(value, Mesh | Shape):
        parts: tuple[Any, ...] = value.__reduce__()[1]  # type: ignore[assignment]
        return (*parts, value.edge_lengths) if isinstance(value, Mesh) and value.is_intrinsic else parts
    state: tuple[Any, ...] = value._state()
    return state[: len(state) - value._notes]


def _is_same(a: Any, b: Any) -> bool:
    """To the bit, so that what is no number equals itself."""
    if a is b:
        return True
    if type(a) is not type(b):
        return False
    if isinstance(a, np.ndarray):
        same: bool = a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
        return same
    if isinstance(a, tuple | list):
        return len(a) == len(b) and all(map(_is_same, a, b))
    if isinstance(a, float):
        return repr(a) == repr(b)
    if type(a) in _travelers():
        return _is_same(_content(a), _content(b))
    return bool(a == b)


def _digest(value: Any, into: Any) -> None:
    """Feed what `_is_same` compares to a hash function."""
    into.update(type(value).__name__.encode())
    if isinstance(value, np.ndarray):
        into.update(f"{value.dtype.str}{value.shape}".encode())
        into.update(np.ascontiguousarray(value).data)
    elif isinstance(value, tuple | list):
        into.update(str(len(value)).encode())
        for part in value:
            _digest(part, into)
    elif type(value) in _travelers():
        _digest(_content(value), into)
    else:
        into.update(repr(sorted(value.items()) if isinstance(value, dict) else value).encode())


def _equal(self: Any, other: object) -> Any:
    return _is_same(self, other) if type(self) is type(other) else NotImplemented


def _sizes(value: Any) -> Any:
    """What equal objects have in common and is known at once."""
    if isinstance(value, np.ndarray):
        return value.shape
    if isinstance(value, tuple | list):
        return tuple(map(_sizes, value))
    return value if isinstance(value, int | str) else type(value).__name__


def _hash(self: Any) -> int:
    if isinstance(self, Mesh):
        return hash(self.fingerprint)
    if isinstance(self, SaddleVertexGraph):
        return hash((self.mesh.fingerprint, self.k, self.accuracy, self.is_exact))
    return hash((type(self).__name__, _sizes(_content(self))))


def _token(self: Any) -> tuple[str, str]:
    found = hashlib.blake2b(digest_size=16)
    _digest(self, found)
    return type(self).__name__, found.hexdigest()


def _itself(self: Any, *_: object) -> Any:
    return self


def _travelers() -> Iterable[type]:
    return _TRAVELERS


def _give(kind: Any) -> None:
    """Give a class what Python, its copy module and Dask ask for; nothing changes these objects: a copy is itself."""
    if hasattr(kind, "_from_state"):
        kind.__reduce__ = _reduce
    kind.__eq__, kind.__hash__ = _equal, _hash
    kind.__copy__ = kind.__deepcopy__ = _itself
    kind.__dask_tokenize__ = _token


_TRAVELERS = {kind for kind in vars(_saddleback).values() if isinstance(kind, type) and "_from_state" in vars(kind)} | {
    Mesh,
    Shape,
    SaddleVertexGraph,
}
for _kind in _TRAVELERS:
    _give(_kind)
SaddleVertexGraph.__reduce__ = _reduce_graph  # type: ignore[method-assign, assignment]
