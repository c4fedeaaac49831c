"""Run libraries that call scipy.spatial.Delaunay with liftmesh's class in its place.

    scripts/scipy_callers.sh                    installs the libraries, and runs all
    python scripts/scipy_callers                runs all in this environment
    python scripts/scipy_callers metpy mne      runs those whose names begin so

Every caller runs with SciPy's class and with liftmesh's, and its results are compared. Exits with 1
if one differs.
"""

from __future__ import annotations

import importlib.metadata
import sys
import time
import warnings
from argparse import ArgumentParser, RawDescriptionHelpFormatter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from scipy_callers.callers import BY_CORNER, CALLERS
from scipy_callers.comparing import Caller, differences

PACKAGES = {"skimage": "scikit-image"}


def main() -> None:
    """Run the callers, and print a line for each."""
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="beginnings of names of callers")
    chosen = tuple(parser.parse_args().names) or ("",)
    faults = [run(caller) for caller in CALLERS if caller.__name__.startswith(chosen)]
    if not faults:
        parser.error(f"no caller begins with {' or '.join(chosen)}")
    print(f"{len(faults)} callers, {sum(faults)} of them with differences")
    raise SystemExit(int(any(faults)))


def run(caller: Caller) -> bool:
    """Run a caller and print what differs; return whether something does."""
    start = time.perf_counter()
    warnings.simplefilter("ignore")  # the libraries' own
    found = differences(caller, by_corner=caller in BY_CORNER)
    package = caller.__name__.partition("_")[0]
    version = importlib.metadata.version(PACKAGES.get(package, package))
    seconds = time.perf_counter() - start
    print(f"{caller.__name__:24} {version:10} {seconds:6.1f} s  {'; '.join(found) or 'equal'}")
    return bool(found)


if __name__ == "__main__":
    main()
