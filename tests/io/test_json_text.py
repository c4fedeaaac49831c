"""JSON of glTF files: parsing holds the interpreter, so that it must not take long."""

from __future__ import annotations

import gc
import io
import json
import tracemalloc

import pytest

import liftmesh
from liftmesh.io import markup
from liftmesh.io.markup import bytes_of_text, bytes_of_tree

SCENE = {
    "asset": {"version": "2.0"},
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64," + "A" * 48}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}]}],
    "nodes": [{"mesh": 0}],
    "scenes": [{"nodes": [0]}],
    "scene": 0,
}


def read(scene: object, **options: int) -> liftmesh.Cloud:
    stream = io.BytesIO(json.dumps(scene).encode())
    return liftmesh.read(stream, format="gltf", **options)


def test_long_json_is_refused_unless_a_limit_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(markup, "_MOST", 2000)
    long = {**SCENE, "extras": [1] * 2000}
    with pytest.raises(
        liftmesh.FormatError, match=r"JSON .* has 6,\d+ bytes, .* of 2,000: .*max_by"
    ):
        read(long)
    assert len(read(long, max_bytes=10**8)) == 3


def test_embedded_buffers_do_not_count(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(markup, "_MOST", 2000)
    image = {"uri": "data:image/png;base64," + "A" * 100_000}
    assert len(read({**SCENE, "images": [image, image]})) == 3


COUNT = 90_000  # a little after tables of Python have grown
SHAPES = {
    "objects": ",".join(f'{{"{k:x}":1.5}}' for k in range(COUNT)),
    "an object": "{" + ",".join(f'"{k:x}":1.5' for k in range(COUNT)) + "}",
    "an emoji": '"\U0001f600",' + ",".join(f'{{"{k:x}":1.5}}' for k in range(COUNT)),
    "one key": ",".join(['{"a":1.5}'] * COUNT),
    "lists": ",".join(["[1]"] * COUNT),
    "strings": ",".join(['"\u0100"'] * COUNT),
    "words": ",".join(f'"{k:x}"' for k in range(COUNT)),
    "numbers": ",".join(["-9"] * COUNT),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_the_memory_of_json_is_counted(shape: str) -> None:
    text = f'{{"extras":[{SHAPES[shape]}]}}'.encode()
    tracemalloc.start()
    tree = markup.parsed(text)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert tree
    looked_at = bytes_of_tree(text, bytes_of_tree(text, 10**9) - 1)
    assert peak + len(text) <= looked_at + bytes_of_text(text) < 3 * peak


def test_keys_that_do_not_come_again_are_dear() -> None:
    parts = [f'{{"{k:x}":1.5}}' for k in range(260_000)]
    with pytest.raises(liftmesh.FormatError, match=r"its JSON of .* expands to 1\d\d,"):
        liftmesh.read(io.BytesIO(b'{"x":[%s]}' % ",".join(parts).encode()), format="gltf")
    again = b",".join([b'{"a":1.5}'] * len(parts))
    with pytest.raises(liftmesh.FormatError, match="no vertices"):
        liftmesh.read(io.BytesIO(b'{"x":[%s]}' % again), format="gltf")


def test_quotation_marks_in_strings_do_not_hide_keys() -> None:
    plain = bytes_of_tree(b'{"a": 1, "b": 2}', 300)
    assert bytes_of_tree(rb'{"a\"": 1, "b": 2}', 300) == plain
    assert bytes_of_tree(rb'{"a\\": 1, "b": 2}', 300) == plain
    assert bytes_of_tree(rb'{"b\\\"": 1, "b" : 2}', 300) == plain


@pytest.mark.parametrize("text", [b"[1]", b"[", b"[" * 100_000])
@pytest.mark.parametrize("is_enabled", [True, False])
def test_the_search_for_cycles_is_as_before(text: bytes, is_enabled: bool) -> None:
    before = gc.isenabled()
    (gc.enable if is_enabled else gc.disable)()
    try:
        try:
            markup.parsed(text)
        except (ValueError, RecursionError):
            assert text != b"[1]"
        assert gc.isenabled() is is_enabled
    finally:
        (gc.enable if before else gc.disable)()


def test_no_search_for_cycles_while_json_is_parsed() -> None:
    passes = gc.get_stats()[0]["collections"]
    markup.parsed(b"[" + b"[]," * 200_000 + b"1]")
    assert gc.get_stats()[0]["collections"] <= passes + 1
