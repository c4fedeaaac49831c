"""Results that are read-only, also in copies and pickles."""

from __future__ import annotations

import copy
import pickle
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field
from threading import Barrier

import numpy as np
import pytest

from liftmesh.base.frozen import FrozenDict, FrozenResult, cached_property


@dataclass(frozen=True, slots=True, eq=False)
class Result(FrozenResult):
    rows: np.ndarray
    named: Mapping[str, np.ndarray] = field(default_factory=dict)


@pytest.mark.parametrize(
    "same", [lambda each: each, copy.copy, copy.deepcopy, lambda r: pickle.loads(pickle.dumps(r))]
)
def test_arrays_and_mappings_are_read_only_in_copies_too(same) -> None:
    result = same(Result(np.zeros(3), {"height": np.ones(3)}))
    assert result.rows.tolist() == [0, 0, 0]
    for array in (result.rows, result.named["height"]):
        assert not array.flags.writeable
    with pytest.raises(TypeError, match="read-only"):
        result.named["height"] = np.zeros(3)


def test_a_frozen_dictionary_is_one_but_for_changes() -> None:
    found = FrozenDict(a=1)
    for change in (lambda: found.update(a=2), found.clear, lambda: found.__setitem__("a", 2)):
        with pytest.raises(TypeError, match=r"this dictionary is read-only: change a copy"):
            change()
    assert copy.deepcopy(found) == dict(found) == {"a": 1}
    assert asdict(Result(np.zeros(1), FrozenDict()))["named"] == {}


class Computed:
    """Threads compute its value at the same time, without waiting for those of other instances."""

    def __init__(self) -> None:
        self.together = Barrier(2)

    @cached_property
    def value(self) -> np.ndarray:
        self.together.wait(60)
        return np.zeros(3)


def test_threads_that_compute_a_value_at_once_share_it() -> None:
    """SciPy's interpolators read one that the other thread had replaced, and the process died."""
    computed = Computed()
    with ThreadPoolExecutor(2) as threads:
        first, second = threads.map(lambda _: computed.value, range(2))
    assert first is second is computed.value
    assert isinstance(Computed.value, cached_property)
