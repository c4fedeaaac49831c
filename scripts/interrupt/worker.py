"""A process with a prompt, which runs one job on request and reports how each run ended.

    python -m interrupt.worker "read PLY" FOLDER

A line on stdin requests a run; the answers are lines of JSON on stdout.
"""

from __future__ import annotations

import json
import signal
import sys
import time
from dataclasses import asdict
from pathlib import Path
from types import TracebackType
from typing import Any

from interrupt.jobs import action_of
from jobs import Action
from process_state import State

import liftmesh

PACKAGE = Path(liftmesh.__file__).parent
# The kernel's stage, by the last share of progress that it reported (see `work` in its sources).
STAGES = ((0.2, "ordering"), (0.95, "halving, merging"), (1.0, "compacting"))
KERNEL = ("delaunay.solve", "delaunay.solution_of", "regular.solve")


def main(name: str, folder: str) -> None:
    """Run the job once for each line of stdin."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    action = action_of(name, Path(folder))
    before = State.now()
    answer(ready=True)
    for _ in sys.stdin:
        outcome = attempt(action)
        answer(**outcome, **asdict(State.settled(before.threads)))


def answer(**values: Any) -> None:
    """Print an answer as one line."""
    print(json.dumps(values), flush=True)


def attempt(action: Action) -> dict[str, Any]:
    """Run the job once; report where it was interrupted, and when the prompt was back."""
    shares = [0.0]
    place = ""
    began = time.monotonic()
    answer(began=began)
    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        action(shares.append)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    except KeyboardInterrupt as error:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        place = where(error.__traceback__, shares[-1])
    ended = time.monotonic()  # the exception's references are released by now
    return {
        "ended": ended,
        "seconds": ended - began,
        "place": place,
        "computed": time.process_time(),
    }


def where(traceback: TracebackType | None, share: float) -> str:
    """Name the innermost function of liftmesh, or the stage of the kernel."""
    name = "the prompt"
    while traceback is not None:
        code = traceback.tb_frame.f_code
        if PACKAGE in Path(code.co_filename).parents:
            name = f"{Path(code.co_filename).stem}.{code.co_name}"
        traceback = traceback.tb_next
    if name in KERNEL:
        name = next(stage for end, stage in STAGES if share <= end)
    return f"{name} ({share:.0%})" if share else name


if __name__ == "__main__":
    main(*sys.argv[1:])
