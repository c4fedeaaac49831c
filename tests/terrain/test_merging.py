"""`merge`: all rows in order, what every cloud has, and never two coordinate systems."""

from __future__ import annotations

import json
import re
import shutil
import tracemalloc
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from commands import liftmesh as command
from files.las import encoded, geo_keys, record, records, with_records

import liftmesh
from liftmesh import Cloud, DataWarning, InputError
from liftmesh.crs.comparison import is_same

ROWS = np.array([[0, 0, 1], [4, 0, 2], [0, 4, 3.0]])
FEET = 'PROJCS["US survey",GEOGCS["NAD83",UNIT["degree",0.0174532925199433]],UNIT["foot",0.3048]]'


def test_rows_in_order_and_values_that_all_have() -> None:
    one = Cloud(ROWS, attributes={"a": np.arange(3, dtype=np.uint8), "b": np.arange(3)})
    two = Cloud(ROWS + np.array([2, 2, 0]), attributes={"a": np.array([300, 301, 302], np.int32)})
    found = liftmesh.merge([one, two])
    assert np.array_equal(found.points, np.vstack([one.points, two.points]))
    assert found.attributes["a"].tolist() == [0, 1, 2, 300, 301, 302]
    assert found.metadata["not_read"] == ("b (not in cloud 1)",)
    assert found.metadata["merged"] == [
        {"source": "cloud 0", "rows": 3, "overlap": 0},
        {"source": "cloud 1", "rows": 3, "overlap": 1},
    ]


@pytest.mark.parametrize("crs", [None, "EPSG:25832"])
@pytest.mark.parametrize(("step", "is_far"), [(3, False), (40, False), (45, True), (1e300, True)])
def test_clouds_that_are_far_apart_are_told(crs: str | None, step: float, is_far: bool) -> None:
    one, two = (Cloud(ROWS + np.array([k * step, 0, 0]), crs=crs) for k in range(2))
    clouds = [one, Cloud(np.full((1, 3), np.nan), crs=crs), two]
    if not is_far or crs:
        merged = liftmesh.merge(clouds).metadata["merged"]
    else:
        with pytest.warns(DataWarning, match=r"cloud 2 is .* away from cloud 0, and neither sta"):
            merged = liftmesh.merge(clouds).metadata["merged"]
    told = [each.get("distance") for each in merged]
    assert told == [None, None, step - 4 if is_far and not crs else None]


def test_the_command_line_tells_that_files_are_far_apart(tmp_path: Path) -> None:
    for name, step in (("a.csv", 0), ("b.csv", 1000)):
        np.savetxt(tmp_path / name, ROWS + np.array([step, 0, 0]), delimiter=",")
    told = command("triangulate", "a.csv", "b.csv", "all.ply", cwd=tmp_path).stderr
    assert "a.csv: 3 rows\n" in told
    assert "b.csv: 3 rows, 996 away from all earlier files, and none states a coordinate" in told


def strips() -> list[Cloud]:
    """Two diagonal strips, whose boxes overlap nearly whole, and they in the middle alone."""
    rng = np.random.default_rng(2)
    along, across = rng.random((2, 40_000)) * [[2000], [100]]
    flown = [(along - across, along + across), (along + across, 2000 - along + across)]
    return [
        Cloud(
            np.column_stack([x + 500000, y + 5.4e6, x * 0]),
            attributes={"point_source_id": np.full(40_000, k, np.uint16)},
        )
        for k, (x, y) in enumerate(flown)
    ]


@pytest.mark.parametrize("far", [False, True])
def test_overlap_is_counted_where_rows_are(far: bool) -> None:
    one, two = strips()
    if far:  # one row that makes the box huge, and so cells
        points = np.vstack([one.points, [[9e9, 9e9, 0], [np.nan, 0, 0]]])
        ids = np.append(one.attributes["point_source_id"], [0, 0])
        one = replace(one, points=points, attributes={"point_source_id": ids})
    found = liftmesh.merge([one, two]).metadata
    flown = found["flight_lines"]
    assert flown["lines"] == 2
    cell = flown["cell"]
    low = np.nanmin(np.vstack([one.points, two.points])[:, :2], axis=0)
    rows = [np.floor((each.points[:, :2] - low) / cell).tolist() for each in (one, two)]
    cells = [{*map(tuple, each)} for each in rows]
    expected = sum(tuple(each) in cells[0] for each in rows[1])
    assert found["merged"][1]["overlap"] == expected
    assert flown["overlap"] == expected + sum(tuple(each) in cells[1] for each in rows[0])
    if not far:
        assert 0.02 < expected / 40_000 < 0.2


def test_merging_takes_the_memory_of_one_column_more() -> None:
    rows = np.random.default_rng(1).random((100_000, 3))
    values = {f"value {k}": rows[:, 0] * k for k in range(5)}
    made = (Cloud(rows + k, attributes={n: v + k for n, v in values.items()}) for k in range(6))
    tracemalloc.start()
    try:
        found = liftmesh.merge(made)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    held = found.points.nbytes + sum(each.nbytes for each in found.attributes.values())
    assert len(found) == 600_000
    assert peak < 1.5 * held


