# SPDX-License-Identifier: MIT
"""What all verbs share: a mesh or a range of frames in, files out that are whole or not there, one summary."""

from __future__ import annotations

import functools
import glob
import io
import json
import os
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

import click
import numpy as np

import saddleback as sb
from saddleback._saddleback import _write_file

Summary = dict[str, Any]
_HASHES = re.compile(r"#+")


class Failure(click.ClickException):
    """One sentence, and the exit code of what failed."""

    def show(self, file: Any = None) -> None:
        """Print the sentence."""
        click.echo(f"saddleback: error: {self.message}", err=True)


def fill(pattern: str, frame: int | None) -> str:
    """Returns the name of a frame: its number stands for the hashes, with as many digits at least."""
    return pattern if frame is None else _HASHES.sub(lambda run: str(frame).zfill(len(run[0])), pattern)


def frames_of(pattern: str, wanted: str | None) -> list[int | None]:
    """Returns the numbers of the frames: those wanted (1-240, or 1-240:5), else those that there are."""
    if not _HASHES.search(os.path.basename(pattern)):
        if wanted:
            raise click.UsageError(f"--frames needs a name with hashes, such as frame.####.ply, not {pattern}")
        return [None]
    if len(_HASHES.findall(pattern)) > 1:
        raise click.UsageError(f"{pattern}: wanted one run of hashes")
    if wanted is None:
        before, after = _HASHES.split(pattern)
        names = glob.glob(f"{glob.escape(before)}*{glob.escape(after)}")
        numbers = [name[len(before) : len(name) - len(after)] for name in names]
        found = sorted(int(number) for number in numbers if number.isdigit())
        if not found:
            raise Failure(f"{pattern}: there is no such frame")
        return list(found)
    match = re.fullmatch(r"(\d+)(?:-(\d+))?(?::(\d+))?", wanted)
    if not match or (match[3] and int(match[3]) == 0) or (match[2] and int(match[2]) < int(match[1])):
        raise click.UsageError(f"--frames: wanted 7, 1-240 or 1-240:5, got {wanted}")
    return list(range(int(match[1]), int(match[2] or match[1]) + 1, int(match[3] or 1)))


def check_output(name: str, formats: tuple[str, ...], is_forced: bool) -> None:
    """Refuse what could not be written, before anything is computed."""
    plain = name[:-3] if name.lower().endswith(".gz") else name
    extension = os.path.splitext(plain)[1][1:].lower()
    if formats and (extension not in formats or (plain != name and extension not in ("ply", "obj"))):
        raise Failure(f"{name}: wanted one of {', '.join(formats)}, got {extension!r}")
    if os.path.isdir(name):
        raise Failure(f"{name} is a folder; give a file")
    folder = os.path.dirname(name) or "."
    if not os.path.isdir(folder):
        raise Failure(f"{name}: there is no folder {folder}")
    if os.path.lexists(name) and not is_forced:
        raise Failure(f"{name} exists; --force overwrites it")


@dataclass
class Run:
    """One frame, or the only one: what is read, what is to be written."""

    source: str
    out: Mapping[str, str | None]
    options: Mapping[str, Any]
    job: sb.Job | None = None
    read: dict[str, Any] = field(default_factory=dict)

    @functools.cached_property
    def mesh(self) -> sb.Mesh:
        """The mesh, repaired if that is wanted."""
        if self.options.get("repair"):
            mesh, report = sb.repair(*sb.read_arrays(self.source, job=self.job), job=self.job)
            self.read["repair"] = report.changes
            return mesh
        try:
            return sb.read_mesh(self.source, job=self.job)
        except sb.MeshError as error:
            raise Failure(
                f"{fault_of(self.source, error)}; --repair mends it on the way, `saddleback repair` writes it mended"
            ) from None

    @functools.cached_property
    def graph(self) -> sb.SaddleVertexGraph:
        """The graph given as a file, or one built as the options say."""
        if self.options.get("graph"):
            return sb.SaddleVertexGraph.load(
                fill(self.options["graph"], self.options["frame"]), self.mesh, job=self.job
            )
        keys = ("accuracy", "k", "exact", "threads", "device")
        given = {key: self.options[key] for key in keys if self.options.get(key) is not None}
        return sb.SaddleVertexGraph(self.mesh, **given, job=self.job)

    def points(self, vertices: str | None, places: tuple[str, ...], what: str) -> Any:
        """Vertices by number, or places of space brought to the surface."""
        if bool(vertices) == bool(places):
            raise click.UsageError(f"wanted either --{what} VERTICES or --{what}-place X,Y,Z")
        if vertices:
            return np.array(whole_numbers(vertices, f"--{what}"), dtype=np.int64)
        return sb.project(self.mesh, np.array([reals(place, 3, f"--{what}-place") for place in places]))


