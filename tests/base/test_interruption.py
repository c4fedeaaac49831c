"""Signals while other libraries run: none is lost, and none breaks an import off."""

from __future__ import annotations

import contextlib
import gc
import io
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest
from interrupt.worker import where

import liftmesh
from liftmesh.base import interruption
from liftmesh.base.interruption import defer_signals, preserve_signals
from liftmesh.io import atomic, registry
from liftmesh.io.atomic import working_folder
from liftmesh.tiles.store import save_array

MESH = liftmesh.triangulate(np.random.default_rng(3).random((40, 3)))


class Late(BaseException):
    """What a handler of SIGTERM or SIGALRM raises."""


@contextmanager
def handled(number: int, handler: Any) -> Iterator[None]:
    before = signal.signal(number, handler)
    try:
        yield
    finally:
        signal.signal(number, before)


def late(*_: object) -> None:
    raise Late


def swallowing(number: int = signal.SIGINT) -> None:
    with suppress(BaseException):
        signal.raise_signal(number)


def test_what_is_caught_inside_is_raised_at_the_end() -> None:
    after = []

    def goes_on() -> None:
        swallowing()
        after.append("the end")

    with pytest.raises(KeyboardInterrupt), preserve_signals():
        goes_on()
    assert after


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGALRM])
def test_other_signals_whose_handlers_raise_are_kept_too(number: int) -> None:
    with handled(number, late), pytest.raises(Late), preserve_signals():
        swallowing(number)


def test_what_comes_out_by_itself_is_raised_once() -> None:
    around = sys.exc_info()[1]  # what other tests left, which interrupt generators
    with pytest.raises(KeyboardInterrupt) as caught, preserve_signals():
        signal.raise_signal(signal.SIGINT)
    assert caught.value.__context__ is around


def test_the_signal_wins_over_the_exception_that_it_became() -> None:
    def wrapping() -> None:
        try:
            signal.raise_signal(signal.SIGINT)
        except BaseException as error:
            raise ImportError("not a whole file") from error

    with pytest.raises(KeyboardInterrupt), preserve_signals():
        wrapping()


def test_other_exceptions_pass() -> None:
    with pytest.raises(ZeroDivisionError), preserve_signals():
        _ = 1 // 0


@pytest.mark.parametrize("inner", [preserve_signals, defer_signals])
@pytest.mark.parametrize("outer", [preserve_signals, defer_signals])
def test_guards_within_guards(inner: Callable[[], Any], outer: Callable[[], Any]) -> None:
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt), outer(), suppress(BaseException), inner():
        swallowing()
    assert signal.getsignal(signal.SIGINT) == before


def test_the_first_signal_waits_for_an_import_and_the_second_does_not() -> None:
    steps = []

    def imports() -> None:
        for step in ("one", "two"):
            signal.raise_signal(signal.SIGINT)
            steps.append(step)

    with pytest.raises(KeyboardInterrupt), defer_signals():
        imports()
    assert steps == ["one"]


def test_a_handler_that_does_not_raise_is_called_once() -> None:
    heard: list[int] = []
    for guard in (preserve_signals, defer_signals):
        with handled(signal.SIGINT, lambda number, _: heard.append(number)):
            with guard():
                signal.raise_signal(signal.SIGINT)
            assert heard == [signal.SIGINT]
            heard.clear()


def test_handlers_are_as_before_and_those_set_inside_stay() -> None:
    before = signal.getsignal(signal.SIGINT)
    with handled(signal.SIGTERM, signal.SIG_IGN):
        with preserve_signals():
            assert signal.getsignal(signal.SIGTERM) is signal.SIG_IGN
            assert signal.getsignal(signal.SIGINT) != before
        assert signal.getsignal(signal.SIGINT) is before
    with preserve_signals():
        signal.signal(signal.SIGINT, late)
    assert signal.getsignal(signal.SIGINT) is late
    signal.signal(signal.SIGINT, before)


def test_other_threads_leave_the_handlers_alone() -> None:
    found = []

    def look() -> None:
        with preserve_signals(), defer_signals():
            found.append(signal.getsignal(signal.SIGINT))

    before = signal.getsignal(signal.SIGINT)
    thread = threading.Thread(target=look)
    thread.start()
    thread.join()
    assert found == [before]


SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGALRM)


@pytest.fixture
def all_handled() -> Iterator[list[Any]]:
    """Handlers that raise for all three signals, as a caller may have them."""
    gc.disable()  # what it calls is no line of a guard, and Python drops what is raised there
    try:
        with handled(signal.SIGTERM, late), handled(signal.SIGALRM, late):
            yield handlers()
    finally:
        gc.enable()


def handlers() -> list[Any]:
    return [signal.getsignal(number) for number in SIGNALS]


