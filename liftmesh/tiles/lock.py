"""The folders of a run: what it may change in them, and that no two runs share them.

A run changes and removes what a run has made, and nothing else. It works in a scratch folder of its
own, with a marker in it, and writes to `out` under few names. While it works, `out` also holds a
lock file; if that is still there but not locked, the run was stopped. Files of such names without a
lock file, and without a manifest that names them, are somebody else's.
"""

from __future__ import annotations

import errno
import json
import os
import re
import socket
import stat
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

from liftmesh.base import platform
from liftmesh.base.interruption import opened
from liftmesh.errors import DegenerateInputError, FormatError, InputError, Option
from liftmesh.tiles.options import JOB, RunContext
from liftmesh.tiles.store import MANIFEST, load_json, manifest_of, save_json

if TYPE_CHECKING:
    from liftmesh.tiles.source_chunks import SourceChunk

LOCK_FILE = ".liftmesh-run"
MARKER = "scratch.json"

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
_ATTEMPTS = 100  # at making folders that other runs remove, which had made them
_LOCK_BYTES = 1 << 16


@contextmanager
def locked(context: RunContext, *, anew: bool) -> Iterator[None]:
    """Hold the folders of a run; what is left of it in the end is removed."""
    if context.out.exists() and not context.out.is_dir():
        reason = "cannot write tiles here: this is a file, not a folder"
        raise NotADirectoryError(errno.ENOTDIR, reason, str(context.out))
    made: list[Path] = []
    try:
        with _lock_file(context.out, made) as lock:
            _take(lock, context, made, anew=anew)
            try:
                yield
            except BaseException as error:
                if isinstance(error, DegenerateInputError) or not (context.scratch / JOB).is_file():
                    _leave(context)  # nothing could be resumed
                raise
            _remove_unnamed(context.out, os.fstat(lock).st_mtime_ns)
            _leave(context)
    except BaseException:
        for folder in reversed(made):
            with suppress(OSError):  # it holds something, perhaps of another run
                folder.rmdir()
        raise


def _make_folders(folder: Path, made: list[Path]) -> None:
    """Make a folder and those above it; list which of them no other run has made."""
    for each in (*reversed(folder.parents), folder):
        if not each.is_dir():
            with suppress(FileExistsError):
                each.mkdir()
                made.append(each)


def check_apart(context: RunContext, chunks: Sequence[SourceChunk]) -> None:
    """Raise if a run would overwrite its own source."""
    out = os.path.realpath(context.out)
    for place in {chunk.place for chunk in chunks if chunk.place is not None}:
        real = Path(os.path.realpath(place))
        if str(real.parent) == out and _SHARD.fullmatch(real.name):
            raise InputError(f"{place} would be overwritten: choose another folder than {out}")


def release_copies(context: RunContext, chunks: Sequence[SourceChunk]) -> None:
    """Remove the copies of what cannot be read by ranges: the next run makes them anew."""
    for place in {chunk.place for chunk in chunks if chunk.place is not None}:
        path = Path(place)
        if path.parent == context.scratch and _NOTE.fullmatch(path.name):
            path.unlink(missing_ok=True)


def clear(context: RunContext) -> None:
    """Remove the triangles of a former run, the manifest first."""
    (context.out / MANIFEST).unlink(missing_ok=True)
    for name in _shards(context.out):
        (context.out / name).unlink()


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
    """Remove what a run has left that was stopped before this one began, in nanoseconds."""
    for name in set(_shards(out)) - _named(out):
        (out / name).unlink()
    for path in out.iterdir():
        if re.fullmatch(_TEMPORARY, path.name) and path.lstat().st_mtime_ns < began:
            path.unlink()


@contextmanager
def _lock_file(out: Path, made: list[Path]) -> Iterator[int]:
    """Lock the file of a folder; both are made if they are missing."""
    path = out / LOCK_FILE
    while True:
        with ExitStack() as stack:
            lock = _open(path, made, stack)
            _lock(lock, path)
            if path.exists() and os.path.samestat(path.stat(), os.fstat(lock)):
                _check_lock(lock, path)
                yield lock
                return
        # It may have been removed between the two calls: then once more.


