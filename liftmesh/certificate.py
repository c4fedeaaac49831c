"""What `verify` found: counts, flaws with their first offenders, and a JSON form that can travel.

A certificate names the points and the triangles it speaks of by their SHA-256, so that whoever
holds both can tell that it is theirs.
"""

from __future__ import annotations

import json
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
    vertices : int
        Positions that are corners.
    duplicates : int
        Rows that are finite and share the position of another row, which stands for them.
    merged : int
        Of those, the ones that are corners themselves, as in meshes whose triangles do not share
        their vertices.
    triangles, edges, hull_edges : int
        Triangles; sides, each counted once; those of them with one triangle.
    flaws : tuple of Flaw
        What is wrong. A flaw of the kind "canonical" leaves the triangulation valid.
    points_sha256, simplices_sha256 : str
        Of the points as little-endian float64, x and y of each row; of the triangles as
        little-endian int32, three corners each.
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
    vertices: int
    duplicates: int
    merged: int
    triangles: int
    edges: int
    hull_edges: int
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
    def euler_characteristic(self) -> int:
        """Vertices less edges plus triangles: 1 for what covers a disk."""
        return self.vertices - self.edges + self.triangles

    def __bool__(self) -> bool:
        return self.valid

    def __str__(self) -> str:
        said = f"{_some(self.triangles, 'triangle')}"
        wrong = "; ".join(flaw.text for flaw in self.flaws if flaw.kind != "canonical")
        if wrong:
            first = next(f.first[0].text for f in self.flaws if f.first) if self._told() else ""
            return f"not valid: {wrong}" + (f"; first: {first}" if first else "")
        said = f"valid: these {said} are a Delaunay triangulation of {_some(self.rows, 'row')}"
        if self.canonical:
            return said.replace("are a Delaunay", "are the canonical Delaunay")
        return f"{said}; not canonical: {self.flaws[0].text}"

    def _told(self) -> bool:
        return any(flaw.first for flaw in self.flaws)

    def as_dict(self) -> dict[str, Any]:
        """Give all that is known as plain values, for JSON.

        Returns
        -------
        dict
            Numbers, texts, lists and dicts.

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
            "flaws": [asdict(flaw) for flaw in self.flaws],
        }

    def to_json(self) -> str:
        """Write the certificate as JSON.

        Returns
        -------
        str
            A JSON object; coordinates name their doubles exactly, and those that are not finite are
            texts.

        Examples
        --------
        >>> import liftmesh
        >>> '"valid": true' in liftmesh.verify([[0, 0], [1, 0], [0, 1]], [[0, 1, 2]]).to_json()
        True
        """
        return json.dumps(_named(self.as_dict()), indent=2, allow_nan=False) + "\n"


def _named(value: Any) -> Any:
    """Give numbers that JSON does not have as texts."""
    if isinstance(value, dict):
        return {key: _named(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_named(inner) for inner in value]
    if isinstance(value, float) and not abs(value) < float("inf"):
        return repr(value)
    return value


def _some(count: int, name: str) -> str:
    return f"{count:,} {name}" + ("" if count == 1 else "s")
