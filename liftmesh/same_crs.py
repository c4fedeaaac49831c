"""Whether coordinates are in one system: of clouds, surfaces, domains, polygons and files.

`Cloud.crs` is a text; objects of geopandas hold systems of pyproj. Texts may differ where the
systems are the same, so pyproj is asked. Nothing is known to differ without it but numbers.
"""

from __future__ import annotations

from typing import Any

from liftmesh.choices import shown
from liftmesh.crs import described, is_number, looked_up, urn_of
from liftmesh.errors import InputError, MissingDependencyError
from liftmesh.optional import load


def system_of(held: Any) -> str | None:
    """Return the coordinate system that an object says it is in.

    Parameters
    ----------
    held : object
        A cloud, the domain of cells, an object of geopandas, or anything else.

    Returns
    -------
    str or None
        WKT or ``EPSG:n``; None if it says nothing.

    Examples
    --------
    >>> import numpy as np
    >>> from liftmesh import Cloud
    >>> system_of(Cloud(np.zeros((1, 3)), crs="EPSG:25832"))
    'EPSG:25832'
    """
    crs = getattr(held, "crs", None)
    if crs is None or isinstance(crs, str):
        return crs
    return text_of(crs) if hasattr(crs, "to_authority") else None


def text_of(crs: Any) -> str:
    """Convert a coordinate system of pyproj to text.

    Parameters
    ----------
    crs : pyproj.CRS
        The system.

    Returns
    -------
    str
        Its number if it is one of EPSG, else WKT.

    Examples
    --------
    >>> import pyproj
    >>> text_of(pyproj.CRS(25832))
    'EPSG:25832'
    """
    authority = crs.to_authority(min_confidence=100)
    return ":".join(authority) if authority and authority[0] == "EPSG" else str(crs.to_wkt())


def given_system(crs: Any) -> str:
    """Convert what geopandas takes as a coordinate system to text.

    Parameters
    ----------
    crs : object
        A number, text, pair of authority and code, or system of pyproj.

    Returns
    -------
    str
        WKT or ``EPSG:n``.

    Raises
    ------
    InputError
        It is no system that pyproj knows.

    Examples
    --------
    >>> given_system(25832)
    'EPSG:25832'
    """
    text = crs.to_wkt() if hasattr(crs, "to_wkt") else crs
    if isinstance(crs, int):
        text = f"EPSG:{crs}"
    elif isinstance(crs, tuple):
        text = ":".join(map(str, crs))
    try:
        return text_of(looked_up(load("pyproj", extra="shapes"), text))
    except InputError as error:
        raise InputError(
            f"crs is {shown(crs)}, which pyproj does not know: give one such as 'EPSG:25832'"
        ) from error


def are_different(one: str | None, other: str | None) -> bool:
    """Whether two texts are known to mean different systems of the plane.

    Parameters
    ----------
    one, other : str, optional
        WKT or numbers.

    Returns
    -------
    bool
        False also if one says nothing, or is not understood.

    Examples
    --------
    >>> are_different("EPSG:25832", "epsg:25832"), are_different("EPSG:25832", None)
    (False, False)
    >>> are_different("EPSG:25832", "EPSG:4326")
    True
    """
    if one is None or other is None or urn_of(one) == urn_of(other):
        return False
    try:
        pyproj = load("pyproj", extra="terrain")
        planes = [looked_up(pyproj, each).to_2d() for each in (one, other)]
    except (MissingDependencyError, InputError):
        return all(is_number(each) for each in (one, other))
    first, second = (each.sub_crs_list[0] if each.is_compound else each for each in planes)
    return not first.equals(second, ignore_axis_order=True)


def plane_of(crs: str | None) -> str | None:
    """Return the system of x and y alone: what has no height is in none of heights.

    Parameters
    ----------
    crs : str, optional
        WKT or a number.

    Returns
    -------
    str or None
        The system without that of heights; the text itself if it states none.

    Raises
    ------
    InputError
        The system is unknown.
    MissingDependencyError
        It states heights, and pyproj is not installed.

    Examples
    --------
    >>> plane_of("EPSG:25832+7837"), plane_of("EPSG:4979"), plane_of("EPSG:25832")
    ('EPSG:25832', 'EPSG:4326', 'EPSG:25832')
    """
    system = described(crs)
    if crs is None or system is None or system.units[2] is None:
        return crs
    found = looked_up(load("pyproj", extra="terrain"), crs).to_2d()
    return text_of(found.sub_crs_list[0] if found.is_compound else found)


def adds_heights(one: str | None, other: str) -> bool:
    """Whether a system is another one of the plane, which says nothing of heights, with heights.

    Parameters
    ----------
    one : str, optional
        Of the plane, perhaps.
    other : str
        Perhaps the same with heights.

    Returns
    -------
    bool
        Also True if there is no first one.

    Examples
    --------
    >>> adds_heights("EPSG:25832", "EPSG:25832+7837"), adds_heights("EPSG:25832", "EPSG:25833+7837")
    (True, False)
    """
    if one is None:
        return True
    before, after = described(one), described(other)
    if before is None or after is None or are_different(one, other):
        return False
    return before.units[2] is None and after.units[2] is not None


def is_same(one: str | None, other: str | None) -> bool:
    """Whether two texts are of one coordinate system, as pyproj judges it if it is installed.

    Parameters
    ----------
    one, other : str, optional
        WKT or numbers.

    Returns
    -------
    bool
        False if they differ, or nobody knows.

    Examples
    --------
    >>> is_same("EPSG:25832", "EPSG:25832"), is_same("EPSG:25832", "EPSG:25833")
    (True, False)
    """
    if one == other:
        return True
    if one is None or other is None:
        return False
    try:
        pyproj = load("pyproj", extra="terrain")
        first, second = (looked_up(pyproj, each) for each in (one, other))
    except (MissingDependencyError, InputError):
        return False
    return bool(first.equals(second, ignore_axis_order=True))


def common_system(
    one: str | None, other: str | None, names: tuple[str, str] = ("the points", "the domain")
) -> str | None:
    """Return the coordinate system of two things that are used together.

    Parameters
    ----------
    one, other : str, optional
        WKT or ``EPSG:n``, if known.
    names : tuple of str
        What has them, for the error.

    Returns
    -------
    str or None
        The first, if it is known.

    Raises
    ------
    InputError
        Both are known, and differ in the plane.

    Examples
    --------
    >>> common_system(None, "EPSG:25832")
    'EPSG:25832'
    >>> common_system("EPSG:4326", "EPSG:25832")
    Traceback (most recent call last):
    liftmesh.errors.InputError: the points are in 'WGS 84', and the domain in 'ETRS89 / UTM ...
    """
    if not are_different(one, other):
        return other if one is None else one
    raise InputError(
        f"{names[0]} are in {_name(one)}, and {names[1]} in {_name(other)}: transform one of them "
        "to the system of the other"
    )


def _name(crs: str | None) -> str:
    system = described(crs)
    return shown(crs if system is None else system.name)
