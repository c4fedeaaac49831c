"""Public classes and docstrings as the site shows them: an extension of Sphinx."""

from __future__ import annotations

import inspect
import pydoc
import re
from functools import cache, cached_property
from typing import Any

from docutils import nodes
from numpydoc.docscrape_sphinx import SphinxDocString
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment

import liftmesh

FIRST = re.compile(r"(Parameters\n-+\n)(\w+) : .*\n(?: .*\n)*")
ALIAS = re.compile(r"(?<!`)`(\w+)`(?!`)")
IN_FULL = re.compile(r"^In full: `([\w.]+)`\.$", re.MULTILINE)

BARS = re.compile(r"(?<!`)\|(\w[^|`]*)\|")  # lengths, such as |x - c|, which are no substitutions


def own_members(kind: type) -> dict[str, Any]:
    """Return the public members of a class, also those of liftmesh that it inherits."""
    bases = [each for each in kind.__mro__ if each.__module__.startswith("liftmesh.")]
    members = {name: each for base in reversed(bases) for name, each in vars(base).items()}
    return {name: each for name, each in members.items() if not name.startswith("_")}


class Looked(dict[str, "list[str]"]):
    """What a function says of a class: for templates, whose context has to be data."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __missing__(self, fullname: str) -> list[str]:
        return globals()[self.name](fullname)


def methods_of(fullname: str) -> list[str]:
    """Return the names of the methods of a class."""
    found = own_members(pydoc.locate(fullname)).items()
    kinds = (classmethod, staticmethod)
    return [name for name, each in found if inspect.isfunction(each) or isinstance(each, kinds)]


def properties_of(fullname: str) -> list[str]:
    """Return the names of the properties that the docstring of a class does not describe."""
    kind = pydoc.locate(fullname)
    described = re.findall(r"^(\w.*?)(?: :.*)?$", inspect.getdoc(kind) or "", re.MULTILINE)
    named = {name for line in described for name in line.split(", ")}
    found = own_members(kind).items()
    properties = [n for n, each in found if isinstance(each, property | cached_property)]
    return [name for name in properties if name not in named]


def describe_in_full(
    _app: Sphinx, _what: str, _name: str, value: object, _options: object, lines: list[str]
) -> None:
    """Put the docstring that describes a name in full in place of a short one."""
    text = "\n".join(lines)
    if named := IN_FULL.search(text):
        summary = text.partition("\n\n")[0]
        full = (inspect.getdoc(pydoc.locate(named[1])) or "").partition("\n\n")[2]
        text = f"{summary}\n\n{as_of_method(full, value)}"
    text = ALIAS.sub(lambda found: f"`{described().get(found[1], found[1])}`", text)
    lines[:] = BARS.sub(r"\\|\1\\|", text).splitlines()


@cache
def described() -> dict[str, str]:
    """Return the method that each function describes in full, by the name of the function."""
    kinds = [getattr(liftmesh, name) for name in liftmesh.__all__]
    pairs = [
        (named[1].rpartition(".")[2], f"{kind.__name__}.{name}")
        for kind in filter(inspect.isclass, kinds)
        for name, each in own_members(kind).items()
        if (named := IN_FULL.search(inspect.getdoc(each) or ""))
    ]
    # Other words are parameters, such as `boundary`.
    return {word: method for word, method in pairs if word != method.rpartition(".")[2]}


def as_of_method(text: str, method: object) -> str:
    """Leave out the first parameter of a function that describes a method, which is `self`."""
    first = FIRST.search(text)
    is_own = first and first[2] in inspect.signature(method).parameters  # type: ignore[arg-type]
    return text if is_own else FIRST.sub(r"\1", text)


def resolve(
    app: Sphinx, env: BuildEnvironment, node: addnodes.pending_xref, content: nodes.Node
) -> nodes.Node | None:
    """Look in the package for what a docstring of another module names, and in its classes."""
    domain = env.domains.python_domain
    place = node.get("refdoc", ""), app.builder
    target = node.get("reftarget", "").removeprefix("liftmesh.")
    for name in (f"liftmesh.{target}", f"liftmesh.{target.rpartition('.')[0]}"):
        if name in domain.objects and pydoc.locate(name) is not None:
            return domain.resolve_xref(env, *place, "obj", name, node, content)
    is_word = node.get("refdomain") == "py" and "." not in target
    return content if is_word else None  # a parameter or an attribute


def setup(app: Sphinx) -> dict[str, bool]:
    """Connect to Sphinx, before numpydoc."""
    app.setup_extension("numpydoc")
    app.connect("autodoc-process-docstring", describe_in_full, priority=100)
    app.connect("missing-reference", resolve)
    # It would put the summary of a property in place of what the class says of it.
    processed = SphinxDocString._process_param  # noqa: SLF001
    SphinxDocString._process_param = lambda *words: processed(*words[:-1], False)  # noqa: SLF001
    return {"parallel_read_safe": True, "parallel_write_safe": True}
