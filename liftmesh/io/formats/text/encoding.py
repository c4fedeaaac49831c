"""The beginning of a text file: its byte order mark, UTF-16, and lines that the caller skips."""

from __future__ import annotations

import codecs
import io
import re
from typing import BinaryIO

from liftmesh.errors import FormatError

_UTF8_MARK = b"\xef\xbb\xbf"
_UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")
_BYTES = 1 << 16
_LINE_END = re.compile(rb"\r\n?|\n")


def as_utf8(stream: BinaryIO, name: str, encoding: str | None = None) -> BinaryIO:
    """Return a stream of UTF-8 without a mark: this one behind its mark, or another converted."""
    if encoding is not None:
        return _converted(stream, name, encoding)
    begin = stream.tell()
    mark = stream.read(3)
    if mark.startswith(_UTF16_MARKS):
        stream.seek(begin)
        return _converted(stream, name, "UTF-16")
    if b"\0" in mark[:2] and mark[:2].strip(b"\0"):
        raise FormatError(
            f"{name}: byte {begin}: the text is UTF-16 without its mark, or no text: save it as "
            "UTF-8"
        )
    stream.seek(begin + len(_UTF8_MARK) if mark == _UTF8_MARK else begin)
    return stream


def _converted(stream: BinaryIO, name: str, encoding: str) -> BinaryIO:
    """Convert text to UTF-8 in memory; of numbers in UTF-16 it takes half as much."""
    decoder = codecs.getincrementaldecoder(encoding)()
    held = io.BytesIO()
    done = False
    while not done:
        data = stream.read(_BYTES)
        done = not data
        try:
            text = decoder.decode(data, final=done)
            held.write((text if held.tell() else text.removeprefix("\ufeff")).encode())
        except UnicodeError as error:
            raise FormatError(
                f"{name}: byte {stream.tell()} or before: the text is damaged {encoding} "
                f"({error}): save it as UTF-8"
            ) from error
    held.seek(0)
    return held


def skip_lines(stream: BinaryIO, count: int, name: str) -> None:
    """Move behind a number of lines, whatever ends them."""
    left = count
    while left:
        begin = stream.tell()
        data = stream.read(_BYTES)
        if not data:
            raise FormatError(
                f"{name}: the file has {count - left:,} lines, and skip_rows={count} skips more"
            )
        if data.endswith(b"\r") and stream.read(1) == b"\n":  # the other half of a line end
            data += b"\n"
        stream.seek(begin + len(data))
        for end in _LINE_END.finditer(data):
            left -= 1
            if not left:
                stream.seek(begin + end.end())
                return
