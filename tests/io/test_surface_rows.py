"""Which rows of files a surface takes: of lidar the ground, of all files or of none."""

from __future__ import annotations

import pytest

from liftmesh.errors import InputError
from liftmesh.io.read import check_grounds, for_surface, read_for_surface

WITH = {"ground": 1, "selected": 5}
WITHOUT = {"ground": 0, "selected": 9}


def test_only_lidar_has_a_choice_of_its_own() -> None:
    assert for_surface("cloud.ply", {}) == {}
    assert for_surface("tile.laz", {}) == {"classes": "ground", "withheld": False}
    assert for_surface("tile.laz", {"classes": "all"}) == {"classes": "all", "withheld": False}
    assert for_surface("tile.bin", {}, "las") == {"classes": "ground", "withheld": False}


def test_all_files_have_ground_or_none() -> None:
    check_grounds([("a.laz", WITH), ("b.laz", {"ground": 0, "selected": 0})])
    check_grounds([("a.laz", WITHOUT), ("b.laz", WITHOUT), ("c.ply", {"selected": 3})])
    with pytest.raises(InputError, match=r"^b\.laz: no ground \(class 2\), while other files"):
        check_grounds([("a.laz", WITH), ("b.laz", WITHOUT)])
    with pytest.raises(InputError, match=r"^0, 1, 2 and 4 more: no ground"):
        check_grounds([("a.laz", WITH), *((f"{k}", WITHOUT) for k in range(7))])


def test_all_rows_of_an_object_count() -> None:
    assert len(read_for_surface([[0, 0, 5], [1, 0, 6]])) == 2
    with pytest.raises(InputError, match="classes= is for files"):
        read_for_surface([[0, 0, 5], [1, 0, 6]], classes=2)
