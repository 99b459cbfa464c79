# SPDX-License-Identifier: MIT
"""The command line, as a new user would try it: on good meshes, broken ones, with wrong names and in scripts."""

from __future__ import annotations

import json
import os
import re
import shlex
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

import saddleback as sb
from saddleback import command_line
from tests import meshes

ROOT = Path(__file__).resolve().parents[3]
VERBS = {"bench", "cells", "check", "completion", "distance", "distribute", "field", "graph", "info", "path", "repair"}
VERBS |= {"voronoi2d"}
TIMEOUT = 100


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with what a user might have."""
    monkeypatch.chdir(tmp_path)
    sb.write_mesh("good.ply", meshes.grid(12, 12, jitter=0.3))
    sb.write_mesh("ball.obj", meshes.icosphere(2))
    vertices, triangles = meshes.grid(6, 6)
    sb.write_mesh("broken.ply", (vertices, np.vstack([triangles, triangles[:2]])))
    sb.write_mesh("two.ply", meshes.two_components())
    Path("notes.ply").write_text("ply? no, a shopping list\n")
    Path("picture.png").write_bytes(b"\x89PNG")
    Path("a folder.ply").mkdir()
    for frame in (8, 9, 10):
        sb.write_mesh(f"frame.{frame:04}.ply", meshes.grid(6, 6, jitter=0.03 * frame))
    return tmp_path


def ask(capsys: Any, *words: str) -> tuple[int, str, str]:
    """The exit code, what it said, and what it complained of; words are parted as a shell does."""
    code = command_line.run([part for word in words for part in shlex.split(word)])
    out, err = capsys.readouterr()
    return code, out, err


def summary(capsys: Any, *words: str) -> dict[str, Any]:
    code, out, err = ask(capsys, *words, "--json")
    assert (code, err) == (0, "")
    found: dict[str, Any] = json.loads(out)
    return found


def is_one_sentence(err: str) -> bool:
    return err.startswith("saddleback: error: ") and err.count("\n") == 1 and "Traceback" not in err


def in_a_shell(*words: str, **more: Any) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "saddleback", *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=TIMEOUT, check=False, **more)


def test_help_lists_every_verb_and_each_has_its_own(capsys) -> None:
    code, out, _ = ask(capsys, "--help")
    listed = re.findall(r"^  (\w+)  ", out.split("Verbs:")[1].split("Options:")[0], re.MULTILINE)
    assert code == 0
    assert set(listed) == VERBS
    for verb in VERBS:
        code, out, _ = ask(capsys, verb, "--help")
        assert code == 0
        assert out.startswith(f"Usage: saddleback {verb} ")
    assert ask(capsys, "--version")[1].strip() == f"saddleback {sb.__version__}"


def test_the_examples_of_the_page_run(tmp_path: Path) -> None:
    """All of them, in order, by the installed name's way in."""
    sb.write_mesh("lizard.ply", meshes.saddle(25))
    sb.write_mesh("broken.obj", meshes.grid(5, 5))
    for frame in (1, 2, 3):
        sb.write_mesh(f"frame.{frame:04}.ply", meshes.grid(12, 12, jitter=0.1 * frame))
    page = (ROOT / "docs/python/command_line.md").read_text(encoding="utf-8")
    lines = [line for block in re.findall(r"```sh\n(.*?)```", page, re.DOTALL) for line in block.splitlines()]
    assert len(lines) >= 11
    for line in lines:
        name, *words = line.split()
        assert name == "saddleback"
        assert command_line.run(words) == 0, line
    assert {path.name for path in tmp_path.glob("cells.*")} >= {"cells.ply", "cells.0003.ply", "cells.npz", "cells.svg"}


def test_info_tells_what_a_mesh_is_and_what_is_wrong(capsys) -> None:
    code, out, _ = ask(capsys, "info", "good.ply", "broken.ply", "--json")
    good, broken = map(json.loads, out.splitlines())
    mesh = sb.read_mesh("good.ply")
    assert code == 1
    assert (good["vertices"], good["genus"], good["area"]) == (mesh.vertex_count, 0, mesh.area)
    assert not broken["valid"]
    assert "repeats face" in broken["fault"]
    assert "saddleback repair broken.ply" in broken["remedy"]


