"""Signals in the midst of writing: the old file stays, and nothing lies beside it."""

from __future__ import annotations

import shutil
import signal
from itertools import cycle
from pathlib import Path

import numpy as np
import pytest
from stopped import STOPS, begun, ended, wait_until_stopped

import liftmesh
from liftmesh import Cloud
from liftmesh.cli import exit_codes
from liftmesh.io import atomic

LIBRARY = f"""{STOPS}
import sys
import numpy as np
import liftmesh
from liftmesh.io import atomic
if sys.argv[1] == "named":  # as on a file system without nameless files
    atomic.NAMELESS = 0
liftmesh.write("mesh.obj", np.random.default_rng(0).random((600_000, 3)))
"""
COMMAND_LINE = f"""{STOPS}
import sys
from liftmesh.cli import main
from liftmesh.io import atomic
if sys.argv[1] == "named":
    atomic.NAMELESS = 0
sys.exit(main(["triangulate", "../cloud.npy", "mesh.obj", "--overwrite"]))
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("kill")
    np.save(folder / "cloud.npy", np.random.default_rng(0).random((300_000, 3)))
    return folder


@pytest.fixture
def folder(place: Path) -> Path:
    inner = place / "inner"
    shutil.rmtree(inner, ignore_errors=True)
    inner.mkdir()
    (inner / "mesh.obj").write_bytes(b"old")
    return inner


def names_in(folder: Path) -> list[str]:
    return sorted(each.name for each in folder.iterdir())


@pytest.mark.parametrize(
    ("program", "sent", "codes", "complaint"),
    [
        (LIBRARY, signal.SIGKILL, {-signal.SIGKILL}, ""),
        (LIBRARY, signal.SIGTERM, {-signal.SIGTERM}, ""),
        (LIBRARY, signal.SIGINT, {-signal.SIGINT}, "KeyboardInterrupt"),
        (COMMAND_LINE, signal.SIGKILL, {-signal.SIGKILL}, ""),
        (COMMAND_LINE, signal.SIGTERM, {exit_codes.TERMINATED}, "terminated by SIGTERM"),
        (COMMAND_LINE, signal.SIGINT, {exit_codes.INTERRUPTED}, "error: interrupted"),
    ],
    ids=["library KILL", "library TERM", "library INT", "KILL", "TERM", "INT"],
)
def test_a_signal_amid_writing_leaves_the_old_file_alone(
    program: str, sent: int, codes: set[int], complaint: str, folder: Path
) -> None:
    child = begun("nameless", cwd=folder, program=program)
    wait_until_stopped(child)
    code, out, err = ended(child, sent)
    assert code in codes
    assert out == ""
    assert complaint in err
    assert names_in(folder) == ["mesh.obj"]
    assert (folder / "mesh.obj").read_bytes() == b"old"


@pytest.mark.parametrize("sent", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_without_nameless_files_only_what_cannot_be_heard_leaves_a_part(
    sent: int, folder: Path
) -> None:
    child = begun("named", cwd=folder, program=COMMAND_LINE)
    wait_until_stopped(child)
    ended(child, sent)
    debris = [name for name in names_in(folder) if name != "mesh.obj"]
    assert len(debris) == (1 if sent == signal.SIGKILL else 0)
    assert all(name.startswith(".liftmesh-") for name in debris)
    assert (folder / "mesh.obj").read_bytes() == b"old"
    # Nobody trips over it: the next file has a name of its own meanwhile.
    liftmesh.write(folder / "mesh.obj", Cloud(np.eye(3)))
    assert len(liftmesh.read(folder / "mesh.obj")) == 3
    assert names_in(folder) == sorted([*debris, "mesh.obj"])


def test_without_nameless_files_an_error_leaves_no_part(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(atomic, "NAMELESS", 0)
    (folder / "mesh.obj").chmod(0o640)
    late = Cloud(np.zeros((2, 3)), colors=np.array([[0.0, 0, 0], [0, 9, 0]]))
    with pytest.raises(liftmesh.InputError, match="row 1"):
        liftmesh.write(folder / "mesh.obj", late)
    assert names_in(folder) == ["mesh.obj"]
    liftmesh.write(folder / "mesh.obj", Cloud(np.eye(3)))
    assert (folder / "mesh.obj").stat().st_mode & 0o777 == 0o640


# Ends each command in the midst of a write: the system sends a signal that nobody hears where a
# file grows beyond a limit.
KILLED_AMID_WRITING = """
import importlib, os, resource, signal, sys
from liftmesh.cli import main

signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
main("solid ../cloud.ply old.stl --thickness 1 --overwrite".split())  # what all of them import
for name in ("geopandas", "laspy", "lazrs", "pyogrio", "rasterio", "scipy.spatial", "shapely"):
    importlib.import_module(name)
open("old.stl", "wb").write(b"old")
for line in sys.stdin:
    limit, *words = line.split()
    child = os.fork()
    if not child:
        resource.setrlimit(resource.RLIMIT_FSIZE, (int(limit), int(limit)))
        os._exit(main(words))
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""
WRITING = [
    "raster ../cloud.ply old.tif --resolution 0.01",
    "raster ../cloud.ply old.tif --resolution 0.01 --cog",
    "contour ../cloud.ply old.geojson --interval 0.05",
    "contour ../cloud.ply old.gpkg --interval 0.05",
    "solid ../cloud.ply old.stl --thickness 1",
    "solid ../cloud.ply old.3mf --base-height -9",
    "sample ../cloud.ply old.csv --at ../cloud.ply",
    "sample ../cloud.ply old.laz --at ../cloud.ply --interpolation sibson",
    "profile ../cloud.ply old.csv --along 0,0 --along 1,1",
    "profile ../cloud.ply old.geojson --along 0,0 --along 1,1",
    "simplify ../cloud.ply old.ply --max-error 0.01",
    "simplify ../cloud.ply old.xml --max-error 0.01",
    "thin ../cloud.ply old.obj --random 900",
    "thin ../cloud.ply old.npz --adaptive 700",
]


@pytest.mark.slow
def test_a_kill_amid_what_surfaces_write_leaves_the_old_file_alone(tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "cloud.ply", np.random.default_rng(0).random((1000, 3)))
    folder = tmp_path / "inner"
    folder.mkdir()
    names = {words.split()[2] for words in WRITING}
    for name in names:
        (folder / name).write_bytes(b"old")
    lines = [
        f"{limit} {words} --overwrite\n"
        for words, limit in zip(WRITING, cycle((1, 2000)), strict=False)
    ]
    child = begun(cwd=folder, program=KILLED_AMID_WRITING)
    out, err = child.communicate("".join(lines), timeout=300)
    assert [int(code) for code in out.splitlines() if code[0] == "-"] == [-signal.SIGXFSZ] * len(
        lines
    ), out + err
    assert {*names_in(folder)} == names
    assert all((folder / name).read_bytes() == b"old" for name in names)


@pytest.mark.parametrize("what", ["removed", "renamed", "replaced"])
@pytest.mark.parametrize("way", ["nameless", "named"])
def test_a_folder_that_vanishes_amid_writing_is_told(what: str, way: str, folder: Path) -> None:
    child = begun(way, cwd=folder, program=COMMAND_LINE)
    wait_until_stopped(child)
    elsewhere = folder.parent / f"elsewhere {way} {what}"
    if what == "removed":
        shutil.rmtree(folder)
    else:
        folder.rename(elsewhere)
    if what == "replaced":
        folder.mkdir()
    code, out, err = ended(child)
    assert (code, out) == (exit_codes.BAD_INPUT, "")
    assert err == (
        f"liftmesh: error: {folder}: cannot write here: "
        "the folder was moved or removed in the meantime\n"
    )
    if what != "removed":
        assert names_in(elsewhere) == ["mesh.obj"]
        assert (elsewhere / "mesh.obj").read_bytes() == b"old"
    if what == "replaced":
        assert names_in(folder) == []
