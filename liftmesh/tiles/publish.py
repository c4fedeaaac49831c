"""The end of a run: what the nodes have done becomes a folder with a manifest."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from liftmesh._typing import Integers
from liftmesh.base.options import counted
from liftmesh.errors import DegenerateInputError
from liftmesh.tiles.adjacency import link_all
from liftmesh.tiles.node import overhangs_apart
from liftmesh.tiles.options import Done, RunContext, Runner, label
from liftmesh.tiles.store import (
    KIND,
    MANIFEST,
    PLAN,
    digest_of,
    save_array,
    save_blocks,
    save_json,
    seal,
)

if TYPE_CHECKING:
    from liftmesh.tiles.plan import Plan
    from liftmesh.tiles.source_chunks import SourceChunk

_DUPLICATES = "duplicates.npy"
_STRETCH = 1 << 22  # rows whose duplicates are merged at a time


def publish(
    runner: Runner,
    context: RunContext,
    chunks: Sequence[SourceChunk],
    plan: Plan,
    identity: Mapping[str, Any],
    done: Sequence[Done],
    skipped: Integers,
) -> None:
    """Write the rows left out, the hull, the plan and the manifest, which is the last."""
    hull = np.load(context.scratch / f"{label(done[-1].name)}-hull.npy")
    rows = sum(chunk.rows for chunk in chunks)
    arrays = {"skipped": np.sort(skipped), "hull": hull}
    counts = {name: len(array) for name, array in arrays.items()}
    listed = _Duplicates.of(context, done, len(chunks))
    counts["duplicates"] = listed.count
    counts |= {"rows": rows, "vertices": rows - counts["duplicates"] - counts["skipped"]}
    counts["triangles"] = sum(each.triangles for each in done)
    _check(counts, is_flat=done[-1].is_flat)
    blocks = _merged(listed.tiles, listed.chunks, rows)
    save_blocks(context.out / _DUPLICATES, (listed.count, 2), blocks)
    save_json(context.out / PLAN, plan.as_dict())
    written = [each for each in _by_kind(done) if each.triangles]
    files = {f"{name}.npy": _file(context.out, name, array) for name, array in arrays.items()}
    if context.neighbors:
        _check_edges(context, done[-1], len(hull))
    files |= _beside(runner, context, written)
    for name in (PLAN, _DUPLICATES):
        files[name] = _stated(context.out / name)
    manifest = {
        "plan": context.plan,
        **identity,
        **about_surface(context, identity, done, len(chunks)),
        **counts,
        "kind": KIND,
        "source": _files(chunks, context.out),
        "shards": [_shard(context, each) for each in written],
        "files": files,
        "merges": _merges(done),
    }
    save_json(context.out / MANIFEST, {**manifest, "seal": seal(manifest)})


def _check(counts: Mapping[str, int], *, is_flat: bool) -> None:
    rows, vertices, skipped = counts["rows"], counts["vertices"], counts["skipped"]
    left_out = f", {skipped} of them skipped as not finite," if skipped else ""
    if vertices < 3:
        raise DegenerateInputError(
            f"{counted(rows, 'row')}{left_out} hold{'s' * (rows == 1)} "
            f"{counted(vertices, 'distinct planar point')}: a triangle needs three"
        )
    if is_flat:
        raise DegenerateInputError(
            f"all {vertices} distinct points lie on one line: a triangle needs a point off it"
        )
    if counts["triangles"] != 2 * vertices - 2 - counts["hull"]:
        raise RuntimeError(
            f"{counts['triangles']} triangles over {vertices} points and {counts['hull']} hull "
            "edges: the tiles do not fit together, which is a bug"
        )


def _check_edges(context: RunContext, root: Done, hull: int) -> None:
    left = np.load(context.scratch / f"{label(root.name)}-edges.npy", mmap_mode="r")
    if len(left) != hull:
        raise RuntimeError(
            f"{len(left)} edges without a neighbour, but {hull} on the hull: the tiles do not fit "
            "together, which is a bug"
        )


def _by_kind(done: Sequence[Done]) -> list[Done]:
    """Put tiles first, by their numbers, then cuts."""
    return sorted(done, key=lambda each: (each.name >= 0, abs(each.name)))


@dataclass(frozen=True)
class _Duplicates:
    """How many there are, and the lists of tiles and of chunks that hold them."""

    count: int
    tiles: list[Path]
    chunks: list[Path]

    @classmethod
    def of(cls, context: RunContext, done: Sequence[Done], runs: int) -> _Duplicates:
        stems = [label(each.name) for each in done if each.duplicates]
        tiles = [context.scratch / f"{stem}-duplicates.npy" for stem in stems]
        chunks = [context.scratch / f"run-{number:05d}-duplicates.npy" for number in range(runs)]
        sizes = {path: len(np.load(path, mmap_mode="r")) for path in chunks}
        count = sum(sizes.values()) + sum(each.duplicates for each in done)
        return cls(count, tiles, [path for path, size in sizes.items() if size])


def _merged(files: Sequence[Path], apart: Sequence[Path], rows: int) -> Iterator[Integers]:
    """Merge lists of duplicates in stretches of rows, without holding the whole list."""
    lowest: dict[int, int] = {}
    named = np.array(sorted({row for path in apart for row in _kept(path)}), dtype=np.int64)
    for begin in range(0, rows, _STRETCH):
        pairs = _stretch(files, begin)
        lowest |= dict(pairs[np.isin(pairs[:, 0], named)].tolist())
        others = _stretch(apart, begin)
        known, place = np.unique(others[:, 1], return_inverse=True)
        others[:, 1] = np.array([lowest.get(row, row) for row in known.tolist()] or [0])[place]
        both = np.concatenate((pairs, others))
        yield both[np.argsort(both[:, 0])]


def _kept(path: Path) -> list[int]:
    """List the rows that duplicates of a chunk name, a stretch at a time."""
    pairs = np.load(path, mmap_mode="r")
    stretches = (pairs[i : i + _STRETCH, 1] for i in range(0, len(pairs), _STRETCH))
    return sorted({row for each in stretches for row in np.unique(each).tolist()})


def _stretch(files: Sequence[Path], begin: int) -> Integers:
    """Read the pairs of a stretch of rows from lists in their order."""
    parts = [np.empty((0, 2), dtype=np.int64)]
    for path in files:
        pairs = np.load(path, mmap_mode="r")
        first, last = np.searchsorted(pairs[:, 0], (begin, begin + _STRETCH))
        parts.append(np.array(pairs[first:last]))
    return np.concatenate(parts)


def about_surface(
    context: RunContext, identity: Mapping[str, Any], done: Sequence[Done], parts: int
) -> dict[str, Any]:
    """Say what was found of a surface."""
    if "surface" not in identity:
        return {}
    apart = [context.scratch / f"run-{number:05d}-apart.npy" for number in range(parts)]
    tiles = [context.scratch / f"{label(each.name)}-heights.npy" for each in done if each.name < 0]
    within = sum(each.overhangs for each in done)
    boxes = np.array([each.box for each in done if each.vertices])
    box = [*boxes[:, :3].min(axis=0).tolist(), *boxes[:, 3:].max(axis=0).tolist()]
    facts = {"overhangs": within + overhangs_apart(apart, tiles), "box": box}
    return {"surface": {**identity["surface"], **facts}}


def _files(chunks: Sequence[SourceChunk], out: Path) -> list[dict[str, Any]]:
    """List the files of a source with the number of their first row, two of one name apart."""
    entries: list[dict[str, Any]] = []
    first, number = 0, -1
    for chunk in chunks:
        if chunk.origin.number != number:
            number = chunk.origin.number
            entry = {"file": Path(chunk.origin.source).name, "first": first, "rows": 0}
            if chunk.origin.is_path:
                entry["path"] = os.path.relpath(chunk.origin.source, out)
            entries.append(entry)
        entries[-1]["rows"] += chunk.rows
        first += chunk.rows
    return entries


def _shard(context: RunContext, done: Done) -> dict[str, Any]:
    name = _shard_name(context, done)
    size = (context.out / name).stat().st_size
    entry = {"file": name, "triangles": done.triangles, "bytes": size}
    return {**entry, "sha256": done.shards[name], **extent_in_manifest(done)}


def _shard_name(context: RunContext, done: Done) -> str:
    return f"{label(done.name)}.{context.shards}"


def extent_in_manifest(done: Done) -> dict[str, Any]:
    """Say how many vertices a shard has, and where they are."""
    if not done.vertices:
        return {}
    return {"vertices": done.vertices, "box": list(done.box)}


def _beside(
    runner: Runner, context: RunContext, written: Sequence[Done]
) -> dict[str, dict[str, Any]]:
    """Write the links of the shards; state all files beside them."""
    digests = link_all(runner, context, written) if context.neighbors else {}
    for each in written:
        digests |= each.shards
        del digests[_shard_name(context, each)]
    return {
        name: {"bytes": (context.out / name).stat().st_size, "sha256": digest}
        for name, digest in digests.items()
    }


def _file(out: Path, name: str, array: Integers) -> dict[str, Any]:
    digest = save_array(out / f"{name}.npy", array)
    return {"bytes": (out / f"{name}.npy").stat().st_size, "sha256": digest}


def _stated(path: Path) -> dict[str, Any]:
    return {"bytes": path.stat().st_size, "sha256": digest_of(path)}


def _merges(done: Sequence[Done]) -> dict[str, int]:
    """Tell how much went from node to node."""
    tiles = [each for each in done if each.name < 0]
    return {
        "tiles": len(tiles),
        "rows_up_from_tiles": sum(each.rows_up for each in tiles),
        "rows_at_root": done[-1].rows,
        "bytes_up": sum(each.bytes_up for each in done),
    }