def test_repair(capsys) -> None:
    told = summary(capsys, "repair", "broken.ply", "-o", "mended.ply.gz")
    assert told["written"] == ["mended.ply.gz"]
    assert sb.read_mesh("mended.ply.gz") == sb.repair(*sb.read_arrays("broken.ply"))[0]


def test_distance_by_graph_file_and_exactly(capsys) -> None:
    mesh = sb.read_mesh("good.ply")
    summary(capsys, "graph", "good.ply", "-o", "good.graph", "--k", "30")
    told = summary(capsys, "distance", "good.ply", "--from", "0,5", "--graph", "good.graph", "-o", "d.npy")
    wanted = sb.SaddleVertexGraph(mesh, k=30).distances([0, 5])
    assert (np.load("d.npy") == wanted).all()
    assert told["farthest"] == wanted.max()
    assert wanted[told["farthest_vertex"]] == wanted.max()
    summary(capsys, "distance", "good.ply", "--from-place", "0.1,0.2,0", "--exact", "-o", "d.ply")
    exact = sb.exact_distances(mesh, sb.project(mesh, [(0.1, 0.2, 0)]))
    shown = trimesh.load("d.ply", process=False)
    assert (shown.vertices == mesh.vertices).all()
    assert (shown.metadata["_ply_raw"]["vertex"]["data"]["distance"].ravel() == exact).all()
    assert (
        json.loads(Path("d.json").read_text())["distance"]
        if ask(capsys, "distance", "two.ply", "--from", "0", "-o", "d.json")
        else True
    )
    assert None in json.loads(Path("d.json").read_text())["distance"]  # the other part is out of reach


def test_a_limit_below_which_there_is_no_vertex(capsys) -> None:
    told = summary(capsys, "distance", "good.ply", "--from-place", "0.501,0.502,0", "--limit", "1e-9")
    assert (told["reached"], told["farthest"], told["farthest_vertex"], told["mean"]) == (0, None, None, None)


def test_graphs_in_parts_are_the_same_file(capsys) -> None:
    summary(capsys, "graph good.ply --k 30 -o whole.graph")
    for part in (1, 2, 3):
        summary(capsys, f"graph good.ply --k 30 --part {part}/3 -o {part}.arcs")
    summary(capsys, "graph good.ply --merge 3.arcs 1.arcs 2.arcs -o merged.graph")
    assert Path("merged.graph").read_bytes() == Path("whole.graph").read_bytes()
    for words in ("--merge 1.arcs 2.arcs", "--merge 1.arcs 1.arcs 2.arcs 3.arcs", "--merge 1.arcs 2.arcs notes.ply"):
        code, _, err = ask(capsys, f"graph good.ply {words} -o again.graph")
        assert code == 1
        assert is_one_sentence(err), err
    for words in ("--part 4/3", "--part 0/3", "--part three", "--merge", "1.arcs", "--part 1/3 --exact"):
        assert ask(capsys, f"graph good.ply {words}")[0] == 2, words
    assert not Path("again.graph").exists()


def test_path(capsys) -> None:
    mesh = sb.read_mesh("ball.obj")
    told = summary(capsys, "path", "ball.obj", "--from", "0", "--to", "9", "-o", "way.obj")
    assert told["length"] == sb.SaddleVertexGraph(mesh).path(0, 9).length
    lines = Path("way.obj").read_text().splitlines()
    points = np.array([line.split()[1:] for line in lines if line.startswith("v ")], float)
    assert np.linalg.norm(np.diff(points, axis=0), axis=1).sum() == pytest.approx(told["length"], rel=1e-12)
    assert summary(capsys, "path", "ball.obj", "--from", "0", "--to", "9", "--exact")["length"] <= told["length"]
    code, _, err = ask(capsys, "path", "two.ply", "--from", "0", "--to", "-1")
    assert code != 0
    last = str(sb.read_mesh("two.ply").vertex_count - 1)
    code, _, err = ask(capsys, "path", "two.ply", "--from", "0", "--to", last)
    assert code == 1
    assert is_one_sentence(err)


