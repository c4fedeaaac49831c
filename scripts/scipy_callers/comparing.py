"""Runs a caller with SciPy's class and with liftmesh's, and compares what it returns.

A caller returns arrays by name. On points in general position the triangulation is unique, so sets
and graphs must be equal, and numbers but for rounding. Both runs must make as many triangulations,
and at least one, or the caller did not come to its call site.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from scipy_callers.placing import KINDS, placed, turned

TOLERANCE = 1e-9
Caller = Callable[[], Mapping[str, Any]]


def differences(caller: Caller, *, by_corner: bool = False) -> list[str]:
    """Run a caller both ways and name what differs.

    With `by_corner`, its results depend on the corner at which a triangle begins: it is made the
    same for both.
    """
    results, counts = {}, {}
    caller()  # imports what it needs, so that all modules that hold the class are loaded
    for name, kind in KINDS.items():
        with placed(turned(kind) if by_corner else kind) as counted:
            results[name] = caller()
        counts[name] = (counted.made, counted.grown)
    ours, theirs = results["liftmesh"], results["SciPy"]
    found = [f"{key}: {fault}" for key in theirs if (fault := unequal(ours[key], theirs[key]))]
    if counts["liftmesh"] != counts["SciPy"] or not counts["SciPy"][0]:
        found.append(f"triangulations made, and grown: {counts}")
    return found


def unequal(ours: Any, theirs: Any) -> str:
    """Say how two results differ; empty if they do not."""
    ours, theirs = np.asarray(ours), np.asarray(theirs)
    if ours.shape != theirs.shape:
        return f"shape {ours.shape}, not {theirs.shape}"
    if theirs.size == 0 or (theirs.dtype.kind == "f" and np.isnan(theirs).all()):
        return "nothing to compare"
    if theirs.dtype.kind != "f":
        return "" if np.array_equal(ours, theirs) else f"{(ours != theirs).sum()} differ"
    scale = np.nanmax(np.abs(theirs))
    if np.allclose(ours, theirs, rtol=0, atol=TOLERANCE * scale, equal_nan=True):
        return ""
    missing = int((np.isnan(ours) != np.isnan(theirs)).sum())
    return f"up to {np.nanmax(np.abs(ours - theirs)):.3g} of {scale:.3g}, {missing} missing in one"


def edges(pairs: Any) -> np.ndarray:
    """Sort pairs, so that two lists of the same pairs are equal."""
    return np.array(sorted({tuple(map(float, pair)) for pair in pairs}))
