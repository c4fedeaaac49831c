"""SIGINT and SIGTERM end a command, whatever runs at the moment and whatever catches them."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from commands import COMMAND, PLAIN, computed, handlers, liftmesh as command

import liftmesh
from liftmesh.base import interruption
from liftmesh.cli import exit_codes, signals
from liftmesh.cli.signals import Ending

ENDS = {
    signal.SIGINT: (exit_codes.INTERRUPTED, "liftmesh: error: interrupted\n"),
    signal.SIGTERM: (exit_codes.TERMINATED, "liftmesh: error: terminated by SIGTERM\n"),
}
# Runs the command line as a process, after a change of some function of it.
PROGRAM = """
import hashlib, os, signal, sys, time

def send(number):
    os.kill(os.getpid(), number)

def swallowed():
    try:
        send(NUMBER)
    except BaseException:
        pass

def deaf(*_, **__):
    print("deaf", flush=True)
    hashlib.pbkdf2_hmac("sha256", b"", b"", 2**31 - 1)  # for minutes, and without the interpreter

from liftmesh.cli import program, signals
"""
END = "\nsys.exit(program())\n"


def started(change: str, *words: object, cwd: Path, number: int = 0) -> subprocess.Popen[str]:
    text = PROGRAM.replace("NUMBER", str(int(number))) + change + END
    return subprocess.Popen(
        [sys.executable, "-c", text, *map(str, words)],
        cwd=cwd,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=PLAIN,
    )


def ended(child: subprocess.Popen[str]) -> tuple[int, str, str]:
    try:
        out, err = child.communicate(timeout=300)
    finally:
        child.kill()
    return child.returncode, out, err


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    mesh = liftmesh.triangulate(np.random.default_rng(0).random((50, 3)))
    for name in ("mesh.glb", "mesh.stl", "mesh.ply"):
        liftmesh.write(tmp_path / name, mesh)
    (tmp_path / "out.ply").write_bytes(b"old")
    (tmp_path / "out.glb").write_bytes(b"old")
    return tmp_path


def wait_until_deaf(child: subprocess.Popen[str]) -> None:
    """Wait for the line in front of the call that hears nothing, and until the call computes."""
    assert child.stdout is not None
    assert child.stdout.readline() == "deaf\n"
    end = computed(child) + 0.1  # so many seconds of the processor are not between the two
    while computed(child) < end:
        time.sleep(0.005)


def wait_until_delivered(child: subprocess.Popen[str]) -> None:
    """Wait until no signal waits for the process any more."""
    status = Path(f"/proc/{child.pid}/status")
    while not re.search(r"^SigPnd:\s*0+\nShdPnd:\s*0+$", status.read_text(), re.MULTILINE):
        time.sleep(0.005)


def assert_nothing_was_written(folder: Path) -> None:
    names = {"mesh.glb", "mesh.stl", "mesh.ply", "out.ply", "out.glb"}
    assert {path.name for path in folder.iterdir()} == names
    assert (folder / "out.ply").read_bytes() == b"old"
    assert (folder / "out.glb").read_bytes() == b"old"


# Commands, and modules whose import trimesh tries, and goes on without if it fails.
TRIED = [
    ("compare mesh.stl", "trimesh.path.exchange.load"),
    ("triangulate mesh.ply out.glb --overwrite", "networkx"),
    ("triangulate mesh.ply - --output-format glb", "networkx"),
]
AMID_AN_IMPORT = """
class Sending:
    def find_spec(self, name, path=None, target=None):
        if name == {module!r}:
            sys.meta_path.remove(self)
            send({number})

sys.meta_path.insert(0, Sending())
"""


@pytest.mark.slow
@pytest.mark.parametrize(("words", "module"), TRIED)
def test_no_signal_is_lost_amid_the_imports_of_trimesh(
    words: str, module: str, folder: Path
) -> None:
    number = signal.SIGINT if words.startswith("compare") else signal.SIGTERM
    change = AMID_AN_IMPORT.format(module=module, number=int(number))
    child = started(change, *words.split(), cwd=folder)
    assert ended(child) == (ENDS[number][0], "", ENDS[number][1])
    assert_nothing_was_written(folder)


# Where a signal comes and is caught: the command goes on, and has nothing to show for it.
SWALLOWED = {
    "in a writer": """
