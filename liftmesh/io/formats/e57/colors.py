"""The depth of colours of E57, which each scan states: its limits are what its scanner can produce.

Scans of 8 and 16 bits may stand in one file. Where a scan states no limits, a type of 8 bits says
it; else, and where a colour is beyond the limits, the values decide, of all such scans together.
Limits of other numbers of bits, such as 1023, are scaled as well; what is no such number is taken
for 8 or 16 bits.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array

if TYPE_CHECKING:
    from liftmesh.io.formats.e57.decoding import Scan

_EIGHT, _SIXTEEN = 255, 65535
_KEYS = ("colorRedMaximum", "colorGreenMaximum", "colorBlueMaximum")
_FIELD = "colorRed"


def at_one_depth(colors: Array, scans: list[Scan], counts: list[int]) -> tuple[int | None, str]:
    """Scale the colours of scans to the depth of the deepest, in place."""
    parts = np.split(colors, np.cumsum(counts)[:-1]) if counts else []
    largest = [int(each.max(initial=0)) for each in parts]
    stated = [_stated(each) for each in scans]
    over = [k for k, top in enumerate(stated) if top is not None and largest[k] > top]
    tops = [None if k in over else top for k, top in enumerate(stated)]
    if not any(tops):
        return None, _note(scans, over)
    judged = max((high for high, top in zip(largest, tops, strict=True) if top is None), default=0)
    unsaid = _EIGHT if judged <= _EIGHT else _SIXTEEN
    full = _EIGHT if max(top or unsaid for top in tops) == _EIGHT else _SIXTEEN
    for part, top in zip(parts, tops, strict=True):
        if (own := top or unsaid) != full:
            part[:] = (part.astype(np.uint32) * full + own // 2) // own
    return full.bit_length(), _note(scans, over)


def _stated(scan: Scan) -> int | None:
    """Return the largest colour that a scan can have; None if it does not say it."""
    most = _EIGHT if scan.fields.get(_FIELD) == "u1" else _SIXTEEN
    said = [scan.limits.get(key, math.nan) for key in _KEYS]
    if not all(1 <= each <= _SIXTEEN for each in said):
        return None if most == _SIXTEEN else _EIGHT
    top = max(_EIGHT, min(int(max(said)), most))
    return top if not top & (top + 1) else _SIXTEEN


def _note(scans: list[Scan], over: list[int]) -> str:
    names = ", ".join(repr(scans[k].name) for k in over[:3])
    return f"colours beyond the limits that scans state: {names}" if over else ""
