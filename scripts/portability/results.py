"""What a build says: hashes of its results, compared with those of another."""

from __future__ import annotations

from pathlib import Path

Results = dict[tuple[str, str], str]  # by file and kind of result


def results(output: str) -> Results:
    """Read lines of a file, a kind of result, its hash and the number of bytes that it is of."""
    found: Results = {}
    for line in output.splitlines():
        file, kind, *hashed = line.split("\t")
        found[Path(file).name, kind] = " ".join(hashed)
    return found


def differences(found: Results, expected: Results) -> list[str]:
    """Name the results that differ, or that only one of the two has."""
    return [
        f"{kind} of {file}: {found.get((file, kind))}, not {expected.get((file, kind))}"
        for file, kind in sorted(found.keys() | expected.keys())
        if found.get((file, kind)) != expected.get((file, kind))
    ]