def fault_of(name: str, error: Exception) -> str:
    """Returns what is wrong with a mesh, without what a script would call."""
    text = str(error).replace("; saddleback.repair mends this", "")
    return text if name in text else f"{name}: {text}"


def whole_numbers(text: str, what: str) -> list[int]:
    """Returns whole numbers parted by commas."""
    try:
        return [int(part) for part in text.split(",")]
    except ValueError:
        raise click.UsageError(f"{what}: wanted whole numbers parted by commas, got {text}") from None


def reals(text: str, count: int, what: str) -> list[float]:
    """Returns so many numbers parted by commas."""
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) != count:
        raise click.UsageError(f"{what}: wanted {count} numbers parted by commas, got {text}")
    return values


def read_numbers(name: str, what: str) -> np.ndarray[Any, Any]:
    """Returns the array of an npy file, the only one of an npz file, or the rows of a text file."""
    extension = os.path.splitext(name)[1].lower()
    try:
        if extension == ".npy":
            return np.asarray(np.load(name, allow_pickle=False))
        if extension == ".npz":
            with np.load(name, allow_pickle=False) as arrays:
                if len(arrays.files) != 1:
                    raise Failure(f"{what}: {name} holds {', '.join(arrays.files)}; wanted one array")
                return np.asarray(arrays[arrays.files[0]])
        return np.loadtxt(name, delimiter="," if extension == ".csv" else None, ndmin=1)
    except (ValueError, EOFError) as error:
        raise Failure(f"{what}: {name} holds no numbers ({error})") from None


def save_numbers(name: str, arrays: Mapping[str, Any]) -> None:
    """Write arrays as npz, npy (the first of them) or json."""
    extension = os.path.splitext(name)[1].lower()
    contents = io.BytesIO()
    if extension == ".npz":
        np.savez_compressed(contents, **arrays)
    elif extension == ".npy":
        np.save(contents, next(iter(arrays.values())))
    else:
        contents.write((json.dumps({key: plain(value) for key, value in arrays.items()}) + "\n").encode())
    save(name, contents.getvalue())


def save(name: str, contents: bytes | str) -> None:
    """Write a file whole, or leave what was there."""
    _write_file(name, contents.encode() if isinstance(contents, str) else contents)


