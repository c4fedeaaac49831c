"""LZF, the compression of PCD files, decompressed.

A byte below 32 begins a run of so many bytes more one, copied as they are. Any other begins a copy
of what came before: three bits of length, or seven and a byte of more, and thirteen of distance.
A copy may reach into itself, which repeats it.
"""

from __future__ import annotations

DENSEST = 264 / 3  # the longest copy, and the bytes that state it


def decompress(data: bytes, size: int) -> bytes:
    """Decompress to ``size`` bytes."""
    out = bytearray()
    place, end = 0, len(data)
    try:
        while place < end and len(out) <= size:
            control = data[place]
            place += 1
            if control < 32:
                out += data[place : place + control + 1]
                place += control + 1
                continue
            length = control >> 5
            if length == 7:
                length += data[place]
                place += 1
            _copy(out, ((control & 31) << 8) + data[place] + 1, length + 2)
            place += 1
    except IndexError as error:
        raise ValueError("the compressed data end within a copy") from error
    if len(out) != size or place != end:
        raise ValueError(f"the compressed data do not expand to {size} bytes")
    return bytes(out)


def _copy(out: bytearray, distance: int, length: int) -> None:
    begin = len(out) - distance
    if begin < 0:
        raise ValueError("the compressed data refer to what is not there")
    if length <= distance:
        out += out[begin : begin + length]
    else:
        out += (bytes(out[begin:]) * (length // distance + 1))[:length]
