"""A process with a prompt: it does one job as often as it is told to, and says how each time ended.

    python -m interrupt.worker "read PLY" FOLDER

It is told through stdin, a line a time, and answers in lines of JSON.
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

from process_state import State

import liftmesh
from interrupt.jobs import JOBS, Action

PACKAGE = Path(liftmesh.__file__).parent
# What the kernel is at, by the share that it has told last (see `work` in its sources).
STAGES = ((0.2, "ordering"), (0.95, "halving, merging"), (1.0, "emitting"))
KERNEL = "hulls._run"


def main(name: str, folder: str) -> None:
    """Do the job for each line of stdin."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    action = JOBS[name](Path(folder))
    before = State.now()
    tell(ready=True)
    for _ in sys.stdin:
        answer = attempt(action)
        tell(**answer, **asdict(State.settled(before.threads)))


def tell(**values: Any) -> None:
    """Answer in one line."""
    print(json.dumps(values), flush=True)


def attempt(action: Action) -> dict[str, Any]:
    """Do the job once; where it was interrupted, and when the prompt was back."""
    shares = [0.0]
    place = ""
    began = time.monotonic()
    tell(began=began)
    try:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        action(shares.append)
        signal.signal(signal.SIGINT, signal.SIG_IGN)
    except KeyboardInterrupt as error:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        place = where(error.__traceback__, shares[-1])
    ended = time.monotonic()  # all that the exception held is free
    return {"ended": ended, "seconds": ended - began, "place": place}


def where(traceback: TracebackType | None, share: float) -> str:
    """Name the innermost function of liftmesh, and in the kernel the stage."""
    name = "the prompt"
    while traceback is not None:
        code = traceback.tb_frame.f_code
        if PACKAGE in Path(code.co_filename).parents:
            name = f"{Path(code.co_filename).stem}.{code.co_name}"
        traceback = traceback.tb_next
    if name == KERNEL:
        name = next(stage for end, stage in STAGES if share <= end)
    return f"{name} ({share:.0%})" if share else name


if __name__ == "__main__":
    main(*sys.argv[1:])
