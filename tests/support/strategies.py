"""hypothesis strategies for planar clouds: whatever is known to break floating-point geometry.

Each motif is a short list of rows, drawn number by number, so that a failure shrinks to a few
small numbers. `clouds` joins several motifs in any order, `alone` makes points of one.
Where `clouds.py` draws one family at a time from a random generator, here the offset, the scale,
the direction and the mixture are hypothesis's to choose.
"""

from __future__ import annotations

import math

import hypothesis.strategies as st
import numpy as np
from clouds import on_radius_325
from hypothesis.strategies import SearchStrategy
from numpy.typing import NDArray

Points = NDArray[np.float64]
Row = tuple[float, float]
Motif = SearchStrategy[list[Row]]

SMALLEST = 2.0**-1074
FINITE = st.floats(allow_nan=False, allow_infinity=False)
ZERO = st.sampled_from([0.0, -0.0])
FEW = st.integers(-4, 4)

POWERS_OF_TWO = st.one_of(
    st.sampled_from([1.0, 2.0**-52, 2.0**53]), st.integers(-1074, 1000).map(lambda k: 2.0**k)
)
POWERS_OF_TEN = st.one_of(
    st.sampled_from([0.1, 0.01, 10.0]), st.integers(-323, 300).map(lambda k: float(f"1e{k}"))
)
SCALES = st.one_of(POWERS_OF_TWO, POWERS_OF_TEN)
OFFSETS = st.one_of(
    st.sampled_from([0.0, 1.0, 0.1, 450_000.0, -5.2e6, 1e15, 2.0**53]), st.floats(-1e300, 1e300)
)
ANY_MAGNITUDE = st.builds(
    math.ldexp,
    st.floats(0.5, 1.0, exclude_max=True).flatmap(lambda m: st.sampled_from([m, -m])),
    st.integers(-1074, 1024),
)
DIRECTIONS = st.tuples(st.integers(-7, 7), st.integers(-7, 7)).filter(any)
COCIRCULAR = [tuple(row) for row in on_radius_325().tolist()]


def rows_of(xs: SearchStrategy[float], ys: SearchStrategy[float], most: int = 12) -> Motif:
    """Lists of rows of independent coordinates."""
    return st.lists(st.tuples(xs, ys), min_size=2, max_size=most)


@st.composite
def lattices(draw: st.DrawFn) -> list[Row]:
    """A lattice with any offset, and with any scale along either axis: exact or just rounded."""
    columns, lines = draw(st.integers(1, 5)), draw(st.integers(1, 5))
    scale = draw(SCALES)
    scales = scale, draw(st.one_of(st.just(scale), SCALES))
    offsets = draw(OFFSETS), draw(OFFSETS)
    if draw(st.booleans()):  # an offset in steps of the lattice, which stays one
        offsets = draw(FEW) * scales[0], draw(FEW) * scales[1]
    return [
        (offsets[0] + i * scales[0], offsets[1] + j * scales[1])
        for i in range(columns)
        for j in range(lines)
    ]


@st.composite
def ulp_neighbours(draw: st.DrawFn) -> list[Row]:
    """Within a few ulps of one position, of any magnitude."""
    near = draw(st.tuples(st.one_of(OFFSETS, ANY_MAGNITUDE), st.one_of(OFFSETS, ANY_MAGNITUDE)))
    steps = draw(st.lists(st.tuples(FEW, FEW), min_size=1, max_size=12))
    ulps = [math.ulp(value) for value in near]
    rows = [(near[0] + i * ulps[0], near[1] + j * ulps[1]) for i, j in steps]
    return [row for row in rows if all(map(math.isfinite, row))]


@st.composite
def collinear_runs(draw: st.DrawFn) -> list[Row]:
    """Multiples of one step in any direction from anywhere, one row perhaps an ulp beside."""
    (dx, dy), scale = draw(DIRECTIONS), draw(SCALES)
    x, y = draw(st.tuples(OFFSETS, OFFSETS) if draw(st.booleans()) else st.just((0.0, 0.0)))
    multiples = draw(st.lists(st.integers(-40, 40), min_size=2, max_size=12))
    rows = [(x + t * dx * scale, y + t * dy * scale) for t in multiples]
    if draw(st.booleans()):
        rows[0] = rows[0][0], math.nextafter(rows[0][1], draw(st.sampled_from([-1e308, 1e308])))
    return rows


