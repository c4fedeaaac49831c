"""Find out what explains the paper's speedup ratios, with its algorithms as printed in plain C.

    python scripts/paper_port                every variant at n = 1,000: some minutes
    python scripts/paper_port --quick        optimisation, and variants of the position test
    python scripts/paper_port --growth       the printed seconds and the counts at each n
    python scripts/paper_port --simulate     instructions and mispredicted branches (valgrind)

The C program is in this folder and is built with cc (or CC). Every variant runs LF and LFRes in
alternation on the same points, with q at the origin (case 1) and at the median point (case 2).
Seconds are processor time: the minimum of several runs, the median over the seeds. Counts come from
a separate build. "printed / here" is how many times slower the paper's processor must have been to
turn the variant's seconds into the printed ones, and "scatter" is what this does not explain. A
table goes to the terminal, all measurements to a CSV file.
"""

from __future__ import annotations

import csv
import os
import sys
import tempfile
from argparse import ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections import defaultdict
from pathlib import Path
from statistics import median

from rich.console import Console
from rich.table import Table

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # scripts/ holds this package

from paper_port.build import PROCEDURES
from paper_port.growth import Line, exponent, lines, two_costs
from paper_port.inputs import uniform, vertex, write
from paper_port.measure import CASES, Measurement, measure
from paper_port.simulate import simulate
from paper_port.slowdown import slowdown_and_scatter
from paper_port.variants import GROUPS, QUICK, VARIANTS, Variant

WIDTH = 190
SIMULATED = {
    "n.p > d": (),
    "function of four points": ("-DPOSITION=DETERMINANT",),
}


def main() -> None:
    options = read_options()
    console = Console() if os.isatty(1) else Console(width=WIDTH)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if options.growth:
            show_growth(console, options, folder)
        elif options.simulate:
            show_simulations(console, options, folder)
        else:
            show_variants(console, options, folder)
    console.print(f"wrote {options.csv}")


def read_options() -> Namespace:
    parser = ArgumentParser(description=__doc__, formatter_class=RawDescriptionHelpFormatter)
    add = parser.add_argument
    add("--n", nargs="+", type=int, default=[1000], metavar="POINTS")
    add("--seeds", nargs="+", type=int, default=[1, 2, 3], metavar="SEED")
    add("--repeat", type=int, default=3, help="runs on each set of points")
    add("--groups", nargs="+", choices=GROUPS, default=GROUPS, metavar="G", help=", ".join(GROUPS))
    add("--matching", default="", metavar="TEXT", help="only variants whose name contains it")
    add("--quick", action="store_true", help=f"{' and '.join(QUICK)} only, one seed")
    add("--growth", action="store_true", help="operation counts at the printed numbers of points")
    add("--largest", type=int, default=10_000, help="the largest n of --growth")
    add("--simulate", action="store_true", help="run a few variants under cachegrind")
    add("--csv", type=Path, default=Path("out/paper_port.csv"))
    options = parser.parse_args()
    if options.largest < 1000:
        parser.error("--largest is at least 1000, the least n of the tables")
    if options.quick:
        options.groups, options.seeds = QUICK, options.seeds[:1]
    return options


def write_csv(file: Path, rows: list[dict[str, object]]) -> None:
    """Write dictionaries of the same keys."""
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("w", newline="") as stream:
        writer = csv.DictWriter(stream, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)


# --- the variants -------------------------------------------------------------------------------


def show_variants(console: Console, options: Namespace, folder: Path) -> None:
    """Measure every chosen variant; print a line for each n."""
    found: list[Measurement] = []
    chosen = [v for v in VARIANTS if v.group in options.groups and options.matching in v.name]
    if not chosen:
        raise SystemExit(f"no variant matches {options.matching!r}")
    with console.status("") as status:
        for variant in chosen:
            status.update(f"{variant.group}: {variant.name}")
            for item in measure(variant, options.n, options.seeds, options.repeat, folder):
                if isinstance(item, str):
                    console.print(f"{variant.name}: not possible with this compiler")
                else:
                    found.append(item)
    console.print(table_of(found))
    write_csv(options.csv, [row_of(item) for item in found])


def table_of(found: list[Measurement]) -> Table:
    """Lay out seconds and ratios, both cases side by side."""
    groups: dict[tuple[Variant, int], list[Measurement]] = defaultdict(list)
    for item in found:
        groups[item.variant, item.n].append(item)
    table = Table(title="LF / LFRes", title_justify="left")
    for heading in ("group", "variant", "n"):
        table.add_column(heading, justify="right" if heading == "n" else "left")
    for case in CASES:
        for heading in ("LF s", "LFRes s", "ratio", "dot products"):
            table.add_column(f"{heading}\ncase {case}", justify="right")
    for heading in ("LF: case 1\n/ case 2", "printed\n/ here", "scatter", "right\nfacets"):
        table.add_column(heading, justify="right")
    for (variant, n), items in groups.items():
        cells = [cell for case in CASES for cell in cells_of(items, case)]
        right = "yes" if all(item.right for item in items) else "no"
        cells += [case_ratio(items), *slowdown_cells(items)]
        table.add_row(variant.group, variant.name, f"{n:,}", *cells, right)
    return table


def cells_of(found: list[Measurement], case: int) -> list[str]:
    """Return seconds, their ratio and the ratio of dot products in a case."""
    items = [item for item in found if item.case == case]
    seconds = [median(item.seconds[name] for item in items) for name in PROCEDURES]
    ratios = [median(item.ratio for item in items), median(item.work_ratio for item in items)]
    return [f"{value:.4f}" for value in seconds] + [f"{ratios[0]:.2f}", f"{ratios[1]:.1f}"]


