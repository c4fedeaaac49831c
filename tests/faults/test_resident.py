"""Readers take at most 20 bytes of memory for each byte of a file, whatever it holds."""

from __future__ import annotations

import mmap
import os
import signal

import pytest
from growth.files.arrays import LIES
from growth.resident import ADDRESSES, FIXED, Held, forked, measured
from growth.subjects import FILES, subjects

from liftmesh.io.registry import FORMATS

pytestmark = pytest.mark.campaign

IN_CHUNKS = [each.name for each in FORMATS if each.read_chunks is not None]
MEGA = 1_000_000


def test_every_reader_is_measured() -> None:
    assert {each.name for each in FORMATS if each.read is not None} <= FILES.keys()


SLOW = {
    "glb": (
        "moved chain",
        "meshes",
        "primitives",
        "one name",
        "unused",
        "unused meshes",
        "empty nodes",
    ),
    "gltf": tuple(FILES["gltf"])[2:],  # the JSON is that of GLB
    "e57": ("many scans",),
    "las": ("equal points", "chunks of one point", "nodes of one point"),
    "npz": ("skipped members", "foreign members", "long names"),
    "ply": ("text elements", "scalar elements", "empty elements"),
    "text": ("six digits", "remarks last", "carriage returns"),
    "obj": ("obj normals", "obj continued", "obj polygon of triples", "obj crs comments"),
}
"""Families that take seconds to make or to read: `python scripts/growth --memory` has them all."""

LARGE = {
    "stl": ("one point", "signed zeros", "soup"),
    "npy": ("bytes of rows", "flags"),
}
"""Families that are read at 25 MB as well: quick, and what is fixed is little beside that."""


def families(kind: str) -> list[str]:
    """Name the families of a format that are quick to make and to read."""
    found = [each for each in FILES[kind] if each not in SLOW.get(kind, ())]
    return [*found, *(LIES if kind == "npz" else ())]


@pytest.mark.parametrize("kind", [each.name for each in FORMATS if each.read is not None])
def test_reading_takes_memory_in_proportion_to_the_file(kind: str) -> None:
    found = measured(kind, families(kind), chunks=False)
    assert len(found) == len(families(kind))
    assert [each.fault for each in found if each.fault] == []


@pytest.mark.parametrize("kind", LARGE)
def test_large_files_take_memory_in_proportion(kind: str) -> None:
    found = measured(kind, [*LARGE[kind]], chunks=False, size=25 * MEGA)
    assert all(each.content > 15 * MEGA for each in found)
    assert [each.fault for each in found if each.fault] == []


@pytest.mark.parametrize("kind", IN_CHUNKS)
def test_reading_in_chunks_takes_no_more(kind: str) -> None:
    counted = subjects()[f"read_chunks {kind}"].counted
    chosen = [each for each in families(kind) if counted is None or each in counted]
    found = measured(kind, chosen, chunks=True)
    assert [each.fault for each in found if each.fault] == []


@pytest.mark.parametrize("kind", IN_CHUNKS)
def test_chunks_of_a_file_do_not_pile_up(kind: str) -> None:
    ordinary = next(iter(FILES[kind]))
    small, large = (
        measured(kind, [ordinary], chunks=True, size=size)[0] for size in (4 * MEGA, 15 * MEGA)
    )
    assert large.content > 3 * small.content
    assert large.grown - small.grown < (large.content - small.content) / 2


def test_what_takes_more_is_noticed() -> None:
    def touch() -> str:  # pages of its own: malloc may have such a block left, which is resident
        block = mmap.mmap(-1, FIXED + 30 * MEGA)
        pages = len(block[:: mmap.PAGESIZE])
        block[:: mmap.PAGESIZE] = b"1" * pages
        return str(len(block))

    fat, outcome = forked(touch, None)
    assert fat > FIXED + 29 * MEGA
    assert "more than" in Held("a", MEGA, fat, "read", "read").fault
    assert outcome == str(FIXED + 30 * MEGA)


def test_what_crashes_is_noticed() -> None:
    _, killed = forked(lambda: str(os.kill(os.getpid(), signal.SIGKILL)), ADDRESSES)
    assert killed == "exit code -9"
    assert "exit code -9" in Held("a", MEGA, 0, "read", killed).fault
    assert Held("a", MEGA, 0, "read", "MemoryError").fault == ""
