"""Output for people: tables and sentences on stdout, progress and errors on stderr.

On a terminal rich adds colour, and a spinner or a progress bar; a pipe or a file gets the same text
without colour, and no progress. rich respects NO_COLOR and TERM=dumb. It is imported only where it
may have something to add: a pipe is written to directly.
"""

from __future__ import annotations

import json
import math
import os
import re
import sys
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from threading import Event, Thread
from time import monotonic
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TextIO

from liftmesh.base.options import counted

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import Progress, ProgressColumn

FORCED = ("FORCE_COLOR", "TTY_COMPATIBLE", "TTY_INTERACTIVE", "JUPYTER_COLUMNS")
"""Variables by which rich takes what is no terminal for one."""
_PERIOD = 0.1  # seconds between two looks at a file
_MOST_ALIKE, _SHORT = 3, 80  # notes of a kind, and characters of the one that stands for others
_NUMBER = re.compile(r"[0-9][0-9.,]*")
_kinds: defaultdict[str, list[tuple[str, str]]] | None = None
STYLES = {"good": "green", "bad": "bold red", "quiet": "dim", "name": "cyan", "": ""}


@contextmanager
def stage(text: str) -> Iterator[None]:
    """Show a spinner with the current activity and its duration, on a terminal only."""

    def columns(rich: Any) -> tuple[ProgressColumn, ...]:
        return rich.SpinnerColumn(), _text(rich), rich.TimeElapsedColumn()

    with _progress(columns) as progress:
        if progress is not None:
            progress.add_task(printable(text), total=None)
        yield


@contextmanager
def reading(
    text: str,
    done: Callable[[], tuple[int, int] | None],  # bytes that are read, and those of the file
) -> Iterator[None]:
    """Show how far a file is read, how fast, and the time that is left, on a terminal only."""

    def columns(rich: Any) -> tuple[ProgressColumn, ...]:
        bar = rich.BarColumn(), rich.TransferSpeedColumn()
        return _text(rich), *bar, rich.TextColumn("left:"), rich.TimeRemainingColumn()

    with _progress(columns) as progress, _watched(progress, text, done):
        yield


@contextmanager
def writing(
    text: str,
    done: Callable[[], tuple[int, None] | None],  # bytes that are written: nobody knows of how many
) -> Iterator[None]:
    """Show how much of a file is written, how fast, and for how long, on a terminal only."""

    def columns(rich: Any) -> tuple[ProgressColumn, ...]:
        amount = rich.FileSizeColumn(), rich.TransferSpeedColumn()
        return _text(rich), rich.SpinnerColumn(), *amount, rich.TimeElapsedColumn()

    with _progress(columns) as progress, _watched(progress, text, done):
        yield


@contextmanager
def _watched(
    progress: Progress | None, text: str, done: Callable[[], tuple[int, int | None] | None]
) -> Iterator[None]:
    """Look at the bytes of a file, again and again, in a thread."""
    if progress is None:
        yield
        return
    task = progress.add_task(printable(text), total=None)
    ended = Event()

    def watch() -> None:
        while not ended.wait(_PERIOD):
            if found := done():
                progress.update(task, completed=found[0], total=found[1])

    watcher = Thread(target=watch, daemon=True)
    watcher.start()
    try:
        yield
    finally:
        ended.set()
        watcher.join()


@contextmanager
def bar(total: float, rows: int = 0) -> Iterator[Callable[..., None]]:
    """Show a progress bar, on a terminal only, which takes a text and the work since the last."""

    def columns(rich: Any) -> tuple[ProgressColumn, ...]:
        left = rich.TextColumn("left:"), rich.TimeRemainingColumn()
        rate = rich.TextColumn("{task.fields[rate]}")
        return rich.BarColumn(), rich.TimeElapsedColumn(), *left, rate, _text(rich)

    with _progress(columns) as progress:
        if progress is None:
            yield lambda _text, _done, _rows=0: None
            return
        task = progress.add_task("", total=total, rate="")

        def advance(text: str, done: float, rows: int = rows) -> None:
            shown = progress.tasks[0]
            part = (shown.completed + done) / total
            progress.update(
                task,
                advance=done,
                description=text or shown.description,
                rate=rate_text(part * rows / (shown.elapsed or math.inf)),
            )

        yield advance


class Share:
    """A `progress` of the library, which hears what share of the work is done, on a bar."""

    def __init__(self, advance: Callable[..., None], text: str, rows: int = 0) -> None:
        self._advance = advance
        self._text = text
        self._share, self._rows = 0.0, rows

    def begin(self, rows: int) -> None:
        """Hear how many rows there are."""
        self._rows = rows

    def __call__(self, share: float) -> None:
        """Hear how much is done."""
        self._advance(self._text, share - self._share, self._rows)
        self._share = share


@contextmanager
def share_bar(text: str, rows: int = 0) -> Iterator[Share]:
    """Show on a bar how far work is, on a terminal only; of rows, how many are done in a second."""
    with bar(1.0) as advance:
        share = Share(advance, text, rows)
        share(0.0)
        yield share


@contextmanager
def _progress(columns: Callable[[Any], Iterable[ProgressColumn]]) -> Iterator[Progress | None]:
    """Show columns that are made by `rich.progress`; None where stderr is no terminal."""
    console = _console(sys.stderr)
    if console is None:
        yield None
        return
    from rich import progress as rich

    with rich.Progress(
        *columns(rich), console=console, transient=True, get_time=monotonic
    ) as progress:
        yield progress