def lines_of_a_guard(
    guard: Callable[[], Any], at: int, number: int, block: Callable[[], None] = lambda: None
) -> int:
    """Enter and leave a guard; call the handler at one of its lines, as Python does."""
    lines = 0

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        nonlocal lines
        outer: FrameType | None = frame
        while outer is not None and outer.f_code.co_filename != interruption.__file__:
            outer = outer.f_back
        if outer is not None and event in {"call", "line"}:
            lines += 1
            if lines == at:
                sys.settrace(None)
                frame.f_trace = None
                handler = signal.getsignal(number)
                assert callable(handler)
                handler(number, frame)
        return trace

    sys.settrace(trace)
    try:
        with guard():
            block()
    finally:
        sys.settrace(None)
    return lines


@pytest.mark.parametrize("number", SIGNALS)
@pytest.mark.parametrize("guard", [preserve_signals, defer_signals])
def test_a_signal_at_any_line_of_a_guard_is_heard_and_leaves_the_handlers(
    guard: Callable[[], Any], number: int, all_handled: list[Any]
) -> None:
    lines = lines_of_a_guard(guard, 0, number)
    assert lines > 40
    for at in range(1, lines + 1):
        with pytest.raises((KeyboardInterrupt, Late)):
            lines_of_a_guard(guard, at, number)
        assert handlers() == all_handled, at


def test_a_signal_while_an_inner_guard_is_entered_does_not_wait_for_the_outer(
    all_handled: list[Any],
) -> None:
    ended = []

    def inside() -> None:
        ended.append(False)
        with preserve_signals():
            pass
        ended[-1] = True

    lines = lines_of_a_guard(preserve_signals, 0, signal.SIGINT, inside)
    heard_within = 0
    for at in range(1, lines + 1):
        ended.clear()
        with pytest.raises(KeyboardInterrupt):
            lines_of_a_guard(preserve_signals, at, signal.SIGINT, inside)
        heard_within += ended == [False]
        assert handlers() == all_handled, at
    assert heard_within > lines // 3  # about half of the lines are those of the inner guard


def late_within_a_guard(_: int, frame: FrameType | None) -> None:
    while frame is not None:
        if frame.f_code.co_filename == interruption.__file__:
            raise Late
        frame = frame.f_back


def send_bursts(is_over: threading.Event) -> None:
    # To the main thread: another one might get to its signal when the handlers are the old again.
    main = threading.main_thread().ident
    for turn in range(400):
        for number in SIGNALS[: turn % 3 + 1]:
            signal.pthread_kill(main, number)
        is_over.wait(1e-5)
    is_over.set()


def is_heard_within(guard: Callable[[], Any]) -> bool:
    try:
        with guard():
            pass
    except Late:
        return True
    return False


@pytest.mark.slow
@pytest.mark.parametrize("guard", [preserve_signals, defer_signals])
def test_bursts_of_signals_leave_the_handlers(guard: Callable[[], Any]) -> None:
    heard = 0
    with ExitStack() as stack:
        gc.disable()  # Python drops, with a warning, what is raised amid what it calls
        stack.callback(gc.enable)
        for number in SIGNALS:
            stack.enter_context(handled(number, late_within_a_guard))
        is_over = threading.Event()
        thread = threading.Thread(target=send_bursts, args=[is_over])
        thread.start()
        while not is_over.is_set():
            heard += is_heard_within(guard)
        thread.join()
        for number in SIGNALS:
            signal.raise_signal(number)  # a handler that was left behind would go now
        assert handlers() == [late_within_a_guard] * 3
    assert heard


def test_a_handler_that_only_notes_its_signal_is_called_beside_one_that_raises() -> None:
    noted: list[int] = []

    def both() -> None:
        signal.raise_signal(signal.SIGTERM)
        signal.raise_signal(signal.SIGINT)

    handler = handled(signal.SIGTERM, lambda number, _: noted.append(number))
    with handler, pytest.raises(KeyboardInterrupt), defer_signals():
        both()
    assert noted == [signal.SIGTERM]


# --- formats and adapters of others --------------------------------------------------------------


def read_deaf(*_: object) -> liftmesh.Cloud:
    swallowing()
    return liftmesh.Cloud(np.eye(3))


def chunks_deaf_at_once(*_: object) -> Iterator[liftmesh.Cloud]:
    return iter([read_deaf()])


def chunks_deaf_later(*_: object) -> Iterator[liftmesh.Cloud]:
    yield liftmesh.Cloud(np.eye(3))
    yield read_deaf()


def write_deaf(*_: object) -> None:
    swallowing()


