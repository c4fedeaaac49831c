"""Time limits: what the handler of a signal raises comes out of reading and writing, wherever it
strikes, even an OSError that the code it strikes expects."""

from __future__ import annotations

import gc
import io
import signal
import sys
import zipfile
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest

import liftmesh
from liftmesh.io import registry

MESH = liftmesh.triangulate(np.random.default_rng(0).random((40, 3)))
PLACES = 24


def saved(kind: str) -> bytes:
    stream = io.BytesIO()
    if kind == "npy":
        np.save(stream, MESH.vertices)
    elif kind == "text":
        np.savetxt(stream, MESH.vertices)
    else:
        liftmesh.write(stream, MESH, format=kind)
    return stream.getvalue()


def reading(kind: str) -> Callable[[], object]:
    data = saved(kind)
    return lambda: liftmesh.read(io.BytesIO(data), format=kind)


def in_chunks(kind: str) -> Callable[[], object]:
    data = saved(kind)
    return lambda: [*liftmesh.read_chunks(io.BytesIO(data), format=kind, rows=7)]


def writing(kind: str) -> Callable[[], object]:
    return lambda: liftmesh.write(io.BytesIO(), MESH, format=kind)


JOBS = {
    **{f"read {kind}": partial(reading, kind) for kind in ("ply", "obj", "off", "stl", "glb")},
    **{f"read {kind}": partial(reading, kind) for kind in ("npy", "npz", "text")},
    **{f"chunks {kind}": partial(in_chunks, kind) for kind in ("npy", "npz")},
    **{f"write {kind}": partial(writing, kind) for kind in ("ply", "npz")},
}


@pytest.fixture
def limited(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A time limit whose handler raises an OSError; Python prints what strikes amid a __del__."""

    def strike(*_: object) -> None:
        raise TimeoutError("too late")

    monkeypatch.setattr(sys, "unraisablehook", lambda _: None)
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGALRM)}
    signal.signal(signal.SIGALRM, strike)
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


class Striking:
    """Sends SIGALRM at one of the instructions of a call, in whatever module."""

    def __init__(self, at: int = -1) -> None:
        self.at = at
        self.seen = 0

    def __call__(self, frame: FrameType, event: str, _: Any) -> Striking:
        frame.f_trace_opcodes = True
        if event == "opcode":
            self.seen += 1
            if self.seen == self.at:
                sys.settrace(None)
                signal.raise_signal(signal.SIGALRM)
        return self


def traced(job: Callable[[], object], at: int = -1) -> int:
    """Run a job, struck at an instruction; return the number of its instructions."""
    striking = Striking(at)
    sys.settrace(striking)
    try:
        job()
    finally:
        sys.settrace(None)
    return striking.seen


@pytest.mark.usefixtures("limited")
@pytest.mark.parametrize("name", JOBS)
def test_a_time_limit_comes_out_wherever_it_strikes(name: str) -> None:
    job = JOBS[name]()
    job()
    for at in np.linspace(1, traced(job) - 40, PLACES).astype(int):
        with pytest.raises(TimeoutError, match="too late"):
            traced(job, int(at))


@pytest.mark.parametrize("name", ["read npz", "write npz"])
def test_ctrl_c_is_heard_while_an_archive_is_thrown_away(
    name: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    job = JOBS[name]()
    printed: list[object] = []
    gc.collect()  # archives of other tests
    monkeypatch.setattr(sys, "unraisablehook", printed.append)  # what Python does about it
    monkeypatch.setattr(
        zipfile.ZipFile, "__del__", lambda _: signal.raise_signal(signal.SIGINT), raising=False
    )
    with pytest.raises(KeyboardInterrupt):
        job()
    assert len(printed) == 1


PLUGIN = """
import signal, liftmesh
signal.raise_signal(signal.SIGALRM)

class Thing:
    pass

FORMAT = liftmesh.Format("slow", (".slow",), lambda *_: None, None, "slow to load")
ADAPTER = liftmesh.Adapter("slow", lambda given: isinstance(given, Thing),
                           lambda _: liftmesh.as_cloud([[0.0, 0.0, 0.0]]))
"""
ENTRIES = (
    "[liftmesh.formats]\nslow = slow_plugin:FORMAT\n[liftmesh.adapters]\nslow = slow_plugin:ADAPTER"
)
LOADING: dict[str, Callable[[], object]] = {
    "list": registry.known_formats,
    "find": lambda: registry.find_format("slow", "a.slow"),
    "adapt": lambda: liftmesh.as_cloud(object()),
}


@pytest.fixture
def plugin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    folder = tmp_path / "slow-1.0.dist-info"
    folder.mkdir()
    (folder / "METADATA").write_text("Metadata-Version: 2.1\nName: slow\nVersion: 1.0\n")
    (folder / "entry_points.txt").write_text(ENTRIES)
    (tmp_path / "slow_plugin.py").write_text(PLUGIN)
    monkeypatch.syspath_prepend(tmp_path)
    registry._installed_adapters.cache_clear()
    yield
    registry._installed_adapters.cache_clear()
    sys.modules.pop("slow_plugin", None)


@pytest.mark.usefixtures("plugin", "limited")
@pytest.mark.parametrize("how", LOADING)
def test_a_time_limit_while_a_plugin_is_loaded_is_no_fault_of_the_plugin(how: str) -> None:
    with pytest.raises(TimeoutError):
        LOADING[how]()
    thing = sys.modules["slow_plugin"].Thing()
    assert len(liftmesh.as_cloud(thing)) == 1
    assert registry.find_format("slow", "a.slow").description == "slow to load"
