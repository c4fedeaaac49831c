"""A system without locks of POSIX, descriptors of folders, forks, alarms, or pipes to wait for.

What Windows lacks is taken away before liftmesh is imported, and what it has instead is put there:
`_winapi` and `msvcrt`, by what POSIX has. As there, a file that is open or mapped can be neither
removed nor renamed, nor replaced, unless it was opened so that it can.
"""

from __future__ import annotations

import errno
import fcntl
import os
import subprocess
import sys
from pathlib import Path

import pytest
from commands import TERRAIN

from liftmesh.base import platform

WINDOWS = """
import os, sys
os.supports_dir_fd.clear()
import fcntl, multiprocessing.connection, pathlib, select, shutil, signal, stat, subprocess, types
for module, names in {
    os: "register_at_fork pread preadv pwrite fchmod sched_getaffinity set_blocking pipe link fork "
        "O_TMPFILE O_PATH O_NOFOLLOW O_NONBLOCK",
    signal: "SIGALRM setitimer alarm",
}.items():
    for name in names.split():
        delattr(module, name)
hidden = ("fcntl", "resource", "termios", "pwd", "grp")
sys.modules.update(dict.fromkeys(hidden))

def without_folders(function):
    def called(*words, **options):
        folders = ("dir_fd", "src_dir_fd", "dst_dir_fd")
        assert all(options.pop(each, None) is None for each in folders)
        return function(*words, **options)
    return called

shared, opened = set(), []

def in_use(path):
    real, held = os.path.realpath(path), os.listdir("/proc/self/fd")
    with open("/proc/self/maps") as lines:
        yield any(line.rstrip().endswith(" " + real) for line in lines)
    for each in held:
        try:
            yield int(each) not in shared and os.readlink("/proc/self/fd/" + each) == real
        except FileNotFoundError:
            pass

def unless_in_use(function):
    def called(path, *words, **options):
        if any(in_use(path)) or any(map(in_use_at_all, words)):
            raise PermissionError(13, "used by another process", path)
        return function(path, *words, **options)
    return called

def in_use_at_all(path):
    return os.path.exists(path) and any(in_use(path))

def close(descriptor, posix_close=os.close):
    shared.discard(descriptor)
    posix_close(descriptor)

os.close = close
for name in ("open", "unlink", "remove", "replace", "rename", "stat"):
    setattr(os, name, without_folders(getattr(os, name)))
    if name not in ("open", "stat"):
        setattr(os, name, unless_in_use(getattr(os, name)))

posix_open, posix_select = os.open, select.select

def create_file(path, access, sharing, security, way, attributes, template):
    if os.path.isdir(path) or "closed" in path:
        raise PermissionError(13, "Permission denied")
    assert (sharing, security, attributes, template) == (7, 0, 0x80, 0)
    kind = {0x80000000: os.O_RDONLY, 0x40000000: os.O_WRONLY, 0xC0000000: os.O_RDWR}[access]
    how = {1: os.O_CREAT | os.O_EXCL, 3: 0, 4: os.O_CREAT}[way]
    opened.append(os.path.basename(path))
    descriptor = posix_open(path, kind | how, 0o666)
    shared.add(descriptor)
    return descriptor

def locking(descriptor, mode, count):
    try:
        fcntl.lockf(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB, count, 0, 1)
    except OSError as error:
        raise PermissionError(13, "locked") from error

def select_sockets(*lists):
    for each in (file for files in lists[:3] for file in files):
        if not stat.S_ISSOCK(os.fstat(each if isinstance(each, int) else each.fileno()).st_mode):
            raise OSError(10038, "not a socket")
    return posix_select(*lists)

select.select = select_sockets
sys.modules["_winapi"] = types.SimpleNamespace(CreateFile=create_file)
sys.modules["msvcrt"] = types.SimpleNamespace(
    LK_NBLCK=2, locking=locking, open_osfhandle=lambda handle, flags: handle
)
import liftmesh as lm
from liftmesh.base import platform
"""
LIBRARY = """
terrain = sys.argv[1]
surface = lm.triangulate(lm.read(terrain, every=50))
assert lm.delaunay(surface.vertices[:, :2]).verify().valid
suffixes = ("ply", "npz", "csv")
for suffix in suffixes:
    for _ in range(2):  # a new file, and one over another
        lm.write(f"mesh.{suffix}", surface)
        assert lm.read(f"mesh.{suffix}").faces is not None or suffix == "csv"
assert any(name.startswith(".liftmesh-") for name in opened)
try:
    lm.write("nowhere/mesh.ply", surface)
except FileNotFoundError as error:
    assert str(error.filename).endswith("nowhere")
os.mkdir("closed")
try:
    lm.write("closed/mesh.ply", surface)
except PermissionError as error:
    assert str(error.filename).endswith(os.path.join("closed", "mesh.ply")), error
os.rmdir("closed")  # without a temporary file
with open("open", "wb") as file:
    for action in (os.unlink, lambda name: os.rename("mesh.ply", name)):
        try:
            action("open")
            raise SystemExit("this system lets go of files that are open")
        except PermissionError:
            pass
os.unlink("open")
rows = surface.vertices[:, :2]
for _ in range(2):
    lm.tile(rows, "tiles", tile_rows=1000)
assert len(lm.open_tiled("tiles").to_array()) == len(surface.faces)
sys.argv[1:] = ["contour", "mesh.ply", "lines.geojson", "--interval", "100"]
from liftmesh.cli import program
assert program() == 0
assert {*os.listdir()} == {"lines.geojson", "tiles", *(f"mesh.{each}" for each in suffixes)}
"""
SIGNALS = """
reader, writer = platform.signal_pipe()
signal.signal(signal.SIGTERM, lambda *_: None)
signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
assert not platform.may_read(reader, 0) and platform.may_write(2, 0.1)
os.kill(os.getpid(), signal.SIGTERM)
assert platform.may_read(reader, 60) and reader.read(1) == bytes([signal.SIGTERM])
assert platform.SIGNALS == (signal.SIGINT, signal.SIGTERM) and platform.processors() >= 1
signal.set_wakeup_fd(-1)
"""
LOCKS = """
with open(sys.argv[1], "r+b") as file:
    try:
        platform.lock(file.fileno())
        print("taken", file.tell())
    except BlockingIOError:
        print("held", file.tell())
"""