from liftmesh.io import write
real = write._write
write._write = lambda *a: (swallowed(), real(*a))[1]
""",
    "after the writing": """
from liftmesh.io import atomic
real = atomic._keep_permissions
atomic._keep_permissions = lambda *a: (real(*a), swallowed())[0]
""",
    "before the replacement": """
from liftmesh.io import atomic
real = atomic._give_name
atomic._give_name = lambda *a: (real(*a), swallowed())[0]
""",
    "in a report": """
import liftmesh.io.read
real = liftmesh.io.read.read
liftmesh.io.read.read = lambda *a, **k: (swallowed(), real(*a, **k))[1]
""",
    "where nobody can catch it": """
from liftmesh.io import write
real = write._write

class Dying:
    def __del__(self):
        send(NUMBER)

write._write = lambda *a: (Dying(), real(*a))[1]
""",
}


@pytest.mark.parametrize("where", SWALLOWED)
def test_nothing_is_put_in_place_after_a_signal_that_was_caught(where: str, folder: Path) -> None:
    number = signal.SIGINT if "writ" in where else signal.SIGTERM
    change = SWALLOWED[where].replace("NUMBER", str(int(number)))
    child = started(
        change, "triangulate", "mesh.ply", "out.ply", "--overwrite", cwd=folder, number=number
    )
    assert ended(child) == (ENDS[number][0], "", ENDS[number][1])
    assert_nothing_was_written(folder)


def test_nothing_goes_to_stdout_after_a_signal_that_was_caught(folder: Path) -> None:
    words = ("triangulate", "mesh.ply", "-", "--output-format", "obj")
    child = started(SWALLOWED["in a report"], *words, cwd=folder, number=signal.SIGTERM)
    assert ended(child) == (ENDS[signal.SIGTERM][0], "", ENDS[signal.SIGTERM][1])


DEAF = """
import liftmesh.io.read
liftmesh.io.read.read = deaf
"""


@pytest.mark.slow
@pytest.mark.parametrize("number", ENDS)
def test_a_signal_is_heard_within_a_second_while_compiled_code_runs(
    number: int, folder: Path
) -> None:
    child = started(DEAF, "triangulate", "mesh.ply", "out.ply", "--overwrite", cwd=folder)
    wait_until_deaf(child)
    child.send_signal(number)
    assert ended(child) == (ENDS[number][0], "", ENDS[number][1])
    assert signals.GRACE < 0.5  # what is left of the second is for a busy machine
    assert_nothing_was_written(folder)


def test_a_second_signal_ends_at_once(folder: Path) -> None:
    child = started(DEAF + "signals.GRACE = 3600\n", "info", "mesh.ply", cwd=folder)
    wait_until_deaf(child)
    child.send_signal(signal.SIGTERM)
    wait_until_delivered(child)  # two that wait at once come in the order of their numbers
    assert child.poll() is None
    child.send_signal(signal.SIGINT)
    assert ended(child) == (ENDS[signal.SIGTERM][0], "", ENDS[signal.SIGTERM][1])


def test_the_line_is_whole_although_a_second_signal_comes_while_it_is_printed(
    folder: Path,
) -> None:
    change = """
from liftmesh.cli import signals
real = signals._write_now

def slow(line):
    send(signal.SIGTERM)
    time.sleep(0.1)
    real(line)

signals._write_now = slow
import liftmesh.io.read
liftmesh.io.read.read = lambda *_, **__: send(signal.SIGINT)
"""
    child = started(change, "info", "mesh.ply", cwd=folder)
    assert ended(child) == (ENDS[signal.SIGINT][0], "", ENDS[signal.SIGINT][1])


@pytest.mark.slow
def test_line_and_exit_code_agree_where_two_signals_come_together(folder: Path) -> None:
    change = """
import liftmesh.io.read

def both(*_, **__):
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGTERM})
    send(signal.SIGINT)
    send(signal.SIGTERM)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT, signal.SIGTERM})

