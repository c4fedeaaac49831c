"""The options of Qhull: which of them leave an exact triangulation as it is.

Most control how Qhull deals with its rounding errors, or what it prints. An exact triangulation
needs none of them, so they have no effect. The others move, scale, rotate or leave out points, or
choose other triangles.
"""

from __future__ import annotations

import re

from liftmesh.errors import InputError

_HARMLESS = re.compile(
    r"d|Qt"  # a Delaunay triangulation, in triangles: SciPy's own
    r"|Qbb|Qz|Qs|Qf|Qr|Qa"  # how the hull is built, and the lift scaled for that
    r"|Qc|Qi"  # rows that are no vertex are listed in any case
    r"|Qx|Qv|Q[0-9]|Q1[0-5]|C-0"  # how facets that rounding spoilt are merged
    r"|Qw|Pp|Po|Ts|Tv|Tz|[finopsmx]|F\w"  # warnings, checks and printed output
)
_JOGGLES = re.compile(r"QJ.*|R\d.*")


_OF_RESULT = {  # what there is instead, and where rows at one position are listed
    "Delaunay": ("triangulation", "coplanar"),
    "Voronoi": ("diagram", "duplicates"),
}


def check_qhull_options(options: str | None, kind: str = "Delaunay") -> None:
    """Raise if options of Qhull would change a triangulation."""
    if options is not None and not isinstance(options, str):
        raise InputError(
            f"qhull_options are a {type(options).__name__}: give a string, such as 'Qbb Qc Qz'"
        )
    for option in (options or "").split():
        if not _HARMLESS.fullmatch(option):
            raise InputError(f"qhull_options: {option!r} {_reason(option, kind)}")


def _reason(option: str, kind: str) -> str:
    result, listed = _OF_RESULT[kind]
    if _JOGGLES.fullmatch(option):
        return (
            f"moves the points at random, for which an exact {result} has no need: leave it "
            f"out (rows at one position stay duplicates, listed in `{listed}`)"
        )
    if option == "Qu":
        return "is furthest_site=True here"
    return (
        f"may give another {result} than that of the points: leave it out, or use "
        f"scipy.spatial.{kind}"
    )
