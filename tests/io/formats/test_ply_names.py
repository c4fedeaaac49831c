"""Names that PLY cannot hold: made valid, told, and given back by reading."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from commands import liftmesh as command
from file_samples import loaded, saved
from hypothesis import given, settings, strategies as st

import liftmesh
from liftmesh import Cloud
from liftmesh.io.columns import ALPHA, COLOR, NORMAL, POSITION

POINTS = np.array([[0, 0, 5], [1, 0, 6], [0, 1, 7]], dtype=np.float64)
GIVEN = ["scalar field #1", "Scan Angle", "Höhe", "", "a\nb", "高さ", "class"]
SPECIAL = [*POSITION, *NORMAL, *COLOR, ALPHA]
ODD = ["a b", "a_b", "a_b_1", "a\tb", "é", "x_1", "blúe", "álpha", " nz"]
NAMES = st.lists(
    st.sampled_from(
        [*SPECIAL, *GIVEN, "a b", "a_b", "a_b_1", "a\tb", "é", "x_1", "blúe", "ALPHA ", " nz"]
    )
    | st.text(),
    unique=True,
)


def named(names: list[str], **more: Any) -> Cloud:
    columns = {name: np.arange(3) + 10 * k for k, name in enumerate(names)}
    return Cloud(POINTS, attributes=columns, **more)


def test_names_of_other_programs_are_made_valid_and_come_back() -> None:
    cloud = named(GIVEN)
    written = liftmesh.write(stream := io.BytesIO(), cloud, format="ply")
    assert written.renamed == (
        ("scalar field #1", "scalar_field_1"),
        ("Scan Angle", "Scan_Angle"),
        ("Höhe", "Hohe"),
        ("", "attribute"),
        ("a\nb", "a_b"),
        ("高さ", "attribute_1"),
    )
    assert b'comment property Hohe "H\\u00f6he"\n' in stream.getvalue()
    back = loaded(stream.getvalue(), "ply")
    assert [*back.attributes] == GIVEN
    assert "comments" not in back.metadata


def test_other_programs_read_the_valid_names() -> None:
    data = saved(named(GIVEN), "ply")
    mesh = trimesh.load(io.BytesIO(data), file_type="ply")
    held = mesh.metadata["_ply_raw"]["vertex"]["data"]
    assert held["Scan_Angle"].tolist() == [10, 11, 12]


@settings(max_examples=60)
@given(names=NAMES, colors=st.sampled_from([0, 3, 4]), normals=st.booleans())
def test_every_name_comes_back(names: list[str], colors: int, normals: bool) -> None:
    rgb = np.arange(3 * colors, dtype=np.uint8).reshape(3, colors) if colors else None
    cloud = named(names, colors=rgb, normals=np.eye(3) if normals else None)
    for encoding in ("binary", "ascii"):
        back = loaded(saved(cloud, "ply", encoding=encoding), "ply")
        assert {key: v.tolist() for key, v in back.attributes.items()} == {
            key: v.tolist() for key, v in cloud.attributes.items()
        }
        assert (back.colors is None) == (rgb is None)
        assert back.colors is None or back.colors.tolist() == rgb.tolist()  # type: ignore[union-attr]
        assert (back.normals is None) != normals


def test_columns_of_one_attribute_come_back_as_columns() -> None:
    cloud = Cloud(POINTS, attributes={"two words": np.eye(3)})
    assert [*loaded(saved(cloud, "ply"), "ply").attributes] == [f"two words_{k}" for k in range(3)]


def test_chunks_have_the_names() -> None:
    data = saved(named(GIVEN), "ply")
    for chunk in liftmesh.read_chunks(io.BytesIO(data), rows=2, format="ply"):
        assert [*chunk.attributes] == GIVEN


@pytest.mark.parametrize(
    "text", ['property z "a"', 'property b "a"', "property a b", 'property a "class"', "property"]
)
def test_a_comment_that_states_no_name_stays_a_comment(text: str) -> None:
    data = saved(named(["a", "class"]), "ply")
    data = data.replace(b"element vertex", f"comment {text}\nelement vertex".encode())
    back = loaded(data, "ply")
    assert [*back.attributes] == ["a", "class"]
    assert back.metadata["comments"] == (text,)


def test_many_names_that_become_one_are_numbered_quickly() -> None:
    names = [chr(0x4E00 + k) for k in range(5000)]
    assert [*loaded(saved(named(names), "ply"), "ply").attributes] == names


@pytest.mark.parametrize(
    ("target", "attributes", "cause"),
    [
        ("mesh.ply", {"id": np.array([0, 1, 2**60])}, "2**53"),
        ("mesh.npz", {"faces": np.arange(3)}, "'faces'"),
    ],
)
def test_what_cannot_be_written_is_refused_before_the_work(
    target: str, attributes: dict[str, np.ndarray], cause: str, tmp_path: Path
) -> None:
    # Points on a line: whoever starts to triangulate them complains of that instead.
    line = Cloud(np.arange(9.0).reshape(3, 3), attributes=attributes)
    source = tmp_path / ("cloud.ply" if target.endswith("npz") else "cloud.npz")
    liftmesh.write(source, line)
    done = command("triangulate", source, tmp_path / target)
    assert done.returncode == 3
    assert cause in done.stderr
    assert not (tmp_path / target).exists()


def test_infinite_rows_are_refused_before_the_work(tmp_path: Path) -> None:
    points = np.vstack([np.arange(9.0).reshape(3, 3), [[np.inf, 0, 0]]])
    liftmesh.write(tmp_path / "cloud.ply", points)
    options = ("--nonfinite", "skip")
    done = command("triangulate", tmp_path / "cloud.ply", tmp_path / "mesh.glb", *options)
    assert done.returncode == 3
    assert "vertex 3 is [inf" in done.stderr


def test_the_command_tells_the_new_names(tmp_path: Path) -> None:
    liftmesh.write(tmp_path / "cloud.npz", named(["Scan Angle"]))
    done = command("triangulate", tmp_path / "cloud.npz", tmp_path / "mesh.ply")
    assert "renamed: 'Scan Angle' to Scan_Angle" in done.stdout
