"""ASCII grids: every digit of every number, and nothing that is no number."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import liftmesh
from file_samples import assert_same_bits

import liftmesh as lm
from liftmesh import Cloud, FormatError

GRID = (
    b"ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 2\nNODATA_value -9999\n"
    b"1 2 3\n4 -9999 6.5\n"
)


def test_ascii_grids(tmp_path: Path) -> None:
    expected = [[11, 23, 1], [13, 23, 2], [15, 23, 3], [11, 21, 4], [15, 21, 6.5]]
    assert read(GRID).points.tolist() == expected
    (tmp_path / "a.asc").write_bytes(GRID)
    with pytest.raises(FormatError, match=r"a\.asc: .* ASCII grid, .* with format='raster'"):
        lm.read(tmp_path / "a.asc")
    done = liftmesh("triangulate", "a.asc", "a.ply", cwd=tmp_path)
    assert done.stderr.rstrip().endswith("not a list of points: read it with --input-format raster")
    done = liftmesh(
        "triangulate", "a.asc", "a.ply", "--input-format", "raster", "--json", cwd=tmp_path
    )
    report = json.loads(done.stdout)
    assert (report["n_rows"], report["not_read"]) == (5, ["1 sample without a value"])


def test_without_a_keyword_the_mark_is_that_of_esri() -> None:
    unsaid = GRID.replace(b"NODATA_value -9999\n", b"")
    assert_same_bits(read(unsaid).points, read(GRID).points)
    assert read(unsaid, nodata="none").points[4].tolist() == [13, 21, -9999]
    assert len(read(GRID, nodata=6.5)) == 4
    with pytest.raises(FormatError, match="band 1 is -32768 in 1 of 6 samples, far from all other"):
        read(unsaid.replace(b"-9999", b"-32768"))


def test_a_prj_file_beside_a_grid(tmp_path: Path) -> None:
    (tmp_path / "a.asc").write_bytes(GRID)
    (tmp_path / "a.prj").write_text('PROJCS["a",GEOGCS["b"],UNIT["Foot_US",0.304800609601219]]')
    cloud = lm.read(tmp_path / "a.asc", format="raster")
    assert (cloud.crs or "").startswith('PROJCS["a"')
    (tmp_path / "a.prj").write_text("Projection UTM\nZone 32\n")
    assert lm.read(tmp_path / "a.asc", format="raster").crs is None


HEAD = b"ncols 3\nnrows 1\nxllcorner 10\nyllcorner 20\ncellsize 2\n"


def read(data: bytes, **options: Any) -> Cloud:
    return lm.read(io.BytesIO(data), format="raster", **options)


@pytest.mark.parametrize(
    "words",
    [
        "123456.789 8848.8601 1e-3",
        "4000000000 -5 7",
        "16777217 9007199254740993 0.1",
        "-0.0 1e300 5e-324",
    ],
)
def test_heights_lose_no_digit(words: str) -> None:
    cloud = read(HEAD + words.encode())
    assert_same_bits(cloud.points[:, 2], np.array([float(each) for each in words.split()]))


def test_lines_need_not_be_rows_and_keywords_stand_anywhere() -> None:
    expected = read(HEAD + b"1 2 3\n").points
    for data in (
        b"\xef\xbb\xbf" + HEAD + b"1\r\n2 3",
        b"NCOLS 3 NROWS 1 CELLSIZE 2\rXLLCENTER 11\rYLLCENTER 21\r1 2 3\r",
        HEAD.replace(b"cellsize 2", b"dx 2\ndy 2") + b"\n1 2\n\n3\n",
    ):
        assert_same_bits(read(data).points, expected)
    oblong = read(HEAD.replace(b"cellsize 2", b"dx 4\ndy 2") + b"1 2 3")
    assert oblong.points[:, :2].tolist() == [[12, 21], [16, 21], [20, 21]]


@pytest.mark.parametrize(
    ("mark", "word"),
    [(b"-9999.0", b"-9999"), (b"-3.4028235e+38", b"-3.4028234663852886e+38"), (b"nan", b"nan")],
)
def test_marks_of_nothing(mark: bytes, word: bytes) -> None:
    cloud = read(HEAD + b"NODATA_value " + mark + b"\n" + word + b" 1 NaN\n")
    assert cloud.points[:, 2].tolist() == [1]
    assert cloud.metadata["not_read"] == ("2 samples without a value",)


def test_part_of_a_grid() -> None:
    values = np.arange(600).reshape(20, 30)
    rows = "\n".join(" ".join(map(str, row)) for row in values.tolist())
    data = b"ncols 30\nnrows 20\nxllcorner 0\nyllcorner 0\ncellsize 1\n" + rows.encode()
    assert read(data, every=7).points[:, 2].tolist() == values[::7, ::7].ravel().tolist()
    assert len(read(data, bounds=(0, 0, 2, 2))) == 4
    with pytest.raises(FormatError, match=r"a raster of 30 x 20 samples expands to .* max_bytes="):
        read(data, max_bytes=100)


WRONG = {
    "a word": (HEAD + b"1 2 x", "line 6, value 3: 'x' is not a number"),
    "too many": (HEAD + b"1 2\n3 4\n", "line 7: 3 x 1 samples need 3 numbers, more follow"),
    "too few": (HEAD + b"1\n2\n", "line 7: 3 x 1 samples need 3 numbers, but 2 are there"),
    "none": (HEAD, "line 5: 3 x 1 samples need 3 numbers, but 0 are there"),
    "lies": (HEAD.replace(b" 3", b" 9007199254740991"), "numbers, but 0 are there"),
    "cellsize": (HEAD.replace(b"size 2", b"size 0") + b"1 2 3", "cellsize is 0: it must be a pos"),
    "no size": (HEAD.replace(b"size 2", b"size nan") + b"1 2 3", "cellsize is nan: it must be"),
    "no number": (b"ncols x\nnrows 3\n", "line 1: 'ncols x' is no keyword of a grid and its num"),
    "no value": (b"ncols\nnrows 3\n", "line 1: 'ncols' is no keyword of a grid and its number"),
    "twice": (HEAD + b"ncols 3\n1 2 3", "line 6: 'ncols 3' is no keyword"),
    "unknown": (HEAD + b"north 3\n1 2 3", "line 6: 'north 3' is no keyword"),
    "no corner": (HEAD.replace(b"xllcorner 10\n", b""), "needs either xllcorner or xllcenter"),
    "both": (HEAD + b"xllcenter 3\n", "needs either xllcorner or xllcenter"),
    "no count": (HEAD.replace(b"ncols 3", b"ncols 2.5"), "ncols is 2.5: it must be a whole number"),
}


@pytest.mark.parametrize("case", WRONG)
def test_what_is_no_grid(case: str) -> None:
    data, cause = WRONG[case]
    with pytest.raises(FormatError, match=f"^<stream>: .*{cause}"):
        read(data)
