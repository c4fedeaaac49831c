"""LAS and LAZ are read as laspy reads them, bit for bit, with every value of a point."""

from __future__ import annotations

import errno
import io
import struct
from pathlib import Path
from typing import Any

import laspy
import lazrs
import numpy as np
import pytest
from commands import process
from failing_stream import Failing
from file_samples import assert_same_bits, assert_same_mesh
from files.las import UTM, copc, encoded, geo_keys, patched, record, records, tile, with_records

import liftmesh
from liftmesh import Cloud, FormatError
from liftmesh.io.formats.las.reader import WAVE_PACKETS

COLORS = ("red", "green", "blue")
VERSIONS = {k: "1.2" if k < 4 else "1.3" if k < 6 else "1.4" for k in range(11)}


def read(data: bytes, **options: Any) -> Cloud:
    return liftmesh.read(io.BytesIO(data), format="las", **options)


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("point_format", range(11))
def test_every_value_of_every_point_format(point_format: int, compressed: bool) -> None:
    las = tile(600, point_format=point_format, version=VERSIONS[point_format])
    cloud = read(encoded(las, compressed=compressed))
    assert_same_bits(cloud.points, np.column_stack([las.x, las.y, las.z]).astype(np.float64))
    left_out = {"X", "Y", "Z", *(WAVE_PACKETS if compressed and point_format > 8 else ())}
    names = [each for each in las.point_format.dimension_names if each not in left_out]
    assert [*cloud.attributes] == [each for each in names if each not in COLORS]
    for name, values in cloud.attributes.items():
        assert_same_bits(values, np.asarray(las[name]))
    if "red" in names:
        assert cloud.color_depth == 16
        assert_same_bits(cloud.colors, np.column_stack([las[each] for each in COLORS]))
    assert cloud.metadata["las"] == {
        "version": VERSIONS[point_format],
        "point_format": point_format,
        "scale": [0.01] * 3,
        "offset": [*UTM],
    }
    waves = ("waveforms",) if point_format in (4, 5, 9, 10) else ()
    packets = ("wave packets (compressed in formats 9 and 10)",) if "x_t" in left_out else ()
    assert cloud.metadata.get("not_read", ()) == (*packets, *waves)


def test_the_whole_numbers_come_back_from_the_coordinates() -> None:
    las = tile(5000)
    cloud = read(encoded(las))
    stated = cloud.metadata["las"]
    numbers = np.rint((cloud.points - stated["offset"]) / stated["scale"]).astype(np.int32)
    assert_same_bits(numbers, np.column_stack([las.X, las.Y, las.Z]))
    again = numbers * np.array(stated["scale"]) + np.array(stated["offset"])
    assert_same_bits(again, cloud.points)


def test_offsets_that_are_no_decimals() -> None:
    las = tile(100)
    las.header.offsets = [674521.9200134277, 1206740.0800170898, 627.530029296875]
    las.points.offsets = las.header.offsets
    cloud = read(encoded(las))
    assert_same_bits(cloud.points[:, 0], las.X * 0.01 + 674521.9200134277)


@pytest.mark.parametrize("compressed", [False, True])
def test_extra_bytes_keep_their_types_and_scales(compressed: bool) -> None:
    las = tile(50, point_format=6, version="1.4")
    steps = np.arange(50, dtype=np.int32) - 7
    params = laspy.ExtraBytesParams
    las.add_extra_dims([
        params("echo width", "f4"),
        params("height", "i4", scales=np.array([0.001]), offsets=np.array([12.5])),
        params("direction", "3f8"),
        params("flags", "u8"),
    ])  # fmt: skip
    las["echo width"] = np.linspace(0, 1, 50, dtype=np.float32)
    las.points.array["height"] = steps
    las["direction"] = np.arange(150.0).reshape(50, 3)
    las["flags"] = np.full(50, 2**63 + 1, np.uint64)
    found = read(encoded(las, compressed=compressed)).attributes
    assert_same_bits(found["echo width"], np.linspace(0, 1, 50, dtype=np.float32))
    assert_same_bits(found["height"], steps * 0.001 + 12.5)
    assert_same_bits(found["direction"], np.arange(150.0).reshape(50, 3))
    assert_same_bits(found["flags"], np.full(50, 2**63 + 1, np.uint64))


