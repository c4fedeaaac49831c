"""Metadata: what the user or a file said comes back or is named, and no path is ever written."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from file_samples import loaded, saved, small_mesh
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh import Cloud, FormatError
from liftmesh.io.metadata import (
    LIFTED,
    NotedColumns,
    Provenance,
    as_extras,
    crs_comment,
    is_lines,
    of_extras,
    others,
    plain_lines,
    stated_crs,
    storable,
    user_entries,
)

KEEPING = ("ply", "obj", "npz", "glb", "gltf")
MESH = small_mesh()


def mesh(metadata: dict[str, Any], **more: Any) -> Cloud:
    return Cloud(MESH.points, faces=MESH.faces, metadata=metadata, **more)


def back(kind: str, metadata: dict[str, Any]) -> dict[str, Any]:
    return user_entries(loaded(saved(mesh(metadata), kind), kind).metadata)


VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(), inner, max_size=3),
    max_leaves=6,
)
ENTRIES = st.dictionaries(
    st.text() | st.sampled_from(["crs", "origin", "metadata", "comments", "obj_info"]),
    VALUES,
    max_size=4,
)


@settings(max_examples=60)
@given(entries=ENTRIES, kind=st.sampled_from(KEEPING))
def test_every_entry_comes_back_or_is_named(entries: dict[str, Any], kind: str) -> None:
    written = liftmesh.write(stream := io.BytesIO(), mesh(entries), format=kind)
    cloud = loaded(stream.getvalue(), kind)
    lost = {each.removeprefix("metadata ") for each in written.dropped}
    assert listed(user_entries(cloud.metadata)) == listed(
        {key: value for key, value in entries.items() if key not in lost}
    )
    assert cloud.crs is None


def listed(value: Any) -> Any:
    """Replace tuples by lists, which JSON gives back."""
    if isinstance(value, list | tuple):
        return [listed(each) for each in value]
    if isinstance(value, dict):
        return {key: listed(each) for key, each in value.items()}
    return value


LINES = st.lists(
    st.text(max_size=9)
    | st.sampled_from(["a\\", "# b", 'metadata {"a": 1}', "", 'crs "X"', "liftmesh"])
)


@settings(max_examples=60)
@given(lines=LINES, kind=st.sampled_from(("ply", "obj", "npz")))
def test_every_comment_comes_back_in_its_place(lines: list[str], kind: str) -> None:
    cloud = mesh({"comments": tuple(lines)} if lines else {})
    found = loaded(saved(cloud, kind), kind)
    assert list(found.metadata.get("comments", ())) == lines
    assert len(found) == len(cloud)


@pytest.mark.parametrize("kind", KEEPING)
def test_bytes_tell_no_path_and_no_format(kind: str, tmp_path: Path) -> None:
    first, second = tmp_path / "a.ply", tmp_path / "b.npz"
    liftmesh.write(first, mesh({"survey": 2024}))
    liftmesh.write(second, mesh({"survey": 2024}))
    one, other = (saved(liftmesh.read(path), kind) for path in (first, second))
    assert one == other == saved(mesh({"survey": 2024}), kind)


@pytest.mark.parametrize("kind", ["stl", "off"])
def test_formats_without_a_place_for_it_name_it(kind: str) -> None:
    cloud = mesh({"survey": 2024, "extent": (0, 1)}, crs="EPSG:2056")
    written = liftmesh.write(io.BytesIO(), cloud, format=kind)
    assert written.dropped[-3:] == ("crs", "metadata extent", "metadata survey")


@pytest.mark.parametrize("kind", KEEPING)
@pytest.mark.parametrize(
    "value",
    [np.zeros(3), {1: "a"}, float("nan"), {1, 2}, b"bytes", "x" * 40_000, object()],
    ids=["array", "numbers as keys", "nan", "set", "bytes", "long", "object"],
)
def test_what_json_does_not_hold_is_named(kind: str, value: object) -> None:
    written = liftmesh.write(io.BytesIO(), mesh({"survey": value, "a": 1}), format=kind)
    assert written.dropped == ("metadata survey",)
    assert back(kind, {"survey": value, "a": 1}) == {"a": 1}


@pytest.mark.parametrize("kind", ["ply", "obj"])
@pytest.mark.parametrize(
    ("lines", "dropped"),
    [
        ([f"line {k} {'x' * 60}" for k in range(2000)], ()),
        ([f"line {k} {'x' * 60}" for k in range(9000)], ("metadata comments",)),
        (["ü"] * 5_000, ()),
        (["ü"] * 9_000, ("metadata comments",)),
        (["ü" * 5_440], ()),
        (["ü" * 5_462], ("metadata comments",)),
        (["x" * 32_680], ()),
        (["x" * 32_768], ("metadata comments",)),
    ],
)
def test_lines_are_written_if_each_of_them_fits(
    kind: str, lines: list[str], dropped: tuple[str, ...]
) -> None:
    cloud = mesh({"comments": tuple(lines)})
    written = liftmesh.write(stream := io.BytesIO(), cloud, format=kind)
    assert written.dropped == dropped
    found = loaded(stream.getvalue(), kind).metadata.get("comments", ())
    assert list(found) == ([] if dropped else lines)


def test_deep_nesting_is_named() -> None:
    deep: list[Any] = []
    for _ in range(100_000):
        deep = [deep]
    assert liftmesh.write(io.BytesIO(), mesh({"a": deep}), format="ply").dropped == ("metadata a",)


def test_labels_of_the_user_are_named() -> None:
    written = liftmesh.write(io.BytesIO(), mesh({"source": "a survey"}), format="ply")
    assert written.dropped == ("metadata source",)


def test_numpy_scalars_and_tuples_come_back_as_json_has_them() -> None:
    assert back("npz", {"a": np.float64(0.1), "b": np.int64(3), "c": (1, (2,))}) == {
        "a": 0.1,
        "b": 3,
        "c": [1, [2]],
    }


@pytest.mark.parametrize("between", ["obj", "npz", "glb"])
def test_lines_of_a_ply_file_survive_other_formats(between: str) -> None:
    data = saved(mesh({}), "ply").replace(
        b"element vertex",
        b"comment made by hand\ncomment h\xc3\xb6he\nobj_info 2 2\nelement vertex",
    )
    cloud = loaded(data, "ply")
    assert cloud.metadata["comments"] == ("made by hand", "höhe")
    again = loaded(saved(loaded(saved(cloud, between), between), "ply"), "ply")
    assert (again.metadata["comments"], again.metadata["obj_info"]) == (
        cloud.metadata["comments"],
        ("2 2",),
    )


def test_a_surface_keeps_what_its_file_said(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_bytes(b"# Survey of 2024\nv 0 0 1\nv 1 0 2\nv 0 1 3\n")
    liftmesh.triangulate(tmp_path / "a.obj").save(tmp_path / "b.ply")
    assert b"comment Survey of 2024\n" in (tmp_path / "b.ply").read_bytes()


def test_comments_given_again_are_written_once() -> None:
    cloud = mesh({"comments": ("made by hand",)})
    text = saved(cloud, "ply", comments=["made by hand", "twice"])
    assert text.count(b"made by hand") == text.count(b"twice") == 1


def test_a_comment_of_obj_may_not_swallow_the_next_line() -> None:
    with pytest.raises(FormatError, match="not a single line"):
        saved(MESH, "obj", comments=["path\\"])


@pytest.mark.parametrize("text", ['metadata {"a": 1', "metadata [1]", "metadata", "metadata {}x"])
def test_comments_that_only_look_like_entries_stay_comments(text: str) -> None:
    data = saved(MESH, "ply").replace(b"element vertex", f"comment {text}\nelement vertex".encode())
    assert loaded(data, "ply").metadata["comments"] == (text,)


def test_an_npz_text_that_states_nothing_is_named() -> None:
    stream = io.BytesIO()
    np.savez(stream, points=MESH.points, metadata=np.array("made by hand"))
    assert loaded(stream.getvalue(), "npz").metadata["not_read"] == ("metadata ()",)


def test_chunks_hold_the_metadata() -> None:
    for kind in ("ply", "npz"):
        data = saved(mesh({"survey": 2024}), kind)
        chunks = liftmesh.read_chunks(io.BytesIO(data), rows=3, format=kind)
        assert [chunk.metadata["survey"] for chunk in chunks] == [2024, 2024]


@pytest.mark.parametrize("kind", KEEPING)
def test_what_was_found_of_a_table_is_not_written(kind: str) -> None:
    text = b"Easting;Northing;Height;code\n0,5;0;5;a\n1;0;6;b\n0;1;7;c\n"
    named = np.array([(0, 0, 5), (1, 0, 6), (0, 1, 7)], [("E", "f8"), ("N", "f8"), ("H", "f8")])
    tables = [liftmesh.read(io.BytesIO(text), format="csv"), liftmesh.as_cloud(named)]
    for cloud in tables:
        surface = liftmesh.triangulate(cloud)
        assert "columns" in surface.metadata
        written = liftmesh.write(stream := io.BytesIO(), surface, format=kind)
        assert not [each for each in written.dropped if each.startswith("metadata")]
        assert user_entries(loaded(stream.getvalue(), kind).metadata) == {}
    assert not any(user_entries(cloud.metadata) for cloud in tables)
    assert tables[0].metadata["notes"]


def test_columns_and_notes_of_the_user_are_named_if_they_are_no_tables() -> None:
    cloud = mesh({"notes": "by hand", "columns": 7})
    written = liftmesh.write(io.BytesIO(), cloud, format="ply")
    assert written.dropped == ("metadata columns", "metadata notes")


@pytest.mark.parametrize("line", ['property class "code"', "color_depth 16", 'crs "EPSG:1"'])
def test_lines_that_look_like_statements_come_back_as_lines(line: str) -> None:
    colors = np.full((4, 3), 999, dtype=np.uint16)
    cloud = mesh({"comments": (line,)}, colors=colors, attributes={"class": np.arange(4)})
    again = loaded(saved(cloud, "ply", colors="exact"), "ply")
    assert again.metadata["comments"] == (line,)
    assert ([*again.attributes], again.crs) == (["class"], None)


NOTES = {"source": "survey", "format": "paper", "columns": {"x": "E"}, "origin": [1, 2, 3]}


@pytest.mark.parametrize("kind", ["texture", "face"])
def test_entries_of_a_user_switch_nothing(kind: str) -> None:
    visual = {"visual": trimesh.visual.TextureVisuals(uv=np.eye(3)[:, :2])}
    if kind == "face":
        visual = {"face_colors": [[255, 0, 0, 255]]}
    lost = {"texture": "texture", "face": "colors of faces"}[kind]
    for metadata in ({}, {"not_read": "mine", "processed": "2024", **NOTES}):
        mesh = trimesh.Trimesh(np.eye(3), [[0, 1, 2]], process=False, metadata=metadata, **visual)
        for source in (mesh, liftmesh.triangulate(mesh), trimesh.Scene([mesh])):
            cloud = liftmesh.as_cloud(source)
            dropped = liftmesh.write(io.BytesIO(), cloud, format="ply").dropped
            assert any(each.startswith(lost) for each in dropped)
            named = {each.partition(" of ")[0] for each in dropped}
            assert {f"metadata {key}" for key in metadata if key != "processed"} <= named
            assert cloud.metadata.get("processed") == metadata.get("processed")
    report = liftmesh.triangulate(Cloud(np.eye(3), metadata=NOTES)).report
    assert (report.columns, report.transformation) == ({}, {})


def test_a_mesh_that_was_read_and_textured_later_says_so(tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "a.ply", Cloud(np.eye(3), faces=np.array([[0, 1, 2]], np.int32)))
    mesh = liftmesh.triangulate(tmp_path / "a.ply").to_trimesh()
    mesh.visual = trimesh.visual.TextureVisuals(uv=np.eye(3)[:, :2])
    dropped = liftmesh.write(io.BytesIO(), liftmesh.as_cloud(mesh), format="ply").dropped
    assert dropped == ("texture",)


def test_merging_keeps_what_users_say_under_the_names_of_notes() -> None:
    clouds = [Cloud(np.eye(3), metadata={**NOTES, "selection": "mine"}) for _ in range(2)]
    assert {**NOTES, "selection": "mine"}.items() <= liftmesh.merge(clouds).metadata.items()
    others = [clouds[0], Cloud(np.eye(3), metadata={"source": "another"})]
    assert "metadata source" in liftmesh.merge(others).metadata["not_read"]


def test_extras_of_other_programs_do_not_pose_as_notes() -> None:
    scene = trimesh.Scene([trimesh.creation.box()])
    scene.metadata = {"columns": {"x": "E"}, "notes": 5, "source": "Blender", "survey": 2024}
    data = scene.export(file_type="glb")
    found = liftmesh.read(io.BytesIO(data), format="glb")
    assert found.metadata["extras"] == {"columns": {"x": "E"}, "notes": 5, "source": "Blender"}
    assert found.metadata["survey"] == 2024
    stream = io.BytesIO()
    assert liftmesh.write(stream, found, format="glb").dropped == ()
    again = liftmesh.read(io.BytesIO(stream.getvalue()), format="glb")
    assert again.metadata["extras"] == found.metadata["extras"]


def test_comments_that_pose_as_notes_stay_comments() -> None:
    head = 'ply\nformat ascii 1.0\ncomment metadata {"selection": {"rows": 1}}\n'
    body = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n"
    found = liftmesh.read(io.BytesIO((head + body + "1 2 3\n").encode()), format="ply")
    assert found.metadata["comments"] == ('metadata {"selection": {"rows": 1}}',)


def test_entries_of_scenes_have_names_of_their_own() -> None:
    inner = {"survey": 2024, "metadata": {"crs": 25832}}
    assert as_extras({"survey": 2024, "crs": 25832}) == inner
    assert of_extras(inner) == {"survey": 2024, "crs": 25832}
    assert of_extras({"source": "Blender"}) == {"extras": {"source": "Blender"}}


def test_what_is_stored_and_what_counts_as_lines() -> None:
    entries = {"survey": 2024, "extent": (0, 1), "where": {1, 2}}
    assert storable(entries) == {"extent": [0, 1], "survey": 2024}
    assert [*map(is_lines, (["a", "b"], "ab", [], ["a", 1]))] == [True, False, False, False]
    lines = {"obj_info": ["grid 2 2"], "more": ["# a"]}
    assert (plain_lines(lines, "obj_info"), plain_lines(lines, "more")) == (["grid 2 2"], [])
    assert lines == {"more": ["# a"]}


def test_only_readers_make_notes() -> None:
    assert not Provenance({"source": "survey", "format": "paper"}).is_read
    assert Provenance({"columns": NotedColumns(x="E")}).columns == {"x": "E"}
    assert Provenance({"columns": {"x": "E"}}).columns == {}


@pytest.mark.parametrize(
    ("said", "is_known"),
    [
        ({"radii": "size"}, True),
        ({"metric": [[1, 0], [0, 2.5]]}, True),
        ({"metric": [[1, 0]]}, False),
        ({"weights": 3}, False),
        ("by hand", False),
    ],
)
def test_by_what_a_mesh_was_lifted(said: object, is_known: bool) -> None:
    assert Provenance({LIFTED: said}).lifted_by == (said if is_known else {})


def test_the_coordinate_system_in_a_comment() -> None:
    assert crs_comment("EPSG:25832") == ['crs "EPSG:25832"']
    assert crs_comment(None) == []
    assert stated_crs(["crs by hand", 'crs "EPSG:25832"']) == "EPSG:25832"
    assert others(["liftmesh", 'crs "EPSG:25832"', "a"], "EPSG:25832") == ("a",)
