"""LAS and LAZ are written: what was read comes back bit for bit, and other clouds keep all."""

from __future__ import annotations

import errno
import io
import struct
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import laspy
import numpy as np
import pyproj
import pytest
from file_samples import assert_same_bits
from files.las import encoded, geo_keys, patched, record, tile, with_records

import liftmesh
from liftmesh import Cloud, FormatError, InputError
from liftmesh.io.formats.las.layout import steps_of
from liftmesh.io.formats.las.reader import WAVE_PACKETS
from liftmesh.io.write import write_chunks

VERSIONS = {k: "1.2" if k < 4 else "1.3" if k < 6 else "1.4" for k in range(11)}
POINTS = np.array([[512000.25, 5400000.5, 1.75], [512004.0, 5400000.0, 2.0], [512000, 5400003, 3]])


def read(data: bytes, **options: Any) -> Cloud:
    return liftmesh.read(io.BytesIO(data), format="las", **options)


def written(cloud: Cloud, kind: str = "las", **options: Any) -> bytes:
    stream = io.BytesIO()
    liftmesh.write(stream, cloud, format=kind, **options)
    return stream.getvalue()


def back(cloud: Cloud, kind: str = "las", **options: Any) -> Cloud:
    return read(written(cloud, kind, **options))


def with_class(cloud: Cloud, row: int, number: int) -> Cloud:
    values = cloud.attributes["classification"].copy()
    values[row] = number
    return replace(cloud, attributes={**cloud.attributes, "classification": values})


@pytest.mark.parametrize("compressed", [False, True])
@pytest.mark.parametrize("point_format", range(11))
def test_a_file_is_written_again_byte_for_byte(point_format: int, compressed: bool) -> None:
    las = tile(600, point_format=point_format, version=VERSIONS[point_format])
    if compressed and point_format > 8:
        for name in WAVE_PACKETS:
            las[name] = np.zeros(600)
    for each in (las, tile(0, point_format=point_format, version=VERSIONS[point_format])):
        data = encoded(each, compressed=compressed)
        assert written(read(data), "laz" if compressed else "las") == data


@pytest.mark.parametrize("kind", ["las", "laz"])
def test_counts_that_a_header_leaves_out_stay_out(kind: str) -> None:
    packed = kind == "laz"
    uncounted = patched(encoded(tile(60), compressed=packed), "<5I", 111, *[0] * 5)
    assert written(read(uncounted), kind) == uncounted
    late = encoded(tile(60, version="1.4"), compressed=packed)
    for data in (late, patched(late, "<6I", 107, *[0] * 6)):
        assert written(read(data), kind) == data
    part = laspy.read(io.BytesIO(written(read(uncounted, classes=2))))
    assert part.header.number_of_points_by_return[:3].sum() == len(part.points)


@pytest.mark.parametrize("compressed", [False, True])
def test_nothing_changes_but_the_classes(compressed: bool) -> None:
    data = encoded(tile(600), compressed=compressed)
    las = laspy.read(io.BytesIO(data))
    changed = written(with_class(read(data), 17, 9), "laz" if compressed else "las")
    again = laspy.read(io.BytesIO(changed))
    assert again.classification[17] == 9
    again.classification[17] = las.classification[17]
    assert_same_bits(again.points.array, las.points.array)
    assert changed[:227] == data[:227]
    if not compressed:
        assert [k for k in range(len(data)) if data[k] != changed[k]] == [227 + 17 * 34 + 15]


def test_header_records_and_what_stands_between_are_kept() -> None:
    made = (
        record(b"LASF_Projection", 34735, geo_keys(k1024=1, k3072=25832)),
        record(b"somebody", 7, b"\0\1\2 what we do not know"),
    )
    data = with_records(encoded(tile(5, point_format=6, version="1.4")), *made)
    head = patched(patched(data, "<16s", 8, b"sixteen bytes id"), "<32s", 26, b"a system")
    start, records = struct.unpack_from("<II", head, 96)
    gap = patched(head[:start], "<I", 96, start + 2) + b"\xdd\xcc" + head[start:]
    rest = struct.pack("<H16sHQ32s", 0, b"another", 8, 3, b"") + b"end"
    extended = patched(gap + rest, "<QI", 235, len(gap), 1)
    cloud = read(extended)
    assert records == 2
    assert cloud.crs == "EPSG:25832"
    assert written(cloud) == extended
    assert written(read(written(cloud, "laz"))) == extended