def case_ratio(found: list[Measurement]) -> str:
    """Return the ratio of LF's seconds in case 1 to those in case 2."""
    first, second = (
        median(item.seconds["LF"] for item in found if item.case == case) for case in CASES
    )
    return f"{first / second:.2f}"


def slowdown_cells(found: list[Measurement]) -> list[str]:
    """Return the slowdown from measured to printed seconds, and the scatter."""
    values = slowdown_and_scatter(found)
    return ["", ""] if values is None else [f"{value:.2f}" for value in values]


def row_of(item: Measurement) -> dict[str, object]:
    """Return a measurement as a row of the CSV file."""
    row: dict[str, object] = {
        "group": item.variant.group,
        "variant": item.variant.name,
        "flags": " ".join(item.variant.flags),
        "order": item.variant.order,
        "n": item.n,
        "case": item.case,
        "seed": item.seed,
        "facets": item.facets,
        "right_facets": item.right,
    }
    for name in PROCEDURES:
        counts = vars(item.counts[name])
        rejected = counts["rejected"]
        row[f"{name} seconds"] = item.seconds[name]
        row |= {f"{name} {key}": value for key, value in counts.items() if key != "rejected"}
        row |= {f"{name} {key}": value for key, value in rejected.items()} if name != "LF" else {}
    return row


# --- the growth ---------------------------------------------------------------------------------


def show_growth(console: Console, options: Namespace, folder: Path) -> None:
    """Print the counts at the printed sizes, their growth, and the printed time per point."""
    found: list[Line] = []
    with console.status("") as status:
        for line in lines(options.largest, options.seeds[0], folder):
            found.append(line)
            status.update(f"case {line.case}: counted n = {line.n:,}")
    console.print(growth_table(found))
    for sentence in growth_sentences(found):
        console.print(sentence)
    write_csv(options.csv, [growth_row(line) for line in found])


def growth_row(line: Line) -> dict[str, object]:
    """Return a printed row with its counts as a row of the CSV file."""
    row: dict[str, object] = {"case": line.case, "n": line.n}
    for name in PROCEDURES:
        counts = line.counts[name]
        row[f"{name} printed seconds"] = line.printed[name]
        row[f"{name} planes"] = counts.planes
        row[f"{name} points"] = counts.points
        row[f"{name} evaluations"] = counts.evaluations
        row[f"{name} comparisons"] = counts.comparisons
        row[f"{name} nanoseconds a point"] = round(line.nanoseconds(name), 2)
    return row


def growth_table(found: list[Line]) -> Table:
    """Lay out the rows of both printed tables."""
    table = Table(title="Printed seconds and counts", title_justify="left")
    headings = ["case", "n", "planes", "points", "dot products\nof LFRes", "ratio of\ndot products"]
    headings += ["printed\nratio", "LF: printed\nns a point", "LFRes: printed\nns a point"]
    for heading in headings:
        table.add_column(heading, justify="right")
    for line in found:
        full, less = (line.counts[name] for name in PROCEDURES)
        table.add_row(
            str(line.case),
            *(f"{value:,}" for value in (line.n, full.planes, full.points, less.evaluations)),
            f"{full.evaluations / less.evaluations:.1f}",
            f"{line.ratio:.2f}",
            *(f"{line.nanoseconds(name):.1f}" for name in PROCEDURES),
        )
    return table


def growth_sentences(found: list[Line]) -> list[str]:
    """State the exponents of growth, and the costs that fit the printed seconds best."""
    sentences = []
    for case in CASES:
        chosen = [line for line in found if line.case == case]
        sizes = [line.n for line in chosen]
        for name in PROCEDURES:
            seconds = exponent(sizes, [line.printed[name] for line in chosen])
            points = exponent(sizes, [line.counts[name].points for line in chosen])
            planes = exponent(sizes, [line.counts[name].planes for line in chosen])
            sentences.append(
                f"case {case}, {name}: printed seconds grow as n^{seconds:.2f}, "
                f"points as n^{points:.2f}, candidate planes as n^{planes:.2f}"
            )
    for name in PROCEDURES:
        (plane, point), error = two_costs(found, name)
        sentences.append(
            f"{name}: printed seconds = {plane:.0f} ns a plane + {point:.1f} ns a point "
            f"fits both tables to {error:.0%}"
        )
    return sentences


# --- the simulated processor --------------------------------------------------------------------


def show_simulations(console: Console, options: Namespace, folder: Path) -> None:
    """Simulate both procedures without and with optimisation."""
    n, seed = options.n[0], options.seeds[0]
    rows: list[dict[str, object]] = []
    with console.status("") as status:
        for level in ("-O0", "-O2"):
            for name, flags in SIMULATED.items():
                for case in CASES:
                    status.update(f"{name}, {level}, case {case}")
                    points = uniform(n, seed)
                    write(points, folder / "points")
                    q = vertex(case, points)
                    pair = simulate((level, *flags), folder / "points", q, folder)
                    rows += simulation_rows(f"{name}, {level}", n, case, pair)
    table = Table(title="Simulated processor", title_justify="left")
    for heading in rows[0]:
        table.add_column(heading.replace("-level", "\n-level"), justify="right")
    for row in rows:
        table.add_row(*(f"{v:,}" if isinstance(v, int) else str(v) for v in row.values()))
    console.print(table)
    write_csv(options.csv, rows)


def simulation_rows(
    name: str, n: int, case: int, pair: dict[str, dict[str, int]]
) -> list[dict[str, object]]:
    """Return the events of both procedures as rows of the table."""
    head: dict[str, object] = {"variant": name, "n": n, "case": case}
    return [{**head, "procedure": key, **item} for key, item in pair.items()]


if __name__ == "__main__":
    main()
