"""Coordinates in another coordinate reference system, by pyproj, which only this needs.

Nothing is approximated in silence: a transformation without its grid is refused; what operation was
taken is said, with its accuracy and the better one whose grid is missing; heights keep their
system, are converted, or are named in the target.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from liftmesh._typing import Floats
from liftmesh.base.options import shown
from liftmesh.crs.description import has_grids, look_up, oldest_wkt
from liftmesh.errors import InputError, Option
from liftmesh.optional import load


class TransformationError(InputError):
    """Nothing transforms coordinates, or the target has no place for some: which ones."""

    place: tuple[float, ...] | None = None


@dataclass(frozen=True, slots=True)
class Operation:
    """How coordinates are transformed: by what of pyproj, and what is said of it."""

    change: Any
    keeps_heights: bool
    # The "operation" as PROJ names it, and its "accuracy" in metres, or None; if one that is more
    # accurate lacks its grid, "better", its name, with "better_accuracy" and "grid", the file.
    told: dict[str, Any]


def transform(
    points: Floats, crs: str | None, target: str, chosen: dict[str, Operation] | None = None
) -> tuple[Floats, dict[str, Any]]:
    """Transform coordinates, x before y whatever the systems say; `chosen` serves a whole file."""
    # The operation is that for the place of the first row, so there is no step among rows.
    if crs is None:
        raise InputError(
            f"{Option('dst_crs', ...)} needs the coordinate system of the points, which is not "
            f"stated: read them with {Option('src_crs', ...)}"
        )
    pyproj = load("pyproj", extra="terrain")
    kept = {} if chosen is None else chosen
    with _offline(pyproj):
        operation = kept.get(crs) or _operation(pyproj, points, crs, target)
    if len(points):  # no rows have no place
        kept[crs] = operation
    try:
        with _offline(pyproj):
            columns = operation.change.transform(*points.astype(np.float64).T)
        moved = np.stack(columns, axis=1)
    except pyproj.exceptions.ProjError as error:
        raise _impossible(target, (), operation.keeps_heights) from error
    moved[:, 2] = points[:, 2] if operation.keeps_heights else moved[:, 2]
    lost = np.isfinite(points).all(axis=1) & ~np.isfinite(moved).all(axis=1)
    if lost.any():
        row = int(np.argmax(lost))
        place = tuple(points[row].tolist())
        lacking = TransformationError(
            f"row {row}, {place}, has no place in {shown(target)}: give another "
            f"{Option('dst_crs', ...)}"
        )
        lacking.place = place
        raise lacking
    return moved, operation.told


def transformation_text(told: Mapping[str, Any]) -> str:
    """Say how coordinates were transformed."""
    accuracy = told["accuracy"]
    known = "not known" if accuracy is None else f"{accuracy:g} m"
    text = f"transformed by {told['operation']} (accuracy {known})"
    if "better" not in told:
        return text
    better = f"{told['better']} ({told['better_accuracy']:g} m)"
    return f"{text}; {better} needs the grid {told['grid']}, which is not installed"


def common_transformation(parts: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Return how the parts of one cloud were transformed, at the accuracy of the worst of them."""
    by_operation = {each["operation"]: each for each in parts if each}
    if len(by_operation) < 2:
        return dict(next(iter(by_operation.values()), {}))
    accuracies = [each["accuracy"] for each in by_operation.values()]
    worst = None if None in accuracies else max(accuracies)
    return {"operation": ", others by ".join(by_operation), "accuracy": worst}


