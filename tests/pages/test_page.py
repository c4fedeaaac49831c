"""`Page`: what is in the file, read as its script reads it."""

from __future__ import annotations

import base64
import hashlib
import re

import numpy as np
import pytest
from hypothesis import given, strategies as st
from hypothesis.extra import numpy as arrays
from page_reader import Elements, read

from liftmesh import FormatError
from liftmesh.pages.page import Layer, Page, Values

CORNERS = np.array([[0.1, 0.2, 5], [1, 0, 6], [0, 1, 7]])
FACE = np.array([[0, 1, 2]], np.int32)


def test_a_page_carries_what_it_was_given():
    colors = np.array([[1, 2, 3], [250, 0, 9], [7, 7, 7]], np.uint8)
    values = [Values("height", unit="m"), Values("class", np.array([2, 9, np.nan]))]
    given = Layer(
        "ground", "faces", CORNERS, FACE, rows=np.array([4, 0, 9]), colors=colors, values=values
    )
    header = read(Page([given], "Title", notes=["one", "two"], unit="metre"))
    assert (header["title"], header["notes"], header["unit"]) == ("Title", ["one", "two"], "metre")
    (layer,) = header["layers"]
    assert np.array_equal(layer["points"].reshape(-1, 3), CORNERS)
    assert layer["cells"].tolist() == [0, 1, 2]
    assert layer["rows"].tolist() == [4, 0, 9]
    assert layer["colors"].reshape(-1, 3).tolist() == colors.tolist()
    height, kind = layer["values"]
    assert "array" not in height
    assert 5 <= height["range"][0] < height["range"][1] <= 7
    assert np.array_equal(kind["array"], np.float32([2, 9, np.nan]), equal_nan=True)


@given(
    arrays.arrays(
        np.float64,
        st.tuples(st.integers(1, 9), st.just(3)),
        elements=st.floats(-1e300, 1e300, allow_subnormal=True),
    ),
    st.lists(st.integers(-(2**31), 2**31 - 1), max_size=9),
)
def test_every_bit_of_coordinates_and_rows_is_there(points, rows):
    layer = Layer("any", "points", points, rows=np.array(rows, np.int32))
    header = read(Page([layer], "any"))
    (found,) = header["layers"]
    assert found["points"].tobytes() == points.reshape(-1).tobytes()
    assert found["rows"].tolist() == rows
    low, high = points.min(axis=0), points.max(axis=0)
    assert (low <= header["origin"]).all() or np.ptp(points) == 0 or (high - low).max() > 0


HOSTILE = '</script><script>alert(1)</script><!-- & "x" \u2028 {{script}} '


def test_no_name_ends_what_it_stands_in():
    layer = Layer(HOSTILE, "faces", CORNERS, FACE, values=[Values(HOSTILE, unit=HOSTILE)])
    page = Page([layer], HOSTILE, notes=[HOSTILE])
    header = read(page)
    (found,) = header["layers"]
    assert header["title"] == header["notes"][0] == found["name"] == HOSTILE
    assert found["values"][0]["unit"] == HOSTILE
    scripts = [text for tag, _, text in Elements(page.to_html()).found if tag == "script"]
    assert len(scripts) == 3
    titles = [text for tag, _, text in Elements(page.to_html()).found if tag == "title"]
    assert titles[0].startswith(HOSTILE)


def test_only_the_script_of_the_page_may_run_and_nothing_be_loaded():
    text = Page([Layer("one", "points", CORNERS)], "one").to_html()
    script = [text for tag, _, text in Elements(text).found if tag == "script"][-1]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest())
    (policy,) = re.findall(r'Content-Security-Policy" content="([^"]+)"', text)
    assert f"script-src 'sha256-{digest.decode()}'" in policy
    assert "default-src 'none'" in policy
    assert not re.search(r"""(src|href)=["'](https?:)?//""", text)


def test_values_without_a_number_have_a_range():
    none = Values("none", np.full(3, np.nan))
    same = Values("same", np.full(3, 4.0))
    rise = Values("rise", np.array([-1.0, 3.0, 0.5]), palette="difference")
    (layer,) = read(Page([Layer("a", "points", CORNERS, values=[none, same, rise])], "a"))["layers"]
    first, second, third = (each["range"] for each in layer["values"])
    assert first == [0, 1]
    assert second == [3.5, 4.5]
    assert third[0] == -third[1] < 0


def test_pages_are_written_whole_and_by_their_suffix(tmp_path):
    page = Page([Layer("a", "points", CORNERS)], "a")
    with pytest.raises(FormatError, match=r"pages.*\.html"):
        page.save(tmp_path / "page.pdf")
    page.save(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == page.to_html()
    assert [each.name for each in tmp_path.iterdir()] == ["page.html"]
    with pytest.raises(OSError, match="nowhere"):
        page.save(tmp_path / "nowhere" / "page.html")


def test_a_notebook_shows_the_page_without_its_origin():
    page = Page([Layer("a", "points", CORNERS)], "a")
    shown = page._repr_html_()
    (frame,) = [attributes for tag, attributes, _ in Elements(shown).found if tag == "iframe"]
    assert frame["sandbox"] == "allow-scripts"
    assert frame["srcdoc"] == page.to_html()
    assert not {"\t", "\n"} & {*shown}  # which programs change that indent what they put into pages
