"""Colours of more bits than they use: decided once, from all values, and said."""

from __future__ import annotations

import io
import pickle
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from commands import liftmesh as command
from file_samples import loaded, saved

import liftmesh
from liftmesh import Cloud, InputError

RED = np.array([[255, 0, 0], [200, 100, 50], [0, 0, 0], [9, 9, 9]])
POINTS = np.array([[0, 0, 5], [1, 0, 6], [0, 1, 7], [1, 1, 8]], dtype=np.float64)
INTEGERS = [np.int8, np.int16, np.uint16, np.int32, np.uint32, np.int64, np.uint64]
DEEP = np.vstack([RED, [[65535, 0, 256]]])  # only the last row shows that the others are dark
FIVE = np.vstack([POINTS, [[2, 2, 9]]])


def ply(colors: np.ndarray, points: np.ndarray = POINTS) -> bytes:
    """Write a PLY file with 16-bit colours as PDAL writes it."""
    row = np.dtype([("p", "<f8", 3), ("c", "<u2", 3)])
    rows = np.empty(len(points), row)
    rows["p"], rows["c"] = points, colors
    names = [f"property double {k}" for k in "xyz"] + [
        f"property ushort {k}" for k in ("red", "green", "blue")
    ]
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}", *names]
    return "\n".join([*head, "end_header", ""]).encode() + rows.tobytes()


def npz(colors: np.ndarray, points: np.ndarray = POINTS) -> bytes:
    stream = io.BytesIO()
    np.savez(stream, points=points, colors=colors)
    return stream.getvalue()


def npy(colors: np.ndarray, points: np.ndarray = POINTS) -> bytes:
    """Save the array that PDAL's pipelines give, with colours."""
    kind = [(k, "<f8") for k in "xyz"] + [(k, "<u2") for k in ("red", "green", "blue")]
    rows = [(*p, *c) for p, c in zip(points.tolist(), colors.tolist(), strict=True)]
    stream = io.BytesIO()
    np.save(stream, np.array(rows, dtype=kind))
    return stream.getvalue()


FILES = {"ply": ply, "npz": npz, "npy": npy}


@pytest.mark.parametrize("kind", FILES)
def test_16_bit_colours_that_hold_8_bit_values_are_not_black(kind: str) -> None:
    cloud = loaded(FILES[kind](RED.astype(np.uint16)), kind)
    assert cloud.color_depth == 8
    again = loaded(saved(cloud, "ply"), "ply")
    assert again.colors is not None
    assert again.colors.tolist() == RED.tolist()


@pytest.mark.parametrize("dtype", INTEGERS)
@pytest.mark.parametrize("kind", ["ply", "obj", "npz", "glb", "gltf"])
def test_integers_of_every_type_are_accepted_by_every_format(kind: str, dtype: Any) -> None:
    colors = np.minimum(RED, 127).astype(dtype)
    faces = np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32)
    cloud = Cloud(POINTS, colors=colors, faces=faces)
    again = loaded(saved(cloud, kind), kind).colors
    assert again is not None
    assert again.dtype == np.uint8
    assert again[:, :3].tolist() == colors.tolist()


@pytest.mark.parametrize("dtype", [np.uint16, np.int32, np.uint32, np.int64, np.uint64])
def test_larger_values_are_16_bit_colours_whatever_holds_them(dtype: Any) -> None:
    cloud = Cloud(FIVE, colors=DEEP.astype(dtype))
    assert cloud.color_depth == 16
    assert cloud.colors is not None
    assert cloud.colors.dtype == np.uint16
    assert cloud.colors.tolist() == DEEP.tolist()


def test_the_full_range_of_wide_types_is_used_beyond_16_bits() -> None:
    deepest = np.array([[2**32 - 1, 0, 65536]], dtype=np.uint32)
    cloud = Cloud(POINTS[:1], colors=deepest)
    assert cloud.color_depth == 32
    assert loaded(saved(cloud, "ply"), "ply").colors.tolist() == [[255, 0, 0]]  # type: ignore[union-attr]


@pytest.mark.parametrize("kind", [*FILES, "csv"])
def test_all_chunks_of_a_file_have_one_depth(kind: str) -> None:
    if kind == "csv":
        rows = np.hstack([FIVE, DEEP]).tolist()
        text = "x,y,z,red,green,blue\n" + "".join(",".join(map(repr, row)) + "\n" for row in rows)
        data = text.encode()
    else:
        data = FILES[kind](DEEP.astype(np.uint16), FIVE)
    chunks = [*liftmesh.read_chunks(io.BytesIO(data), rows=2, format=kind)]
    assert [chunk.color_depth for chunk in chunks] == [16, 16, 16]
    assert np.vstack([chunk.colors for chunk in chunks]).tolist() == DEEP.tolist()  # type: ignore[misc]
    assert {chunk.colors.dtype for chunk in chunks} == {np.dtype(np.uint16)}  # type: ignore[union-attr]