def test_faces_and_edges_are_left_out_and_named() -> None:
    mesh = Cloud(np.eye(3), faces=np.array([[0, 1, 2]]), edges=np.array([[0, 1]]))
    assert liftmesh.merge([np.eye(3), mesh]).metadata["not_read"] == ("faces", "edges")


def test_types_that_nothing_holds_are_left_out() -> None:
    one = Cloud(ROWS, attributes={"n": np.array([2**63 + 1, 0, 1], np.uint64)})
    two = Cloud(ROWS, attributes={"n": np.array([-1, 0, 1])})
    found = liftmesh.merge([one, two])
    assert found.metadata["not_read"] == ("n (of different types)",)
    assert not found.attributes


def test_colours_of_different_types() -> None:
    one = Cloud(ROWS, colors=np.array([[0, 51, 255]] * 3, np.uint8))
    two = Cloud(ROWS, colors=np.array([[0, 13107, 65535, 0]] * 3, np.uint16))
    found = liftmesh.merge([one, two]).colors
    assert found is not None
    assert found.tolist() == [[0, 0.2, 1, 1]] * 3 + [[0, 0.2, 1, 0]] * 3
    dark = Cloud(ROWS, colors=np.array([[0, 51, 255]] * 3, np.uint16), color_depth=16)
    both = liftmesh.merge([dark, dark])
    assert both.color_depth == 16
    assert both.colors is not None
    assert both.colors.dtype == np.uint16


def test_different_coordinate_systems_are_refused() -> None:
    one, two = Cloud(ROWS, crs="EPSG:25832"), Cloud(ROWS, crs=FEET)
    with pytest.raises(
        InputError, match=r"UTM zone 32N \(metre\) and US survey \(foot\): give dst_crs="
    ):
        liftmesh.merge([one, two])


def test_the_same_system_in_other_words() -> None:
    from pyproj import CRS

    wkt = CRS("EPSG:25832").to_wkt("WKT1_GDAL")
    assert is_same(wkt, "EPSG:25832")
    assert liftmesh.merge([Cloud(ROWS, crs=wkt), Cloud(ROWS, crs="EPSG:25832")]).crs == wkt


def test_a_cloud_without_a_system_is_warned_of() -> None:
    with pytest.warns(DataWarning, match="cloud 1 without a coordinate system"):
        found = liftmesh.merge([Cloud(ROWS, crs="EPSG:25832"), ROWS])
    assert found.crs == "EPSG:25832"


def test_metadata_that_all_say_alike() -> None:
    one = Cloud(ROWS, metadata={"survey": 2024, "by": "a"})
    found = liftmesh.merge([one, replace(one, metadata={"survey": 2024, "by": "b"})])
    assert found.metadata["survey"] == 2024
    assert found.metadata["not_read"] == ("metadata by",)


def test_nothing_to_merge() -> None:
    with pytest.raises(InputError, match="there is no cloud to merge"):
        liftmesh.merge([])
    with pytest.raises(InputError, match="clouds is 5: give a list of clouds or paths"):
        liftmesh.merge(5)  # type: ignore[arg-type]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    rng = np.random.default_rng(0)
    key = record(b"LASF_Projection", 34735, geo_keys(k1024=1, k3072=25832))
    for k in range(3):
        points = np.round(rng.random((200, 3)) * (60, 50, 5) + (500000 + 50 * k, 5400000, 0), 2)
        las = records(points, classification=np.resize([2, 5], 200).astype(np.uint8))
        (tmp_path / f"tile{k}.las").write_bytes(with_records(encoded(las), key))
    return tmp_path


def test_the_command_merges_tiles(folder: Path) -> None:
    tiles = [folder / f"tile{k}.las" for k in range(3)]
    done = command("triangulate", *(each.name for each in tiles), "tin.ply", "--json", cwd=folder)
    assert done.returncode == 0
    report = json.loads(done.stdout)
    mesh = liftmesh.read(folder / "tin.ply")
    ground = [liftmesh.read(each, classes=2).points for each in tiles]
    assert np.array_equal(mesh.points, np.vstack(ground))
    assert mesh.crs == "EPSG:25832"
    inside = np.count_nonzero(ground[1][:, 0] <= ground[0][:, 0].max())
    assert inside / 2 < report["merged"][1]["overlap"] < 3 * inside
    assert "flight lines" not in done.stderr  # one
    for k, each in enumerate(strips()):
        liftmesh.write(folder / f"strip{k}.las", each)
    flown = command("triangulate", "strip0.las", "strip1.las", "new.ply", cwd=folder)
    assert re.search(r": 2 flight lines; [\d,]+ rows are in cells of size ", flown.stderr)
    assert "tile1.las: 100 rows, " in done.stderr
    assert report["n_rows"] == 300
    assert report["selection"] == {"rows": 600, "selected": 300, "classes": 300, "ground": 1}
    assert done.stderr.count("ground (class 2): 100 of 200 rows") == 3


