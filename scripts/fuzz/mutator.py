"""Mutate a text file by whole lines and words.

Random changes of bytes mostly break the header, so that the code behind it is seldom reached. So
every other mutation works on lines: it repeats, drops or swaps lines, inserts one from the
dictionary, replaces a word, or replaces a number by a neighbouring one or by a limit of its type.
"""

from __future__ import annotations

import random
import re
from pathlib import Path

NUMBER = re.compile(rb"-?\d+(?:\.\d+)?")
EDGES = (b"0", b"1", b"2", b"3", b"255", b"256", b"65536", b"2147483648", b"1e400", b"nan", b"-0.0")
DICTIONARIES = Path(__file__).parent / "dictionaries"


def vocabulary(kind: str) -> list[bytes]:
    """Return the words of a target's dictionary, without line ends."""
    text = (DICTIONARIES / f"{kind}.dict").read_text("ascii")
    quoted = re.findall(r'^"(.*)"$', text, flags=re.MULTILINE)
    words = [word.encode("ascii").decode("unicode_escape").encode("latin-1") for word in quoted]
    return [word.strip(b"\r\n") for word in words if word.strip(b"\r\n")]


class LineMutator:
    """Makes one to three changes to a file; the same seed makes the same changes."""

    def __init__(self, data: bytes, words: list[bytes], random_: random.Random) -> None:
        self._lines = data.split(b"\n")
        self._words = words
        self._random = random_

    def mutate(self) -> bytes:
        """Return the changed file."""
        changes = (self._repeat, self._drop, self._swap, self._insert, self._word, self._number)
        for _ in range(self._random.randint(1, 3)):
            self._random.choice(changes)(self._random.randrange(len(self._lines)))
        return b"\n".join(self._lines)

    def _repeat(self, at: int) -> None:
        self._lines.insert(self._random.randint(0, len(self._lines)), self._lines[at])

    def _drop(self, at: int) -> None:
        if len(self._lines) > 1:
            del self._lines[at]

    def _swap(self, at: int) -> None:
        other = self._random.randrange(len(self._lines))
        self._lines[at], self._lines[other] = self._lines[other], self._lines[at]

    def _insert(self, at: int) -> None:
        self._lines.insert(at, self._random.choice(self._words))

    def _word(self, at: int) -> None:
        parts = self._lines[at].split(b" ")
        parts[self._random.randrange(len(parts))] = self._random.choice(self._words).strip()
        self._lines[at] = b" ".join(parts)

    def _number(self, at: int) -> None:
        line = self._lines[at]
        found = [*NUMBER.finditer(line)]
        if not found:
            return
        number = self._random.choice(found)
        near = str(int(float(number[0][:15])) + self._random.choice((-1, 1))).encode()
        value = near if self._random.random() < 0.5 else self._random.choice(EDGES)
        self._lines[at] = line[: number.start()] + value + line[number.end() :]
