"""The result of `verify`: counts, flaws with their first violations, and a JSON form.

A certificate identifies its points and triangles by their SHA-256 sums, so that anyone who has them
can confirm that it is theirs.
"""

from __future__ import annotations

import hashlib
import json
import math
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from liftmesh._typing import Array
from liftmesh.base.display import Plotted

FORMAT = "liftmesh certificate"
FORMAT_VERSION = 1
OF_MEMBERS = 2  # of other triangulations than Delaunay's, which readers of version 1 do not know
OF_CONSTRAINED = 3  # of these, which readers of version 2 do not know
OF_TETRAHEDRA = 4  # of these, which readers of version 3 do not know
OF_SPHERE = 5  # of triangles on it, which readers of version 4 do not know
_IN_SPACE = ("tetrahedron", "tetrahedra")
_NAMES_IN_SPACE = {
    "n_triangles": "n_tetrahedra",
    "n_edges": "n_facets",
    "n_hull_edges": "n_hull_facets",
}
_HASHED_AT_ONCE = 1 << 20


@dataclass(frozen=True, slots=True)
class Violation:
    """One place where a triangulation is wrong.

    Attributes
    ----------
    text : str
        What is wrong there, in words.
    rows : tuple of int
        The rows concerned: the corners of a triangle, the ends of an edge, or a row of the boundary
        between its neighbours; for an edge that is not Delaunay the corners of one triangle, then
        the apex of the other.
    points : tuple of (float, float), or of three
        Their coordinates; empty if an index is not a row.
    triangles : tuple of int
        The triangles concerned, or tetrahedra.
    sign : int or None
        The exact sign that decides: of `orient2d` for three rows; for four of `incircle`, or for
        other members than "delaunay" whether the last is lifted below the plane of the others (1).
        In space of `orient3d` and `insphere`; on the sphere whether the last row is inside the
        circle of the others (1) or on it (0).

    See Also
    --------
    Flaw : A kind of flaw, with its first violations.
    orient2d : The sign of three rows.
    incircle : The sign of four rows.

    Examples
    --------
    >>> import liftmesh
    >>> liftmesh.verify([[0, 0], [1, 0], [0, 1]], [[0, 2, 1]]).flaws[0].first[0].sign
    -1
    """

    text: str
    rows: tuple[int, ...]
    points: tuple[tuple[float, ...], ...] = ()
    triangles: tuple[int, ...] = ()
    sign: int | None = None


@dataclass(frozen=True, slots=True)
class Flaw:
    """One kind of flaw.

    Attributes
    ----------
    kind : str
        Its name: "invalid_index", "non_finite", "clockwise", "degenerate", "non_manifold_edges",
        "non_manifold_vertices", "boundary_loops", "boundary_winding", "not_convex",
        "missing_vertices", "not_delaunay", "no_triangles", "no_boundary", "euler" or
        "not_canonical"; with constraints also "missing_constraints", "open_boundaries" or
        "overlaps", of which only the first is found; of refined triangulations also "small_angles"
        or "uncovered_edges"; of tiles also "other_hull", "other_duplicates", "other_skipped",
        "other_neighbors", "other_coordinates", "other_vertices" or "damaged_files"; of graphs of
        disks also "no_circle", "wrong_neighbors", "wrong_hull", "wrong_order", "wrong_hidden",
        "wrong_duplicates", "other_circles" or "other_skipped"; of tetrahedra also "negative",
        "non_manifold_facets" or "no_tetrahedra".
    count : int
        The number of occurrences.
    text : str
        What it means, with the count, in words.
    first : tuple of Violation
        At most the first sixteen occurrences.

    See Also
    --------
    Violation : One place of a flaw.
    Certificate : All flaws of some triangles.

    Examples
    --------
    >>> import liftmesh
    >>> liftmesh.verify([[0, 0], [1, 0], [0, 1]], [[0, 2, 1]]).flaws[0].text
    '1 triangle is clockwise'
    """

    kind: str
    count: int
    text: str
    first: tuple[Violation, ...] = ()