def test_a_version_that_has_no_flag_for_wkt_and_sets_it() -> None:
    wkt = record(b"LASF_Projection", 2112, b'PROJCS["a"]\0')
    data = with_records(encoded(tile(5)), wkt, wkt=True)
    cloud = read(data)
    assert cloud.crs == 'PROJCS["a"]'
    assert written(cloud) == data
    moved = written(replace(cloud, crs='PROJCS["b"]'))
    assert (moved[25], moved[6] & 16) == (2, 16)
    assert read(moved).crs == 'PROJCS["b"]'


def test_a_file_in_the_middle_of_a_stream() -> None:
    data = encoded(tile(700, point_format=6, version="1.4"), compressed=True)
    stream = io.BytesIO(b"before")
    stream.seek(6)
    liftmesh.write(stream, read(data), format="laz")
    assert stream.getvalue() == b"before" + data
    stream.seek(6)
    assert_same_bits(liftmesh.read(stream, format="laz").points, read(data).points)


def test_rows_that_were_selected() -> None:
    las = tile(600)
    cloud = back(read(encoded(las), classes=2))
    ground = np.flatnonzero(np.asarray(las.classification) == 2)
    assert_same_bits(cloud.points, read(encoded(las)).points[ground])
    header = laspy.read(io.BytesIO(written(cloud))).header
    assert header.point_count == len(ground)
    assert_same_bits(np.asarray(header.mins), cloud.points.min(axis=0))
    counts = np.bincount(np.asarray(las.return_number)[ground], minlength=6)[1:6]
    assert list(header.number_of_points_by_return[:5]) == counts.tolist()


@pytest.mark.parametrize("kind", ["las", "laz"])
def test_extra_bytes_come_back_with_their_descriptions(kind: str) -> None:
    las = tile(50, point_format=6, version="1.4")
    params = laspy.ExtraBytesParams
    las.add_extra_dims([
        params("height", "i4", "above the ground", np.array([12.5]), np.array([0.001])),
        params("direction", "3f8"),
        params("flags", "u8", no_data=[99]),
        params("gain", "f4", "", np.array([2.0]), np.array([0.1])),
        params("turns", "3i2", "", np.array([0.0, 1.0, 2.0]), np.array([0.1, 0.01, 0.001])),
    ])  # fmt: skip
    las.points.array["height"] = np.arange(50) - 7
    las["direction"] = np.arange(150.0).reshape(50, 3)
    las["flags"] = np.full(50, 2**63 + 1, np.uint64)
    gains, turns = np.arange(50) / 7, np.arange(150).reshape(50, 3) * 99 - 7000
    las.points.array["gain"], las.points.array["turns"] = gains, turns
    data = encoded(las, compressed=kind == "laz")
    assert written(read(data), kind) == data
    cloud = read(data)
    single = gains.astype(np.float32).astype(np.float64)
    assert_same_bits(cloud.attributes["gain"], single * 0.1 + 2.0)
    assert_same_bits(cloud.attributes["turns"], turns * [0.1, 0.01, 0.001] + [0.0, 1.0, 2.0])
    moved = replace(cloud, attributes={**cloud.attributes, "height": np.full(50, np.pi)})
    assert_same_bits(back(moved, kind).attributes["height"], np.full(50, np.pi))
    longer = np.array([0, 10**6] * 25, np.uint64)
    wider = replace(cloud, attributes={**cloud.attributes, "flags": longer})
    assert_same_bits(back(wider, kind).attributes["flags"], longer)


