"""Families of text files: OBJ, OFF, tables of points, and STL as text.

Work grows where a line is handled by itself because it is unlike its neighbours, where a line is
joined to all before it, and where a line or a header is as long as the file.
"""

from __future__ import annotations

import numpy as np
from growth.families import families_in, random


def positions(n: int, form: str = "{} {} {}\n") -> str:
    """Write n rows of coordinates."""
    points = np.round(random().random((n, 3)) * 1000, 2)
    return "".join(form.format(x, y, z) for x, y, z in points.tolist())


def corners(n: int, k: int) -> list[int]:
    """Return the corners of face k of n vertices, counted from 1: three or four in turn."""
    return [(k + j) % n + 1 for j in range(3 + k % 2)]


def obj_triangles(n: int) -> bytes:
    """The ordinary mesh."""
    faces = (f"f {k + 1} {(k + 1) % n + 1} {(k + 2) % n + 1}\n" for k in range(n))
    return (positions(n, "v {} {} {}\n") + "".join(faces)).encode()


def obj_polygons(n: int) -> bytes:
    """Triangles and quadrilaterals in turn."""
    faces = (f"f {' '.join(map(str, corners(n, k)))}\n" for k in range(n))
    return (positions(n, "v {} {} {}\n") + "".join(faces)).encode()


def obj_groups(n: int) -> bytes:
    """A group, a material and a smoothing group before every face."""
    faces = (f"g g{k}\nusemtl m{k}\ns {k}\nf 1 2 3\n" for k in range(n))
    return (positions(n, "v {} {} {}\n") + "".join(faces)).encode()


def obj_keywords(n: int) -> bytes:
    """Lines of a keyword of their own each: keywords must not be compared with all before them."""
    return (positions(4, "v {} {} {}\n") + "".join(f"key{k} 1\n" for k in range(n))).encode()


def obj_alternating(n: int) -> bytes:
    """Vertices and faces in turn, with negative indices: counted from where the file has got to."""
    vertices = positions(n, "v {} {} {}\n").splitlines(keepends=True)
    return "".join(line + "f -1 -2 -3\n" * (k > 1) for k, line in enumerate(vertices)).encode()


def obj_one_polygon(n: int) -> bytes:
    """One face with all vertices for corners: a line as long as the file."""
    return (positions(n, "v {} {} {}\n") + f"f {' '.join(map(str, range(1, n + 1)))}\n").encode()


def obj_normals(n: int) -> bytes:
    """Corners with normals of their own, some with textures: four forms of corners in turn."""
    forms = ("f {0}//{0} {1}//{1} {2}//{2}\n", "f {0} {1} {2}\n", "f {0}/{0} {1}/{1} {2}/{2}\n")
    faces = (forms[k % 3].format(k + 1, (k + 1) % n + 1, (k + 2) % n + 1) for k in range(n))
    head = positions(n, "v {} {} {}\n") + "vn 0 0 1\n" * n + "vt 0 0\n" * n
    return (head + "".join(faces)).encode()


def obj_continued(n: int) -> bytes:
    """Lines that go on and on."""
    return b"v 0 0 0\nv 1 0 0\n" + b"a\\\n" * n + b"\n"


def obj_unlike_vertices(n: int) -> bytes:
    """Vertices with and without colours in turn: refused, by looking at each line."""
    lines = positions(n, "v {} {} {}\n").splitlines()
    return "".join(f"{line}{' 0.5 0.5 0.5' * (k % 2)}\n" for k, line in enumerate(lines)).encode()


def obj_comments(n: int) -> bytes:
    """Comments before, between and behind."""
    return ("# c\n" * n + positions(n, "v {} {} {} # c\n")).encode()


def obj_polygon_of_pairs(n: int) -> bytes:
    """One face whose corners have normals."""
    return b"v 0 0 0\nv 1 0 0\nv 1 1 0\nvn 0 0 1\nf" + b" 1//1" * n + b"\n"


def obj_polygon_of_triples(n: int) -> bytes:
    """One face whose corners have textures and normals."""
    return b"v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvn 0 0 1\nf" + b" 1/1/1" * n + b"\n"


def obj_crs_comments(n: int) -> bytes:
    """Comments that look as if they stated a coordinate system."""
    return b"# crs \n" * n + b"v 0 0 0\n"


