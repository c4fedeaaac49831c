"""Honest files of every format, to compare two versions of liftmesh by the instructions they take.

A terrain of a given number of rows with colours is written once in each format that has a writer,
and as text and NPY. Every interpreter that is compared reads the same files.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from growth.counting import Count, Work, count

import liftmesh

CHUNKS = 8
POLYGONS = ("quads.ply", "quads_ascii.ply", "quads.off", "quads.obj")


def terrain(rows: int) -> liftmesh.Surface:
    """Make a surface of random points with colours and whole centimetres."""
    rng = np.random.default_rng(1)
    points = np.round(rng.random((rows, 3)) * (1000, 1000, 100), 2)
    colors = rng.integers(0, 256, (rows, 3), dtype=np.uint8)
    return liftmesh.triangulate(liftmesh.Cloud(points, colors=colors))


def write_files(folder: Path, rows: int) -> list[str]:
    """Write the files, and return their names."""
    surface = terrain(rows)
    for kind in ("ply", "obj", "off", "stl", "glb", "gltf", "npz"):
        surface.save(folder / f"mesh.{kind}")
    surface.save(folder / "ascii.ply", encoding="ascii")
    surface.save(folder / "packed.npz", compressed=True)
    liftmesh.write(folder / "points.ply", surface.to_cloud().select(slice(None)))
    np.save(folder / "points.npy", surface.vertices)
    np.savetxt(folder / "points.xyz", surface.vertices, fmt="%.2f")
    np.savetxt(folder / "points.csv", surface.vertices, "%.2f", ",", header="x,y,z", comments="")
    (folder / "facets.stl").write_bytes(text_stl(surface))
    for name in POLYGONS:
        (folder / name).write_bytes(quads(name, rows))
    return sorted(path.name for path in folder.iterdir())


def text_stl(surface: liftmesh.Surface) -> bytes:
    """Write the triangles as text."""
    facets = (
        "facet normal 0 0 1\n outer loop\n"
        + "".join(f"  vertex {x:.6g} {y:.6g} {z:.6g}\n" for x, y, z in corners)
        + " endloop\nendfacet\n"
        for corners in surface.vertices[surface.faces].tolist()
    )
    return f"solid terrain\n{''.join(facets)}endsolid terrain\n".encode()


def quads(name: str, rows: int) -> bytes:
    """Write a grid of quadrilaterals."""
    side = int(rows**0.5)
    grid = np.indices((side, side)).reshape(2, -1).T.astype(np.float64)
    points = np.column_stack([grid, grid.sum(axis=1)])
    first = np.arange(side * (side - 1)).reshape(-1, side)[:, :-1].reshape(-1)
    faces = np.column_stack([first, first + 1, first + side + 1, first + side])
    rows_of = {"%s": points.tolist(), "4 %s": faces.tolist()}
    if name.endswith(".obj"):
        rows_of = {"v %s": points.tolist(), "f %s": (faces + 1).tolist()}
    text = "".join(
        form % " ".join(map(repr, row)) + "\n" for form, found in rows_of.items() for row in found
    )
    if name.endswith(".obj"):
        return text.encode()
    if name.endswith(".off"):
        return f"OFF\n{len(points)} {len(faces)} 0\n{text}".encode()
    return _ply(name, points, faces, text)


def _ply(name: str, points: np.ndarray, faces: np.ndarray, text: str) -> bytes:
    encoding = "ascii" if "ascii" in name else "binary_little_endian"
    head = (
        f"ply\nformat {encoding} 1.0\nelement vertex {len(points)}\nproperty double x\n"
        f"property double y\nproperty double z\nelement face {len(faces)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    if encoding == "ascii":
        return (head + text).encode()
    table = np.empty(len(faces), dtype=[("n", "u1"), ("corners", "<i4", (4,))])
    table["n"], table["corners"] = 4, faces
    return head.encode() + points.astype("<f8").tobytes() + table.tobytes()


def compare(folder: Path, rows: int, pythons: list[str], only: str) -> dict[str, list[Count]]:
    """Count the reading and writing of every file with each interpreter."""
    names = write_files(folder, rows)
    verbs = [f"{verb} {name}" for name, verb in _verbs(names)]
    labels = [label for label in verbs if only in label]
    jobs = [[verb, str(folder / name)] for verb, name in map(str.split, labels)]
    found = [count("growth.honest:prepare", jobs, python=python) for python in pythons]
    return {label: list(each) for label, *each in zip(labels, *found, strict=True)}


def _verbs(names: list[str]) -> Iterator[tuple[str, str]]:
    for name in names:
        yield from ((name, verb) for verb in ("read", "read_chunks"))
        if name.startswith("mesh") or name in ("ascii.ply", "packed.npz"):
            yield name, "write"


def prepare(job: list[str]) -> Work:
    """Make the call of a job: read or write one file."""
    verb, path = job
    size = Path(path).stat().st_size
    if verb == "read":
        return Work(lambda: liftmesh.read(path), size)
    cloud = liftmesh.read(path)
    if verb == "write":
        kind = Path(path).suffix
        options = {"ascii.ply": {"encoding": "ascii"}, "packed.npz": {"compressed": True}}
        chosen = options.get(Path(path).name, {})
        return Work(lambda: liftmesh.write(io.BytesIO(), cloud, format=kind, **chosen), size)
    rows = -(-len(cloud) // CHUNKS)
    return Work(lambda: sum(map(len, liftmesh.read_chunks(path, rows=rows))), size)
