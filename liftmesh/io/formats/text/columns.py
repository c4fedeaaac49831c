"""The columns of a table: which are coordinates, colours and normals, by the names they have.

The names decide, and what the caller says goes first. A name that could mean two things, a second
column with the same meaning, and a depth, whose sign nobody told, are refused: the message shows
the header and names the option. Which columns are what is kept as text for those who ask.

*Names.* ``POINT_X``, ``X [m]``, ``Rechtswert`` and ``lng`` are all x. A name is taken apart: a unit
at its end (in brackets, or behind a blank, an underline or a slash), accents, and words that say
nothing about the axis, such as ``coord`` or ``point``. What is left is looked up in a table of
words in English, German, French, Spanish, Italian, Portuguese, Dutch and the Scandinavian
languages. A word that is not in the table means nothing: no name is guessed from a part of it, so
that ``GroundZ`` is a name of its own.
"""

from __future__ import annotations

import re
import unicodedata
import warnings
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

from liftmesh.errors import DataWarning, FormatError, Message, Option
from liftmesh.io.columns import ALPHA, COLOR, NORMAL, PARTS, POSITION
from liftmesh.io.options import LEFT_OUT, TableOptions, is_plain

_GROUPS = ((*COLOR, ALPHA), NORMAL)  # of which the first three belong together

_GEOMETRY = {"wkt", "wkt_geom", "geometry", "geom", "the_geom"}
DEGREES = Message(  # holds until they are transformed
    "x and y are degrees: lengths and triangles are distorted, and heights have another unit: "
    f"transform them with {Option('src_crs', ...)} and {Option('dst_crs', ...)}"
)
_CHOOSE = f"{Option('columns', 'x=..,y=..,z=..')}"
_LONGEST = 40  # characters of a name in a message


@dataclass(frozen=True, slots=True)
class Columns:
    """What each column of a table is."""

    names: tuple[str, ...]  # parts of a point, and names of attributes
    given: tuple[str, ...]  # in the table
    left_out: frozenset[int] = frozenset()  # columns that become nothing
    negated: int | None = None  # the column of depths
    said: bool = True  # whether a header or the caller named them
    notes: tuple[str, ...] = ()  # what is worth knowing

    def mapping(self) -> dict[str, str]:
        """The name in the table of each part of a point, with the sign of depths."""
        pairs = zip(self.names, self.given, strict=True)
        parts = {
            name: f"-{given}" if k == self.negated else given
            for k, (name, given) in enumerate(pairs)
            if name in PARTS and k not in self.left_out
        }
        return {part: parts[part] for part in PARTS if part in parts}

    def warn(self) -> None:
        """Warn of what the names tell about units, and most users do not want."""
        for each in self.notes:
            warnings.warn(each, DataWarning, stacklevel=2)

    def check_height(self, values: Collection[str], where: str) -> None:
        """Raise if no column is z, but others hold numbers: one may be the height."""
        groups = [group for group in _GROUPS if {*group[:3]} <= {*self.names}]
        known = {*POSITION}.union(*groups)
        others = [each for each in values if each not in known]
        if "z" not in self.names and others:
            raise FormatError(
                f"{where}: no column of {shown(self.given)} is known as the height z, and "
                f"{shown(others, 4)} {'holds' if len(others) == 1 else 'hold'} numbers: read it "
                f"with {_CHOOSE}, or with {Option('flat', True)} if heights do not matter"
            )


def coordinates_sentence(mapping: Mapping[str, str]) -> str:
    """Say which columns are the coordinates; "" where they are called x, y and z, or come first."""
    planar = {part: name for part, name in mapping.items() if part in POSITION}
    plain = all(name.lower() == part for part, name in planar.items())
    first = all(name == f"column_{POSITION.index(part) + 1}" for part, name in planar.items())
    return (
        "" if plain or first else ", ".join(f"{k} is {_quoted(name)}" for k, name in planar.items())
    )


def shown(names: Sequence[str], most: int = 12) -> str:
    """List the names of a header for a message."""
    rest = len(names) - most
    listed = ", ".join(map(_quoted, names[:most]))
    return f"{listed} and {rest:,} more" if rest > 0 else listed


def _quoted(name: str) -> str:
    return repr(name if len(name) <= _LONGEST else name[: _LONGEST - 3] + "...")


def known_header(names: Sequence[str]) -> bool:
    """Whether names are those of a header: x and y are among them."""
    parts = {name for name in _planar(list(map(meaning, names))) if name}
    return {"x", "y"} <= parts


