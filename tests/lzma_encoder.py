"""LZMA data that do not end with a marker, as 7-Zip writes them: Python's encoder adds it always.

Every byte is a literal without a context (lc = lp = pb = 0). So little more is needed than the
range coder of the LZMA specification: an interval, which each bit narrows by the probability that
bits of its kind had so far.
"""

from __future__ import annotations

import struct


class RangeCoder:
    """Codes bits. The start of the interval is kept whole, so that nothing is carried."""

    def __init__(self) -> None:
        self._low = 0
        self._range = 0xFFFFFFFF
        self._size = 4

    def encode(self, odds: list[int], kind: int, bit: int) -> None:
        """Encode a bit; ``odds`` are those of a zero, of 2,048, for each kind."""
        bound = (self._range >> 11) * odds[kind]
        if bit:
            self._low += bound
            self._range -= bound
            odds[kind] -= odds[kind] >> 5
        else:
            self._range = bound
            odds[kind] += (2048 - odds[kind]) >> 5
        while self._range < 1 << 24:
            self._range <<= 8
            self._low <<= 8
            self._size += 1

    def finish(self) -> bytes:
        """Return the data, which begin with a zero."""
        return b"\0" + self._low.to_bytes(self._size, "big")


def without_marker(content: bytes) -> bytes:
    """Compress the content of a member; LZMA's properties precede it."""
    coder, matches, literals = RangeCoder(), [1024], [1024] * 256
    for byte in content:
        coder.encode(matches, 0, 0)
        symbol = 1
        for place in range(7, -1, -1):
            bit = byte >> place & 1
            coder.encode(literals, symbol, bit)
            symbol = symbol << 1 | bit
    return struct.pack("<2BHBL", 9, 4, 5, 0, 1 << 16) + coder.finish()
