"""Ctrl-C at any call of a function, and in every phase of the campaign: state as before."""

from __future__ import annotations

import inspect
import io
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest
from commands import ROOT

import liftmesh
from liftmesh.base import interruption

PACKAGE = str(Path(liftmesh.__file__).parent)
CLOUD = liftmesh.Cloud(np.random.default_rng(8).random((60, 3)), colors=np.zeros((60, 3), np.uint8))
MESH = liftmesh.triangulate(CLOUD)


class Interrupting:
    """Raises KeyboardInterrupt at a certain call of a function of the package."""

    def __init__(self, at: int = -1) -> None:
        self.at = at
        self.seen = 0

    def __enter__(self) -> Interrupting:
        sys.setprofile(self._look)
        return self

    def __exit__(self, *_: object) -> None:
        sys.setprofile(None)

    def _look(self, frame: FrameType, event: str, _: Any) -> None:
        code = frame.f_code
        # A generator is also called where it is thrown away, which hears no exception.
        if event != "call" or code.co_flags & inspect.CO_GENERATOR:
            return
        # What a handler raises within a guard of signals waits until the guard is entered or left.
        if code.co_filename.startswith(PACKAGE) and code.co_filename != interruption.__file__:
            self.seen += 1
            if self.seen == self.at:
                handler: Any = signal.getsignal(signal.SIGINT)  # that of a guard, perhaps
                handler(signal.SIGINT, frame)


def saved(kind: str) -> bytes:
    stream = io.BytesIO()
    liftmesh.write(stream, MESH, format=kind)
    return stream.getvalue()


def reading(kind: str) -> Callable[[Path], object]:
    data = saved(kind)
    return lambda _: liftmesh.read(io.BytesIO(data), format=kind).points.tobytes()


def writing(name: str, **options: Any) -> Callable[[Path], object]:
    def write(folder: Path) -> object:
        liftmesh.write(folder / name, MESH, **options)
        return (folder / name).read_bytes()

    return write


def verifying(_: Path) -> object:
    return liftmesh.verify(MESH.vertices, MESH.faces)


def triangulating(_: Path) -> object:
    return liftmesh.triangulate(CLOUD, plane="fit", on_duplicate="mean").faces.tobytes()


def rastering(folder: Path) -> object:
    MESH.raster(0.2).save(folder / "a.tif")
    return (folder / "a.tif").read_bytes()


def contouring(folder: Path) -> object:
    MESH.contours(interval=0.2).save(folder / "a.geojson")
    return (folder / "a.geojson").read_bytes()


def closing(folder: Path) -> object:
    liftmesh.write(folder / "solid.stl", MESH.solid(thickness=1))
    return (folder / "solid.stl").read_bytes()


def measuring(_: Path) -> object:
    volume = MESH.volume(0.5)
    earthwork = MESH.cut_and_fill(MESH.replace(vertices=MESH.vertices + (0, 0, 1)))  # noqa: RUF005
    profile = MESH.profile([[0, 0], [1, 1]]).points.tobytes()
    return volume.above, earthwork.fill, MESH.area(), profile


def sampling(_: Path) -> object:
    return MESH.sample(CLOUD.points[:, :2] * 0.9, "sibson").tobytes()


def simplifying(_: Path) -> object:
    return liftmesh.simplify(CLOUD, max_error=0.2).vertices.tobytes()


def thinning(_: Path) -> object:
    return liftmesh.thin(CLOUD, adaptive=20).points.tobytes()


JOBS: dict[str, Callable[[Path], object]] = {
    "triangulate": triangulating,
    "verify": verifying,
    "raster": rastering,
    "contours": contouring,
    "solid": closing,
    "volumes and profiles": measuring,
    "sample": sampling,
    "simplify": simplifying,
    "thin": thinning,
    **{f"read {kind}": reading(kind) for kind in ("ply", "obj", "npz", "off", "stl")},
    **{
        f"write {k}": writing(f"a.{k}", overwrite=True)
        for k in ("ply", "obj", "npz", "off", "stl", "laz")
    },
    "write text": writing("a.ply", encoding="ascii"),
}


@pytest.mark.parametrize("job", JOBS)
def test_an_interrupt_at_any_call_leaves_all_as_it_was(job: str, tmp_path: Path) -> None:
    run = JOBS[job]
    expected = run(tmp_path)
    with Interrupting() as counted:
        assert run(tmp_path) == expected
    assert counted.seen > 5
    old = {path: path.write_bytes(b"old") for path in tmp_path.iterdir()}
    for at in np.unique(np.linspace(1, counted.seen, 40).astype(int)):
        with pytest.raises(KeyboardInterrupt), Interrupting(int(at)):
            run(tmp_path)
        assert {*tmp_path.iterdir()} == old.keys()
        assert all(path.read_bytes() in (b"old", expected) for path in old)
    assert run(tmp_path) == expected
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def campaign(*words: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, str(ROOT / "scripts" / "interrupt"), *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=600, check=False)


@pytest.mark.campaign
def test_the_campaign_interrupts_every_phase() -> None:
    jobs = ("delaunay", "tile", "write OBJ")
    done = campaign("--rows", "100000", "--rounds", "2", "--most", "20", "--jobs", *jobs)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "0 of them wrong" in done.stdout
    assert [f"\n{job}: " in f"\n{done.stdout}" for job in jobs] == [True] * len(jobs)
    assert "the files of a run after all of them  ok" in done.stdout


@pytest.mark.campaign
def test_the_campaign_fails_where_the_prompt_is_late() -> None:
    done = campaign("--rows", "300000", "--rounds", "3", "--most", "0", "--jobs", "write OBJ")
    assert done.returncode == 1, done.stdout + done.stderr
    assert "it took too long" in done.stdout