def obj_metadata_comments(n: int) -> bytes:
    """Comments that state metadata, under a key of their own each."""
    return b"".join(b'# metadata {"%d": [[]]}\n' % k for k in range(n)) + b"v 0 0 0\n"


def obj_painted(n: int) -> bytes:
    """Comments of ZBrush that hold the colour of a vertex each, and many of none."""
    painted = b"#MRGB ff010203\n" * n + b"#MRGB\n" * n
    return positions(n, "v {} {} {}\n").encode() + painted


def obj_blank(n: int) -> bytes:
    """Lines of nothing, and lines of a letter."""
    return b"\n" * n + b"v 0 0 0\n" + b"a\n" * n


def obj_continued_faces(n: int) -> bytes:
    """Faces on two lines each."""
    return b"v 0 0 0\n" + b"f 1\\\n 1 1\n" * n


def obj_continued_polygon(n: int) -> bytes:
    """One face on as many lines as it has corners."""
    return b"v 0 0 0\nf" + b" 1\\\n" * n + b" 1 1\n"


def obj_continued_nothing(n: int) -> bytes:
    """Lines that go on with nothing."""
    return b"v 0 0 0\n" + b"\\\n" * n + b"\n"


def obj_long_keyword(n: int) -> bytes:
    """A keyword and a name as long as the file."""
    return b"v 0 0 0\n" + b"a" * n + b"\ng " + b"a" * n + b"\n"


OBJ = families_in(globals(), "bytes", "obj_")


def off_triangles(n: int) -> bytes:
    """The ordinary mesh."""
    faces = "".join(f"3 {k} {(k + 1) % n} {(k + 2) % n}\n" for k in range(n))
    return f"OFF\n{n} {n} 0\n{positions(n)}{faces}".encode()


def off_polygons(n: int) -> bytes:
    """Triangles and quadrilaterals in turn."""
    rows = ([c - 1 for c in corners(n, k)] for k in range(n))
    faces = "".join(f"{len(row)} {' '.join(map(str, row))}\n" for row in rows)
    return f"OFF\n{n} {n} 0\n{positions(n)}{faces}".encode()


def off_colours(n: int) -> bytes:
    """Colours behind some faces."""
    faces = "".join(f"3 0 1 2{' 255 0 0' * (k % 2)}\n" for k in range(n))
    return f"OFF\n{n} {n} 0\n{positions(n)}{faces}".encode()


def off_one_polygon(n: int) -> bytes:
    """One face with all vertices for corners."""
    return f"OFF\n{n} 1 0\n{positions(n)}{n} {' '.join(map(str, range(n)))}\n".encode()


def off_empty_faces(n: int) -> bytes:
    """Faces without corners, two bytes each."""
    return f"OFF\n3 {n + 1} 0\n{positions(3)}3 0 1 2\n".encode() + b"0\n" * n


def off_comments(n: int) -> bytes:
    """Comments and empty lines between the rows."""
    return f"OFF\n{n} 1 0\n{positions(n, '{} {} {} # c' + chr(10) * 3)}3 0 1 2\n".encode()


def off_wide_vertices(n: int) -> bytes:
    """Vertices of a hundred values, of which three count."""
    return b"OFF\n%d 0 0\n" % n + (b"0 " * 99 + b"0\n") * n


def off_blank(n: int) -> bytes:
    """Lines of nothing at the end."""
    return b"OFF\n1 0 0\n0 0 0\n" + b"\n" * n


OFF = families_in(globals(), "bytes", "off_")


def table(n: int) -> bytes:
    """The ordinary table."""
    return positions(n).encode()


def table_with_header(n: int) -> bytes:
    """The ordinary table with a header, colours and a column of its own."""
    rows = positions(n, "{},{},{},1,2,3,7\n")
    return f"x,y,z,red,green,blue,class\n{rows}".encode()


def one_digit_rows(n: int) -> bytes:
    """Rows of four bytes: what is kept for a row outweighs it."""
    return b"0 1\n" * n


def columns(n: int) -> bytes:
    """Rows of very many columns, with a header: names must not be compared with all others."""
    names = ",".join(["x", "y", *(f"c{k}" for k in range(n))])
    return f"{names}\n{'1,' * (n + 1)}1\n{'2,' * (n + 1)}1\n".encode()


def unnamed_columns(n: int) -> bytes:
    """One row of very many columns, and one that has fewer."""
    return b"1 " * n + b"\n1 2 3\n"