@dataclass(frozen=True, slots=True, repr=False)
class Certificate(Plotted):
    """Whether some triangles are a triangulation of some points: what `verify` has found.

    It is said of Delaunay triangulations, of constrained, regular, metric or farthest-point ones,
    and of graphs of disks: `member`.

    As a truth value it is `valid`.

    Attributes
    ----------
    n_rows : int
        Rows of the points.
    n_skipped : int
        Rows that are not finite.
    n_vertices : int or None
        Distinct positions of corners. This and the other counts are None if a corner is not a row,
        or is on a row that is not finite.
    n_duplicates : int or None
        Finite rows at the position of another row, which represents them, and of its weight.
    n_merged : int or None
        The number of rows that are corners, beyond one for each position, as in meshes whose
        triangles do not share vertices.
    n_triangles : int
        Triangles; in space tetrahedra.
    n_edges, n_hull_edges : int or None
        Edges, and those of them that belong to one triangle only; in space facets, and those of one
        tetrahedron. Where regions were carved, these are the boundary of what is left.
    flaws : tuple of Flaw
        What is wrong. A flaw of the kind "not_canonical" leaves the triangulation valid.
    points_sha256 : str
        Of x and y of each row (in space and on the sphere also z), in order, as little-endian
        float64, without the number of rows. float32 is widened, -0.0 stays as given. It is of the
        points that were checked: of the planar coordinates if ``liftmesh verify`` has ``--plane``.
    simplices_sha256 : str
        Of the three corners of each triangle, as given, as little-endian int32; if one does not
        fit, and so is not a row, all as int64, or as uint64 if that does not fit either.
    version : str
        Of liftmesh.
    member : str
        Of which triangulation this is said: "delaunay", "constrained", "weights" or "radii"
        (regular), "metric", "farthest", "spherical", or "apollonius" for the graph of disks.
    n_hidden : int or None
        Finite rows that are no vertices as their lifted points are strictly above the triangles, or
        as their disks are within others; 0 where none can be, None if they were not counted. They
        are not among the duplicates.
    metric : tuple or None
        The matrix of a metric.
    values_sha256 : str or None
        Of the weights or radii of all rows, also of disks, as little-endian float64.
    n_constraints : int or None
        Constraints, as given; None for others than constrained triangulations.
    n_outside : int or None
        Finite rows that lie where no triangle is, since regions were carved; None if they were not
        counted. They are not among the duplicates.
    carved : bool
        Whether regions bounded by constraints were allowed to be missing.
    constraints_sha256 : str or None
        Of the two rows of each constraint, as given, as little-endian int32.
    planar : bool or None
        Whether no two triangles overlap, whatever their orientation, and no vertex is inside a side
        of another one, also if the triangulation is not valid: then `as_surface` makes a surface of
        a mesh as it is, if rows at one position have one height. None if it was not asked, as of
        members by weights or in a metric.
    delaunay : bool or None
        Whether the triangulation is valid, and no circle of a triangle contains the apex of a
        neighbour, not even across a constraint: it is Delaunay without constraints then, but for
        those along which regions were carved. None if it was not asked, as of invalid ones with
        constraints, and of other members.

    See Also
    --------
    verify : Makes certificates.
    Flaw : What is wrong.

    Examples
    --------
    >>> import liftmesh
    >>> certificate = liftmesh.verify([[0, 0], [2, 0], [2, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]])
    >>> bool(certificate), certificate.canonical
    (True, False)
    >>> print(certificate)
    valid: these 2 triangles are a Delaunay triangulation of 4 rows; not canonical: 1 edge is ...
    """

    n_rows: int
    n_skipped: int
    n_vertices: int | None
    n_duplicates: int | None
    n_merged: int | None
    n_triangles: int
    n_edges: int | None
    n_hull_edges: int | None
    flaws: tuple[Flaw, ...]
    points_sha256: str
    simplices_sha256: str
    version: str = field(compare=False)
    member: str = "delaunay"
    n_hidden: int | None = 0
    metric: tuple[tuple[float, float], tuple[float, float]] | None = None
    values_sha256: str | None = None
    n_constraints: int | None = None
    n_outside: int | None = 0
    carved: bool = False
    constraints_sha256: str | None = None
    planar: bool | None = None
    delaunay: bool | None = None
    dimension: int = 2

    def __repr__(self) -> str:
        return f"<Certificate: {self}>"

    @property
    def valid(self) -> bool:
        """Whether the triangles are such a triangulation of all the points."""
        return all(flaw.kind == "not_canonical" for flaw in self.flaws)

    @property
    def canonical(self) -> bool:
        """Whether they are the triangles that liftmesh makes, also where several are right."""
        return not self.flaws

    @property
    def euler_characteristic(self) -> int | None:
        """Vertices - edges + triangles: 1 for a disk, 2 for a sphere. None if not counted.

        Of carved triangulations it may be another number, and of tetrahedra it is None.
        """
        if self.n_vertices is None or self.n_edges is None or self.dimension == 3:
            return None
        return self.n_vertices - self.n_edges + self.n_triangles

    @property
    def name(self) -> str:
        """What the triangles are said to be, without an article."""
        return {
            "constrained": "constrained Delaunay triangulation",
            "farthest": "farthest-point Delaunay triangulation",
            "apollonius": "Delaunay graph of disks",
            "spherical": "Delaunay triangulation on the sphere",
            "weights": "regular triangulation by weights",
            "radii": "regular triangulation by radii",
            "metric": f"Delaunay triangulation in the metric {_plain(self.metric)}",
        }.get(self.member, "Delaunay triangulation")

    def __bool__(self) -> bool:
        return self.valid

    def __str__(self) -> str:
        if not self.valid:
            return self._describe_flaws()
        one, more = ("triangle", "triangles") if self.dimension == 2 else _IN_SPACE
        count = self.n_triangles
        these = f"these {count:,} {more} are" if count != 1 else f"1 {one} is"
        kind = "the canonical" if self.canonical else "a"
        said = f"valid: {these} {kind} {self.name} of {self.n_rows:,} rows"
        said += f", {self.n_hidden:,} of them hidden" if self.n_hidden else ""
        said += f", {self.n_outside:,} of them outside" if self.n_outside else ""
        said += "; not Delaunay along constraints" if self.delaunay is False else ""
        return said + "".join(f"; not canonical: {flaw.text}" for flaw in self.flaws)

    def _describe_flaws(self) -> str:
        wrong = "; ".join(flaw.text for flaw in self.flaws if flaw.kind != "not_canonical")
        first = [flaw.first[0].text for flaw in self.flaws if flaw.first]
        said = f"not valid: {wrong}" + "".join(f"; first: {text}" for text in first[:1])
        if not self.planar:
            return said
        told = "; no two triangles overlap: as_surface takes them"
        return said + told + (" if rows at one position have one height" if self.n_merged else "")

    def as_dict(self) -> dict[str, Any]:
        """Return the certificate as plain values, for JSON.

        Returns
        -------
        dict
            Numbers, strings, booleans, lists and dicts; None for what was not counted. Coordinates
            that are not finite are strings, since JSON has no such numbers.

        See Also
        --------
        Certificate.to_json : The same as text.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.verify([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]).as_dict()["counts"]["n_edges"]
        3
        """
        counts = {k: v for k, v in asdict(self).items() if k.startswith("n_")}
        if self.member in ("delaunay", "constrained", "spherical"):
            del counts["n_hidden"]
        if self.member != "constrained":
            del counts["n_constraints"], counts["n_outside"]
        versions = {"delaunay": FORMAT_VERSION, "constrained": OF_CONSTRAINED}
        versions["spherical"] = OF_SPHERE
        version = versions.get(self.member, OF_MEMBERS)
        if self.dimension == 3:
            version = OF_TETRAHEDRA
            counts = {_NAMES_IN_SPACE.get(name, name): count for name, count in counts.items()}
        return {
            "format": FORMAT,
            "format_version": version,
            **self._member(),
            "liftmesh": self.version,
            "valid": self.valid,
            "canonical": self.canonical,
            **self._shape(),
            "points_sha256": self.points_sha256,
            "simplices_sha256": self.simplices_sha256,
            "counts": counts,
            "euler_characteristic": self.euler_characteristic,
            "flaws": [_plain(asdict(flaw)) for flaw in self.flaws],
        }

    def _member(self) -> dict[str, Any]:
        """What a certificate of a Delaunay triangulation does not hold."""
        said = {"member": self.member, "metric": _plain(self.metric)}
        said |= {"values_sha256": self.values_sha256}
        if self.member == "constrained":
            said |= {"carved": self.carved, "constraints_sha256": self.constraints_sha256}
        return {} if self.member == "delaunay" else {k: v for k, v in said.items() if v is not None}

    def _shape(self) -> dict[str, bool]:
        """What was asked of a triangulation besides whether it is valid."""
        said = {"planar": self.planar, "delaunay": self.delaunay}
        return {name: value for name, value in said.items() if value is not None}

    def to_json(self) -> str:
        """Write the certificate as JSON.

        Returns
        -------
        str
            `as_dict` as a JSON object; coordinates name their doubles exactly.

        See Also
        --------
        Certificate.as_dict : The same as plain values.

        Examples
        --------
        >>> import liftmesh
        >>> '"valid": true' in liftmesh.verify([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]).to_json()
        True
        """
        return json.dumps(self.as_dict(), indent=2, allow_nan=False) + "\n"


def _plain(value: Any) -> Any:
    """Replace tuples by lists, and numbers that JSON lacks by strings."""
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    return value


def sha256_of(array: Array, dtype: str) -> str:
    """Hash the values in one form, for any layout, without copying the whole array."""
    digest = hashlib.sha256()
    for first in range(0, len(array), _HASHED_AT_ONCE):
        piece = np.ascontiguousarray(array[first : first + _HASHED_AT_ONCE], dtype=dtype)
        digest.update(piece.data)
    return digest.hexdigest()


def narrowest(given: Array) -> str:
    """Find the type in which corners are hashed: int32, unless one of them does not fit."""
    if given.dtype == np.int32 or given.size == 0:
        return "<i4"
    least, most = int(given.min()), int(given.max())
    if least >= -(2**31) and most < 2**31:
        return "<i4"
    return "<i8" if most < 2**63 else "<u8"
