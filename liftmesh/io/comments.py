"""The coordinate system of a file, where only comments have room for it.

It stands as ``crs`` and a JSON string, which fits one line of ASCII whatever the text holds:
``crs "EPSG:25832"``.
"""

from __future__ import annotations

import json
from collections.abc import Iterable

_KEYWORD = "crs "


def crs_comment(crs: str | None) -> list[str]:
    """Give the comment that states a coordinate system, if there is one.

    Parameters
    ----------
    crs : str or None
        The coordinate system.

    Returns
    -------
    list of str
        One comment or none, without the mark that begins comments.

    Examples
    --------
    >>> crs_comment("EPSG:25832")
    ['crs "EPSG:25832"']
    """
    return [] if crs is None else [_KEYWORD + json.dumps(crs)]


def stated_crs(comments: Iterable[str]) -> str | None:
    """Find the coordinate system that comments state.

    Parameters
    ----------
    comments : iterable of str
        The comments of a file, without the marks that begin them.

    Returns
    -------
    str or None
        The first that is stated; None for comments that only look alike.

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
