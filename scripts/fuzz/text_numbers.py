"""The properties of numbers in text that must hold for any bytes: the kernel against Python.

The first byte chooses delimiter, comments and the number of threads. The rest is a text, whose
lines, tables, numbers and faces are read by the kernel, and by Python's `str.split`, `float` and
`int`, which share no code with it. The rest is also a list of doubles: they are printed as Python
prints them, and the texts of numbers halfway between two doubles, which are the hardest to round,
are read as Python reads them.
"""

from __future__ import annotations

import math
import re
import struct
from collections.abc import Sequence
from decimal import Context, Decimal
from itertools import product

import numpy as np
from fuzz.round_trip import demand
from numpy.typing import NDArray

from liftmesh import _kernel

DELIMITERS = ("", ",", ";", "\t")
COMMENTS: tuple[tuple[str, ...], ...] = ((), ("#",), ("#", "//"))
THREADS = (1, 2)
KEEP_TABS = (False, True)
CHOICES = [*product(DELIMITERS, COMMENTS, THREADS, KEEP_TABS)]
WHITE = "".join(map(chr, (*range(9, 14), *range(28, 33))))

WHOLE = re.compile(r"[+-]?[0-9]+")
CORNER = re.compile(r"([+-]?[0-9]+)(?:/([+-]?[0-9]+)?(?:/([+-]?[0-9]+))?)?")
EXACT = Context(prec=1200, Emin=-99999, Emax=99999)
MOST_DOUBLES = 8

Places = NDArray[np.int64]