def test_bytes_of_a_point_that_nothing_describes() -> None:
    data = encoded(tile(4, point_format=0))
    start = int.from_bytes(data[96:100], "little")
    rows = [data[start + 20 * k : start + 20 * (k + 1)] + bytes([k, 9]) for k in range(4)]
    cloud = read(patched(data[:start], "<H", 105, 22) + b"".join(rows))
    assert cloud.attributes["ExtraBytes"].tolist() == [[0, 9], [1, 9], [2, 9], [3, 9]]


def test_extra_bytes_with_the_name_of_a_coordinate_are_named() -> None:
    las = tile(4)
    las.add_extra_dim(laspy.ExtraBytesParams("q", "f4"))
    cloud = read(encoded(las).replace(b"\x09\x06q\x00", b"\x09\x06z\x00"))
    assert cloud.metadata["not_read"] == ("extra bytes 'z' (the name of a coordinate, or none)",)
    assert_same_bits(cloud.points[:, 2], np.asarray(las.z, dtype=np.float64))


@pytest.mark.parametrize("top", [255, 256])
def test_colours_of_8_bits_in_16(top: int) -> None:
    las = tile(4)
    for name in COLORS:
        las[name] = np.array([0, 1, 2, top], dtype=np.uint16)
    cloud = read(encoded(las))
    assert cloud.color_depth == (8 if top == 255 else 16)
    assert cloud.colors is not None
    assert cloud.colors[:, 0].tolist() == [0, 1, 2, top]
    dark = read(encoded(las), every=4)  # all rows of the file decide
    assert dark.color_depth == cloud.color_depth
    assert dark.colors is not None
    assert dark.colors.dtype == cloud.colors.dtype


def test_times_that_are_no_numbers() -> None:
    times = np.array([np.nan, 123456.789, -np.inf, 0.0])
    cloud = read(encoded(records(np.eye(4, 3) + UTM, 1, gps_time=times)))
    assert_same_bits(cloud.attributes["gps_time"], times)


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("rows", [1, 7, 50_000, 10**6])
def test_chunks_have_the_rows_of_the_whole(rows: int, compressed: bool) -> None:
    data = encoded(tile(60_000 if rows > 7 else 50), compressed=compressed)
    whole = read(data)
    parts = [*liftmesh.read_chunks(io.BytesIO(data), rows=rows, format="laz")]
    assert max(map(len, parts)) <= rows
    assert_same_bits(np.concatenate([each.points for each in parts]), whole.points)
    for name, values in whole.attributes.items():
        assert_same_bits(np.concatenate([each.attributes[name] for each in parts]), values)
    assert {each.color_depth for each in parts} == {16}


@pytest.mark.parametrize("compressed", [False, True])
def test_a_file_without_points(compressed: bool) -> None:
    cloud = read(encoded(tile(0), compressed=compressed))
    assert len(cloud) == 0
    assert cloud.attributes["classification"].dtype == np.uint8


def test_a_path_a_stream_and_a_pipe(tmp_path: Path) -> None:
    las = tile(30)
    las.write(str(tmp_path / "a.laz"))
    whole = liftmesh.read(tmp_path / "a.laz")
    with (tmp_path / "a.laz").open("rb") as stream:
        assert_same_mesh(liftmesh.read(stream), whole)
    data = (tmp_path / "a.laz").read_bytes()
    done = process(
        *(
            "triangulate",
            "-",
            "-",
            "--input-format",
            "laz",
            "--output-format",
            "ply",
            "--all-classes",
        ),
        stdin=data,
        text=False,
    )
    mesh = liftmesh.read(io.BytesIO(done.stdout), format="ply")
    assert_same_bits(mesh.points, whole.points)
    assert mesh.metadata["las"] == whole.metadata["las"]


def test_bytes_behind_the_last_point_are_named() -> None:
    data = encoded(tile(6))
    count = patched(data, "<I", 107, 4)
    assert read(count).metadata["not_read"] == ("68 bytes after the last point",)


