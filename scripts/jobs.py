"""What campaigns do with liftmesh: calls of the library, commands, and the files that they read.

`soak` makes the calls on small points and `interrupt` on large ones; `sweep` and `fault_injection`
run the commands with every format, `sweep --long` those that take long on large files.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.random import Generator
from worst_points import tiny_and_far_cluster

import liftmesh

Progress: TypeAlias = Callable[[float], None]
Action: TypeAlias = Callable[[Progress], object]
Call: TypeAlias = Callable[[np.ndarray, Generator], Action]

MESHES = ("stl", "glb", "gltf", "ply", "obj", "off", "npz")
CLOUDS = ("npy", "xyz", "csv")
BY_TRIMESH = ("stl", "glb", "gltf")
STDOUT = "-"
OLD = b"what was there before\n"  # in every file that is replaced
SEED = 5
AREA = ((0.2, 0.2), (0.8, 0.3), (0.5, 0.8), (0.2, 0.2))

# --- commands -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Command:
    """A command line; words after ``<`` are files that it reads, and after ``>`` that it writes."""

    line: str

    @property
    def name(self) -> str:
        return self.line.split()[0]

    @property
    def sources(self) -> list[str]:
        return [word[1:] for word in self.line.split() if word[0] == "<"]

    @property
    def targets(self) -> list[str]:
        return [word[1:] for word in self.line.split() if word[0] == ">"]

    @property
    def by_trimesh(self) -> bool:
        """Whether trimesh reads or writes one of its files, which takes longer."""
        return any(file.endswith(BY_TRIMESH) for file in (*self.sources, *self.targets))

    def words(self, sources: Path | str, targets: Path | str) -> list[str]:
        """Return the arguments, with files in these folders; files that are there are replaced."""
        folders = {"<": sources, ">": targets}
        placed = [
            str(Path(folders[word[0]], word[1:])) if word[0] in folders else word
            for word in self.line.split()
        ]
        return [*placed, "--overwrite"] if self.targets else placed


def commands() -> list[Command]:
    """List every command with every format that it reads; the formats it writes take turns."""
    return list(map(Command, _lines()))


def _lines() -> Iterator[str]:
    yield "--version"
    targets = [*(f">new.{kind}" for kind in MESHES), f"{STDOUT} --output-format ply"]
    for k, kind in enumerate((*MESHES, *CLOUDS)):
        yield f"info <mesh.{kind}"
        yield f"compare <mesh.{kind} --lower >lower.ply --hull >hull.glb"
        yield f"triangulate <mesh.{kind} {targets[k % len(targets)]}"
    yield "info <mesh.npy --json"
    yield "doctor --json"
    for kind in MESHES:
        yield f"verify <mesh.{kind} --certificate >new.json"
    yield "contour <mesh.ply >lines.geojson --interval 0.1"
    yield "raster <mesh.npz >heights.tif --resolution 0.01"
    yield "solid <mesh.ply >block.stl --thickness 1"
    yield "sample <mesh.obj >heights.csv --at <mesh.xyz"
    yield "profile <mesh.ply >profile.csv --along 0,0 --along 1,1"
    yield "volume <mesh.ply <mesh.npz --json"
    yield "simplify <mesh.ply >few.ply --max-error 0.1 --json"
    yield "refine <flat.npz >fine.vtu --json"
    yield "thin <mesh.npy >thin.ply --adaptive 100"
    yield "height <mesh.xyz >above.npz --ground <mesh.ply"
    yield "accuracy <mesh.ply >residuals.csv --json"
    yield "difference <mesh.ply <mesh.obj >change.ply"
    yield "clip <mesh.ply >part.ply --within <area.geojson"
    yield "voronoi <flat.npz >cells.geojson --domain <area.geojson"
    yield "constrain <flat.npz >edges.obj --polygons <area.geojson --json"
    yield "tetrahedralize <mesh.npy >cells.vtu --json"
    yield "hull <mesh.npy >hull.ply --json"
    yield "alpha-shape <mesh.npy >shape.ply --components 2 --json"
    yield "plot <mesh.ply >map.png --dpi 20 --json"
    yield "view <mesh.ply --output >page.html --json"
    yield "tile <mesh.npy made --json"
    yield "tileset <mesh.ply made --max-error 0.1 --levels 2 --extrapolate hull"
    yield "paper --n 50 --seeds 1 --no-figures --out made"


LONG_COMMANDS = [
    Command("triangulate <cloud.ply >mesh.ply"),
    Command("triangulate <cloud.xyz >mesh.obj"),
    Command("verify <mesh.ply"),
    Command("info <scales.ply"),
    Command("refine <flat.ply >mesh.ply --max-area 1e-7"),
    Command("simplify <waves.ply >mesh.ply --max-error 0.01"),
]

# --- files --------------------------------------------------------------------------------------


def make_files(folder: Path, names: Iterable[str], mesh: liftmesh.Surface) -> None:
    """Write files; their names say what is in them, a mesh, its points, or others, and how."""
    for name in names:
        path = folder / name
        content = _content(path.stem, mesh)
        if path.suffix == ".npy":
            np.save(path, content.vertices if content is mesh else content)
        elif path.suffix == ".geojson":
            path.write_text(json.dumps({"type": "Polygon", "coordinates": [AREA]}))
        elif path.suffix in {".xyz", ".csv"}:
            liftmesh.write(path, mesh.vertices)
        else:
            liftmesh.write(path, content, **({"encoding": "ascii"} if path.stem == "text" else {}))


def _content(stem: str, mesh: liftmesh.Surface) -> Any:
    points = mesh.vertices
    if stem == "scales":  # nearest neighbours are at distances of two scales
        return tiny_and_far_cluster(len(points), np.random.default_rng(SEED)) @ np.eye(2, 3)
    return {"mesh": mesh, "waves": waves(points), "flat": points * [1, 1, 0]}.get(stem, points)


def waves(points: np.ndarray) -> np.ndarray:
    """Return points at heights of long waves and short ones."""
    x, y, noise = points.T
    heights = np.sin(7 * x) + np.sin(19 * (x + y)) / 9 + np.sin(90 * (x - 2 * y)) / 40
    return np.column_stack([x, y, heights + noise / 200])


# --- calls: each prepares its input, and returns what is done -------------------------------------


def _delaunay(points: np.ndarray, _: Generator, **options: Any) -> Action:
    planar = np.ascontiguousarray(points[:, :2])
    return lambda progress: liftmesh.delaunay(planar, **options, progress=progress)


def _regular(points: np.ndarray, rng: Generator, **options: Any) -> Action:
    planar = np.ascontiguousarray(points[:, :2])
    weights = rng.random(len(planar)) * np.ptp(planar) ** 2 / len(planar)
    return lambda progress: liftmesh.regular(planar, weights=weights, **options, progress=progress)


def _many(points: np.ndarray, _: Generator) -> Action:
    planar, starts = points[:, :2], np.append(np.arange(0, len(points), 40), len(points))
    return lambda progress: liftmesh.delaunay_many(planar, starts, progress=progress)


def _graph(points: np.ndarray, _: Generator) -> Action:
    found = liftmesh.delaunay(points[:, :2])
    return lambda _: [
        found.graph(kind) for kind in ("minimum_spanning_tree", "sphere_of_influence")
    ]


def _triangulate(points: np.ndarray, _: Generator) -> Action:
    several = points.copy()
    some = len(points) // 5  # have the position of another, and another height
    several[:some, :2] = points[len(points) - some :, :2]
    return lambda progress: liftmesh.triangulate(
        several, plane="fit", on_duplicate="mean", progress=progress
    )


def _verify(points: np.ndarray, _: Generator, **options: Any) -> Action:
    faces = liftmesh.triangulate(points).faces
    return lambda progress: liftmesh.verify(points, faces, **options, progress=progress)


def _disks(
    points: np.ndarray, rng: Generator, ask: Callable[[np.ndarray, np.ndarray], Action]
) -> Action:
    centers = np.where(np.abs(points[:, :2]) < 1e-30, 0, points[:, :2])
    return ask(centers, (rng.random(len(centers)) * 0.5 / len(centers) ** 0.5).round(6))


def _apollonius(centers: np.ndarray, radii: np.ndarray) -> Action:
    return lambda progress: liftmesh.apollonius(centers, radii, progress=progress)


def _verify_disks(centers: np.ndarray, radii: np.ndarray) -> Action:
    graph = liftmesh.apollonius(centers, radii)
    return lambda progress: graph.verify(threads=1, progress=progress)


def _cell_sides(centers: np.ndarray, radii: np.ndarray) -> Action:
    few = max(3, len(centers) // 20)
    graph = liftmesh.apollonius(centers[:few], radii[:few])
    return lambda _: graph.cell_sides((0, 0, 1, 1), 1e-4)


def _stars(points: np.ndarray, _: Generator) -> Action:
    planar = np.ascontiguousarray(points[:, :2])
    metrics = np.zeros((len(planar), 2, 2))
    across = planar[:, 0] - planar[:, 0].min()
    metrics[:, 0, 0], metrics[:, 1, 1] = 1, 1 + 3 * across / (across.max() or 1)
    return lambda progress: liftmesh.anisotropic_stars(planar, metrics, progress=progress)


def _find_simplex(points: np.ndarray, _: Generator) -> Action:
    planar = np.ascontiguousarray(points[:, :2])
    few = liftmesh.delaunay(planar[: max(len(planar) // 10, 3)])
    return lambda _: few.find_simplex(planar)


def _tetrahedralize(points: np.ndarray, rng: Generator, **threads: Any) -> Action:
    """As many tetrahedra as triangles of the other calls."""
    solid = rng.random((max(len(points) // 3, 4), 3))
    return lambda progress: liftmesh.tetrahedralize(solid, progress=progress, **threads)


def _verify_tetrahedra(points: np.ndarray, rng: Generator) -> Action:
    tetra = liftmesh.tetrahedralize(rng.random((max(len(points) // 3, 4), 3)))
    return lambda progress: tetra.verify(progress=progress)


def _on_sphere(points: np.ndarray, rng: Generator) -> Action:
    rays = rng.normal(size=(len(points), 3))
    return lambda progress: liftmesh.spherical_delaunay(rays, progress=progress)


def _verify_on_sphere(points: np.ndarray, rng: Generator) -> Action:
    """With a row that is no vertex: then directions are compared, too."""
    rays = rng.normal(size=(len(points), 3))
    simplices = liftmesh.spherical_delaunay(rays[1:]).simplices + 1
    return lambda progress: liftmesh.verify(rays, simplices, spherical=True, progress=progress)


def _in_tetrahedra(points: np.ndarray, rng: Generator) -> Action:
    tetra = liftmesh.tetrahedralize(rng.random((max(len(points) // 30, 4), 3)))
    places = rng.random((len(points), 3))
    return lambda _: tetra.find_simplex(places)


def _surface(points: np.ndarray, _: Generator, ask: Callable[[liftmesh.Surface], object]) -> Action:
    """Ask a surface of a tenth of the rows."""
    surface = liftmesh.triangulate(points[: max(len(points) // 10, 3)])
    return lambda _: ask(surface)


def _raster(surface: liftmesh.Surface) -> object:
    """Make a raster of a million pixels, or of fewer if there are few rows."""
    side = min(10 * len(surface.vertices) ** 0.5, 1000)
    return surface.raster(max(np.ptp(surface.vertices[:, :2], axis=0)) / side)


def _contours(surface: liftmesh.Surface) -> object:
    return surface.contours(interval=0.05)


def _sample(surface: liftmesh.Surface) -> object:
    """Sample between every vertex and the next one."""
    points = surface.vertices[:, :2]
    return surface.sample((points + np.roll(points, 1, axis=0)) / 2, "sibson")


def _profile(surface: liftmesh.Surface) -> object:
    """Cross the unit square many times."""
    at = np.linspace(0, 1, 80)
    return surface.profile(np.column_stack([at, np.arange(80) % 2]))


def _cut_and_fill(points: np.ndarray, _: Generator) -> Action:
    one, two = (liftmesh.triangulate(points[k::20]) for k in range(2))
    return lambda _: one.cut_and_fill(two)


def _simplify(points: np.ndarray, _: Generator, prune: bool) -> Action:
    rows = waves(points)
    return lambda progress: liftmesh.simplify(rows, max_error=0.01, prune=prune, progress=progress)


def _thin_adaptively(points: np.ndarray, _: Generator) -> Action:
    rows = waves(points)[::10]
    return lambda _: liftmesh.thin(rows, adaptive=max(len(rows) // 10, 64))


def _refine(points: np.ndarray, _: Generator, **options: Any) -> Action:
    """Refine a tenth of the rows, which become some five times as many."""
    few = liftmesh.delaunay(np.ascontiguousarray(points[: max(len(points) // 10, 3), :2]))
    return lambda progress: liftmesh.refine(few, **options, progress=progress)


CALLS: dict[str, Call] = {
    "delaunay, 1 thread": partial(_delaunay, threads=1),
    "delaunay": _delaunay,
    "regular, 1 thread": partial(_regular, threads=1),
    "regular": _regular,
    "triangulate": _triangulate,
    "verify, 1 thread": partial(_verify, threads=1),
    "verify": _verify,
    "apollonius": partial(_disks, ask=_apollonius),
    "verify disks": partial(_disks, ask=_verify_disks),
    "cell sides of disks": partial(_disks, ask=_cell_sides),
    "anisotropic stars": _stars,
    "find_simplex": _find_simplex,
    "graph": _graph,
    "many sets": _many,
    "tetrahedralize, 1 thread": partial(_tetrahedralize, threads=1),
    "tetrahedralize": _tetrahedralize,
    "verify tetrahedra": _verify_tetrahedra,
    "find_simplex in tetrahedra": _in_tetrahedra,
    "spherical_delaunay": _on_sphere,
    "verify on the sphere": _verify_on_sphere,
    "raster": partial(_surface, ask=_raster),
    "contours": partial(_surface, ask=_contours),
    "cut and fill": _cut_and_fill,
    "sample by Sibson": partial(_surface, ask=_sample),
    "profile": partial(_surface, ask=_profile),
    "simplify": partial(_simplify, prune=True),
    "simplify without the last pass": partial(_simplify, prune=False),
    "thin adaptively": _thin_adaptively,
    "refine": _refine,
    "refine by size": partial(_refine, size=lambda places: 0.003 + abs(places[:, 0]) / 100),
    "refine a surface": partial(_surface, ask=liftmesh.refine),
}
