"""Build the site of documentation: ``python scripts/docs``.

    python scripts/docs                  build it, with the gallery's pictures, in out/docs/html
    python scripts/docs --no-pictures    run no script of the gallery: half a minute
    python scripts/docs --fresh          from scratch: reuse nothing of an earlier build

Warnings are errors, and so are links and anchors of the pages that lead nowhere, and parts that a
browser would load from elsewhere. Nothing is downloaded. It needs the extra ``docs``,
``pip install -e '.[docs]'``, which ``nox -s dev`` installs, too.
"""

from __future__ import annotations

import shutil
import sys
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from pathlib import Path

from checking import broken
from command_pages import put_commands
from sphinx.cmd.build import build_main
from staging import stage


def main() -> int:
    """Make the sources of the site, and build it."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("out/docs"))
    parser.add_argument("--no-pictures", action="store_true")
    parser.add_argument("--fresh", action="store_true")
    options = parser.parse_args()
    out = options.out.resolve()
    if options.fresh:
        shutil.rmtree(out, ignore_errors=True)
    source = out / "source"
    stage(source)
    put_commands(source / "cli")
    pictures = int(not options.no_pictures)
    words = ["--builder", "html", "--fail-on-warning", "--quiet"]
    words += ["--define", f"plot_gallery={pictures}", "--doctree-dir", str(out / "doctrees")]
    code = build_main([*words, str(source), str(out / "html")])
    found = broken(out / "html")
    print(*found, sep="\n", end="\n" if found else "", file=sys.stderr)
    return code or bool(found)


if __name__ == "__main__":
    sys.exit(main())