def test_numbers_that_are_no_colours_do_not_stop_the_chunks_before_them() -> None:
    head = "ply\nformat ascii 1.0\nelement vertex 3\n"
    names = "".join(f"property int {each}\n" for each in ("x", "y", "red", "green", "blue"))
    data = f"{head}{names}end_header\n0 0 1 2 3\n1 0 4 5 6\n2 0 -7 8 9\n".encode()
    whole = liftmesh.read(io.BytesIO(data), format="ply").colors
    chunks = [each.colors for each in liftmesh.read_chunks(io.BytesIO(data), rows=1, format="ply")]
    assert whole is not None
    assert np.array_equal(np.vstack(chunks), whole)  # type: ignore[arg-type]


def test_chunks_of_8_bit_values_have_the_depth_of_the_file() -> None:
    data = ply(RED.astype(np.uint16))
    chunks = [*liftmesh.read_chunks(io.BytesIO(data), rows=2, format="ply")]
    assert [(chunk.color_depth, chunk.colors.dtype) for chunk in chunks] == [(8, np.uint8)] * 2  # type: ignore[union-attr]


def test_chunks_of_a_file_with_negative_colours_stay_as_they_are() -> None:
    colors = np.array([[1, 2, 3], [4, 5, 6], [300, 0, 0], [-16, 0, 0]], dtype=np.int16)
    data = npz(colors)
    chunks = [*liftmesh.read_chunks(io.BytesIO(data), rows=2, format="npz")]
    assert np.vstack([chunk.colors for chunk in chunks]).tolist() == colors.tolist()  # type: ignore[misc]
    assert liftmesh.read(io.BytesIO(data), format="npz").color_depth is None


def test_a_dark_part_of_a_16_bit_cloud_stays_dark() -> None:
    cloud = Cloud(FIVE, colors=DEEP.astype(np.uint16))
    part = cloud.select(slice(0, 4))
    surface = liftmesh.triangulate(part)
    copies = (part, pickle.loads(pickle.dumps(part)), replace(part, crs="EPSG:2056"))
    for each in (*copies, surface.to_cloud()):
        assert each.color_depth == 16
        assert loaded(saved(each, "ply"), "ply").colors.tolist()[0] == [1, 0, 0]  # type: ignore[union-attr]


@pytest.mark.parametrize("kind", FILES)
def test_an_option_overrides(kind: str) -> None:
    data = FILES[kind](RED.astype(np.uint16))
    whole = liftmesh.read(io.BytesIO(data), format=kind, color_depth=16)
    parts = liftmesh.read_chunks(io.BytesIO(data), rows=3, format=kind, color_depth=16)
    for cloud in (whole, *parts):
        assert cloud.colors is not None
        assert (cloud.color_depth, cloud.colors.dtype) == (16, np.uint16)
    explicit = Cloud(POINTS, colors=RED.astype(np.uint16), color_depth=16)
    assert loaded(saved(explicit, "ply"), "ply").colors.tolist()[0] == [1, 0, 0]  # type: ignore[union-attr]


def test_other_colours_in_place_of_decided_ones_are_decided_anew() -> None:
    deep = Cloud(FIVE, colors=DEEP.astype(np.uint16))
    assert replace(deep, colors=RED[[0, 1, 2, 3, 0]].astype(np.uint8)).color_depth is None
    assert replace(deep, colors=np.zeros((5, 3))).color_depth is None
    assert replace(deep, colors=None).color_depth is None
    floats = Cloud(POINTS, colors=np.zeros((4, 3)))
    assert floats.with_color_depth(16).colors is floats.colors


def test_a_depth_that_does_not_hold_the_colours_is_refused() -> None:
    data = ply(DEEP.astype(np.uint16), FIVE)
    with pytest.raises(InputError, match=r"<stream>: row 4 .* outside 0\.\.255.*color_depth=8"):
        liftmesh.read(io.BytesIO(data), format="ply", color_depth=8)
    for wrong in (12, True, 0):
        with pytest.raises(InputError, match="color_depth is"):
            liftmesh.read(io.BytesIO(data), format="ply", color_depth=wrong)


@pytest.mark.parametrize("bad", [-1, 65536])
def test_signed_integers_that_are_no_colours_are_refused_when_written(bad: int) -> None:
    cloud = Cloud(POINTS, colors=np.where(RED == 9, bad, RED))
    assert cloud.color_depth is None
    with pytest.raises(InputError, match=r"row 3 has the colour"):
        saved(cloud, "ply")


def test_the_command_says_it_and_takes_the_option(tmp_path: Any) -> None:
    source, target = tmp_path / "cloud.ply", tmp_path / "mesh.ply"
    source.write_bytes(ply(RED.astype(np.uint16)))
    done = command("triangulate", source, target)
    assert "8-bit colours" in done.stderr
    assert liftmesh.read(target).colors.tolist() == RED.tolist()  # type: ignore[union-attr]
    done = command("triangulate", source, target, "--color-depth", "16", "--overwrite")
    assert (done.returncode, done.stderr) == (0, "")
    assert liftmesh.read(target).colors.tolist()[0] == [1, 0, 0]  # type: ignore[union-attr]
    assert command("triangulate", source, target, "--color-depth", "9").returncode == 2


