"""Work that grows, to see that the growth tests notice it."""

from __future__ import annotations

from itertools import pairwise

from growth.counting import Work

SIZES = (16, 128, 1024)


def prepare(job: list[str | int]) -> Work:
    """Make a call that compares each of some numbers with all others, or with the next one."""
    _, family, number = job
    size = SIZES[int(number)]
    numbers = [*range(size)]
    if family == "each with all":
        return Work(lambda: [numbers.count(each) for each in numbers], size)
    return Work(lambda: [each == other for each, other in pairwise(numbers)], size)
