"""JSON in files: what is parsed, and how texts are written.

While JSON is parsed, the interpreter is held, and no signal is heard. So the text is limited,
without embedded buffers, which take no time. And Python's search for reference cycles is put off:
it would look again and again at all that is there already, for up to four fifths of the time, and
JSON holds no cycles. Numbers of files may be text, booleans, or too large for a double.
"""

from __future__ import annotations

import gc
import json
import math

from liftmesh.errors import FormatError, Option
from liftmesh.io.text_tables import shortened

_MOST = 1 << 25
_EMBEDDED = b'"data:'
_LONG = 1000  # shorter strings may be keys, and their number matters


def parsed(text: bytes | str) -> object:
    """Parse a text; raise ValueError or RecursionError if it is not JSON."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        return json.loads(text)
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


def shown(values: object) -> str:
    """Show a value, or the first of a list, in a message; of nested ones, maybe deep, the type."""
    listed = values[:4] if isinstance(values, list) else [values]
    texts = (type(v).__name__ if isinstance(v, list | dict) else repr(v) for v in listed)
    return ", ".join(map(shortened, texts))
