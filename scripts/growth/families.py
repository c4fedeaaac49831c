"""Families of inputs: functions of a size, each named after what makes it hard.

A family takes a size n and returns an input of about n parts: rows, faces, members. It does the
same in each process. Its docstring says in a sentence why it is the worst known input of its kind,
or that it is the ordinary one that others are seen beside.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeAlias

import numpy as np
from distributions import DISTRIBUTIONS, Distribution, Points

Family: TypeAlias = Callable[[int], Any]
Families: TypeAlias = Mapping[str, Family]

SEED = 14

FEW = 16
"""The least number of rows that is counted where each takes tens of microseconds."""


def named(*families: Family) -> dict[str, Family]:
    """Key families by their names, as people write them."""
    return {family.__name__.replace("_", " ").strip(): family for family in families}


def families_in(module: Mapping[str, Any], kind: str, first: str = "") -> dict[str, Family]:
    """Key the families that a module defines: its functions of n that return a kind of thing."""
    found = (
        each
        for name, each in module.items()
        if name.startswith(first)
        and getattr(each, "__annotations__", None) == {"n": "int", "return": kind}
        and (each.__module__, name[0]) == (module["__name__"], name.lstrip("_")[0])
    )
    return named(*found)


def random() -> np.random.Generator:
    """Make the generator of random numbers that a family starts from."""
    return np.random.default_rng(SEED)


def distributed(distribution: Distribution) -> Family:
    """Make a family of one of the benchmark's distributions."""

    def family(n: int) -> Points:
        return distribution(n, random())

    family.__doc__ = distribution.__doc__
    return family


BENCHMARK = {
    name.replace("-", " "): distributed(DISTRIBUTIONS[name])
    for name in DISTRIBUTIONS
    if name != "jacksboro"  # reads a file; its lattice is like the others
}
