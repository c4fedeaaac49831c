"""The README as package indexes show it, where relative links lead nowhere.

    python scripts/docs/readme.py            print it
    python scripts/docs/readme.py --write    put it in the place of README.md: before a release

Links become those of ``Documentation`` and ``Source`` in ``[project.urls]`` of
``pyproject.toml``. While there are none, links leave their text, and pictures nothing.
"""

from __future__ import annotations

import sys

from links import ROOT, address, in_repository, relinked
from staging import place

README = ROOT / "README.md"


def readme() -> str:
    """Return the README with absolute links."""
    return relinked(README.read_text("utf-8"), ".", absolute)


def absolute(path: str, is_picture: bool) -> str | None:
    """Return the address of a file: of its page on the site, or in the repository."""
    site = address("Documentation")
    page = place(path) if (ROOT / path).is_file() else None
    if site and page and page.endswith((".md", ".rst")):
        return f"{site}/{page.rpartition('.')[0]}.html"
    return in_repository(path, is_picture)


if __name__ == "__main__":
    if "--write" in sys.argv[1:]:
        README.write_text(readme(), encoding="utf-8", newline="\n")
    else:
        sys.stdout.write(readme())