def test_bytes_that_nothing_describes_stay_the_last() -> None:
    data = encoded(tile(4, point_format=0))
    start = int.from_bytes(data[96:100], "little")
    rows = [data[start + 20 * k : start + 20 * (k + 1)] + bytes([k, 9]) for k in range(4)]
    odd = patched(data[:start], "<H", 105, 22) + b"".join(rows)
    cloud = read(odd)
    assert written(cloud) == odd
    more = replace(cloud, attributes={**cloud.attributes, "slope": np.arange(4.0)})
    again = back(more)
    assert again.attributes["slope"].tolist() == [0, 1, 2, 3]
    assert again.attributes["ExtraBytes"].tolist() == [[0, 9], [1, 9], [2, 9], [3, 9]]


def test_a_cloud_from_elsewhere_becomes_las_1_4() -> None:
    values = {"classification": np.array([2.0, 6, 200]), "slope": np.array([0.5, 1, 2], np.float32)}
    cloud = Cloud(POINTS, attributes=values, colors=np.array([[1, 2, 255]] * 3, np.uint8))
    data = written(cloud)
    las = laspy.read(io.BytesIO(data))
    assert (str(las.header.version), las.point_format.id) == ("1.4", 7)
    assert_same_bits(np.asarray(las.xyz), POINTS)
    assert np.asarray(las.classification).tolist() == [2, 6, 200]
    assert np.asarray(las.blue).tolist() == [65535] * 3
    assert np.asarray(las["slope"]).tolist() == [0.5, 1, 2]
    assert las.header.creation_date is None
    assert written(cloud) == data
    assert np.array_equal(read(data).colors, np.array([[257, 514, 65535]] * 3))


@pytest.mark.parametrize("crs", ["EPSG:25832", "EPSG:28992+5709", "EPSG:4326"])
def test_other_programs_find_the_coordinate_system(crs: str) -> None:
    data = written(Cloud(POINTS, crs=crs))
    said = laspy.read(io.BytesIO(data)).header.parse_crs()
    assert said == pyproj.CRS(pyproj.CRS(crs).to_wkt("WKT1_GDAL"))
    assert data[6] & 16
    assert read(data).crs == crs


def test_new_files_of_late_formats_say_wkt() -> None:
    assert written(Cloud(POINTS))[6] & 16
    keys = record(b"LASF_Projection", 34735, geo_keys(k1024=1, k3072=25832))
    cloud = read(with_records(encoded(tile(5)), keys))
    assert not written(cloud)[6] & 16
    data = written(cloud, point_format=7)
    header = laspy.read(io.BytesIO(data)).header
    assert header.global_encoding.wkt
    assert header.parse_crs() == pyproj.CRS(pyproj.CRS("EPSG:25832").to_wkt("WKT1_GDAL"))
    assert [each.record_id for each in header.vlrs if each.user_id == "LASF_Projection"] == [2112]
    assert read(data).crs == "EPSG:25832"
    unknown = record(b"LASF_Projection", 34735, geo_keys(k1024=1, k3072=32767))
    data = written(read(with_records(encoded(tile(5)), unknown)), point_format=7)
    assert data[6] & 16
    assert unknown[54:] in data


def test_a_coordinate_system_that_another_program_replaced() -> None:
    data = written(Cloud(POINTS, crs="EPSG:25832"))
    wkt = pyproj.CRS("EPSG:25832").to_wkt("WKT1_GDAL").encode()
    other = data.replace(wkt, wkt.replace(b"32N", b"33N"))
    assert other != data
    assert read(other).crs == wkt.replace(b"32N", b"33N").decode()


def test_another_coordinate_system_takes_the_place_of_geokeys() -> None:
    keys = record(b"LASF_Projection", 34735, geo_keys(k1024=1, k3072=25832))
    cloud = read(with_records(encoded(tile(5)), keys))
    moved = replace(cloud, crs="EPSG:25833")
    assert back(moved).crs == "EPSG:25833"
    assert b"zone 33N" in written(moved)
    assert geo_keys(k1024=1, k3072=25832) not in written(moved)
    assert back(replace(cloud, crs=None)).crs is None


