"""Whole files or none, with the permissions of any new file."""

from __future__ import annotations

import io
import os
import stat
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

import numpy as np
import pytest
from file_samples import assert_same_mesh, full_mesh, loaded, saved

import liftmesh
from liftmesh import Cloud, FormatError, InputError
from liftmesh.io.atomic import replacing


def names_in(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def mode_of(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


def test_a_new_file_and_nothing_else(tmp_path: Path) -> None:
    target = tmp_path / "mesh.ply"
    written = liftmesh.write(target, full_mesh())
    assert (written.path, written.format, written.origin) == (target, "ply", None)
    assert written.bytes == target.stat().st_size
    assert names_in(tmp_path) == ["mesh.ply"]
    assert_same_mesh(liftmesh.read(target), full_mesh())


def test_a_path_and_a_stream_get_the_same_bytes(tmp_path: Path) -> None:
    for kind in ("ply", "obj", "npz", "off"):
        liftmesh.write(tmp_path / f"mesh.{kind}", full_mesh())
        assert (tmp_path / f"mesh.{kind}").read_bytes() == saved(full_mesh(), kind)


def test_permissions_are_those_of_any_new_file(tmp_path: Path) -> None:
    for mask in (0o022, 0o077, 0o002):
        before = os.umask(mask)
        try:
            (tmp_path / f"plain{mask}").touch()
            liftmesh.write(tmp_path / f"{mask}.ply", full_mesh())
        finally:
            os.umask(before)
        assert mode_of(tmp_path / f"{mask}.ply") == mode_of(tmp_path / f"plain{mask}")


def test_a_replaced_file_keeps_its_permissions(tmp_path: Path) -> None:
    target = tmp_path / "mesh.ply"
    target.write_bytes(b"old")
    target.chmod(0o640)
    liftmesh.write(target, full_mesh())
    assert mode_of(target) == 0o640
    assert_same_mesh(liftmesh.read(target), full_mesh())


def test_a_link_stays_a_link(tmp_path: Path) -> None:
    (tmp_path / "far").mkdir()
    link = tmp_path / "mesh.ply"
    link.symlink_to(tmp_path / "far" / "real.ply")
    for _ in range(2):
        liftmesh.write(link, full_mesh())
        assert link.is_symlink()
        assert names_in(tmp_path / "far") == ["real.ply"]
    assert names_in(tmp_path) == ["far", "mesh.ply"]
    assert_same_mesh(liftmesh.read(tmp_path / "far" / "real.ply"), full_mesh())


def test_an_error_while_writing_leaves_the_old_file_and_no_debris(tmp_path: Path) -> None:
    target = tmp_path / "mesh.obj"
    target.write_bytes(b"old")
    late = Cloud(np.zeros((2, 3)), colors=np.array([[0.0, 0, 0], [0, 9, 0]]))
    with pytest.raises(InputError, match="row 1"):
        liftmesh.write(target, late)
    assert target.read_bytes() == b"old"
    assert names_in(tmp_path) == ["mesh.obj"]
    with pytest.raises(InputError, match="row 1"):
        liftmesh.write(tmp_path / "new.obj", late)
    assert names_in(tmp_path) == ["mesh.obj"]


@pytest.mark.parametrize("error", [KeyboardInterrupt, MemoryError, OSError])
def test_every_kind_of_interruption(tmp_path: Path, error: type[BaseException]) -> None:
    target = tmp_path / "file"
    target.write_bytes(b"old")

    def interrupted() -> None:
        with replacing(target) as stream:
            stream.write(b"half")
            raise error

    with pytest.raises(error):
        interrupted()
    assert target.read_bytes() == b"old"
    assert names_in(tmp_path) == ["file"]


def test_a_reader_sees_the_old_file_until_the_new_one_is_whole(tmp_path: Path) -> None:
    target = tmp_path / "file"
    target.write_bytes(b"old")
    with replacing(target) as stream:
        stream.write(b"new")
        stream.flush()
        assert target.read_bytes() == b"old"
    assert target.read_bytes() == b"new"


def test_a_full_disk_leaves_nothing(tmp_path: Path) -> None:
    program = f"""
import resource, signal
import numpy as np, liftmesh
from liftmesh import Cloud
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, 100_000))
try:
    liftmesh.write({str(tmp_path / "mesh.ply")!r}, Cloud(np.zeros((100_000, 3))))
except OSError as error:
    print(type(error).__name__)
"""
    found = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert found.stdout == "OSError\n"
    assert names_in(tmp_path) == []


def test_messages_name_the_callers_path(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError, match=r"the folder does not exist: '.*missing'"):
        liftmesh.write(tmp_path / "missing" / "mesh.ply", full_mesh())
    (tmp_path / "folder.ply").mkdir()
    with pytest.raises(FormatError, match=r"folder.ply: this is a folder"):
        liftmesh.write(tmp_path / "folder.ply", full_mesh())
    with pytest.raises(IsADirectoryError, match=r"it is a folder: '.*folder.ply'"):
        liftmesh.write(tmp_path / "folder.ply", full_mesh(), format="ply")
    (tmp_path / "file").write_bytes(b"")
    with pytest.raises(NotADirectoryError, match=r"a file, not a folder: '.*file'"):
        liftmesh.write(tmp_path / "file" / "mesh.ply", full_mesh())


def test_long_names(tmp_path: Path) -> None:
    target = tmp_path / ("n" * 251 + ".ply")
    liftmesh.write(target, full_mesh())
    assert names_in(tmp_path) == [target.name]


READ_ONLY = """
import io, os, sys
import numpy as np
from liftmesh import Cloud, write
folder = sys.argv[1]
write(io.BytesIO(), Cloud(np.zeros((1, 3))), format="ply")  # imports what others may not read
if os.getuid() == 0:
    os.setgid(65534)
    os.setuid(65534)
for path in (folder + "/locked/mesh.ply", folder + "/open/old.ply"):
    try:
        write(path, Cloud(np.zeros((1, 3))))
    except PermissionError as error:
        print(error)
"""


def test_read_only_folders_and_files() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        folder.chmod(0o755)
        for inner, mode in (("locked", 0o555), ("open", 0o777)):
            (folder / inner).mkdir()
            (folder / inner).chmod(mode)
        old = folder / "open" / "old.ply"
        old.write_bytes(b"old")
        old.chmod(0o444)
        command = [sys.executable, "-c", READ_ONLY, name]
        found = subprocess.run(command, capture_output=True, text=True, check=True)
        first, second = found.stdout.splitlines()
        assert "the folder is read-only" in first
        assert first.endswith("locked'")
        assert "cannot replace this file: it is read-only" in second
        assert second.endswith("old.ply'")
        assert old.read_bytes() == b"old"
        assert names_in(folder / "open") == ["old.ply"]
        assert names_in(folder / "locked") == []


@pytest.mark.parametrize("kind", ["ply", "obj", "npz", "glb"])
def test_pipes_are_written_and_read_directly(tmp_path: Path, kind: str) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    mesh = Cloud(np.zeros((3, 3)), faces=np.array([[0, 1, 2]], dtype=np.int32))
    writer = threading.Thread(target=liftmesh.write, args=(pipe, mesh), kwargs={"format": kind})
    writer.start()
    back = liftmesh.read(pipe, format=kind)
    writer.join()
    assert_same_mesh(back, mesh)
    assert stat.S_ISFIFO(pipe.stat().st_mode)


def test_streams_that_cannot_seek() -> None:
    class Sink(io.RawIOBase):
        def __init__(self) -> None:
            self.content = bytearray()

        def writable(self) -> bool:
            return True

        def write(self, data: object) -> int:
            self.content += memoryview(data).tobytes()  # type: ignore[arg-type]
            return len(self.content)

    for kind in ("ply", "obj", "npz"):
        sink = Sink()
        written = liftmesh.write(sink, full_mesh(), format=kind)  # type: ignore[arg-type]
        assert bytes(sink.content) == saved(full_mesh(), kind)
        assert written.bytes == len(sink.content)


def test_a_stream_is_used_from_where_it_stands() -> None:
    for kind in ("ply", "obj", "npz", "glb", "stl", "off"):
        mesh = Cloud(np.zeros((3, 3)), faces=np.array([[0, 1, 2]], dtype=np.int32))
        stream = io.BytesIO(b"before")
        stream.seek(6)
        assert liftmesh.write(stream, mesh, format=kind).bytes == len(stream.getvalue()) - 6
        assert stream.getvalue()[:6] == b"before"
        stream.seek(6)
        assert len(liftmesh.read(stream, format=kind)) == len(loaded(saved(mesh, kind), kind))