def check(data: bytes) -> None:
    """Raise a FindError if a property does not hold."""
    delimiter, comments, threads, keep_tabs = (
        CHOICES[data[0] % len(CHOICES)] if data else CHOICES[0]
    )
    text = bytes(code & 127 for code in data[1:])
    places, lines = check_lines(text, comments, threads, keep_tabs=keep_tabs)
    check_table(text, places, lines, delimiter, threads)
    check_numbers(text, places, lines, threads)
    check_corners(text, places, lines, threads)
    check_keywords(text, places, lines)
    whole = data[1 : 1 + 8 * min((len(data) - 1) // 8, MOST_DOUBLES)] if data else b""
    check_printing(whole)
    for value in struct.unpack(f"<{len(whole) // 8}d", whole):
        check_halfway(value)


def value_of(text: str) -> float | None:
    """Return what a text is as a number; None if it is none."""
    try:
        return None if "_" in text else float(text)
    except ValueError:
        return None


def check_lines(
    text: bytes, comments: tuple[str, ...], threads: int, *, keep_tabs: bool
) -> tuple[Places, list[str]]:
    """Compare the lines that are not empty, and their numbers."""
    every = text.decode("ascii").removesuffix("\n").split("\n") if text else []
    blanks = WHITE.replace("\t", "") if keep_tabs else WHITE
    bare = [line.strip(blanks) for line in every]
    if comments:
        bare = ["" if x.startswith(comments) else x.partition("#")[0].strip(blanks) for x in bare]
    kept = [(number, line) for number, line in enumerate(bare) if line]
    places, numbers, count = _kernel.find_lines(text, comments, keep_tabs, threads)
    found = [text[begin:end].decode("ascii") for begin, end in places.tolist()]
    demand(count == len(every), "lines are not all counted")
    demand([*zip(numbers.tolist(), found, strict=True)] == kept, "other lines are found")
    return places, found


def check_table(
    text: bytes, places: Places, lines: list[str], delimiter: str, threads: int
) -> None:
    """Compare the lines as a table of as many columns as its first line has."""
    if not lines:
        return
    values = [x.replace('"', "").split(delimiter) if delimiter else x.split() for x in lines]
    # `float` alone does not take the control characters 28 to 31 for white space.
    rows = [[value_of(x.strip()) for x in row] for row in values]
    width = _kernel.count_values(lines[0].encode("ascii"), delimiter)
    demand(width == len(rows[0]), "other values are counted")
    table = _kernel.parse_table(text, places, width, delimiter, threads)
    good = all(len(row) == width and None not in row for row in rows)
    demand((table is not None) == good, "another table is accepted")
    if table is not None:
        demand(same_bits(table, np.array(rows, dtype=np.float64)), "a table has other values")


def check_numbers(text: bytes, places: Places, lines: list[str], threads: int) -> None:
    """Compare the lines as numbers, any number of them in each."""
    words = [line.split() for line in lines]
    flat = [word for line in words for word in line]
    parsed = _kernel.parse_numbers(text, places, threads)
    values = [value_of(word) for word in flat]
    demand((parsed is not None) == (None not in values), "other numbers are accepted")
    if parsed is None:
        return
    demand(parsed[0].tolist() == [len(line) for line in words], "other words are counted")
    whole = all(WHOLE.fullmatch(word) and abs(int(word)) < 2**63 - 1 for word in flat)
    expected = np.array(
        [int(word) for word in flat] if whole else values, np.int64 if whole else np.float64
    )
    demand(same_bits(parsed[1], expected), "numbers have other values")


def check_corners(text: bytes, places: Places, lines: list[str], threads: int) -> None:
    """Compare the lines as faces of an OBJ file."""
    words = [line.split() for line in lines]
    corners = [corner_of(word) for line in words for word in line]
    parsed = _kernel.parse_corners(text, places, threads)
    demand((parsed is not None) == (None not in corners), "other corners are accepted")
    if parsed is None:
        return
    counts, vertices, normals = parsed
    named = normals.tolist() if normals is not None else [0] * len(vertices)
    demand(counts.tolist() == [len(line) for line in words], "other corners are counted")
    demand([*zip(vertices.tolist(), named, strict=True)] == corners, "corners have other values")
    demand(normals is None or bool(normals.any()), "normals out of nothing")


def corner_of(word: str) -> tuple[int, int] | None:
    """Return the vertex and the normal of a corner, 0 for none; None if it is no corner."""
    found = CORNER.fullmatch(word)
    if found is None or (found[2] is not None and abs(int(found[2])) >= 2**63 - 1):
        return None
    indices = [int(each) for each in (found[1], found[3]) if each is not None]
    if any(index == 0 or not -(2**31) <= index < 2**31 for index in indices):
        return None
    return (indices[0], indices[1] if len(indices) > 1 else 0)


def check_keywords(text: bytes, places: Places, lines: list[str]) -> None:
    """Compare with which keyword each line begins."""
    keywords = ("v", "vn", "f")
    expected = [
        next((k for k, word in enumerate(keywords) if x.startswith((f"{word} ", f"{word}\t"))), -1)
        for x in lines
    ]
    demand(_kernel.find_keywords(text, places, keywords).tolist() == expected, "another keyword")


def check_printing(data: bytes) -> None:
    """Compare what is printed for the same bytes as values of each type."""
    columns = [np.frombuffer(data, code) for code in ("f8", "f4", "i8", "u8", "i4", "u2", "i1")]
    for values in columns:
        specifier = {"f8": "%r", "f4": "%.9g"}.get(values.dtype.str[1:], "%d")
        expected = "".join(f"<{specifier % value}>\n" for value in values.tolist())
        demand(printed(values) == expected, f"{values.dtype} is printed in another way")
    singles = "".join(f"<{float(str(value))!r}>\n" for value in columns[1])
    demand(printed(columns[1], shortest=True) == singles, "float32 is printed in another way")


def printed(values: NDArray[np.generic], *, shortest: bool = False) -> str:
    """Print one column."""
    return lines_of([values], ["<", ">\n"], shortest=shortest).decode("ascii")


def lines_of(
    columns: Sequence[NDArray[np.generic]],
    around: Sequence[str],
    *,
    shortest: bool = False,
    threads: int = 1,
) -> bytes:
    """Print columns, with text around the values of each row."""
    printer = _kernel.Printer(around, shortest, threads)
    printer.begin(columns)
    return b"".join(printer.finish())


def check_halfway(value: float) -> None:
    """Compare numbers at and beside the middle between a double and the next."""
    after = math.nextafter(value, math.inf)
    if not math.isfinite(value) or math.isinf(after):
        return
    middle = EXACT.divide(EXACT.add(Decimal(value), Decimal(after)), Decimal(2))
    digits = str(middle)
    mantissa, mark, exponent = digits.partition("E")
    point = "" if "." in mantissa else "."
    texts = [digits, mantissa + point + "1" + mark + exponent, mantissa[:-1] + mark + exponent]
    text = "\n".join([*texts, f"{middle:.20e}", f"{value:.17g}", f"+{middle:f}"]).encode("ascii")
    places, _, _ = _kernel.find_lines(text, (), False, 1)
    words = text.decode("ascii").split()
    values = [value_of(word) for word in words]
    table = _kernel.parse_table(text, places, 1, "", 1)
    demand((table is not None) == (None not in values), "a text halfway is accepted or not")
    if table is not None:
        demand(same_bits(table[:, 0], np.array(values)), "a text halfway is rounded otherwise")


def same_bits(a: NDArray[np.generic], b: NDArray[np.generic]) -> bool:
    """Whether two arrays are the same, signs of zeros and of NaNs among them."""
    return a.dtype == b.dtype and a.shape == b.shape and a.tobytes() == b.tobytes()
