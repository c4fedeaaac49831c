"""The jobs that a campaign interrupts: calls of the library on large points, and on large files."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jobs import CALLS, OLD, SEED, Action, make_files

import liftmesh

READ = {
    "read PLY": "mesh.ply",
    "read PLY, text": "text.ply",
    "read OBJ": "cloud.obj",
    "read XYZ": "cloud.xyz",
    "read NPY": "cloud.npy",
    "read NPZ": "cloud.npz",
}
WRITTEN = {
    "write PLY": "mesh.ply",
    "write PLY, text": "text.ply",
    "write OBJ": "mesh.obj",
    "write NPZ": "mesh.npz",
}
# Folders of jobs that leave what they have done when they are interrupted, to go on from there.
UNFINISHED = {"tile": Path("out", "tiles")}
JOBS = (*READ, *CALLS, "tile", *WRITTEN)


def prepare(folder: Path, rows: int, jobs: Sequence[str]) -> None:
    """Write the files that the jobs read, and old files at the paths that they write."""
    mesh = liftmesh.triangulate(np.random.default_rng(SEED).random((rows, 3)))
    names = (READ[job] for job in jobs if job in READ)
    make_files(folder, {"cloud.npy", *names}, mesh)
    np.save(folder / "faces.npy", mesh.faces)
    (folder / "out").mkdir()
    for name in WRITTEN.values():
        (folder / "out" / name).write_bytes(OLD)


def action_of(job: str, folder: Path) -> Action:
    """Prepare what a job needs, and return the call that is interrupted."""
    if job in READ:
        return lambda _: liftmesh.read(folder / READ[job])
    points = np.load(folder / "cloud.npy")
    if job in CALLS:
        return CALLS[job](points, np.random.default_rng(SEED))
    return _tile(points, folder) if job == "tile" else _writing(points, folder, WRITTEN[job])


def _tile(points: np.ndarray, folder: Path) -> Action:
    planar = points[:, :2]
    options: dict[str, Any] = {"tile_rows": max(16, len(points) // 4), "resume": False}
    target = folder / UNFINISHED["tile"]
    return lambda progress: liftmesh.tile(planar, target, **options, progress=progress)


def _writing(points: np.ndarray, folder: Path, name: str) -> Action:
    mesh = liftmesh.Cloud(points, faces=np.load(folder / "faces.npy"))
    options: dict[str, Any] = {"encoding": "ascii"} if name.startswith("text") else {}
    return lambda _: liftmesh.write(folder / "out" / name, mesh, **options)
