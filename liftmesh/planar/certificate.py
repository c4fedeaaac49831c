"""What `verify` found: counts, flaws with their first offenders, and a JSON form that can travel.

A certificate names the points and the triangles it speaks of by their SHA-256, so that whoever
holds both can tell that it is theirs.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass, field
from typing import Any

FORMAT = "liftmesh certificate"
FORMAT_VERSION = 1


@dataclass(frozen=True, slots=True)
class Offender:
    """One place where a triangulation is wrong.

    Attributes
    ----------
    text : str
        What is wrong there, in words.
    rows : tuple of int
        The rows it is about: the corners of a triangle, the ends of a side, a row of the border
        between its neighbours; of a side that is not Delaunay the corners of one triangle, then the
        apex of the other.
    points : tuple of (float, float)
        Their coordinates; nothing for an index that is no row.
    triangles : tuple of int
        The triangles it is about.
    side : int or None
        The exact sign that tells: of `orient2d` for three rows, of `incircle` for four.

    Examples
    --------
    >>> import liftmesh
    >>> liftmesh.verify([[0, 0], [1, 0], [0, 1]], [[0, 2, 1]]).flaws[0].first[0].side
    -1
    """

    text: str
    rows: tuple[int, ...]
    points: tuple[tuple[float, float], ...] = ()
    triangles: tuple[int, ...] = ()
    side: int | None = None


@dataclass(frozen=True, slots=True)
class Flaw:
    """One kind of flaw.

    Attributes
    ----------
    kind : str
        Its name: "index", "non-finite", "clockwise", "flat", "doubled", "empty", "border",
        "pinched", "pieces", "winding", "hull", "euler", "missing", "delaunay" or "canonical".
    count : int
        How often it was found.
    text : str
        What it means, with the count, in words.
    first : tuple of Offender
        The first sixteen places at most.

    Examples
    --------
    >>> import liftmesh
    >>> liftmesh.verify([[0, 0], [1, 0], [0, 1]], [[0, 2, 1]]).flaws[0].text
    '1 triangle turns clockwise'
    """

    kind: str
    count: int
    text: str
    first: tuple[Offender, ...] = ()


@dataclass(frozen=True, slots=True)
class Certificate:
    """Whether some triangles are the Delaunay triangulation of some points. Made by `verify`.

    As a truth value it is `valid`.

    Attributes
    ----------
    rows : int
        Rows of the points.
    skipped : int
        Rows that are not finite, and no corners.
    vertices : int or None
        Positions that are corners. This, and what is None besides, is not counted where a corner is
        no row, or a row that is not finite.
    duplicates : int or None
        Rows that are finite and share the position of another row, which stands for them.
    merged : int or None
        Of the rows that are corners, those beyond one for each position, as in meshes whose
        triangles do not share their vertices.
    triangles : int
        Triangles.
    edges, hull_edges : int or None
        Sides, each counted once; those of them with one triangle.
    flaws : tuple of Flaw
        What is wrong. A flaw of the kind "canonical" leaves the triangulation valid.
    points_sha256 : str
        Of x and y of each row, one after the other, as little-endian float64; no number of rows.
        float32 is widened, -0.0 stays as it is given. It is of the points that were judged: of
        those in the plane, where ``liftmesh verify`` has ``--plane``.
    simplices_sha256 : str
        Of the three corners of each triangle, as they are given, as little-endian int32; where one
        does not fit, and so is no row, all as int64, or as uint64 where that does not fit either.
    version : str
        Of liftmesh.

    Examples
    --------
    >>> import liftmesh
    >>> certificate = liftmesh.verify([[0, 0], [2, 0], [2, 1], [0, 1]], [[0, 1, 2], [0, 2, 3]])
    >>> bool(certificate), certificate.canonical
    (True, False)
    >>> print(certificate)
    valid: these 2 triangles are a Delaunay triangulation of 4 rows; not canonical: 1 side is ...
    """

    rows: int
    skipped: int
    vertices: int | None
    duplicates: int | None
    merged: int | None
    triangles: int
    edges: int | None
    hull_edges: int | None
    flaws: tuple[Flaw, ...]
    points_sha256: str
    simplices_sha256: str
    version: str = field(compare=False)

    @property
    def valid(self) -> bool:
        """Whether the triangles are a Delaunay triangulation of all the points."""
        return all(flaw.kind == "canonical" for flaw in self.flaws)

    @property
    def canonical(self) -> bool:
        """Whether they are the one in which ties are broken by the rule, as `delaunay` does."""
        return not self.flaws

    @property
    def euler_characteristic(self) -> int | None:
        """Vertices less edges plus triangles: 1 for what covers a disk. None if not counted."""
        if self.vertices is None or self.edges is None:
            return None
        return self.vertices - self.edges + self.triangles

    def __bool__(self) -> bool:
        return self.valid

    def __str__(self) -> str:
        if not self.valid:
            return self._objection()
        these = f"these {self.triangles:,} triangles are" if self.triangles > 1 else "1 triangle is"
        kind = "the canonical" if self.canonical else "a"
        said = f"valid: {these} {kind} Delaunay triangulation of {self.rows:,} rows"
        return said + "".join(f"; not canonical: {flaw.text}" for flaw in self.flaws)

    def _objection(self) -> str:
        wrong = "; ".join(flaw.text for flaw in self.flaws if flaw.kind != "canonical")
        first = [flaw.first[0].text for flaw in self.flaws if flaw.first]
        return f"not valid: {wrong}" + "".join(f"; first: {text}" for text in first[:1])

    def as_dict(self) -> dict[str, Any]:
        """Give all that is known as plain values, for JSON.

        Returns
        -------
        dict
            Numbers, texts, truth values, lists and dicts; None for what was not counted.
            Coordinates that are not finite are texts: JSON has no such numbers.

        Examples
        --------
        >>> import liftmesh
        >>> liftmesh.verify([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]).as_dict()["counts"]["edges"]
        3
        """
        counts = ("rows", "skipped", "vertices", "duplicates", "merged", "triangles", "edges")
        return {
            "format": FORMAT,
            "format_version": FORMAT_VERSION,
            "liftmesh": self.version,
            "valid": self.valid,
            "canonical": self.canonical,
            "points_sha256": self.points_sha256,
            "simplices_sha256": self.simplices_sha256,
            "counts": {name: getattr(self, name) for name in (*counts, "hull_edges")},
            "euler_characteristic": self.euler_characteristic,
            "flaws": [_plain(asdict(flaw)) for flaw in self.flaws],
        }

    def to_json(self) -> str:
        """Write the certificate as JSON.

        Returns
        -------
        str
            `as_dict` as a JSON object; coordinates name their doubles exactly.

        Examples
        --------
        >>> import liftmesh
        >>> '"valid": true' in liftmesh.verify([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]).to_json()
        True
        """
        return json.dumps(self.as_dict(), indent=2, allow_nan=False) + "\n"


def _plain(value: Any) -> Any:
    """Give lists for tuples, and texts for numbers that JSON does not have."""
    if isinstance(value, dict):
        return {key: _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if isinstance(value, float) and not math.isfinite(value):
        return repr(value)
    return value