def test_cells(capsys) -> None:
    mesh = sb.read_mesh("good.ply")
    told = summary(
        capsys,
        "cells good.ply --count 12 --seed 3 -o c.npz --split s.ply --dual d.obj --edges e.ply",
    )
    even = sb.centroidal_voronoi(sb.SaddleVertexGraph(mesh), count=12, seed=3)
    with np.load("c.npz") as numbers:
        assert (numbers["vertex_cell"] == even.cells.vertex_cell).all()
        assert (numbers["areas"] == even.cells.areas).all()
    split = trimesh.load("s.ply", process=False)
    assert (split.metadata["_ply_raw"]["face"]["data"]["cell"].ravel() == even.cells.split().triangle_cell).all()
    assert (sb.read_arrays("d.obj")[1] == even.cells.dual().triangles).all()
    assert told["cells"] == 12
    Path("sites.txt").write_text("0\n50\n70\n")
    summary(capsys, "cells", "good.ply", "--sites", "sites.txt", "-o", "given.json")
    given = json.loads(Path("given.json").read_text())
    wanted = sb.geodesic_voronoi(sb.SaddleVertexGraph(mesh), [0, 50, 70])
    assert given["vertex_cell"] == wanted.vertex_cell.tolist()


def test_voronoi2d(capsys) -> None:
    sites = np.random.default_rng(0).random((20, 2))
    np.savetxt("sites.csv", sites, delimiter=",")
    told = summary(capsys, "voronoi2d sites.csv --domain 0,0,1,1 -o v.json")
    found = json.loads(Path("v.json").read_text())
    assert np.isclose(sum(found["areas"]), 1)
    assert told["vertices"] == len(sb.voronoi_2d(sites).vertices)
    summary(capsys, "voronoi2d", "sites.csv", "-o", "v.svg")
    assert Path("v.svg").read_text().count("<circle") == 20


def test_field_distribute_and_check(capsys) -> None:
    told = summary(capsys, "field ball.obj --singularity 0:1 --singularity 5:1 -o f.npz")
    assert told["singularities"] == {"0": 1.0, "5": 1.0}
    told = summary(
        capsys,
        "distribute ball.obj --shape star --count 5 --size 0.2 -o p.json --cut c.ply",
    )
    assert told["copies"] == 5
    assert summary(capsys, "check ball.obj --placements p.json --samples 10000")["ok"]
    laid = json.loads(Path("p.json").read_text())
    for key in ("shape", "face", "barycentric", "angle", "scale", "mirrored"):
        laid[key] += laid[key][:1]  # one twice
    Path("p.json").write_text(json.dumps(laid))
    code, out, err = ask(capsys, "check ball.obj --placements p.json --samples 10000")
    assert (code, err) == (3, "")
    assert "0 and 5" in out


def test_bench_and_completion(capsys) -> None:
    told = summary(capsys, "bench good.ply --repeat 1 --cells 5")
    assert all(value > 0 for key, value in told.items() if key.endswith("_seconds"))
    for shell in ("bash", "zsh", "fish"):
        assert "_SADDLEBACK_COMPLETE" in ask(capsys, "completion", shell)[1]
    os.environ |= {"COMP_WORDS": "saddleback dis", "COMP_CWORD": "1"}
    done = in_a_shell(env=os.environ | {"_SADDLEBACK_COMPLETE": "bash_complete"})
    assert "plain,distance" in done.stdout


def test_frames(capsys, tmp_path: Path) -> None:
    words = ["distance", "frame.####.ply", "--from", "0", "-o", "d.####.npy"]
    code, out, _ = ask(capsys, *words, "--json")
    assert code == 0
    assert [json.loads(line)["frame"] for line in out.splitlines()] == [8, 9, 10]
    for frame in (8, 9, 10):
        mesh = sb.read_mesh(f"frame.{frame:04}.ply")
        assert (np.load(f"d.{frame:04}.npy") == sb.SaddleVertexGraph(mesh).distances(0)).all()
    Path("d.0009.npy").unlink()
    code, out, err = ask(capsys, *words)
    assert code == 1
    assert "d.0008.npy exists; --force" in err
    assert not Path("d.0009.npy").exists()  # nothing is begun that cannot be ended
    code, out, _ = ask(capsys, *words, "--resume", "--json")
    assert [json.loads(line)["frame"] for line in out.splitlines()] == [9]
    assert ask(capsys, *words, "--resume") == (0, "the files of all frames are there\n", "")
    assert summary(capsys, *words, "--force", "--frames", "10")["frame"] == 10
    code, _, err = ask(capsys, *words, "--frames", "10-11", "--force")
    assert code == 1
    assert is_one_sentence(err)
    assert "frame.0011.ply" in err