def remarks(n: int) -> bytes:
    """Comments before the first row and behind every row."""
    return ("# a remark\n" * n + positions(n, "{} {} {} # remark\n")).encode()


def remarks_behind_commas(n: int) -> bytes:
    """Comments behind rows, where a # may be text as well, and between them."""
    return positions(n, "{},{},{},7 # remark\n#1,2,3,4\n").encode()


def blank_lines(n: int) -> bytes:
    """Lines of nothing."""
    return b"0 0 0\n" + b"\n" * 8 * n + b"1 0 0\n"


def carriage_returns(n: int) -> bytes:
    """Lines that end as they once did."""
    return positions(n).replace("\n", "\r").encode()


def quoted_values(n: int) -> bytes:
    """Every value in quotes."""
    return positions(n, '"{}";"{}";"{}"\n').encode()


def last_line_broken(n: int) -> bytes:
    """A table whose last line is no row: all lines are looked at again to tell which it is."""
    return (positions(n) + "1 2\n").encode()


def long_numbers(n: int) -> bytes:
    """Numbers of very many digits."""
    return f"0.{'1' * n} 0.{'2' * n} 0.{'3' * n}\n".encode()


def six_digits(n: int) -> bytes:
    """Rows that may be points with colours, which only the last of them decides."""
    return b"1 1 1 1 1 1\n" * n


def long_word(n: int) -> bytes:
    """A number as long as the file."""
    return b"1" * n + b" 2\n"


def wide_rows(n: int) -> bytes:
    """Rows of a thousand columns."""
    return (b"1 " * 999 + b"1\n") * max(n // 16, 1)


def remarks_last(n: int) -> bytes:
    """Comments behind the only row."""
    return b"1 1\n" + b"#ab\n" * n


def long_remark(n: int) -> bytes:
    """A comment that might be the header of very many columns."""
    return b"# " + b"a " * n + b"\n1 1\n"


def header_of_words(n: int) -> bytes:
    """A first line of words without a column named x."""
    return b"ab " * n + b"\n1 1\n"


def blanks_in_header(n: int) -> bytes:
    """Blanks between two words of a header: a unit may follow, which belongs to the first."""
    return b"x y z" + b" " * n + b"[\n1 2 3 4\n"


def quotes_in_header(n: int) -> bytes:
    """A header of quotes, and a blank that separates names."""
    return b"x y " + b'"' * n + b"\n1 2 3\n"


def empty_names(n: int) -> bytes:
    """A header of commas."""
    return b"x,y" + b"," * n + b"\n"


def decimal_commas(n: int) -> bytes:
    """Numbers with decimal commas: every value is looked at by itself."""
    return positions(n, "{};{};{}\n").replace(".", ",").encode()


def words_beside(n: int) -> bytes:
    """A column of text, and one that is mostly empty."""
    return ("x,y,z,name,w\n" + positions(n, "{},{},{},tree,\n")).encode()


def word_at_the_end(n: int) -> bytes:
    """A column that only the last row shows to be text."""
    return ("x,y,z,w\n" + positions(n, "{},{},{},1\n") + "1,2,3,oak\n").encode()


def words_in_columns(n: int) -> bytes:
    """One row of very many words."""
    return f"x,y,z{',c' * n}\n1,2,3{',word' * n}\n".encode()


def ids(n: int) -> bytes:
    """An id before the coordinates, which only the last row rules out."""
    rows = "".join(f"{k},{k % 7}.5,{k % 5}.25,1\n" for k in range(n))
    return f"{rows}0,1,2,3\n".encode()


def marks(n: int) -> bytes:
    """Heights of which every other one is the mark of a missing value."""
    return ("x y z\n" + positions(n, "{} {} {}\n1 2 -9999\n")).encode()


def sixteen_bits(n: int) -> bytes:
    """A table in UTF-16."""
    return positions(n).encode("utf-16")


def tabs(n: int) -> bytes:
    """Rows between tabs, without their last values."""
    return ("x\ty\tz\tw\n" + positions(n, "{}\t{}\t{}\t\n")).encode()


def long_quote(n: int) -> bytes:
    """A quote that is not closed before the end of the file."""
    return b'x,y,z,w\n1,2,3,"' + b"ab," * n + b"\n"


TEXT = {
    name: family
    for name, family in families_in(globals(), "bytes").items()
    if name not in OBJ | OFF
}
