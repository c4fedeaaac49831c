"""Numbers in JSON: those of files may be text, booleans, or too large for a double."""

from __future__ import annotations

import math

from liftmesh.io.text_tables import shortened


def finite_numbers(values: object, count: int) -> list[float] | None:
    """Convert a list of finite numbers to floats; None if it is anything else."""
    if not isinstance(values, list) or len(values) != count or not all(map(_is_finite, values)):
        return None
    return [float(value) for value in values]


def _is_finite(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer beyond all doubles
        return False


def shown(values: object) -> str:
    """Show a value, or the first of a list, in a message; of nested ones, maybe deep, the type."""
    listed = values[:4] if isinstance(values, list) else [values]
    texts = (type(v).__name__ if isinstance(v, list | dict) else repr(v) for v in listed)
    return ", ".join(map(shortened, texts))
