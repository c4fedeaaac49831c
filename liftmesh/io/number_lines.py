"""Lines of numbers that differ in length, as the faces of text files do.

The kernel parses the words of all lines of a block into one list. So lines of all lengths are as
fast as a table, and a line of a million words takes no more memory than a million lines.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array
from liftmesh.base.threads import as_threads
from liftmesh.io.ragged import Ragged
from liftmesh.io.text_tables import line_error

if TYPE_CHECKING:
    from liftmesh.io.lines import Block


def ragged_numbers(block: Block, name: str) -> Ragged:
    """Parse lines of numbers: int64 if all are whole numbers written as such, else float64."""
    threads, _ = as_threads(None, len(block))
    parsed = _kernel.parse_numbers(block.plain, block.places, threads)
    if parsed is None:
        raise line_error(block, name)
    return Ragged(*parsed)


def whole(values: Array, dtype: type[np.integer[Any]]) -> Array:
    """Convert whole numbers to a type of integers."""
    kept = np.iinfo(dtype)
    fits = (values >= kept.min) & (values <= kept.max)
    if values.dtype.kind == "f":
        fits &= values == np.rint(values)
    if not fits.all():
        raise ValueError(f"{values[np.argmin(fits)]} is not an index")
    return values.astype(dtype)
