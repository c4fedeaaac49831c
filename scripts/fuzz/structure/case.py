"""A generated file: its format, its bytes, and what must be read from it if nothing was changed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from fuzz.structure.parts import Chance, Liar, Part, encoded
from numpy.typing import NDArray

Points = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Case:
    """A file; ``points`` are its rows in the order of `in_order`, None if lies were told.

    ``content`` is the size of what it holds, for a file that is compressed; ``others`` says that
    it holds more than the points, which must be read as well, or named. With ``options`` it is read
    once more, to any end.
    """

    kind: str
    data: bytes
    points: Points | None = None
    content: int = 0
    others: bool = False
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def size(self) -> int:
        """The larger of the sizes of the file and of its content."""
        return max(len(self.data), self.content)


def told(
    kind: str, parts: list[Part], names: Sequence[bytes], points: Points, chance: Chance
) -> Case:
    """Make a file of parts: one in four as it is, the others with some lies."""
    if chance.one_in(4):
        return Case(kind, encoded(parts), in_order(points))
    return Case(kind, encoded(Liar(parts, names, chance).lie(chance.choice((1, 1, 2, 3, 6)))))


def in_order(points: Points) -> Points:
    """Sort rows, so that sets of rows can be compared."""
    return points[np.lexsort(points.T[::-1])] + 0.0


def quarters(chance: Chance, rows: int, columns: int = 3) -> Points:
    """Draw coordinates that every type of number holds exactly if ``whole``, else quarters."""
    values = [[chance.randint(-200, 200) / 4 for _ in range(columns)] for _ in range(rows)]
    return np.array(values, dtype=np.float64).reshape(rows, columns)