def _open(path: Path, made: list[Path], stack: ExitStack, attempts: int = _ATTEMPTS) -> int:
    """Open a lock file, never by a link; another run may remove the folders that it has made."""
    flags = os.O_RDWR | os.O_CREAT | platform.REGULAR
    try:
        _make_folders(path.parent, made)
        return stack.enter_context(opened(path, flags, 0o666))
    except FileNotFoundError:
        if attempts == 0:
            raise
        return _open(path, made, stack, attempts - 1)
    except OSError as error:
        if path.is_symlink():
            raise _not_ours(path) from error
        raise


def _lock(lock: int, path: Path) -> None:
    """Lock a file; file systems without locks do without."""
    try:
        platform.lock(lock)
    except BlockingIOError:
        holder = _holder(lock).get("holder", "another process")
        raise InputError(
            f"{path.parent} is being written by {holder}: wait for it, or choose another folder"
        ) from None


def _check_lock(lock: int, path: Path) -> None:
    """Raise if the file is not what a run leaves; nothing has been written to it."""
    state = os.fstat(lock)
    is_alone = stat.S_ISREG(state.st_mode) and state.st_nlink == 1
    if not is_alone or (state.st_size and {*_holder(lock)} != {"holder", "scratch"}):
        raise _not_ours(path)


def _not_ours(path: Path) -> InputError:
    return InputError(
        f"{path} was not made by a run of liftmesh: remove it, or choose another folder"
    )


def _holder(lock: int) -> dict[str, str]:
    """Read what the holder of a lock says; nothing if it says nothing."""
    try:
        os.lseek(lock, 0, os.SEEK_SET)
        said = json.loads(os.read(lock, _LOCK_BYTES))
    except (ValueError, RecursionError, OSError):
        return {}
    return said if isinstance(said, dict) and all(map(_is_text, said.values())) else {}


def _is_text(value: object) -> bool:
    return isinstance(value, str) and "\0" not in value


def _take(lock: int, context: RunContext, made: list[Path], *, anew: bool) -> None:
    """Say whose the folders are; a scratch folder that was used before must be known."""
    before = os.fstat(lock).st_size
    try:
        if not before:
            _check_out(context.out)
        _take_scratch(Path(_holder(lock).get("scratch", context.scratch)), context, made, anew=anew)
    except BaseException:
        if not before:  # the lock file is new
            (context.out / LOCK_FILE).unlink()
        raise
    holder = f"process {os.getpid()} on {socket.gethostname()}"
    text = json.dumps({"holder": holder, "scratch": str(context.scratch)})
    os.lseek(lock, 0, os.SEEK_SET)
    os.write(lock, text.encode().ljust(before))  # it is never empty again


def _take_scratch(before: Path, context: RunContext, made: list[Path], *, anew: bool) -> None:
    if before != context.scratch and (before / MARKER).is_file():
        if not anew:
            raise InputError(
                f"{context.out} holds a run that works in {before}: give the same scratch folder, "
                f"or begin anew with {Option('resume', False)}"
            )
        if _out_of(before) == os.path.realpath(context.out):
            _remove(before)
    _make(context, made)
    if anew:
        _remove(context.scratch)
        _make(context, made)


def _out_of(scratch: Path) -> object:
    """Return the folder that a run in this scratch folder writes to: a lock file may name any."""
    try:
        return load_json(scratch / MARKER).get("out")
    except FormatError:
        return None


def _make(context: RunContext, made: list[Path]) -> None:
    scratch = context.scratch
    if scratch.is_symlink():
        raise InputError(f"{scratch} is a link: remove it, or choose another scratch folder")
    _make_folders(scratch, made)
    others = [path for path in scratch.iterdir() if not re.fullmatch(_TEMPORARY, path.name)]
    if others and not (scratch / MARKER).is_file():
        raise InputError(
            f"{scratch} was not made by liftmesh: move it, or choose another scratch folder"
        )
    marker = {"kind": "scratch folder of liftmesh", "out": os.path.realpath(context.out)}
    save_json(scratch / MARKER, marker)


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


def _leave(context: RunContext) -> None:
    """Remove the scratch folder, and the lock file unless there are shards without a manifest."""
    _remove(context.scratch)
    if (context.out / MANIFEST).exists() or not _shards(context.out):
        (context.out / LOCK_FILE).unlink()
