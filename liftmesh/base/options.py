"""Options and their checks: those with a fixed set of values, switches, counts, threads, callbacks.

The command line reads the values of options for its help, so nothing here loads NumPy or the
kernel.
"""

from __future__ import annotations

import math
import operator
import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from reprlib import Repr
from typing import Any, Literal, NoReturn, TypeAlias

from liftmesh.base.platform import processors
from liftmesh.errors import InputError, Option

VARIABLE = "LIFTMESH_NUM_THREADS"
MOST_THREADS = 1024

_LONGEST = 64  # characters of a value in a message
_SHORT = 10**15
_NO_REALS = tuple("bcSUmMO")  # NumPy's kinds of all else than real numbers
_REPR = Repr()  # of a list it shows the first few, and looks at no others
_REPR.maxstring = _REPR.maxother = _LONGEST

Algorithm: TypeAlias = Literal["auto", "divide-and-conquer", "lf", "lfres", "lfres-indexed"]
HullAlgorithm: TypeAlias = Literal["auto", "lf"]
NonFinite: TypeAlias = Literal["error", "skip"]
RowOrder: TypeAlias = Literal["engine", "canonical"]
Crossing: TypeAlias = Literal["error", "split"]
Carve: TypeAlias = Literal["outside", "holes"]
PlyEncoding: TypeAlias = Literal["binary", "ascii"]
PlyColors: TypeAlias = Literal["uint8", "exact"]
ObjColors: TypeAlias = Literal["values", "comments", "none"]
CellRow: TypeAlias = Literal["lowest", "highest", "center"]
GroundAlgorithm: TypeAlias = Literal["csf", "tin"]
Voids: TypeAlias = Literal["error", "lowest"]
Up: TypeAlias = Literal["y", "z"]
Unit3MF: TypeAlias = Literal["micron", "millimeter", "centimeter", "inch", "foot", "meter"]
Interpolation: TypeAlias = Literal["linear", "nearest", "laplace", "sibson", "c1"]
Extrapolation: TypeAlias = Literal["nearest", "hull"]
Pinched: TypeAlias = Literal["error", "trim"]
OwnFaces: TypeAlias = Literal["own"]
GraphKind: TypeAlias = Literal[
    "delaunay",
    "gabriel",
    "relative_neighborhood",
    "minimum_spanning_tree",
    "sphere_of_influence",
]
GraphWeights: TypeAlias = Literal["length", "binary"]
Coincident: TypeAlias = Literal["first", "clique"]
RasterQuantity: TypeAlias = Literal["height", "slope", "aspect", "hillshade", "longest-edge"]
ClassChoice: TypeAlias = int | Iterable[int] | Literal["ground", "all"] | None
Returns: TypeAlias = Literal["first", "last", "only"]
ShardFormat: TypeAlias = Literal["npy", "parquet", "ply"]
OnDuplicate: TypeAlias = Literal["first", "last", "lowest", "highest", "mean", "error"]


def exhausted(word: NoReturn) -> NoReturn:
    """Stand where every word of an option was taken: mypy refuses a further one."""
    raise AssertionError(word)  # pragma: no cover - mypy refuses


def refused(
    name: str, value: object, reason: str, *, verb: str = "is", mark: str = ": "
) -> InputError:
    """Make the error of an option with a wrong value; `mark` stands before the reason."""
    message = f"{Option(name)} {verb} {shown(value)}{mark}{reason}"
    return InputError(message, option=name, value=value, reason=reason)


def check_option(name: str, value: object, words: Any) -> None:
    """Raise unless an option has one of its allowed values."""
    known = words.__args__  # what get_args returns, without its checks
    if not isinstance(value, str) or value not in known:
        raise refused(name, value, f"give one of {', '.join(map(repr, known))}")


def as_switch(name: str, value: object) -> bool:
    """Convert an option that is true or false."""
    try:
        return {True: True, False: False}[value]  # type: ignore[index]
    except (KeyError, TypeError, ValueError) as error:  # arrays cannot be looked up
        raise refused(name, value, "give True or False") from error