def test_points_that_a_header_of_1_4_does_not_count_are_named() -> None:
    las = tile(6, point_format=6, version="1.4")
    short = patched(encoded(las), "<Q", 247, 4)
    assert read(short).metadata["not_read"] == ("60 bytes after the last point",)
    las.evlrs = laspy.vlrs.vlrlist.VLRList([laspy.VLR("somebody", 7, "", bytes(100))])
    assert "not_read" not in read(encoded(las)).metadata
    short = patched(encoded(las), "<Q", 247, 4)
    assert read(short).metadata["not_read"] == ("60 bytes after the last point",)


def test_extra_bytes_of_a_name_that_is_taken_are_named() -> None:
    las = tile(6)
    las.add_extra_dim(laspy.ExtraBytesParams("other_classes", "u1"))
    data = encoded(las).replace(b"other_classes\0", b"classification")
    cloud = read(data)
    assert cloud.metadata["not_read"] == (
        "extra bytes 'classification' (the name of another value)",
    )
    assert_same_bits(cloud.attributes["classification"], np.asarray(las.classification))


WKT = 'PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89"],UNIT["metre",1]]'
PROJECTION = b"LASF_Projection"
SYSTEMS = {
    "none": ((), False, None),
    "wkt": ((record(PROJECTION, 2112, WKT.encode() + b"\0\0"),), True, WKT),
    "empty wkt": ((record(PROJECTION, 2112, b"\0"),), True, None),
    "no wkt at all": ((record(PROJECTION, 2112, b""),), True, None),
    "keys": ((record(PROJECTION, 34735, geo_keys(k1024=1, k3072=25832)),), False, "EPSG:25832"),
    "keys of degrees": (
        (record(PROJECTION, 34735, geo_keys(k1024=2, k2048=4326)),), False, "EPSG:4326"
    ),
    "keys with heights": (
        (record(PROJECTION, 34735, geo_keys(k3072=28992, k4096=5709)),), False, "EPSG:28992+5709"
    ),
    "keys made by hand": ((record(PROJECTION, 34735, geo_keys(k3072=32767)),), False, None),
    "keys made by hand beside wkt": (
        (
            record(PROJECTION, 34735, geo_keys(k3072=32767)),
            record(b"liblas", 2112, WKT.encode()),
        ),
        False,
        WKT,
    ),
    "both, wkt is said to count": (
        (
            record(PROJECTION, 34735, geo_keys(k3072=25833)),
            record(PROJECTION, 2112, WKT.encode()),
        ),
        True,
        WKT,
    ),
    "keys that end early": ((record(PROJECTION, 34735, geo_keys(k3072=25832)[:-1]),), False, None),
    "a record of another": ((record(b"someone", 34735, geo_keys(k3072=25832)),), False, None),
}  # fmt: skip


@pytest.mark.parametrize("case", SYSTEMS)
def test_the_coordinate_system_that_a_file_states(case: str) -> None:
    made, wkt, expected = SYSTEMS[case]
    assert read(with_records(encoded(tile(4)), *made, wkt=wkt)).crs == expected


def test_the_coordinate_system_in_an_extended_record() -> None:
    las = tile(4, point_format=6, version="1.4")
    las.header.global_encoding.wkt = True
    las.evlrs = laspy.vlrs.vlrlist.VLRList([laspy.VLR("LASF_Projection", 2112, "", WKT.encode())])
    assert read(encoded(las)).crs == WKT


@pytest.mark.slow
def test_a_fork_reads_laz_too(tmp_path: Path) -> None:
    program = tmp_path / "forking.py"
    tile(120_000).write(str(tmp_path / "a.laz"))
    program.write_text(
        "import os, sys, liftmesh\n"
        "count = len(liftmesh.read('a.laz'))\n"
        "pid = os.fork()\n"
        "if not pid:\n"
        "    os._exit(0 if len(liftmesh.read('a.laz')) == count else 1)\n"
        "sys.exit(os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1]))\n"
    )
    import subprocess
    import sys

    subprocess.run([sys.executable, program], cwd=tmp_path, check=True, timeout=300)


@pytest.mark.parametrize("count", [49_999, 50_000, 50_001])
def test_a_last_chunk_that_is_full_or_of_one_point(count: int) -> None:
    las = tile(count, point_format=6, version="1.4")
    assert_same_bits(read(encoded(las, compressed=True)).points[:, 0], np.asarray(las.x))


