"""The site as browsers get it: every link and anchor is there, and nothing comes from elsewhere."""

from __future__ import annotations

import re
from collections.abc import Iterator
from html import unescape
from pathlib import Path
from urllib.parse import unquote

FRAME = re.compile(r'srcdoc="[^"]*"')  # pages of their own
IDS = re.compile(r'<[^>]*?\s(?:id|name)="([^"]+)"')
LINKS = re.compile(r'<a\s[^>]*?href="([^"]*)"')
PARTS = re.compile(r'<(?:script|img|iframe|link)\s[^>]*?(?:src|href)="([^"]*)"')
OUTSIDE = re.compile(r"[a-z]+:|//")


def broken(folder: Path) -> list[str]:
    """Return what is wrong with a site, a line each."""
    pages = [path for path in folder.rglob("*.html") if "_static" not in path.parts]
    texts = {path: FRAME.sub("", path.read_text("utf-8")) for path in pages}
    anchors = {path: {*map(unescape, IDS.findall(text))} for path, text in texts.items()}
    return [f"{path.relative_to(folder)}: {each}" for path in texts
            for each in flaws(path, texts[path], anchors)]  # fmt: skip


def flaws(path: Path, text: str, anchors: dict[Path, set[str]]) -> Iterator[str]:
    """Find the links of a page that lead nowhere, and parts that need a network."""
    for part in PARTS.findall(text):
        if OUTSIDE.match(part) and not part.startswith("data:"):
            yield f"{part} is loaded from elsewhere"
        elif not OUTSIDE.match(part) and not target(path, part)[0].exists():
            yield f"{part} is missing"
    for link in {*LINKS.findall(text)}:
        if not OUTSIDE.match(link):
            there, anchor = target(path, unescape(link))
            known = anchors.get(there, {anchor})
            if not there.exists() or (anchor and anchor not in known):
                yield f"{link} leads nowhere"


def target(path: Path, link: str) -> tuple[Path, str]:
    """Return the file and the anchor that a link of a page names."""
    name, _, anchor = link.partition("#")
    there = (path.parent / unquote(name.partition("?")[0])).resolve() if name else path
    return there, unquote(anchor)
