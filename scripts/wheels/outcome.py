"""What a step of the campaign found: a row of the table of platforms."""

from __future__ import annotations

from dataclasses import dataclass

from native.build import ROOT

PAGE = ROOT / "docs" / "project" / "platforms.md"
BEGIN, END = "<!-- platforms: begin -->", "<!-- platforms: end -->"


@dataclass(frozen=True)
class Outcome:
    """What was built for a platform, where it ran, and what is wrong with it."""

    platform: str
    built: str
    ran: str
    faults: tuple[str, ...] = ()

    def row(self) -> str:
        """Return it as a row of a table."""
        return f"| {self.platform} | {self.built} | {self.ran}{' **wrong**' * bool(self.faults)} |"


def write_table(found: list[Outcome]) -> None:
    """Put the rows in the page of platforms, in the place of those of the same platforms."""
    text = PAGE.read_text("utf-8")
    before, rest = text.split(BEGIN)
    table, after = rest.split(END)
    new = {outcome.platform for outcome in found}
    old = [line for line in table.splitlines() if line.startswith("| ")][2:]
    kept = [line for line in old if line.split(" | ")[0].removeprefix("| ") not in new]
    head = ["| platform | built | run |", "| --- | --- | --- |"]
    lines = [*head, *kept, *(outcome.row() for outcome in found)]
    PAGE.write_text(f"{before}{BEGIN}\n" + "\n".join(lines) + f"\n{END}{after}", "utf-8")