@st.composite
def concentric_circles(draw: st.DrawFn) -> list[Row]:
    """Exactly cocircular points of several circles around one centre, and perhaps the centre."""
    scale, (x, y) = draw(POWERS_OF_TWO), draw(st.tuples(FEW, FEW))
    radii = draw(st.lists(st.integers(1, 4), min_size=1, max_size=3, unique=True))
    rows = [(x, y)] if draw(st.booleans()) else []
    for radius in radii:
        chosen = draw(st.lists(st.sampled_from(COCIRCULAR), min_size=3, max_size=9))
        rows += [(x + radius * u, y + radius * v) for u, v in chosen]
    return [(u * scale, v * scale) for u, v in rows]


@st.composite
def clusters_of_duplicates(draw: st.DrawFn) -> list[Row]:
    """A few positions, each in many rows, with zeros of both signs."""
    zero = st.one_of(ZERO, FEW.map(float))
    positions = draw(rows_of(zero, zero, 5))
    return draw(st.lists(st.sampled_from(positions), min_size=2, max_size=15))


def denormals() -> Motif:
    """Whole multiples of the smallest double, at zero and where denormal numbers end."""
    step = st.builds(lambda near, k: near + k * SMALLEST, st.sampled_from([0.0, 2.0**-1022]), FEW)
    return rows_of(step, step)


def zeros_of_both_signs() -> Motif:
    """On the axes, and at their crossing."""
    value = st.one_of(ZERO, st.sampled_from([1.0, -1.0, SMALLEST, -SMALLEST]))
    return rows_of(value, value)


def last_integers() -> Motif:
    """Integers where doubles begin to pass over some."""
    near = st.builds(lambda side, k: side * (2.0**53 + k), st.sampled_from([1, -1, 1]), FEW)
    return rows_of(near, st.one_of(near, FEW.map(float)))


@st.composite
def small_integers(draw: st.DrawFn) -> list[Row]:
    """Every kind of coincidence at once, at any power of two."""
    scale = draw(POWERS_OF_TWO)
    return [(x * scale, y * scale) for x, y in draw(rows_of(FEW, FEW))]


def mixed_magnitudes() -> Motif:
    """Each coordinate of another magnitude, over the whole range of exponents."""
    return rows_of(ANY_MAGNITUDE, ANY_MAGNITUDE, 10)


MOTIFS: dict[str, Motif] = {
    "lattices": lattices(),
    "ulp-neighbours": ulp_neighbours(),
    "collinear-runs": collinear_runs(),
    "concentric-circles": concentric_circles(),
    "clusters-of-duplicates": clusters_of_duplicates(),
    "denormals": denormals(),
    "zeros-of-both-signs": zeros_of_both_signs(),
    "last-integers": last_integers(),
    "small-integers": small_integers(),
    "mixed-magnitudes": mixed_magnitudes(),
    "any-doubles": rows_of(FINITE, FINITE, 10),
}
ANY_MOTIF = st.one_of(*MOTIFS.values())


def alone(motif: Motif, most: int = 24) -> SearchStrategy[Points]:
    """The rows of one motif as points."""
    return motif.map(lambda rows: np.array(rows[:most] or [(0.0, 0.0)], dtype=np.float64))


@st.composite
def clouds(draw: st.DrawFn, most: int = 24) -> Points:
    """Rows of up to three motifs in any order: finite, and between one and `most`."""
    motifs = draw(st.lists(ANY_MOTIF, min_size=1, max_size=3))
    rows = [row for motif in motifs for row in motif] or [(0.0, 0.0)]
    return np.array(draw(st.permutations(rows))[:most], dtype=np.float64)


COCIRCULAR_CLOUDS = st.one_of(alone(concentric_circles()), alone(small_integers()))
SITES = st.lists(st.tuples(*[st.integers(-3, 6)] * 2), min_size=1, max_size=9).map(
    lambda rows: np.array(rows, float)
)
