"""Surfaces in tiles: the triangles, values and report of one call, from every source."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from commands import liftmesh as command
from tiled_surfaces import POLICIES, check, steep_cloud

import liftmesh
from liftmesh import Cloud, TiledSurface
from liftmesh.errors import (
    DataWarning,
    DegenerateInputError,
    DuplicateHeightError,
    InputError,
    NonFiniteError,
)
from liftmesh.tiles import schedule, shards, sorted_chunks, surface_raster

CLOUD = steep_cloud()
POINTS = CLOUD.points
RAISED = POINTS + np.array([0, 0, 1])


@pytest.mark.parametrize("policy", POLICIES)
def test_every_policy_is_that_of_one_call(policy: Any, tmp_path: Path) -> None:
    expected = liftmesh.triangulate(CLOUD, on_duplicate=policy)
    assert expected.report.n_overhangs > 300 < expected.report.n_used
    for tile_rows in (60, 5_000):
        out = tmp_path / str(tile_rows)
        found = liftmesh.tile_surface(CLOUD, out, on_duplicate=policy, tile_rows=tile_rows)
        check(found, expected)
        check(liftmesh.open_tiled(out), expected)  # type: ignore[arg-type]
        names = {path.name for path in out.iterdir()}
        vertices = {f"{path.stem}-vertices.npy" for path in found.shards}
        vertices |= {f"{path.stem}-faces.npy" for path in found.shards}
        lists = {"duplicates.npy", "skipped.npy", "hull.npy", "plan.json", "manifest.json"}
        assert names == {path.name for path in found.shards} | vertices | lists


@pytest.mark.parametrize("seed", range(10))
def test_tiny_clouds_with_ties_and_repeated_positions(seed: int, tmp_path: Path) -> None:
    """Chunks of any size cut groups of equal positions anywhere; so do tiles not at all."""
    rng = np.random.default_rng(seed)
    rows = int(rng.integers(8, 260))
    cloud = steep_cloud(seed, rows, side=int(rng.integers(3, 12)))
    points = cloud.points.copy()
    points[rng.integers(0, rows, 2)] = [np.nan, 1, 2]
    points[rng.integers(0, rows, 2), 2] = np.inf
    policy: Any = POLICIES[seed % 5]
    expected = liftmesh.triangulate(points, on_duplicate=policy, nonfinite="skip")
    chunks = iter(np.split(points, np.sort(rng.integers(0, rows, 3))))
    options: dict[str, Any] = {"on_duplicate": policy, "nonfinite": "skip"}
    found = liftmesh.tile_surface(chunks, tmp_path, tile_rows=16, **options)
    check(found, expected)
    assert found.verify(points).canonical


def mesh(folder: Path, name: str) -> Path:
    liftmesh.write(folder / name, CLOUD)
    return folder / name


def npy(folder: Path, array: Any) -> Path:
    np.save(folder / "points.npy", array)
    return folder / "points.npy"


def parquet(folder: Path) -> Path:
    frame().to_parquet(folder / "points.parquet", row_group_size=170)
    return folder / "points.parquet"


def frame() -> pd.DataFrame:
    columns = dict(zip("xyz", POINTS.T, strict=True))
    colors = dict(zip(("red", "green", "blue"), CLOUD.colors.T, strict=True))
    return pd.DataFrame({"class": CLOUD.attributes["classification"], **columns, **colors})


SOURCES: dict[str, Callable[[Path], object]] = {
    "array": lambda _: POINTS,
    "planar points": lambda _: POINTS[:, :2],
    "table": lambda _: frame(),
    "NPY": lambda folder: npy(folder, POINTS),
    "NPY by columns": lambda folder: npy(folder, np.asfortranarray(POINTS)),
    "NPY of two columns": lambda folder: npy(folder, POINTS[:, :2]),
    "NPY in single precision": lambda folder: npy(folder, POINTS.astype(np.float32)),
    "mapped array": lambda folder: np.load(npy(folder, POINTS), mmap_mode="r"),
    "PLY": lambda folder: mesh(folder, "points.ply"),
    "NPZ": lambda folder: mesh(folder, "points.npz"),
    "text": lambda folder: mesh(folder, "points.csv"),
}


@pytest.mark.parametrize("kind", SOURCES)
def test_every_source_is_that_of_one_call(kind: str, tmp_path: Path) -> None:
    source = SOURCES[kind](tmp_path)
    expected = liftmesh.triangulate(source, on_duplicate="lowest")
    found = liftmesh.tile_surface(source, tmp_path / "out", on_duplicate="lowest", tile_rows=200)
    check(found, expected)
    again = None if isinstance(source, Path) else source
    assert found.verify(source if again is not None else None).canonical


def test_parquet_is_that_of_its_table(tmp_path: Path) -> None:
    found = liftmesh.tile_surface(parquet(tmp_path), tmp_path / "out", tile_rows=200)
    check(found, liftmesh.triangulate(frame()))
    assert found.verify().canonical


def test_whole_numbers_of_parquet_that_are_missing_in_one_batch(tmp_path: Path) -> None:
    """They are doubles in all batches, whatever the row groups are."""
    numbers = frame().rename(columns={"class": "number"}).astype({"number": "Int64"})
    numbers.loc[400:460, "number"] = None
    numbers.to_parquet(tmp_path / "points.parquet")
    found = liftmesh.tile_surface(tmp_path / "points.parquet", tmp_path / "out", tile_rows=200)
    expected = numbers["number"].to_numpy(np.float64, na_value=np.nan)
    column = np.concatenate([each.attributes["number"] for each in found.iter_meshes()])
    assert np.isnan(column).any()
    assert column.dtype == np.float64
    assert {*column[~np.isnan(column)]} == {*expected[~np.isnan(expected)]}


def test_rows_of_lidar_files_are_selected_as_they_are_read(tmp_path: Path) -> None:
    names = ["a.laz", "b.las"]
    kept = {name: CLOUD.attributes[name] for name in ("classification",)}
    plain = Cloud(POINTS, attributes=kept, crs=CLOUD.crs)
    for name, rows in zip(names, (slice(0, 500), slice(500, None)), strict=True):
        liftmesh.write(tmp_path / name, plain.select(rows))
    paths = [tmp_path / name for name in names]
    options: dict[str, Any] = {"classes": (1, 3), "bounds": [0, 0, 18, 21]}
    clouds = [liftmesh.read(path, **options) for path in paths]
    whole = Cloud(
        np.concatenate([each.points for each in clouds]),
        attributes={
            name: np.concatenate([each.attributes[name] for each in clouds])
            for name in clouds[0].attributes
        },
        crs=clouds[0].crs,
    )
    found = liftmesh.tile_surface(
        paths, tmp_path / "out", on_duplicate="highest", tile_rows=100, **options
    )
    check(found, liftmesh.triangulate(whole, on_duplicate="highest"))
    assert found.manifest["surface"]["reading"] == {"classes": [1, 3], "bounds": [0, 0, 18, 21]}
    assert [each["rows"] for each in found.manifest["source"]] == [len(each) for each in clouds]
    assert found.verify().canonical


def lidar(folder: Path, name: str, rows: slice, classes: list[int]) -> Path:
    points = POINTS[rows]
    found = np.resize(np.array(classes, np.uint8), len(points))
    liftmesh.write(folder / name, Cloud(points, attributes={"classification": found}))
    return folder / name


def test_the_ground_of_lidar_files_is_taken_as_by_triangulate(tmp_path: Path) -> None:
    """By the library and the command, for one file and for several."""
    one = lidar(tmp_path, "a.laz", slice(0, 500), [2, 5, 1])
    other = lidar(tmp_path, "b.las", slice(500, None), [5, 2])
    bare = lidar(tmp_path, "c.las", slice(0, 300), [0])
    found = liftmesh.tile_surface(one, tmp_path / "one", tile_rows=100)
    alone = liftmesh.triangulate(one)
    check(found, alone)
    assert found.report.classes == alone.report.classes == {2: 167}
    assert liftmesh.open_tiled(tmp_path / "one").verify().canonical
    both = liftmesh.tile_surface([one, other], tmp_path / "both", tile_rows=100)
    ground = liftmesh.merge([liftmesh.read(each, classes=2) for each in (one, other)])
    assert both.classes == {2: len(ground)}
    assert both.npoints == len(ground)
    assert both.verify([one, other]).canonical
    every = liftmesh.tile_surface(one, tmp_path / "all", classes="all", tile_rows=100)
    assert every.report.classes == {1: 166, 2: 167, 5: 167}
    assert liftmesh.tile_surface(bare, tmp_path / "bare", tile_rows=100).classes == {0: 300}
    with pytest.raises(InputError, match=r"c\.las: no ground \(class 2\), while other files"):
        liftmesh.tile_surface([one, bare], tmp_path / "mixed", tile_rows=100)
    assert not (tmp_path / "mixed").exists()
    done = command("tile", one, tmp_path / "cli", "--surface", "--tile-rows", 100)
    assert "2 ground 167" in done.stdout
    assert liftmesh.open_tiled(tmp_path / "cli").to_array().tolist() == found.to_array().tolist()


@pytest.mark.slow
@pytest.mark.parametrize("policy", POLICIES)
def test_neighbors_are_those_of_one_call(policy: Any, tmp_path: Path) -> None:
    """Triangles name the rows that the policy chooses; which of them share an edge is the same."""
    found = liftmesh.tile_surface(
        CLOUD, tmp_path, on_duplicate=policy, tile_rows=60, neighbors=True
    )
    check(found, liftmesh.triangulate(CLOUD, on_duplicate=policy))
    triangles, neighbors = found.to_array(), found.neighbors_to_array()
    edges = {(t[k - 2], t[k - 1]): i for i, t in enumerate(triangles.tolist()) for k in range(3)}
    beyond = [[edges.get((t[k - 1], t[k - 2]), -1) for k in range(3)] for t in triangles.tolist()]
    assert neighbors.tolist() == beyond
    assert found.verify(CLOUD).canonical
    path = tmp_path / f"{found.shards[1].stem}-neighbors.npy"
    np.save(path, np.roll(np.load(path), 1, axis=0))
    assert "other_neighbors" in {flaw.kind for flaw in found.verify(CLOUD).flaws}


def test_values_may_have_any_names(tmp_path: Path) -> None:
    values = {name: np.arange(1_200) for name in ("Höhe", "高さ", "it's", "a\nb")}
    cloud = Cloud(POINTS, attributes=values)
    found = liftmesh.tile_surface(cloud, tmp_path, tile_rows=150)
    check(found, liftmesh.triangulate(cloud))
    assert found.verify(cloud).canonical
    assert np.load(tmp_path / f"{found.shards[0].stem}-vertices.npy")["高さ"].max() < 1_200


def test_a_shard_is_a_mesh_by_itself(tmp_path: Path) -> None:
    found = liftmesh.tile_surface(CLOUD, tmp_path, tile_rows=150)
    for mesh, triangles in zip(found.iter_meshes(), found.iter_blocks(), strict=True):
        assert mesh.faces is not None
        assert np.array_equal(mesh.attributes["row"][mesh.faces], triangles)
        assert mesh.colors is not None
        assert mesh.colors.dtype == np.uint16
        part = liftmesh.as_surface(Cloud(mesh.points, faces=mesh.faces))
        assert len(part.faces) == len(triangles)


def test_bytes_depend_on_rows_and_options_alone(tmp_path: Path) -> None:
    one = liftmesh.tile_surface(CLOUD, tmp_path / "a", tile_rows=90, threads=1)
    pieces = (CLOUD.select(slice(i, i + 7)) for i in range(0, len(CLOUD), 7))
    other = liftmesh.tile_surface(
        pieces, tmp_path / "b", tile_rows=90, threads=2, scratch=tmp_path / "scratch"
    )
    for path in one.shards:
        for name in (path.name, f"{path.stem}-vertices.npy", f"{path.stem}-faces.npy"):
            assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    assert one.manifest["shards"] == other.manifest["shards"]
    assert list((tmp_path / "scratch").iterdir()) == []


def test_rows_at_one_position_that_must_not_differ(tmp_path: Path) -> None:
    points = np.random.default_rng(4).random((900, 3))
    points[700] = points[20]
    found = liftmesh.tile_surface(points, tmp_path / "a", on_duplicate="error", tile_rows=90)
    check(found, liftmesh.triangulate(points, on_duplicate="error"))
    points[700, 2] += 1
    with pytest.raises(DuplicateHeightError, match="rows 20 and 700 share the planar") as caught:
        liftmesh.tile_surface(points, tmp_path / "b", on_duplicate="error", tile_rows=90)
    assert caught.value.rows == (20, 700)
    points[100:500, :2] = points[20, :2]  # most of them in no tile
    points[100:500, 2] = points[20, 2]
    with pytest.raises(DuplicateHeightError, match="rows 20 and 700 share the planar"):
        liftmesh.tile_surface(points, tmp_path / "c", on_duplicate="error", tile_rows=90)


def test_heights_that_are_not_finite(tmp_path: Path) -> None:
    points = POINTS.copy()
    points[333, 2] = np.nan
    with pytest.raises(NonFiniteError, match=r"row 333 is not finite") as caught:
        liftmesh.tile_surface(points, tmp_path / "a", tile_rows=100)
    with pytest.raises(NonFiniteError) as one:
        liftmesh.triangulate(points)
    assert (str(caught.value), caught.value.row) == (str(one.value), 333)
    found = liftmesh.tile_surface(points, tmp_path / "b", tile_rows=100, nonfinite="skip")
    check(found, liftmesh.triangulate(points, nonfinite="skip"))
    assert found.skipped.tolist() == [333]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"plane": "fit"}, "plane is 'fit': surfaces in tiles are over x and y"),
        ({"plane": [0, 0, 1]}, "surfaces in tiles are over x and y"),
        ({"weights": "intensity"}, "weights is for surfaces in one call: the merges"),
        ({"radii": [1, 2]}, "radii is for surfaces in one call"),
        ({"metric": np.eye(2)}, "metric is for surfaces in one call"),
        ({"max_edge": 3}, "max_edge is for surfaces in one call: what trimming"),
        ({"on_duplicate": "median"}, "on_duplicate is 'median'"),
        ({"crs": ""}, "crs is ''"),
        ({"crs": "EPSG:4978"}, "geocentric"),
        ({"classes": 2}, "classes: options of files, and there is no file"),
        ({"bounds": object()}, "bounds is <object"),
        ({"tile_rows": 3}, "tile_rows"),
        ({"shards": "parquet"}, "shards is 'parquet': a surface has NPY, with vertices"),
        ({"shards": "ply"}, "shards is 'ply': a surface has NPY"),
        ({"shards": "obj"}, "shards is 'obj'"),
        ({"neighbors": "yes"}, "neighbors is 'yes'"),
    ],
)
def test_options_that_are_refused(options: Any, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        liftmesh.tile_surface(POINTS, tmp_path / "out", **options)
    assert not (tmp_path / "out" / "manifest.json").exists()


@pytest.mark.parametrize(
    ("cloud", "message"),
    [
        (Cloud(POINTS, attributes={"row": POINTS[:, 0]}), "values named 'row' cannot be kept"),
        (Cloud(POINTS, attributes={"z": POINTS[:, 0]}), "values named 'z' cannot be kept"),
        (Cloud(POINTS, attributes={"colors": POINTS[:, 0]}), "values named 'colors'"),
        (Cloud(POINTS, attributes={"o": np.array([None] * 1_200)}), "'o' are objects of Python"),
        (
            iter([Cloud(POINTS, crs=CLOUD.crs), CLOUD]),
            r"iterator has the values colors \(uint16\(3,\)\)",
        ),
        (iter([Cloud(POINTS), Cloud(POINTS, crs="EPSG:7415")]), "iterator is in 'EPSG:7415'"),
        (
            iter([Cloud(POINTS, colors=np.full((1_200, 3), k, np.int64)) for k in (9, 900)]),
            "colours of 16 bits, what came before of 8: give color_depth=",
        ),
        (np.zeros((9, 3)), "9 rows hold 1 distinct planar point:"),
    ],
)
def test_clouds_that_are_refused(cloud: object, message: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=message):
        liftmesh.tile_surface(cloud, tmp_path / "out", tile_rows=100)


def test_files_that_do_not_go_together(tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "a.ply", Cloud(POINTS))
    liftmesh.write(tmp_path / "b.ply", Cloud(POINTS, attributes={"class": POINTS[:, 0]}))
    with pytest.raises(InputError, match=r"b.ply has the values class .*a.ply has no names"):
        liftmesh.tile_surface([tmp_path / "a.ply", tmp_path / "b.ply"], tmp_path / "out")
    with pytest.raises(DegenerateInputError, match="the source has no rows"):
        liftmesh.tile_surface(tmp_path / "a.ply", tmp_path / "none", bounds=[900, 900, 901, 901])


def test_warnings_and_systems_are_those_of_one_call(tmp_path: Path) -> None:
    with pytest.warns(DataWarning) as one:
        liftmesh.triangulate(POINTS, crs="EPSG:4326")
    with pytest.warns(DataWarning) as other:
        liftmesh.tile_surface(POINTS, tmp_path, crs="EPSG:4326")
    assert [str(each.message) for each in other] == [str(each.message) for each in one]


class DiskFullError(OSError):
    """What writing raises at some point of a run."""


@pytest.mark.parametrize("number", [3, 29, 64, 80])
def test_a_run_that_broke_off_goes_on(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    options: dict[str, Any] = {"on_duplicate": "mean", "tile_rows": 200}
    expected = liftmesh.tile_surface(CLOUD, tmp_path / "expected", **options)
    asked = [0]
    save = schedule.save_array  # the same function in all three

    def failing(path: Path, array: Any) -> str:
        asked[0] += 1
        if asked[0] == number:
            raise DiskFullError(28, "No space left on device", str(path))
        return save(path, array)

    for module in (sorted_chunks, shards, schedule):
        monkeypatch.setattr(module, "save_array", failing)
    with pytest.raises(DiskFullError):
        liftmesh.tile_surface(CLOUD, tmp_path / "out", **options)
    found = liftmesh.tile_surface(CLOUD, tmp_path / "out", **options)
    assert found.manifest == expected.manifest
    assert found.is_sound()
    if number > 20:  # something was kept: all but the task that failed
        broken_off, asked[0] = asked[0], number
        liftmesh.tile_surface(CLOUD, tmp_path / "again", **options)
        assert broken_off < asked[0] + number


def test_what_has_changed_before_a_run_goes_on(tmp_path: Path) -> None:
    path = npy(tmp_path, POINTS)
    liftmesh.tile_surface(path, tmp_path / "out", tile_rows=200)
    with pytest.raises(
        InputError, match="holds the triangles with on_duplicate 'first', not 'last'"
    ):
        liftmesh.tile_surface(path, tmp_path / "out", tile_rows=200, on_duplicate="last")
    with pytest.raises(InputError, match="holds the triangles with crs None, not 'EPSG:7415'"):
        liftmesh.tile_surface(path, tmp_path / "out", tile_rows=200, crs="EPSG:7415")
    with pytest.raises(InputError, match="holds a surface, not triangles alone"):
        liftmesh.tile(path, tmp_path / "out", tile_rows=200)
    npy(tmp_path, RAISED)
    with pytest.raises(InputError, match="holds the triangles of other points"):
        liftmesh.tile_surface(path, tmp_path / "out", tile_rows=200)
    found = liftmesh.tile_surface(path, tmp_path / "out", tile_rows=150, resume=False)
    check(found, liftmesh.triangulate(RAISED))
    liftmesh.tile(path, tmp_path / "out", tile_rows=200, resume=False)
    assert not [*(tmp_path / "out").glob("*-vertices.npy"), *(tmp_path / "out").glob("*-faces.*")]
    with pytest.raises(InputError, match="holds triangles alone, not a surface"):
        liftmesh.tile_surface(path, tmp_path / "out", tile_rows=200)


def broken(tiled: TiledSurface, change: Callable[[Any], None]) -> set[str]:
    """Change the vertices of a shard, and say what the proof finds."""
    path = tiled.folder / f"{tiled.shards[1].stem}-vertices.npy"
    vertices = np.load(path)
    change(vertices)
    np.save(path, vertices)
    return {flaw.kind for flaw in tiled.verify(CLOUD).flaws}


@pytest.mark.parametrize("policy", POLICIES)
def test_heights_and_values_are_proved_against_the_source(policy: Any, tmp_path: Path) -> None:
    found = liftmesh.tile_surface(CLOUD, tmp_path, on_duplicate=policy, tile_rows=150)
    certificate = found.verify(CLOUD)
    assert certificate.canonical
    assert (certificate.n_rows, certificate.n_duplicates) == (1_200, len(found.duplicates))

    def lower(vertices: Any) -> None:
        vertices["z"][3] -= 0.125

    assert broken(found, lower) == {"damaged_files", "other_vertices"}


def test_values_and_rows_that_are_not_those_of_the_source(tmp_path: Path) -> None:
    found = liftmesh.tile_surface(CLOUD, tmp_path, tile_rows=150)

    def swap(vertices: Any) -> None:
        vertices["waveform"][[0, 1]] = vertices["waveform"][[1, 0]] + 1

    assert broken(found, swap) == {"damaged_files", "other_vertices"}
    pairs = np.load(tmp_path / "duplicates.npy")
    pairs[5, 1] = pairs[5, 0]
    np.save(tmp_path / "duplicates.npy", pairs)
    assert broken(found, swap) == {"damaged_files", "other_vertices", "other_duplicates"}
    raised = Cloud(RAISED, CLOUD.colors, CLOUD.normals, CLOUD.attributes)
    with pytest.raises(InputError, match="rows 0 to 149 are not the points that were tiled"):
        found.verify(raised)


def test_rows_are_those_that_the_policy_chooses(tmp_path: Path) -> None:
    """Triangles that name another row of a position are found, though they are Delaunay."""
    found = liftmesh.tile_surface(CLOUD, tmp_path, on_duplicate="lowest", tile_rows=150)
    pairs = np.asarray(found.duplicates)
    for path in found.shards:
        triangles = np.load(path)
        swapped = pairs[np.isin(pairs[:, 1], triangles)]
        if len(swapped):
            triangles[triangles == swapped[0, 1]] = swapped[0, 0]
            np.save(path, triangles)
            break
    kinds = {flaw.kind for flaw in found.verify(CLOUD).flaws}
    assert {"damaged_files", "invalid_index"} <= kinds


@pytest.mark.parametrize("interpolation", ["linear", "nearest", "laplace", "sibson"])
def test_heights_at_points_are_those_of_one_call(tmp_path: Path, interpolation: Any) -> None:
    points = np.random.default_rng(3).random((3000, 3))
    tiled = liftmesh.tile_surface(points, tmp_path, tile_rows=300)
    surface = liftmesh.triangulate(points)
    at = np.random.default_rng(4).random((40, 50, 3)) * 1.2 - 0.1
    at[0, 0] = np.nan
    at[1] = points[:50]
    options: dict[str, Any] = {"interpolation": interpolation, "threads": 1}
    expected = surface.sample(at[..., :2], **options)
    assert 1000 < np.isfinite(expected).sum() < 2000
    np.testing.assert_array_equal(tiled.sample(at[..., :2], **options), expected)
    above = at.reshape(-1, 3)
    expected = surface.height_above(above, **options)
    np.testing.assert_array_equal(tiled.height_above(above, **options), expected)


def test_points_of_few_shards_are_asked_of_few_faces(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A box with too many faces is cut, down to points at one position."""
    points = np.random.default_rng(3).random((3000, 3))
    tiled = liftmesh.tile_surface(points, tmp_path, tile_rows=300)
    monkeypatch.setattr(surface_raster, "_FACES", 1)
    at = np.repeat(points[:100, :2], 3, axis=0)
    np.testing.assert_array_equal(tiled.sample(at), np.repeat(points[:100, 2], 3))
    assert tiled.sample([0.5, 0.5]) == liftmesh.triangulate(points).sample([0.5, 0.5])
    assert tiled.sample(np.empty((0, 2))).shape == (0,)


def test_what_tiles_are_not_asked(tmp_path: Path) -> None:
    tiled = liftmesh.tile_surface(POINTS[:100], tmp_path, on_duplicate="first")
    with pytest.raises(InputError, match="interpolation='c1' needs all vertices at once"):
        tiled.sample([[0, 0]], "c1")
    with pytest.raises(InputError, match="the points have no z"):
        tiled.height_above([[0, 0]])
    with pytest.raises(InputError, match="points need"):
        tiled.sample([0, 0, 0])
