"""E57: the points of all scans, in the coordinates that they share."""

from __future__ import annotations

import io
import struct
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from commands import liftmesh
from file_samples import assert_same_bits
from files.e57 import PAGE, Scan, e57, with_checksums, with_xml

import liftmesh as lm
from liftmesh import Cloud, FormatError
from liftmesh.io.formats.e57 import decoding

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
    assert cloud.metadata["not_read"] == ("intensity (of some scans)",)


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
    assert cloud.metadata["not_read"] == ("40 points without a valid position",)
    steps = np.array([-50.001, 0.002, 7.25])
    scale = {"cartesianX": (0.001, 400.0)}
    cloud = read(e57(Scan(dict.fromkeys(PLACES, steps), scaled=scale)))
    assert_same_bits(cloud.points[:, 0], np.rint((steps - 400) / 0.001) * 0.001 + 400)
    assert cloud.points[:, 1].tolist() == steps.tolist()


COLORS = ("colorRed", "colorGreen", "colorBlue")


def colored(top: float | None, *values: int, kind: str = "u2", name: str = "a scan") -> Scan:
    """Make a scan of grey points that states its largest colour."""
    limits = {} if top is None else dict.fromkeys([f"{each}Maximum" for each in COLORS], top)
    greys = dict.fromkeys(COLORS, np.array(values, kind))
    places = {key: each[: len(values)] for key, each in PLACES.items()}
    return Scan({**places, **greys}, name, limits={"colorLimits": limits})


DEPTHS = {
    "8 and 16 bits": ([colored(255, 0, 7, 255), colored(65535, 9)], [0, 7 * 257, 65535, 9]),
    "8 bits by type": ([colored(None, 7, kind="u1"), colored(65535, 9)], [7 * 257, 9]),
    "nothing stated": ([colored(None, 7, kind="u1"), colored(None, 300)], [7 * 257, 300]),
    "8 bits in wide types": ([colored(255, 7, 255), colored(255, 9)], [7, 255, 9]),
    "dark": ([colored(65535, 7)], [7]),
    "dark and 8 bits": ([colored(65535, 7), colored(255, 1)], [7, 257]),
    "10 bits": ([colored(1023, 0, 512, 1023)], [0, 32800, 65535]),
    "no number of bits": ([colored(200, 7), colored(300, 9)], [7 * 257, 9]),
    "no limits": ([colored(0, 7), colored(-1, 200)], [7, 200]),
    "empty": ([colored(255), colored(65535, 9), colored(255)], [9]),
}


@pytest.mark.parametrize("case", DEPTHS)
def test_colours_of_scans_have_one_depth(case: str) -> None:
    scans, expected = DEPTHS[case]
    cloud = read(e57(*scans))
    depth = 8 if case in {"8 bits in wide types", "no limits"} else 16
    assert cloud.colors is not None
    assert_same_bits(
        cloud.colors, np.repeat(np.array(expected, f"u{depth // 8}"), 3).reshape(-1, 3)
    )
    assert "notes" not in cloud.metadata