def _text(rich: Any) -> ProgressColumn:
    column: ProgressColumn = rich.TextColumn("{task.description}", markup=False)
    return column


def rate_text(rows: float) -> str:
    """Format a number of rows in a second with three digits."""
    for unit, size in (("M", 1e6), ("k", 1e3), ("", 1.0)):
        if rows >= size:
            return f"{rows / size:.3g} {unit}/s"
    return ""


def error_line(text: str) -> None:
    """Print an error message as one line on stderr."""
    _message("error: ", STYLES["bad"], text)


def note(text: str) -> None:
    """Print a line on stderr about something that is no error."""
    name, _, said = text.partition(": ")
    alike = [] if _kinds is None else _kinds[_NUMBER.sub("", said)]
    alike.append((name, said))
    if len(alike) <= _MOST_ALIKE:
        _message("note: ", "", text)


@contextmanager
def few_of_a_kind() -> Iterator[None]:
    """Print the first few of the notes on files that differ in numbers alone, count the others."""
    global _kinds  # noqa: PLW0603 - as stderr, there is one
    held: defaultdict[str, list[tuple[str, str]]] = defaultdict(list)
    _kinds = held
    try:
        yield
    finally:
        _kinds = None
    for alike in held.values():
        more = len(alike) - _MOST_ALIKE
        if more > 0:
            name, said = alike[_MOST_ALIKE - 1]
            short = said if len(said) <= _SHORT else said[: _SHORT - 3] + "..."
            note(f"{counted(more, 'more file')}, as {name}: {short}")


def sentence(text: str, style: str = "") -> None:
    """Print a paragraph on stdout, wrapped on a terminal, as one line elsewhere."""
    console = _console(sys.stdout)
    if console is None:
        sys.stdout.write(printable(text) + "\n")
        return
    from rich.text import Text

    console.print(Text(printable(text), style=STYLES[style]))


def item(text: str) -> None:
    """Print one item of a list, with a hanging indent on a terminal."""
    console = _console(sys.stdout)
    if console is None:
        sentence(f"- {text}")
        return
    from rich.table import Table
    from rich.text import Text

    grid = Table.grid(padding=(0, 1))
    grid.add_row(Text("•", style=STYLES["name"]), Text(text, style=STYLES["quiet"]))
    console.print(grid)


def blank() -> None:
    """Print an empty line."""
    sys.stdout.write("\n")


def table(
    rows: Sequence[tuple[str, ...]],
    *,
    header: tuple[str, ...] = (),
    styles: Mapping[str, str] = MappingProxyType({}),
) -> None:
    """Print aligned columns on stdout: names on the left, values on the right."""
    rows = [tuple(map(printable, row)) for row in rows]
    console = _console(sys.stdout)
    if console is None:
        _plain_table([header, *rows] if header else rows)
        return
    from rich.table import Table
    from rich.text import Text

    grid = Table(box=None, show_header=bool(header), pad_edge=False, header_style="bold")
    for k in range(len(rows[0])):
        name = header[k] if header else ""
        numbers = bool(header) and k > 0
        style = STYLES["name"] if k == 0 else ""
        grid.add_column(name, style=style, justify="right" if numbers else "left")
    for row in rows:
        grid.add_row(*(Text(cell) for cell in row), style=STYLES[styles.get(row[0], "")])
    console.print(grid)


def as_json(values: Mapping[str, Any]) -> None:
    """Print values on stdout as one JSON object; NaN and infinity become null."""
    sys.stdout.write(json.dumps(_finite(values), indent=2, allow_nan=False) + "\n")


def _finite(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _finite(each) for key, each in value.items()}
    return [_finite(each) for each in value] if isinstance(value, list | tuple) else value


def printable(text: str) -> str:
    """Escape control characters: text from files must not control the terminal."""
    return "".join(each if each.isprintable() else repr(each)[1:-1] for each in text)


def bytes_text(count: float) -> str:
    """Format a number of bytes with three digits."""
    for unit in ("B", "kB", "MB", "GB"):
        if count < 999.5:
            return f"{count:.3g} {unit}"
        count /= 1000
    return f"{count:,.3g} TB"


def _console(stream: TextIO) -> Console | None:
    """Return rich's view of a stream, if it is a terminal."""
    if not stream.isatty() and not any(os.environ.get(each) for each in FORCED):
        return None
    if find_spec("rich") is None:  # as where liftmesh is installed without the extra cli
        return None
    from rich.console import Console

    console = Console(file=stream, highlight=False)
    return console if console.is_terminal else None


def _message(kind: str, style: str, text: str) -> None:
    """Print one line on stderr after the name of the program."""
    console = _console(sys.stderr)
    if console is None:
        sys.stderr.write(f"liftmesh: {kind}{printable(text)}\n")
        return
    from rich.text import Text

    line = Text.assemble(("liftmesh: ", "bold"), (kind, style), printable(text))
    console.print(line, soft_wrap=True)


def _plain_table(rows: Sequence[tuple[str, ...]]) -> None:
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for name, *values in rows:
        cells = [name.ljust(widths[0])]
        if len(values) == 1:
            cells += values
        else:
            cells += [value.rjust(width) for value, width in zip(values, widths[1:], strict=True)]
        sys.stdout.write("  ".join(cells).rstrip() + "\n")
