"""A process that answers requests within a time limit: a line to it, a line of JSON back."""

from __future__ import annotations

import json
import os
import select
import signal
import subprocess
import tempfile
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any

STARTING = 300.0  # time limit in seconds for a process's first answer
ENDING = 300.0  # for a process that has closed its output, to end by itself


class NoAnswerError(Exception):
    """The process gave no answer; the message says why."""


class TimeLimitError(NoAnswerError):
    """The process was killed because its answer took too long."""


class Process:
    """A running worker, which is ended by an error and at the end of a `with` block."""

    def __init__(self, command: list[str], environment: dict[str, str], folder: Path) -> None:
        self.folder = tempfile.TemporaryDirectory()
        self.errors = Path(self.folder.name, "errors")
        with self.errors.open("w") as errors:
            self.child = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
                env=os.environ | environment,
                cwd=folder,
            )
        kill_first_when_out_of_memory(self.child.pid)
        self.greeting = self.answer(STARTING)

    def __enter__(self) -> Process:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def ask(self, *words: object, patience: float) -> dict[str, Any]:
        """Send a request and wait for the answer."""
        if self.child.stdin.closed:
            raise NoAnswerError("gone")
        try:
            print(*words, sep="\t", file=self.child.stdin, flush=True)
        except BrokenPipeError:
            raise NoAnswerError(self.close(ENDING)) from None
        return self.answer(patience)

    def answer(self, patience: float) -> dict[str, Any]:
        """Read one line; kill a process that exceeds the time limit."""
        ready, _, _ = select.select([self.child.stdout], [], [], patience)
        if not ready:
            self.close()
            raise TimeLimitError(f"> {patience:g} s")
        line = self.child.stdout.readline()
        if not line.endswith("\n"):
            raise NoAnswerError(self.close(ENDING))
        return json.loads(line)

    def close(self, patience: float = 0.5) -> str:
        """End the process; return why it had ended, if it had."""
        if self.child.stdin.closed:
            return "gone"
        with suppress(BrokenPipeError):
            self.child.stdin.close()
        try:
            code = self.child.wait(patience)
        except subprocess.TimeoutExpired:
            self.child.kill()
            code = self.child.wait()
        self.child.stdout.close()
        with self.folder:
            return cause(code, self.errors.read_text(errors="replace"))


def cause(code: int, stderr: str) -> str:
    """Describe why a process ended: its signal, or the line of its traceback with the error."""
    if code < 0:
        return f"crash, {signal.Signals(-code).name}"
    lines = stderr.strip().splitlines() or [f"exit code {code}"]
    line = next((line for line in reversed(lines) if "Error" in line), lines[-1])
    return line.replace("ModuleNotFoundError", "not installed")[:100]


def kill_first_when_out_of_memory(pid: int) -> None:
    """Make the system's OOM killer choose the worker before the benchmark."""
    score = Path(f"/proc/{pid}/oom_score_adj")
    if score.exists():
        score.write_text("1000")