def test_the_command_refuses_mixed_systems_and_files_twice(folder: Path) -> None:
    moved = liftmesh.read(folder / "tile0.las", dst_crs="EPSG:25833")
    liftmesh.write(folder / "moved.laz", moved)
    done = command("triangulate", "tile0.las", "moved.laz", "tin.ply", cwd=folder)
    assert done.returncode == 3
    assert done.stderr.splitlines()[-1].endswith("give --dst-crs, which transforms both")
    words = ("triangulate", "tile0.las", "moved.laz", "tin.ply", "--dst-crs", "EPSG:25832")
    assert command(*words, cwd=folder).returncode == 0
    done = command("triangulate", "tile0.las", "tile0.las", "new.ply", cwd=folder)
    assert (done.returncode, "tile0.las is given twice" in done.stderr) == (2, True)
    other = f"../{folder.name}/tile0.las"
    done = command("triangulate", "tile0.las", other, "new.ply", cwd=folder)
    assert (done.returncode, f"{other} is given twice, as tile0.las" in done.stderr) == (2, True)


def test_the_system_of_files_that_state_none(folder: Path) -> None:
    plain = replace(liftmesh.read(folder / "tile0.las"), crs=None)
    liftmesh.write(folder / "plain.las", plain)
    words = ("triangulate", "tile1.las", "plain.las", "tin.ply", "--overwrite", "--src-crs")
    assert command(*words, "EPSG:25832", cwd=folder).returncode == 0
    done = command(*words, "EPSG:25833", cwd=folder)
    assert done.returncode == 3
    assert "tile1.las and plain.las have different coordinate systems" in done.stderr
    both = command(*words, "EPSG:25833", "--dst-crs", "EPSG:25832", cwd=folder)
    assert both.returncode == 0
    moved = liftmesh.read(
        folder / "plain.las", classes=2, src_crs="EPSG:25833", dst_crs="EPSG:25832"
    )
    kept = liftmesh.read(folder / "tile1.las", classes=2)
    expected = np.vstack([kept.points, moved.points])
    assert np.array_equal(liftmesh.read(folder / "tin.ply").points, expected)


def test_only_one_states_heights(folder: Path) -> None:
    high = replace(liftmesh.read(folder / "tile0.las"), crs="EPSG:25832+7837")
    liftmesh.write(folder / "high.las", high)
    for words in ((), ("--dst-crs", "EPSG:25833")):
        done = command("triangulate", "tile1.las", "high.las", "tin.ply", *words, cwd=folder)
        assert done.returncode == 3
        assert done.stderr.splitlines()[-1].endswith(
            "are the same in the plane, but only high.las states what heights are: say it "
            "of the other with --src-crs, such as EPSG:7415"
        )
    words = ("--dst-crs", "EPSG:25832+7837")
    done = command("triangulate", "tile1.las", "high.las", "tin.ply", *words, cwd=folder)
    assert "states what heights are, but nothing says their unit in the file" in done.stderr
    words = ("--src-crs", "EPSG:25832+7837")
    done = command("triangulate", "tile1.las", "high.las", "tin.ply", *words, cwd=folder)
    assert done.returncode == 0
    taken = "tile1.las: states ETRS89 / UTM zone 32N; taken as ETRS89 / UTM zone 32N + DHHN2016"
    assert taken in done.stderr


def test_an_input_is_never_overwritten(folder: Path) -> None:
    shutil.copy(folder / "tile0.las", folder / "kept.las")
    done = command("triangulate", "tile0.las", "kept.las", "kept.las", cwd=folder)
    assert done.returncode == 2
    assert "are the same file" in done.stderr


def test_an_error_names_the_row_of_the_file(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("x,y,z\n0,0,1\n1,0,1\n0,1,1\n")
    (tmp_path / "b.csv").write_text("x,y,z\n5,5,1\nnan,5,1\n")
    done = command("triangulate", "a.csv", "b.csv", "tin.ply", cwd=tmp_path)
    assert done.returncode == 3
    assert "row 1 of b.csv" in done.stderr


def test_rows_left_out_by_a_step_are_said(folder: Path) -> None:
    done = command("triangulate", "tile0.las", "tin.ply", "--every", "10", cwd=folder)
    assert "left out: 100 of other classes, 90 by --every\n" in done.stderr


def test_many_files_have_few_notes(tmp_path: Path) -> None:
    names = [f"{k}.csv" for k in range(20)]
    for k, name in enumerate(names):
        (tmp_path / name).write_text(f"E,N,h,id\n{k},0,1,a\n{k},1,2,b\n" + "9,9,9,x\n" * k)
    done = command("triangulate", *names, "all.ply", cwd=tmp_path)
    lines = done.stderr.splitlines()
    assert sum("x is 'E', y is 'N', z is 'h'" in each for each in lines) == 4
    assert "liftmesh: note: 17 more files, as 2.csv: x is 'E', y is 'N', z is 'h'" in lines
    assert len(lines) < 20
    few = command("triangulate", *names[:3], "few.ply", cwd=tmp_path).stderr
    assert "more file" not in few
    assert few.count("x is 'E'") == 3