@pytest.mark.parametrize("point_format", [3, 6])
def test_laz_that_holds_more_than_its_header_counts(point_format: int) -> None:
    las = tile(120_000, point_format=point_format, version="1.4")
    data = bytearray(encoded(las, compressed=True))
    assert liftmesh.read(io.BytesIO(data), format="laz").metadata.get("not_read") is None
    for place, form in ((107, "<I"), (247, "<Q")):
        if struct.unpack_from(form, data, place)[0]:
            struct.pack_into(form, data, place, 100)
    cloud = liftmesh.read(io.BytesIO(data), format="laz")
    assert len(cloud) == 100
    said = {3: "2 chunks after the last point", 6: "119,900 points that the header"}[point_format]
    assert said in cloud.metadata["not_read"][0]


def test_scaled_numbers_that_doubles_round_are_named() -> None:
    las = tile(3, point_format=6, version="1.4")
    for name in ("small", "huge"):
        las.add_extra_dim(
            laspy.ExtraBytesParams(name, "u8", scales=np.array([0.5]), offsets=np.array([0.0]))
        )
    las.points.array["small"] = 2**53
    las.points.array["huge"] = [0, 1, 2**53 + 1]
    for kind in ("las", "laz"):
        data = encoded(las, compressed=kind == "laz")
        cloud = liftmesh.read(io.BytesIO(data), format=kind)
        assert cloud.metadata["not_read"] == ("low digits of huge (beyond 2**53 steps)",)
        chunks = liftmesh.read_chunks(io.BytesIO(data), format=kind, rows=2)
        assert [len(each.metadata.get("not_read", ())) for each in chunks] == [0, 1]


@pytest.mark.parametrize("part", [0.02, 0.5, 0.7, 1.0])
@pytest.mark.parametrize("kind", ["las", "laz", "copc"])
def test_an_error_of_the_disk_is_no_damage(kind: str, part: float) -> None:
    las = tile(3000, point_format=6, version="1.4")
    data = copc(las) if kind == "copc" else encoded(las, compressed=kind == "laz")
    error = OSError(errno.EIO, "Input/output error")
    place = int((len(data) - 2) * part)
    stream = Failing(data, range(place, place + 1), error)
    with pytest.raises(OSError, match="Input/output error"):
        liftmesh.read(stream, format="las")


@pytest.mark.parametrize("number", [1, 30_000])
def test_a_table_of_more_chunks_than_their_points_is_refused(number: int) -> None:
    las = tile(10, point_format=6, version="1.4")
    data = encoded(las, compressed=True)
    start = struct.unpack_from("<I", data, 96)[0]
    place = struct.unpack_from("<q", data, start)[0]
    first, rest = data[start + 8 : place], bytes(200_000)
    packing = lazrs.LazVlr(data[data.index(b"laszip encoded") + 52 :][: 34 + 12])
    stream = io.BytesIO()
    empty = [(50_000, 0)] * (number - 1)
    lazrs.write_chunk_table(stream, [(50_000, len(first)), *empty], packing)
    body = patched(data[: start + 8], "<q", start, start + 8 + len(first) + len(rest))
    lie = body + first + rest + stream.getvalue()
    if number == 1:
        assert len(liftmesh.read(io.BytesIO(lie), format="laz")) == 10
        return
    with pytest.raises(
        FormatError, match=r"the table of chunks states 30,000 chunks of 200,\d+ byt"
    ):
        liftmesh.read(io.BytesIO(lie), format="laz")


@pytest.mark.parametrize("compressed", [False, True])
def test_extra_bytes_of_no_bytes_are_an_error_of_the_file(compressed: bool) -> None:
    las = tile(3)
    las.add_extra_dim(laspy.ExtraBytesParams("a", "u1"))
    data = encoded(las, compressed=compressed)
    place = data.index(b"LASF_Spec") + 52 + 2
    with pytest.raises(FormatError, match="<stream>: the extra bytes 'a' have 0 bytes"):
        liftmesh.read(io.BytesIO(patched(data, "<2B", place, 0, 0)), format="las")
