"""The end of `liftmesh.cli.main` itself, interrupted at each of its instructions."""

from __future__ import annotations

import signal
import sys
from types import FrameType
from typing import Any

import pytest
from commands import handlers, liftmesh as command

from liftmesh.base import interruption
from liftmesh.cli.signals import Ending


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
    before = handlers()
    count = interrupted_stop(0)
    assert count > 30
    for at in range(1, count + 1):
        with pytest.raises(KeyboardInterrupt):
            interrupted_stop(at)
        assert handlers() == before
        interruption.check()
