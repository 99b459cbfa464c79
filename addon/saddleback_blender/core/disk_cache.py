# SPDX-License-Identifier: GPL-3.0-or-later
"""Distance graphs kept in a folder, by content: what was built in one session needs no building in the next.

A file that cannot be used is built again; what went wrong becomes a note, never an error, for the run itself needs no
file. One of a newer version stays: it is of use to the Blender that wrote it.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import native

SUFFIX = ".saddleback"
# What the library leaves when Blender is killed while it writes, and when such a file can belong to nobody any more.
PARTIAL, PARTIAL_SECONDS = ".saddleback-*.partial", 3600.0


@dataclass(frozen=True)
class DiskCache:
    """Graphs in `folder`; those not used for longest go first when the sum of their sizes passes `limit` bytes."""

    folder: Path
    limit: int

    def path(self, name: str) -> Path:
        """The file of a graph."""
        return self.folder / (name + SUFFIX)

    def has(self, name: str) -> bool:
        """Tells whether there is such a file, usable or not; none where one may not look, or the name is too long."""
        return os.path.isfile(self.path(name))

    def load(self, name: str, mesh: Any, job: Any, note: Callable[[str], None]) -> Any | None:
        """The graph of that name for `mesh`, None where there is none that can be used."""
        path, sb = self.path(name), native.load()
        if not self.has(name):
            return None
        try:
            graph = sb.SaddleVertexGraph.load(path, mesh, job=job)
        except sb.VersionError as error:
            note(f"The distance graph kept on disk is left to the newer version that wrote it ({error})")
            return None
        except sb.InputError as error:
            note(f"The distance graph kept on disk could not be used and is built again ({error})")
            with contextlib.suppress(OSError):
                path.unlink()
            return None
        with contextlib.suppress(OSError):
            os.utime(path)  # used now: it goes last
        return graph

    def save(self, name: str, graph: Any, job: Any, note: Callable[[str], None]) -> None:
        """Keeps a graph, and makes room for it."""
        sb = native.load()
        if graph.nbytes > self.limit:
            note(
                f"The distance graph takes {graph.nbytes / 2**20:.0f} MB and was not kept on disk, where "
                f"{self.limit / 2**20:.0f} MB are allowed (preferences)"
            )
            return
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            graph.save(self.path(name), job=job)
        except sb.InputError as error:
            note(f"The distance graph could not be kept on disk ({error})")
            return
        except OSError as error:
            note(
                f"The distance graph could not be kept on disk ({self.folder} cannot be made: {error.strerror}; choose "
                "another cache folder in the preferences)"
            )
            return
        self.trim(spared=self.path(name))

    def trim(self, spared: Path | None = None) -> int:
        """Removes the files not used for longest until the rest keeps the limit; returns how many went."""
        files = []
        for path in self._files("*" + SUFFIX):
            with contextlib.suppress(OSError):  # another Blender may remove it meanwhile
                status = path.stat()
                files.append((path == spared, status.st_mtime_ns, path.name, status.st_size, path))
        for path in self._files(PARTIAL):
            with contextlib.suppress(OSError):
                if time.time() - path.stat().st_mtime > PARTIAL_SECONDS:
                    path.unlink()
        total = sum(size for *_, size, _ in files)
        removed = 0
        for *_, size, path in sorted(files):
            if total <= self.limit:
                break
            with contextlib.suppress(OSError):
                path.unlink()
                removed += 1
            total -= size
        return removed

    def _files(self, pattern: str) -> list[Path]:
        try:
            return list(self.folder.glob(pattern))
        except OSError:  # a folder that cannot be read, whatever the reason
            return []

    def clear(self) -> int:
        """Removes all graphs, and nothing else; returns how many there were."""
        return DiskCache(self.folder, -1).trim()