WHOLE = liftmesh.Format("whole", (".whole",), read_deaf, write_deaf, "swallows signals")
AT_ONCE = replace(WHOLE, name="at_once", read_chunks=chunks_deaf_at_once)
LATER = replace(WHOLE, name="later", read_chunks=chunks_deaf_later)


@pytest.fixture
def plugin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Install a plugin with these formats."""
    folder = tmp_path / "deaf-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: deaf\nVersion: 1.0\n")
    names = [f"{name} = {__name__}:{name.upper()}\n" for name in ("whole", "at_once", "later")]
    (folder / "entry_points.txt").write_text(f"[liftmesh.formats]\n{''.join(names)}")
    monkeypatch.syspath_prepend(tmp_path)


@pytest.mark.usefixtures("plugin")
@pytest.mark.parametrize("kind", ["whole", "at_once", "later"])
def test_ctrl_c_in_the_chunks_of_a_plugin_is_heard(kind: str) -> None:
    with pytest.raises(KeyboardInterrupt):
        list(liftmesh.read_chunks(io.BytesIO(b"some"), format=kind))


READ_AND_WRITE = {
    "read": lambda: liftmesh.read(io.BytesIO(b"some"), format="whole"),
    "write": lambda: liftmesh.write(io.BytesIO(), np.eye(3), format="whole"),
}


@pytest.mark.usefixtures("plugin")
@pytest.mark.parametrize("what", READ_AND_WRITE)
def test_ctrl_c_in_a_plugin_is_heard(what: str) -> None:
    with pytest.raises(KeyboardInterrupt):
        READ_AND_WRITE[what]()


def test_ctrl_c_between_chunks_reaches_the_caller_where_it_comes() -> None:
    chunks = liftmesh.read_chunks(io.BytesIO(b"0 0 5\n1 0 6\n"), rows=1, format="xyz")
    before = signal.getsignal(signal.SIGINT)
    for _ in chunks:
        assert signal.getsignal(signal.SIGINT) is before


def test_ctrl_c_while_an_adapter_looks_at_an_object_is_heard(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def accepts(_: object) -> bool:
        swallowing()
        return True

    deaf = liftmesh.Adapter("deaf", accepts, lambda _: liftmesh.Cloud(np.eye(3)))
    monkeypatch.setattr(registry, "ADAPTERS", (deaf, *registry.ADAPTERS))
    with pytest.raises(KeyboardInterrupt):
        liftmesh.as_cloud(object())


def test_check_raises_what_was_announced_until_it_is_withdrawn(tmp_path: Path) -> None:
    interruption.announce(Late())
    try:
        with pytest.raises(Late):
            interruption.check()
        with pytest.raises(Late):
            liftmesh.write(tmp_path / "mesh.ply", MESH)
    finally:
        interruption.withdraw()
    interruption.check()
    assert [*tmp_path.iterdir()] == []


def test_the_campaign_names_the_stage_of_the_kernel() -> None:
    def stop(_: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        liftmesh.delaunay(np.random.default_rng(1).random((2000, 2)), progress=stop)
    assert where(caught.tb, 0.5) == "halving, merging (50%)"


def instructions(run: Callable[[], object], at: int = -1) -> int:
    """Raise KeyboardInterrupt at one instruction of the package or of contextlib; count them."""
    files = (str(Path(liftmesh.__file__).parent), contextlib.__file__)
    seen = 0

    def trace(frame: FrameType, event: str, _: Any) -> Any:
        nonlocal seen
        if not frame.f_code.co_filename.startswith(files):
            return None
        frame.f_trace_opcodes = True
        if event == "opcode":
            seen += 1
            if seen == at:
                raise KeyboardInterrupt
        return trace

    sys.settrace(trace)
    try:
        run()
    except KeyboardInterrupt:
        assert at > 0
    finally:
        sys.settrace(None)
    return seen


def open_files() -> int:
    return len([*Path("/proc/self/fd").iterdir()])


@pytest.mark.slow
@pytest.mark.parametrize("nameless", [True, pytest.param(False, marks=pytest.mark.campaign)])
def test_a_signal_at_any_instruction_leaves_no_file_open(
    nameless: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if not nameless:
        monkeypatch.setattr(atomic, "NAMELESS", 0)
    monkeypatch.setattr(sys, "unraisablehook", lambda _: None)  # a generator that is thrown away

    def run() -> None:
        with working_folder(tmp_path, "test"):
            save_array(tmp_path / "a.npy", np.arange(3))

    run()
    gc.freeze()  # what other tests hold need not be looked at each time
    held = open_files()
    total = instructions(run)
    assert total > 500
    for at in range(1, total + 1):
        instructions(run, at)
        if open_files() != held:  # a traceback may hold what was thrown away
            gc.collect()
        assert open_files() == held, at
