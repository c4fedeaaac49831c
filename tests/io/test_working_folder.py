"""Hidden folders to work in: they go when their block, their process or its successor ends."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import given, settings, strategies as st

from liftmesh.io.atomic import LOCK, remove_unfinished, unfinished_folders, working_folder

KILLED = """
import os, signal, sys
from liftmesh.io.atomic import working_folder

with working_folder(sys.argv[1], "test") as folder:
    (folder / "inner").mkdir()
    (folder / "inner" / "data").write_bytes(b"data")
    os.kill(os.getpid(), signal.SIGKILL)
"""
NAMES = st.from_regex(r"(\.liftmesh-)?(test|other)?-?[0-9a-f]{8,17}", fullmatch=True)


def names_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def killed_in(place: Path) -> None:
    command = [sys.executable, "-c", KILLED, str(place)]
    assert subprocess.run(command, check=False).returncode == -9


def test_it_is_there_during_the_block(tmp_path: Path) -> None:
    with working_folder(tmp_path, "test") as folder:
        (folder / "data").write_bytes(b"data")
        assert folder.parent == tmp_path
        assert folder.name.startswith(".liftmesh-test-")
        assert names_in(folder) == ["data", LOCK]
    assert names_in(tmp_path) == []
    assert not unfinished_folders


@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError, OSError])
def test_it_is_removed_after_an_error(tmp_path: Path, error: type[BaseException]) -> None:
    def interrupted() -> None:
        with working_folder(tmp_path, "test") as folder:
            (folder / "data").write_bytes(b"data")
            raise error

    with pytest.raises(error):
        interrupted()
    assert names_in(tmp_path) == []


def test_it_is_removed_if_the_process_is_to_end_at_once(tmp_path: Path) -> None:
    with working_folder(tmp_path, "test") as folder:
        (folder / "data").write_bytes(b"data")
        remove_unfinished()
        assert names_in(tmp_path) == []


def test_what_a_killed_process_leaves_is_removed_by_the_next_one(tmp_path: Path) -> None:
    killed_in(tmp_path)
    (left,) = names_in(tmp_path)
    with working_folder(tmp_path, "other"):
        assert left in names_in(tmp_path)  # of another kind
    with working_folder(tmp_path, "test") as folder:
        assert names_in(tmp_path) == [folder.name]
    assert names_in(tmp_path) == []


def test_a_folder_in_use_stays(tmp_path: Path) -> None:
    with working_folder(tmp_path, "test") as one, working_folder(tmp_path, "test") as other:
        assert names_in(tmp_path) == sorted([one.name, other.name])


@settings(max_examples=30)
@given(names=st.sets(NAMES, max_size=5), is_marked=st.booleans())
def test_folders_of_others_stay(
    tmp_path_factory: pytest.TempPathFactory, names: set[str], is_marked: bool
) -> None:
    place = tmp_path_factory.mktemp("place")
    for name in names:
        (place / name).mkdir()
        if is_marked:
            (place / name / LOCK).touch()
    with working_folder(place, "test"):
        pass
    is_ours = re.compile(r"\.liftmesh-test-[0-9a-f]{16}")
    assert names_in(place) == sorted(
        name for name in names if not (is_marked and is_ours.fullmatch(name))
    )


def test_a_link_to_a_folder_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "place").mkdir()
    killed_in(tmp_path)
    (left,) = (path for path in tmp_path.iterdir() if path.name != "place")
    shutil.move(left, tmp_path / "kept")
    (tmp_path / "place" / left.name).symlink_to(tmp_path / "kept")
    with working_folder(tmp_path / "place", "test"):
        pass
    assert names_in(tmp_path / "kept" / "inner") == ["data"]


def test_a_place_that_is_missing(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError), working_folder(tmp_path / "missing", "test"):
        pass
    assert not unfinished_folders