def on_windows(code: str, folder: Path, *words: object) -> str:
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", WINDOWS + code, *map(str, words)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.stderr, done.returncode) == ("", 0)
    return done.stdout


@pytest.mark.slow
def test_reading_writing_and_commands_without_what_windows_lacks(tmp_path: Path) -> None:
    on_windows(LIBRARY, tmp_path, TERRAIN)


def test_signals_are_told_by_sockets(tmp_path: Path) -> None:
    on_windows(SIGNALS, tmp_path)


def test_a_lock_is_of_a_byte_that_nobody_reads(tmp_path: Path) -> None:
    path = tmp_path / "lock"
    path.write_bytes(b"holder")
    assert on_windows(LOCKS, tmp_path, path) == "taken 0\n"
    with path.open("r+b") as file:
        fcntl.lockf(file, fcntl.LOCK_EX, 1, 1 << 30)
        assert on_windows(LOCKS, tmp_path, path) == "held 0\n"


def test_what_cannot_be_locked_is_said_and_other_errors_are_raised(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with (tmp_path / "file").open("wb") as file:
        assert platform.lock(file.fileno())

        def refuse(*_: object) -> None:
            raise OSError(number, os.strerror(number))

        monkeypatch.setattr(fcntl, "flock", refuse)
        number = errno.ENOLCK
        assert not platform.lock(file.fileno())
        number = errno.EIO
        with pytest.raises(OSError, match=os.strerror(errno.EIO)):
            platform.lock(file.fileno())
