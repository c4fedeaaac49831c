"""JSON and XML in files: checked before they are parsed, and written.

While JSON is parsed, the interpreter is held, and no signal is heard. So the text is limited,
without embedded buffers, which take no time. And Python's search for reference cycles is put off:
it would look again and again at all that is there already, for up to four fifths of the time, and
JSON holds no cycles. Numbers of files may be text, booleans, or too large for a double.

What JSON takes once it is parsed is counted from the marks of its text: each brace begins an
object, each bracket a list, and each comma an entry of one of them, perhaps with a number. Strings
are cheap if they are keys that come again, because Python holds equal keys once, and dear if they
are keys that do not. To tell them apart takes about as long as parsing, so all are taken for new
keys first, which suffices for most files.
"""

from __future__ import annotations

import gc
import json
import math
import re
from collections.abc import Callable
from typing import Any

from liftmesh.errors import FormatError, Option
from liftmesh.io.text_tables import shortened

_MOST = 1 << 25
_EMBEDDED = b'"data:'
# Bytes at most, with their share of growing tables: CPython 3.10 to 3.14, 64 bits.
_OBJECT, _LIST, _ENTRY = 210, 90, 40
_KEY, _STRING = 170, 60

# What the text takes itself, for each of its bytes: it is held as bytes, and as characters of up
# to four bytes if one of them needs as many.
_ASCII, _OTHER = 2, 5

_STRINGS = re.compile(rb'"([^"]*)"([ \t\r\n]*:)?')

_LONG = 1000  # shorter strings may be keys, and their number matters


def parsed(text: bytes | str, take: Callable[[dict[str, Any]], object] | None = None) -> object:
    """Parse a text; raise ValueError or RecursionError if it is not JSON.

    Each object is replaced by what `take` returns of it, as soon as it is complete.
    """
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        return json.loads(text, object_hook=take)
    finally:
        if was_enabled:
            gc.enable()


def parsed_or_none(text: str | bytes) -> object:
    """Parse a short text in UTF-8; None if it is not JSON."""
    try:
        return json.loads(text if isinstance(text, str) else text.decode())
    except (ValueError, RecursionError):
        return None


def without_buffers(text: bytes) -> bytes:
    """Leave out embedded buffers: long strings that take little memory, and no time."""
    parts, done = [], 0
    begin = text.find(_EMBEDDED)
    while begin >= 0 and (end := text.find(b'"', begin + len(_EMBEDDED))) >= 0:
        if end - begin > _LONG:
            parts.append(text[done:begin])
            done = end
        begin = text.find(_EMBEDDED, end)
    return b"".join([*parts, text[done:]]) if parts else text


def check_length(text: bytes, name: str) -> None:
    """Raise if a text without embedded buffers is too long to be parsed while signals wait."""
    if len(text) > _MOST:
        raise FormatError(
            f"{name}: its JSON without embedded buffers has {len(text):,} bytes, more than the "
            f"limit of {_MOST:,}: if you trust the file, give its content a limit with "
            f"{Option('max_bytes', ...)}"
        )


def ascii_string(text: str) -> str:
    """Return a text as a JSON string of printable ASCII."""
    return json.dumps(text).replace("\x7f", "\\u007f")


def finite_numbers(values: object, count: int) -> list[float] | None:
    """Convert a list of finite numbers to floats; None if it is anything else."""
    if not isinstance(values, list) or len(values) != count or not all(map(_is_finite, values)):
        return None
    return [float(value) for value in values]


def _is_finite(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    try:
        return math.isfinite(value)
    except OverflowError:  # an integer beyond all doubles
        return False


def shown_json(values: object) -> str:
    """Show a value, or the first of a list, in a message; of nested ones, maybe deep, the type."""
    listed = values[:4] if isinstance(values, list) else [values]
    texts = (type(v).__name__ if isinstance(v, list | dict) else repr(v) for v in listed)
    return ", ".join(map(shortened, texts))


def bytes_of_text(text: bytes) -> int:
    """Return what a text takes as long as it is parsed, without what is made of it."""
    return (_ASCII if text.isascii() else _OTHER) * len(text)


def bytes_of_tree(text: bytes, enough: int) -> int:
    """Return what the objects take that a text describes."""
    marks = _OBJECT * text.count(b"{") + _LIST * text.count(b"[") + _ENTRY * text.count(b",")
    needed = marks + _KEY * (text.count(b'"') // 2)
    return needed if needed <= enough else marks + _bytes_of_strings(text, enough)


def _bytes_of_strings(text: bytes, enough: int) -> int:
    """Look at each string: distinct keys, other strings; keys that came before are free."""
    plain = text.replace(rb"\\", b"\0").replace(rb"\"", b"\1")  # neither is in valid JSON
    keys: set[bytes] = set()
    others = 0
    for string in _STRINGS.finditer(plain):
        if string[2] is None:
            others += 1
        else:
            keys.add(string[1])
        if _KEY * len(keys) > enough:
            break
    return _KEY * len(keys) + _STRING * others


# XML 1.0 has no other characters below the blank, no surrogates, and not these two.
_IMPOSSIBLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")
# By hand, as xml.sax.saxutils loads all that fetches addresses: 25 ms and megabytes.
_MARKED = str.maketrans(
    {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;"}
    | {"\n": "&#10;", "\r": "&#13;", "\t": "&#9;"}
)


def is_possible(text: str) -> bool:
    """Whether XML can hold a text."""
    return _IMPOSSIBLE.search(text) is None


def attribute(text: str) -> str:
    """Write a text as the value of an attribute, in quotation marks."""
    return f'"{text.translate(_MARKED)}"'
