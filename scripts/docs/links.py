"""Links of Markdown, turned into those of another place: of the site, or of a package index."""

from __future__ import annotations

import os
import re
from collections.abc import Callable
from pathlib import Path

try:
    import tomllib
except ModuleNotFoundError:  # Python 3.10
    import tomli as tomllib

ROOT = Path(__file__).resolve().parent.parent.parent
FENCED = re.compile(r"(^(?P<fence>`{3,}|~{3,}).*?^(?P=fence)`*$)", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"(?P<sign>!?)\[(?P<text>(?:[^][]|\[[^][]*\])*)\]\((?P<target>[^()\s]+)\)")
ELSEWHERE = re.compile(r"[a-z]+:|#|/")

Resolve = Callable[[str, bool], "str | None"]


def relinked(text: str, folder: str, resolve: Resolve) -> str:
    """Rewrite the relative links of a page in a folder of the repository.

    `resolve` takes a path from the root, and whether it is a picture, and returns the new target,
    or None where there is none: then a link leaves its text, and a picture nothing.
    """

    def replaced(found: re.Match[str]) -> str:
        if ELSEWHERE.match(found["target"]):
            return found[0]
        path, hash_sign, anchor = found["target"].partition("#")
        is_picture = bool(found["sign"])
        target = resolve(os.path.normpath(f"{folder}/{path}"), is_picture)
        if target is None:
            return "" if is_picture else found["text"]
        return f"{found['sign']}[{found['text']}]({target}{hash_sign}{anchor})"

    parts = FENCED.split(text)  # prose, block, its fence, prose, ...
    kept = [LINK.sub(replaced, each) if at % 3 == 0 else each for at, each in enumerate(parts)]
    return "".join(each for at, each in enumerate(kept) if at % 3 != 2)


def address(kind: str) -> str | None:
    """Return one of the project's addresses in ``pyproject.toml``, if it has one."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    found = project.get("urls", {}).get(kind)
    return found.rstrip("/") if found else None


def in_repository(path: str, is_picture: bool) -> str | None:
    """Return the address of a file in the public repository, if there is one."""
    repository = address("Source")
    return repository and f"{repository}/{'raw' if is_picture else 'blob'}/HEAD/{path}"
