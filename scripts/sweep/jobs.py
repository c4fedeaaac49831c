"""The commands of a sweep: each reads one format, and some write others."""

from __future__ import annotations

import io
import os
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import redirect_stdout
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

import liftmesh
from liftmesh.cli import main

COMMAND = (sys.executable, "-m", "liftmesh")
OLD = b"old"  # what every file holds before it is replaced
STDOUT = "-"

_MESHES = ("stl", "glb", "gltf", "ply", "obj", "off", "npz")
_CLOUDS = ("npy", "xyz", "csv")
_TRIMESH = ("stl", "glb", "gltf")


@dataclass(frozen=True, slots=True)
class Job:
    """A command.

    Attributes
    ----------
    words : tuple of str
        Its arguments; files are in the folder above the current one.
    outputs : tuple of str
        Files that it replaces in the current folder.
    kind : str
        Commands of one kind take about as long.
    """

    words: tuple[str, ...]
    outputs: tuple[str, ...]
    kind: str

    @property
    def command(self) -> str:
        """Its first word."""
        return self.words[0]


@dataclass(slots=True)
class Known:
    """What the jobs do without a signal."""

    seconds: dict[str, float] = field(default_factory=dict)
    printed: dict[Job, tuple[bytes, bytes]] = field(default_factory=dict)  # stdout, stderr
    written: dict[Job, dict[str, bytes]] = field(default_factory=dict)


def all_jobs() -> list[Job]:
    """List every command with every format that it reads; the formats it writes take turns."""
    jobs = [*_of_clouds(), *_of_meshes(), *_of_surfaces()]
    replacing = [
        replace(each, words=(*each.words, "--overwrite")) if each.outputs else each for each in jobs
    ]
    return [Job(("--version",), (), "version"), *replacing, _paper()]


def _of_clouds() -> Iterator[Job]:
    targets = [*_MESHES, STDOUT]
    for k, kind in enumerate((*_MESHES, *_CLOUDS)):
        source, target = f"../in.{kind}", targets[k % len(targets)]
        yield Job(("info", source), (), _kind("info", kind))
        words = ("compare", source, "--lower", "lower.ply", "--hull", "hull.glb")
        yield Job(words, ("lower.ply", "hull.glb"), "compare")
        if target == STDOUT:
            words = ("triangulate", source, STDOUT, "--format", "ply")
            yield Job(words, (), _kind("triangulate", kind))
        else:
            words = ("triangulate", source, f"out.{target}")
            yield Job(words, (f"out.{target}",), _kind("triangulate", kind, target))


def _of_meshes() -> Iterator[Job]:
    for kind in _MESHES:
        words = ("verify", f"../in.{kind}", "--certificate", "out.json")
        yield Job(words, ("out.json",), _kind("verify", kind))


def _of_surfaces() -> Iterator[Job]:
    words = ("contour", "../in.ply", "lines.geojson", "--interval", "0.1")
    yield Job(words, ("lines.geojson",), "contour")
    words = ("raster", "../in.npz", "heights.tif", "--resolution", "0.01")
    yield Job(words, ("heights.tif",), "raster")
    words = ("solid", "../in.ply", "block.stl", "--thickness", "1")
    yield Job(words, ("block.stl",), "solid")
    words = ("sample", "../in.obj", "heights.csv", "--at", "../in.xyz")
    yield Job(words, ("heights.csv",), "sample")
    words = ("profile", "../in.ply", "profile.csv", "--along", "0,0", "--along", "1,1")
    yield Job(words, ("profile.csv",), "profile")
    yield Job(("volume", "../in.ply", "../in.npz", "--json"), (), "volume")
    words = ("simplify", "../in.ply", "few.ply", "--max-error", "0.1", "--json")
    yield Job(words, ("few.ply",), "simplify")
    words = ("thin", "../in.npy", "thin.ply", "--adaptive", "100")
    yield Job(words, ("thin.ply",), "thin")


def _paper() -> Job:
    words = ("paper", "--n", "50", "--seeds", "1", "--no-figures", "--out", "made")
    return Job(words, (), "paper")


def _kind(command: str, *formats: str) -> str:
    return f"{command}, trimesh" if {*formats} & {*_TRIMESH} else command


def prepare(folder: Path, rows: int) -> None:
    """Write the files that the jobs read."""
    mesh = liftmesh.triangulate(np.random.default_rng(7).random((rows, 3)))
    for kind in _MESHES:
        liftmesh.write(folder / f"in.{kind}", mesh)
    np.save(folder / "in.npy", mesh.vertices)
    for kind, mark in (("xyz", " "), ("csv", ",")):
        np.savetxt(folder / f"in.{kind}", mesh.vertices, delimiter=mark)


def fill(folder: Path, job: Job) -> None:
    """Make a folder for one run of a job, with the files that it replaces."""
    folder.mkdir()
    for name in job.outputs:
        (folder / name).write_bytes(OLD)


def learn(folder: Path, jobs: Sequence[Job]) -> Known:
    """Run the jobs without a signal: one of each kind as a process, to see how long it takes."""
    known = Known()
    for number, job in enumerate(jobs):
        place = folder / f"whole-{number}"
        fill(place, job)
        if job.kind not in known.seconds or STDOUT in job.words:
            began = time.monotonic()
            known.printed[job] = _process(job, place)
            known.seconds[job.kind] = time.monotonic() - began
        else:
            known.printed[job] = _here(job, place)
        known.written[job] = {name: (place / name).read_bytes() for name in job.outputs}
    return known


def _process(job: Job, place: Path) -> tuple[bytes, bytes]:
    done = subprocess.run(
        [*COMMAND, *job.words], cwd=place, capture_output=True, timeout=60, check=False
    )
    if done.returncode:
        raise SystemExit(f"{' '.join(job.words)}: {done.returncode}, {done.stderr!r}")
    return done.stdout, done.stderr


def _here(job: Job, place: Path) -> tuple[bytes, bytes]:
    shown = io.StringIO()
    here = Path.cwd()
    os.chdir(place)
    try:
        with redirect_stdout(shown):
            code = main(job.words)
    finally:
        os.chdir(here)
    if code:
        raise SystemExit(f"{' '.join(job.words)}: {code}")
    return shown.getvalue().encode(), b""