@pytest.mark.parametrize("kind", INTEGERS[1:])
def test_colours_given_apart_have_a_depth_of_their_own(kind: Any) -> None:
    deep = Cloud(POINTS, colors=257 * RED.astype(np.uint16))
    red = RED.astype(kind)
    surface = liftmesh.triangulate(deep, colors=red)
    for each in (surface, liftmesh.triangulate(deep).replace(colors=red)):
        found = loaded(saved(each, "ply"), "ply").colors
        assert found is not None
        assert np.array_equal(found, RED)


def test_the_report_says_how_colours_were_taken() -> None:
    points = np.array([[0.0, 0, 5], [1, 0, 6], [0, 1, 7]])
    for colors in (RED[:3].astype(np.uint16), RED[:3], RED[:3].tolist()):
        surface = liftmesh.triangulate(points, colors=colors)
        assert surface.report.color_depth == 8
        assert "Integer colours taken as 8-bit." in str(surface.report)
    assert liftmesh.triangulate(points, colors=DEEP[2:]).report.color_depth == 16
    plain = liftmesh.triangulate(points, colors=RED.astype(np.uint8)[:3]).report
    assert plain.color_depth is None
    assert "colours" not in str(plain)


def test_replacing_colours_of_a_surface_keeps_their_depth() -> None:
    dark = RED.astype(np.uint16)
    surface = liftmesh.triangulate(Cloud(POINTS, colors=dark).with_color_depth(16))
    changed = [
        surface.replace(colors=surface.colors),
        surface.replace(colors=RED, color_depth=16),
        liftmesh.triangulate(POINTS, colors=dark).replace(color_depth=16),
        surface.replace(crs="EPSG:25832"),
    ]
    for each in changed:
        assert each.colors is not None
        assert each.colors.dtype == np.uint16
        assert each.to_cloud().color_depth == 16
    anew = surface.replace(colors=dark).colors
    assert anew is not None
    assert anew.dtype == np.uint8
    with pytest.raises(InputError, match=r"row 0 has the colour .* color_depth=8"):
        surface.replace(colors=RED * 257, color_depth=8)


EXACT = [
    ("npz", {}),
    ("ply", {"colors": "exact"}),
    ("ply", {"colors": "exact", "encoding": "ascii"}),
]


@pytest.mark.parametrize(("kind", "options"), EXACT)
def test_a_dark_part_of_a_deep_cloud_stays_dark(kind: str, options: dict[str, str]) -> None:
    dark = Cloud(FIVE, colors=DEEP.astype(np.uint16)).select(slice(0, 4))
    assert dark.color_depth == 16
    data = saved(dark, kind, **options)
    back = loaded(data, kind)
    assert back.color_depth == 16
    assert np.array_equal(back.colors, dark.colors)  # type: ignore[arg-type]
    pieces = [*liftmesh.read_chunks(io.BytesIO(data), format=kind, rows=3)]
    assert [piece.color_depth for piece in pieces] == [16, 16]
    assert saved(back, kind, **options) == data
    assert loaded(data, kind).metadata.keys() <= {"source", "format"}


@pytest.mark.parametrize(("kind", "options"), EXACT)
def test_a_depth_that_the_values_tell_is_not_stated(kind: str, options: dict[str, str]) -> None:
    for colors in (RED.astype(np.uint8), RED.astype(np.uint16), DEEP.astype(np.uint16)):
        data = saved(Cloud(FIVE[: len(colors)], colors=colors), kind, **options)
        assert b"color_depth" not in data


@pytest.mark.parametrize("kind", ["glb", "gltf"])
def test_gltf_rounds_dark_colours_of_16_bits_to_black(kind: str) -> None:
    dark = Cloud(FIVE, colors=DEEP.astype(np.uint16)).select(slice(0, 4))
    back = loaded(saved(dark, kind), kind).colors
    assert back is not None
    assert back[:, :3].max() == 1  # 255 of 65,535


def test_a_depth_of_another_type_is_a_comment_like_others() -> None:
    text = saved(Cloud(POINTS, colors=RED.astype(np.uint8)), "ply", comments=["color_depth 16"])
    back = loaded(text, "ply")
    assert (back.color_depth, back.metadata["comments"]) == (None, ("color_depth 16",))
    stream = io.BytesIO()
    np.savez(stream, points=POINTS, colors=RED.astype(np.uint16), color_depth=np.uint8(32))
    assert loaded(stream.getvalue(), "npz").color_depth == 8


def test_an_archive_has_an_attribute_or_a_depth_of_one_name() -> None:
    named = {"color_depth": np.arange(4)}
    assert [*loaded(saved(Cloud(POINTS, attributes=named), "npz"), "npz").attributes] == [*named]
    dark = Cloud(POINTS, colors=RED.astype(np.uint16), color_depth=16, attributes=named)
    with pytest.raises(liftmesh.FormatError, match="attribute 'color_depth'"):
        saved(dark, "npz")
