"""Members of NPZ files: read exactly as far as the directory of the archive states."""

from __future__ import annotations

import errno
import io
import json
import random
import struct
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest
from failing_stream import Failing
from faults.children import output
from file_samples import loaded
from growth.resident import forked
from lzma_encoder import without_marker
from zip_archives import BZIP2, DEFLATED, LZMA, METHODS, STORED, archive, packed

import liftmesh
from liftmesh import FormatError
from liftmesh.cli import exit_codes, main


def npy(array: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, array)
    return stream.getvalue()


POINTS = np.random.default_rng(0).random((70, 3))
CONTENT = npy(POINTS)


def in_chunks(data: bytes) -> np.ndarray:
    chunks = liftmesh.read_chunks(io.BytesIO(data), rows=9, format="npz")
    return np.concatenate([chunk.points for chunk in chunks])


def refused(data: bytes, cause: str) -> None:
    with pytest.raises(FormatError, match=rf"<stream>: points\.npy: .*{cause}"):
        loaded(data, "npz")
    with pytest.raises(FormatError, match=rf"<stream>: points\.npy: .*{cause}"):
        in_chunks(data)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("rows", [1, 70, 60_000])
def test_every_method_is_read_whole_and_in_chunks(method: int, rows: int) -> None:
    points = np.random.default_rng(1).random((rows, 3))
    content = npy(points)
    data = archive(packed(method, content), content, method=method)
    assert np.array_equal(loaded(data, "npz").points, points)
    assert np.array_equal(in_chunks(data), points) or rows > 70
    with np.load(io.BytesIO(data)) as arrays:  # so it is an archive, not one that only we read
        assert np.array_equal(arrays["points"], points)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("more", [1, 17, 1 << 20])
def test_data_that_go_on_are_refused(method: int, more: int) -> None:
    refused(archive(packed(method, CONTENT + bytes(more)), CONTENT, method=method), "go on after")


@pytest.mark.parametrize("method", METHODS)
def test_bytes_after_the_end_of_the_data_are_refused(method: int) -> None:
    for more in (b"\0", bytes(1 << 17)):
        data = packed(method, CONTENT) + more
        refused(archive(data, CONTENT, method=method), "go on after")


