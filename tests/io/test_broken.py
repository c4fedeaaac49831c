"""Files cut short at every byte, with changed bytes, or of another kind: errors, no crash."""

from __future__ import annotations

import io
import warnings

import numpy as np
import pytest
from file_samples import FACES, full_mesh, loaded, saved, small_mesh

from liftmesh import Cloud, FormatError

MESH = full_mesh()


def npy(array: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


POLYGONS = (
    b"ply\nformat {} 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    b"property list uchar int near\nelement face 2\nproperty list uchar int vertex_indices\n"
    b"property float q\nend_header\n"
)

SAMPLES = {
    "ply": saved(MESH, "ply"),
    "ply ascii": saved(MESH, "ply", encoding="ascii"),
    "ply polygons ascii": POLYGONS.replace(b"{}", b"ascii")
    + b"0 0 1 1\n1 0 0\n1 1 2 0 1\n0 1 0\n4 0 1 2 3 0.5\n3 0 1 2 0.5\n",
    "ply polygons": POLYGONS.replace(b"{}", b"binary_big_endian")
    + b"".join(bytes(8) + bytes([n]) + bytes(4 * n) for n in (1, 0, 2, 0))
    + b"".join(bytes([n]) + bytes(4 * n + 4) for n in (4, 3)),
    "obj": saved(MESH, "obj"),
    "off": saved(Cloud(MESH.points, faces=FACES), "off"),
    "csv": b"x,y,z,red,green,blue,class\n1.5,2.5,3.5,10,20,30,2\n4,5,6,40,50,60,2\n",
    "xyz": b"# a cloud\n1.5 2.5 3.5\n-4e0 5 6\n7 8 9\n",
    "asc": b"450000.125 5200000.5 3 17\n450001 5200001 4 18\n",
    "tsv": "\ufeffEasting\tNorthing\tH\u00f6he\n1\t2\t3\n4\t5\t6\n".encode(),
    "txt": b"x;y;z;nx;ny;nz\n1;2;3;0;0;1\n4;5;6;0;1;0\n",
    "off polygons": b"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2\n",
    "npy": npy(MESH.points),
    "npy columns": npy(np.zeros(3, dtype=[("x", "<f4"), ("y", ">f8"), ("red", "u1")])),
    "npz": saved(MESH, "npz"),
    "npz deflated": saved(small_mesh(), "npz", compressed=True),
    "stl": saved(small_mesh(), "stl"),
    "stl text": b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
    b"vertex 0 1 0\nendloop\nendfacet\nendsolid\n",
    "glb": saved(small_mesh(), "glb"),
    "gltf": saved(small_mesh(), "gltf"),
}

# What has an end, or counts what it holds: cut short it is never taken for a smaller file.
NEVER_SHORTER = {
    "ply", "ply polygons", "npy", "npy columns", "npz", "npz deflated", "stl", "stl text", "glb",
    "gltf",
}  # fmt: skip

TEXT = {"xyz", "csv", "txt", "asc", "tsv"}


def sample(key: str) -> tuple[bytes, str]:
    return SAMPLES[key], key.split(maxsplit=1)[0]


def outcome(data: bytes, kind: str) -> Cloud | str:
    """Read a broken file: what comes of it is a cloud that can be written, or a FormatError."""
    try:
        cloud = loaded(data, kind)
    except FormatError as error:
        message = str(error)
        assert message.startswith("<stream>: ")
        return message
    saved(Cloud(cloud.points, faces=cloud.faces), "ply")
    return cloud


@pytest.mark.parametrize("key", SAMPLES)
def test_the_sample_itself_is_whole(key: str) -> None:
    assert isinstance(outcome(*sample(key)), Cloud)


@pytest.mark.parametrize("key", SAMPLES)
def test_cut_short_at_every_byte(key: str) -> None:
    data, kind = sample(key)
    whole = loaded(data, kind)
    for size in range(len(data) - 1):
        found = outcome(data[:size], kind)
        if key in NEVER_SHORTER:
            assert isinstance(found, str), size
        elif isinstance(found, Cloud):
            # Text that ends between numbers, or inside one, may be a shorter file that is whole.
            assert len(found) <= len(whole)


@pytest.mark.slow
@pytest.mark.parametrize("key", SAMPLES)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_every_bit_turned(key: str) -> None:
    data, kind = sample(key)
    # Of long files, and of those that take trimesh a millisecond, one bit in 17.
    step = 17 if len(data) > 700 or kind in {"stl", "glb", "gltf"} else 1
    for bit in range(0, 8 * len(data), step):
        broken = bytearray(data)
        broken[bit // 8] ^= 1 << (bit % 8)
        outcome(bytes(broken), kind)


@pytest.mark.parametrize("key", SAMPLES)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_changed_bytes(key: str) -> None:
    data, kind = sample(key)
    random = np.random.default_rng(sum(key.encode()))
    for _ in range(250):
        broken = bytearray(data)
        for at in random.integers(0, len(data), random.integers(1, 4)):
            broken[at] = random.integers(0, 256)
        outcome(bytes(broken), kind)


@pytest.mark.parametrize("key", SAMPLES)
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_bytes_lost_repeated_and_added(key: str) -> None:
    data, kind = sample(key)
    random = np.random.default_rng(sum(key.encode()))
    for _ in range(100):
        first, last = sorted(random.integers(0, len(data), 2))
        last = min(last, first + 40)
        outcome(data[:first] + data[last:], kind)
        outcome(data[:last] + data[first:], kind)
        outcome(data[:first] + random.bytes(5) + data[first:], kind)


@pytest.mark.parametrize("kind", sorted({key.split()[0] for key in SAMPLES}))
def test_files_of_another_kind(kind: str) -> None:
    for key in SAMPLES:
        data, other = sample(key)
        if other != kind and not {kind, other} <= TEXT:  # text is one format of many suffixes
            assert isinstance(outcome(data, kind), str), (kind, other)


@pytest.mark.parametrize("kind", sorted({key.split()[0] for key in SAMPLES}))
def test_random_bytes(kind: str) -> None:
    random = np.random.default_rng(7)
    for size in (1, 2, 3, 10, 84, 134, 1000, 10_000):
        for data in (random.bytes(size), bytes(size), b"\n" * size, b" " * size, b"9" * size):
            assert isinstance(outcome(data, kind), str), (size, data[:10])


def test_warnings_of_broken_files_are_errors_outside_of_tests_too() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        text = (
            b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 x 0\n"
        )
        with pytest.raises(FormatError, match="line 6, value 2: 'x' is not a number"):
            loaded(text + b"endloop\nendfacet\nendsolid\n", "stl")
