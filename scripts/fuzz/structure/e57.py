"""E57, written by libE57; numbers in it are others, and the checksums of its pages are right."""

from __future__ import annotations

from files.e57 import Scan, e57, with_checksums
from fuzz.structure.case import Case, in_order, quarters
from fuzz.structure.parts import Chance, Part

_PLACES = ("cartesianX", "cartesianY", "cartesianZ")
_DIGITS = b"0123456789-e."
EXPANDED = 4 << 20
"""What the points of a damaged file may take."""


def scans(chance: Chance) -> Case:
    """Make a file of one scan or several; in three of four some of its numbers are others."""
    points = quarters(chance, chance.randint(1, 30))
    columns = dict(zip(_PLACES, points.T, strict=True))
    scaled = dict.fromkeys(chance.some(_PLACES), (0.25, 0.0))
    data = e57(Scan(columns, scaled=scaled))
    if chance.one_in(4):
        return Case("e57", data, in_order(points))
    damaged = bytearray(data)
    digits = [k for k, byte in enumerate(data) if byte in _DIGITS]
    for _ in range(chance.randint(1, 4)):
        if chance.one_in(2):
            damaged[chance.choice(digits)] = chance.choice(_DIGITS)
        else:
            part = Part(chance.whole(), chance.choice(("<H", "<I", "<Q"))).encode()
            place = chance.randrange(48, len(damaged) - len(part))
            damaged[place : place + len(part)] = part
    return Case("e57", with_checksums(bytes(damaged)), content=EXPANDED)
