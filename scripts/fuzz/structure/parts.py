"""A file as a list of its smallest parts: counts, names, numbers, separators, blocks of bytes.

A generator builds a file of such parts. Lies are told on the parts: a value becomes an extreme one,
a neighbour or one of another kind, a part is dropped, repeated, exchanged or copied over another, a
run of parts is multiplied, and the file ends after a part. Everything else stays as it was, so
that a reader gets far enough to believe the lie. All draws come from one seeded source.
"""

from __future__ import annotations

import random
import struct
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, TypeVar

Value: TypeAlias = int | float | bytes
T = TypeVar("T")

WHOLE = (0, 1, 2, 3, 4, 7, 127, 128, 255, 256, 32768, 65535, 65536, 2**31 - 1, 2**31, 2**32 - 1,
         2**32, 2**53 + 1, 2**63 - 1, 2**63, 2**64, 10**18, 10**30, 10**400)  # fmt: skip
REAL = (-0.0, 0.5, 1.5, 5e-324, 1e-45, 3.5e38, 1e300, 1.7976931348623157e308, float("inf"),
        float("-inf"), float("nan"))  # fmt: skip
WORDS = (b"", b"-", b"+", b".", b"nan", b"inf", b"-inf", b"1e400", b"1e", b"0x10", b"1_0", b"true",
         b"null", b"\0", b"\xff", b"\xef\xbb\xbf", b"\xc3\xa9", b"\x1b[31m", b" ", b"\t", b"\n",
         b"\r\n", b"\r", b"\\\n", b"#", b"//", b",", b";", b'"', b"1,5", b"a" * 300,
         "\u0663".encode())  # fmt: skip

LARGEST = 1 << 18  # bytes of a file whose parts were multiplied


class Chance(random.Random):
    """A seeded source of decisions."""

    def one_in(self, n: int) -> bool:
        """Decide with a probability of 1/n."""
        return self.randrange(n) == 0

    def some(self, items: Sequence[T]) -> list[T]:
        """Return a subset, in order; each item with a probability of one half."""
        return [item for item in items if self.one_in(2)]

    def whole(self, near: int = 0) -> int:
        """Draw an extreme whole number, or one near the given one."""
        if self.one_in(2):
            return near + self.choice((-2, -1, 1, 2))
        return self.choice(WHOLE) * self.choice((1, 1, 1, -1))

    def real(self) -> float:
        """Draw an extreme real number."""
        return self.choice(REAL) * self.choice((1, -1))


@dataclass(frozen=True, slots=True)
class Part:
    """A value, and its form: a struct format, or "" for text."""

    value: Value
    form: str = ""

    def encode(self) -> bytes:
        """Return the bytes; numbers beyond the range of a binary type wrap around."""
        if isinstance(self.value, bytes):
            return self.value
        if not self.form:
            return repr(self.value).encode()
        if self.form[-1] in "efd":
            return _packed_float(self.form, self.value)
        whole = int(self.value) if abs(self.value) < float("inf") else 0
        size = struct.calcsize(self.form)
        order = "big" if self.form[0] == ">" else "little"
        return (whole % (1 << 8 * size)).to_bytes(size, order)  # type: ignore[arg-type]


def _packed_float(form: str, value: float) -> bytes:
    try:
        return struct.pack(form, value)
    except (OverflowError, struct.error):
        return struct.pack(form, float("inf"))


def encoded(parts: Sequence[Part]) -> bytes:
    """Join parts to a file."""
    return b"".join(part.encode() for part in parts)


def damaged(data: bytes, chance: Chance, forms: Sequence[str]) -> bytes:
    """Replace one to four numbers of a file, at any places."""
    found = bytearray(data)
    for _ in range(chance.randint(1, 4)):
        form = chance.choice(forms)
        value = chance.whole() if form != "<d" else chance.real()
        part = Part(value, form).encode()
        place = chance.randrange(len(found) - len(part))
        found[place : place + len(part)] = part
    return bytes(found)


def words(text: str | bytes) -> list[Part]:
    """Split a line at its blanks into parts, the blanks between them included."""
    line = text.encode() if isinstance(text, str) else text
    return [Part(piece) for word in line.split(b" ") for piece in (word, b" ")][:-1]


class Liar:
    """Tells lies about a list of parts; ``names`` are the words of the format."""

    def __init__(self, parts: list[Part], names: Sequence[bytes], chance: Chance) -> None:
        self._parts = parts
        self._names = names
        self._chance = chance

    def lie(self, times: int) -> list[Part]:
        """Return the changed parts."""
        kinds: list[Callable[[int], None]] = [
            self._number, self._number, self._number, self._word, self._drop, self._repeat,
            self._exchange, self._copy, self._cut, self._drop_run, self._multiply, self._insert,
        ]  # fmt: skip
        for _ in range(times):
            if self._parts:
                self._chance.choice(kinds)(self._place())
        return self._parts

    def _place(self) -> int:
        """Choose a part: as often among the first ones, the header, as among all."""
        first = min(len(self._parts), 60)
        return self._chance.randrange(first if self._chance.one_in(2) else len(self._parts))

    def _number(self, at: int) -> None:
        """Change the next number from a place on."""
        for k in range(at, min(at + 40, len(self._parts))):
            part = self._parts[k]
            value = _as_number(part.value)
            if value is None:
                continue
            whole = isinstance(value, int) or self._chance.one_in(3)
            lie = self._chance.whole(int(value) if abs(value) < 1e9 else 0)
            new: Value = lie if whole and not self._chance.one_in(6) else self._chance.real()
            self._parts[k] = replace(part, value=new)
            return

    def _word(self, at: int) -> None:
        part = self._parts[at]
        if not part.form:
            self._parts[at] = replace(part, value=self._any_word())

    def _insert(self, at: int) -> None:
        self._parts.insert(at, Part(self._any_word()))

    def _any_word(self) -> bytes:
        return self._chance.choice(self._names if self._chance.one_in(2) else WORDS)

    def _drop(self, at: int) -> None:
        del self._parts[at]

    def _drop_run(self, at: int) -> None:
        del self._parts[at : at + self._chance.randint(2, 30)]

    def _repeat(self, at: int) -> None:
        self._parts.insert(self._place(), self._parts[at])

    def _exchange(self, at: int) -> None:
        other = self._place()
        self._parts[at], self._parts[other] = self._parts[other], self._parts[at]

    def _copy(self, at: int) -> None:
        self._parts[at] = replace(self._parts[at], value=self._parts[self._place()].value)

    def _cut(self, at: int) -> None:
        del self._parts[at:]

    def _multiply(self, at: int) -> None:
        """Repeat a run of parts, a few times or as often as fits the largest file."""
        run = self._parts[at : at + self._chance.randint(1, 30)]
        room = LARGEST // (len(encoded(run)) + 8 * len(run))
        times = room if self._chance.one_in(20) else self._chance.randint(1, 5)
        self._parts[at:at] = run * min(times, LARGEST // len(run))


def _as_number(value: Value) -> int | float | None:
    if not isinstance(value, bytes):
        return value
    try:
        return int(value[:300])
    except ValueError:
        return None