def _operation(pyproj: Any, points: Floats, crs: str, target: str) -> Operation:
    """Choose the most accurate operation that is installed, and say which would be better."""
    systems = [look_up(crs), look_up(target)]
    heights = [_vertical(each) for each in systems]
    is_shared = None not in heights and heights[0].equals(heights[1], ignore_axis_order=True)
    is_planar = is_shared or len(systems[1].axis_info) < 3
    area = _place(pyproj, points, systems[0])
    if is_shared:  # then a change of the plane's datum asks for no grid of heights
        systems = [each.sub_crs_list[0] for each in systems]
    else:
        _check_grids(crs, target)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # what is not installed is said below
        group = pyproj.transformer.TransformerGroup(
            *systems, always_xy=True, allow_ballpark=False, area_of_interest=area
        )
    lacking = sorted(group.unavailable_operations, key=_error)
    if not group.transformers:
        raise _impossible(target, lacking, is_planar)
    change = min(group.transformers, key=_error)
    told = {"operation": _named(change.description), "accuracy": _known(change)}
    if lacking and _error(lacking[0]) < _error(change):
        told |= {"better": _named(lacking[0].name), "better_accuracy": _known(lacking[0])}
        told["grid"] = ", ".join(_grids(lacking[0]))
    return Operation(change, is_shared, told)


def _place(pyproj: Any, points: Floats, system: Any) -> Any:
    """Return where the first finite row is, in degrees; None if that is not known."""
    first = np.argmax(np.isfinite(points).all(axis=1)) if len(points) else 0
    try:
        change = pyproj.Transformer.from_crs(system, "EPSG:4326", always_xy=True)
        x, y, _ = change.transform(*points[first : first + 1].astype(np.float64).T)
        return pyproj.aoi.AreaOfInterest(x[0], y[0], x[0], y[0])
    except (pyproj.exceptions.ProjError, IndexError, ValueError):
        return None


def _error(operation: Any) -> float:
    """Return the accuracy in metres, or infinity."""
    known = _known(operation)
    return math.inf if known is None else known


def _known(operation: Any) -> float | None:
    accuracy = operation.accuracy
    return None if accuracy is None or accuracy < 0 else float(accuracy)


def _named(text: str) -> str:
    """Return the name of an operation, without what concerns no value."""
    steps = [each for each in text.split(" + ") if not each.startswith("axis order change")]
    return " + ".join(steps) or text


def _grids(operation: Any) -> list[str]:
    return [each.short_name for each in operation.grids if not each.available]


def _impossible(target: str, lacking: Sequence[Any], is_planar: bool) -> TransformationError:
    """Say that nothing transforms the rows, and what helps: of the plane alone, other systems."""
    files = dict.fromkeys(name for each in lacking for name in _grids(each))
    needed = f" ({', '.join(files)})" if files else ""
    remedy = "give" if is_planar else "give the system without heights, or"
    return TransformationError(
        f"{Option('dst_crs')} is {shown(target)}: there is no exact transformation where the rows "
        f"are, or it needs a grid that is not installed{needed}: {remedy} another one of the file "
        f"with {Option('src_crs', ...)}"
    )


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
            f"text names is opened: name their system with {Option('src_crs', ...)}, such as "
            "EPSG:26910+5703"
        )


def with_heights(crs: str | None, target: str) -> str:
    """Return a target with heights: the source's, if it states none itself."""
    if crs is None:
        return target
    source, plane = look_up(crs), look_up(target)
    if len(plane.axis_info) != 2 or len(source.axis_info) != 3:
        return target
    vertical = _vertical(source)
    if vertical is None:  # heights above the ellipsoid, or geocentric
        return str(plane.to_3d().to_wkt("WKT2_2019"))
    numbers = [each.to_authority(min_confidence=100) for each in (plane, vertical)]
    if all(each and each[0] == "EPSG" for each in numbers):
        return f"EPSG:{numbers[0][1]}+{numbers[1][1]}"
    name = f"{plane.name} + {vertical.name}"
    compound = load("pyproj.crs", extra="terrain").CompoundCRS
    return oldest_wkt(compound(name=name, components=[plane, vertical]))


def _vertical(system: Any) -> Any:
    """Return the system of heights of a compound one, of pyproj; None of others."""
    return system.sub_crs_list[-1] if system.is_compound else None
