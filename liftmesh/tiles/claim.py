"""The folders of a run: what it may change in them, and that no two runs share them.

A run changes and removes what a run has made, and nothing else. It works in a scratch folder of its
own, with a marker in it, and writes to `out` under few names. While it works, `out` also holds a
claim, a locked file; if that is still there but not locked, the run was stopped. Files of such
names without a claim, and without a manifest that names them, are somebody else's.
"""

from __future__ import annotations

import errno
import fcntl
import hashlib
import json
import os
import re
import socket
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from liftmesh.choices import as_folder
from liftmesh.errors import DegenerateInputError, FormatError, InputError
from liftmesh.tiles.manifest import MANIFEST, manifest_of
from liftmesh.tiles.stages import JOB, Folders
from liftmesh.tiles.store import load_json, save_json

if TYPE_CHECKING:
    from liftmesh.tiles.sources import Part

CLAIM = ".liftmesh-run"
MARKER = "scratch.json"
SCRATCH = ".liftmesh-tiles"

_SHARD = re.compile(
    r"(tile|seam)-\d{5,}(\.(npy|parquet|ply)|-(neighbors|links|vertices|faces)\.npy)"
    r"|(duplicates|skipped|hull)\.npy|(manifest|plan)\.json"
)
_TEMPORARY = r"\.liftmesh-[0-9a-f]{16}"
_NOTE = re.compile(
    r"points-\d{5,}(-\d{5,})?\.npy|(boxes|shards|cuts)\.npy"
    r"|run-\d{5,}(-\d{2})?(-begins|-boxes|-skipped|-duplicates|-values|-apart)?\.npy"
    r"|(tile|seam)-\d{5,}-(duplicates|records|rim|hull|links|edges|values|heights)\.npy"
    rf"|(job|plan|(run|tile|seam)-\d{{5,}})\.json|{_TEMPORARY}"
)
_UNABLE = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP}


def folders_of(out: str | os.PathLike[str], scratch: str | os.PathLike[str] | None) -> Folders:
    """Name the folders of a run.

    Parameters
    ----------
    out, scratch
        As for `tile`.

    Returns
    -------
    Folders
        A scratch folder in `out`, or one in the given folder that no other `out` has.
    """
    target = Path(os.path.abspath(as_folder("out", out)))  # noqa: PTH100 - links stay
    if scratch is None:
        return Folders(target, target / SCRATCH)
    tag = hashlib.sha256(os.fsencode(target)).hexdigest()[:16]
    place = os.path.abspath(as_folder("scratch", scratch))  # noqa: PTH100 - as above
    return Folders(target, Path(place) / f"{SCRATCH}-{tag}")


@contextmanager
def claimed(folders: Folders, *, anew: bool) -> Iterator[None]:
    """Hold the folders of a run; what is left of it in the end is removed.

    Parameters
    ----------
    folders : Folders
        They are made if they are missing; after an error, those that are empty are removed again.
    anew : bool
        Whether to remove what an interrupted run has left in the scratch folder.

    Raises
    ------
    InputError
        Another run is at work, or there are files that no run has made.
    OSError
        The folders cannot be used.
    """
    if folders.out.exists() and not folders.out.is_dir():
        reason = "cannot write tiles here: this is a file, not a folder"
        raise NotADirectoryError(errno.ENOTDIR, reason, str(folders.out))
    missing = [*_missing(folders.scratch), *_missing(folders.out)]
    try:
        folders.out.mkdir(parents=True, exist_ok=True)
        if not (folders.out / CLAIM).exists():
            _check_out(folders.out)
        with _locked(folders.out / CLAIM) as lock:
            _take(lock, folders, anew=anew)
            try:
                yield
            except BaseException as error:
                if isinstance(error, DegenerateInputError) or not (folders.scratch / JOB).is_file():
                    _leave(folders)  # nothing could be resumed
                raise
            _remove_unnamed(folders.out, os.fstat(lock).st_mtime_ns)
            _leave(folders)
    except BaseException:
        for folder in missing:
            with suppress(OSError):  # it was not made, or holds something
                folder.rmdir()
        raise


def _missing(folder: Path) -> list[Path]:
    """List the folders that have to be made for this one, the innermost first."""
    return [each for each in (folder, *folder.parents) if not os.path.lexists(each)]


def check_apart(folders: Folders, parts: Sequence[Part]) -> None:
    """Raise if a run would overwrite its own source.

    Parameters
    ----------
    folders : Folders
        Where it writes.
    parts : sequence of Part
        The source.

    Raises
    ------
    InputError
        A file of the source has a name that the run may use.
    """
    out = os.path.realpath(folders.out)
    for place in {part.place for part in parts if part.place is not None}:
        real = Path(os.path.realpath(place))
        if str(real.parent) == out and _SHARD.fullmatch(real.name):
            raise InputError(f"{place} would be overwritten: choose another folder than {out}")