@pytest.mark.parametrize("colors", [[0, 51, 255], [0, 51, 256]])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_the_depth_of_dark_colours(colors: list[int], dtype: type) -> None:
    given = np.array([np.minimum(colors, np.iinfo(dtype).max)] * 3, dtype)
    cloud = Cloud(POINTS, colors=given, color_depth=16 if dtype is np.uint16 else None)
    found = back(cloud)
    assert found.color_depth == 16
    assert found.colors is not None
    assert np.array_equal(found.colors, given.astype(np.uint16) * (257 if dtype is np.uint8 else 1))


@pytest.mark.parametrize("full", [1.0, 2**32 - 1])
def test_dark_colours_of_other_types(full: float) -> None:
    given = (np.array([[0, 1, 255]] * 3) / 65535 * full).astype("u4" if full > 1 else "f8")
    found = back(Cloud(POINTS, colors=given, color_depth=32 if full > 1 else None))
    assert found.colors is not None
    assert found.colors.tolist() == [[0, 1, 255]] * 3
    assert found.color_depth == 16
    black = back(Cloud(POINTS, colors=np.zeros((3, 3))))
    assert black.colors is not None
    assert not black.colors.any()
    assert b"liftmesh\0" not in written(Cloud(POINTS, colors=np.zeros((3, 3))))[300:]


def test_8_bits_in_16_stay_as_they_are() -> None:
    las = tile(4)
    for name in ("red", "green", "blue"):
        las[name] = np.array([0, 1, 2, 255], np.uint16)
    data = encoded(las)
    assert read(data).color_depth == 8
    assert written(read(data)) == data


@pytest.mark.parametrize(
    ("name", "values", "cause"),
    [
        ("classification", [2, 2, 40], r"40 in row 2, but point format 3 .* from 0 to 31"),
        ("intensity", [0.5, 1, 2], r"0.5 in row 0, but .* from 0 to 65,535"),
        ("user_data", [0, np.nan, 2], r"nan in row 1"),
        ("gps_time", [0, 2**60 + 1, 2], r"\d+ in row 1, .* floats of 64 bits"),
        ("return_number", ["a", "b", "c"], r"<U1 of shape \(3,\)"),
    ],
)
def test_a_value_that_does_not_fit_is_refused(name: str, values: Any, cause: str) -> None:
    cloud = Cloud(POINTS, attributes={name: np.array(values)}, metadata={
        "las": {"version": "1.2", "point_format": 3}
    })  # fmt: skip
    with pytest.raises(FormatError, match=f"{name} is {cause}"):
        written(cloud)


def test_a_point_format_that_holds_more() -> None:
    cloud = with_class(read(encoded(tile(4))), 1, 40)
    with pytest.raises(FormatError, match="point_format="):
        written(cloud)
    found = back(cloud, point_format=7)
    assert found.attributes["classification"][1] == 40
    assert_same_bits(
        found.attributes["scan_angle_rank"], cloud.attributes["scan_angle_rank"]
    )  # extra bytes now
    assert_same_bits(found.points, cloud.points)


@pytest.mark.parametrize(
    ("options", "cause"),
    [
        ({"point_format": 11}, "point_format is 11: give a whole number from 0 to 10"),
        ({"scale": 0}, "scale is 0: give a positive number"),
        ({"point_format": 1}, "point_format is 1, which has no colours: give 3"),
    ],
)
def test_options_are_checked(options: dict[str, Any], cause: str) -> None:
    with pytest.raises(InputError, match=cause):
        written(Cloud(POINTS, colors=np.zeros((3, 3), np.uint8)), **options)


@pytest.mark.parametrize("version", ["1." + "9" * 5000, "1.9", "1.\u0663", ["1.2"], 1.2])
def test_a_version_that_metadata_makes_up(version: Any) -> None:
    entries = {"las": {"version": version, "point_format": 2}}
    assert written(Cloud(POINTS, metadata=entries))[24:26] == b"\1\4"