liftmesh.io.read.read = both
"""
    for _ in range(5):
        code, out, err = ended(started(change, "info", "mesh.ply", cwd=folder))
        assert ((code, err), out) in [(each, "") for each in ENDS.values()]


@pytest.mark.slow
def test_the_watchdog_removes_a_temporary_file_that_has_a_name(folder: Path) -> None:
    change = """
from liftmesh.io import atomic, write
atomic.NAMELESS = 0
write._write = deaf
"""
    child = started(change, "triangulate", "mesh.ply", "out.ply", "--overwrite", cwd=folder)
    wait_until_deaf(child)
    assert any(path.name.startswith(".liftmesh-") for path in folder.iterdir())
    child.send_signal(signal.SIGTERM)
    assert ended(child) == (ENDS[signal.SIGTERM][0], "", ENDS[signal.SIGTERM][1])
    assert_nothing_was_written(folder)


@pytest.mark.slow
@pytest.mark.parametrize("number", ENDS)
def test_the_watchdog_removes_the_folder_of_a_raster_of_tiles(number: int, tmp_path: Path) -> None:
    points = np.random.default_rng(0).random((200, 3))
    liftmesh.tile_surface(points, tmp_path / "tiles")
    change = """
import rasterio.shutil
rasterio.shutil.copy = deaf
"""
    words = ("raster", "tiles", "out.tif", "--resolution", "0.1", "--cog")
    child = started(change, *words, cwd=tmp_path)
    wait_until_deaf(child)
    (hidden,) = tmp_path.glob(".liftmesh-raster-*")
    assert (hidden / "raster.tif").is_file()
    child.send_signal(number)
    assert ended(child) == (ENDS[number][0], "", ENDS[number][1])
    assert [path.name for path in tmp_path.iterdir()] == ["tiles"]


@pytest.mark.slow
def test_workers_leave_no_second_line(tmp_path: Path) -> None:
    np.save(tmp_path / "cloud.npy", np.random.default_rng(0).random((200, 2)))
    change = """
import liftmesh.dask
liftmesh.dask.delaunay = deaf
"""
    child = started(change, "tile", "cloud.npy", "out", "--workers", "1", cwd=tmp_path)
    wait_until_deaf(child)
    child.send_signal(signal.SIGTERM)
    assert ended(child) == (ENDS[signal.SIGTERM][0], "", ENDS[signal.SIGTERM][1])
    assert [path.name for path in tmp_path.iterdir()] == ["cloud.npy"]


@pytest.mark.slow
def test_a_full_pipe_of_errors_does_not_hold_up_the_end(folder: Path) -> None:
    change = DEAF + "os.write(2, bytes(65536))\n"
    child = started(change, "info", "mesh.ply", cwd=folder)
    wait_until_deaf(child)
    child.send_signal(signal.SIGTERM)
    assert child.wait(timeout=300) == exit_codes.TERMINATED
    child.communicate()


AT_EXIT = """
import atexit
atexit.register(send, {0})
atexit.register(send, {1})
"""


@pytest.mark.parametrize("words", [["info", "mesh.ply"], ["verify", "mesh.glb"], ["--version"]])
def test_a_signal_after_the_result_does_not_change_it(words: list[str], folder: Path) -> None:
    child = started(AT_EXIT.format(signal.SIGINT, signal.SIGTERM), *words, cwd=folder)
    code, out, err = ended(child)
    assert (code, err) == (exit_codes.DONE, "")
    assert out


QHULL_RUNS_ON = """
import threading
import numpy as np
from liftmesh.comparison import hull

real = hull.interruptible

def sorts_for_ever():
    ids = np.random.default_rng(0).integers(0, 10**6, 400_000)
    while True:
        np.unique(ids)

def begun(work):
    threading.Timer(0.3, send, [{number}]).start()
    return real(sorts_for_ever)

