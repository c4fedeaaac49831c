"""Symbolic links that lead in a circle: refused as input and as output, and left as they are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from commands import ROOT, failed, liftmesh as command

import liftmesh
from liftmesh.cli import exit_codes

WORDS = {
    "info": ["info", "loop.ply"],
    "verify": ["verify", "loop.ply"],
    "compare": ["compare", "loop.ply"],
    "triangulate, input": ["triangulate", "loop.ply", "mesh.ply"],
    "triangulate, output": ["triangulate", "cloud.npy", "loop.ply"],
    "in a folder": ["triangulate", "cloud.npy", "loop.ply/mesh.ply"],
    "two outputs": ["compare", "cloud.npy", "--lower", "lower.ply", "--hull", "loop.ply"],
    "input, two outputs": ["compare", "loop.ply", "--lower", "lower.ply", "--hull", "hull.ply"],
    "certificate": ["verify", str(ROOT / "data/jacksboro.ply"), "--certificate", "loop.ply"],
}


@pytest.fixture(params=["itself", "each other"])
def folder(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    np.save(tmp_path / "cloud.npy", np.random.default_rng(0).random((20, 3)))
    if request.param == "itself":
        (tmp_path / "loop.ply").symlink_to("loop.ply")
    else:
        (tmp_path / "loop.ply").symlink_to("other.ply")
        (tmp_path / "other.ply").symlink_to("loop.ply")
    return tmp_path


@pytest.mark.parametrize("words", WORDS.values(), ids=WORDS)
def test_a_command_refuses_a_circle_of_links(words: list[str], folder: Path) -> None:
    before = sorted(folder.iterdir())
    done = command(*words, cwd=folder)
    failed(done, exit_codes.BAD_INPUT, "loop.ply", "links lead in a circle")
    assert sorted(folder.iterdir()) == before
    assert (folder / "loop.ply").is_symlink()


def test_the_library_refuses_a_circle_of_links(folder: Path) -> None:
    loop = folder / "loop.ply"
    with pytest.raises(liftmesh.FormatError, match=r"loop\.ply: its symbolic links"):
        liftmesh.read(loop)
    with pytest.raises(liftmesh.FormatError, match=r"loop\.ply: its symbolic links"):
        list(liftmesh.read_chunks(loop))
    with pytest.raises(liftmesh.FormatError, match=r"loop\.ply: its symbolic links"):
        liftmesh.write(loop, np.eye(3))
    assert loop.is_symlink()


def test_a_link_that_leads_to_no_file_yet_is_followed(tmp_path: Path) -> None:
    (tmp_path / "link.ply").symlink_to("mesh.ply")
    liftmesh.write(tmp_path / "link.ply", np.eye(3))
    assert (tmp_path / "link.ply").is_symlink()
    assert len(liftmesh.read(tmp_path / "mesh.ply")) == 3


def test_a_buffer_of_gltf_may_not_be_a_circle_either(tmp_path: Path) -> None:
    (tmp_path / "loop.bin").symlink_to("loop.bin")
    (tmp_path / "mesh.gltf").write_text(
        '{"asset": {"version": "2.0"}, "buffers": [{"uri": "loop.bin", "byteLength": 36}]}'
    )
    with pytest.raises(liftmesh.FormatError, match="does not exist"):
        liftmesh.read(tmp_path / "mesh.gltf")