def as_count(name: str, value: Any, least: int, most: int | None = None) -> int:
    """Convert an option that is a whole number; True does not count as 1."""
    with suppress(TypeError):
        count = least - 1 if isinstance(value, bool) else operator.index(value)
        if least <= count and (most is None or count <= most):
            return count
    bounds = f"{least}" if most is None else f"{least} to {most}"
    raise refused(name, value, f"give a whole number from {bounds}")


def as_number(
    name: str,
    value: Any,
    wanted: str = "a finite number",
    is_wanted: Callable[[float], bool] = math.isfinite,
) -> float:
    """Convert an option that is one number; `wanted` says which are right. True is none."""
    kind = getattr(getattr(value, "dtype", None), "kind", "")  # float() takes any of NumPy's
    number = math.nan
    if kind not in _NO_REALS and not isinstance(value, str | bytes | bytearray | bool):
        with suppress(TypeError, ValueError, OverflowError):
            number = float(value)
    if not is_wanted(number):
        raise refused(name, value, f"give {wanted}")
    return number


def as_positive(name: str, value: Any, wanted: str = "a positive number") -> float:
    """Convert an option that is a positive, finite number."""
    return as_number(name, value, wanted, lambda number: 0 < number < math.inf)


def as_distance(name: str, value: Any, wanted: str = "0 or a positive number") -> float:
    """Convert an option that is a finite number, and not below zero."""
    return as_number(name, value, wanted, lambda number: 0 <= number < math.inf)


def as_threads(threads: int | None, rows: int) -> tuple[int, bool]:
    """Return how many threads a run may use, and whether it shares them with other runs."""
    from liftmesh import _kernel  # noqa: PLC0415 - see above

    if threads is not None:
        return as_count("threads", threads, 1, MOST_THREADS), False
    if rows < 2 * _kernel.ROWS_PER_THREAD:
        return 1, True
    chosen = os.environ.get(VARIABLE)
    return (_threads_of(chosen) if chosen else cores()), True


def _threads_of(text: str) -> int:
    """Read the variable of the environment; messages show its text."""
    with suppress(ValueError):
        if 1 <= int(text) <= MOST_THREADS:
            return int(text)
    return as_count(VARIABLE, text, 1, MOST_THREADS)  # which raises: no text is a number


def cores() -> int:
    """Return how many processors this process may use, of those that threads are started on."""
    return min(processors(), MOST_THREADS)


def check_progress(progress: object) -> None:
    """Raise unless the option ``progress`` is a function or None."""
    if progress is not None and not callable(progress):
        raise refused("progress", progress, "give a function of the fraction done, such as print")


class Part:
    """Progress of a part of a run, told as that of the run; it never falls."""

    def __init__(self, progress: Callable[[float], None], first: float, last: float) -> None:
        self.has_raised = False
        self._progress = progress
        self._first, self._last, self._told = first, last, first

    def __call__(self, done: float) -> None:
        """Tell how much of the part is done."""
        wanted = self._first + done * (self._last - self._first)
        self._told = max(self._told, min(wanted, self._last))
        try:
            self._progress(self._told)
        except BaseException:
            self.has_raised = True
            raise


def part_of(progress: Callable[[float], None] | None, first: float, last: float) -> Part | None:
    """Return a callback for a part of a run; None if nobody listens."""
    return None if progress is None else Part(progress, first, last)


def shown(value: object) -> str:
    """Show a value in a message, in one line that is not too long."""
    text = " ".join(_REPR.repr(value).split())
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST - 3]}..."


def counted(number: int, noun: str) -> str:
    """Return a number with its noun in the singular or the plural."""
    return f"{number:,} {noun}" if number == 1 else f"{number:,} {noun}s"


def as_thousands(count: int) -> str:
    """Show a number, which may be of any size, in a message."""
    if count < _SHORT:
        return f"{count:,}"
    digits = str(count)
    return f"{digits[0]}e+{len(digits) - 1}"


def as_folder(name: str, given: object) -> str:
    """Return the path of a folder that a caller names."""
    if not isinstance(given, str | os.PathLike) or isinstance(os.fspath(given), bytes):
        reason = "give the path of a folder"
        message = f"{Option(name)} is a {type(given).__name__}: {reason}"
        raise InputError(message, option=name, value=given, reason=reason)
    return os.path.expanduser(given)  # noqa: PTH111 - where there is no home, it stays
