"""Numbers as text: the digits that bring every value back bit for bit.

Doubles are written by Python's ``repr``, the shortest digits that round-trip. Single precision
gets nine significant digits: these bring a float back even where a reader rounds to double first,
which the shortest digits do not guarantee.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import chain
from typing import Any, BinaryIO

from liftmesh._typing import Array

ROWS = 1 << 15


def write_rows(
    stream: BinaryIO, columns: Sequence[Array], *, prefix: str = "", template: str = ""
) -> None:
    """Write one line a row: ``prefix``, then the values of all columns between single spaces.

    Columns are (n,) or (n, k) arrays of float, integers, or ready-made strings (dtype object);
    ``template`` replaces the whole line if it must look otherwise.
    """
    values_apart = " ".join(chain.from_iterable(map(_specifiers, columns)))
    template = template or f"{prefix}{values_apart}\n"
    for start in range(0, len(columns[0]), ROWS):
        flat = [part for each in columns for part in _flat(each[start : start + ROWS])]
        values = tuple(chain.from_iterable(zip(*flat, strict=True)))
        stream.write(((template * len(flat[0])) % values).encode("ascii"))


def _specifiers(column: Array) -> Iterable[str]:
    kind = column.dtype.kind
    single = kind == "f" and column.dtype.itemsize < 8
    specifier = "%.9g" if single else {"f": "%r", "O": "%s"}.get(kind, "%d")
    return [specifier] * (column.shape[1] if column.ndim == 2 else 1)


def _flat(block: Array) -> list[list[Any]]:
    return [block.tolist()] if block.ndim == 1 else [column.tolist() for column in block.T]
