"""Clusters that are started here: nobody else can talk to them, or hears of them."""

from __future__ import annotations

import asyncio
import os
import ssl
import stat
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from commands import liftmesh as command
from dask.distributed import Client, Security
from distributed.comm import connect

import liftmesh.dask
from liftmesh import dask as clusters
from liftmesh.errors import MissingDependencyError

LISTENS = "0A"  # in the tables of the kernel


def listening(processes: list[int]) -> set[str]:
    """List the addresses on which processes listen, as the kernel writes them, and their ports."""
    held: set[str] = set()
    for link in (link for each in processes for link in Path(f"/proc/{each}/fd").iterdir()):
        with suppress(FileNotFoundError):  # closed in the meantime
            held.add(str(link.readlink()))
    rows = [
        line.split()
        for table in ("tcp", "tcp6")
        for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]
    ]
    return {row[1] for row in rows if row[3] == LISTENS and f"socket:[{row[9]}]" in held}


@pytest.fixture(scope="module")
def others() -> set[str]:
    """Where this process listens anyway."""
    return listening([os.getpid()])


@pytest.fixture(scope="module")
def client(others: set[str]) -> Iterator[Client]:
    assert isinstance(others, set)  # before the cluster is there
    with liftmesh.dask.local_cluster(n_workers=2) as made:
        made.wait_for_workers(2)
        yield made


def addresses(client: Client) -> list[str]:
    """Return where the scheduler, the workers and what starts them can be called."""
    nannies = [each.address for each in client.cluster.workers.values()]
    return [client.scheduler.address, *client.run(os.getpid), *nannies]


def test_only_this_machine_can_call(client: Client, others: set[str]) -> None:
    found = listening([os.getpid(), *client.run(os.getpid).values()]) - others
    assert len(found) >= 8  # of the scheduler and two workers, each with HTTP, and of two nannies
    assert {each.partition(":")[0] for each in found} == {"0100007F"}  # 127.0.0.1
    assert len(addresses(client)) == 5
    assert {each.rpartition(":")[0] for each in addresses(client)} == {"tls://127.0.0.1"}


def showing(credentials: Security | None) -> dict[str, Any]:
    """Return what calls by TLS, with any credentials or none, and takes whoever answers."""
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    if credentials is not None:
        context = credentials.get_connection_args("client")["ssl_context"]
    context.check_hostname = False
    context.verify_mode = ssl.CERT_NONE
    return {"ssl_context": context, "require_encryption": True}


CALLS = {
    "without encryption": ("tcp", dict),
    "without credentials": ("tls", lambda: showing(None)),
    "with others": ("tls", lambda: showing(Security.temporary())),
}


@pytest.mark.parametrize("who", CALLS)
def test_nobody_is_heard_without_the_credentials_of_the_cluster(who: str, client: Client) -> None:
    """Neither by the scheduler nor by workers, which would run any function."""
    way, options = CALLS[who]

    async def call(address: str) -> None:
        comm = await connect(address, timeout=60, **options())
        try:
            await comm.write({"op": "identity", "reply": True})
            await comm.read()
        finally:
            comm.abort()

    for address in addresses(client):
        with pytest.raises(OSError, match=r"TLS|TCP|closed"):
            asyncio.run(call(address.replace("tls://", f"{way}://")))
    assert client.submit(abs, -3).result() == 3


def test_a_client_of_dask_is_refused(client: Client) -> None:
    security = Security(require_encryption=False)
    address = client.scheduler.address.replace("tls://", "tcp://")
    with pytest.raises(OSError, match=r"Timed out|closed"):
        Client(address, timeout=1, set_as_default=False, security=security)


def test_pages_of_the_cluster_say_nothing(client: Client) -> None:
    def port(dask_worker: Any) -> int:
        return int(dask_worker.http_server.port)

    ports = [client.cluster.scheduler.http_server.port, *client.run(port).values()]
    for each in ports:
        for page in ("", "status", "health", "metrics", "info/main/workers.html", "json/identity"):
            with pytest.raises(urllib.error.HTTPError, match="404"):
                urllib.request.urlopen(f"http://127.0.0.1:{each}/{page}", timeout=60)


def test_what_workers_put_aside_is_in_a_folder_of_their_own(client: Client) -> None:
    """Tasks are pickled there: whoever could write them would run what he likes."""

    def folder(dask_worker: Any) -> str:
        return str(dask_worker.local_directory)

    for place in client.run(folder).values():
        (own,) = (each for each in Path(place).parents if each.name.startswith(".liftmesh-workers"))
        assert stat.S_IMODE(own.stat().st_mode) == 0o700
        assert own.stat().st_uid == os.getuid()


def test_credentials_cannot_be_made_without_cryptography(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cryptography", None)
    with (
        pytest.raises(MissingDependencyError, match=r"pip install 'liftmesh\[dask\]'"),
        liftmesh.dask.local_cluster(),
    ):
        pass


@pytest.mark.slow
def test_the_command_starts_such_a_cluster(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert liftmesh.dask.local_cluster is clusters.local_cluster
    (tmp_path / "points.xyz").write_text("0 0 1\n1 0 2\n0 1 3\n")
    done = command("tile", tmp_path / "points.xyz", tmp_path / "out", "--workers", "1")
    assert done.returncode == 0, done.stderr
