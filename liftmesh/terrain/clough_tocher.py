"""Interpolation over the faces whose first derivatives are continuous: Clough and Tocher's element.

Each face is divided at its centroid into three cubics (Clough, Tocher 1965), in Bernstein-Bezier
form (Farin 1986). They take the values and gradients of the corners; along a side the cubic is that
of its ends alone. The derivative across a side, in the direction from one centroid to the next, is
linear along it: so two faces agree on it, and what is quadratic is reproduced (Alfeld 1984).

Gradients that are not given are those by which the cubics along all sides bend least: the sum of
the integrals of their squared second derivatives (Nielson 1983; Renka, Cline 1984). The equations
of a vertex hold its own gradient at least twice as strongly as those of its neighbours together, so
Chebyshev's iteration gains a factor of 3.7 in each round. It adds up in the order of coordinates,
whatever that of the rows.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from liftmesh._typing import Array, Floats, Integers, Rows
from liftmesh.base.arrays import pair_keys, used_rows
from liftmesh.errors import InputError, Option

if TYPE_CHECKING:
    from collections.abc import Iterator

    from liftmesh.base.weights import Weights
    from liftmesh.terrain.surface_data import SurfaceData

_ROUNDS = 29  # 3.7 ** 29 > 2 ** 53
_TOGETHER = 1 << 15  # points whose cubics are held at a time


class CloughTocher:
    """A surface with values of its vertices, (k, n), and their gradients, (k, n, 2)."""

    def __init__(self, surface: SurfaceData, columns: Floats, gradients: Floats | None) -> None:
        used = used_rows(len(surface.vertices), surface.faces)
        _check_finite("values", columns[..., None], used)
        if gradients is not None:
            _check_finite("gradients", gradients, used)
        given = np.where(np.isfinite(surface.triangulation.points), surface.triangulation.points, 0)
        exponent = int(np.frexp(np.abs(given[used]).max())[1])  # what is square stays a double
        self._points = np.ldexp(given, -exponent)
        self._solved, self._given = surface.triangulation, columns
        # Values within 1 leave room for their sums; other exponents change no bit of these.
        self._exponents = np.frexp(np.abs(columns[:, used]).max(axis=1))[1][:, None]
        self._columns = np.ldexp(columns, -self._exponents)
        with np.errstate(all="ignore"):
            self._gradients = (
                _Network(self._points, surface.faces, used).gradients(self._columns)
                if gradients is None
                else np.ldexp(gradients, exponent - self._exponents[..., None])
            )

    def at(self, weights: Weights, faces: Rows) -> Floats:
        """Interpolate, (k, m), by linear weights and the triangles that contain the points."""
        found: Floats = (weights @ self._given.T).T
        counts = np.diff(weights.indptr)
        with np.errstate(all="ignore"):
            for number in (2, 3):
                for some in _blocks(np.flatnonzero(counts == number)):
                    entries = weights.indptr[some][:, None] + np.arange(number)
                    corners, shares = weights.indices[entries], weights.data[entries]
                    smooth = (
                        self._on_sides(corners, shares)
                        if number == 2
                        else self._in_faces(corners, shares, faces[some])
                    )  # where it is no double, the linear one stays
                    smooth = np.ldexp(smooth, self._exponents)
                    found[:, some] = np.where(np.isfinite(smooth), smooth, found[:, some])
        return found

    def _rise(self, start: Rows, end: Rows) -> Floats:
        """How much the tangent plane at the start rises to the end, (k, p)."""
        steps = self._gradients[:, start] * (self._points[end] - self._points[start])
        rises: Floats = steps[..., 0] + steps[..., 1]
        return rises

    def _on_sides(self, corners: Rows, shares: Floats) -> Floats:
        u, v = corners.T
        s, t = shares.T
        first = self._columns[:, u]
        whole = self._columns[:, v] - first
        near, far = self._rise(u, v) / 3, whole + self._rise(v, u) / 3
        found: Floats = first + t * (3 * s * (near * s + far * t) + whole * t * t)
        return found

    def _in_faces(self, corners: Rows, shares: Floats, faces: Rows) -> Floats:
        first = self._columns[:, corners[:, 0]]
        heights = self._columns[:, corners] - first[..., None]
        turn = [(0, 1, 2), (1, 2, 0), (2, 0, 1)]
        rises = [[self._rise(corners[:, i], corners[:, j]) for j in range(3)] for i in range(3)]
        sides = [[heights[..., i] + rises[i][j] / 3 for j in range(3)] for i in range(3)]
        inner = [heights[..., i] + (rises[i][j] + rises[i][k]) / 9 for i, j, k in turn]
        middle = []  # of the cubic at the side opposite a corner
        for k, i, j in turn:
            of_i, of_j = self._across(corners, faces, k)
            ends = of_i * (heights[..., i] + sides[j][i]) + of_j * (heights[..., j] + sides[i][j])
            ends += inner[i] + inner[j]
            middle.append(ends / 2 - of_i * sides[i][j] - of_j * sides[j][i])
        deep = [(inner[i] + middle[j] + middle[k]) / 3 for i, j, k in turn]
        centre = (deep[0] + deep[1] + deep[2]) / 3
        least = np.argmin(shares, axis=1)  # the cubic is that opposite the corner
        found = np.empty_like(first)
        for k, i, j in turn:
            own = least == k
            c = 3 * shares[own, k]
            a, b = shares[own, i] - shares[own, k], shares[own, j] - shares[own, k]
            edge = heights[:, own, i] * (a * a * a) + heights[:, own, j] * (b * b * b)
            edge += 3 * a * b * (sides[i][j][:, own] * a + sides[j][i][:, own] * b)
            next_row = inner[i][:, own] * a * a + inner[j][:, own] * b * b
            next_row += 2 * middle[k][:, own] * a * b
            third = deep[i][:, own] * a + deep[j][:, own] * b
            found[:, own] = edge + c * (3 * next_row + c * (3 * third + c * centre[:, own]))
        whole: Floats = first + found
        return whole

    def _across(self, corners: Rows, faces: Rows, k: int) -> tuple[Floats, Floats]:
        """Weigh i and j in the direction across the side opposite corner k; the centroid has 1.

        It leads from the centroid of the face beyond, or from the middle of the side.
        """
        simplices, neighbors = self._solved.simplices, self._solved.neighbors
        turned = np.argmax(simplices[faces] == corners[:, :1], axis=1)
        beyond = neighbors[faces, (turned + k) % 3]
        i, j = corners[:, (k + 1) % 3], corners[:, (k + 2) % 3]
        apex = simplices[beyond].sum(axis=1, dtype=np.int64) - i - j
        side = self._points[j] - self._points[i]
        own = (side + self._points[corners[:, k]] - self._points[i]) / 3
        other = (side + self._points[np.where(beyond < 0, i, apex)] - self._points[i]) / 3
        area = _cross(side, own)
        of_centre, of_j = _cross(side, other) / area, _cross(other, own) / area
        away = of_centre - 1
        shares = (1 - of_j - of_centre) / away, of_j / away
        is_sound = (beyond >= 0) & np.isfinite(shares[0]) & np.isfinite(shares[1])
        return np.where(is_sound, shares[0], -0.5), np.where(is_sound, shares[1], -0.5)


class _Network:
    """The sides of faces, both ways, in the order of the coordinates of their ends."""

    def __init__(self, points: Floats, faces: Rows, used: Rows) -> None:
        self._order = used[np.lexsort((points[used, 1], points[used, 0]))]
        self._rows = len(points)
        place = np.empty(self._rows, np.int64)
        place[self._order] = np.arange(len(used))
        ends = place.take(faces, axis=0)
        starts, stops = ends.ravel(), np.roll(ends, -1, axis=1).ravel()
        keys = np.unique(np.concatenate([pair_keys(starts, stops), pair_keys(stops, starts)]))
        self._from, self._to = keys >> 32, keys & 0xFFFFFFFF
        at = points[self._order]
        steps = at[self._to] - at[self._from]
        length = np.sqrt(steps[:, 0] ** 2 + steps[:, 1] ** 2)
        self._scale = length * np.sqrt(length)
        self._x, self._y = steps.T / self._scale
        self._xx, self._xy, self._yy = (
            2 * self._added(each) for each in (self._x**2, self._x * self._y, self._y**2)
        )
        turn = self._xx * self._yy - self._xy**2
        self._inverse = np.where(turn > 0, 1 / turn, 0)

    def gradients(self, columns: Floats) -> Floats:
        """Estimate the gradients, (k, n, 2), of values, (k, n)."""
        found = np.zeros((*columns.shape, 2))
        for values, each in zip(columns, found, strict=True):
            each[self._order] = self._solved(values[self._order]).T
        return found

    def _solved(self, values: Floats) -> Floats:
        rises = 3 * (values[self._to] - values[self._from]) / self._scale
        last, now = np.zeros((2, len(values))), self._solved_alone(rises)
        factor = 2.0
        for _ in range(_ROUNDS):
            factor = 1 / (1 - factor / 16)  # Chebyshev's, for a spectrum within 1/2
            others = self._x * now[0, self._to] + self._y * now[1, self._to]
            last, now = now, factor * (self._solved_alone(rises - others) - last) + last
        return now

    def _solved_alone(self, along: Floats) -> Floats:
        """Solve the equations of each vertex, with what is known along its sides."""
        u, v = self._added(self._x * along), self._added(self._y * along)
        both = np.stack([self._yy * u - self._xy * v, self._xx * v - self._xy * u])
        solved: Floats = both * self._inverse
        return solved

    def _added(self, each: Floats) -> Floats:
        added: Floats = np.bincount(self._from, each, len(self._order)).astype(np.float64)
        return added


def _cross(p: Floats, q: Floats) -> Floats:
    crossed: Floats = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    return crossed


def _blocks(rows: Integers) -> Iterator[Integers]:
    for first in range(0, len(rows), _TOGETHER):
        yield rows[first : first + _TOGETHER]


def _check_finite(name: str, held: Array, used: Rows) -> None:
    """Raise if a vertex of a face has a number that is not finite: it would reach all others."""
    are_finite = np.isfinite(held[:, used]).all(axis=(0, 2))
    if not are_finite.all():
        row = int(used[np.argmin(are_finite)])
        number = held[:, row][~np.isfinite(held[:, row])][0]
        raise InputError(
            f"{Option(name)} of row {row} hold {number}: {Option('interpolation', 'c1')} needs "
            "finite ones at all vertices of faces, which reach all others"
        )
