"""Fuzz a target for some time in one or several processes, and parse libFuzzer's logs."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from fuzz.targets import SCRIPTS, Target

EXECUTIONS = re.compile(r"^stat::number_of_executed_units: (\d+)", re.MULTILINE)
COVERAGE = re.compile(r"\bcov: (\d+) ft: (\d+) corp: (\d+)")
FIND = re.compile(r"Test unit written to (.+)")
REASON = re.compile(
    r"^(?:FIND: .+|\w*(?:Error|Exception)\b.*|.*runtime error: .+|SUMMARY: .+)$",
    re.MULTILINE,
)


@dataclass(frozen=True)
class Outcome:
    """The result of one fuzzing process, or the sum over several."""

    executions: int
    branches: int  # edges of the control flow graph that were covered
    features: int  # covered edges, counted once for each bucket of hit counts
    corpus: int
    finds: tuple[Path, ...]
    failed: tuple[str, ...]  # last lines of the logs of processes that failed without a find

    @classmethod
    def of(cls, parts: Sequence[Outcome]) -> Outcome:
        """Sum up over processes."""
        return cls(
            sum(part.executions for part in parts),
            max(part.branches for part in parts),
            max(part.features for part in parts),
            max(part.corpus for part in parts),
            tuple(find for part in parts for find in part.finds),
            tuple(text for part in parts for text in part.failed),
        )


def fuzz(target: Target, folder: Path, seconds: int, jobs: int, seed: int) -> Outcome:
    """Run libFuzzer; the corpus, finds and logs are written to ``folder``."""
    corpus, finds = folder / "corpus", folder / "finds"
    for each in (corpus, finds):
        each.mkdir(parents=True, exist_ok=True)
    command = [
        *target.command(),
        *target.options,
        f"-max_total_time={seconds}",
        f"-artifact_prefix={finds}/",
        "-print_final_stats=1",
        "-verbosity=1",
    ]
    places = [str(corpus), str(target.seeds)]
    logs = [folder / f"log-{job}.txt" for job in range(jobs)]
    processes = [
        _started([*command, f"-seed={seed + job}", *places], log) for job, log in enumerate(logs)
    ]
    codes = [process.wait() for process in processes]
    return Outcome.of([_read(log, code) for log, code in zip(logs, codes, strict=True)])


def _started(command: list[str], log: Path) -> subprocess.Popen[bytes]:
    with log.open("wb") as stream:
        return subprocess.Popen(command, cwd=SCRIPTS, stdout=stream, stderr=stream)


def _read(log: Path, code: int) -> Outcome:
    text = log.read_text("utf-8", "replace")
    executions = EXECUTIONS.search(text)
    branches, features, corpus = map(int, (COVERAGE.findall(text) or [(0, 0, 0)])[-1])
    found = tuple(map(Path, FIND.findall(text))) if code else ()
    return Outcome(
        int(executions[1]) if executions else 0,
        branches,
        features,
        corpus,
        found,
        (text[-3000:],) if code and not found else (),
    )


def reason(target: Target, path: Path) -> str | None:
    """Run one file; return None if it passes, else the line that describes the failure."""
    command = [*target.command(), *target.options, str(path)]
    done = subprocess.run(command, cwd=SCRIPTS, capture_output=True, check=False)
    if not done.returncode:
        return None
    said = REASON.search((done.stdout + done.stderr).decode("utf-8", "replace"))
    return said[0] if said else f"exit code {done.returncode}"
