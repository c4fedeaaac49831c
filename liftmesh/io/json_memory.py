"""What JSON takes in memory once it is parsed, counted from its text before that.

Marks of the text are counted: each brace begins an object, each bracket a list, and each comma an
entry of one of them, perhaps with a number. Strings are cheap if they are keys that come again,
because Python holds equal keys once, and dear if they are keys that do not. To tell them apart
takes about as long as parsing, so all are taken for new keys first, which suffices for most files.
"""

from __future__ import annotations

import re

# Bytes at most, with their share of growing tables: CPython 3.10 to 3.14, 64 bits.
_OBJECT, _LIST, _ENTRY = 210, 90, 40
_KEY, _STRING = 170, 60

# What the text takes itself, for each of its bytes: it is held as bytes, and as characters of up
# to four bytes if one of them needs as many.
_ASCII, _OTHER = 2, 5

_STRINGS = re.compile(rb'"([^"]*)"([ \t\r\n]*:)?')


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
