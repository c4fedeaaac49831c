"""Coordinate systems in the comments of files whose format has no field for them.

The comment is ``crs`` and a JSON string, which is one line of ASCII for any text:
``crs "EPSG:25832"``.
"""

from __future__ import annotations

import json
from collections.abc import Iterable

_KEYWORD = "crs "


def crs_comment(crs: str | None) -> list[str]:
    """Return the comment for a coordinate system, if there is one.

    Parameters
    ----------
    crs : str or None
        The coordinate system.

    Returns
    -------
    list of str
        At most one comment, without the comment character.

    Examples
    --------
    >>> crs_comment("EPSG:25832")
    ['crs "EPSG:25832"']
    """
    return [] if crs is None else [_KEYWORD + json.dumps(crs)]


def stated_crs(comments: Iterable[str]) -> str | None:
    """Find a coordinate system in comments.

    Parameters
    ----------
    comments : iterable of str
        The comments of a file, without the comment characters.

    Returns
    -------
    str or None
        The first coordinate system; similar comments are ignored.

    Examples
    --------
    >>> stated_crs(["liftmesh", 'crs "EPSG:25832"'])
    'EPSG:25832'
    """
    found = (_crs(comment) for comment in comments if comment.startswith(_KEYWORD))
    return next((crs for crs in found if crs is not None), None)


def _crs(comment: str) -> str | None:
    try:
        crs = json.loads(comment.removeprefix(_KEYWORD))
    except (ValueError, RecursionError):
        return None
    return crs if isinstance(crs, str) and crs else None
