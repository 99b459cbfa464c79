# SPDX-License-Identifier: MIT
"""Graphs, fields and batches of meshes over the workers of a Dask cluster; needs ``dask`` and ``distributed``.

Answers are those of one machine, to the bit. Everything that a task needs is known to the scheduler, so what a worker
that died had done is done again by the others, and a task that raises is tried again as often as ``retries`` says.
"""

from __future__ import annotations

import pickle
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from saddleback._saddleback import (
    Cancelled,
    Error,
    InputError,
    Job,
    Mesh,
    SaddleVertexGraph,
    SurfaceCurve,
    SurfacePoints,
    VersionError,
    __version__,
    find_arcs,
    read_mesh,
)

try:
    import dask
    import dask.array
    from dask.delayed import delayed
    from distributed import Client, Future, as_completed
except ImportError as error:
    raise ImportError(f"saddleback.dask needs dask and distributed ({error}): pip install saddleback[dask]") from error

__all__ = ["build", "fields", "map_meshes", "threads"]

Result = TypeVar("Result")
Progress = Callable[[int, int], object]
_SECONDS_BETWEEN_LOOKS = 0.05


def build(
    client: Client,
    mesh: Mesh,
    *,
    k: int | None = None,
    accuracy: float | None = None,
    parts: int | None = None,
    retries: int = 2,
    progress: Progress | None = None,
    job: Job | None = None,
) -> SaddleVertexGraph:
    """Build a graph: the workers find its parts, which are joined here to the same bits as `SaddleVertexGraph` builds.

    Parameters
    ----------
    client : distributed.Client
    mesh : Mesh
    k, accuracy : optional
        As of SaddleVertexGraph.
    parts : int, optional
        How many; by default four for each thread of the workers.
    retries : int
        How often a task that raises is tried again.
    progress : callable, optional
        Called with the number of tasks that are done, and of all, until these are equal.
    job : Job, optional
        Cancellation, as by Ctrl-C: no other task begins; those that have begun end by themselves.

    Returns
    -------
    SaddleVertexGraph

    Raises
    ------
    InputError
        As of SaddleVertexGraph, or a worker has no saddleback.
    VersionError
        A worker has another version of the library.
    Cancelled
        The job was cancelled.
    """
    _check_workers(client)
    count = 4 * max(1, sum(client.nthreads().values())) if parts is None else parts
    if count < 1:
        raise InputError(f"parts: wanted at least 1, got {count}")
    given: dict[str, Any] = {"mesh": _sent(client, mesh), "parts": count, "k": k, "accuracy": accuracy}
    tasks = client.map(_find, range(count), **given, version=__version__, pure=False, retries=retries)
    return SaddleVertexGraph.from_parts(mesh, _results(client, tasks, progress, job), job=job)


def fields(
    client: Client,
    graph: SaddleVertexGraph,
    sources: ArrayLike | SurfacePoints | Sequence[SurfaceCurve],
    *,
    chunk: int = 16,
    limit: float = np.inf,
) -> dask.array.Array:
    """Give the distances from each of many sources, which the workers find when they are asked for.

    Parameters
    ----------
    client : distributed.Client
    graph : SaddleVertexGraph
        Sent once, and from worker to worker.
    sources : (n,) vertices, SurfacePoints or a list of SurfaceCurve
    chunk : int
        Sources of a task.
    limit : float
        As of `SaddleVertexGraph.fields`.

    Returns
    -------
    dask.array.Array
        (n, V) float64, equal to what `SaddleVertexGraph.fields` returns; 8 bytes a vertex and source where it is found.

    Raises
    ------
    InputError
        No sources, chunk below 1, or a worker has no saddleback; what else is wrong with the sources when computed.
    VersionError
        A worker has another version of the library.
    """
    _check_workers(client)
    if chunk < 1:
        raise InputError(f"chunk: wanted at least 1 source a task, got {chunk}")
    given: Any = sources
    if not isinstance(given, SurfacePoints) and not _are_curves(given):
        given = np.asarray(given)
        if given.ndim != 1:
            raise InputError(f"sources: wanted a row of vertices, got an array of shape {given.shape}")
    count = len(given)
    if count == 0:
        raise InputError("sources: wanted at least 1, got none")
    sent, rows = _sent(client, graph), delayed(_fields, pure=False)
    return dask.array.concatenate(
        [
            dask.array.from_delayed(
                rows(sent, _piece(given, first, first + chunk), limit, __version__),
                shape=(min(chunk, count - first), graph.mesh.vertex_count),
                dtype=np.float64,
            )
            for first in range(0, count, chunk)
        ]
    )


