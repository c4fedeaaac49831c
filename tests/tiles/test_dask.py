"""Tiles on the workers of Dask: the bytes of one process, whoever dies on the way."""

from __future__ import annotations

import inspect
import logging
import os
import pickle
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import Any

import dask.array
import dask.config
import dask.dataframe
import numpy as np
import pandas as pd
import pytest
from dask.distributed import Client, LocalCluster
from tiled_surfaces import check, steep_cloud

import liftmesh
import liftmesh.dask
from liftmesh.errors import (
    DuplicateHeightError,
    InputError,
    MissingDependencyError,
    NonFiniteError,
)
from liftmesh.tiles.schema import Reading

POINTS = np.random.default_rng(8).random((24_000, 2))
TILE_ROWS = 2_000
OPTIONS: dict[str, Any] = {"tile_rows": TILE_ROWS, "shards": "parquet", "neighbors": True}


@pytest.fixture(scope="module")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LocalCluster]:
    with liftmesh.dask.local_cluster(
        n_workers=2,
        memory_limit="400MB",
        local_directory=str(tmp_path_factory.mktemp("workers")),
    ) as made:
        yield made.cluster


@pytest.fixture
def client(cluster: LocalCluster) -> Iterator[Client]:
    with Client(cluster) as made:
        made.wait_for_workers(2)
        yield made


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("source") / "points.npy"
    np.save(path, POINTS)
    return path


def rest(client: Client) -> None:
    """Wait until no worker is at a task, however long it takes."""

    def executing(dask_worker: Any) -> int:
        return int(dask_worker.state.executing_count)

    while any(client.run(executing).values()):
        time.sleep(0.05)


def clients(client: Client) -> set[str]:
    """Name the clients that the scheduler knows."""
    return {*client.run_on_scheduler(lambda dask_scheduler: [*dask_scheduler.clients])}


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def after_a_kill(folder: Path) -> dict[str, bytes]:
    """Read all files but the one that a worker may leave if it is killed as it renames it."""
    found = contents(folder)
    left = [name for name in found if name.startswith(".liftmesh-")]
    assert len(left) <= 1
    return {name: each for name, each in found.items() if name not in left}


