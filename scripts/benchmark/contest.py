"""Measure one case: a trial of every contestant, then alternating rounds.

Rounds alternate so that drift of the machine affects all contestants alike. The process of a trial
also runs the rounds. Short calls are repeated until a round lasts `BURST` seconds. A slow
contestant takes part in as many rounds as `patience` allows; if that is fewer than two, its trial
is its only round. A contestant that exceeds the time limit is not tried on larger inputs.
"""

from __future__ import annotations

import hashlib
import tempfile
from contextlib import ExitStack
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from distributions import DISTRIBUTIONS
from numpy.typing import NDArray
from oracles.second_opinion import flaw

from benchmark.contestants import Contestant
from benchmark.peers import PEERS
from benchmark.process import NoAnswerError, Process, TimeLimitError
from benchmark.results import Calls, Measurement, Timing, Trial
from benchmark.system_load import SystemLoad

if TYPE_CHECKING:
    from benchmark.cases import Case

SEED = 20
BURST = 0.1  # seconds for which short calls are repeated in a round
SAVING = 600.0  # seconds that writing the triangles may take

Limits = dict[tuple[str, Contestant], tuple[int, float]]


class Judge:
    """Checks the triangles in a folder; the verdict on equal files is remembered."""

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
    """Map an array into memory, which loads only the parts that are read."""
    if not file.stat().st_size:
        return np.empty((0, columns), dtype)
    return np.memmap(file, dtype, "r").reshape(-1, columns)


def run_case(case: Case, limits: Limits) -> Measurement:
    """Measure a case; `limits` remembers which contestants exceeded the time limit."""
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
    """Write the points, the same in every run, to a file for the workers."""
    points = DISTRIBUTIONS[case.distribution](case.size, np.random.default_rng(SEED))
    points.tofile(file)
    return len(points)


def first_run(
    contestant: Contestant, case: Case, judge: Judge, limits: Limits
) -> tuple[Trial, Process | None]:
    """Run the trial in a fresh process; return the process if it can run the rounds."""
    key = (case.distribution, contestant)
    size, patience = limits.get(key, (case.size, 0.0))
    if size < case.size and patience >= case.patience:
        return Trial(trouble=f"> {patience:g} s at {size:,}", cut_off=True), None
    try:
        process = contestant.start()
        trial = try_out(process, contestant, case, judge)
    except TimeLimitError as error:
        limits[key] = (case.size, case.patience)
        return Trial(trouble=str(error), cut_off=True), None
    except NoAnswerError as error:
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
    """Time the contestants in alternating rounds, A B C A B C."""
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
    """Time one round; return nothing if the process failed or exceeded the time limit."""
    try:
        return [tuple(process.ask("time", calls, file, patience=2 * patience)["seconds"])]
    except NoAnswerError:
        return []


def rounds_allowed(case: Case, seconds: float) -> int:
    allowed = min(case.rounds, int(case.patience / seconds))
    return allowed if allowed > 1 or allowed == case.rounds else 0


def calls_in_round(case: Case, seconds: float) -> int:
    """Return how often a call is repeated in a round: as the case says, or for `BURST` seconds."""
    wanted = case.calls or ceil(BURST / seconds)
    return max(1, min(wanted, int(case.patience / case.rounds / seconds)))