def test_frames_in_a_folder_whose_name_has_brackets(capsys) -> None:
    Path("take[2]").mkdir()
    Path("take[2]/frame.0007.ply").write_bytes(Path("good.ply").read_bytes())
    assert summary(capsys, "distance", "take[2]/frame.####.ply", "--from", "0")["frame"] == 7


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("distance nowhere.ply --from 0", "nowhere.ply cannot be opened"),
        ("distance notes.ply --from 0", "notes.ply"),
        ("distance picture.png --from 0", 'the extension "png"; wanted obj, ply, off or stl'),
        ("distance broken.ply --from 0", "broken.ply: .*repeats face.*--repair"),
        ("cells broken.ply --count 3 -o out.ply", "--repair mends it"),
        ("distance good.ply --from 999", "999"),
        ("distance good.ply --from -3", "-3"),
        ("distance good.ply --from 0 -o good.ply", "good.ply exists; --force overwrites it"),
        ("distance good.ply --from 0 -o out.xyz", "out.xyz: wanted one of ply, npz, npy, json"),
        ("distance good.ply --from 0 -o out.npy.gz", "wanted one of"),
        ("distance good.ply --from 0 -o nowhere/out.ply", "there is no folder nowhere"),
        ("distance good.ply --from 0 --graph nothing.graph", "nothing.graph"),
        ("distance good.ply --from 0 --graph notes.ply", "is no saddleback graph"),
        ("distance good.ply --from 0 --accuracy 7", "accuracy"),
        ("distance good.ply --from 0 --device cuda:7", "(?i)cuda"),
        ("cells good.ply --sites notes.ply", "holds no numbers"),
        ("cells two.ply --count 1", "connected|parts|component"),
        ("cells good.ply --count 3 --density notes.ply", "holds no numbers"),
        ("voronoi2d notes.ply", "holds no numbers"),
        ("voronoi2d good.npy", "good.npy"),
        ("check good.ply --placements notes.ply", "not a file of placements"),
        ("distribute good.ply --size 1e9", "larger|size"),
        ("field good.ply --singularity 0:9", "0"),
        ("info notes.ply", "notes.ply"),
        ("distance shot.####.ply --from 0", "there is no such frame"),
    ],
)
def test_what_fails_is_one_sentence(capsys, line: str, said: str) -> None:
    before = sorted(os.listdir())
    code, out, err = ask(capsys, *line.split())
    assert code == 1, (out, err)
    assert is_one_sentence(err), err
    assert re.search(said, err), err
    assert sorted(os.listdir()) == before


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["disstance", "good.ply"], "'disstance' is no verb"),
        (["distance"], "Usage"),
        (["distance", "good.ply"], "--from VERTICES or --from-place X,Y,Z"),
        (["distance", "good.ply", "--from", "nose"], "--from: wanted whole numbers"),
        (["distance", "good.ply", "--from-place", "1,2"], "wanted 3 numbers"),
        (["distance", "good.ply", "--form", "0"], "--form"),
        (["cells", "good.ply"], "either --count N or --sites FILE"),
        (["cells", "good.ply", "--count", "0"], "--count"),
        (["path", "good.ply", "--from", "0,1", "--to", "3"], "--from: wanted one point, got 2"),
        (["distance", "good.ply", "--from", "0", "--frames", "1-3"], "name with hashes"),
        (["distance", "frame.####.ply", "--from", "0", "--frames", "3-1"], "wanted 7, 1-240 or 1-240:5"),
        (["distance", "frame.####.ply", "--from", "0", "-o", "one.npy"], "frames would overwrite each other"),
        (
            ["cells", "good.ply", "--count", "3", "--split", "a.ply", "--dual", "a.ply"],
            "two outputs have the same name",
        ),
        (["voronoi2d"], "Usage"),
        (["voronoi2d", "--count", "9", "--domain", "1,0,0,1"], "wanted X0 below X1"),
    ],
)
def test_a_wrong_command_line_is_told_by_its_own_code(capsys, words: list[str], said: str) -> None:
    code, out, err = ask(capsys, *words)
    assert code == 2
    assert said in err + out
    assert "Traceback" not in err


