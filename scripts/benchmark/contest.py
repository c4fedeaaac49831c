"""One case: a trial of every contestant, then alternating rounds, so that drift hits all alike.

The process of a trial stays for the rounds. Short calls are repeated within a round until it lasts
a while. A slow contestant sits out rounds: it takes as many as patience allows, and where that is
not even two its trial is its only round. What took too long is not tried on larger inputs.
"""

from __future__ import annotations

import hashlib
import sys
import tempfile
from contextlib import ExitStack
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from distributions import DISTRIBUTIONS
from numpy.typing import NDArray

from benchmark.contestants import SCRIPTS, Contestant
from benchmark.peers import PEERS
from benchmark.process import Process, TooLongError, TroubleError
from benchmark.results import Calls, Measurement, Timing, Trial
from benchmark.system_load import SystemLoad

sys.path.append(str(SCRIPTS.parent / "tests"))  # for the check of triangles

from second_opinion import flaw

if TYPE_CHECKING:
    from benchmark.cases import Case

SEED = 20
BURST = 0.1  # seconds for which short calls are repeated in a round
SAVING = 600.0  # seconds that writing the triangles may take

Limits = dict[tuple[str, Contestant], tuple[int, float]]


class Judge:
    """Checks the triangles in a folder; bytes that were checked before are not checked again."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.verdicts: dict[bytes, str] = {}

    def verdict(self) -> str:
        files = [self.folder / name for name in ("triangles", "neighbors")]
        files = [file for file in files if file.exists()]
        digest = b"".join(digest_of(file) for file in files)
        if digest not in self.verdicts:
            points = mapped(self.folder / "points", np.float64, 2)
            arrays = [mapped(file, np.int32, 3) for file in files]
            self.verdicts[digest] = flaw(points, *arrays)
        for file in files:
            file.unlink()
        return self.verdicts[digest]


def digest_of(file: Path) -> bytes:
    digest = hashlib.blake2b()
    with file.open("rb") as stream:
        while piece := stream.read(1 << 24):
            digest.update(piece)
    return digest.digest()


def mapped(file: Path, dtype: type, columns: int) -> NDArray[Any]:
    """Leave an array in its file, so that only what is looked at takes memory."""
    if not file.stat().st_size:
        return np.empty((0, columns), dtype)
    return np.memmap(file, dtype, "r").reshape(-1, columns)


def run_case(case: Case, limits: Limits) -> Measurement:
    """Measure a case; `limits` remembers what took too long."""
    load = SystemLoad()
    with tempfile.TemporaryDirectory() as name, ExitStack() as stack:
        folder = Path(name)
        rows = write_points(case, folder / "points")
        judge = Judge(folder)
        trials: dict[Contestant, Trial] = {}
        running: dict[Contestant, Process] = {}
        for contestant in case.contestants():
            trial, process = first_run(contestant, case, judge, limits)
            trials[contestant] = trial
            if process:
                running[contestant] = stack.enter_context(process)
        rounds = run_rounds(case, trials, running, folder / "points")
    timings = {who: Timing(trial, tuple(rounds.get(who, ()))) for who, trial in trials.items()}
    others = load.processors()
    return Measurement(case.distribution, case.size, rows, timings, others)


def write_points(case: Case, file: Path) -> int:
    """Make the points, the same ones in every run, and leave them to the workers."""
    points = DISTRIBUTIONS[case.distribution](case.size, np.random.default_rng(SEED))
    points.tofile(file)
    return len(points)


def first_run(
    contestant: Contestant, case: Case, judge: Judge, limits: Limits
) -> tuple[Trial, Process | None]:
    """Run once in a fresh process and check; the process is given back if it is of use."""
    key = (case.distribution, contestant)
    size, patience = limits.get(key, (case.size, 0.0))
    if size < case.size and patience >= case.patience:
        return Trial(trouble=f"> {patience:g} s at {size:,}", cut_off=True), None
    try:
        process = contestant.start()
        trial = try_out(process, contestant, case, judge)
    except TooLongError as error:
        limits[key] = (case.size, case.patience)
        return Trial(trouble=str(error), cut_off=True), None
    except TroubleError as error:
        return Trial(trouble=str(error)), None
    return trial, process


def try_out(process: Process, contestant: Contestant, case: Case, judge: Judge) -> Trial:
    run = process.ask("try", judge.folder / "points", patience=case.patience)
    if not PEERS[contestant.peer].triangulates:
        return Trial(**run, **process.greeting)
    saved = process.ask("save", judge.folder, patience=SAVING)
    return Trial(**run, **saved, **process.greeting, flaw=judge.verdict())


def run_rounds(
    case: Case, trials: dict[Contestant, Trial], running: dict[Contestant, Process], file: Path
) -> dict[Contestant, list[Calls]]:
    """Time all in turns, A B C A B C."""
    allowed = {who: rounds_allowed(case, trials[who].seconds) for who in running}
    rounds: dict[Contestant, list[Calls]] = {
        who: [] if allowed[who] else [(trials[who].seconds,)] for who in running
    }
    for done in range(case.rounds):
        for who, process in running.items():
            if done < allowed[who]:
                calls = calls_in_round(case, trials[who].seconds)
                rounds[who] += one_round(process, calls, file, case.patience)
    return rounds


def one_round(process: Process, calls: int, file: Path, patience: float) -> list[Calls]:
    """Ask for one round; nothing comes back from a process that failed or took too long."""
    try:
        return [tuple(process.ask("time", calls, file, patience=2 * patience)["seconds"])]
    except TroubleError:
        return []


def rounds_allowed(case: Case, seconds: float) -> int:
    allowed = min(case.rounds, int(case.patience / seconds))
    return allowed if allowed > 1 or allowed == case.rounds else 0


def calls_in_round(case: Case, seconds: float) -> int:
    """Repeat short calls: as often as the case says, or for a while."""
    wanted = case.calls or ceil(BURST / seconds)
    return max(1, min(wanted, int(case.patience / case.rounds / seconds)))
