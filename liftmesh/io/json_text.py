"""Parsing JSON of files: the interpreter is held meanwhile, and no signal is heard.

So the text is limited, without embedded buffers, which take no time. And Python's search for
reference cycles is put off: it would look again and again at all that is there already, for up to
four fifths of the time, and JSON holds no cycles.
"""

from __future__ import annotations

import gc
import json

from liftmesh.errors import FormatError

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


def ascii_string(text: str) -> str:
    """Return a text as a JSON string of printable ASCII."""
    return json.dumps(text).replace("\x7f", "\\u007f")


def check_length(text: bytes, name: str) -> None:
    """Raise if a text without embedded buffers is too long to be parsed while signals wait."""
    if len(text) > _MOST:
        raise FormatError(
            f"{name}: its JSON without embedded buffers has {len(text):,} bytes, more than the "
            f"limit of {_MOST:,}: if you trust the file, give its content a limit with max_bytes="
        )
