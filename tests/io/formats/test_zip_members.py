"""Members of NPZ files: read exactly as far as the directory of the archive states."""

from __future__ import annotations

import errno
import io
import json
import random
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from children import output
from failing_stream import Failing
from file_samples import loaded
from files.archives import BZIP2, DEFLATED, LZMA, METHODS, STORED, archive, packed
from growth.resident import forked

import liftmesh
from liftmesh import FormatError


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
        else:
            assert np.array_equal(read, POINTS)


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


@pytest.mark.parametrize(("method", "name"), [(BZIP2, "bzip2"), (LZMA, "LZMA")])
def test_methods_without_bound_are_refused(method: int, name: str) -> None:
    cause = f"it is compressed with {name}, which is not read: save the arrays with numpy.savez"
    refused(archive(packed(method, CONTENT), CONTENT, method=method), cause)
    refused(archive(b"", CONTENT, method=method, size=GIGABYTES), cause)


def test_thirty_kilobytes_do_not_take_thirty_megabytes() -> None:
    data = archive(packed(DEFLATED, CONTENT + bytes(30 << 20)), CONTENT, method=DEFLATED)
    assert len(data) < 40_000
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


GIGABYTES = 4_000_000_000


def test_zeros_may_be_compressed_as_far_as_the_method_does() -> None:
    content = npy(np.zeros((10**6, 3)))
    data = archive(packed(DEFLATED, content), content, method=DEFLATED)
    assert len(content) > 1000 * len(data)
    for cloud in (loaded(data, "npz"), *liftmesh.read_chunks(io.BytesIO(data), format="npz")):
        assert cloud.points.shape == (10**6, 3)
        assert not cloud.points.any()
    limit = f"expands to 24,000,128 bytes, more than the limit of {24_000_127:,}"
    with pytest.raises(FormatError, match=limit):
        liftmesh.read(io.BytesIO(data), format="npz", max_bytes=24_000_127)


def test_what_bounded_methods_cannot_make_stays_impossible() -> None:
    for method in (STORED, DEFLATED):
        data = archive(packed(method, CONTENT), CONTENT, method=method, size=GIGABYTES)
        with pytest.raises(FormatError, match="bytes cannot decompress to 4000000000"):
            liftmesh.read(io.BytesIO(data), format="npz", max_bytes=10**12)


def test_headers_of_arrays_are_not_read_without_bound() -> None:
    content = b"\x93NUMPY\2\0" + struct.pack("<L", GIGABYTES) + bytes(100 << 20)
    data = archive(packed(DEFLATED, content), content, method=DEFLATED)

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
