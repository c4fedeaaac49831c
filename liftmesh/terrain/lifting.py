"""The lift of a cloud's planar points: by weights, by radii, or by the form of a metric.

Weights and radii, by which points may be lifted, are named values of the cloud, so they go where
the surface goes, radii as radii. A surface with weights also has the named values ``hidden``: 1 for
rows that are in no face because they are strictly above the lower hull. Its metadata say which
values were taken, and so do files that keep metadata. A surface that is triangulated again has what
the new run says.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from liftmesh._typing import Floats, Mask, Rows
from liftmesh.base.options import Algorithm
from liftmesh.errors import DataWarning, InputError, Option
from liftmesh.io.metadata import LIFTED, Provenance
from liftmesh.planar import delaunay, regular
from liftmesh.planar.delaunay import Solution, triangulation_of
from liftmesh.planar.kinds import (
    TriangulationKind,
    as_metric,
    as_weights,
    named_values,
    weights_or_radii,
)
from liftmesh.planar.regular import regular_triangulation_of
from liftmesh.terrain.surface_data import HIDDEN

if TYPE_CHECKING:
    from liftmesh.base.cloud import Cloud
    from liftmesh.planar.triangulation import Triangulation

DIVIDING = ("auto", "divide-and-conquer")


@dataclass(frozen=True, slots=True, eq=False)
class Lifting:
    """What the planar points of a cloud are lifted by."""

    cloud: Cloud  # has weights or radii among its named values
    weights: TriangulationKind | None = None
    metric: Floats | None = None

    @property
    def points(self) -> Floats:
        """The rows that are triangulated."""
        return self.cloud.points

    @property
    def ranks(self) -> None:
        """All rows at a position count."""

    def completed(self, hidden: Rows) -> Cloud:
        """Return the cloud with what the triangulation adds."""
        if self.weights is None:
            return self.cloud
        return replace(self.cloud, attributes=self._with_hidden(hidden))

    def solve(self, planar: Floats, options: Mapping[str, Any]) -> Solution:
        """Triangulate planar points; return the arrays of the result."""
        if self.weights is None:
            return delaunay.solve(planar, **options, metric=self.metric)
        shared = {name: options[name] for name in ("nonfinite", "threads", "progress")}
        return regular.solve(planar, self.weights.name, self.weights.values, **shared)

    def triangulation(self, solution: Solution) -> Triangulation:
        """Make the triangulation of a solution."""
        make = triangulation_of if self.weights is None else regular_triangulation_of
        return make(solution)

    def has_weight(self, rows: Rows) -> Mask:
        """Tell which rows are not skipped because of their weight."""
        if self.weights is None:
            return np.ones(len(rows), dtype=np.bool_)
        return np.isfinite(self.weights.values[rows])

    def _with_hidden(self, rows: Rows) -> dict[str, Any]:
        hidden = np.zeros(len(self.cloud), dtype=np.uint8)
        hidden[rows] = 1
        return {**self.cloud.attributes, HIDDEN: hidden}


def lifting_of(
    cloud: Cloud,
    weights: ArrayLike | str | None,
    radii: ArrayLike | str | None,
    metric: ArrayLike | None,
    algorithm: Algorithm,
) -> Lifting:
    """Convert the options to what the points are lifted by."""
    cloud = without_former(cloud)
    if weights is None and radii is None:
        if metric is None:
            return Lifting(cloud)
        form = as_metric(metric)
        return Lifting(_with_entry(cloud, {"metric": form.tolist()}), metric=form)
    kind, given = weights_or_radii(weights, radii)
    if metric is not None:
        raise InputError(f"both {kind} and a metric are given: give one of them")
    if algorithm not in DIVIDING:
        raise InputError(
            f"{Option('algorithm')} {algorithm!r} takes no {Option(kind)}: leave one of the two out"
        )
    _check_hidden(cloud, kind)
    if isinstance(given, str):
        values = as_weights(kind, named_values(cloud, kind, given), len(cloud))
        return Lifting(_with_entry(cloud, {kind: given}), values)
    values = as_weights(kind, given, len(cloud))
    array = given if type(given) is np.ndarray and given.ndim == 1 else values.values
    named = replace(cloud, attributes={**cloud.attributes, kind: array})
    return Lifting(_with_entry(named, {kind: kind}), values)


def _check_hidden(cloud: Cloud, kind: str) -> None:
    """Raise for values that would be replaced, or warn if they are 0 and 1."""
    if HIDDEN not in cloud.attributes:
        return
    if not np.isin(cloud.attributes[HIDDEN], (0, 1)).all():
        raise InputError(
            f"the points have values named {HIDDEN!r}, the name of those that say by 0 or 1 which "
            f"rows the {kind} hide: rename them, or leave them out"
        )
    warnings.warn(replaced_flags(cloud), DataWarning, stacklevel=5)


def replaced_flags(cloud: Cloud) -> str:
    """Say that values of 0 and 1 are replaced by those that tell which rows are hidden."""
    former = Provenance(cloud.metadata).lifted_by
    if HIDDEN not in cloud.attributes or former.keys() & {"weights", "radii"}:
        return ""
    ones = f"1 in {np.count_nonzero(cloud.attributes[HIDDEN]):,} of {len(cloud):,} rows"
    return f"the values {HIDDEN!r} of the points, {ones}, are replaced by those of this run"


def _with_entry(cloud: Cloud, entry: dict[str, Any]) -> Cloud:
    return replace(cloud, metadata={**cloud.metadata, LIFTED: entry})


def without_former(cloud: Cloud) -> Cloud:
    """Take off what a former run noted: the entry of the metadata, and which rows it hid."""
    former = Provenance(cloud.metadata).lifted_by
    if not former:
        return cloud
    noted = (HIDDEN,) if former.keys() & {"weights", "radii"} else ()
    return replace(
        cloud,
        attributes={name: each for name, each in cloud.attributes.items() if name not in noted},
        metadata={name: each for name, each in cloud.metadata.items() if name != LIFTED},
    )