def release_copies(folders: Folders, parts: Sequence[Part]) -> None:
    """Remove the copies of what cannot be read by ranges: the next run makes them anew.

    Parameters
    ----------
    folders : Folders
        Claimed.
    parts : sequence of Part
        The source, whose rows have been sorted by tile.
    """
    for place in {part.place for part in parts if part.place is not None}:
        path = Path(place)
        if path.parent == folders.scratch and _NOTE.fullmatch(path.name):
            path.unlink(missing_ok=True)


def clear(folders: Folders) -> None:
    """Remove the triangles of a former run, the manifest first.

    Parameters
    ----------
    folders : Folders
        Claimed.
    """
    (folders.out / MANIFEST).unlink(missing_ok=True)
    for name in _shards(folders.out):
        (folders.out / name).unlink()


def _shards(out: Path) -> list[str]:
    return sorted(path.name for path in out.iterdir() if _SHARD.fullmatch(path.name))


def _check_out(out: Path) -> None:
    """Raise if there are files with our names that no finished run has written."""
    names = _shards(out)
    if not names:
        return
    known = _named(out)
    for name in sorted(names, key=lambda name: name != MANIFEST):
        if name not in known:
            raise InputError(
                f"{out / name} was not made by a run of liftmesh that is known: it would be "
                "overwritten: move it, or choose another folder"
            )


def _named(out: Path) -> set[str]:
    """Return the files that a manifest names, and its own name; none if it is not ours."""
    try:
        manifest = manifest_of(out)
    except FormatError:
        return set()
    return {MANIFEST, *manifest["files"], *(shard["file"] for shard in manifest["shards"])}


def _remove_unnamed(out: Path, began: int) -> None:
    """Remove what a run has left that was stopped before this one began, in nanoseconds.

    That is shards of another plan, and files that were about to get their names.
    """
    for name in set(_shards(out)) - _named(out):
        (out / name).unlink()
    for path in out.iterdir():
        if re.fullmatch(_TEMPORARY, path.name) and path.lstat().st_mtime_ns < began:
            path.unlink()


@contextmanager
def _locked(path: Path) -> Iterator[int]:
    """Lock a file, which is made if it is missing; file systems without locks do without."""
    while True:
        lock = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            _lock(lock, path)
            if path.exists() and os.path.samestat(path.stat(), os.fstat(lock)):
                yield lock
                return
        finally:  # it may have been removed between the two calls: then once more
            os.close(lock)


def _lock(lock: int, path: Path) -> None:
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        holder = _claim(path).get("holder", "another process")
        raise InputError(
            f"{path.parent} is being written by {holder}: wait for it, or choose another folder"
        ) from None
    except OSError as error:
        if error.errno not in _UNABLE:
            raise


def _claim(path: Path) -> dict[str, str]:
    try:
        return load_json(path)
    except (FormatError, FileNotFoundError):
        return {}


def _take(lock: int, folders: Folders, *, anew: bool) -> None:
    """Say whose the folders are; a scratch folder that was used before must be known."""
    try:
        _take_scratch(folders, anew=anew)
    except BaseException:
        if os.fstat(lock).st_size == 0:  # the claim is new
            (folders.out / CLAIM).unlink()
        raise
    holder = f"process {os.getpid()} on {socket.gethostname()}"
    text = json.dumps({"holder": holder, "scratch": str(folders.scratch)})
    os.ftruncate(lock, 0)
    os.pwrite(lock, text.encode(), 0)


def _take_scratch(folders: Folders, *, anew: bool) -> None:
    before = Path(_claim(folders.out / CLAIM).get("scratch", folders.scratch))
    if before != folders.scratch and (before / MARKER).exists():
        if not anew:
            raise InputError(
                f"{folders.out} holds a run that works in {before}: give the same scratch folder, "
                "or begin anew with resume=False"
            )
        _remove(before)
    _make(folders.scratch)
    if anew:
        _remove(folders.scratch)
        _make(folders.scratch)


def _make(scratch: Path) -> None:
    scratch.mkdir(parents=True, exist_ok=True)
    others = [path for path in scratch.iterdir() if not re.fullmatch(_TEMPORARY, path.name)]
    if others and not (scratch / MARKER).is_file():
        raise InputError(
            f"{scratch} was not made by liftmesh: move it, or choose another scratch folder"
        )
    save_json(scratch / MARKER, {"kind": "scratch folder of liftmesh"})


def _remove(scratch: Path) -> None:
    """Remove what runs have written; the folder stays if it holds anything else."""
    if not (scratch / MARKER).is_file():
        return
    for path in [*scratch.iterdir()]:
        if _NOTE.fullmatch(path.name):
            path.unlink()
    if [path.name for path in scratch.iterdir()] == [MARKER]:
        (scratch / MARKER).unlink()
        scratch.rmdir()


def _leave(folders: Folders) -> None:
    """Remove the scratch folder, and the claim unless there are shards without a manifest."""
    _remove(folders.scratch)
    if (folders.out / MANIFEST).exists() or not _shards(folders.out):
        (folders.out / CLAIM).unlink()
