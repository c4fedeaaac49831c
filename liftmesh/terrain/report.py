"""`Report`: what became of every row of a cloud that was triangulated."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Rows
from liftmesh.base.frozen import FrozenResult
from liftmesh.base.options import counted
from liftmesh.crs.transformation import transformation_text
from liftmesh.io.formats.text.columns import coordinates_sentence
from liftmesh.io.metadata import Provenance
from liftmesh.io.read import classes_of
from liftmesh.io.selection import selection_sentence

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud


@dataclass(frozen=True, slots=True, eq=False)
class Report(FrozenResult):
    """Summary of the use of every input row.

    ``n_rows`` is the sum of ``n_used``, ``n_duplicates``, ``n_overhangs``, ``n_skipped``,
    ``n_hidden`` and ``n_unused``.

    Parameters
    ----------
    n_rows : int
        Rows of the input.
    n_used : int
        Rows that are vertices of faces.
    n_duplicates : int
        Rows not used because a used row has the same position and height in the input.
    n_overhangs : int
        Rows not used because a used row has the same planar position at another height.
    n_skipped : int
        Rows not used because they are not finite.
    n_triangles : int
        Number of faces.
    policy : str
        The option ``on_duplicate``: which row is used at a shared planar position.
    seconds : mapping of str to float
        Duration of each stage.
    left_out : (k,) ndarray of int32
        The rows in no face, increasing: duplicates, overhangs, skipped and hidden rows.
    representatives : (k,) ndarray of int32
        For each row in ``left_out``, the used row at the same planar position; -1 for skipped and
        hidden rows.
    columns : mapping of str to str
        Of a table, the names of the columns that are x, y and z, colours and normals; else empty.
    color_depth : int, optional
        Of integer colours that were given in more than 8 bits, the bits per channel that their
        numbers were taken to mean; see `Cloud`.
    n_hidden : int
        Rows not used because weights or radii hide them.
    n_unused : int
        Rows in no face of the mesh that `as_surface` was given.
    classes : mapping of int to int
        Rows by class, as lidar has them; empty if the cloud has no classes.
    selection : mapping of str to int
        Of the files, how many rows were selected, and how many were left out by which condition, as
        in ``metadata["selection"]``; empty if all were taken.
    transformation : mapping
        How ``dst_crs=`` transformed the coordinates of a file: "operation", "accuracy" in metres or
        None, and a "better" one with its "grid", if that is missing; empty if they were not.
    lines : mapping of str to int
        Of a surface that was made with lines: the "rows" that these have become, which are the
        last ones; the "rows_from_around", whose heights are those of the surface without them, and
        the "rows_at_crossings" among them; the "rows_at_other_heights", left out since another
        line has a corner there at another height, by the policy; the "edges" that lines are; and
        the "flat_triangles" whose corners are at one height, as between contour lines; and the
        "lines_beyond", soft breaklines and rings of holes with no part over the faces. Else empty.

    See Also
    --------
    triangulate : Makes a report on every surface.
    Surface.report : The report of a surface.

    Examples
    --------
    >>> import liftmesh
    >>> cloud = [[0, 0, 5], [1, 0, 6], [0, 1, 7], [1, 0, 9], [1, 0, 6]]
    >>> report = liftmesh.triangulate(cloud, on_duplicate="highest").report
    >>> report.n_rows, report.n_used, report.n_duplicates, report.n_overhangs, report.n_skipped
    (5, 3, 0, 2, 0)
    >>> report.left_out, report.representatives
    (array([1, 4], dtype=int32), array([3, 3], dtype=int32))
    """

    n_rows: int
    n_used: int
    n_duplicates: int
    n_overhangs: int
    n_skipped: int
    n_triangles: int
    policy: str
    seconds: Mapping[str, float] = field(repr=False)
    left_out: Rows = field(repr=False)
    representatives: Rows = field(repr=False)
    columns: Mapping[str, str] = field(default_factory=dict, repr=False)
    color_depth: int | None = field(default=None, repr=False)
    n_hidden: int = 0
    n_unused: int = 0
    classes: Mapping[int, int] = field(default_factory=dict, repr=False)
    selection: Mapping[str, int] = field(default_factory=dict, repr=False)
    transformation: Mapping[str, Any] = field(default_factory=dict, repr=False)
    lines: Mapping[str, int] = field(default_factory=dict, repr=False)

    def __str__(self) -> str:
        stages = ", ".join(f"{stage} {seconds:.3f}" for stage, seconds in self.seconds.items())
        return (
            f"{counted(self.n_rows, 'row')}, {self.n_used:,} of them used in "
            f"{counted(self.n_triangles, 'triangle')}. "
            f"Left out: {self._omissions()}. {self._columns()}{self._classes()}{self._colors()}"
            f"{self._change()}{self._lines()}"
            f"{sum(self.seconds.values()):.3f} s: {stages}."
        ).removesuffix(" 0.000 s: .")

    def _columns(self) -> str:
        said = coordinates_sentence(self.columns)
        return f"Columns: {said}. " if said else ""

    def _classes(self) -> str:
        said = ", ".join(f"{key} ({count:,})" for key, count in self.classes.items())
        chosen = f"Read: {selection_sentence(self.selection)}. " if self.selection else ""
        return chosen + (f"Rows by class: {said}. " if said else "")

    def _change(self) -> str:
        said = transformation_text(self.transformation) if self.transformation else ""
        return f"{said[:1].upper()}{said[1:]}. " if said else ""

    def _lines(self) -> str:
        if not self.lines:
            return ""
        said = [counted(self.lines["rows"], "row") + f" in {counted(self.lines['edges'], 'edge')}"]
        if around := self.lines["rows_from_around"]:
            said.append(f"{around:,} with the height of the surface around")
        if crossings := self.lines["rows_at_crossings"]:
            said.append(f"{crossings:,} where lines cross")
        if others := self.lines["rows_at_other_heights"]:
            said.append(f"{others:,} left out, as lines meet there at other heights")
        if flat := self.lines["flat_triangles"]:
            said.append(counted(flat, "flat triangle"))
        if beyond := self.lines["lines_beyond"]:
            said.append(f"{counted(beyond, 'line')} beyond all faces")
        return f"Lines: {', '.join(said)}. "

    def _colors(self) -> str:
        depth = self.color_depth
        return "" if depth is None else f"Integer colours taken as {depth}-bit. "

    def _omissions(self) -> str:
        parts = []
        if self.n_duplicates:
            parts.append(counted(self.n_duplicates, "duplicate"))
        if self.n_overhangs:
            parts.append(f"{counted(self.n_overhangs, 'overhang')} (policy {self.policy!r})")
        if self.n_skipped:
            parts.append(f"{counted(self.n_skipped, 'row')} skipped")
        if self.n_hidden:
            parts.append(f"{counted(self.n_hidden, 'row')} hidden")
        if self.n_unused:
            parts.append(f"{counted(self.n_unused, 'row')} in no face")
        return ", ".join(parts) or "none"


def report_on(cloud: Cloud, **fields: Any) -> Report:
    """Make a report with what a cloud says of its classes, colours and coordinates."""
    known = {
        "n_rows": len(cloud),
        "color_depth": cloud.color_depth,
        "classes": classes_of(cloud.attributes),
        "selection": Provenance(cloud.metadata).selection,
        "transformation": Provenance(cloud.metadata).transformation,
    }
    return Report(**{**known, **fields})


def bare_report(rows: int, faces: int) -> Report:
    """Make a report of points all of which are vertices."""
    none = np.empty(0, np.int32)
    fields: dict[str, Any] = {"left_out": none, "representatives": none}
    return Report(rows, rows, 0, 0, 0, faces, "error", {}, **fields)
