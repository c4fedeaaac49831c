"""Names of the API in prose: code that is a public name is a link to its page."""

from __future__ import annotations

import operator
import re
from functools import cache

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx

import liftmesh
import liftmesh.dask

NAME = re.compile(r"(?:liftmesh\.)?([\w.]+)(?:\(.*\))?", re.DOTALL)
MODULES = {"scipy": liftmesh.scipy.__all__, "dask": liftmesh.dask.__all__}
BY_THEMSELVES = ("api/", "cli/")  # docstrings mark names as such; words of commands are none


@cache
def is_public(name: str) -> bool:
    """Tell whether a dotted name without that of the package is public."""
    parts = name.split(".")
    head = parts[1:2] if parts[0] in MODULES else parts[:1]
    if not head or head[0] not in MODULES.get(parts[0], liftmesh.__all__) or "_" in parts[-1][:1]:
        return False
    try:
        operator.attrgetter(name)(liftmesh)
    except AttributeError:
        return False
    return True


def link_names(app: Sphinx, tree: nodes.document) -> None:
    """Put a reference around each literal that is a public name, unless it is one already."""
    place = app.env.current_document.docname
    if place.startswith(BY_THEMSELVES):
        return
    for literal in list(tree.findall(nodes.literal)):
        found = NAME.fullmatch(literal.astext())
        if found and is_public(found[1]) and not is_in_link(literal):
            reference = addnodes.pending_xref(
                "", refdomain="py", reftype="obj", refdoc=place, reftarget=f"liftmesh.{found[1]}"
            )
            literal.replace_self(reference)
            reference += literal


def is_in_link(node: nodes.Node) -> bool:
    """Tell whether a node is a part of a link, or of a heading."""
    parent = node.parent
    kinds = nodes.reference | nodes.title | addnodes.pending_xref
    return parent is not None and (isinstance(parent, kinds) or is_in_link(parent))


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect to Sphinx."""
    app.connect("doctree-read", link_names)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
