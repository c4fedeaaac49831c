"""Families of LandXML.

Work grows where elements are many and hold little, where names are all different, and where a
tag or a comment does not end.
"""

from __future__ import annotations

from growth.families import named
from growth.files.text import positions

_HEAD, _END = b"<LandXML><Surfaces><Surface name='a'><Definition>", b"</Definition></Surface>"
_POINTS = b"".join(b"<P id='%d'>%d %d 0</P>" % (k, k % 3, k // 3) for k in range(9))


def _surface(points: bytes, faces: bytes, before: bytes = b"") -> bytes:
    head = _HEAD.replace(b"<Definition>", before + b"<Definition>")
    parts = [head, b"<Pnts>", points, b"</Pnts><Faces>", faces, b"</Faces>", _END]
    return b"".join([*parts, b"</Surfaces></LandXML>"])


def surface_in_xml(n: int) -> bytes:
    """The ordinary surface."""
    lines = positions(n).splitlines()
    points = "".join(f'<P id="{k}">{line}</P>\n' for k, line in enumerate(lines, 1)).encode()
    faces = b"".join(b"<F>%d %d %d</F>\n" % (k, k % n + 1, (k + 1) % n + 1) for k in range(1, n))
    return _surface(points, faces)


def short_faces(n: int) -> bytes:
    """Faces of few bytes each, and invisible ones."""
    return _surface(_POINTS, b"<F>1 2 3</F>" * n + b"<F i='1'/>" * n)


def long_breakline(n: int) -> bytes:
    """One breakline of very many corners."""
    line = b"<SourceData><Breaklines><Breakline><PntList3D>%s</PntList3D></Breakline></Breaklines>"
    return _surface(_POINTS, b"<F>1 2 3</F>", (line + b"</SourceData>") % (b"1 1 0 " * n))


def points_of_a_survey(n: int) -> bytes:
    """Points without heights."""
    return b"<LandXML><CgPoints>" + b"<CgPoint>1 2</CgPoint>" * n + b"</CgPoints></LandXML>"


def other_elements(n: int) -> bytes:
    """Elements that are left out, with attributes."""
    return _surface(_POINTS, b"<F>1 2 3</F>", b"<a b='' c=''><d/></a>" * n)


def many_names(n: int) -> bytes:
    """Names that are all different: refused beyond a number of them."""
    return _surface(_POINTS, b"<F>1 2 3</F>", b"".join(b"<n%x/>" % k for k in range(n)))


def endless_comment(n: int) -> bytes:
    """A comment, which expat reads from its beginning each time."""
    return _surface(_POINTS, b"<F>1 2 3</F>", b"<!--" + b"a" * 12 * n + b"-->")


LANDXML = named(
    surface_in_xml,
    short_faces,
    long_breakline,
    points_of_a_survey,
    other_elements,
    many_names,
    endless_comment,
)
