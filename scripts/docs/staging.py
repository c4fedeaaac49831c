"""The sources of the site: a copy of ``docs/`` with the root's pages, and links that hold there."""

from __future__ import annotations

from pathlib import Path

from links import ROOT, in_repository, relinked

DOCS = ROOT / "docs"
GENERATED = ("api/names", "cli", "gallery")  # made by Sphinx, its extensions or `command_pages.py`
PROJECT = {"ARCHITECTURE", "BENCHMARKS", "CHANGELOG", "CONTRIBUTING", "SECURITY", "TRUST"}


def stage(source: Path) -> None:
    """Make the sources in a folder: files that are the same keep their times."""
    pages = {path: at for path in repository_pages() if (at := place(path))}
    wanted = {source / at for at in pages.values()}
    for path, at in pages.items():
        wanted |= put_page(source, path, at)
    for path in source.rglob("*"):
        generated = str(path.relative_to(source)).startswith(GENERATED)
        if path.is_file() and path not in wanted and not generated:
            path.unlink()


def repository_pages() -> list[str]:
    """Return all files of the site, from the root."""
    found = [*ROOT.glob("*.md"), *(p for p in DOCS.rglob("*") if p.is_file())]
    return sorted(p.relative_to(ROOT).as_posix() for p in found if "__pycache__" not in p.parts)


def place(path: str) -> str | None:
    """Return where a file of the repository stands among the sources, if it does."""
    if path == "README.md":
        return "index.md"
    name = path.removesuffix(".md")
    if "/" not in path and path.endswith(".md"):
        return f"{'project' if name in PROJECT else 'guide'}/{name.lower()}.md"
    inside = path.removeprefix("docs/")
    is_script = inside.startswith("gallery/")  # which Sphinx-Gallery reads where it stands
    return inside if path.startswith("docs/") and not is_script else None


def put_page(source: Path, path: str, at: str) -> set[Path]:
    """Write a file, with the pictures that it shows; return these."""
    pictures: set[Path] = set()

    def resolve(target: str, is_picture: bool) -> str | None:
        if is_picture and (ROOT / target).is_file():
            put(source / target, (ROOT / target).read_bytes())
            pictures.add(source / target)
            return f"/{target}"
        there = place(target) if (ROOT / target).is_file() else None
        return f"/{there}" if there else in_repository(target, is_picture)

    if path != "README.md":
        data = (ROOT / path).read_bytes()
        if path.endswith(".md"):
            folder = path.rpartition("/")[0]
            data = relinked(data.decode("utf-8"), folder, resolve).encode("utf-8")
        put(source / at, data)
    return pictures


def put(path: Path, data: bytes) -> None:
    """Write a file unless it is the same."""
    if not path.is_file() or path.read_bytes() != data:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
