"""Names of the files beside a shard."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from liftmesh.tiles import store

NAMES = [
    (store.vertices_name, "tile-00007-vertices.npy"),
    (store.faces_name, "tile-00007-faces.npy"),
    (store.neighbors_name, "tile-00007-neighbors.npy"),
    (store.links_name, "tile-00007-links.npy"),
]


@pytest.mark.parametrize(("name", "expected"), NAMES)
@pytest.mark.parametrize("suffix", ["npy", "parquet", "ply"])
def test_files_beside_a_shard(name: Callable[[str], str], expected: str, suffix: str) -> None:
    assert name(f"tile-00007.{suffix}") == expected
