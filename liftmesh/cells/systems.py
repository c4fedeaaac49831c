"""The coordinate system of cells, as text: that of their points, or of their domain.

Both may know theirs, as clouds and objects of geopandas do; then they must agree in the plane.
"""

from __future__ import annotations

from typing import Any

from liftmesh.choices import shown
from liftmesh.errors import InputError
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
        A number, text or system of pyproj.

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
    pyproj = load("pyproj", extra="shapes")
    try:
        return text_of(pyproj.CRS.from_user_input(crs))
    except pyproj.exceptions.CRSError as error:
        raise InputError(
            f"crs is {shown(crs)}, which pyproj does not know: give one such as 'EPSG:25832'"
        ) from error


def common_system(
    cloud: str | None, domain: str | None, names: tuple[str, str] = ("the points", "the domain")
) -> str | None:
    """Return the coordinate system of cells: that of the points or that of the domain.

    Parameters
    ----------
    cloud, domain : str, optional
        WKT or ``EPSG:n``, if known.
    names : tuple of str
        What has them, for the error.

    Returns
    -------
    str or None
        That of the points, if it is known.

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
    if cloud is None or domain is None or cloud == domain:
        return domain if cloud is None else cloud
    pyproj = load("pyproj", extra="shapes")
    try:
        one, other = (_in_the_plane(pyproj.CRS.from_user_input(each)) for each in (cloud, domain))
    except pyproj.exceptions.CRSError:
        return cloud  # a local system, of which nobody knows what it equals
    if not one.equals(other, ignore_axis_order=True):
        raise InputError(
            f"{names[0]} are in {one.name!r}, and {names[1]} in {other.name!r}: transform one of "
            "them to the system of the other"
        )
    return cloud


def _in_the_plane(system: Any) -> Any:
    """A coordinate system without heights."""
    plane = system.sub_crs_list[0] if system.is_compound else system
    return plane.to_2d()
