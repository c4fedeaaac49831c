"""What planar points are lifted by, from the options."""

from __future__ import annotations

import numpy as np

from liftmesh import Cloud
from liftmesh.terrain.lifting import lifting_of, replaced_flags


def test_a_metric_stands_in_the_metadata() -> None:
    lifting = lifting_of(Cloud(np.eye(3)), None, None, [[2, 0], [0, 1]], "auto")
    assert lifting.cloud.metadata == {"triangulated_by": {"metric": [[2.0, 0.0], [0.0, 1.0]]}}


def test_weights_are_named_values() -> None:
    lifting = lifting_of(Cloud(np.eye(3)), [0, 1, 2], None, None, "auto")
    assert lifting.cloud.attributes["weights"].tolist() == [0, 1, 2]
    assert lifting.cloud.metadata == {"triangulated_by": {"weights": "weights"}}


def test_flags_of_the_caller_are_said_to_be_replaced() -> None:
    cloud = Cloud(np.eye(3), attributes={"hidden": np.array([0, 1, 1])})
    assert replaced_flags(cloud) == (
        "the values 'hidden' of the points, 1 in 2 of 3 rows, are replaced by those of this run"
    )
    assert replaced_flags(Cloud(np.eye(3))) == ""
