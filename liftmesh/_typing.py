"""Array types by content; shapes are given in the docstrings."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[Any]
Floats: TypeAlias = NDArray[np.float64]  # coordinates, heights, normals
Reals: TypeAlias = NDArray[np.floating[Any]]  # float32 or float64, as the caller passed them
Rows: TypeAlias = NDArray[np.int32]  # row numbers of the caller's points, and triangles of these
Indices: TypeAlias = NDArray[np.intp]  # indices into arrays, as NumPy's sorts and searches return
Integers: TypeAlias = NDArray[np.int64]
Mask: TypeAlias = NDArray[np.bool_]

Apex: TypeAlias = Literal["median", "origin"] | ArrayLike
Progress: TypeAlias = Callable[[float], None]
