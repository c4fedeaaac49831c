"""Lines of text, whatever ends them and wherever a block of the file ends."""

from __future__ import annotations

import io

import numpy as np
import pytest
from file_samples import loaded
from hypothesis import given, settings, strategies as st

from liftmesh import FormatError
from liftmesh.io import text_tables
from liftmesh.io.text_tables import Block, Lines, Syntax

TEXT = st.lists(
    st.sampled_from(
        [b"\n", b"\r", b"\r\n", b"\\\n", b"\\ \t\n", b"\\\r\n", b"\\", b"a", b"bc ", b" "]
    ),
    max_size=60,
).map(b"".join)


def taken(data: bytes, *, continued: bool) -> list[tuple[str, int]]:
    found = Lines(io.BytesIO(data), "name", Syntax(continued=continued))
    all_of_them: list[tuple[str, int]] = []
    while len(block := found.take(3)):
        all_of_them += [(" ".join(text.split()), number) for text, number in block]
    return all_of_them


def expected(data: bytes, *, continued: bool) -> list[tuple[str, int]]:
    """Go through the lines one by one."""
    text = data.decode("latin-1").replace("\r\n", "\n").replace("\r", "\n")
    found, held = [], ""
    physical = text.removesuffix("\n").split("\n")
    for number, line in enumerate(physical, 1):
        bare = line.rstrip(" \t")
        goes_on = continued and bare.endswith("\\")
        held += bare[:-1] + " " if goes_on else line
        if goes_on and number < len(physical):
            continue
        words = " ".join(held.split())
        held = ""
        if words:
            found.append((words, number))
    return found


@given(TEXT, st.integers(1, 9), st.booleans())
@settings(max_examples=500)
def test_blocks_end_where_they_may(data: bytes, size: int, continued: bool) -> None:
    usual = text_tables._BYTES
    text_tables._BYTES = size
    try:
        assert taken(data, continued=continued) == expected(data, continued=continued)
    finally:
        text_tables._BYTES = usual


@pytest.mark.parametrize("shift", range(-3, 4))
def test_a_line_is_continued_beyond_a_block(shift: int) -> None:
    for block in (1 << 19, 1 << 21, 1 << 22):
        before = b"v 0 0 0\nv 1 0 0\nv 1 1 0\n#"
        face = b"\nf 1 2 3 \\\n 1 2 3\n"
        filling = b"x" * (block + shift - len(before) - face.index(b"\\") - 1)
        faces = loaded(before + filling + face, "obj").faces
        assert faces is not None
        assert len(faces) == 4


def test_lines_that_end_in_cr_are_counted() -> None:
    rows = b"1 2 3\r" * 200_000
    assert np.array_equal(loaded(rows, "xyz").points, np.tile([1.0, 2, 3], (200_000, 1)))
    with pytest.raises(FormatError, match="line 200001, value 1: 'x'"):
        loaded(rows + b"x y\r", "xyz")


def test_a_byte_that_is_not_utf8_is_named_by_its_line() -> None:
    with pytest.raises(FormatError, match=r"line 100002: byte 2 of the line \(0xff\) is not UTF-8"):
        loaded(b"1 2 3\n" * 100_001 + b"1 \xff\n", "xyz")


def test_an_obj_file_of_many_keywords_counts_the_first() -> None:
    data = b"v 0 0 0\n" + b"".join(b"a%d\n" % k for k in range(1500)) + b"a0\n" + b"b" * 99 + b"\n"
    ignored = loaded(data, "obj").metadata["ignored"]
    assert ignored["a0"] == 2
    assert ignored["..."] == 501
    assert len(ignored) == 1001


def test_tabs_at_the_ends_of_a_line_may_stay() -> None:
    data = b" \t1\t\t \n\n\t# a\n"
    for keep_tabs, texts in ((False, ["1"]), (True, ["\t1\t\t", "\t"])):
        found = Lines(io.BytesIO(data), "name", Syntax(comments=("#",), keep_tabs=keep_tabs))
        assert found.take(9).texts == texts


def test_a_block_of_lines_that_were_changed() -> None:
    texts = ["1,2", "\t3,,\xf6", "x"]
    assert [*Block.of(texts, np.array([7, 9, 12]))] == [*zip(texts, (7, 9, 12), strict=True)]