@pytest.fixture(scope="module")
def expected(source: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    out = tmp_path_factory.mktemp("expected")
    liftmesh.tile(source, out, **OPTIONS)
    return contents(out)


def test_what_is_not_given_is_as_without_dask() -> None:
    for with_dask, without in (
        (liftmesh.dask.delaunay, liftmesh.tile),
        (liftmesh.dask.triangulate, liftmesh.tile_surface),
    ):
        ours, theirs = (inspect.signature(each).parameters for each in (with_dask, without))
        shared = ours.keys() & theirs.keys()
        assert {"nonfinite", "resume", "shards", "neighbors"} <= shared
        assert {name: ours[name].default for name in shared} == {
            name: theirs[name].default for name in shared
        }


@pytest.mark.slow
def test_the_bytes_are_those_of_one_process(
    client: Client, source: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    shown: list[float] = []
    found = liftmesh.dask.delaunay(
        source, tmp_path, client=client, progress=shown.append, **OPTIONS
    )
    assert contents(tmp_path) == expected
    assert shown == sorted(shown)
    assert shown[-1] == 1.0
    assert found.simplices.max().compute() == len(POINTS) - 1  # by the same workers
    assert found.report.n_used == len(POINTS)
    again = liftmesh.dask.delaunay(source, tmp_path, **OPTIONS)  # the current client
    assert again.manifest == found.manifest


def test_rows_go_as_triangles_come(client: Client, source: Path, tmp_path: Path) -> None:
    """There are four groups of three tiles, which are worked on one after the other."""
    there: list[frozenset[str]] = []

    def watch(share: float) -> None:
        found = tmp_path.glob(".liftmesh-tiles/run-?????-??.npy")
        there.append(frozenset(path.stem[-2:] for path in found))

    liftmesh.dask.delaunay(source, tmp_path, client=client, progress=watch, **OPTIONS)
    whole = there.index(frozenset({"00", "01", "02", "03"}))
    assert len({*there[whole:]}) > 2
    assert there[-1] == frozenset()


def test_objects_of_dask_and_of_memory(
    client: Client, expected: dict[str, bytes], tmp_path: Path
) -> None:
    frame = pd.DataFrame({"z": 0.0, "x": POINTS[:, 0], "y": POINTS[:, 1]})
    array = dask.array.from_array(np.column_stack((POINTS, POINTS))[:, :3], chunks=(7_000, 1))
    sources = {
        "memory": POINTS,
        "array": array,
        "frame": dask.dataframe.from_pandas(frame, npartitions=3),
        "unknown lengths": dask.dataframe.from_pandas(frame, npartitions=3).to_dask_array()[:, 1:],
    }
    for name, each in sources.items():
        out = tmp_path / name
        liftmesh.dask.delaunay(each, out, tile_rows=TILE_ROWS * 6, client=client)
        triangles = np.sort(liftmesh.open_tiled(out).to_array().view("i8,i8,i8").ravel())
        if name == "memory":
            first = triangles
        assert np.array_equal(triangles, first), name
    one = liftmesh.delaunay(POINTS, order="canonical").simplices.astype(np.int64)
    assert np.array_equal(np.sort(one.view("i8,i8,i8").ravel()), first)
    assert expected


def test_workers_decode_files(
    client: Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also by names that only lead to them from the folder of the client."""
    monkeypatch.chdir(tmp_path)
    names = ["b.laz", "a.xyz", "c.las"]
    for name, rows in zip(names, np.split(POINTS[:3_000], 3), strict=True):
        liftmesh.write(name, np.column_stack((rows.round(3), rows[:, 0])))
    alone = liftmesh.tile(names, tmp_path / "alone", tile_rows=700)
    monkeypatch.setattr("liftmesh.tiles.sources.read_chunks", None)  # here, not in the workers
    found = liftmesh.dask.delaunay(names, tmp_path / "out", tile_rows=700, client=client)
    assert contents(tmp_path / "out") == contents(tmp_path / "alone")
    assert found.manifest == alone.manifest
    with pytest.raises(FileNotFoundError, match=r"d\.laz"):
        liftmesh.dask.delaunay("d.laz", tmp_path / "d", client=client)


@pytest.mark.slow
def test_surfaces_have_the_bytes_of_one_process(client: Client, tmp_path: Path) -> None:
    """Also if a worker is killed in the middle."""
    cloud = steep_cloud(rows=12_000, side=90)
    liftmesh.write(tmp_path / "cloud.ply", cloud)
    options: dict[str, Any] = {"tile_rows": 1_000, "on_duplicate": "mean", "neighbors": True}
    alone = liftmesh.tile_surface(tmp_path / "cloud.ply", tmp_path / "alone", **options)
    victims = [*client.run(os.getpid).values()][:1]

    def kill_one(share: float) -> None:
        if share > 0.6 and victims:  # in the middle of the tiles
            os.kill(victims.pop(), signal.SIGKILL)

    source, out = tmp_path / "cloud.ply", tmp_path / "out"
    found = liftmesh.dask.triangulate(source, out, client=client, progress=kill_one, **options)
    assert not victims
    assert after_a_kill(tmp_path / "out") == contents(tmp_path / "alone")
    assert repr(found) == repr(alone)
    check(found, liftmesh.triangulate(source, on_duplicate="mean"))
    client.wait_for_workers(2, timeout=120)


def test_surfaces_of_frames_and_arrays(client: Client, tmp_path: Path) -> None:
    points = steep_cloud().points
    columns = dict(zip("xyz", points.T, strict=True))
    frame = pd.DataFrame({"class": np.arange(len(points)) % 7, **columns})
    sources = {
        "frame": (dask.dataframe.from_pandas(frame, npartitions=3), frame),
        "array": (dask.array.from_array(points, chunks=(500, 2)), points),
        "memory": (points, points),
    }
    for name, (each, whole) in sources.items():
        options: dict[str, Any] = {"on_duplicate": "highest", "tile_rows": 300}
        out = tmp_path / name
        found = liftmesh.dask.triangulate(each, out, client=client, crs="EPSG:7415", **options)
        check(found, liftmesh.triangulate(whole, on_duplicate="highest", crs="EPSG:7415"))
    with pytest.raises(InputError, match="classes: options of files, and there is no file"):
        liftmesh.dask.triangulate(sources["frame"][0], tmp_path / "a", client=client, classes=2)
    points[700, 2] += 1
    with pytest.raises(DuplicateHeightError, match="share the planar position"):
        liftmesh.dask.triangulate(points, tmp_path / "b", on_duplicate="error", client=client)


@pytest.mark.slow
def test_a_worker_is_killed_in_the_middle(
    client: Client, source: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    killed: list[int] = []

    def kill_one(share: float) -> None:
        if share > 0.4 and not killed:  # in the middle of the tiles
            killed.append(next(iter(before.values())))
            os.kill(killed[0], signal.SIGKILL)

    before = client.run(os.getpid)
    liftmesh.dask.delaunay(source, tmp_path, client=client, progress=kill_one, **OPTIONS)
    assert after_a_kill(tmp_path) == expected
    client.wait_for_workers(2, timeout=120)
    assert killed[0] not in client.run(os.getpid).values()


@pytest.mark.slow
def test_what_a_worker_leaves_that_is_killed_as_it_renames_is_removed_by_the_next_run(
    client: Client, source: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    def kill_at_a_shard() -> None:
        from liftmesh.io import atomic

        put = atomic._put_in_place

        def killing(temporary: str, target: Path, folder: int) -> None:
            if target.name.startswith("tile-"):
                os.kill(os.getpid(), signal.SIGKILL)
            put(temporary, target, folder)

        atomic._put_in_place = killing

    client.run(kill_at_a_shard, workers=[next(iter(client.scheduler_info()["workers"]))])
    liftmesh.dask.delaunay(source, tmp_path, client=client, **OPTIONS)
    assert after_a_kill(tmp_path) == expected
    assert len(contents(tmp_path)) == len(expected) + 1
    client.wait_for_workers(2, timeout=120)
    liftmesh.dask.delaunay(source, tmp_path, client=client, **OPTIONS)
    assert contents(tmp_path) == expected


PROGRAM = """
import pickle, sys
from dask.distributed import Client
import liftmesh.dask
options = {"tile_rows": 2000, "shards": "parquet", "neighbors": True}
def wait(share):
    if share > 0.5:
        print("in the middle", flush=True)
        sys.stdin.readline()
with Client(sys.argv[1], security=pickle.loads(bytes.fromhex(sys.stdin.readline()))) as client:
    liftmesh.dask.delaunay(*sys.argv[2:], client=client, progress=wait, **options)
"""


@pytest.mark.slow
def test_a_client_dies_and_comes_back(
    client: Client, source: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    address, known = client.scheduler.address, clients(client)
    command = [sys.executable, "-c", PROGRAM, address, str(source), str(tmp_path)]
    with subprocess.Popen(command, stdin=-1, stdout=-1, text=True) as child:
        assert child.stdin is not None
        assert child.stdout is not None
        child.stdin.write(pickle.dumps(client.security).hex() + "\n")
        child.stdin.flush()
        assert child.stdout.readline() == "in the middle\n"
        child.kill()
    while clients(client) != known:  # its tasks that have not begun go with it
        time.sleep(0.05)
    rest(client)  # the tasks that have begun
    assert not (tmp_path / "manifest.json").exists()
    done = {path: path.stat().st_mtime_ns for path in tmp_path.glob("tile-*.parquet")}
    assert done
    damaged, _ = done.popitem()
    os.truncate(damaged, damaged.stat().st_size - 5)
    liftmesh.dask.delaunay(source, tmp_path, client=client, **OPTIONS)
    assert contents(tmp_path) == expected
    assert {path: path.stat().st_mtime_ns for path in done} == done


def test_files_of_workers_are_cut_off_as_by_a_full_disk(
    client: Client, source: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    """The runs have 48 kB each, and the shards 90 in NPY: no worker can write one."""

    def limit(size: int) -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, resource.RLIM_INFINITY))

    options: dict[str, Any] = {"tile_rows": TILE_ROWS, "client": client}
    client.run(limit, 60_000)
    try:
        with pytest.raises(OSError, match="File too large"):
            liftmesh.dask.delaunay(source, tmp_path, **options)
    finally:
        rest(client)  # what runs when another task fails goes on
        client.run(limit, resource.RLIM_INFINITY)
    names = {path.name for path in tmp_path.rglob("*")}
    assert {"job.json", "run-00011-03.npy"} <= names
    assert not names & {"manifest.json", "tile-00003.npy"}
    found = liftmesh.dask.delaunay(source, tmp_path, **options)
    assert found.is_sound()
    assert (tmp_path / "hull.npy").read_bytes() == expected["hull.npy"]
    assert found.verify().canonical


@pytest.mark.slow
def test_the_scheduler_is_lost_and_started_again(
    source: Path, expected: dict[str, bytes], tmp_path: Path
) -> None:
    options: dict[str, Any] = {"n_workers": 1, "threads_per_worker": 1, "processes": False}
    options |= {"dashboard_address": "127.0.0.1:0", "silence_logs": logging.CRITICAL}
    with ExitStack() as stack, LocalCluster(**options) as first, Client(first) as client:

        def close(share: float) -> None:
            if share > 0.4 and first.scheduler.status.name == "running":
                quick = dask.config.set({"distributed.comm.timeouts.connect": "300ms"})
                stack.enter_context(quick)  # of calls of who is not there
                first.sync(first.scheduler.close)

        with pytest.raises(ConnectionError, match=r"Dask has dropped the tasks .*: what is done"):
            liftmesh.dask.delaunay(source, tmp_path, client=client, progress=close, **OPTIONS)
    assert not (tmp_path / "manifest.json").exists()
    done = {path: path.stat().st_mtime_ns for path in tmp_path.glob("tile-*.parquet")}
    assert done
    with LocalCluster(**options) as second, Client(second) as client:
        liftmesh.dask.delaunay(source, tmp_path, client=client, **OPTIONS)
    assert contents(tmp_path) == expected
    assert {path: path.stat().st_mtime_ns for path in done} == done


def test_errors_of_workers_are_those_of_one_process(client: Client, tmp_path: Path) -> None:
    points = POINTS.copy()
    points[21_234, 1] = np.nan
    out = tmp_path / "new" / "out"
    with pytest.raises(NonFiniteError, match="row 21234 is not finite") as caught:
        liftmesh.dask.delaunay(points, out, tile_rows=TILE_ROWS, client=client)
    assert caught.value.row == 21_234
    assert list(tmp_path.iterdir()) == []
    with pytest.raises(InputError, match=r"points need the shape \(n, 2\) or \(n, 3\)"):
        liftmesh.dask.delaunay(dask.array.zeros((8, 4)), tmp_path / "a", client=client)
    with pytest.raises(InputError, match=r"client is a str: give a dask.distributed.Client"):
        liftmesh.dask.delaunay(points, tmp_path / "b", client="tcp://localhost:8786")


def test_the_first_error_ends_the_run_and_is_not_tried_again(
    client: Client, tmp_path: Path
) -> None:
    def task(number: int) -> None:
        with (tmp_path / str(number)).open("a") as stream:
            stream.write("x")
        if number == 0:
            raise InputError("no point")
        if number == 1:
            raise OSError("no disk")
        while not (tmp_path / "told").exists():  # what has begun lasts until the error was seen
            time.sleep(0.01)

    workers = liftmesh.dask._Workers(client, None)
    with pytest.raises(InputError, match="no point"):
        workers.each("scan", task, [(number,) for number in (0, *range(2, 60))])
    assert (tmp_path / "0").read_text() == "x"
    assert len(list(tmp_path.iterdir())) < 6  # that one, and what the two workers had begun
    (tmp_path / "told").touch()
    rest(client)
    workers = liftmesh.dask._Workers(client, None)
    with pytest.raises(OSError, match="no disk"):
        workers.each("scan", task, [(1,)])
    assert (tmp_path / "1").read_text() == "xxx"


@pytest.mark.slow
def test_a_worker_that_dies_at_a_task_is_replaced_however_long_it_takes() -> None:
    """By default Dask gives up a worker that needs 15 seconds to start again."""
    impatient = dask.config.set({"distributed.deploy.lost-worker-timeout": "1ms"})
    silent = {"silence_logs": logging.CRITICAL}
    with impatient, liftmesh.dask.local_cluster(n_workers=1, **silent) as client:
        client.cluster.scheduler.allowed_failures = 0
        workers = liftmesh.dask._Workers(client, None)
        with pytest.raises(ConnectionError, match=r"workers died 1 time at scan-00000-.*memory"):
            workers.each("scan", lambda: os.kill(os.getpid(), signal.SIGKILL), [()])
        client.wait_for_workers(1, timeout=120)
        assert workers.each("scan", abs, [(-3,)]) == [3]


def test_a_stage_can_be_repeated(client: Client) -> None:
    workers = liftmesh.dask._Workers(client, None)
    for times in (1, 2):
        assert workers.each("partition", lambda n, by: n * by, [(3, times), (5, times)]) == [
            3 * times,
            5 * times,
        ]


def test_columns_of_dask_are_not_rounded(client: Client, tmp_path: Path) -> None:
    frame = pd.DataFrame({"X": [2**53 + 1, 0, 5], "Y": [0.0, 1.0, 2.5]})
    with pytest.raises(InputError, match="9007199254740993"):
        liftmesh.dask.delaunay(dask.dataframe.from_pandas(frame), tmp_path / "a", client=client)
    frame["X"] -= 1
    found = liftmesh.dask.delaunay(
        dask.dataframe.from_pandas(frame), tmp_path / "b", client=client, tile_rows=16
    )
    assert found.nsimplex == 1


def test_blocks_of_dask_are_not_held(client: Client, tmp_path: Path) -> None:
    """Of 32 blocks of 400 kB, a worker holds those at which it is, and one more at times."""

    def tell(block: np.ndarray) -> np.ndarray:
        from dask.distributed import get_worker

        with (tmp_path / "held").open("a") as stream:
            stream.write(f"{get_worker().data.fast.total_weight}\n")
        return block

    array = dask.array.random.default_rng(1).random((800_000, 2), chunks=(25_000, 2))
    blocks = array.map_blocks(tell, meta=np.empty((0, 2)))
    workers = liftmesh.dask._Workers(client, None)
    parts = workers.chunks(blocks, 25_000, tmp_path, Reading(is_planar=True))
    assert [part.rows for part in parts] == [25_000] * 32
    held = [int(float(line)) for line in (tmp_path / "held").read_text().split()]
    assert max(held) < 2_000_000


@pytest.mark.campaign
def test_tiles_fit_the_memory_of_a_worker(client: Client, tmp_path: Path) -> None:
    found = liftmesh.dask.delaunay(POINTS, tmp_path, client=client)
    assert found.manifest["tile_rows"] == 700_000


@pytest.mark.slow
def test_without_a_client_there_is_a_cluster_for_the_call(
    source: Path, expected: dict[str, bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its workers are threads here, which start faster."""
    monkeypatch.setattr("dask.distributed.LocalCluster", partial(LocalCluster, processes=False))
    liftmesh.dask.delaunay(source, tmp_path, **OPTIONS)
    assert contents(tmp_path) == expected


@pytest.mark.slow
def test_without_dask_the_message_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setitem(sys.modules, "dask.distributed", None)
    with pytest.raises(MissingDependencyError, match=r"pip install 'liftmesh\[dask\]'"):
        liftmesh.dask.delaunay(POINTS, tmp_path)
