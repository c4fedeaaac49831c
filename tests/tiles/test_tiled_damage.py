"""Folders of tiles that were changed: nothing is read of a file that is not as it was written."""

from __future__ import annotations

import copy
import json
import os
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import liftmesh as command

import liftmesh
from liftmesh import Tiled, TiledSurface
from liftmesh.base.options import ShardFormat
from liftmesh.errors import FormatError, LiftmeshError
from liftmesh.tiles import store

POINTS = np.random.default_rng(5).random((400, 3))
POINTS[7], POINTS[9, 0] = POINTS[8], np.nan
CRS = "EPSG:7415"


def surface(folder: Path) -> TiledSurface:
    return liftmesh.tile_surface(
        POINTS, folder, tile_rows=90, neighbors=True, crs=CRS, nonfinite="skip"
    )


def flipped(path: Path) -> None:
    """Change one bit near the end, and neither the size nor the time."""
    content, before = bytearray(path.read_bytes()), path.stat()
    content[-2] ^= 0x10
    path.write_bytes(content)
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


READINGS: dict[str, tuple[str, Callable[[Any], Any]]] = {
    "blocks": ("", lambda tiled: [*tiled.iter_blocks()]),
    "compute": ("", lambda tiled: tiled.to_array()),
    "delayed": ("", lambda tiled: [each.compute() for each in tiled.to_delayed()]),
    "simplices": ("", lambda tiled: tiled.simplices.compute()),
    "frame": ("", lambda tiled: tiled.to_dask_dataframe().compute()),
    "neighbor blocks": ("-neighbors", lambda tiled: [*tiled.iter_neighbor_blocks()]),
    "links": ("-links", lambda tiled: tiled.neighbors_to_array()),
    "neighbors": ("-links", lambda tiled: tiled.neighbors.compute()),
    "vertices": ("-vertices", lambda tiled: [*tiled.iter_vertices()]),
    "faces": ("-faces", lambda tiled: [*tiled.iter_faces()]),
    "meshes": ("-vertices", lambda tiled: [*tiled.iter_meshes()]),
    "raster": ("-vertices", lambda tiled: tiled.raster(0.1)),
    "raster of faces": ("-faces", lambda tiled: tiled.raster(0.1)),
    "sibson": ("-vertices", lambda tiled: tiled.raster(0.3, interpolation="sibson")),
    "contours": ("-vertices", lambda tiled: tiled.contours([0.5])),
    "contours of faces": ("-faces", lambda tiled: tiled.contours([0.5])),
    "hull": ("hull", lambda tiled: tiled.convex_hull),
    "duplicates": ("duplicates", lambda tiled: tiled.duplicates),
    "skipped": ("skipped", lambda tiled: tiled.skipped),
}


@pytest.mark.parametrize("reading", READINGS)
def test_a_bit_that_has_changed_is_noticed_by_every_reading(reading: str, tmp_path: Path) -> None:
    """Whether the folder is opened before or after, or was read before."""
    what, read = READINGS[reading]
    tiled = surface(tmp_path)
    read(tiled)
    name = f"{what}.npy" if what.isalpha() else f"tile-00001{what}.npy"
    flipped(tmp_path / name)
    for each in (tiled, liftmesh.open_tiled(tmp_path)):
        with pytest.raises(FormatError, match=rf"{name}: damaged \(its SHA-256 is not that of"):
            read(each)
    assert not tiled.verify(POINTS)


@pytest.mark.parametrize("shards", ["npy", "parquet", "ply"])
def test_a_bit_in_a_shard_of_any_format(shards: ShardFormat, tmp_path: Path) -> None:
    liftmesh.tile(POINTS[:, :2], tmp_path, tile_rows=150, shards=shards, nonfinite="skip")
    flipped(tmp_path / f"tile-00002.{shards}")
    tiled = liftmesh.open_tiled(tmp_path)
    for read in (Tiled.to_array, lambda each: [one.compute() for one in each.to_delayed()]):
        with pytest.raises(FormatError, match=rf"tile-00002.{shards}: damaged \(its SHA-256"):
            read(tiled)


def test_commands_read_no_damaged_shard(tmp_path: Path) -> None:
    surface(tmp_path / "T")
    flipped(tmp_path / "T" / "tile-00000-vertices.npy")
    for words in (("raster", "a.tif", "--resolution", 0.1), ("contour", "a.json", "--interval", 1)):
        done = command(words[0], tmp_path / "T", tmp_path / words[1], *words[2:])
        assert done.returncode == 3
        assert "tile-00000-vertices.npy: damaged (its SHA-256" in done.stderr
        assert not (tmp_path / words[1]).exists()


def test_a_shard_is_hashed_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Windows of a raster read a shard many times."""
    tiled = surface(tmp_path)
    hashed: list[Path] = []
    monkeypatch.setattr(
        store, "digest_of", lambda path: hashed.append(path) or tiled._digests[path.name]
    )
    monkeypatch.setattr("liftmesh.tiles.surface_raster._SIDE", 4)
    tiled.raster(0.1)
    assert len({*hashed}) == len(hashed) == 2 * len(tiled.shards)


VALUES: list[Any] = [None, True, -1, 0, 7, 1 << 70, float("nan"), 1e308, "../x", "mean"]
VALUES += [[], [-1, 2, 3, 4, 5, 6], {"a": 1}]
MISSING = object()


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yield where something stands in a tree of JSON; of lists, and of many names, the first."""
    yield path
    if isinstance(value, dict):
        for name in list(value) if len(value) < 30 else list(value)[:1]:
            yield from places(value[name], (*path, name))
    elif isinstance(value, list) and value:
        yield from places(value[0], (*path, 0))


