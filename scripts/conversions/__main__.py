"""Send clouds through every pair of formats and objects, or make the tables of formats.md.

    python scripts/conversions                  writes the tables into docs/guide/formats.md
    python scripts/conversions --check          exits with 1 if the page is out of date
    python scripts/conversions --seconds 600    draws clouds, and sends them through every pair
    python scripts/conversions --files FOLDER   triangulates files, sends them through each format

What comes back must be the same bit for bit, or the loss named (`checking`). A find is shown in its
smallest form, and the exit code is 1.
"""

from __future__ import annotations

import sys
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from campaign import seed_of
from conversions.campaign import hunt
from conversions.comparing import ChangedError
from conversions.given import files_in, there_and_back
from conversions.table import PAGE, page


def main() -> None:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("--check", action="store_true", help="change nothing; 1 if out of date")
    parser.add_argument("--seconds", type=float, help="draw clouds for so long")
    parser.add_argument("--seed", type=int, help="of the first cloud; default: random")
    parser.add_argument("--files", type=Path, nargs="+", help="files and folders to send")
    options = parser.parse_args()
    if options.files is not None:
        raise SystemExit(sum(map(_is_changed, files_in(options.files))) > 0)
    if options.seconds is not None:
        seed = seed_of(options.seed)
        print(f"seed {seed}", flush=True)
        print(f"{hunt(options.seconds, seed):,} clouds, no find")
        return
    text = PAGE.read_text("utf-8")
    made = page(text)
    if not options.check:
        PAGE.write_text(made, "utf-8")
    elif made != text:
        raise SystemExit(f"{PAGE.name} is out of date: run python scripts/conversions")


def _is_changed(path: Path) -> bool:
    try:
        told = there_and_back(path)
    except ChangedError as error:
        print(f"{path}: CHANGED: {error}", flush=True)
        return True
    print(f"{path}: {told}", flush=True)
    return False


if __name__ == "__main__":
    main()
