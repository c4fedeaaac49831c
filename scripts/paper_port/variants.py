"""The variants: single changes to a base program, and a few combinations."""

from __future__ import annotations

from dataclasses import dataclass

BASE = ("-O0",)
DETERMINANT = "-DPOSITION=DETERMINANT"


@dataclass(frozen=True)
class Variant:
    """One way of writing, compiling or feeding the program."""

    group: str
    name: str
    flags: tuple[str, ...]
    order: str = "as generated"


def at_both(group: str, name: str, *flags: str) -> list[Variant]:
    """Return a variant without and with optimisation."""
    return [Variant(group, f"{name}, {level}", (level, *flags)) for level in ("-O0", "-O2")]


VARIANTS = [
    Variant("compiler", "-O0", ("-O0",)),
    Variant("compiler", "-O1", ("-O1",)),
    Variant("compiler", "-O2", ("-O2",)),
    Variant("compiler", "-O3", ("-O3",)),
    Variant("compiler", "-O3 -march=native", ("-O3", "-march=native")),
    *at_both("position", "n.(p - p_l) > 0", "-DPOSITION=DIFFERENCE"),
    *at_both("position", "w_z* of Section 2, a division", "-DPOSITION=DIVISION"),
    *at_both("position", "function, by address", "-DPOSITION=CALL"),
    *at_both("position", "function, structs by value", "-DPOSITION=BY_VALUE"),
    *at_both("position", "function, signed distance", "-DPOSITION=DISTANCE"),
    *at_both("position", "function of four points", DETERMINANT),
    Variant("position", "function of four points, -O1", ("-O1", DETERMINANT)),
    *at_both("position", "four points in LF, n.p in LFRes", "-DLF_POSITION=DETERMINANT"),
    *at_both("numbers", "float", "-DREAL=float"),
    *at_both("numbers", "long double", "-DREAL=long double"),
    *at_both("numbers", "x87", "-mfpmath=387"),
    *at_both("numbers", "x87, four points", "-mfpmath=387", DETERMINANT),
    *at_both("layout", "wide structs", "-DLAYOUT=WIDE"),
    *at_both("layout", "three arrays", "-DLAYOUT=COLUMNS"),
    *at_both("layout", "pointers to structs", "-DLAYOUT=POINTERS"),
    *at_both("layout", "linked list", "-DLAYOUT=LIST"),
    *at_both("membership", "coordinates compared", "-DSAME=COORDINATES"),
    *at_both("membership", "a, b, p_l not left out", "-DSAME=NOT_TESTED"),
    *at_both("edges", "E_L and E'_L as linked lists", "-DEDGES=CHAIN"),
    *at_both("edges", "E_L and E'_L as arrays", "-DEDGES=ARRAY"),
    *at_both("tests", "z first", "-DTESTS=Z_FIRST"),
    *at_both("tests", "five tests without jumps", "-DTESTS=TOGETHER"),
    *at_both("plane", "n and d where n_z < 0", "-DPLANE=LATE"),
    *at_both("exit", "no early exit", "-DEXIT=FLAGGED"),
    Variant("order", "sorted by x, -O0", BASE, "sorted by x"),
    Variant("order", "sorted by y, -O0", BASE, "sorted by y"),
    Variant("order", "sorted by z, -O0", BASE, "sorted by z"),
    Variant("order", "along a Z-curve, -O0", BASE, "by cells"),
    Variant("order", "sorted by x, -O2", ("-O2",), "sorted by x"),
    Variant("order", "sorted by z, -O2", ("-O2",), "sorted by z"),
    *at_both("together", "four points, wide structs", DETERMINANT, "-DLAYOUT=WIDE"),
    *at_both("together", "four points, arrays of edges", DETERMINANT, "-DEDGES=ARRAY"),
    *at_both(
        "together",
        "four points, coordinates compared, lists",
        DETERMINANT,
        "-DSAME=COORDINATES",
        "-DEDGES=CHAIN",
        "-DLAYOUT=LIST",
    ),
]
GROUPS = list(dict.fromkeys(variant.group for variant in VARIANTS))
QUICK = ["compiler", "position"]
