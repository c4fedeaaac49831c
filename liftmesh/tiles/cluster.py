"""Clusters of Dask on this machine, which take nobody else; and the clients of others."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

from liftmesh.errors import InputError
from liftmesh.io.atomic import working_folder
from liftmesh.optional import load

# Tasks are long calls of the kernel: samples of their stacks say nothing, and take a twentieth.
# Nor does anybody look at pages of a cluster that lasts for a call.
_SETTINGS = {
    "distributed.scheduler.http.routes": [],
    "distributed.worker.http.routes": [],
    "distributed.deploy.lost-worker-timeout": "10 minutes",
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
}


@contextmanager
def client_of(given: Any) -> Iterator[Any]:
    """Use a client, the current one, or a cluster of this machine for as long as it is needed."""
    distributed = load("dask.distributed", extra="dask")
    if given is not None and not isinstance(given, distributed.Client):
        raise InputError(f"client is a {type(given).__name__}: give a dask.distributed.Client")
    used = given if given is not None else _current(distributed)
    if used is None:
        with local_cluster() as made:
            yield made
    elif used.asynchronous:
        raise InputError("the client is asynchronous: give one made with asynchronous=False")
    else:
        yield used


@contextmanager
def local_cluster(**options: Any) -> Iterator[Any]:
    """Start workers of one thread on this machine, and close them in the end.

    Whoever can talk to a scheduler can run anything as its user. So it and its workers listen on
    the loopback address alone, and take nobody without the credentials of this cluster, which are
    made for it and never leave memory. There is no dashboard. A worker that dies is replaced, also
    if that takes longer than the 15 seconds that Dask waits.

    Parameters
    ----------
    **options
        As for `dask.distributed.LocalCluster`.

    Yields
    ------
    distributed.Client
        A client of the cluster.

    Raises
    ------
    MissingDependencyError
        Dask, or cryptography, is not installed.
    """
    distributed, config = (load(f"dask.{name}", extra="dask") for name in ("distributed", "config"))
    load("cryptography", extra="dask")  # which makes credentials
    place = config.get("temporary-directory") or tempfile.gettempdir()
    with config.set(_SETTINGS), working_folder(place, "workers") as folder:
        settings = {
            "threads_per_worker": 1,
            "security": True,
            "dashboard_address": "127.0.0.1:0",
            "scheduler_kwargs": {"dashboard": False},
            "local_directory": str(folder),
            **options,
        }
        with (
            distributed.LocalCluster(**settings) as cluster,
            distributed.Client(cluster, set_as_default=False) as client,
        ):
            yield client


def _current(distributed: Any) -> Any:
    with suppress(ValueError):
        return distributed.Client.current()
    return None
