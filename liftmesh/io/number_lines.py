"""Lines of numbers that differ in length, as the faces of text files do.

The lines of a block become one text, in which the words are found by NumPy; the text is parsed as
if all of its lines had the same number of words. So lines of all lengths are as fast as a table,
and a line of a million words takes no more memory than a million lines.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from liftmesh._typing import Array, Floats, Integers
from liftmesh.errors import FormatError
from liftmesh.io.ragged import Ragged
from liftmesh.io.text_tables import raise_for_numbers

if TYPE_CHECKING:
    from liftmesh.io.lines import Block

_BLANKS = bytes(ord(" ") if chr(code).isspace() else code for code in range(256))

_OTHER, _BLANK, _DIGIT, _SIGN = range(4)
_KINDS = np.zeros(256, dtype=np.uint8)
_KINDS[ord(" ")] = _BLANK
_KINDS[[*b"0123456789"]] = _DIGIT
_KINDS[[*b"+-"]] = _SIGN

_WORDS = 32  # words of a line given to the parser of floats

_LARGEST = 2**63 - 1


def ragged_numbers(block: Block, name: str) -> Ragged:
    """Parse lines of numbers: int64 if all are whole numbers written as such, else float64.

    Raises
    ------
    FormatError
        A word is not a number; the message gives line and position.
    """
    text, ends = joined(block)
    begins = words(text)
    values: Array | None = integers(text, len(begins))
    if values is None:
        try:
            values = _floats(text.decode("latin-1"), begins)
        except ValueError as error:
            raise_for_numbers(block, name)
            raise FormatError(f"{name}: line {block.numbers[0]} or later: {error}") from error
    return Ragged(per_line(begins, ends), values)


def joined(block: Block) -> tuple[bytes, Integers]:
    """Join the lines of a block, with blanks as all white space; return where each line ends."""
    lengths = np.fromiter(map(len, block.texts), np.int64, len(block))
    return " ".join(block.texts).encode("latin-1").translate(_BLANKS), np.cumsum(lengths + 1)


def words(text: bytes) -> Integers:
    """Find where the words of a text begin."""
    begins = np.frombuffer(text, np.uint8) != ord(" ")
    begins[1:] &= ~begins[:-1]
    return np.flatnonzero(begins)


def per_line(begins: Integers, ends: Integers) -> Integers:
    """Count the words of each line."""
    counts: Integers = np.diff(np.searchsorted(begins, ends), prepend=0)
    return counts


def integers(text: bytes, count: int) -> NDArray[np.int64] | None:
    """Parse ``count`` whole numbers; None if a word is not one that int64 holds."""
    kinds = _KINDS[np.frombuffer(text, np.uint8)]
    sign = kinds == _SIGN
    begun = not (sign[1:] & (kinds[:-1] != _BLANK)).any()
    followed = not (sign[:-1] & (kinds[1:] != _DIGIT)).any() and not text.endswith((b"+", b"-"))
    if not begun or not followed or (kinds == _OTHER).any():
        return None
    values = np.fromstring(text, dtype=np.int64, sep=" ")
    saturated = len(values) and (values.max() == _LARGEST or values.min() == -_LARGEST - 1)
    return None if saturated or len(values) != count else values


def whole(values: Array, dtype: type[np.integer[Any]]) -> Array:
    """Convert whole numbers to a type of integers.

    Raises
    ------
    ValueError
        A value is not a whole number, or is too large; the message gives it.
    """
    kept = np.iinfo(dtype)
    fits = (values >= kept.min) & (values <= kept.max)
    if values.dtype.kind == "f":
        fits &= values == np.rint(values)
    if not fits.all():
        raise ValueError(f"{values[np.argmin(fits)]} is not an index")
    return values.astype(dtype)


def _floats(text: str, begins: Integers) -> Floats:
    """Parse numbers as lines of equally many words, the last filled up."""
    if not len(begins):
        return np.empty(0)
    cuts = [*begins[::_WORDS].tolist(), len(text)]
    lines = [text[start:stop] for start, stop in pairwise(cuts)]
    lines[-1] += " 0" * (-len(begins) % _WORDS)
    table: Array = np.loadtxt(lines, comments=None, ndmin=2, dtype=float)
    return table.reshape(-1)[: len(begins)]
