"""Build the library that makes system calls fail, and tell it which ones."""

from __future__ import annotations

import ctypes
import errno
import os
import shlex
import subprocess
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

SOURCE = Path(__file__).with_name("shim.c")
PRELOAD = "LD_PRELOAD"

PART, ACT = -1, -2
_CALLABLE = ctypes.CFUNCTYPE(None)

# What may happen to each system call.
_ROOM = (errno.ENOSPC, errno.EDQUOT)
FAULTS: dict[str, tuple[int, ...]] = {
    "open": (errno.EIO, errno.EINTR, errno.EACCES, errno.EMFILE, errno.EROFS, *_ROOM),
    "read": (errno.EIO, errno.EINTR, PART),
    "write": (errno.EIO, errno.EINTR, PART, *_ROOM),
    "close": (errno.EIO, errno.EINTR, *_ROOM),
    "lseek": (),  # fails for pipes alone
    "fsync": (errno.EIO, errno.EINTR, *_ROOM),
    "ftruncate": (errno.EIO, errno.EINTR, *_ROOM),
    "fchmod": (errno.EIO, errno.EPERM),
    "stat": (errno.EIO, errno.EACCES),
    "access": (errno.EIO, errno.EACCES, errno.EROFS),
    "readlink": (errno.EIO, errno.EACCES),
    "unlink": (errno.EIO, errno.EACCES),
    "link": (errno.EIO, errno.EPERM, errno.EROFS, *_ROOM),
    "rename": (errno.EIO, errno.EACCES, errno.EXDEV, *_ROOM),
}


@dataclass(frozen=True, slots=True)
class Fault:
    """What happens at a call: an error, once or from then on, a part of the bytes, or an action."""

    at: int
    kind: int
    is_lasting: bool = False
    action: str = ""

    def __str__(self) -> str:
        name = "a part" if self.kind == PART else self.action or errno.errorcode[self.kind]
        return f"{name} at call {self.at}{' and on' if self.is_lasting else ''}"


def build(folder: Path) -> Path:
    """Compile the library."""
    target = folder / "shim.so"
    compiler = shlex.split(os.environ.get("CC", "cc"))
    flags = ["-std=gnu11", "-O1", "-shared", "-fPIC", "-Wall", "-Wno-nonnull-compare"]
    subprocess.run([*compiler, *flags, str(SOURCE), "-o", str(target), "-ldl"], check=True)
    return target


class Shim:
    """The library, preloaded into this process, and the folder that it watches."""

    def __init__(self, folder: Path) -> None:
        self._folder = os.fsencode(folder)
        self._library = ctypes.CDLL(None)
        self._library.faults_name.restype = ctypes.c_char_p
        self._library.faults_count.restype = ctypes.c_long
        self._held: object = None

    def arm(
        self, fault: Fault | None, *, nameless: bool, action: Callable[[], None] | None = None
    ) -> None:
        """Let a fault happen; without nameless files if the file system is to have none."""
        at, kind, lasting = (fault.at, fault.kind, fault.is_lasting) if fault else (0, 0, False)
        self._held = _CALLABLE(action or (lambda: None))  # else it would be freed too early
        self._library.faults_arm(
            self._folder, ctypes.c_long(at), kind, lasting, not nameless, self._held
        )

    def disarm(self) -> None:
        """Let all calls pass again."""
        self._library.faults_disarm()

    def calls(self) -> list[str]:
        """Return the names of the calls since the library was armed."""
        count = self._library.faults_count()
        name = self._library.faults_name
        return [name(ctypes.c_long(k)).decode() for k in range(1, count + 1)]
