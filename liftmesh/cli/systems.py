"""What is said on stderr of the coordinate system of a file."""

from __future__ import annotations

import importlib.util
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud

_LONGEST = 80  # characters of a system that is not understood


def notes(cloud: Cloud, *, is_transformed: bool = False) -> tuple[str, ...]:
    """Say what most users do not want of a coordinate system, or that it is not understood."""
    from liftmesh.crs.description import is_system, named, warnings_of  # noqa: PLC0415 - help does without
    from liftmesh.crs.transformation import sentence, told_of  # noqa: PLC0415 - as above
    from liftmesh.crs.units import system_of  # noqa: PLC0415 - as above

    crs, found = cloud.crs, system_of(cloud)
    stated = cloud.metadata.get("stated_crs")
    told = told_of(cloud.metadata)
    instead = "--from-crs says another system" if told else f"taken as {named(crs)}"
    taken = [f"states {named(stated)}; {instead}"] if isinstance(stated, str) else []
    taken += [sentence(told)] if told else []
    if crs is None or found is not None:
        words = "name a projected system with" if is_transformed else "transform them with"
        change = "transform them with to_crs=", f"{words} --to-crs"
        return (*taken, *(each.replace(*change) for each in warnings_of(found)))
    text = f"the coordinate system {crs[:_LONGEST]!r} is not understood: its units are not known"
    is_number = is_system(crs) and importlib.util.find_spec("pyproj") is None
    hint = " (pip install 'liftmesh[terrain]' looks up numbers)" if is_number else ""
    return (*taken, f"{text}{hint}")