def test_names_without_a_place_are_dropped() -> None:
    values = {"red": np.arange(3), "x" * 33: np.arange(3), "text": np.array(["a", "b", "c"])}
    result = liftmesh.write(io.BytesIO(), Cloud(POINTS, attributes=values), format="las")
    assert result.dropped == ("red", "x" * 33, "text")


def test_wave_packets_that_lazrs_confuses_are_refused() -> None:
    cloud = read(encoded(tile(4, point_format=9, version="1.4")))
    with pytest.raises(FormatError, match=r"format 9 cannot be compressed: write \.las"):
        written(cloud, "laz")


@pytest.mark.parametrize(
    ("values", "scale", "exact"),
    [
        ([512.25, 512.5], 0.01, True),
        ([636296.123, 636295.999], 0.001, False),  # but for the last bit of the doubles
        ([1.0, 2.0, 3.0], 1.0, True),
        ([0.0, 0.0004, 1.0], 0.0001, True),
        ([1 / 3, 2 / 3], 1e-10, False),
        ([3e9, 3e9 + 1], 1.0, True),
        ([-1e300, 1e300], 1e291, False),
        ([0.1234567890123] * 2, 0.01, True),
        ([-0.0, 1.0], 1.0, False),
        ([0.0, 5e-324], 5e-324, True),
    ],
)
def test_the_coarsest_scale_that_loses_no_decimal(
    values: list[float], scale: float, exact: bool
) -> None:
    array = np.array(values)
    found = steps_of(array, None)
    assert (found.scale, found.exact) == (scale, exact)
    again = found.coordinates(found.numbers(array).astype(np.int32))
    assert np.abs(again - array).max() <= scale
    assert exact == (again.tobytes() == array.tobytes())
    cloud = Cloud(np.column_stack([array] * 3))
    result = liftmesh.write(io.BytesIO(), cloud, format="las")
    name = "last bits of coordinates, whose decimals are the same"
    name = name if found.near else "double precision"
    assert result.dropped == (() if exact else (name,))
    if found.near:
        assert (np.abs(again - array) <= 8 * np.spacing(np.abs(array).max())).all()


def test_a_scale_that_is_asked_for() -> None:
    cloud = Cloud(POINTS / 3 * (1, 1, 1000))
    found = back(cloud, scale=0.5)
    assert_same_bits(found.points, np.rint(cloud.points / 0.5) * 0.5)
    with pytest.raises(FormatError, match=r"more than 32 bits in steps of scale=1e-08"):
        written(cloud, scale=1e-8)


def test_laz_by_its_suffix(tmp_path: Path) -> None:
    cloud = Cloud(POINTS)
    liftmesh.write(tmp_path / "a.laz", cloud)
    liftmesh.write(tmp_path / "a.las", cloud)
    assert (tmp_path / "a.laz").read_bytes()[104] == 6 | 128
    assert (tmp_path / "a.las").read_bytes()[104] == 6
    assert_same_bits(liftmesh.read(tmp_path / "a.laz").points, POINTS)


@pytest.mark.parametrize("suffix", ["las", "vtu"])
def test_values_called_as_a_part_of_a_cloud_are_named_when_they_are_lost(
    tmp_path: Path, suffix: str
) -> None:
    words = np.array(["a", "b", "c"])
    cloud = Cloud(np.eye(3), attributes={"alpha": words, "size": words})
    dropped = liftmesh.write(tmp_path / f"cloud.{suffix}", cloud).dropped
    assert {"alpha (values)", "size"} <= {*dropped}


@pytest.mark.parametrize(("before", "after"), [(3, 7), (7, 3)])
def test_the_angle_of_the_scanner_in_another_point_format(before: int, after: int) -> None:
    las = tile(300, point_format=before, version="1.4")
    degrees = np.arange(300) % 181 - 90
    if before == 3:
        las.scan_angle_rank = degrees.astype(np.int8)
    else:
        las.scan_angle = np.rint(degrees / 0.006).astype(np.int16)
    cloud = liftmesh.read(io.BytesIO(encoded(las)), format="las")
    stream = io.BytesIO()
    written = liftmesh.write(stream, cloud, format="las", point_format=after)
    assert written.dropped == ()
    again = laspy.read(io.BytesIO(stream.getvalue()))
    if after == 7:
        assert np.array_equal(again.scan_angle, np.rint(degrees / 0.006))
        assert np.array_equal(again["scan_angle_rank"], degrees)
    else:
        assert np.array_equal(again.scan_angle_rank, degrees)
        assert np.array_equal(again["scan_angle"], np.rint(degrees / 0.006))


