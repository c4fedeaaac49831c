"""Signals while trimesh runs, which catches every exception in many places: none is lost."""

from __future__ import annotations

import inspect
import io
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest
import trimesh
from children import output

import liftmesh

MESH = liftmesh.triangulate(np.random.default_rng(3).random((40, 3)))
TRIMESH = str(Path(trimesh.__file__).parent)


def saved(kind: str) -> bytes:
    stream = io.BytesIO()
    liftmesh.write(stream, MESH, format=kind)
    return stream.getvalue()


WITH_TRIMESH: dict[str, Callable[[], object]] = {
    **{f"write {kind}": lambda kind=kind: saved(kind) for kind in ("glb", "gltf")},
    "to_trimesh": MESH.to_trimesh,
    "as_cloud": lambda: liftmesh.as_cloud(trimesh.Scene(trimesh.creation.box())),
}


def calls_of_trimesh(work: Callable[[], object], at: int) -> int:
    """Run some work, and send a signal at a call of a function of trimesh; count the calls."""
    calls = 0

    def profile(frame: FrameType, event: str, _: Any) -> None:
        nonlocal calls
        # A generator is also called where it is thrown away; what it raises there is printed.
        is_plain = not frame.f_code.co_flags & inspect.CO_GENERATOR
        if event == "call" and is_plain and frame.f_code.co_filename.startswith(TRIMESH):
            calls += 1
            if calls == at:
                sys.setprofile(None)
                signal.raise_signal(signal.SIGINT)

    sys.setprofile(profile)
    try:
        work()
    finally:
        sys.setprofile(None)
    return calls


@pytest.mark.parametrize("job", WITH_TRIMESH)
def test_ctrl_c_at_calls_all_over_trimesh_is_heard(job: str) -> None:
    work = WITH_TRIMESH[job]
    work()
    calls = calls_of_trimesh(work, 0)
    assert calls > 3
    for at in np.unique(np.linspace(1, calls, 150).astype(int)):
        with pytest.raises(KeyboardInterrupt):
            calls_of_trimesh(work, int(at))


@pytest.mark.slow
def test_ctrl_c_at_calls_all_over_the_hull_of_a_comparison_is_heard() -> None:
    """trimesh runs in a thread of its own there, and the main thread waits."""
    program = """
    import os, signal, sys, threading
    import numpy as np
    import liftmesh, trimesh

    FOLDER = os.path.dirname(trimesh.__file__)
    mesh = liftmesh.triangulate(np.random.default_rng(3).random((40, 3)))
    liftmesh.compare(mesh)

    def calls(at):
        seen = 0

        def profile(frame, event, _):
            nonlocal seen
            if event == "call" and frame.f_code.co_filename.startswith(FOLDER):
                seen += 1
                if seen == at:
                    sys.setprofile(None)
                    os.kill(os.getpid(), signal.SIGINT)

        threading.setprofile(profile)
        try:
            liftmesh.compare(mesh)
        finally:
            threading.setprofile(None)
        return seen

    total, heard = calls(0), 0
    moments = np.unique(np.linspace(1, total, 30).astype(int))
    for at in moments:
        try:
            calls(int(at))
        except KeyboardInterrupt:
            heard += 1
    print(total > 3, len(moments) - heard)
    for thread in threading.enumerate():
        if thread is not threading.current_thread():
            thread.join()
    """
    assert output(program).split() == ["True", "0"]


@pytest.mark.slow
def test_ctrl_c_amid_the_import_of_trimesh_leaves_no_module_missing() -> None:
    program = """
    import io, os, signal, sys
    import numpy as np
    import liftmesh

    class Signalling:
        seen = 0

        def find_spec(self, name, path=None, target=None):
            if name in {"networkx", "PIL", "trimesh.path.exchange.load"} and not self.seen:
                self.seen = 1
                os.kill(os.getpid(), signal.SIGINT)

    finder = Signalling()
    sys.meta_path.insert(0, finder)
    stream = io.BytesIO()
    for _ in range(2):
        try:
            liftmesh.write(stream, liftmesh.Cloud(np.eye(3)), format="glb")
        except KeyboardInterrupt:
            print("interrupted")
    import trimesh
    print(finder.seen, len(stream.getvalue()) > 100)
    print(type(trimesh.exchange.load.load_path).__name__, type(trimesh.graph.nx).__name__)
    """
    assert output(program).split() == ["interrupted", "1", "True", "function", "module"]