def unnamed(width: int, options: TableOptions, where: str) -> Columns:
    """Name the columns of a table without a header: x, y, z, then column_4 and so on."""
    if width < 2:
        raise FormatError(f"{where}: only one value: a point needs x and y at least")
    given = tuple(f"column_{k}" for k in range(1, width + 1))
    if options.chosen or options.names is not None:
        return understood(given, options, where)
    names = (*POSITION[: 2 if options.flat else 3], *given[2 if options.flat else 3 :])[:width]
    dropped = frozenset({2}) if options.flat and width > 2 else frozenset[int]()
    return Columns(names, given, dropped, said=False)


def understood(given: Sequence[str], options: TableOptions, where: str) -> Columns:
    """Find what the columns of a header are."""
    given = tuple(each or f"column_{k}" for k, each in enumerate(given, 1))
    named = given if options.names is None else _renamed(given, options.names, where)
    choice = _Choice(given, where)
    for part, source in options.chosen.items():
        choice.take(part, source)
    names = choice.completed(named, flat=options.flat)
    left_out = {k for k, name in enumerate(names) if name in (LEFT_OUT, "")}
    kept = [k for k in range(len(names)) if k not in left_out]
    _check_once([names[k] for k in kept], [given[k] for k in kept], where)
    return Columns(
        tuple(names),
        given,
        frozenset(left_out),
        choice.negated,
        notes=(*_notes(names, [meaning(each) for each in given]), *_turned(names, given, options)),
    )


def _renamed(given: Sequence[str], names: Sequence[str], where: str) -> tuple[str, ...]:
    if len(names) != len(given):
        raise FormatError(
            f"{where}: {Option('columns', ...)} names {len(names)} columns, and the table has "
            f"{len(given)}: {shown(given)}"
        )
    return tuple(names)


class _Choice:
    """The parts of a point by column, first those that the caller chose."""

    def __init__(self, given: Sequence[str], where: str) -> None:
        self.negated: int | None = None
        self._given = given
        self._where = where
        self._parts: dict[int, str] = {}

    def take(self, part: str, source: str) -> None:
        """Take the column that the caller chose for a part."""
        k, sign = self._found(source)
        if k in self._parts:
            raise FormatError(
                f"{self._where}: {Option('columns', ...)} takes {self._given[k]!r} for "
                f"{self._parts[k]!r} and for {part!r}: give two columns"
            )
        if part == "z" and not sign and meaning(self._given[k]).part == "depth":
            raise self._unsigned(k)
        if sign and part != "z":
            raise FormatError(
                f"{self._where}: {Option('columns', ...)} gives {part!r} a sign: only z can have "
                "one"
            )
        self._parts[k] = part
        self.negated = k if sign == "-" else self.negated

    def completed(self, named: Sequence[str], *, flat: bool | None) -> list[str]:
        """Return the part or the name of each column; "" for one that is left out."""
        taken = set(self._parts.values())
        found = _complete([meaning(name) for name in named])
        for k, (part, name) in enumerate(zip(found, named, strict=True)):
            if k not in self._parts and part and part not in taken:
                self._parts[k] = "" if flat and part == "z" else part
            elif k not in self._parts:
                self._parts[k] = "" if name in taken and name in PARTS else name
        names = [self._parts[k] for k in range(len(named))]
        self._check(named, names, flat=flat)
        return names

    def _check(self, named: Sequence[str], names: Sequence[str], *, flat: bool | None) -> None:
        missing = [each for each in ("x", "y") if each not in names]
        if missing and list(named) != list(self._given):
            raise FormatError(
                f"{self._where}: {Option('columns', ...)} renames the columns to {shown(named)}, "
                f"and none of these is {' or '.join(missing)}: name x and y among them"
            )
        if missing:
            raise FormatError(
                f"{self._where}: the header {shown(self._given)} has no column "
                f"{' or '.join(missing)}: {self._remedy()}"
            )
        depths = [k for k, name in enumerate(named) if meaning(name).part == "depth"]
        if depths and "z" not in names and flat is False:
            raise self._unsigned(depths[0])

    def _remedy(self) -> str:
        """Say how to read a table whose names do not tell the coordinates."""
        if {each.casefold() for each in self._given} & _GEOMETRY:
            return "points as WKT are not read: save x, y and z as columns (QGIS: GEOMETRY=AS_XYZ)"
        skip = (
            f", or if it is no header, with {Option('skip_rows', 1)}"
            if ": line " in self._where
            else ""
        )
        return f"read it with {_CHOOSE}{skip}"

    def _found(self, source: str) -> tuple[int, str]:
        """Find a column by its name, its name in other letters, or its number; and its sign."""
        for sign in ("", "-", "+"):
            if source.startswith(sign):
                name = source.removeprefix(sign)
                for test in (str, str.casefold):
                    places = [k for k, each in enumerate(self._given) if test(each) == test(name)]
                    if len(places) == 1:
                        return places[0], sign
                if name.isdecimal() and 0 < int(name[:9]) <= len(self._given):
                    return int(name[:9]) - 1, sign
        raise FormatError(
            f"{self._where}: {Option('columns', ...)} names {_quoted(source)}, which is not one of "
            f"the columns {shown(self._given)}"
        )

    def _unsigned(self, k: int) -> FormatError:
        name = self._given[k]
        typed = name if is_plain(name) else f"{k + 1}"
        return FormatError(
            f"{self._where}: {_quoted(name)} may count downwards or upwards: read it with "
            f"{Option('columns', f'z=-{typed}')} if heights are negative depths, or with "
            f"{Option('columns', f'z=+{typed}')} if they are heights already"
        )


