"""`liftmesh.cli.main` within a process that goes on: its handlers come and go, signals do not get
lost."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from pathlib import Path
from types import FrameType
from typing import Any

import pytest
from commands import liftmesh as command
from test_signals import ENDS, assert_nothing_was_written, ended, folder, started

from liftmesh.base import interruption
from liftmesh.cli import exit_codes
from liftmesh.cli.signals import Ending

__all__ = ["folder"]


def state() -> tuple[object, ...]:
    here = [signal.getsignal(number) for number in ENDS]
    wakeup = signal.set_wakeup_fd(-1)
    return *here, wakeup, sys.unraisablehook


@pytest.fixture(autouse=True)
def _no_thread_is_left() -> Iterator[None]:
    """See that a test leaves no thread behind; those of others may end meanwhile."""
    before = {*threading.enumerate()}
    yield
    assert {*threading.enumerate()} <= before


def test_main_restores_all_it_changes(folder: Path) -> None:
    before = state()
    assert command("info", "mesh.ply", cwd=folder).returncode == exit_codes.DONE
    assert command("info", "nowhere.ply", cwd=folder).returncode == exit_codes.BAD_INPUT
    assert state() == before


@pytest.mark.parametrize("number", ENDS)
def test_main_ends_at_a_signal_and_can_run_again(
    number: int, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = state()

    def send(*_: object, **__: object) -> None:
        signal.raise_signal(number)

    with monkeypatch.context() as patched:
        patched.setattr("liftmesh.io.read.read", send)
        done = command("triangulate", "mesh.ply", "out.ply", "--overwrite", cwd=folder)
        assert (done.returncode, done.stderr) == ENDS[number]
    assert_nothing_was_written(folder)
    assert state() == before
    done = command("triangulate", "mesh.ply", "out.ply", "--overwrite", cwd=folder)
    assert done.returncode == exit_codes.DONE


def test_main_leaves_a_signal_that_comes_after_its_result_to_its_process(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    before = state()
    real = Ending.stop

    def stop(ending: Ending) -> None:
        signal.raise_signal(signal.SIGINT)
        real(ending)

    monkeypatch.setattr(Ending, "stop", stop)
    with pytest.raises(KeyboardInterrupt):
        command("--version")
    assert state() == before
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


def interrupted_stop(at: int) -> int:
    """Run a command whose `stop` meets Ctrl-C at an instruction; return how many there are."""
    seen = 0

    def look(frame: FrameType, event: str, _: Any) -> Any:
        nonlocal seen
        if frame.f_code is not Ending.stop.__code__:
            return None
        frame.f_trace_opcodes = True
        if event == "opcode":
            seen += 1
            if seen == at:
                sys.settrace(None)
                signal.raise_signal(signal.SIGINT)
        return look

    sys.settrace(look)
    try:
        command("--version")
    finally:
        sys.settrace(None)
    return seen


def test_ctrl_c_amid_the_end_of_main_leaves_no_handler_behind() -> None:
    before = state()
    count = interrupted_stop(0)
    assert count > 30
    for at in range(1, count + 1):
        with pytest.raises(KeyboardInterrupt):
            interrupted_stop(at)
        assert state() == before
        interruption.check()