@pytest.mark.parametrize(("moved", "is_same"), [(2e-9, True), (2e-8, False), (3e-7, False)])
def test_a_coordinate_is_near_a_decimal_within_the_rounding_of_doubles_only(
    moved: float, is_same: bool
) -> None:
    values = 5400000 + np.arange(1000) / 100
    values[::7] += moved  # steps of doubles are 9.3e-10 there
    for known in (None, (0.01, 0.0)):
        found = steps_of(values, known)
        assert (found.scale == 0.01) == is_same
        assert not found.exact
    points = np.column_stack([values, values, values])
    near = "last bits of coordinates, whose decimals are the same"
    dropped = liftmesh.write(io.BytesIO(), Cloud(points), format="las").dropped
    assert (near in dropped) == is_same


@pytest.mark.parametrize("kind", ["las", "laz"])
def test_chunks_make_the_file_of_the_whole(kind: str, tmp_path: Path) -> None:
    cloud = read(encoded(tile(700, point_format=7, version="1.4"), compressed=True))
    cloud = replace(cloud, attributes={**cloud.attributes, "high": cloud.points[:, 2] / 3})
    parts = [cloud.select(slice(k, k + 150)) for k in range(0, 700, 150)]
    parts.insert(2, cloud.select(slice(0, 0)))
    done = write_chunks(tmp_path / f"file.{kind}", iter(parts))
    data = (tmp_path / f"file.{kind}").read_bytes()
    assert data == written(cloud, kind)
    assert (done.bytes, done.format, done.dropped) == (len(data), "las", ())


def test_chunks_that_do_not_fit_together_leave_no_file(tmp_path: Path) -> None:
    cloud = read(encoded(tile(20, point_format=6, version="1.4")))
    moved = replace(cloud, points=cloud.points + 1e-5)
    named = replace(cloud, attributes={**cloud.attributes, "more": np.arange(20.0)})
    for other in (moved, named):
        with pytest.raises(FormatError, match="chunk 1 has other values, or coordinates"):
            write_chunks(tmp_path / "file.laz", iter([cloud, other]))
    with pytest.raises(FormatError, match="ply files are not written in chunks"):
        write_chunks(tmp_path / "file.ply", iter([cloud]))
    assert [*tmp_path.iterdir()] == []


@pytest.mark.parametrize("kind", ["las", "laz"])
@pytest.mark.parametrize("error", [OSError(5, "unreadable"), KeyboardInterrupt()])
def test_chunks_that_end_in_an_error_leave_the_old_file(
    kind: str, error: BaseException, tmp_path: Path
) -> None:
    cloud = read(encoded(tile(20, point_format=6, version="1.4")))
    path = tmp_path / f"file.{kind}"
    path.write_bytes(b"old")

    def chunks() -> Iterator[Cloud]:
        yield from [cloud, cloud]
        raise error

    with pytest.raises(type(error)):
        write_chunks(path, chunks())
    assert {each: each.read_bytes() for each in tmp_path.iterdir()} == {path: b"old"}


class _Full(io.BytesIO):
    """A disk that is full after so many bytes."""

    def write(self, data: Any) -> int:
        if self.tell() + len(data) > 2000:
            raise OSError(errno.ENOSPC, "No space left on device")
        return super().write(data)


def test_a_full_disk_is_said_of_compressed_points() -> None:
    cloud = liftmesh.Cloud(np.random.default_rng(0).integers(0, 9999, (5000, 3)) / 100.0)
    with pytest.raises(OSError, match="No space left"):
        liftmesh.write(_Full(), cloud, format="laz")
