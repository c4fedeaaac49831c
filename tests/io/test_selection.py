"""Rows are selected as a file is read: what stays, what is counted, what is refused."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
from file_samples import assert_same_bits, saved
from files.las import COUNTS, RETURNS, UTM, encoded, records, tile

import liftmesh
from liftmesh import Cloud, FormatError, InputError

COUNT = 600


def lidar(*, compressed: bool = False, count: int = COUNT) -> bytes:
    return encoded(tile(count, point_format=6, version="1.4"), compressed=compressed)


def read(data: bytes, kind: str = "las", **options: Any) -> Cloud:
    return liftmesh.read(io.BytesIO(data), format=kind, **options)


WHOLE = read(lidar())
CLASS, LAST = WHOLE.attributes["classification"], np.resize(RETURNS == COUNTS, COUNT)
x, y, Z = WHOLE.points.T
BOX = (UTM[0] + 200, UTM[1] + 100, UTM[0] + 700, UTM[1] + 900)
INSIDE = (x >= BOX[0]) & (y >= BOX[1]) & (x <= BOX[2]) & (y <= BOX[3])
CASES: dict[str, tuple[dict[str, Any], Any]] = {
    "a class": ({"classes": 2}, CLASS == 2),
    "classes": ({"classes": (2, 9)}, (CLASS == 2) | (CLASS == 9)),
    "classes of numpy": ({"classes": np.array([2, 9])}, (CLASS == 2) | (CLASS == 9)),
    "ground": ({"classes": "ground"}, CLASS == 2),
    "all": ({"classes": "all", "every": 2}, np.arange(COUNT) % 2 == 0),
    "last returns": ({"returns": "last"}, LAST),
    "first returns": ({"returns": "first"}, np.resize(RETURNS == 1, COUNT)),
    "only returns": ({"returns": "only"}, np.resize((RETURNS == 1) & (COUNTS == 1), COUNT)),
    "a box": ({"bounds": BOX}, INSIDE),
    "heights": ({"z_range": (10, 20)}, (Z >= 10) & (Z <= 20)),
    "heights to the top": ({"z_range": (10, np.inf)}, Z >= 10),
    "everything": ({"every": COUNT}, np.arange(COUNT) == 0),
    "beyond everything": ({"every": 10**30}, np.arange(COUNT) == 0),
    "a class in a box": ({"classes": 2, "bounds": BOX}, (CLASS == 2) & INSIDE),
}


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("case", CASES)
def test_rows_that_meet_a_condition(case: str, compressed: bool) -> None:
    options, mask = CASES[case]
    found = read(lidar(compressed=compressed), **options)
    assert 0 < len(found) < COUNT
    assert_same_bits(found.points, WHOLE.points[mask])
    for name, values in WHOLE.attributes.items():
        assert_same_bits(found.attributes[name], values[mask])
    counts = found.metadata["selection"]
    reasons = [key for key in counts if key not in {"rows", "selected", "ground"}]
    assert counts["rows"] == COUNT == counts["selected"] + sum(counts[each] for each in reasons)
    assert counts["selected"] == len(found)


@pytest.mark.parametrize("case", [each for each in CASES if each != "ground"])
@pytest.mark.parametrize("kind", ["las", "npz", "ply"])
def test_other_formats_and_chunks_select_the_same_rows(case: str, kind: str) -> None:
    options, mask = CASES[case]
    kept = ("classification", "return_number", "number_of_returns")
    part = Cloud(WHOLE.points, attributes={name: WHOLE.attributes[name] for name in kept})
    data = lidar() if kind == "las" else saved(part, kind)
    whole = read(data, kind)
    assert_same_bits(read(data, kind, **options).points, whole.points[mask])
    stream = io.BytesIO(data)
    parts = [*liftmesh.read_chunks(stream, rows=77, format=kind, **options)]
    assert_same_bits(np.concatenate([each.points for each in parts]), whole.points[mask])
    assert parts[-1].metadata["selection"]["selected"] == np.count_nonzero(mask)


def test_every_nth_of_the_rows_that_are_left() -> None:
    found = read(lidar(), classes=2, every=7)
    assert_same_bits(found.points, WHOLE.points[CLASS == 2][::7])
    assert found.metadata["selection"]["every"] == np.count_nonzero(CLASS == 2) - len(found)


def test_a_box_and_heights_have_their_borders() -> None:
    points = np.array([[0, 0, 0], [1, 0, 1], [1, 1, 2], [1.5, 1, 3]]) + UTM
    data = encoded(records(points, 0))
    assert len(read(data, bounds=(UTM[0], UTM[1], UTM[0] + 1, UTM[1] + 1))) == 3
    assert len(read(data, z_range=(1, 2))) == 2


def test_ground_that_begins_late() -> None:
    count = 300_000
    las = records(np.zeros((count, 3)) + UTM, 6, version="1.4")
    las.x = np.arange(count) * 0.01 + UTM[0]
    las.classification = np.where(np.arange(count) < 290_000, 1, 2).astype(np.uint8)
    las.withheld = (np.arange(count) % 10 == 0).astype(np.uint8)
    found = read(encoded(las), classes="ground", withheld=False, every=7)
    assert_same_bits(
        found.points[:, 0], np.asarray(las.x)[290_000:][las.withheld[290_000:] == 0][::7]
    )
    assert found.metadata["selection"] == {
        "rows": count, "selected": 1286, "ground": 1, "withheld": 30_000, "classes": 261_000,
        "every": 7714,
    }  # fmt: skip


def test_ground_of_a_file_that_has_none() -> None:
    las = tile(60)
    las.classification = np.full(60, 6, np.uint8)
    found = read(encoded(las), classes="ground")
    assert len(found) == 60
    assert found.metadata["selection"] == {"rows": 60, "selected": 60, "ground": 0}
    table = b"x y z\n1 2 3\n4 5 6\n"
    assert len(read(table, "xyz", classes="ground")) == 2


def test_withheld_rows() -> None:
    las = tile(60)
    las.withheld = (np.arange(60) % 4 == 0).astype(np.uint8)
    data = encoded(las)
    assert len(read(data)) == len(read(data, withheld=True)) == 60
    found = read(data, withheld=False)
    assert not found.attributes["withheld"].any()
    assert found.metadata["selection"] == {"rows": 60, "selected": 45, "withheld": 15}


def test_tables_with_the_names_of_other_programs() -> None:
    header = b"X,Y,Z,Classification,ReturnNumber,NumberOfReturns\n"
    text = header + b"1,2,3,2,1,1\n2,2,3,2,1,2\n3,2,3,6,2,2\n"
    assert read(text, "csv", classes=2).points[:, 0].tolist() == [1, 2]
    assert read(text, "csv", returns="last").points[:, 0].tolist() == [1, 3]


def test_faces_are_left_out_and_named() -> None:
    mesh = Cloud(np.eye(3), faces=np.array([[0, 1, 2]], dtype=np.int32))
    found = read(saved(mesh, "ply"), "ply", every=2)
    assert found.faces is None
    assert found.metadata["not_read"] == ("1 face (rows were selected)",)


def test_edges_that_lose_an_end_are_named() -> None:
    pairs = np.array([[0, 1], [0, 2], [3, 2]], np.int32)
    mesh = Cloud(np.arange(12.0).reshape(4, 3), edges=pairs)
    for found in (read(saved(mesh, "ply"), "ply", every=2), liftmesh.thin(mesh, every=2)):
        assert found.edges is not None
        assert found.edges.tolist() == [[0, 1]]
        assert found.metadata["not_read"] == ("2 edges (rows were selected)",)
    whole = liftmesh.thin(mesh, every=1)
    assert "not_read" not in whole.metadata
    np.testing.assert_array_equal(whole.edges, pairs)


def test_nothing_is_left() -> None:
    found = read(lidar(), classes=200)
    assert len(found) == 0
    assert found.attributes["intensity"].dtype == np.uint16


def test_the_counts_of_a_file_are_not_written_to_another() -> None:
    found = read(lidar(), classes=2)
    assert "selection" not in read(saved(found, "npz"), "npz").metadata


WRONG: dict[str, tuple[dict[str, Any], str]] = {
    "a word": ({"classes": "trees"}, r"classes is 'trees': give numbers from 0 to 255, 'ground'"),
    "a class of 256": ({"classes": [2, 256]}, r"classes is \[2, 256\]: give numbers"),
    "a negative class": ({"classes": -1}, r"classes is -1: give numbers"),
    "no class": ({"classes": []}, r"classes is \[\]: give numbers"),
    "half a class": ({"classes": 2.5}, r"classes is 2.5: give numbers"),
    "true": ({"classes": [True]}, r"classes is \[True\]: give numbers"),
    "returns": ({"returns": "second"}, r"returns is 'second': give one of 'first', 'last', 'only'"),
    "three sides": ({"bounds": (0, 0, 1)}, r"bounds is \(0, 0, 1\): give xmin, ymin, xmax, ymax"),
    "a box inside out": ({"bounds": (1, 0, 0, 1)}, r"bounds is \(1, 0, 0, 1\): give xmin"),
    "a box of NaN": ({"bounds": (np.nan, 0, 0, 1)}, r"bounds is .*: give xmin"),
    "a box of words": ({"bounds": "abcd"}, r"bounds is 'abcd': give xmin"),
    "a height": ({"z_range": 5}, r"z_range is 5: give z0, z1"),
    "heights upside down": ({"z_range": (5, 4)}, r"z_range is \(5, 4\): give z0, z1"),
    "every zeroth": ({"every": 0}, "every is 0: give a whole number from 1"),
    "withheld": ({"withheld": "drop"}, "withheld is 'drop': give True or False"),
}


@pytest.mark.parametrize("case", WRONG)
def test_conditions_that_are_none(case: str) -> None:
    options, message = WRONG[case]
    for reading in (read, lambda data, **given: [*liftmesh.read_chunks(io.BytesIO(data), **given)]):
        with pytest.raises(InputError, match=message):
            reading(lidar(), **options)


def test_chunks_do_not_know_whether_there_is_ground() -> None:
    with pytest.raises(InputError, match="'ground', which the whole file decides: give classes=2"):
        [*liftmesh.read_chunks(io.BytesIO(lidar()), format="las", classes="ground")]


def test_values_that_the_file_does_not_have() -> None:
    table = b"x,y,z,weight\n1,2,3,4\n"
    with pytest.raises(FormatError, match="by class: there is no classification, but weight"):
        read(table, "csv", classes=2)
    with pytest.raises(FormatError, match="by return: there is no return_number and number_of"):
        read(table, "csv", returns="last")
    with pytest.raises(FormatError, match="there is no classification, but coordinates only"):
        read(b"1 2 3\n", "xyz", classes=2)
