"""Notes on a cloud that was read: rows, columns, coordinate system, parts, lidar."""

from __future__ import annotations

import importlib.util
from collections.abc import Mapping, Sequence
from datetime import date, datetime, timedelta
from typing import TYPE_CHECKING, Any

from liftmesh.cli.wording import worded

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.io.metadata import Provenance
    from liftmesh.terrain.surface import Surface

_MOST_LISTED = 8
_LONGEST = 80  # characters of each, or of a coordinate system that is not understood

# ASPRS, LAS Specification 1.4-R15, tables 9 and 17.
CLASSES = {
    0: "never classified", 1: "unclassified", 2: "ground", 3: "low vegetation",
    4: "medium vegetation", 5: "high vegetation", 6: "building", 7: "low noise", 8: "key points",
    9: "water", 10: "rail", 11: "road", 12: "overlap", 13: "wire guard", 14: "wire", 15: "tower",
    16: "wire connector", 17: "bridge deck", 18: "high noise", 19: "overhead structure",
    20: "ignored ground", 21: "snow", 22: "excluded",
}  # fmt: skip
FLAGS = ("withheld", "synthetic", "overlap", "key_point")
_HEADER = 227  # bytes
_WEEK = 604_800  # seconds
_GPS, _ADJUSTED = datetime(1980, 1, 6), 1e9
_OVERLAP = 12  # the class of overlap, in files without a flag for it


def provenance_of(cloud: Cloud | Surface) -> Provenance:
    """Return what is known of where a cloud or a surface comes from."""
    from liftmesh.io.metadata import Provenance

    return Provenance(cloud.metadata)


def cloud_notes(cloud: Cloud, *, is_transformed: bool = False) -> tuple[str, ...]:
    """Return what is worth knowing about how a file was read."""
    about_system = _about_system(cloud, is_transformed=is_transformed)
    first = (*_about_rows(cloud), *map(worded, about_system))
    known = provenance_of(cloud)
    names = known.columns
    if not names:
        is_told = not {"raster", "e57"}.isdisjoint(cloud.metadata)
        return (*first, *known.notes) if is_told else first
    from liftmesh.io.formats.text.columns import coordinates_sentence

    said = coordinates_sentence(names)
    told = map(worded, known.notes)
    return (*first, *([said] if said else []), *told)


def _about_rows(cloud: Cloud) -> tuple[str, ...]:
    """Say which rows were selected, and which of lidar are among them."""
    counts = counts_of(cloud)
    if counts is None:
        return ()
    from liftmesh.io.selection import selection_sentence

    said = worded(selection_sentence(counts))
    return tuple(filter(None, (said, _flagged(cloud))))


def counts_of(cloud: Cloud) -> dict[str, int] | None:
    """Return the counts of rows that were selected and left out; None if all were read."""
    return provenance_of(cloud).selection or None


def _about_system(cloud: Cloud, *, is_transformed: bool) -> tuple[str, ...]:
    """Say what most users do not want of a coordinate system, or that it is not understood."""
    from liftmesh.crs.description import crs_name, is_system
    from liftmesh.crs.transformation import transformation_text
    from liftmesh.crs.units import coordinate_warnings, system_of

    crs, system = cloud.crs, system_of(cloud)
    known = provenance_of(cloud)
    stated, told = known.stated_crs, known.transformation
    instead = "--src-crs says another system" if told else f"taken as {crs_name(crs)}"
    taken = [f"states {crs_name(stated)}; {instead}"] if stated is not None else []
    taken += [transformation_text(told)] if told else []
    if crs is None or system is not None:
        return (*taken, *coordinate_warnings(system, is_transformed=is_transformed))
    text = f"the coordinate system {crs[:_LONGEST]!r} is not understood: its units are not known"
    is_number = is_system(crs) and importlib.util.find_spec("pyproj") is None
    hint = " (pip install 'liftmesh[terrain]' looks up numbers)" if is_number else ""
    return (*taken, f"{text}{hint}")


def parts_not_read(cloud: Cloud) -> tuple[str, ...]:
    """Return the parts of a file that its reader named as not read, with their counts."""
    return provenance_of(cloud).not_read


def listed(names: Sequence[str]) -> str:
    """List names for a message; a file can hold any number of them."""
    from liftmesh.io.text_tables import shortened

    shown = ", ".join(shortened(each, _LONGEST) for each in names[:_MOST_LISTED])
    rest = len(names) - _MOST_LISTED
    return f"{shown} and {rest:,} more" if rest > 0 else shown


