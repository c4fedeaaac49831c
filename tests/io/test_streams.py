"""Names of files, and streams for libraries that expect files."""

from __future__ import annotations

import io
from pathlib import Path

import pytest

from liftmesh.errors import FormatError
from liftmesh.io.atomic import check_writable, holds_data
from liftmesh.io.formats.las.laz import ErrorRecordingStream, OffsetStream
from liftmesh.io.streams import check_links, check_suffix, is_file, name_of, suffix_of


@pytest.mark.parametrize(
    ("name", "suffix"),
    [("points.csv", ".csv"), ("points.csv.gz", ".csv.gz"), ("a.b.PLY", ".PLY"), ("points", "")],
)
def test_the_suffix_of_a_name(name: str, suffix: str) -> None:
    assert suffix_of(name) == suffix


def test_a_suffix_that_promises_another_format_is_refused() -> None:
    check_suffix("lines.JSON", (".geojson", ".json"), "contours are written as GeoJSON")
    with pytest.raises(FormatError, match=r"lines\.gpkg: contours are .*: name it \*\.geojson"):
        check_suffix("lines.gpkg", (".geojson", ".json"), "contours are written as GeoJSON")


def test_names_of_streams() -> None:
    assert name_of(Path("a.ply")) == "a.ply"
    assert name_of(io.BytesIO()) == "<stream>"


def test_what_is_not_there_has_no_links_in_a_circle(tmp_path: Path) -> None:
    check_links(tmp_path / "a file that does not exist")
    check_links("NUL \0")


def test_places_that_cannot_be_written() -> None:
    with pytest.raises(IsADirectoryError, match="cannot write a file here: it is a folder"):
        check_writable("/")
    assert not holds_data("/dev/null")


def test_a_stream_remembers_its_first_error() -> None:
    stream = ErrorRecordingStream(io.BytesIO(b"points"))
    assert (stream.seek(2), stream.read(3), stream.tell(), stream.failure) == (2, b"int", 5, None)

    class Broken(io.BytesIO):
        def read(self, size: int | None = -1, /) -> bytes:
            raise OSError(size)

    failing = ErrorRecordingStream(Broken())
    for size in (1, 2):
        with pytest.raises(OSError, match=str(size)):
            failing.read(size)
    assert failing.failure is not None
    assert failing.failure.args == (1,)


def test_a_part_of_a_stream_begins_at_zero() -> None:
    stream = io.BytesIO(b"head points")
    part = OffsetStream(stream, 5)
    assert (part.seek(0), part.read(6), part.tell(), stream.tell()) == (0, b"points", 6, 11)
    assert part.seek(-3, io.SEEK_END) == 3


def test_a_stream_is_its_file_while_that_is_there(tmp_path: Path) -> None:
    path = tmp_path / "a.ele"
    path.write_bytes(b"1")
    with path.open("rb") as stream:
        assert is_file(stream, str(path))
        assert not is_file(io.BytesIO(b"1"), str(path))
        path.unlink()
        assert not is_file(stream, str(path))
