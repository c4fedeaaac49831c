"""max_bytes: which readers are given it, and its values on the command line."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import pytest

import liftmesh
from liftmesh import Cloud, Format, FormatError, InputError
from liftmesh.cli import exit_codes, main, options
from liftmesh.io import registry
from liftmesh.io.options import check_columns, check_expanded, most_columns

GIVEN: list[int | None] = []


def plain(stream: BinaryIO, name: str) -> Cloud:
    assert stream.read(), name
    return Cloud(np.eye(3))


def expanding(stream: BinaryIO, name: str, *, max_bytes: int | None) -> Cloud:
    GIVEN.append(max_bytes)
    return plain(stream, name)


def in_chunks(stream: BinaryIO, name: str, rows: int, *, max_bytes: int | None) -> Iterator[Cloud]:
    GIVEN.append(max_bytes)
    yield plain(stream, name).select(slice(0, rows))


@pytest.fixture(autouse=True)
def formats(monkeypatch: pytest.MonkeyPatch) -> None:
    GIVEN.clear()
    added = (
        Format("plain", (".plain",), plain, None, "takes no limit"),
        Format("whole", (".whole",), expanding, None, "expands", expands=True),
        Format(
            "parts", (".parts",), expanding, None, "expands", read_chunks=in_chunks, expands=True
        ),
    )
    monkeypatch.setattr(registry, "FORMATS", (*registry.FORMATS, *added))


@pytest.mark.parametrize(("kind", "expands"), [("plain", False), ("whole", True), ("parts", True)])
def test_only_formats_that_expand_are_given_the_limit(
    tmp_path: Path, kind: str, expands: bool
) -> None:
    path = tmp_path / f"cloud.{kind}"
    path.write_bytes(b"x")
    liftmesh.read(path)
    liftmesh.read(path, max_bytes=7)
    list(liftmesh.read_chunks(path))
    list(liftmesh.read_chunks(path, max_bytes=7))
    assert main(["info", str(path), "--max-bytes", "7"]) == exit_codes.DONE
    assert ([None, 7, None, 7, 7] if expands else []) == GIVEN


@pytest.mark.parametrize("value", [0, -1, True, 2.5, "9", float("nan")])
@pytest.mark.parametrize("kind", ["plain", "whole", "parts"])
def test_values_that_are_no_limit(kind: str, value: Any) -> None:
    for call in (liftmesh.read, liftmesh.read_chunks):
        with pytest.raises(InputError, match=r"max_bytes is .*: give a whole number from 1"):
            call(io.BytesIO(b"x"), format=kind, max_bytes=value)
    assert not GIVEN


@pytest.mark.parametrize(
    ("text", "size"),
    [
        ("1", 1),
        ("500M", 500_000_000),
        ("4G", 4_000_000_000),
        ("4gb", 4_000_000_000),
        ("2k", 2000),
        ("1T", 10**12),
    ],
)
def test_sizes(text: str, size: int) -> None:
    assert options.size(text) == size


@pytest.mark.parametrize("text", ["", "0", "0G", "-1", "1.5G", "1_0", "٣", "G", "4Gi", "9" * 30])
def test_texts_that_are_no_size(text: str) -> None:
    with pytest.raises(InputError, match="give a size, as 500M or 4G"):
        options.size(text)


@pytest.mark.parametrize(
    "words",
    [
        ["info", "x.ply"],
        ["verify", "x.ply"],
        ["compare", "x.ply"],
        ["triangulate", "x.ply", "y.ply"],
    ],
)
def test_every_command_that_reads_checks_the_size_first(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([*words, "--max-bytes", "many"]) == exit_codes.USAGE
    assert "--max-bytes is 'many': give a size" in capsys.readouterr().err


def test_limits_are_the_largest_that_pass() -> None:
    check_expanded(1000, 1000, "points.npz", "points.npy")
    with pytest.raises(FormatError, match=r"points\.npz: points\.npy expands to 1,001 bytes, more"):
        check_expanded(1001, 1000, "points.npz", "points.npy")
    check_columns(10_000, None, "wide.csv", "a row of 10,000 values")
    with pytest.raises(FormatError, match=r"expands to 6,000 .* 5,999: save only the columns you"):
        check_columns(3, 5999, "wide.csv: line 1", "a row of 3 values")
    assert (most_columns(None), most_columns(100_000_000)) == (10_000, 50_000)
