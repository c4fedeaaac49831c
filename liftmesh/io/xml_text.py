"""Texts in XML: which characters it can hold, and how they are written.

Not beside JSON, which every command reads: XML of the standard library imports a hundred modules.
"""

from __future__ import annotations

import re
from xml.sax.saxutils import quoteattr

# XML 1.0 has no other characters below the blank, no surrogates, and not these two.
_IMPOSSIBLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\ud800-\udfff\ufffe\uffff]")


def is_possible(text: str) -> bool:
    """Whether XML can hold a text."""
    return _IMPOSSIBLE.search(text) is None


def attribute(text: str) -> str:
    """Write a text as the value of an attribute, in quotation marks."""
    marked = {"\n": "&#10;", "\r": "&#13;", "\t": "&#9;", '"': "&quot;"}
    found = quoteattr(text, marked)
    return found if found.startswith('"') else f'"{found[1:-1]}"'
