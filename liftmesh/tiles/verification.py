"""`Tiled.verify`: the points of a folder are read again, and its triangles proved part by part."""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from liftmesh import _kernel
from liftmesh._typing import Array, Progress
from liftmesh.base.options import as_folder, as_threads, check_progress
from liftmesh.errors import InputError
from liftmesh.io.atomic import working_folder
from liftmesh.planar.certificate import Certificate, Flaw
from liftmesh.tiles.proof import Proof, proof_of
from liftmesh.tiles.schema import Reading
from liftmesh.tiles.sorted_chunks import digests_of
from liftmesh.tiles.sources import files_of, source_chunks
from liftmesh.tiles.store import concatenated
from liftmesh.tiles.tiled_data import TiledData, UnprovedData, blocks_of, is_intact, plan_of

_MANY = 1 << 30  # rows: enough for any number of threads
_READ = 0.3  # the share of the work before the first tile


def verify_tiled(
    tiled: TiledData,
    points: object,
    scratch: str | os.PathLike[str] | None,
    threads: int | None,
    progress: Progress | None,
) -> Certificate:
    """Do what `Tiled.verify` says."""
    check_progress(progress)
    tiled = UnprovedData(tiled.folder, tiled.manifest)
    count, _ = as_threads(threads, _MANY)
    show = progress if progress is not None else lambda _: None
    source = _source_of(tiled) if points is None else points
    place = tiled.folder if scratch is None else as_folder("scratch", scratch)
    with working_folder(place, "verify") as folder:
        plan = plan_of(tiled)
        proof = proof_of(tiled, plan, folder, count)
        sizes = [chunk["rows"] for chunk in tiled.manifest["chunks"]]
        rows = _rows(tiled, source, max(1, *sizes), folder)
        chunks = _as_first_read(_regrouped(rows, sizes), tiled.manifest["chunks"])
        skipped, digest = proof.read(_shown(chunks, len(sizes), show))
        for number, _ in enumerate(proof.parts(), 1):
            show(_READ + (1 - _READ) * number / (2 * plan.tiles))
    _check_files(tiled, proof)
    return _certificate(tiled, proof, skipped, digest)


def _source_of(tiled: TiledData) -> list[str]:
    """List the files that were tiled."""
    entries = tiled.manifest["source"]
    if not all("path" in each for each in entries):
        raise InputError(f"{tiled.folder} does not name the files of its points: give them")
    paths = [os.path.normpath(tiled.folder / each["path"]) for each in entries]
    for path in paths:
        if not Path(path).exists():
            raise InputError(f"{path} is missing, whose points were tiled: say where they are")
    return paths


def _rows(tiled: TiledData, source: object, most: int, scratch: Path) -> Iterator[Array]:
    """Read the records of a source, chunk by chunk."""
    said = tiled.manifest.get("surface")
    if said is None:
        reading = Reading(is_planar=True)
    else:
        options = said["reading"] if files_of(source) is not None else {}
        reading = Reading(said["crs"], options)
    yield from (chunk.records() for chunk in source_chunks(source, most, scratch, reading))


def _regrouped(parts: Iterable[Array], sizes: Sequence[int]) -> Iterator[Array]:
    """Yield chunks of the stated sizes, and one more if there are more rows."""
    held = np.empty(0)
    wanted = iter(sizes)
    size = next(wanted, None)
    for part in parts:
        held = concatenated((held, part)) if len(held) else part
        while size is not None and len(held) >= size:
            yield np.ascontiguousarray(held[:size])
            held, size = held[size:], next(wanted, None)
    if len(held):
        yield np.ascontiguousarray(held)


def _as_first_read(chunks: Iterable[Array], stated: Sequence[Mapping[str, Any]]) -> Iterator[Array]:
    """Raise if a chunk is not what was tiled, or if there are more or fewer."""
    number, first = 0, 0
    for number, rows in enumerate(chunks, 1):
        if number > len(stated) or not _is_as_stated(rows, stated[number - 1]):
            raise InputError(
                f"rows {first:,} to {first + len(rows) - 1:,} are not the points that were tiled: "
                "give the same source, in the same order"
            )
        yield rows
        first += len(rows)
    if number < len(stated):
        raise InputError(f"there are {first:,} rows, fewer than were tiled: give the same source")


def _is_as_stated(rows: Array, chunk: Mapping[str, Any]) -> bool:
    return digests_of(rows) == (chunk["sha256"], chunk.get("values", ""))


def _shown(chunks: Iterable[Array], count: int, show: Progress) -> Iterator[Array]:
    for number, rows in enumerate(chunks):
        yield rows
        show(_READ * (number + 1) / count)


def _check_files(tiled: TiledData, proof: Proof) -> None:
    if not is_intact(tiled):
        proof.findings.add("damaged_files", 1)


def _certificate(tiled: TiledData, proof: Proof, skipped: int, digest: str) -> Certificate:
    flaws = proof.findings.flaws()
    triangles = sum(len(block) for block in blocks_of(tiled))
    missing = sum(flaw.count for flaw in flaws if flaw.kind == "missing_vertices")
    edges = proof.findings.interior_edges + proof.hull_edges
    vertices = tiled.npoints - skipped - proof.duplicates - missing
    if vertices - edges + triangles != 1:
        text = f"vertices - edges + triangles is {vertices - edges + triangles}, not 1"
        flaws = (Flaw("euler", 1, text), *flaws)
    certificate = Certificate(
        n_rows=tiled.npoints,
        n_skipped=skipped,
        n_vertices=vertices,
        n_duplicates=proof.duplicates,
        n_merged=0,
        n_triangles=triangles,
        n_edges=edges,
        n_hull_edges=proof.hull_edges,
        flaws=flaws,
        points_sha256=digest,
        simplices_sha256=_sha256(tiled),
        version=_kernel.VERSION,
    )
    return replace(certificate, planar=certificate.valid or None, delaunay=certificate.valid)


def _sha256(tiled: TiledData) -> str:
    """Hash the triangles as `verify` would, from one shard after the other."""
    kind = "<i4" if tiled.npoints < 1 << 31 else "<i8"
    digest = hashlib.sha256()
    for block in blocks_of(tiled):
        for begin in range(0, len(block), 1 << 20):
            digest.update(np.ascontiguousarray(block[begin : begin + (1 << 20)], dtype=kind).data)
    return digest.hexdigest()