def test_a_folder_is_no_file(capsys) -> None:
    code, _, err = ask(capsys, "distance", "'a folder.ply'", "--from", "0")
    assert code == 1
    assert "is a folder" in err
    code, _, err = ask(capsys, "distance", "good.ply", "--from", "0", "-o", "'a folder.ply'", "--force")
    assert code == 1
    assert "a folder.ply is a folder; give a file" in err


def test_force_replaces_whole_files_only(capsys) -> None:
    Path("d.npy").write_text("old")
    code, _, _err = ask(capsys, "distance", "broken.ply", "--from", "0", "-o", "d.npy", "--force")
    assert (code, Path("d.npy").read_text()) == (1, "old")
    summary(capsys, "distance", "broken.ply", "--repair", "--from", "0", "-o", "d.npy", "--force")
    assert np.load("d.npy").shape == (36,)


def test_warnings_are_sentences() -> None:
    Path("bow.obj").write_text("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nv 2 2 0\nf 1 2 3 4\nf 2 5 3\n")
    err = in_a_shell("info", "bow.obj").stderr
    assert err.startswith("saddleback: warning: bow.obj")
    assert err.count("\n") == 1


def seconds_of(process: int) -> float:
    """Time of the processor that it has had."""
    return int(Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[11]) / os.sysconf("SC_CLK_TCK")


@pytest.mark.skipif(sys.platform != "linux", reason="looks into /proc; CI runs it on Linux")
def test_ctrl_c_ends_it_soon_and_leaves_nothing(tmp_path: Path) -> None:
    sb.write_mesh("large.ply", meshes.icosphere(6))
    words = "cells large.ply --count 2000 --iterations 5000 --accuracy 1e-3 --threads 1 -o cells.npz"
    child = subprocess.Popen([sys.executable, "-m", "saddleback", *words.split()], stderr=subprocess.PIPE, text=True)
    while child.poll() is None and seconds_of(child.pid) < 2:  # it is at work then, and for long
        time.sleep(0.1)
    child.send_signal(signal.SIGINT)
    begin = time.monotonic()
    _, err = child.communicate(timeout=TIMEOUT)
    assert child.returncode == 130
    assert err == "saddleback: interrupted\n"
    assert time.monotonic() - begin < 5
    assert not [name for name in os.listdir() if "cells" in name]


@pytest.mark.skipif(sys.platform == "win32", reason="closed pipes are other errors there; CI runs it on Linux")
def test_a_closed_pipe_is_told(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "saddleback", "info", *["good.ply"] * 50]
    to_read, to_write = os.pipe()
    os.close(to_read)
    done = subprocess.run(command, stdout=to_write, stderr=subprocess.PIPE, text=True, timeout=TIMEOUT, check=False)
    os.close(to_write)
    assert done.returncode == 141
    assert done.stderr == "saddleback: the pipe was closed before everything was said\n"


def test_without_click_it_says_what_is_missing() -> None:
    code = "import sys; sys.modules['click'] = None; import saddleback; from saddleback.command_line import main"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "needs click, which is not here; pip install click" in done.stderr


def test_help_is_there_at_once() -> None:
    """No verb's module is imported for it, and nothing that is heavy: its time is that of importing the package."""
    code = (
        "import sys\nfrom saddleback.command_line import run\nrun(['--help'])\n"
        "wrong = {'scipy', 'pyvista', 'matplotlib', 'saddleback.command_line.runs', 'asyncio', 'tempfile'}\n"
        "print(sorted(wrong & set(sys.modules)), file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr == "[]\n"