def plain(value: Any) -> Any:
    """Returns what JSON holds: numbers that it has no word for become null."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if isinstance(value, dict):
        return {str(key): plain(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    return None if isinstance(value, float) and (value != value or abs(value) == float("inf")) else value


def say(summary: Summary, as_json: bool) -> None:
    """Print a summary: one line of JSON, or a line for each of its parts."""
    if as_json:
        click.echo(json.dumps(plain(summary)))
        return
    width = max(map(len, summary), default=0)
    for key, value in summary.items():
        click.echo(f"{key.replace('_', ' '):<{width}}  {_in_words(value)}")


def _in_words(value: Any) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, dict):
        return ", ".join(f"{key} {_in_words(part)}" for key, part in value.items()) or "nothing"
    if isinstance(value, list | tuple):
        return ", ".join(map(_in_words, value)) or "none"
    return "none" if value is None else str(value)


@contextmanager
def watched(is_quiet: bool) -> Iterator[sb.Job]:
    """A job with a bar on stderr, or without."""
    if is_quiet:
        yield sb.Job()
    else:
        with sb.progress_bar() as job:
            yield job


Option = Callable[[Any], Any]
JSON = click.option("--json", "as_json", is_flag=True, help="Print one line of JSON for programs.")
QUIET = click.option("-q", "--quiet", is_flag=True, help="Draw no progress bar.")
FORCE = click.option("--force", is_flag=True, help="Overwrite files that exist.")
THREADS = click.option("--threads", type=click.IntRange(0), default=0, help="Threads; 0: all cores.")
_SHARED = (
    click.option(
        "--frames", metavar="A-B[:STEP]", help="Frames of a name with hashes, frame.####.ply; else all of them."
    ),
    click.option("--resume", is_flag=True, help="Leave out frames whose files are all there."),
    FORCE,
    click.option("--repair", is_flag=True, help="Repair the mesh on the way in."),
    JSON,
    QUIET,
)
GRAPH = (
    click.option("--graph", metavar="FILE", help="Use this graph of the mesh, as the verb graph wrote it."),
    click.option("--accuracy", type=float, help="Largest relative error of distances.  [default: 0.005]"),
    click.option("--k", type=int, help="Vertices per geodesic disk, instead of an accuracy."),
    click.option("--device", help="auto, cpu, cuda, cuda:1, ..."),
    THREADS,
)


def output(*names: str, formats: tuple[str, ...], help: str) -> Option:
    """An option that names a file to be written, and which kinds of files it may be."""

    def decorate(body: Any) -> Any:
        parameter = names[-1].lstrip("-").replace("-", "_")
        body.outputs = {**getattr(body, "outputs", {}), parameter: formats}
        return click.option(*names, metavar="FILE", help=f"{help} ({', '.join(formats)})")(body)

    return decorate


def verb(*options: Option) -> Callable[[Callable[..., Summary | int]], click.Command]:
    """Make a verb of a function that does one frame: it takes a Run and its own options, and returns a summary."""

    def decorate(body: Any) -> click.Command:
        for option in reversed((*options, *_SHARED)):
            option(body)
        outputs: dict[str, tuple[str, ...]] = getattr(body, "outputs", {})

        @functools.wraps(body)
        def each(
            mesh: str, frames: str | None, resume: bool, force: bool, as_json: bool, quiet: bool, **own: Any
        ) -> int:
            patterns = {key: own.pop(key) for key in outputs}
            numbers = frames_of(mesh, frames)
            files = _files(numbers, patterns, outputs, resume, force)
            if not files and not as_json:
                click.echo("the files of all frames are there")
            worst = 0
            for frame, out in files:
                source = fill(mesh, frame)
                with watched(quiet or as_json) as job:
                    one = Run(source, out, {**own, "frame": frame}, job)
                    summary = body(one, **{key: own[key] for key in own if key in body.wants})
                worst = max(worst, summary.pop("exit_code", 0))
                head = {"frame": frame} if frame is not None else {}
                written = [name for name in out.values() if name]
                say(
                    {**head, "mesh": source, **one.read, **summary, **({"written": written} if written else {})},
                    as_json,
                )
            return worst

        names = body.__code__.co_varnames[: body.__code__.co_argcount + body.__code__.co_kwonlyargcount]
        body.wants = set(names[1:])
        argument = click.argument("mesh", metavar="MESH")
        return click.command(body.__name__, help=body.__doc__, no_args_is_help=True)(argument(each))

    return decorate


def _files(
    numbers: list[int | None],
    patterns: Mapping[str, str | None],
    outputs: Mapping[str, tuple[str, ...]],
    is_resumed: bool,
    is_forced: bool,
) -> list[tuple[int | None, dict[str, str | None]]]:
    """Returns the names of what each frame writes, all of which can be written."""
    found = []
    for frame in numbers:
        out = {key: fill(pattern, frame) if pattern else None for key, pattern in patterns.items()}
        named = {key: name for key, name in out.items() if name}
        if is_resumed and named and all(map(os.path.isfile, named.values())):
            continue
        for key, name in named.items():
            if frame is not None and name == patterns[key]:
                raise click.UsageError(f"{name}: frames would overwrite each other; wanted hashes for their numbers")
            check_output(name, outputs[key], is_forced)
        if len(set(named.values())) < len(named):
            raise click.UsageError("two outputs have the same name")
        found.append((frame, out))
    return found
