"""The process of a Python peer: ``python -m benchmark.worker PEER THREADS``.

It reads one request a line, words separated by tabs, and answers with one line of JSON.

    try   FILE          triangulate the points of FILE once and keep the result
    save  FOLDER        write the kept triangles (and neighbours) to files, and free them
    time  CALLS FILE    triangulate CALLS times, and return the time of each call

Points are raw doubles, triangles raw 32-bit rows of the points. Only the call is timed. An error
ends the process with a traceback.
"""

from __future__ import annotations

import gc
import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any, TextIO

import numpy as np
from distributions import Points
from process_state import memory

from benchmark.peers import PEERS, Call, Outputs, touch

TINY = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [3.0, 4.0]])


class Worker:
    """A loaded peer, and its last result until it is saved."""

    def __init__(self, name: str, threads: int) -> None:
        self.peer = PEERS[name]
        self.call: Call = self.peer.prepare(threads)
        self.call(TINY)
        self.points: Points = TINY
        self.outputs: Outputs = ()

    def try_out(self, file: str) -> dict[str, Any]:
        """Run once, and measure time and memory."""
        self.points = read(file)
        gc.collect()
        before = memory("VmRSS")
        seconds, self.outputs = self.timed()
        peak = memory("VmHWM")
        return {"seconds": seconds, "beyond": max(0, peak - before), "peak": peak}

    def save(self, folder: str) -> dict[str, Any]:
        triangles, *others = self.peer.rows(self.outputs, self.points)
        triangles.astype(np.int32, copy=False).tofile(Path(folder, "triangles"))
        for neighbors in others:
            neighbors.astype(np.int32, copy=False).tofile(Path(folder, "neighbors"))
        self.points, self.outputs = TINY, ()
        return {"triangles": len(triangles)}

    def time(self, calls: str, file: str) -> dict[str, Any]:
        """Run several times on one newly read array."""
        self.points = read(file)
        gc.collect()
        seconds = [self.timed()[0] for _ in range(int(calls))]
        self.points = TINY
        return {"seconds": seconds}

    def timed(self) -> tuple[float, Outputs]:
        points = self.points
        start = perf_counter()
        outputs = self.call(points)
        touch(outputs)
        return perf_counter() - start, outputs


def read(file: str) -> Points:
    return np.fromfile(file).reshape(-1, 2)


def own_output() -> TextIO:
    """Reserve stdout for the answers; whatever a peer prints goes to stderr."""
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    return answers


def main(name: str, threads: str) -> None:
    answers = own_output()
    worker = Worker(name, int(threads))
    print(json.dumps({"version": worker.peer.version}), file=answers, flush=True)
    verbs: dict[str, Callable[..., dict[str, Any]]] = {
        "try": worker.try_out,
        "save": worker.save,
        "time": worker.time,
    }
    for line in sys.stdin:
        verb, *words = line.rstrip("\n").split("\t")
        print(json.dumps(verbs[verb](*words)), file=answers, flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