def map_meshes(
    client: Client,
    function: Callable[[Mesh, str], Result],
    paths: Iterable[str | Path],
    *,
    retries: int = 2,
    progress: Progress | None = None,
    job: Job | None = None,
) -> list[Result]:
    """Call a function with each of many meshes, such as the frames of an animation, on the workers that read them.

    Parameters
    ----------
    client : distributed.Client
    function : callable
        ``function(mesh, path)``; what it returns is sent back. What it writes should be written beside its place and
        moved there, since a task whose worker dies is done again.
    paths : iterable of str or os.PathLike
        Files that the workers can read.
    retries, progress, job :
        As of `build`.

    Returns
    -------
    list
        What the function returned for each path, in their order.

    Raises
    ------
    Error
        A file cannot be read or the function refuses its mesh: the error begins with the path. What else the function
        raises comes as it is. No other task begins then.
    VersionError
        A worker has another version of the library.
    Cancelled
        The job was cancelled.
    """
    _check_workers(client)
    names = [str(path) for path in paths]
    tasks = client.map(_apply, names, function=function, version=__version__, pure=False, retries=retries)
    return _results(client, tasks, progress, job)


def threads() -> int:
    """How many threads a task may take where it runs: ``saddleback.threads`` of Dask's configuration there, else 1.

    ``DASK_SADDLEBACK__THREADS=8 dask worker --nthreads 1 ...`` is a worker whose tasks take 8 threads, one after the
    other. Functions that `map_meshes` calls pass it on as ``threads=``.
    """
    wanted = dask.config.get("saddleback.threads", 1)
    if isinstance(wanted, int) and wanted >= 1:
        return wanted
    raise InputError(f"saddleback.threads in Dask's configuration: wanted an integer of at least 1, got {wanted!r}")


def _check_workers(client: Client) -> None:
    """Ask by what every Python has: a worker without the library could not read a function of ours."""
    question = "__import__('saddleback').__version__"
    for worker, answer in client.run(eval, question, on_error="return").items():
        if isinstance(answer, ImportError):
            raise InputError(f"client: worker {worker} has no saddleback ({answer}); install {__version__} there")
        if isinstance(answer, str):  # else it died just now
            _check_version(answer, f"client: worker {worker}")


def _check_version(there: str, who: str) -> None:
    if there != __version__:
        raise VersionError(
            f"{who} has saddleback {there}, which may answer otherwise than {__version__} here; install the same on all"
        )


def _sent(client: Client, value: Mesh | SaddleVertexGraph) -> Future[Any]:
    """Make a value known to the scheduler as a task: unlike what is scattered it survives the workers that have it."""
    with dask.config.set({"distributed.admin.large-graph-warning-threshold": "1 TB"}):
        return client.submit(pickle.loads, pickle.dumps(value), pure=False)


def _find(part: int, mesh: Mesh, parts: int, k: int | None, accuracy: float | None, version: str) -> bytes:
    _check_version(version, "the client of this task")
    return find_arcs(mesh, part, parts, k=k, accuracy=accuracy, threads=threads())


def _fields(graph: SaddleVertexGraph, sources: Any, limit: float, version: str) -> np.ndarray[Any, Any]:
    _check_version(version, "the client of this task")
    return graph.fields(sources, limit=limit, threads=threads())


def _are_curves(sources: Any) -> bool:
    return isinstance(sources, Sequence) and any(isinstance(source, SurfaceCurve) for source in sources)


def _piece(sources: Any, begin: int, end: int) -> Any:
    if isinstance(sources, SurfacePoints):
        return SurfacePoints(sources.faces[begin:end], sources.barycentric[begin:end])
    return sources[begin:end]


def _apply(path: str, function: Callable[[Mesh, str], Result], version: str) -> Result:
    _check_version(version, "the client of this task")
    try:
        return function(read_mesh(path), path)
    except Error as error:
        if path in str(error):
            raise
        raise type(error)(f"{path}: {error}") from None


def _results(client: Client, tasks: list[Future[Any]], progress: Progress | None, job: Job | None) -> list[Any]:
    """Wait for all, and forget them where one fails, the job is cancelled, or Ctrl-C comes."""
    finished, done = as_completed(tasks, loop=client.loop), 0
    try:
        while True:
            for task in finished.next_batch(block=False):
                if task.status not in ("finished", "pending"):  # pending: done, and lost again
                    task.result()
                done += 1
            if progress is not None:
                progress(done, len(tasks))
            if job is not None and job.cancelled:
                raise Cancelled("cancelled")
            if done == len(tasks):
                return client.gather(tasks)
            time.sleep(_SECONDS_BETWEEN_LOOKS)
    except BaseException:
        client.cancel(tasks, force=True)
        raise
