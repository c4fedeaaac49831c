"""Tables of very many columns: refused by default, read if the limit allows what they take."""

from __future__ import annotations

import io
import json
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from file_samples import loaded
from growth.resident import MOST_PER_BYTE, forked

import liftmesh
from liftmesh import Cloud, FormatError
from liftmesh.cli import exit_codes, main
from liftmesh.io.options import COLUMN_BYTES, MOST_COLUMNS

MANY = 12_000  # columns: more than are read by default
NAMES = ["z", *(f"a{k}" for k in range(3, MANY))]
ROWS = 2
VALUES = np.arange(ROWS * MANY, dtype=float).reshape(ROWS, MANY) * (0.5 ** np.arange(ROWS)[:, None])


def rows(delimiter: str, values: np.ndarray = VALUES) -> bytes:
    return b"".join(delimiter.join(map(repr, row)).encode() + b"\n" for row in values.tolist())


def ply(encoding: str, lines: list[str], body: bytes) -> bytes:
    return "\n".join(["ply", f"format {encoding} 1.0", *lines, "end_header", ""]).encode() + body


VERTEX = [f"element vertex {ROWS}", *(f"property double {each}" for each in ("x", "y", *NAMES))]
WIDE = {
    "ply as text": ("ply", ply("ascii", VERTEX, rows(" ")), 1),
    "ply in binary": ("ply", ply("binary_little_endian", VERTEX, VALUES.tobytes()), 1),
    "csv": ("csv", ",".join(["x", "y", *NAMES]).encode() + b"\n" + rows(","), 0),
    "semicolons": ("csv", rows(";"), 0),
    "bars": ("csv", rows("|"), 0),
    "tabs": ("tsv", rows("\t"), 0),
    "blanks": ("xyz", rows(" "), 0),
    "header in a comment": ("xyz", b"# x y " + " ".join(NAMES).encode() + b"\n" + rows(" "), 0),
    "lines longer than a block": ("xyz", rows(" " * 30), 0),
}


def needed(name: str) -> int:
    """The bytes that the columns of a file take, and its elements."""
    return (MANY + WIDE[name][2]) * COLUMN_BYTES


def both(data: bytes, kind: str, max_bytes: int | None) -> Iterator[Cloud]:
    """Read a file whole and in chunks."""
    yield liftmesh.read(io.BytesIO(data), format=kind, max_bytes=max_bytes)
    yield from liftmesh.read_chunks(io.BytesIO(data), format=kind, max_bytes=max_bytes)


@pytest.mark.parametrize("name", WIDE)
@pytest.mark.parametrize("less", [None, 1])
def test_wide_tables_are_refused_with_both_figures_and_the_option(
    name: str, less: int | None
) -> None:
    kind, data, _ = WIDE[name]
    limit = MOST_COLUMNS * COLUMN_BYTES if less is None else needed(name) - less
    told = re.escape(
        f"expands to {needed(name):,} bytes, more than the limit of {limit:,}: save only the "
        "columns you need, or if you trust the file, raise it with max_bytes="
    )
    given = None if less is None else limit
    with pytest.raises(
        FormatError, match=rf"<stream>: line \d+: .* of {MANY // 1000},00. .*{told}"
    ):
        liftmesh.read(io.BytesIO(data), format=kind, max_bytes=given)
    with pytest.raises(FormatError, match=told):
        next(liftmesh.read_chunks(io.BytesIO(data), format=kind, max_bytes=given))


@pytest.mark.slow
@pytest.mark.parametrize("name", WIDE)
def test_wide_tables_are_read_with_the_limit_that_they_need(name: str) -> None:
    kind, data, _ = WIDE[name]
    for cloud in both(data, kind, needed(name)):
        assert np.array_equal([*cloud.points.T, *cloud.attributes.values()], VALUES.T)


def test_a_delimiter_of_the_caller_counts_as_others_do() -> None:
    stream = io.BytesIO(rows(":"))
    with pytest.raises(FormatError, match="a row of 12,000 values expands to 24,000,000 bytes"):
        liftmesh.read(stream, format="csv", delimiter=":")
    row = b"1:1\n" + b'"1":' * 300_000
    with pytest.raises(FormatError, match="line 2: expected 2 values, found 300,001"):
        liftmesh.read(io.BytesIO(row), format="csv", delimiter=":")


