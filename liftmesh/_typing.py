"""Array types by what they hold; shapes stand in the docstrings."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[Any]
Floats: TypeAlias = NDArray[np.float64]  # coordinates, heights, normals
Reals: TypeAlias = NDArray[np.floating[Any]]  # float32 or float64, as callers give them
Rows: TypeAlias = NDArray[np.int32]  # rows of the caller's points, and triangles of them
Indices: TypeAlias = NDArray[np.intp]  # places in other arrays, as NumPy's sorts and searches give
Integers: TypeAlias = NDArray[np.int64]
Mask: TypeAlias = NDArray[np.bool_]

ParaboloidVertex: TypeAlias = Literal["origin", "median"] | ArrayLike
Progress: TypeAlias = Callable[[float], None]