def _planar(meanings: Sequence[Meaning]) -> list[str]:
    """Return the parts of a point that names mean, each name by itself but for E, N and H."""
    parts = [each.part for each in meanings]
    grid = {"e": "x", "n": "y", "h": "z"} if {"e", "n"} <= {*parts} else {}
    angles = {"lon": "x", "lat": "y"} if {"lon", "lat"} <= {*parts} else {}
    known = {"e": "", "n": "", "h": "", "lon": "x", "lat": "y", "depth": ""} | grid | angles
    return [known.get(part, part) for part in parts]


def _complete(meanings: Sequence[Meaning]) -> list[str]:
    """Leave only groups that are complete: a column R alone is no colour."""
    parts = _planar(meanings)
    for group in _GROUPS:
        if not {*group[:3]} <= {*parts}:
            parts = ["" if part in group else part for part in parts]
    return parts


def _check_once(names: Sequence[str], given: Sequence[str], where: str) -> None:
    """Raise for two columns of one name, in time that does not grow with their number squared."""
    twice = next((name for name, count in Counter(names).items() if count > 1), None)
    if twice is not None:
        those = [each for name, each in zip(names, given, strict=True) if name == twice]
        how = (
            _CHOOSE
            if twice in POSITION
            else f"{Option('columns', '..,..,..')}, the names of all columns"
        )
        raise FormatError(
            f"{where}: the header has {len(those)} columns for {_quoted(twice)}, {shown(those)}: "
            f"read it with {how}"
        )


def _turned(names: Sequence[str], given: Sequence[str], options: TableOptions) -> Iterator[str]:
    """Say that 'Y' before 'X' may be easting and northing, but not that of Z, Y and X."""
    places = [given.index(each) if each in given else -2 for each in ("Y", "X")]
    is_chosen = options.names is not None or not {"x", "y"}.isdisjoint(options.chosen)
    if places[1] - places[0] != 1 or is_chosen or [names[each] for each in places] != ["y", "x"]:
        return
    if places[0] > 0 and names[places[0] - 1] == "z":
        return
    yield Message(
        "'Y' stands before 'X', as in surveys where X is northing: if it is here, all is mirrored: "
        f"read it with {Option('columns', 'x=Y,y=X')}"
    )


def _notes(names: Sequence[str], meanings: Sequence[Meaning]) -> Iterator[str]:
    """Say what a table tells about its units that its user should know."""
    by_part: Mapping[str, Meaning] = dict(zip(names, meanings, strict=True))
    planar = [by_part[each] for each in ("x", "y")]
    if any(each.part in ("lon", "lat") or each.unit == "degrees" for each in planar):
        yield DEGREES
    units = {part: each.unit for part, each in by_part.items() if part in POSITION and each.unit}
    if len({*units.values()} - {"degrees"}) > 1:
        listed = ", ".join(f"{part} in {unit}" for part, unit in units.items())
        yield f"the columns have different units: {listed}: nothing is converted"


