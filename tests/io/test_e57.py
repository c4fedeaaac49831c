"""E57: the points of all scans, in the coordinates that they share."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beside.e57_files import PAGE, Scan, e57, with_checksums
from commands import liftmesh
from file_samples import assert_same_bits

import liftmesh as lm
from liftmesh import Cloud, FormatError
from liftmesh.io.e57 import decoding

RNG = np.random.default_rng(3)
ROWS = 70_000  # more than a piece
X, Y, Z = RNG.random((3, ROWS)) * 1e-3 + np.array([[450000.1], [5200000.7], [0.3]])
PLACES = {"cartesianX": X, "cartesianY": Y, "cartesianZ": Z}
FEW = {key: each[:50] for key, each in PLACES.items()}


def read(data: bytes, **options: Any) -> Cloud:
    return lm.read(io.BytesIO(data), format="e57", **options)


def test_every_value_of_a_scan() -> None:
    values = {
        "colorRed": RNG.integers(0, 256, ROWS, np.uint8),
        "colorGreen": RNG.integers(0, 256, ROWS, np.uint8),
        "colorBlue": RNG.integers(0, 256, ROWS, np.uint8),
        "intensity": RNG.random(ROWS).astype(np.float32),
        "rowIndex": RNG.integers(0, 65536, ROWS, np.uint16),
        "timeStamp": RNG.random(ROWS),
        "returnIndex": RNG.integers(-100, 100, ROWS, np.int8),
        "columnIndex": RNG.integers(-(2**40), 2**40, ROWS).astype(np.longlong),
    }
    cloud = read(e57(Scan({**PLACES, **values}), crs="EPSG:25832"))
    assert_same_bits(cloud.points, np.column_stack([X, Y, Z]))
    assert cloud.colors is not None
    assert_same_bits(cloud.colors, np.column_stack([values.pop(key) for key in [*values][:3]]))
    assert list(cloud.attributes) == [*values]
    for key, each in values.items():
        assert_same_bits(cloud.attributes[key], each.astype(each.dtype.newbyteorder("=")))
    assert cloud.crs == "EPSG:25832"
    assert cloud.metadata["e57"] == {"scans": ({"name": "a scan", "points": ROWS},)}


def test_scans_are_moved_by_their_poses() -> None:
    turned = ((np.sqrt(0.5), 0, 0, np.sqrt(0.5)), (100.0, 200.0, 5.0))  # by 90 degrees about z
    cloud = read(
        e57(
            Scan({**FEW, "intensity": np.arange(50.0)}, "first"),
            Scan({key: np.arange(3.0) for key in PLACES}, "second", turned),
            Scan({key: np.zeros(0) for key in PLACES}, "empty"),
            Scan(FEW, "moved", ((1, 0, 0, 0), (1000.0, 0.0, 0.0))),
        )
    )
    assert_same_bits(cloud.points[:50], np.column_stack([X, Y, Z])[:50])
    expected = [[100.0 - k, 200.0 + k, 5.0 + k] for k in range(3)]
    assert np.allclose(cloud.points[50:53], expected, rtol=0, atol=1e-12)
    assert_same_bits(cloud.points[53:, 0], X[:50] + 1000.0)
    assert_same_bits(cloud.points[53:, 1], Y[:50])
    assert cloud.attributes["scan"].tolist() == [0] * 50 + [1] * 3 + [3] * 50
    assert cloud.metadata["skipped"] == ("intensity (of some scans)",)


def test_spheres_steps_and_states() -> None:
    angle = np.linspace(-3, 3, 60)
    sphere = {
        "sphericalRange": 5 + angle,
        "sphericalAzimuth": angle,
        "sphericalElevation": angle / 3,
    }
    state = (np.arange(60) % 3).astype(np.int8)
    cloud = read(e57(Scan({**sphere, "sphericalInvalidState": state})))
    across = sphere["sphericalRange"] * np.cos(angle / 3)
    x, y = across * np.cos(angle), across * np.sin(angle)
    z = sphere["sphericalRange"] * np.sin(angle / 3)
    assert_same_bits(cloud.points, np.column_stack([x, y, z])[::3])
    assert cloud.metadata["skipped"] == ("40 points without a valid position",)
    steps = np.array([-50.001, 0.002, 7.25])
    scale = {"cartesianX": (0.001, 400.0)}
    cloud = read(e57(Scan(dict.fromkeys(PLACES, steps), scaled=scale)))
    assert_same_bits(cloud.points[:, 0], np.rint((steps - 400) / 0.001) * 0.001 + 400)
    assert cloud.points[:, 1].tolist() == steps.tolist()


def test_the_command_line(tmp_path: Path) -> None:
    (tmp_path / "a.e57").write_bytes(e57(Scan(FEW)))
    done = liftmesh("triangulate", "a.e57", "a.ply", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert_same_bits(lm.read(tmp_path / "a.ply").points, np.column_stack([X, Y, Z])[:50])
    assert [each.name for each in tmp_path.iterdir() if each.suffix not in {".e57", ".ply"}] == []


def test_what_is_refused() -> None:
    data = e57(Scan(FEW))
    flipped = bytearray(data)
    flipped[100] ^= 1
    place = data.index(b"<data3D")
    declared = data.replace(b'<?xml version="1.0"', b"<!DOCTYPE a []><?x ", 1)
    wanting = with_checksums(
        data.replace(b"<cartesianX", b"<cartesianW").replace(b"/cartesianX", b"/cartesianW")
    )
    cases = {
        "<stream>: not an E57 file": b"ply" * 100,
        "the header states .* bytes, but the file has": data[:-100],
        "decoded: checksum mismatch": bytes(flipped),
        "is no XML of UTF-8": with_checksums(declared),
        "the XML declares a document type": with_checksums(
            data[:place] + b"<!DOCTYPE" + data[place + 9 :]
        ),
        "has neither cartesianX, cartesianY and cartesianZ nor range": wanting,
        "version 2 cannot be read": with_checksums(data[:8] + b"\2" + data[9:]),
    }
    for cause, each in cases.items():
        with pytest.raises(FormatError, match=cause):
            read(each)
    many = e57(Scan({key: each[:500] for key, each in PLACES.items()}))
    with pytest.raises(FormatError, match="500 points expands to 12,000 bytes, more than the lim"):
        read(many, max_bytes=11_999)
    assert len(read(many, max_bytes=12_000)) == 500


def test_damage_with_the_right_checksums_ends_no_process() -> None:
    data = e57(Scan({**FEW, "intensity": np.arange(50, dtype=np.uint16)}))
    first = data.index(b"recordCount=") if b"recordCount=" in data else data.index(b"data3D")
    places = [56, 64, PAGE // 10, 200, first + 13, *RNG.integers(48, len(data), 3)]
    for place in map(int, places):
        damaged = bytearray(data)
        damaged[place : place + 2] = b"97"
        found = read_or_cause(with_checksums(bytes(damaged)))
        assert found.startswith("<stream>: ") or found == "50 rows"


def read_or_cause(data: bytes) -> str:
    try:
        return f"{len(read(data))} rows"
    except FormatError as error:
        return str(error)


def test_a_process_that_dies_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    data = e57(Scan(FEW))
    for program in ("import os; os.abort()", "print('{', end='')", "raise MemoryError"):
        monkeypatch.setattr(decoding, "PROGRAM", program)
        with pytest.raises(
            FormatError, match=r"<stream>: the file cannot be decoded: libE57 ended"
        ):
            read(data)


def test_a_process_that_takes_too_much_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    data = e57(Scan(FEW))
    limits = decoding.Limits
    monkeypatch.setattr(limits, "of", lambda *_: limits(1 << 28, 1))
    endless = decoding.PROGRAM.replace("image = libe57", "while True: pass\n    image = libe57")
    fat = decoding.PROGRAM.replace("image = libe57", "_ = bytearray(1 << 29)\n    image = libe57")
    monkeypatch.setattr(decoding, "PROGRAM", endless)
    with pytest.raises(FormatError, match=r"<stream>: libE57 does not decode it in 1 s, the limit"):
        read(data)
    monkeypatch.setattr(decoding, "PROGRAM", fat)
    with pytest.raises(FormatError, match=r"libE57 needs more than 268,435,456 bytes to decode it"):
        read(data)


def test_the_hint_without_pye57(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    data = e57(Scan(FEW))
    library = [each for each in sys.path if "site-packages" not in each]
    monkeypatch.setattr(sys, "path", [str(tmp_path), *library])
    with pytest.raises(lm.MissingDependencyError, match=r"pip install 'liftmesh\[e57\]'"):
        read(data)
    (tmp_path / "pye57").mkdir()
    (tmp_path / "pye57" / "__init__.py").write_text("")
    (tmp_path / "pye57" / "libe57.py").write_text("raise ImportError('a library is missing')")
    with pytest.raises(lm.MissingDependencyError, match="a library is missing"):
        read(data)