@pytest.mark.parametrize("name", ["ply in binary", "csv"])
def test_the_command_line_tells_its_own_option(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    kind, data, _ = WIDE[name]
    path = tmp_path / f"wide.{kind}"
    path.write_bytes(data)
    assert main(["info", str(path)]) == exit_codes.BAD_INPUT
    told = capsys.readouterr().err
    assert f"expands to {needed(name):,} bytes, more than the limit of 20,000,000" in told
    assert told.endswith("if you trust the file, raise it with --max-bytes\n")
    assert main(["info", str(path), "--max-bytes", str(needed(name)), "--json"]) == exit_codes.DONE
    assert json.loads(capsys.readouterr().out)["n_rows"] == ROWS


@pytest.mark.slow
def test_as_many_columns_as_the_limit_allows() -> None:
    for count, fits in ((10_000, True), (10_001, False)):
        columns = [f"property uchar a{k}" for k in range(count - 3)]
        lines = ["element vertex 1", "property uchar x", "property uchar y", *columns]
        elements = ["element vertex 1", "property uchar x", "property uchar y"]
        elements += [f"element a{k} 0" for k in range(count - 3)]
        for data, kind in (
            (ply("ascii", lines, b"0 " * (count - 1)), "ply"),
            (ply("ascii", elements, b"0 0\n"), "ply"),
            (b"1 " * count, "xyz"),
            (
                ",".join(["x", "y", *NAMES[: count - 2]]).encode() + b"\n1" + b",1" * (count - 1),
                "csv",
            ),
        ):
            if fits:
                assert [len(cloud) for cloud in both(data, kind, None)] == [1, 1]
            else:
                with pytest.raises(FormatError, match=r"10,001.* expands to 20,002,000 bytes"):
                    loaded(data, kind)


def test_a_long_comment_is_no_header() -> None:
    assert len(loaded(b"# x y" + b" a" * MANY + b"\n1 1\n", "xyz")) == 1


@pytest.mark.parametrize(
    ("kind", "data", "cause"),
    [
        ("xyz", b"1 1\n" + b"1 " * 300_000, "line 2: expected 2 values, found 300,000"),
        ("csv", b"1,1\n" + b"1," * 300_000, "line 2: expected 2 values, found 300,001"),
        ("ply", ply("ascii", VERTEX[:3], b"1 " * 300_000), "line 7: expected 2 values"),
        ("off", b"OFF\n1 0 0\n" + b"1 " * 300_000, "expected at most 10,000 values, found 300,000"),
    ],
)
def test_a_long_line_in_a_narrow_table_is_told(kind: str, data: bytes, cause: str) -> None:
    with pytest.raises(FormatError, match=cause):
        loaded(data, kind)


def test_a_header_that_does_not_end_is_told_first() -> None:
    data = ply("ascii", VERTEX, b"").replace(b"end_header\n", b"")
    with pytest.raises(FormatError, match="the header does not end"):
        loaded(data, "ply")


# The properties of one row that take the most, with the bytes of each.
DEAR = {
    "scalars beside a list": ("property double", 8, ["property list uchar uchar tags"]),
    "scalars": ("property double", 8, []),
    "lists": ("property list uchar uchar", 1, []),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", DEAR)
@pytest.mark.parametrize("encoding", ["ascii", "binary_little_endian"])
def test_columns_take_no_more_than_is_counted_for_them(name: str, encoding: str) -> None:
    count = 30_000
    kind, size, first = DEAR[name]
    lines = ["element vertex 1", "property uchar x", "property uchar y", *first]
    lines += [f"{kind} b{k}" for k in range(count)]
    text, binary = b"0 " * (2 + len(first) + count), bytes(2 + len(first) + size * count)
    data = ply(encoding, lines, text if encoding == "ascii" else binary)
    limit = (3 + len(first) + count) * COLUMN_BYTES

    def read() -> str:
        return str(len(liftmesh.read(io.BytesIO(data), format="ply", max_bytes=limit)))

    grown, outcome = forked(read, None)
    assert outcome == "1"
    assert grown < limit + MOST_PER_BYTE * len(data)