_WORDS = {
    "x": "x xcoord easting east eastings rechtswert ostwert ost oost est este abscissa abscisse "
    "ascissa abscisa abszisse",
    "y": "y ycoord northing north northings hochwert nordwert nord norte noord ordinate ordonnee "
    "ordinata ordenada",
    "z": "z zcoord elevation elevations elev ele height heights altitude alt hoehe hohe hoehenwert "
    "hauteur altura altitud altezza altitudine elevazione elevacion elevacao quota cota hoogte "
    "hoyde hojd hojde orthometricheight orthoheight ellipsoidalheight ellipsoidheight",
    "lon": "lon long lng longitude laengengrad longitud longitudine lengtegraad",
    "lat": "lat latitude breitengrad latitud latitudine breedtegraad",
    "depth": "depth depths tiefe wassertiefe waterdepth profondeur profundidad profundidade "
    "profondita diepte djup dybde sounding soundings",
    "e": "e",
    "n": "n",
    "h": "h u",
    "red": "red r",
    "green": "green g",
    "blue": "blue b",
    "alpha": "alpha a",
    "nx": "nx normalx",
    "ny": "ny normaly",
    "nz": "nz normalz",
}
_MEANING = {word: part for part, words in _WORDS.items() for word in words.split()}
_SILENT = {
    *("coord", "coords", "coordinate", "coordinates", "koordinate", "koordinaten", "coor"),
    *("coordonnee", "coordonnees", "coordenada", "coordinata", "coordinaat"),
    *("point", "points", "pt", "pnt", "punkt", "pos", "position", "utm", "wert", "value", "field"),
    *("vertex", "grid"),
    *("nn", "nhn", "nap", "msl", "ue", "ueber"),  # above which zero
}
_POINTS = re.compile(r"points?[:_ ]([012])")  # how ParaView writes the columns of a vector

_UNITS = {
    **dict.fromkeys(("m", "metre", "metres", "meter", "meters", "metros", "metri"), "m"),
    **dict.fromkeys(
        ("ft", "foot", "feet", "ftus", "usft", "us-ft", "ft us", "us survey foot"), "ft"
    ),
    **dict.fromkeys(("km", "kilometre", "kilometer"), "km"),
    **{unit: unit for unit in ("cm", "mm")},
    **dict.fromkeys(("deg", "degree", "degrees", "grad", "°", "dd"), "degrees"),
}
_BRACKETED = re.compile(r"\s*[\[(<]\s*([^\[\]()<>]*?)\s*[\])>]")
_BEHIND = re.compile(r"(?<=\w)[\s_/.,-]+(?:in[\s_]+)?([^\W\d_]+|°)$")
_LETTERS = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "ø": "o", "å": "a", "ł": "l"})


@dataclass(frozen=True, slots=True)
class Meaning:
    """What a name means, "" for nothing, and the unit that it states, "" for none."""

    part: str
    unit: str


def meaning(name: str) -> Meaning:
    """Find what a column holds from its name."""
    if len(name) > 80:  # no name in the table is so long, even with its unit
        return Meaning("", "")
    text = unicodedata.normalize("NFC", name).strip()
    vector = _POINTS.fullmatch(text.lower())
    if vector:
        return Meaning("xyz"[int(vector[1])], "")
    text, unit = _without_unit(text)
    return Meaning(_part(text), unit)


def _without_unit(text: str) -> tuple[str, str]:
    """Split off the unit; other words in brackets stay."""
    for pattern in (_BRACKETED, _BEHIND):
        match = pattern.search(text)
        said = match[1].casefold() if match else ""
        unit = _UNITS.get(said) or _UNITS.get(said.partition(" ")[0])  # m above sea level
        if match and unit:
            return text[: match.start()] + text[match.end() :], unit
    return text, ""


def _part(text: str) -> str:
    """Look up the words of a name: all of them as one, or each by itself if they mean the same."""
    spaced = re.sub(r"(?<=[a-zäöü])(?=[A-Z])", " ", text).casefold().translate(_LETTERS)
    plain = "".join(
        each for each in unicodedata.normalize("NFKD", spaced) if not unicodedata.combining(each)
    )
    words = re.findall(r"[^\W_]+", plain)
    said = [word for word in words if word not in _SILENT]
    joined = "".join(said)
    if joined in _MEANING:
        return _MEANING[joined]
    parts = {_MEANING.get(word, "") for word in said}
    if parts in ({"x", "e"}, {"y", "n"}, {"z", "h"}):  # Easting (E)
        return min(parts & {"x", "y", "z"})
    parts |= {_MEANING.get("".join(words), "")} if not parts else set()
    return parts.pop() if len(parts) == 1 else ""