def changed(tree: Any, path: tuple[Any, ...], value: Any) -> Any:
    tree = copy.deepcopy(tree)
    held = tree
    for name in path[:-1]:
        held = held[name]
    if value is MISSING:
        del held[path[-1]]
    else:
        held[path[-1]] = value
    return tree


def everything(folder: Path) -> None:
    """Ask a folder for all that it has; what is wrong with it may only be told as such."""
    with suppress(LiftmeshError, OSError, MemoryError):
        tiled = liftmesh.open_tiled(folder)
        calls = [lambda: tiled.report, lambda: tiled.convex_hull, tiled.to_array]
        calls += [tiled.neighbors_to_array, lambda: tiled.verify(POINTS, threads=1)]
        if isinstance(tiled, TiledSurface):
            calls += [lambda: tiled.raster(0.25), lambda: [*tiled.iter_meshes()]]
            calls += [
                lambda: tiled.contours([0.5]),
                lambda: tiled.raster(0.5, interpolation="sibson"),
            ]
        for call in calls:
            with suppress(LiftmeshError, OSError, MemoryError):
                call()


KINDS = ["surface", "npy", "parquet", "ply"]


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_a_manifest_that_was_changed_and_sealed_again(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every value, in turn by values of every kind."""
    if kind == "surface":
        surface(tmp_path)
    else:
        options: Any = {"shards": kind, "nonfinite": "skip", "neighbors": kind == "ply"}
        liftmesh.tile(POINTS[:, :2], tmp_path, tile_rows=150, **options)
    monkeypatch.setattr(os, "fsync", lambda _: None)
    place = tmp_path / "manifest.json"
    whole = json.loads(place.read_text())
    del whole["seal"]
    opened = 0
    for path in [*places(whole)][1:]:
        for value in (*VALUES, MISSING):
            forged = changed(whole, path, value)
            place.write_text(json.dumps({**forged, "seal": store.seal(forged)}))
            with suppress(FormatError):
                liftmesh.open_tiled(tmp_path)
                opened += 1
                everything(tmp_path)
    assert 0 < opened < 300


@pytest.mark.parametrize("name", ["../x.npy", "/etc/passwd", "tile-00000.npy/../x", "tile-1.npy"])
def test_a_manifest_names_no_file_elsewhere(name: str, tmp_path: Path) -> None:
    surface(tmp_path / "T")
    np.save(tmp_path / "x.npy", np.zeros((1, 3), dtype=np.int64))
    place = tmp_path / "T" / "manifest.json"
    forged = json.loads(place.read_text())
    del forged["seal"]
    forged["shards"][0]["file"] = name
    place.write_text(json.dumps({**forged, "seal": store.seal(forged)}))
    with pytest.raises(FormatError, match="the names of files is not what tile writes"):
        liftmesh.open_tiled(tmp_path / "T")


def sealed(folder: Path, name: str, content: bytes) -> None:
    """Replace a file, and let the manifest say so."""
    (folder / name).write_bytes(content)
    place = folder / "manifest.json"
    forged = json.loads(place.read_text())
    del forged["seal"]
    stated = {**forged["files"], **{each["file"]: each for each in forged["shards"]}}
    stated[name]["bytes"] = len(content)
    stated[name]["sha256"] = store.digest_of(folder / name)
    place.write_text(json.dumps({**forged, "seal": store.seal(forged)}))


@pytest.mark.slow
@pytest.mark.parametrize("name", [
    "tile-00000.npy", "tile-00000-faces.npy", "tile-00000-vertices.npy", "tile-00000-links.npy",
    "tile-00000-neighbors.npy", "hull.npy", "duplicates.npy", "skipped.npy",
])  # fmt: skip
def test_arrays_that_were_changed_and_sealed_again(name: str, tmp_path: Path) -> None:
    """Numbers that name nothing, other types and other shapes."""
    surface(tmp_path)
    whole = np.load(tmp_path / name)
    if whole.dtype.names:
        changes = [np.zeros_like(whole), whole.copy(), whole[["row", "x", "y"]]]
        changes[1]["x"] = np.nan
    else:
        changes = [whole * 0 + number for number in (-5, 1 << 30, 0)]
        changes += [whole.astype(np.float64), whole.astype(">i2")]
    changes += [whole[:0], whole[:-1], whole.reshape(-1)[:4], whole[None]]
    for each in changes:
        np.save(tmp_path / "forged.npy", each)
        sealed(tmp_path, name, (tmp_path / "forged.npy").read_bytes())
        everything(tmp_path)


@pytest.mark.parametrize("text", [
    "{}", '{"axes": "x"}', '{"axes": [0], "at": [[0, 0]], "children": [[-1, 0]]}',
    '{"axes": [0], "at": [[0, 0]], "children": [[-1, -9]]}',
    '{"axes": [3], "at": [[0, 0]], "children": [[-1, -2]]}',
    '{"axes": [0, 0], "at": [[0, 0], [1, 1]], "children": [[-1, -2], [1, -3]]}',
    '{"axes": [], "at": [], "children": [], "repeated": [[NaN, 0]]}',
])  # fmt: skip
def test_a_plan_that_was_changed_and_sealed_again(text: str, tmp_path: Path) -> None:
    surface(tmp_path)
    sealed(tmp_path, "plan.json", text.encode())
    with pytest.raises(FormatError, match="no plan of tiles"):
        liftmesh.open_tiled(tmp_path).verify(POINTS)