hull.interruptible = begun
"""


@pytest.mark.slow
@pytest.mark.parametrize("number", ENDS)
def test_compare_ends_in_order_although_qhull_runs_on(number: int, folder: Path) -> None:
    change = QHULL_RUNS_ON.format(number=int(number))
    child = started(change, "compare", "mesh.ply", cwd=folder)
    assert ended(child) == (ENDS[number][0], "", ENDS[number][1])


@pytest.mark.parametrize("ignored", ["INT", "TERM"])
def test_a_signal_that_is_ignored_stays_ignored(ignored: str, folder: Path) -> None:
    number = signal.Signals[f"SIG{ignored}"]
    words = [*COMMAND, "triangulate", "mesh.glb", "out.ply", "--overwrite"]
    child = subprocess.Popen(
        ["sh", "-c", f'trap "" {ignored}; echo ready; exec "$@"', "sh", *words],
        cwd=folder,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=PLAIN,
    )
    assert child.stdout is not None
    assert child.stdout.readline() == "ready\n"
    while child.poll() is None:
        child.send_signal(number)
        time.sleep(0.02)
    code, out, err = ended(child)
    assert (code, err) == (exit_codes.DONE, "")
    assert "triangles" in out
    assert len(liftmesh.read(folder / "out.ply")) == 50


def test_the_help_says_that_an_ignored_signal_stays_ignored() -> None:
    assert "nohup" in " ".join(command("--help").stdout.split())


# `liftmesh.cli.main` within a process that goes on: its handlers come and go.


@pytest.fixture(autouse=True)
def _no_thread_is_left() -> Iterator[None]:
    """See that a test leaves no thread behind; those of others may end meanwhile."""
    before = {*threading.enumerate()}
    yield
    assert {*threading.enumerate()} <= before


def test_main_restores_all_it_changes(folder: Path) -> None:
    before = handlers()
    assert command("info", "mesh.ply", cwd=folder).returncode == exit_codes.DONE
    assert command("info", "nowhere.ply", cwd=folder).returncode == exit_codes.BAD_INPUT
    assert handlers() == before


@pytest.mark.parametrize("number", ENDS)
def test_main_ends_at_a_signal_and_can_run_again(
    number: int, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = handlers()

    def send(*_: object, **__: object) -> None:
        signal.raise_signal(number)

    with monkeypatch.context() as patched:
        patched.setattr("liftmesh.io.read.read", send)
        done = command("triangulate", "mesh.ply", "out.ply", "--overwrite", cwd=folder)
        assert (done.returncode, done.stderr) == ENDS[number]
    assert_nothing_was_written(folder)
    assert handlers() == before
    done = command("triangulate", "mesh.ply", "out.ply", "--overwrite", cwd=folder)
    assert done.returncode == exit_codes.DONE


def test_main_leaves_a_signal_that_comes_after_its_result_to_its_process(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before = handlers()
    real = Ending.stop

    def stop(ending: Ending) -> None:
        signal.raise_signal(signal.SIGINT)
        real(ending)

    monkeypatch.setattr(Ending, "stop", stop)
    with pytest.raises(KeyboardInterrupt):
        command("--version")
    assert handlers() == before
    interruption.check()


def test_main_leaves_the_handlers_of_its_process_alone(folder: Path) -> None:
    heard: list[int] = []
    before = signal.signal(signal.SIGTERM, lambda number, _: heard.append(number))
    try:
        handler = signal.getsignal(signal.SIGTERM)
        assert command("info", "mesh.ply", cwd=folder).returncode == exit_codes.DONE
        assert signal.getsignal(signal.SIGTERM) is handler
    finally:
        signal.signal(signal.SIGTERM, before)


def test_main_runs_in_another_thread(folder: Path) -> None:
    codes: list[int] = []
    thread = threading.Thread(
        target=lambda: codes.append(command("info", "mesh.glb", cwd=folder).returncode)
    )
    thread.start()
    thread.join()
    assert codes == [exit_codes.DONE]


def test_a_fork_does_not_report_its_signals_to_its_parent(folder: Path) -> None:
    change = """
import liftmesh.io.read
real = liftmesh.io.read.read

def forking(*a, **k):
    child = os.fork()
    if not child:
        signal.signal(signal.SIGTERM, lambda *_: None)
        send(signal.SIGTERM)
        os._exit(0)
    os.waitpid(child, 0)
    time.sleep(signals.GRACE + 0.3)
    return real(*a, **k)

liftmesh.io.read.read = forking
"""
    code, out, err = ended(started(change, "info", "mesh.ply", cwd=folder))
    assert (code, err) == (exit_codes.DONE, "")
    assert out
