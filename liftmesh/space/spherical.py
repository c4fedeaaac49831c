"""spherical_delaunay(): the Delaunay triangulation of points on the sphere, and their cells.

Points are rays: what counts is the exact direction of a vector of three doubles, of any length. So
no row is off the sphere, and none can get lost: rows of one direction are duplicates, and all
others are vertices, however near to each other. Longitudes and latitudes are converted once.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Floats, Progress, Rows
from liftmesh.base.arrays import as_numbers, non_finite, read_only, widened
from liftmesh.base.frozen import cached_property, check_copied
from liftmesh.base.options import NonFinite, as_switch, counted
from liftmesh.errors import DegenerateInputError, InputError, Option
from liftmesh.planar.delaunay import check_options
from liftmesh.planar.lifting import HullMesh
from liftmesh.planar.space_verification import check_directions, verify_sphere
from liftmesh.space.points import coordinates_of

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.planar.certificate import Certificate

_SECRET = int.from_bytes(os.urandom(8), "little")  # salts the order of insertion


@dataclass(frozen=True, eq=False, repr=False)
class SphericalTriangulation(HullMesh):
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
    spherical: ClassVar[bool] = True

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
        numbers = np.arange(len(self.simplices))
        for k in range(3):
            own = np.flatnonzero(self.neighbors[:, k] > numbers)  # each edge once
            tail, head = (self.simplices[own, (k + step) % 3] for step in (1, 2))
            before, after = self.centers[self.neighbors[own, k]], self.centers[own]
            parts = _swept_areas(units[tail], units[head], before, after)
            for ends in (tail, head):
                areas += np.bincount(ends, weights=parts, minlength=len(areas))
        return read_only(areas)

    def to_cloud(self) -> Cloud:
        """Convert it to a cloud with faces, of all rows, each in its place.

        Returns
        -------
        Cloud
            The vectors with the triangles as faces. Its metadata, which files keep, say that these
            are of the sphere: so `verify` takes the file as it is.

        See Also
        --------
        SphericalTriangulation.save : As a file.

        Examples
        --------
        >>> import liftmesh
        >>> tri = liftmesh.spherical_delaunay([0, 90, 180, -90, 0], [0, 0, 0, 0, 90])
        >>> cloud = tri.to_cloud()
        >>> cloud, liftmesh.verify(cloud).canonical
        (<Cloud of 5 points, 6 faces>, True)
        """
        from liftmesh.base.cloud import Cloud  # noqa: PLC0415 - triangles do without
        from liftmesh.io.metadata import LIFTED  # noqa: PLC0415

        return Cloud(self.points, faces=self.simplices, metadata={LIFTED: {"spherical": True}})

    def verify(
        self, *, threads: int | None = None, progress: Progress | None = None
    ) -> Certificate:
        """Verify the triangles from scratch, as `liftmesh.verify` does for any.

        Parameters
        ----------
        threads : int, optional
            As for `tetrahedralize`.
        progress : callable, optional
            As for `delaunay`.

        Returns
        -------
        Certificate
            True if the triangles are a Delaunay triangulation of the directions.

        Raises
        ------
        InputError
            `threads` is not a valid number, or `progress` cannot be called.

        See Also
        --------
        verify : The check of triangles from any source, with ``spherical=True``.

        Examples
        --------
        >>> import liftmesh
        >>> bool(liftmesh.spherical_delaunay([0, 90, 180, -90, 0], [0, 0, 0, 0, 90]).verify())
        True
        """
        is_skipping = len(self.skipped) > 0
        return verify_sphere(self.points, self.simplices, is_skipping, threads, progress)


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
    check_directions(rows)
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
    circle sweeps 2 atan(tan(a / 2) tan(b / 2)). Seen from q it is the same.
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
