"""What the name of a column means: ``POINT_X``, ``X [m]``, ``Rechtswert`` and ``lng`` are all x.

A name is taken apart: a unit at its end (in brackets, or behind a blank, an underline or a slash),
accents, and words that say nothing about the axis, such as ``coord`` or ``point``. What is left is
looked up in a table of words in English, German, French, Spanish, Italian, Portuguese, Dutch and
the Scandinavian languages. A word that is not in the table means nothing: no name is guessed from
a part of it, so that ``GroundZ`` is a name of its own.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass

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
