"""What the values of lidar say of a cloud: classes, returns and flags, counted."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import date, datetime, timedelta
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.terrain.surface import Surface

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


def counted(cloud: Cloud) -> dict[str, Any]:
    """Count classes, returns and flags."""
    import numpy as np  # noqa: PLC0415 - help and --version do without

    from liftmesh.io.surface_rows import bytes_of, classes_of  # noqa: PLC0415 - as above

    returns = cloud.attributes.get("return_number")
    counts = {"classes": classes_of(cloud.attributes)}
    counts |= {} if returns is None else {"returns": bytes_of(returns)}
    found: dict[str, Any] = {key: each for key, each in counts.items() if each}
    found |= _about_file(cloud)
    layout = cloud.metadata.get("las")
    if isinstance(layout, dict):
        found |= {key: layout[key] for key in ("scale", "copc") if key in layout}
    for name in FLAGS:
        values = cloud.attributes.get(name)
        if values is not None and values.dtype == np.uint8 and values.any():
            found[name] = int(np.count_nonzero(values))
    return found


def _about_file(cloud: Cloud) -> dict[str, Any]:
    """Return by which program and when a LAS file was made, and the times of its points."""
    import numpy as np  # noqa: PLC0415 - as above

    records = cloud.metadata.get("las_records")
    header = records.get("header", b"") if isinstance(records, Mapping) else b""
    if len(header) < _HEADER:
        return {}
    found: dict[str, Any] = {}
    text = header[58:90].partition(b"\0")[0].rstrip()
    if software := text.decode("ascii", "replace"):
        found["software"] = software
    day, year = (int.from_bytes(header[k : k + 2], "little") for k in (90, 92))
    if 0 < day <= 366 and 1900 < year < 2200:
        found["created"] = str(date(year, 1, 1) + timedelta(days=day - 1))
    times = cloud.attributes.get("gps_time")
    times = None if times is None else times[np.isfinite(times)]
    if times is not None and times.any():
        ends = float(times.min()), float(times.max())
        found["gps_time"] = [*map(_as_date, ends)] if header[6] & 1 else list(ends)
    return found


def _as_date(seconds: float) -> str | float:
    """Return adjusted GPS time as a date and time, without leap seconds; else the number."""
    try:
        found = _GPS + timedelta(seconds=seconds + _ADJUSTED)
    except OverflowError:
        return seconds
    return found.isoformat(" ", "seconds")


def provenance(held: Cloud | Surface) -> dict[str, Any]:
    """Return for JSON which classes the rows of a cloud or a surface are of, and their way here."""
    from liftmesh.crs.transformation import told_of  # noqa: PLC0415 - as above
    from liftmesh.io.surface_rows import classes_of  # noqa: PLC0415 - help and --version do without

    told = told_of(held.metadata) or None
    return {"classes": classes_of(held.attributes), "transformation": told}


def lines(found: dict[str, Any]) -> list[tuple[str, str]]:
    """Describe the counts in lines of a table."""
    rows = []
    if classes := found.get("classes"):
        words = (f"{k} {CLASSES.get(k, '')} {n:,}".replace("  ", " ") for k, n in classes.items())
        rows.append(("classes", ", ".join(words)))
    if returns := found.get("returns"):
        rows.append(("returns", ", ".join(f"{k}: {n:,}" for k, n in returns.items())))
    if index := found.get("copc"):
        rows.append(
            ("copc", f"{index['levels']} levels, spacing {index['spacing']:g} at the first")
        )
    if times := found.get("gps_time"):
        unit = "" if isinstance(times[0], str) else "  (seconds of a week)"
        if unit and max(times) > _WEEK:
            unit = "  (stated as seconds of a week, which has only 604,800)"
        rows.append(("gps time", f"{times[0]} to {times[1]}{unit}"))
    if scale := found.get("scale"):
        rows.append(("scale", ", ".join(f"{each:.6g}" for each in dict.fromkeys(scale))))
    said = [found[key] for key in ("software", "created") if key in found]
    rows += [("made by", ", ".join(said))] if said else []
    flags = [f"{name.replace('_', ' ')} {found[name]:,}" for name in FLAGS if name in found]
    return [*rows, *([("flags", ", ".join(flags))] if flags else [])]


def flagged(cloud: Cloud) -> str:
    """Say which rows a surface keeps though a flag may speak against them; "" if there are none."""
    if "las" not in cloud.metadata:
        return ""
    found = counted(cloud)
    has_flag = "overlap" in cloud.attributes
    overlap = found.get("overlap", 0) if has_flag else found.get("classes", {}).get(_OVERLAP, 0)
    counts = {"synthetic": found.get("synthetic", 0), "in the overlap of flight lines": overlap}
    words = [f"{count:,} {name}" for name, count in counts.items() if count]
    return f"among them {' and '.join(words)}" if words else ""
