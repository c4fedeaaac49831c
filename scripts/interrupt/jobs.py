"""The jobs that a campaign interrupts: reading, triangulating, verifying and writing."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from worst_points import tiny_and_far_cluster

import liftmesh

Progress: TypeAlias = Callable[[float], None]
Action: TypeAlias = Callable[[Progress], object]
SEED = 5
OLD = b"old"


# The file that each reading job reads.
FILES = {
    "read PLY": "mesh.ply",
    "read PLY, text": "text.ply",
    "read OBJ": "cloud.obj",
    "read XYZ": "cloud.xyz",
    "read NPY": "cloud.npy",
    "read NPZ": "cloud.npz",
}

# Arguments of the command line; the second one is the input file.
COMMANDS: dict[str, tuple[str, ...]] = {
    "liftmesh triangulate, PLY": ("triangulate", "cloud.ply", "out/mesh.ply", "--overwrite"),
    "liftmesh triangulate, text": ("triangulate", "cloud.xyz", "out/mesh.obj", "--overwrite"),
    "liftmesh verify": ("verify", "mesh.ply"),
    "liftmesh info": ("info", "scales.ply"),
    "liftmesh simplify": (
        *("simplify", "waves.ply", "out/mesh.ply", "--max-error", "0.01", "--overwrite"),
    ),
}


def prepare(folder: Path, rows: int, jobs: Sequence[str]) -> None:
    """Write the files that the jobs read, and old files at the paths that they write."""
    points = np.random.default_rng(SEED).random((rows, 3))
    mesh = liftmesh.triangulate(points)
    np.save(folder / "cloud.npy", points)
    np.save(folder / "faces.npy", mesh.faces)
    for name in {FILES.get(job) or COMMANDS.get(job, ("", "cloud.npy"))[1] for job in jobs}:
        _make(folder / name, mesh)
    (folder / "out").mkdir()
    for name in ("mesh.ply", "text.ply", "mesh.obj", "mesh.npz"):
        (folder / "out" / name).write_bytes(OLD)


def _make(path: Path, mesh: liftmesh.Surface) -> None:
    points = mesh.vertices
    contents = {"mesh": mesh, "scales": _scales(len(points)), "waves": _waves(points)}
    content = contents.get(path.stem, points)
    if path.suffix == ".xyz":
        text = path.with_suffix(".text")
        liftmesh.write(text, content, format="ply", encoding="ascii")
        _without_header(text, path)
        text.unlink()
    elif path.suffix != ".npy":
        liftmesh.write(path, content, **({"encoding": "ascii"} if path.stem == "text" else {}))


def _scales(rows: int) -> np.ndarray:
    """Return points whose nearest neighbours are at distances of two scales."""
    return tiny_and_far_cluster(rows, np.random.default_rng(SEED)) @ np.eye(2, 3)


def _waves(points: np.ndarray) -> np.ndarray:
    """Return points at heights of long waves and short ones."""
    x, y, noise = points.T
    heights = np.sin(7 * x) + np.sin(19 * (x + y)) / 9 + np.sin(90 * (x - 2 * y)) / 40
    return np.column_stack([x, y, heights + noise / 200])


def _without_header(source: Path, target: Path) -> None:
    with source.open("rb") as lines, target.open("wb") as copy:
        while lines.readline() != b"end_header\n":
            pass
        shutil.copyfileobj(lines, copy)


def _reading(name: str, folder: Path) -> Action:
    return lambda _: liftmesh.read(folder / name)


def _writing(name: str, folder: Path, **options: Any) -> Action:
    mesh = liftmesh.Cloud(np.load(folder / "cloud.npy"), faces=np.load(folder / "faces.npy"))
    return lambda _: liftmesh.write(folder / "out" / name, mesh, **options)


def _delaunay(folder: Path, threads: int | None) -> Action:
    points = np.load(folder / "cloud.npy")[:, :2]
    return lambda progress: liftmesh.delaunay(points, threads=threads, progress=progress)


def _regular(folder: Path, threads: int | None) -> Action:
    points = np.load(folder / "cloud.npy")[:, :2]
    weights = np.random.default_rng(SEED).random(len(points)) * np.ptp(points) ** 2 / len(points)
    options: dict[str, Any] = {"weights": weights, "threads": threads}
    return lambda progress: liftmesh.regular(points, **options, progress=progress)


def _tile(folder: Path) -> Action:
    points = np.load(folder / "cloud.npy")[:, :2]
    options: dict[str, Any] = {"tile_rows": max(16, len(points) // 4), "resume": False}
    return lambda progress: liftmesh.tile(
        points, folder / "out" / "tiles", **options, progress=progress
    )


def _triangulate(folder: Path) -> Action:
    points = np.load(folder / "cloud.npy")
    points[: len(points) // 5, :2] = points[
        -(len(points) // 5) :, :2
    ]  # several heights at one position
    options: dict[str, Any] = {"plane": "fit", "duplicates": "mean"}
    return lambda progress: liftmesh.triangulate(points, **options, progress=progress)


def _verify(folder: Path, threads: int | None) -> Action:
    points, faces = np.load(folder / "cloud.npy"), np.load(folder / "faces.npy")
    return lambda progress: liftmesh.verify(points, faces, threads=threads, progress=progress)


def _disks(folder: Path, ask: Callable[[np.ndarray, np.ndarray], Action]) -> Action:
    centers = np.load(folder / "cloud.npy")[:, :2]
    return ask(
        centers, np.random.default_rng(SEED).random(len(centers)) * 0.5 / len(centers) ** 0.5
    )


def _apollonius(centers: np.ndarray, radii: np.ndarray) -> Action:
    return lambda progress: liftmesh.apollonius(centers, radii, progress=progress)


def _verify_disks(centers: np.ndarray, radii: np.ndarray) -> Action:
    graph = liftmesh.apollonius(centers, radii)
    return lambda progress: graph.verify(threads=1, progress=progress)


def _cell_sides(centers: np.ndarray, radii: np.ndarray) -> Action:
    few = max(3, len(centers) // 20)
    graph = liftmesh.apollonius(centers[:few], radii[:few])
    return lambda _: graph.cell_sides((0, 0, 1, 1), 1e-4)


def _stars(folder: Path) -> Action:
    points = np.load(folder / "cloud.npy")[:, :2]
    metrics = np.zeros((len(points), 2, 2))
    metrics[:, 0, 0], metrics[:, 1, 1] = 1, 1 + 3 * points[:, 0]
    return lambda progress: liftmesh.anisotropic_stars(points, metrics, progress=progress)


def _find_simplex(folder: Path) -> Action:
    points = np.ascontiguousarray(np.load(folder / "cloud.npy")[:, :2])
    few = liftmesh.delaunay(points[: len(points) // 10])
    return lambda _: few.find_simplex(points)


def _surface(folder: Path, ask: Callable[[liftmesh.Surface], object]) -> Action:
    """Ask a surface of a tenth of the rows."""
    points = np.load(folder / "cloud.npy")
    surface = liftmesh.triangulate(points[: len(points) // 10])
    return lambda _: ask(surface)


def _between(surface: liftmesh.Surface) -> np.ndarray:
    """Return points between every vertex and the next one."""
    points = surface.vertices[:, :2]
    return (points + np.roll(points, 1, axis=0)) / 2


def _zigzag() -> np.ndarray:
    """Return a line that crosses the unit square many times."""
    at = np.linspace(0, 1, 80)
    return np.column_stack([at, np.arange(80) % 2])


def _simplify(folder: Path, prune: bool) -> Action:
    points = _waves(np.load(folder / "cloud.npy"))
    options: dict[str, Any] = {"max_error": 0.01, "prune": prune}
    return lambda progress: liftmesh.simplify(points, **options, progress=progress)


def _thin_adaptively(folder: Path) -> Action:
    points = _waves(np.load(folder / "cloud.npy"))[::10]
    return lambda _: liftmesh.thin(points, adaptive=max(len(points) // 10, 64))


def _cut_and_fill(folder: Path) -> Action:
    points = np.load(folder / "cloud.npy")
    one, two = (liftmesh.triangulate(points[k::20]) for k in range(2))
    return lambda _: one.cut_and_fill(two)


# Folders of jobs that leave what they have done when they are interrupted, to go on from there.
UNFINISHED = {"tile": Path("out", "tiles")}

# Each prepares its input, and returns the call that is interrupted.
JOBS: dict[str, Callable[[Path], Action]] = {
    **{job: partial(_reading, name) for job, name in FILES.items()},
    "delaunay, 1 thread": partial(_delaunay, threads=1),
    "delaunay": partial(_delaunay, threads=None),
    "regular, 1 thread": partial(_regular, threads=1),
    "regular": partial(_regular, threads=None),
    "tile": _tile,
    "triangulate": _triangulate,
    "verify, 1 thread": partial(_verify, threads=1),
    "verify": partial(_verify, threads=None),
    "apollonius": partial(_disks, ask=_apollonius),
    "verify disks": partial(_disks, ask=_verify_disks),
    "cell sides of disks": partial(_disks, ask=_cell_sides),
    "anisotropic stars": _stars,
    "find_simplex": _find_simplex,
    "raster": partial(_surface, ask=lambda surface: surface.raster(1e-3)),
    "contours": partial(_surface, ask=lambda surface: surface.contours(interval=0.05)),
    "cut and fill": _cut_and_fill,
    "sample by Sibson": partial(
        _surface, ask=lambda surface: surface.sample(_between(surface), "sibson")
    ),
    "profile": partial(_surface, ask=lambda surface: surface.profile(_zigzag())),
    "simplify": partial(_simplify, prune=True),
    "simplify without the last pass": partial(_simplify, prune=False),
    "thin adaptively": _thin_adaptively,
    "write PLY": partial(_writing, "mesh.ply"),
    "write PLY, text": partial(_writing, "text.ply", encoding="ascii"),
    "write OBJ": partial(_writing, "mesh.obj"),
    "write NPZ": partial(_writing, "mesh.npz"),
}
