"""LandXML: surfaces with breaklines, and points of a survey."""

from __future__ import annotations

from fuzz.structure.case import Case, quarters, told
from fuzz.structure.parts import Chance, Part

WORDS = [b"<P>", b"</P>", b"<F i='1'>", b"<F>", b"</Faces>", b"<Pnts>", b"<Surface name='b'>",
         b"<PntList3D>", b"<!-- a -->", b"<![CDATA[1 2 3]]>", b"<!DOCTYPE a []>", b"<?a b?>",
         b"<CgPoint>1 2 3</CgPoint>", b"</LandXML>", b" id='1'", b"&lt;", b"&a;"]  # fmt: skip


def landxml(chance: Chance) -> Case:
    """Make a surface, or points of a survey."""
    points = quarters(chance, chance.randint(1, 6))
    is_survey = chance.one_in(4)
    parts = _text('<?xml version="1.0" encoding="UTF-8"?>\n') * chance.one_in(2)
    parts += _text('<LandXML xmlns="http://www.landxml.org/schema/LandXML-1.2">\n')
    parts += _text("<Units><Imperial linearUnit='foot'/></Units>") * chance.one_in(4)
    parts += _text("<CgPoints>" if is_survey else "<Surfaces><Surface name='a'>")
    if not is_survey and chance.one_in(2):
        parts += _text("<SourceData><Breaklines><Breakline><PntList3D>")
        for k in (0, -1):
            parts += _numbers(points[k, [1, 0, 2]].tolist())
        parts += _text("</PntList3D></Breakline></Breaklines></SourceData>")
    parts += [] if is_survey else _text("<Definition><Pnts>")
    for k, point in enumerate(points[:, [1, 0, 2]].tolist(), 1):
        parts += _text("<CgPoint>") if is_survey else [Part(b'<P id="'), Part(k), Part(b'">')]
        parts += [*_numbers(point), *_text("</CgPoint>\n" if is_survey else "</P>\n")]
    if not is_survey:
        parts += [*_text("</Pnts><Faces>"), *_faces(chance, len(points)), *_text("</Faces>")]
    parts += _text("</CgPoints>" if is_survey else "</Definition></Surface></Surfaces>")
    return told("landxml", [*parts, *_text("</LandXML>")], WORDS, points, chance)


def _faces(chance: Chance, rows: int) -> list[Part]:
    parts: list[Part] = []
    for _ in range(chance.randint(0, 5)):
        parts += _text(chance.choice(("<F>", '<F n="0 1 2">', '<F i="1">')))
        size = chance.choice((3, 3, 4))
        for _ in range(size):
            parts += [Part(chance.randint(1, rows)), Part(b" ")]
        parts += _text("</F>\n")
    return parts


def _text(text: str) -> list[Part]:
    return [Part(text.encode())]


def _numbers(values: list[float]) -> list[Part]:
    return [part for value in values for part in (Part(value), Part(b" "))]
