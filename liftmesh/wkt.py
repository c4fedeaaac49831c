"""Well-known text: keywords with brackets, which hold names, numbers and further keywords.

Only the brackets are read here, those of both versions; `crs` knows what the keywords mean. pyproj
would read them as well, but units are to be known where it is not installed. Texts come from files,
so they are read without recursion, and very long ones not at all.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field

_LONGEST = 1 << 16  # characters
_WORD = re.compile(r'"(?:[^"]|"")*"|[A-Za-z_][A-Za-z0-9_]*|[-+]?[0-9.][0-9.eE+-]*|[\[\](),]')


@dataclass(slots=True)
class Node:
    """A keyword, in upper case, with the names and numbers in its brackets, and the keywords."""

    keyword: str
    values: list[str] = field(default_factory=list)
    parts: list[Node] = field(default_factory=list)

    def of(self, keywords: Collection[str]) -> Iterator[Node]:
        """Find the parts of these keywords."""
        return (each for each in self.parts if each.keyword in keywords)

    @property
    def title(self) -> str:
        """The name that comes first, without its quotes."""
        return self.values[0].strip('"') if self.values else ""


def tree(text: str) -> Node | None:
    """Read a text; None if its brackets do not match, or it is too long.

    Parameters
    ----------
    text : str
        The text; several after one another become parts of a compound, as Esri writes them.

    Returns
    -------
    Node or None
        The outermost keyword.

    Examples
    --------
    >>> found = tree('VERT_CS["NAP height",UNIT["metre",1]]')
    >>> found.title, found.parts[0].values
    ('NAP height', ['"metre"', '1'])
    >>> tree("UNIT[") is None
    True
    """
    top = Node("")
    if len(text) > _LONGEST or not _fill(top, text) or not top.parts:
        return None
    if len(top.parts) == 1:
        return top.parts[0]
    return Node("COMPOUNDCRS", top.parts[0].values, top.parts)


def _fill(top: Node, text: str) -> bool:
    """Add what a text holds to a node; False if the brackets do not match."""
    open_nodes, last = [top], ""
    for word in _WORD.findall(text):
        if word in "[(":
            node = Node(last.upper())
            open_nodes[-1].parts.append(node)
            open_nodes.append(node)
            last = ""
            continue
        open_nodes[-1].values += [last] if last else []
        last = "" if word in "])," else word
        if word in "])" and len(open_nodes) > 1:
            open_nodes.pop()
        elif word in "])":
            return False
    return len(open_nodes) == 1
