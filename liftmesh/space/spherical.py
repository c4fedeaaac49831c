"""spherical_delaunay(): the Delaunay triangulation of points on the sphere, and their cells.

Points are rays: what counts is the exact direction of a vector of three doubles, of any length. So
no row is off the sphere, and none can get lost: rows of one direction are duplicates, and all
others are vertices, however near to each other. Longitudes and latitudes are converted once.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Floats, Mask, Progress, Rows
from liftmesh.base.arrays import as_numbers, non_finite, read_only, used_rows, widened
from liftmesh.base.frozen import FrozenResult, cached_property, check_copied
from liftmesh.base.options import NonFinite, as_switch, counted
from liftmesh.errors import DegenerateInputError, InputError, Option
from liftmesh.planar.certificate import Certificate, Flaw, sha256_of
from liftmesh.planar.delaunay import check_options
from liftmesh.predicates import orient2d
from liftmesh.space.points import coordinates_of

_SECRET = int.from_bytes(os.urandom(8), "little")  # salts the order of insertion


@dataclass(frozen=True, eq=False, repr=False)
class SphericalTriangulation(FrozenResult):
    """A Delaunay triangulation of points on the sphere, as returned by `spherical_delaunay`.

    Every index is a row of the caller's array. The arrays are read-only.

    Parameters
    ----------
    points : (n, 3) ndarray of float64
        The points as vectors: those of longitudes and latitudes have length 1, up to rounding.
    simplices : (m, 3) ndarray of int32
        The triangles, counter-clockwise seen from outside: 2 v - 4 of v vertices.
    neighbors : (m, 3) ndarray of int32
        The triangle across the edge opposite vertex k. There is no outside.
    duplicates : (k, 2) ndarray of int32
        Rows that are not a vertex because an earlier row has the same direction, ascending, each
        with that row.
    skipped : (j,) ndarray of int32
        Rows that were skipped because they are not finite, ascending.

    See Also
    --------
    spherical_delaunay : Makes it.
    Tetrahedralization : Of points in space.

    Examples
    --------
    >>> import liftmesh
    >>> liftmesh.spherical_delaunay([0, 90, 180, -90, 7, 0], [0, 0, 0, 0, 90, -90])
    <SphericalTriangulation of 6 points: 8 triangles>
    """

    points: Floats
    simplices: Rows
    neighbors: Rows
    duplicates: Rows
    skipped: Rows

    def _check_copy(self) -> None:
        rows = self.duplicates, self.skipped
        check_copied(len(self.points), self.simplices, self.neighbors, *rows)

    def __repr__(self) -> str:
        count = len(self.simplices)
        return f"<SphericalTriangulation of {len(self.points):,} points: {count:,} triangles>"

    @cached_property
    def centers(self) -> Floats:
        """The centers of the circles through the corners of each triangle, on its side.

        Returns
        -------
        (m, 3) ndarray of float64
            Unit vectors: the corners of the Voronoi cells.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.spherical_delaunay([0, 90, 180, -90, 0, 0], [0, 0, 0, 0, 90, -90]).centers[0]
        array([-0.57735027, -0.57735027, -0.57735027])
        """
        centers = np.empty((len(self.simplices), 3))
        _kernel.circle_centres(self.points, np.ascontiguousarray(self.simplices), centers)
        return read_only(centers)

    @cached_property
    def cells(self) -> tuple[Rows, Rows]:
        """The corners of the Voronoi cell of each row: indptr and indices.

        Returns
        -------
        indptr : (n + 1,) ndarray of int32
            Where the corners of each cell begin; rows that are no vertices have none.
        indices : (3 m,) ndarray of int32
            The corners of cell i are ``centers[indices[indptr[i]:indptr[i + 1]]]``,
            counter-clockwise seen from outside. Where four points or more lie on one circle, some
            are at one place, up to rounding.

        Examples
        --------
        >>> import liftmesh, numpy as np
        >>> cube = np.indices((2, 2, 2)).reshape(3, -1).T - 0.5
        >>> indptr, indices = liftmesh.spherical_delaunay(cube).cells
        >>> np.diff(indptr)
        array([3, 5, 5, 5, 5, 5, 5, 3], dtype=int32)
        """
        arrays = map(np.ascontiguousarray, (self.simplices, self.neighbors))
        first, second = arrays
        indptr, indices = _kernel.sphere_cells(first, second, len(self.points))
        return indptr, indices

    @cached_property
    def areas(self) -> Floats:
        """The areas of the Voronoi cells on the sphere of radius 1.

        Returns
        -------
        (n,) ndarray of float64
            In steradians, 4 pi in all; 0 for rows that are no vertices.

        Examples
        --------
        >>> import liftmesh, numpy as np
        >>> six = liftmesh.spherical_delaunay([0, 90, 180, -90, 0, 0], [0, 0, 0, 0, 90, -90])
        >>> np.allclose(six.areas, 4 * np.pi / 6)
        True
        """
        areas = np.zeros(len(self.points))
        units = _units(self.points)
        for k in range(3):
            tail, head = (self.simplices[:, (k + step) % 3] for step in (1, 2))
            before = self.centers[self.neighbors[:, k]]
            parts = _swept_areas(units[tail], units[head], before, self.centers)
            areas += np.bincount(tail, weights=parts, minlength=len(areas))
        return read_only(areas)

    def verify(self) -> Certificate:
        """Verify from scratch, and exactly, that these are the triangles of the points.

        Returns
        -------
        Certificate
            True if the triangles are the canonical Delaunay triangulation of the directions.

        See Also
        --------
        verify : The same in the plane and in space, for triangulations from any source.

        Notes
        -----
        From one of the points, the sphere is seen as a plane in which circles stay circles. The
        triangles at this point are beyond the boundary of the others, which must turn
        counter-clockwise, pair along their edges, and have a convex boundary that turns once. Then
        they cover its inside once. They are Delaunay if no circle has the apex of a neighbour.

        Examples
        --------
        >>> import liftmesh
        >>> bool(liftmesh.spherical_delaunay([0, 90, 180, -90, 0], [0, 0, 0, 0, 90]).verify())
        True
        """
        return _certificate(self)


def spherical_delaunay(
    points: Any,
    lat: Any = None,
    *,
    degrees: bool = True,
    nonfinite: NonFinite = "error",
    progress: Progress | None = None,
) -> SphericalTriangulation:
    """Compute the Delaunay triangulation of points on the sphere, and their Voronoi cells.

    Poles and the antimeridian are places like any other. The result is exact for the directions of
    vectors, and unique: of points on one circle, those whose unit vectors are
    lexicographically larger count as infinitesimally nearer to the centre of the sphere.

    Parameters
    ----------
    points : array_like of shape (n,), (n, 2) or (n, 3), Cloud, table or path
        Longitudes, with `lat`; longitudes and latitudes as columns; or vectors x, y, z of any
        length but 0, whose directions count.
    lat : array_like of shape (n,), optional
        Latitudes.
    degrees : bool, default True
        Whether longitudes and latitudes are in degrees, rather than radians. Degrees are converted
        so that multiples of 90 are exact: rows at a pole have one direction, whatever their
        longitude, as have longitudes of -180 and 180.
    nonfinite : {"error", "skip"}, default "error"
        Whether rows with NaN or infinity raise an error, or are skipped and listed in ``skipped``.
    progress : callable, optional
        As for `delaunay`.

    Returns
    -------
    SphericalTriangulation
        Triangles, neighbours, the cells and their areas. Of rows of one direction the first is the
        vertex; the others are in ``duplicates``.

    Raises
    ------
    InputError
        The points have another shape, a latitude is beyond a pole, a vector is 0, or an option is
        unknown.
    NonFiniteError
        A row is not finite and `nonfinite` is "error".
    DegenerateInputError
        There are fewer than four different directions.
    FormatError
        The file cannot be read.

    See Also
    --------
    delaunay : In the plane.
    voronoi : Cells in the plane.
    tetrahedralize : Points in space.

    Notes
    -----
    The triangles are the facets of the convex hull of all directions as unit vectors. Points in one
    hemisphere have some that face the other one; on one circle, two layers of them. Their cells
    fill the sphere as well.

    Examples
    --------
    >>> tri = spherical_delaunay([0, 90, 180, -90, 0, 33, -180], [0, 0, 0, 0, 90, -90, 0])
    >>> tri.simplices.shape, tri.duplicates.tolist(), round(float(tri.areas.sum()), 6)
    ((8, 3), [[6, 2]], 12.566371)
    """
    check_options(nonfinite, "engine", progress)
    rows = _vectors(points, lat, as_switch("degrees", degrees))
    zero = np.flatnonzero((rows == 0).all(axis=1))
    if len(zero):
        raise InputError(f"row {zero[0]} is (0, 0, 0), which has no direction: remove such rows")
    status, row, distinct, simplices, neighbors, duplicates, skipped = _kernel.spherical_delaunay(
        rows, nonfinite == "skip", _SECRET, progress
    )
    if status == "non-finite":
        raise non_finite(row, rows[row])
    if status != "ok":
        raise DegenerateInputError(
            f"{counted(len(rows), 'row')} of {counted(distinct, 'different direction')}: "
            "triangles on the sphere need four"
        )
    if progress is not None:
        progress(1.0)
    return SphericalTriangulation(rows, simplices, neighbors, duplicates, skipped)


def _vectors(points: Any, lat: Any, in_degrees: bool) -> Floats:
    if lat is not None:
        columns = [
            as_numbers(name, values, "give a number for each point", verb="are")
            for name, values in (("points", points), ("lat", lat))
        ]
        lon, lat = columns
        if lon.ndim != 1 or lon.shape != lat.shape:
            raise InputError(
                f"longitudes and latitudes have the shapes {lon.shape} and {lat.shape}: give one "
                "of each for every point"
            )
    else:
        rows = coordinates_of(points)
        if rows.shape[1] == 3:
            return np.ascontiguousarray(widened(rows))
        lon, lat = widened(rows).T
    pole = 90.0 if in_degrees else np.pi / 2
    beyond = np.flatnonzero((np.abs(lat) > pole) & np.isfinite(lat))
    if len(beyond):
        raise InputError(
            f"row {beyond[0]} has the latitude {float(lat[beyond[0]])!r}, which is beyond a pole: "
            f"latitudes are from {-pole} to {pole}, {Option('degrees')} or not, and come second"
        )
    with np.errstate(invalid="ignore"):
        (sin_lat, cos_lat), (sin_lon, cos_lon) = (
            _sine_and_cosine(angles, in_degrees) for angles in (lat, lon)
        )
    return np.stack([cos_lat * cos_lon, cos_lat * sin_lon, sin_lat], axis=1) + 0.0


def _sine_and_cosine(angles: Floats, in_degrees: bool) -> tuple[Floats, Floats]:
    """Those of degrees are exact at multiples of 90, and mirrored exactly between these."""
    if not in_degrees:
        return np.sin(angles), np.cos(angles)
    angles = np.fmod(angles, 360.0)
    quarter = np.rint(angles / 90)
    rest = np.deg2rad(angles - 90 * quarter)
    sine, cosine = np.sin(rest), np.cos(rest)
    turned = [(sine, cosine), (cosine, -sine), (-sine, -cosine), (-cosine, sine)]
    which = np.where(np.isfinite(quarter), quarter, 0).astype(np.int64) % 4
    sines, cosines = (np.choose(which, parts) for parts in zip(*turned, strict=True))
    return sines, cosines


def _units(points: Floats) -> Floats:
    """Return directions as unit vectors, rounded."""
    with np.errstate(invalid="ignore"):
        exponents = np.frexp(np.abs(points).max(axis=1))[1]
        scaled = np.ldexp(points, -exponents[:, None])
        units: Floats = scaled / np.sqrt((scaled**2).sum(axis=1))[:, None]
    return units


def _swept_areas(p: Floats, q: Floats, first: Floats, last: Floats) -> Floats:
    """Compute what sides of cells sweep, seen from p: where p and q are as near, between centers.

    From the middle of p and q, which is at the distance a, an arc of length b along this great
    circle sweeps 2 atan(tan(a / 2) tan(b / 2)).
    """
    total = p + q
    cosine = np.sqrt((total**2).sum(axis=1)) / 2
    is_opposite = cosine < 1e-10  # any place is the middle
    middle = np.where(is_opposite[:, None], first, total)
    along = np.cross(p - q, middle)
    middle, along = (each / np.sqrt((each**2).sum(axis=1))[:, None] for each in (middle, along))
    share = np.sqrt(((p - q) ** 2).sum(axis=1)) / 2 / (1 + cosine)
    arcs = [np.arctan2((c * along).sum(axis=1), (c * middle).sum(axis=1)) for c in (first, last)]
    swept = [2 * np.arctan2(share * np.sin(b / 2), np.cos(b / 2)) for b in arcs]
    # No side is longer than pi: one that seems to go back has passed the place behind the sphere.
    turns = np.where(arcs[1] - arcs[0] < -2, 2 * np.pi, 0.0)
    areas: Floats = swept[1] - swept[0] + turns
    return areas


def _certificate(found: SphericalTriangulation) -> Certificate:
    corners, rows = found.simplices, found.points
    vertices = used_rows(len(rows), corners)
    flaws = []

    def note(kind: str, count: Any, text: str) -> None:
        if count:
            flaws.append(Flaw(kind, int(count), f"{count:,} {text}"))

    missing = len(rows) - len(vertices) - len(found.skipped) - _represented(found, vertices)
    note("missing_vertices", missing, "of the rows have no vertex of their direction")
    tails, heads = (np.roll(corners, -step, axis=1).reshape(-1) for step in (1, 2))
    order = np.lexsort((heads, tails))
    back = np.lexsort((tails, heads))
    paired = (tails[order] == heads[back]) & (heads[order] == tails[back])
    repeated = (np.diff(tails[order]) == 0) & (np.diff(heads[order]) == 0)
    unpaired = np.count_nonzero(~paired) + np.count_nonzero(repeated)
    note("non_manifold_edges", unpaired, "edges do not join two triangles")
    note("no_triangles", not len(corners), "triangulation without triangles")
    if len(corners) and not unpaired:
        beyond = np.empty(len(tails), dtype=np.int32)
        beyond[order] = corners.reshape(-1)[back]  # the apex across each edge
        inside = _sides(rows, *np.repeat(corners, 3, axis=0).T, beyond) >= 0
        note("not_delaunay", np.count_nonzero(inside) // 2, "edges are not locally Delaunay")
        far = corners[0, 0]
        is_near = ~(corners == far).any(axis=1)
        turns = _sides(rows, *corners[is_near].T, far) >= 0
        note("clockwise", np.count_nonzero(turns), "triangles are clockwise")
        note("boundary_winding", not _turns_once(rows, corners, far), "boundary turns twice")
    return Certificate(
        n_rows=len(rows),
        n_skipped=len(found.skipped),
        n_vertices=len(vertices),
        n_duplicates=len(rows) - len(vertices) - len(found.skipped) - missing,
        n_merged=0,
        n_triangles=len(corners),
        n_edges=len(tails) // 2,
        n_hull_edges=0,
        flaws=tuple(flaws),
        points_sha256=sha256_of(rows, "<f8"),
        simplices_sha256=sha256_of(corners, "<i4"),
        version=_kernel.VERSION,
        member="spherical",
    )


def _represented(found: SphericalTriangulation, vertices: Rows) -> int:
    """Count the duplicates whose vertex has exactly their direction."""
    row, kept = found.duplicates.T
    p, q = found.points[row], found.points[kept]
    same: Mask = (np.sign(p) == np.sign(q)).all(axis=1) & np.isin(kept, vertices)
    for axes in ((0, 1), (1, 2), (2, 0)):
        same &= orient2d(np.zeros((len(p), 2)), p[:, axes], q[:, axes]) == 0
    return int(np.count_nonzero(same & ~np.isin(row, vertices)))


def _sides(rows: Floats, *corners: Any) -> Array:
    """Tell on which side of the circles through three rows a fourth is: 1 inside, -1 outside."""
    length = len(corners[0])
    a, b, c, d = (np.ascontiguousarray(rows[np.broadcast_to(each, length)]) for each in corners)
    signs = np.empty(length, dtype=np.int8)
    _kernel.ray_side(a, b, c, d, signs)
    return signs


def _turns_once(rows: Floats, corners: Rows, far: int) -> bool:
    """Whether the triangles at a row are a fan around it, seen from it a convex polygon."""
    star = corners[(corners == far).any(axis=1)]
    turn = (star == far).argmax(axis=1)
    ahead = {}
    for each, k in zip(star.tolist(), turn.tolist(), strict=True):
        ahead[each[(k + 2) % 3]] = each[(k + 1) % 3]
    ring = [next(iter(ahead))]
    while (after := ahead[ring[-1]]) != ring[0] and len(ring) <= len(star):
        ring.append(after)
    if len(ring) != len(star):
        return False
    first, *others = ring
    fan = [(first, a, b) for a, b in pairwise(others)]
    fan += [(first, others[0], each) for each in others[1:]]
    return bool((_sides(rows, *np.array(fan, dtype=np.int32).T, far) < 0).all())
