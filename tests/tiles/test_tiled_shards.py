"""Shards in each format, and neighbours across them: those of one call, and proved."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import trimesh
from tilings import adjacent

import liftmesh
from liftmesh import Tiled
from liftmesh.base.options import ShardFormat
from liftmesh.errors import FormatError, InputError, MissingDependencyError
from liftmesh.tiles import shards as formats
from liftmesh.tiles.adjacency import paired

FORMATS: tuple[ShardFormat, ...] = ("npy", "parquet", "ply")
POINTS = np.random.default_rng(5).permutation(np.indices((25, 28)).reshape(2, -1).T) * 1.0
POINTS[10:40] = POINTS[100:130]  # ties everywhere, and duplicates


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def check(tiled: Tiled, points: np.ndarray) -> None:
    expected = liftmesh.delaunay(points, order="canonical")
    assert np.array_equal(
        adjacent(tiled.to_array(), tiled.neighbors_to_array()),
        adjacent(expected.simplices, expected.neighbors),
    )
    assert tiled.is_sound()


@pytest.mark.parametrize("shards", FORMATS)
def test_triangles_and_neighbors_are_those_of_one_call(shards: ShardFormat, tmp_path: Path) -> None:
    tiled = liftmesh.tile(POINTS, tmp_path / "a", tile_rows=90, shards=shards, neighbors=True)
    check(tiled, POINTS)
    check(liftmesh.open_tiled(tmp_path / "a"), POINTS)
    assert {path.suffix for path in tiled.shards} == {f".{shards}"}
    assert tiled.manifest["shard_format"] == shards
    assert np.array_equal(tiled.simplices.compute(), tiled.to_array())
    assert np.array_equal(tiled.to_dask_dataframe().compute().to_numpy(), tiled.to_array())
    pairs = tiled.neighbors.compute()
    assert pairs.shape == (tiled.nsimplex, 3, 2)
    assert np.array_equal(pairs, np.concatenate([*tiled.iter_neighbor_blocks()]))
    assert set(np.unique(pairs[:, :, 0])) == set(range(-1, len(tiled.shards)))
    assert tiled.verify(POINTS).canonical
    parts = iter(np.split(POINTS, [600]))
    liftmesh.tile(parts, tmp_path / "b", tile_rows=90, shards=shards, neighbors=True, threads=2)
    one, other = contents(tmp_path / "a"), contents(tmp_path / "b")
    assert one.pop("manifest.json") != other.pop("manifest.json")  # the source has another name
    assert one == other


def test_neighbors_where_little_or_nothing_is_settled(tmp_path: Path) -> None:
    angles = np.linspace(0, 6, 500)
    line = np.column_stack((np.arange(200.0), np.zeros(200)))
    sets = {
        "circle": np.column_stack((np.cos(angles), np.sin(angles))),
        "columns": np.column_stack((np.arange(400) % 2, np.arange(400.0) ** 2)),
        "a line and a point": np.concatenate((line, [[50, 9]])),
        "a triangle": np.array([[0.0, 0], [1, 0], [0, 1]]),
        "survey lines": np.random.default_rng(2).random((600, 2)) * 0.2
        + np.indices((300, 2)).reshape(2, -1).T * (1, 100),
    }
    for name, points in sets.items():
        check(liftmesh.tile(points, tmp_path / name, tile_rows=40, neighbors=True), points)


def test_ply_is_a_mesh_with_rows(tmp_path: Path) -> None:
    tiled = liftmesh.tile(POINTS, tmp_path, tile_rows=90, shards="ply")
    area = 0.0
    for path, triangles in zip(tiled.shards, tiled.iter_blocks(), strict=True):
        mesh = trimesh.load(path, process=False)
        rows = mesh.metadata["_ply_raw"]["vertex"]["data"]["row"].reshape(-1)
        assert np.array_equal(rows[mesh.faces], triangles)
        assert np.array_equal(mesh.vertices[:, :2], POINTS[rows])
        assert len(np.unique(rows)) == len(rows)
        area += mesh.area
    assert area == 24 * 27


def test_parquet_is_read_by_others(tmp_path: Path) -> None:
    tiled = liftmesh.tile(POINTS, tmp_path, tile_rows=90, shards="parquet")
    frames = [pd.read_parquet(path) for path in tiled.shards]
    assert np.array_equal(pd.concat(frames).to_numpy(), tiled.to_array())
    assert [str(kind) for kind in frames[0].dtypes] == ["int64"] * 3
    assert [*frames[0].columns] == ["a", "b", "c"]


def test_large_shards_have_several_row_groups(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(formats, "_GROUP", 64)
    tiled = liftmesh.tile(POINTS, tmp_path, shards="parquet")
    assert np.array_equal(tiled.to_array(), liftmesh.tile(POINTS, tmp_path / "npy").to_array())


def test_ply_is_refused_where_rows_do_not_fit(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=r"PLY has no 64-bit integers .* 2,147,483,649 rows"):
        formats.check_format("ply", 2**31 + 1)
    formats.check_format("ply", 2**31)
    formats.check_format("npy", 2**40)
    monkeypatch.setattr(formats, "_MOST_ROWS", 600)
    with pytest.raises(InputError, match=r"of 700 rows, only of 600: give shards='npy'"):
        liftmesh.tile(POINTS, tmp_path / "out", shards="ply")
    assert not (tmp_path / "out").exists()


def test_options_that_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for options, message in (
        ({"shards": "obj"}, "shards is 'obj': give one of 'npy', 'parquet', 'ply'"),
        ({"neighbors": "yes"}, "neighbors is 'yes': give True or False"),
    ):
        with pytest.raises(InputError, match=message):
            liftmesh.tile(POINTS, tmp_path / "out", **options)  # type: ignore[arg-type]
    tiled = liftmesh.tile(POINTS, tmp_path / "out", tile_rows=300)
    with pytest.raises(InputError, match="has no neighbours: tile again with neighbors=True"):
        tiled.neighbors_to_array()
    for again, message in (
        ({"shards": "ply"}, "holds the triangles with shard_format 'npy', not 'ply'"),
        ({"neighbors": True}, "holds the triangles with neighbors False, not True"),
    ):
        with pytest.raises(InputError, match=message):
            liftmesh.tile(POINTS, tmp_path / "out", **again)  # type: ignore[arg-type]
    replaced = liftmesh.tile(POINTS, tmp_path / "out", resume=False, shards="ply", neighbors=True)
    assert {path.name for path in (tmp_path / "out").iterdir()} >= {
        path.name for path in replaced.shards
    }
    assert not list((tmp_path / "out").glob("tile-00001*.npy"))
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", None)
    with pytest.raises(MissingDependencyError, match=r"pip install 'liftmesh\[dask\]'"):
        liftmesh.tile(POINTS, tmp_path / "parquet", shards="parquet")


@pytest.mark.parametrize("shards", FORMATS)
def test_damaged_files_are_named_and_made_again(shards: ShardFormat, tmp_path: Path) -> None:
    tiled = liftmesh.tile(POINTS, tmp_path, tile_rows=300, shards=shards, neighbors=True)
    before = contents(tmp_path)
    for name in (tiled.shards[1].name, "tile-00001-neighbors.npy", "seam-00000-links.npy"):
        (tmp_path / name).write_bytes(before[name][: len(before[name]) // 2])
        with pytest.raises(FormatError, match=rf"{name}: "):
            liftmesh.open_tiled(tmp_path)
        with pytest.raises(FormatError, match=rf"{name}: damaged"):
            [*tiled.iter_blocks(), *tiled.iter_neighbor_blocks()]
        liftmesh.tile(POINTS, tmp_path, tile_rows=300, shards=shards, neighbors=True)
        assert contents(tmp_path) == before


def other_row(neighbors: np.ndarray) -> np.ndarray:
    at = tuple(np.argwhere(neighbors >= 0)[3])
    neighbors[at] = (neighbors[at] + 1) % len(neighbors)
    return neighbors


def not_stated(neighbors: np.ndarray) -> np.ndarray:
    neighbors[tuple(np.argwhere(neighbors >= 0)[3])] = -1
    return neighbors


def stated_on_the_hull(neighbors: np.ndarray) -> np.ndarray:
    neighbors[tuple(np.argwhere(neighbors < 0)[0])] = 0
    return neighbors


def too_large(neighbors: np.ndarray) -> np.ndarray:
    return np.where(neighbors == neighbors.max(), 10**6, neighbors).astype(np.int32)


CHANGES: dict[str, tuple[str, Callable[[np.ndarray], np.ndarray]]] = {
    "another row": ("neighbors", other_row),
    "a row that is not stated": ("neighbors", not_stated),
    "a row beyond the hull": ("neighbors", stated_on_the_hull),
    "no row": ("neighbors", too_large),
    "rows of another shard": ("neighbors", lambda neighbors: neighbors[1:]),
    "a link is missing": ("links", lambda links: links[1:]),
    "a link to another shard": ("links", lambda links: np.add(links, (0, 1, 0))),
    "a link to another row": ("links", lambda links: np.add(links, (0, 0, 1))),
}


@pytest.mark.parametrize("change", CHANGES)
def test_wrong_neighbors_are_found(change: str, tmp_path: Path) -> None:
    tiled = liftmesh.tile(POINTS, tmp_path, tile_rows=300, neighbors=True)
    what, make = CHANGES[change]
    for stem in ("tile-00001", "seam-00000"):
        path = tmp_path / f"{stem}-{what}.npy"
        whole = path.read_bytes()
        np.save(path, make(np.load(path)))
        assert {flaw.kind for flaw in tiled.verify(POINTS).flaws} == {
            "damaged_files",
            "other_neighbors",
        }
        path.write_bytes(whole)
    assert tiled.verify(POINTS)


def test_a_neighbor_at_the_same_corner_is_not_enough(tmp_path: Path) -> None:
    tiled = liftmesh.tile(POINTS, tmp_path, tile_rows=300, neighbors=True)
    triangles, path = np.load(tiled.shards[0]), tmp_path / "tile-00000-neighbors.npy"
    stated = np.load(path)
    triangle, side = np.argwhere((stated >= 0).all(axis=1)[:, None] & [True] * 3)[0]
    for turn in (1, 2):
        at_corner = np.flatnonzero(
            (triangles == triangles[triangle, (side + turn) % 3]).any(axis=1)
        )
        for other in set(at_corner.tolist()) - {int(stated[triangle, side])}:
            wrong = stated.copy()
            wrong[triangle, side] = other
            np.save(path, wrong)
            flaws = {flaw.kind: flaw.count for flaw in tiled.verify(POINTS).flaws}
            assert flaws["other_neighbors"] == 1


def test_links_are_ascending_and_mutual(tmp_path: Path) -> None:
    tiled = liftmesh.tile(POINTS, tmp_path, tile_rows=90, neighbors=True)
    found = set()
    for shard, path in enumerate(tiled.shards):
        links = np.load(tmp_path / f"{path.stem}-links.npy")
        assert (np.diff(links[:, 0]) > 0).all()
        assert (links[:, 1] != shard).all()
        found |= {(shard, code // 3, *beyond) for code, *beyond in links.tolist()}
    assert found
    assert found == {(there, at, shard, row) for shard, row, there, at in found}


def test_edges_in_the_same_direction_are_no_pair() -> None:
    edges = np.array([[4, 9, 0, 0], [4, 9, 1, 7], [9, 5, 0, 1], [5, 9, 2, 3]])
    links, left = paired(edges)
    assert links.tolist() == [[2, 3, 0, 1]]
    assert left.tolist() == edges[:2].tolist()


def test_vertices_of_ply_are_held_against_the_source(tmp_path: Path) -> None:
    tiled = liftmesh.tile(POINTS, tmp_path, tile_rows=300, shards="ply")
    cloud = liftmesh.read(tiled.shards[0])
    moved = np.array(cloud.points)
    moved[4, 1] = np.nextafter(moved[4, 1], 99)
    liftmesh.write(
        tiled.shards[0], liftmesh.Cloud(moved, faces=cloud.faces, attributes=cloud.attributes)
    )
    assert {flaw.kind for flaw in tiled.verify(POINTS).flaws} == {
        "damaged_files",
        "other_coordinates",
    }