def provenance(held: Cloud | Surface) -> dict[str, Any]:
    """Return for JSON which classes the rows of a cloud or a surface are of, and their way here."""
    from liftmesh.io.read import classes_of

    told = provenance_of(held).transformation or None
    return {"classes": classes_of(held.attributes), "transformation": told}


def lidar_counts(cloud: Cloud) -> dict[str, Any]:
    """Count the classes, returns and flags of lidar; say when and by what the file was made."""
    import numpy as np

    from liftmesh.io.read import bytes_of, classes_of

    returns = cloud.attributes.get("return_number")
    counts = {"classes": classes_of(cloud.attributes)}
    counts |= {} if returns is None else {"returns": bytes_of(returns)}
    counted: dict[str, Any] = {key: each for key, each in counts.items() if each}
    counted |= _about_file(cloud)
    layout = provenance_of(cloud).las
    counted |= {key: layout[key] for key in ("scale", "copc") if key in layout}
    for name in FLAGS:
        values = cloud.attributes.get(name)
        if values is not None and values.dtype == np.uint8 and values.any():
            counted[name] = int(np.count_nonzero(values))
    return counted


def _about_file(cloud: Cloud) -> dict[str, Any]:
    """Return by which program and when a LAS file was made, and the times of its points."""
    import numpy as np

    header = provenance_of(cloud).las_records.get("header", b"")
    if len(header) < _HEADER:
        return {}
    facts: dict[str, Any] = {}
    text = header[58:90].partition(b"\0")[0].rstrip()
    if software := text.decode("ascii", "replace"):
        facts["software"] = software
    day, year = (int.from_bytes(header[k : k + 2], "little") for k in (90, 92))
    if 0 < day <= 366 and 1900 < year < 2200:
        facts["created"] = str(date(year, 1, 1) + timedelta(days=day - 1))
    times = cloud.attributes.get("gps_time")
    times = None if times is None else times[np.isfinite(times)]
    if times is not None and times.any():
        ends = float(times.min()), float(times.max())
        facts["gps_time"] = [*map(_as_date, ends)] if header[6] & 1 else list(ends)
    return facts


def _as_date(seconds: float) -> str | float:
    """Return adjusted GPS time as a date and time, without leap seconds; else the number."""
    try:
        moment = _GPS + timedelta(seconds=seconds + _ADJUSTED)
    except OverflowError:
        return seconds
    return moment.isoformat(" ", "seconds")


def lidar_lines(counted: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Describe the counts of lidar in lines of a table."""
    rows = []
    if classes := counted.get("classes"):
        words = (f"{k} {CLASSES.get(k, '')} {n:,}".replace("  ", " ") for k, n in classes.items())
        rows.append(("classes", ", ".join(words)))
    if returns := counted.get("returns"):
        rows.append(("returns", ", ".join(f"{k}: {n:,}" for k, n in returns.items())))
    if index := counted.get("copc"):
        rows.append(
            ("copc", f"{index['levels']} levels, spacing {index['spacing']:g} at the first")
        )
    if times := counted.get("gps_time"):
        unit = "" if isinstance(times[0], str) else "  (seconds of a week)"
        if unit and max(times) > _WEEK:
            unit = "  (stated as seconds of a week, which has only 604,800)"
        rows.append(("gps time", f"{times[0]} to {times[1]}{unit}"))
    if scale := counted.get("scale"):
        rows.append(("scale", ", ".join(f"{each:.6g}" for each in dict.fromkeys(scale))))
    said = [counted[key] for key in ("software", "created") if key in counted]
    rows += [("made by", ", ".join(said))] if said else []
    flags = [f"{name.replace('_', ' ')} {counted[name]:,}" for name in FLAGS if name in counted]
    return [*rows, *([("flags", ", ".join(flags))] if flags else [])]


def _flagged(cloud: Cloud) -> str:
    """Say which rows a surface keeps though a flag may speak against them; "" if there are none."""
    if not provenance_of(cloud).las:
        return ""
    counted = lidar_counts(cloud)
    has_flag = "overlap" in cloud.attributes
    overlap = counted.get("overlap", 0) if has_flag else counted.get("classes", {}).get(_OVERLAP, 0)
    counts = {"synthetic": counted.get("synthetic", 0), "in the overlap of flight lines": overlap}
    words = [f"{count:,} {name}" for name, count in counts.items() if count]
    return f"among them {' and '.join(words)}" if words else ""
