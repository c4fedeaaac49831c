"""The collections of Dask that a `Tiled` can be: an array, delayed objects, a DataFrame."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from liftmesh.optional import load
from liftmesh.tiles.shards import read_shard


class Collections:
    """The methods of a `Tiled` that need ``liftmesh[dask]``."""

    @property
    def simplices(self: Any) -> Any:
        """The triangles as an array of Dask, (m, 3) int64, a chunk for each shard.

        Needs ``liftmesh[dask]``. The workers of a cluster must see the folder.
        """
        return self._of_dask(self.to_delayed(), 3)

    @property
    def neighbors(self: Any) -> Any:
        """The neighbours as an array of Dask, (m, 3, 2) int64, as of `neighbor_blocks`.

        Needs ``liftmesh[dask]``. The workers of a cluster must see the folder.
        """
        delayed = load("dask", extra="dask").delayed
        keys = (
            f"neighbors-{each['sha256'][:16]}-{i}" for i, each in enumerate(self.manifest["shards"])
        )
        return self._of_dask(
            [delayed(self._pairs)(i, dask_key_name=key) for i, key in enumerate(keys)], 3, 2
        )

    def _of_dask(self: Any, delayed: Sequence[Any], *shape: int) -> Any:
        array = load("dask.array", extra="dask")
        return array.concatenate(
            [
                array.from_delayed(each, (count, *shape), np.int64)
                for each, count in zip(delayed, self._counts, strict=True)
            ]
        )

    def to_delayed(self: Any) -> list[Any]:
        """Return the shards as delayed objects of Dask, which read them.

        Returns
        -------
        list of dask.delayed.Delayed
            Each computes an (m, 3) ndarray of int64.

        Raises
        ------
        MissingDependencyError
            Dask is not installed.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> tiled = liftmesh.tile([[0, 0], [1, 0], [0, 1]], tempfile.mkdtemp())
        >>> tiled.to_delayed()[0].compute()
        array([[0, 1, 2]])
        """
        delayed = load("dask", extra="dask").delayed
        return [
            delayed(read_shard)(
                path, shard, dask_key_name=f"triangles-{path.stem}-{shard['sha256'][:16]}"
            )
            for path, shard in zip(self.shards, self.manifest["shards"], strict=True)
        ]

    def to_dask_dataframe(self: Any) -> Any:
        """Return the triangles as a DataFrame of Dask.

        Returns
        -------
        dask.dataframe.DataFrame
            The columns a, b and c are the corners; a partition for each shard.

        Raises
        ------
        MissingDependencyError
            Dask, or its DataFrame, is not installed.

        Examples
        --------
        >>> import tempfile
        >>> import liftmesh
        >>> tiled = liftmesh.tile([[0, 0], [1, 0], [0, 1]], tempfile.mkdtemp())
        >>> tiled.to_dask_dataframe().compute().to_numpy().tolist()
        [[0, 1, 2]]
        """
        frame = load("dask.dataframe", extra="dask")
        return frame.from_dask_array(self.simplices, columns=["a", "b", "c"])