@pytest.mark.parametrize("method", METHODS)
def test_data_that_end_early_are_refused(method: int) -> None:
    for less in (1, 200, len(CONTENT)):
        short = CONTENT[: len(CONTENT) - less]
        refused(
            archive(packed(method, short), CONTENT, method=method), "end|header|cannot decompress"
        )
    cut = packed(method, CONTENT)
    refused(archive(cut[: len(cut) // 2], CONTENT, method=method), "end")


@pytest.mark.parametrize("method", METHODS)
def test_damaged_data_are_refused(method: int) -> None:
    rng, good = random.Random(method), packed(method, CONTENT)
    for _ in range(200):
        data = bytearray(good)
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        try:
            read = loaded(archive(bytes(data), CONTENT, method=method), "npz").points
        except FormatError:
            pass
        else:  # a bit without meaning, as in the size of LZMA's dictionary
            assert np.array_equal(read, POINTS)
        if method == LZMA:
            with pytest.raises(FormatError, match=r"points\.npy: "):
                in_chunks(archive(bytes([*data[:40], 0, 0, *data[42:]]), CONTENT, method=method))


def test_lzma_without_an_end_marker_is_read_to_its_end() -> None:
    data = archive(without_marker(CONTENT), CONTENT, method=LZMA, flags=0)
    assert np.array_equal(loaded(data, "npz").points, POINTS)
    assert np.array_equal(in_chunks(data), POINTS)
    with np.load(io.BytesIO(data)) as arrays:
        assert np.array_equal(arrays["points"], POINTS)


@pytest.mark.parametrize("more", [1, 17, 1 << 12, 1 << 24])
def test_lzma_without_an_end_marker_that_goes_on_is_refused(more: int) -> None:
    data = packed(LZMA, CONTENT + bytes(more))
    refused(archive(data, CONTENT, method=LZMA, flags=0), "Corrupt input data|go on after")
    if more < 1 << 20:
        data = without_marker(CONTENT + bytes(more))
        refused(archive(data, CONTENT, method=LZMA, flags=0), "Corrupt input data|go on after")
        data = without_marker(CONTENT) + bytes(more)
        refused(archive(data, CONTENT, method=LZMA, flags=0), "Corrupt input data|go on after")


@pytest.mark.parametrize(
    "head", [b"\x09\x04", b"\x09\x04\x05\x00", b"\x09\x04\x04\x00" + bytes(20)]
)
def test_lzma_without_its_properties_is_refused(head: bytes) -> None:
    refused(archive(head, CONTENT, method=LZMA), "LZMA properties")


def test_lzma_takes_no_dictionary_beyond_its_content() -> None:
    data = bytearray(packed(LZMA, CONTENT))
    data[5:9] = b"\xff\xff\xff\xff"  # 4 GiB
    program = """
        import sys, io, liftmesh, lzma
        limit(200_000_000)
        print(len(liftmesh.read(io.BytesIO(bytes.fromhex(sys.argv[1])), format="npz")))
    """
    told = output(program, archive(bytes(data), CONTENT, method=LZMA).hex())
    assert told.split() == ["70"]


CRC, SIZE = zlib.crc32(CONTENT), len(CONTENT)


@pytest.mark.parametrize(
    "local",
    [
        (DEFLATED, CRC, SIZE, SIZE),
        (STORED, CRC + 1, SIZE, SIZE),
        (STORED, CRC, SIZE - 1, SIZE),
        (STORED, CRC, SIZE, SIZE + 1),
        (STORED, 0, 0, 0),
        (STORED, CRC, 2**32 - 1, 2**32 - 1),
    ],
)
def test_a_header_that_contradicts_the_directory_is_refused(
    local: tuple[int, int, int, int],
) -> None:
    cause = "ZIP64 sizes are missing" if local[2] == 2**32 - 1 else "contradicts the directory"
    refused(archive(CONTENT, CONTENT, local=local), cause)


def test_sizes_that_follow_the_data_are_those_of_the_directory() -> None:
    for local in ((STORED, 0, 0, 0), (STORED, CRC, SIZE, SIZE)):
        data = archive(CONTENT, CONTENT, flags=8, local=local)
        assert np.array_equal(loaded(data, "npz").points, POINTS)
    refused(archive(CONTENT, CONTENT, flags=8, local=(STORED, 0, 3, 0)), "contradicts")


def test_sizes_in_the_extra_field_are_compared_too() -> None:
    large = (STORED, CRC, 2**32 - 1, 2**32 - 1)
    for sizes, fits in (((SIZE, SIZE), True), ((SIZE + 1, SIZE), False), ((SIZE, 0), False)):
        extra = b"ab\1\0c" + struct.pack("<2H2Q", 1, 16, *sizes)
        data = archive(CONTENT, CONTENT, local=large, extra=extra)
        if fits:
            assert np.array_equal(loaded(data, "npz").points, POINTS)
        else:
            refused(data, "contradicts the directory")
    refused(archive(CONTENT, CONTENT, local=large, extra=b"\1\0\x10\0abc"), "ZIP64 sizes")


def test_members_that_cannot_be_read_are_refused() -> None:
    refused(archive(CONTENT, CONTENT, flags=1), "it is encrypted")
    for method in (1, 6, 93, 99):
        refused(archive(CONTENT, CONTENT, method=method), f"method, {method}, is not supported")
    refused(archive(CONTENT, CONTENT, flags=1 << 5), "not supported")
    good = archive(CONTENT, CONTENT)
    refused(good.replace(b"points", b"pointz", 1), "contradicts the directory")
    refused(good.replace(b"PK\3\4", b"PK\3\5"), "no header in front")
    refused(
        good.replace(b"\x00\x00\x00\x00points.npyPK", b"\x00\x01\x00\x00points.npyPK"), "header"
    )


def test_the_checksum_is_checked() -> None:
    wrong = bytearray(CONTENT)
    wrong[-1] ^= 1
    refused(archive(bytes(wrong), CONTENT), r"checksum \(CRC-32\) is wrong")


@pytest.mark.parametrize("method", [BZIP2, LZMA])
def test_three_kilobytes_do_not_take_a_gigabyte(method: int) -> None:
    data = archive(packed(method, CONTENT + bytes(100 << 20)), CONTENT, method=method)
    assert len(data) < 20_000
    program = """
        import io, json, sys, liftmesh
        data = sys.stdin.buffer.read() if len(sys.argv) < 2 else bytes.fromhex(sys.argv[1])
        told = []
        liftmesh.read(io.BytesIO(b"x,y\\n0,0\\n"), format="csv")
        before = status("VmHWM")
        for read in (liftmesh.read, lambda *a, **k: list(liftmesh.read_chunks(*a, **k))):
            try:
                read(io.BytesIO(data), format="npz")
            except liftmesh.FormatError as error:
                told.append(str(error))
        print(json.dumps([told, status("VmHWM") - before]))
    """
    told, grown = json.loads(output(program, data.hex()))
    assert [each[-40:] for each in told] == [told[0][-40:]] * 2
    assert "go on after" in told[0]
    assert grown < 20_000_000


def test_a_limit_of_the_content_is_told() -> None:
    stream = io.BytesIO()
    np.savez(stream, points=POINTS, faces=np.zeros((1000, 3), int), k=np.zeros(70))
    data = stream.getvalue()
    whole = 70 * 24 + 1000 * 24 + 70 * 8 + 3 * 128
    limit = f"expands to {whole:,} bytes, more than the limit of {whole - 1:,}: .*max_bytes="
    with pytest.raises(FormatError, match=limit):
        liftmesh.read(io.BytesIO(data), format="npz", max_bytes=whole - 1)
    assert len(liftmesh.read(io.BytesIO(data), format="npz", max_bytes=whole)) == 70
    used = whole - 1000 * 24 - 128
    chunks = liftmesh.read_chunks(io.BytesIO(data), format="npz", rows=9, max_bytes=used)
    assert sum(map(len, chunks)) == 70
    with pytest.raises(FormatError, match=f"more than the limit of {used - 1:,}"):
        next(liftmesh.read_chunks(io.BytesIO(data), format="npz", max_bytes=used - 1))


UNBOUNDED = (BZIP2, LZMA)  # they compress zeros more than 1,100-fold
GIGABYTES = 4_000_000_000


def zeros(rows: int, stated: int) -> bytes:
    """The content of a member of ``rows`` rows whose header states more."""
    head = npy(np.zeros((1, 3)))[:-24].replace(b"(1, 3)", b"(%d, 3)" % stated)
    return b"\x93NUMPY\1\0\x76\0" + head[10:-1].rstrip().ljust(117) + b"\n" + bytes(24 * rows)


@pytest.fixture(scope="module", params=UNBOUNDED)
def bomb(request: pytest.FixtureRequest) -> bytes:
    """An archive of a few kilobytes that states four gigabytes, the first of which are there."""
    content = zeros(10**6, (GIGABYTES - 128) // 24)
    return archive(packed(request.param, content), content, method=request.param, size=GIGABYTES)


@pytest.mark.parametrize("method", UNBOUNDED)
def test_zeros_may_be_compressed_as_far_as_the_method_does(method: int) -> None:
    content = zeros(10**6, 10**6)
    data = archive(packed(method, content), content, method=method)
    assert len(content) > 1100 * len(data)
    for cloud in (loaded(data, "npz"), *liftmesh.read_chunks(io.BytesIO(data), format="npz")):
        assert cloud.points.shape == (10**6, 3)
        assert not cloud.points.any()
    limit = f"expands to 24,000,128 bytes, more than the limit of {24_000_127:,}"
    with pytest.raises(FormatError, match=limit):
        liftmesh.read(io.BytesIO(data), format="npz", max_bytes=24_000_127)


def test_gigabytes_in_kilobytes_are_refused_with_the_option(
    bomb: bytes, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert len(bomb) < 10_000
    limit = "its content expands to 4,000,000,000 bytes, more than the limit of 268,435,456: "
    with pytest.raises(FormatError, match=f"{limit}.*max_bytes="):
        liftmesh.read(io.BytesIO(bomb), format="npz")
    with pytest.raises(FormatError, match=f"{limit}.*max_bytes="):
        next(liftmesh.read_chunks(io.BytesIO(bomb), format="npz"))
    path = tmp_path / "bomb.npz"
    path.write_bytes(bomb)
    assert main(["info", str(path)]) == exit_codes.BAD_INPUT
    told = capsys.readouterr().err
    assert limit in told
    assert told.endswith("raise it with --max-bytes SIZE\n")


def test_with_a_limit_the_stated_size_decides(bomb: bytes) -> None:
    def chunk(limit: int) -> liftmesh.Cloud:
        stream = io.BytesIO(bomb)
        return next(liftmesh.read_chunks(stream, rows=1000, format="npz", max_bytes=limit))

    assert not chunk(GIGABYTES).points.any()
    with pytest.raises(FormatError, match="more than the limit of 3,999,999,999"):
        chunk(GIGABYTES - 1)


def test_what_bounded_methods_cannot_make_stays_impossible() -> None:
    for method in (STORED, DEFLATED):
        data = archive(packed(method, CONTENT), CONTENT, method=method, size=GIGABYTES)
        with pytest.raises(FormatError, match="bytes cannot decompress to 4000000000"):
            liftmesh.read(io.BytesIO(data), format="npz", max_bytes=10**12)


def test_many_members_share_one_limit() -> None:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_BZIP2) as members:
        for name in ("points", "faces"):
            members.writestr(f"{name}.npy", CONTENT)
    size, stated = struct.pack("<L", len(CONTENT)), struct.pack("<L", 150_000_000)
    with pytest.raises(
        FormatError, match="expands to 300,000,000 bytes, more than the limit of 268"
    ):
        loaded(stream.getvalue().replace(size, stated), "npz")


@pytest.mark.parametrize("method", UNBOUNDED)
def test_headers_of_arrays_are_not_read_without_bound(method: int) -> None:
    content = b"\x93NUMPY\2\0" + struct.pack("<L", GIGABYTES) + bytes(100 << 20)
    data = bytearray(archive(packed(method, content), content, method=method, size=GIGABYTES))
    if method == LZMA:
        at = data.index(b"\x09\x04\x05\x00") + 5
        data[at : at + 4] = b"\xff\xff\xff\xff"  # a dictionary of 4 GiB

    def read() -> str:
        try:
            next(liftmesh.read_chunks(io.BytesIO(data), format="npz"))
        except FormatError as error:
            return str(error)
        return "read"

    grown, told = forked(read, 100_000_000)
    assert "its header is invalid" in told
    assert grown < 20_000_000


def test_members_are_read_in_turns() -> None:
    stream = io.BytesIO()
    np.savez_compressed(stream, points=POINTS, k=np.arange(70), text=np.array(["a"] * 70))
    stream.seek(0)
    parts = [*liftmesh.read_chunks(stream, rows=11, format="npz")]
    assert np.concatenate([part.attributes["k"] for part in parts]).tolist() == [*range(70)]


@pytest.mark.parametrize("method", METHODS)
def test_errors_of_the_stream_are_no_errors_of_the_archive(method: int) -> None:
    data = archive(packed(method, CONTENT), CONTENT, method=method)
    error = OSError(errno.EIO, "Input/output error")
    for place in (0, 45, len(data) - 110 - 30, len(data) - 60, len(data) - 3):
        for read in (liftmesh.read, lambda *a, **k: [*liftmesh.read_chunks(*a, **k)]):
            with pytest.raises(OSError, match="Input/output error") as told:
                read(Failing(data, range(place, place + 1), error), format="npz")
            assert told.value is error


def test_an_error_that_the_caller_handles_is_not_that_of_the_archive(tmp_path: Path) -> None:
    try:
        (tmp_path / "another file").read_bytes()
    except OSError:
        with pytest.raises(FormatError, match="not a valid NPZ file: File is not a zip file"):
            loaded(b"no archive at all", "npz")


def test_positions_that_do_not_exist_are_errors_of_the_archive(tmp_path: Path) -> None:
    data = bytearray(archive(CONTENT, CONTENT))
    struct.pack_into("<L", data, len(data) - 6, len(data))  # the directory would begin before
    path = tmp_path / "shifted.npz"
    path.write_bytes(data)
    with pytest.raises(FormatError, match=r"not a valid NPZ file|points\.npy: "):
        liftmesh.read(path)


def test_too_little_memory_is_no_error_of_the_archive(tmp_path: Path) -> None:
    many = {f"a{k}": np.zeros((70_000, 1), np.uint8) for k in range(200)}
    path = tmp_path / "many.npz"
    np.savez_compressed(path, points=np.zeros((70_000, 2), np.uint8), **many)
    program = """
        import json, liftmesh, resource, sys
        liftmesh.read(sys.argv[1])
        before, ends = status("VmSize"), []
        for extra in range(1_000_000, 16_000_000, 2_000_000):
            resource.setrlimit(resource.RLIMIT_AS, (before + extra, resource.RLIM_INFINITY))
            try:
                next(liftmesh.read_chunks(sys.argv[1], rows=1000))
                ends.append("read")
            except (MemoryError, liftmesh.FormatError) as error:
                ends.append(f"{type(error).__name__}: {str(error)[-60:]}")
        resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        print(json.dumps(sorted(set(ends))))
    """
    ends = json.loads(output(program, str(path)))
    assert [each for each in ends if each.startswith("FormatError")] == []
    assert any(each.startswith("MemoryError") for each in ends)
