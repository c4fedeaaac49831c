"""Coordinates in another coordinate reference system, by pyproj, which only this needs.

Nothing is approximated in silence: a transformation without its grid is refused, and heights keep
their system, are converted, or are named in the target.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from liftmesh._typing import Floats
from liftmesh.choices import shown
from liftmesh.crs import looked_up
from liftmesh.errors import InputError
from liftmesh.optional import load
from liftmesh.wkt import has_grids


def transformed(points: Floats, crs: str | None, target: str) -> Floats:
    """Transform coordinates to another system, by pyproj.

    Parameters
    ----------
    points : (n, 3) ndarray
        Coordinates, x before y whatever the system says.
    crs : str, optional
        Their system.
    target : str
        The other system: WKT or ``EPSG:n``.

    Returns
    -------
    (n, 3) ndarray of float64
        The coordinates, x before y; heights of the same vertical system as they are.

    Raises
    ------
    InputError
        A system is unknown or missing, there is no transformation, or a row has no place there.
    MissingDependencyError
        pyproj is not installed.

    Examples
    --------
    >>> transformed(np.array([[9.0, 48.0, 5.0]]), "EPSG:4326", "EPSG:25832").round().tolist()
    [[500000.0, 5316300.0, 5.0]]
    """
    if crs is None:
        raise InputError(
            "to_crs= needs the coordinate system of the points, which is not stated: read them "
            "with crs="
        )
    pyproj = load("pyproj", extra="terrain")
    systems = [looked_up(pyproj, each) for each in (crs, target)]
    heights = [_vertical(each) for each in systems]
    is_shared = None not in heights and heights[0].equals(heights[1], ignore_axis_order=True)
    if is_shared:  # then a change of the plane's datum asks for no grid of heights
        systems = [each.sub_crs_list[0] for each in systems]
    else:
        _check_grids(crs, target)
    try:
        with _offline(pyproj):
            change = pyproj.Transformer.from_crs(*systems, always_xy=True, allow_ballpark=False)
            found = np.stack(change.transform(*points.astype(np.float64).T), axis=1)
        found[:, 2] = points[:, 2] if is_shared else found[:, 2]
    except pyproj.exceptions.ProjError as error:
        raise InputError(
            f"to_crs={shown(target)}: there is no exact transformation, or it needs a grid that is "
            "not installed: give the system without heights, or another one of the file with crs="
        ) from error
    lost = np.isfinite(points).all(axis=1) & ~np.isfinite(found).all(axis=1)
    if lost.any():
        row = int(np.argmax(lost))
        raise InputError(
            f"row {row}, {tuple(points[row].tolist())}, has no place in {shown(target)}: give "
            "another to_crs="
        )
    return found


@contextmanager
def _offline(pyproj: Any) -> Iterator[None]:
    """Keep PROJ from fetching grids, even if PROJ_NETWORK allows it; the setting is restored."""
    was = pyproj.network.is_network_enabled()
    pyproj.network.set_network_enabled(active=False)
    try:
        yield
    finally:
        pyproj.network.set_network_enabled(active=was)


def _check_grids(*systems: str) -> None:
    """Raise for a system whose heights are defined by the file of a grid."""
    for each in filter(has_grids, systems):
        raise InputError(
            f"the heights of {shown(each)} are those of a grid (PROJ4_GRIDS), and no file that a "
            "text names is opened: name their system with crs=, such as EPSG:26910+5703"
        )


def with_heights(crs: str | None, target: str) -> str:
    """Return a target that says what heights are: those of the source, if it says nothing itself.

    Parameters
    ----------
    crs : str, optional
        The system of the points.
    target : str
        The system that they are to have, perhaps of the plane alone.

    Returns
    -------
    str
        The target, compound with the system of heights of the source, if it has any.

    Raises
    ------
    InputError
        A system is unknown.
    MissingDependencyError
        pyproj is not installed.

    Examples
    --------
    >>> with_heights("EPSG:2225+6360", "EPSG:26910"), with_heights("EPSG:2225", "EPSG:26910")
    ('EPSG:26910+6360', 'EPSG:26910')
    """
    if crs is None:
        return target
    pyproj = load("pyproj", extra="terrain")
    source, plane = (looked_up(pyproj, each) for each in (crs, target))
    if len(plane.axis_info) != 2 or len(source.axis_info) != 3:
        return target
    vertical = _vertical(source)
    if vertical is None:  # heights above the ellipsoid, or geocentric
        return str(plane.to_3d().to_wkt("WKT2_2019"))
    numbers = [each.to_authority(min_confidence=100) for each in (plane, vertical)]
    if all(each and each[0] == "EPSG" for each in numbers):
        return f"EPSG:{numbers[0][1]}+{numbers[1][1]}"
    name = f"{plane.name} + {vertical.name}"
    both = pyproj.crs.CompoundCRS(name=name, components=[plane, vertical])
    try:
        return str(both.to_wkt("WKT1_GDAL"))
    except pyproj.exceptions.CRSError:
        return str(both.to_wkt("WKT2_2019"))


def _vertical(system: Any) -> Any:
    """Return the system of heights of a compound one, of pyproj; None of others."""
    return system.sub_crs_list[-1] if system.is_compound else None