def test_limits_that_scans_do_not_keep_are_said(tmp_path: Path) -> None:
    data = e57(colored(255, 300, 7, name="wrong"), colored(255, 1, kind="u1"))
    (tmp_path / "a.e57").write_bytes(data)
    cloud = read(data)
    assert cloud.colors is not None
    assert cloud.colors[:, 0].tolist() == [300, 7, 257]
    assert cloud.metadata["notes"] == ("colours beyond the limits that scans state: 'wrong'",)
    done = liftmesh("triangulate", "a.e57", "a.ply", cwd=tmp_path)
    assert "colours beyond the limits that scans state: 'wrong'" in done.stderr
    values = {"intensity": np.array([0.5])}
    places = {key: each[:1] for key, each in PLACES.items()}
    each = [
        Scan(places | values, limits={"intensityLimits": {"intensityMaximum": top}})
        for top in (1.0, 255.0)
    ]
    assert "notes" not in read(e57(each[0], each[0])).metadata
    assert read(e57(*each)).metadata["notes"] == ("intensities of scans have different limits",)


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
        "the XML is damaged": with_checksums(data[:place] + b"<!DOCTYPE" + data[place + 9 :]),
        "places the description outside": with_checksums(
            data[:24] + (PAGE - 2).to_bytes(8, "little") + data[32:]
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


XSI = 'xmlns:x="http://www.w3.org/2001/XMLSchema-instance"'
ROOT = '<e57Root type="Structure"'
FOREIGN = {
    f'{XSI} x:schemaLocation="a http://127.0.0.1:9/s.xsd"': "the attribute schemaLocation of 'http",
    f'{XSI} x:noNamespaceSchemaLocation="file:///etc/hosts"': "attribute noNamespaceSchemaLocation",
    f'{XSI} x:type="a"': "has the attribute type of 'http://www.w3.org/2001/XMLSchema-instance'",
    'xml:base="file:///etc/"': "has the attribute base of",
    'x:schemaLocation="a b"': "is damaged: unbound prefix",
}
DECLARED = {
    "<!DOCTYPE a [<!ENTITY b SYSTEM 'file:///etc/hosts'>]>": "declares a document type",
    "<!DOCTYPE\na SYSTEM 'http://127.0.0.1:9/a.dtd'>": "declares a document type",
    "<!ENTITY a 'b'>": "is damaged",
}
ENCODINGS = ("UTF-16", "UTF-7", "ISO-8859-1", "IBM037", "nonsense")


def refused_at_once(data: bytes, cause: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Read a file that no process may see."""
    monkeypatch.setattr(decoding.subprocess, "Popen", lambda *_, **__: pytest.fail("started"))
    with pytest.raises(FormatError, match=f"<stream>: the (XML|descr).*{cause}"):
        read(data)


@pytest.mark.parametrize("attribute", FOREIGN)
@pytest.mark.parametrize("where", [ROOT, '<data3D type="Vector"', "<guid"])
def test_no_schema_is_named(attribute: str, where: str, monkeypatch: pytest.MonkeyPatch) -> None:
    data = with_xml(e57(Scan(FEW)), where, f"{where} {attribute} ")
    refused_at_once(data, FOREIGN[attribute], monkeypatch)


@pytest.mark.parametrize("text", DECLARED)
def test_nothing_is_declared(text: str, monkeypatch: pytest.MonkeyPatch) -> None:
    data = with_xml(e57(Scan(FEW)), ROOT, f"{text}{ROOT}")
    refused_at_once(data, DECLARED[text], monkeypatch)


def test_the_description_is_xml_1_0_of_utf_8(monkeypatch: pytest.MonkeyPatch) -> None:
    data = e57(Scan(FEW))
    assert len(read(with_xml(data, ' encoding="UTF-8"', ""))) == 50
    refused_at_once(with_xml(data, 'version="1.0"', 'version="1.1"'), "is XML 1.1", monkeypatch)
    for each in ENCODINGS:
        named = with_xml(data, 'encoding="UTF-8"', f'encoding="{each}"')
        refused_at_once(named, f"is XML 1.0 in {each}", monkeypatch)
    for each in ("UTF-16-LE", "UTF-16-BE", "UTF-16", "UTF-32", "cp037", "UTF-8-SIG"):
        found = bytearray(data)
        place, length = struct.unpack_from("<2Q", data, 24)
        text = f"<?xml?><!DOCTYPE a []>{'<a/>' * 100}".encode(each)[: min(length, 400)]
        found[place : place + len(text)] = text
        refused_at_once(with_checksums(bytes(found)), "is no XML of UTF-8", monkeypatch)


NAMES = "".join(f"<a{k}/>" for k in range(99))
SPACES = " ".join(f"xmlns:a{k}='{k}'" for k in range(9000))
CROWDS = {
    "names": "".join(f'<a{k} type="Integer"/>' for k in range(9000)),
    "spaces": f"<a {SPACES}/>",
    "types": f'<a type="Vector">{"<b/>" * 9000}</a>',
    "types of many": f'<a type="Vector">{f"<b>{NAMES}</b>" * 300}</a>',
    "depth": '<a type="Structure">' * 5000 + "</a>" * 5000,
}


@pytest.mark.parametrize("crowd", CROWDS)
def test_crowds_of_elements_take_no_quadratic_time(
    crowd: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    data = with_xml(e57(Scan(FEW)), "</e57Root>", f"{CROWDS[crowd]}</e57Root>")
    refused_at_once(data, "has too many elements beside or within", monkeypatch)


def test_a_negative_number_of_points() -> None:
    data = with_xml(e57(Scan(FEW)), 'recordCount="50"', 'recordCount="-1"')
    with pytest.raises(FormatError, match="<stream>: the scan 'a scan' states -1 points"):
        read(data)
    data = with_xml(e57(Scan(FEW)), 'recordCount="50"', 'recordCount="51"')
    with pytest.raises(FormatError, match="of 51 points of a scan are missing"):
        read(data)


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


@pytest.mark.slow
def test_a_process_that_takes_too_much_is_ended(monkeypatch: pytest.MonkeyPatch) -> None:
    data = e57(Scan(FEW))
    limits = decoding.Limits
    monkeypatch.setattr(limits, "of", lambda *_: limits(1 << 28, 1))
    endless = decoding.PROGRAM.replace("image = libe57", "while True: pass\n    image = libe57")
    fat = decoding.PROGRAM.replace("image = libe57", "_ = bytearray(1 << 29)\n    image = libe57")
    monkeypatch.setattr(decoding, "PROGRAM", endless)
    with pytest.raises(FormatError, match=r"<stream>: libE57 does not decode it in 1 s, the limit"):
        read(data)
    monkeypatch.setattr(limits, "of", lambda *_: limits(1 << 28, 300))
    monkeypatch.setattr(decoding, "PROGRAM", fat)
    with pytest.raises(FormatError, match=r"libE57 needs more than 268,435,456 bytes to decode it"):
        read(data)


def test_the_process_may_take_more_for_larger_files() -> None:
    least, large, long = (decoding.Limits.of(*each) for each in ((0, 0), (0, 10**9), (10**9, 0)))
    assert (large.memory - least.memory, large.seconds) == (10**9, least.seconds)
    assert (long.memory, long.seconds > least.seconds) == (least.memory, True)


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
