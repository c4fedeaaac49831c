"""The scans of an E57 file, as the process that decodes them describes and sends them.

libE57 is written in C++ and takes paths only: a damaged file may end the process that reads it.
`PROGRAM` is given the path of modules, which must not begin with the current folder, the path of
the file, the rows of a piece, and the bytes of memory and the seconds of a processor that it may
take, which the system holds it to where it can. It writes a line of JSON to stdout, which describes
the scans, then the values of each, piece by piece and field by field. What is wrong stands in
stderr.

The module of libE57 is loaded without the package around it, which imports NumPy: the process takes
a tenth of the time to start. Buffers of 64 bits have the type q: pye57 takes l for 32 bits.
"""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any, BinaryIO

import numpy as np

from liftmesh._typing import Array
from liftmesh.errors import FormatError, MissingDependencyError, Option
from liftmesh.io.streams import is_file
from liftmesh.optional import python_command

PROGRAM = """
import json, os, sys
sys.path[:] = json.loads(sys.argv[1])
try:
    import resource
except ImportError:  # not on Windows
    resource = None
limits = {"RLIMIT_DATA": int(sys.argv[4]), "RLIMIT_CPU": int(sys.argv[5]), "RLIMIT_CORE": 0}
for each, most in limits.items() if resource else ():
    kind = getattr(resource, each)
    before, hard = resource.getrlimit(kind)
    known = [k for k in (before, hard, most) if k != resource.RLIM_INFINITY]
    resource.setrlimit(kind, (min(known), hard))
answer = os.fdopen(os.dup(1), "wb")
os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
from importlib.machinery import PathFinder
from importlib.util import module_from_spec
package = PathFinder.find_spec("pye57", sys.path)
places = package and package.submodule_search_locations
found = places and PathFinder.find_spec("libe57", places)
if not found:
    sys.exit("missing: there is no module of it for this Python")
try:
    libe57 = module_from_spec(found)
    found.loader.exec_module(libe57)
except ImportError as error:
    sys.exit(f"missing: {error}")

TYPES = {"f4": "f", "f8": "d", "u1": "B", "i1": "b", "u2": "H", "i2": "h", "i8": "q"}
BOUNDS = {"u1": (0, 255), "i1": (-128, 127), "u2": (0, 65535), "i2": (-32768, 32767)}
KINDS = libe57.NodeType
NUMBERS = {
    KINDS.E57_FLOAT: libe57.FloatNode, KINDS.E57_INTEGER: libe57.IntegerNode,
    KINDS.E57_SCALED_INTEGER: libe57.ScaledIntegerNode,
}
COORDINATES = ("cartesian", "spherical")

def type_of(node, name):
    kind = node.type()
    if kind == KINDS.E57_SCALED_INTEGER or name.startswith(COORDINATES) and name[-5:] != "State":
        return "f8"
    if kind == KINDS.E57_FLOAT:
        single = libe57.FloatNode(node).precision() == libe57.FloatPrecision.E57_SINGLE
        return "f4" if single else "f8"
    if kind != KINDS.E57_INTEGER:
        return None
    bounds = libe57.IntegerNode(node)
    for each, (low, high) in BOUNDS.items():
        if low <= bounds.minimum() and bounds.maximum() <= high:
            return each
    return "i8"

def number(node):
    found = NUMBERS[node.type()](node)
    return float(found.scaledValue() if hasattr(found, "scaledValue") else found.value())

def pose_of(scan):
    if not scan.isDefined("pose"):
        return None
    found, pose = [], libe57.StructureNode(scan.get("pose"))
    for group, names in (("rotation", "wxyz"), ("translation", "xyz")):
        values = [float(name == "w") for name in names]
        if pose.isDefined(group):
            values = [number(pose.get(f"{group}/{name}")) for name in names]
        found.append(values)
    return found

def text_of(structure, name):
    there = structure.isDefined(name) and structure.get(name).type() == KINDS.E57_STRING
    return libe57.StringNode(structure.get(name)).value() if there else ""

def limits_of(scan, name):
    group = libe57.StructureNode(scan.get(name)) if scan.isDefined(name) else None
    children = [group.get(k) for k in range(group.childCount())] if group else []
    return {each.elementName(): number(each) for each in children if each.type() in NUMBERS}

def described(scan):
    points = libe57.CompressedVectorNode(scan.get("points"))
    prototype = libe57.StructureNode(points.prototype())
    children = [prototype.get(k) for k in range(prototype.childCount())]
    types = {each.elementName(): type_of(each, each.elementName()) for each in children}
    return points, {
        "name": text_of(scan, "name"), "rows": points.childCount(), "pose": pose_of(scan),
        "fields": {name: kind for name, kind in types.items() if kind},
        "skipped": [name for name, kind in types.items() if not kind],
        "limits": limits_of(scan, "colorLimits") | limits_of(scan, "intensityLimits"),
    }

def write(points, about, rows):
    fields = about["fields"]
    rows = min(rows, about["rows"])
    arrays = [memoryview(bytearray(rows * int(kind[1]))) for kind in fields.values()]
    buffers = libe57.VectorSourceDestBuffer()
    for (name, kind), array in zip(fields.items(), arrays):
        values = array.cast(TYPES[kind])
        buffers.append(libe57.SourceDestBuffer(image, name, values, rows, True, True))
    reader, left = points.reader(buffers), about["rows"]
    while left:
        count = reader.read()
        if count != min(rows, left):
            sys.exit(f"wrong: {left:,} of {about['rows']:,} points of a scan are missing")
        for array in arrays:
            answer.write(array[: len(array) // rows * count])
        left -= count
    reader.close()

try:
    image = libe57.ImageFile(sys.argv[2], "r")
    root = image.root()
    scans = libe57.VectorNode(root.get("data3D")) if root.isDefined("data3D") else None
    count = scans.childCount() if scans else 0
    found = [described(libe57.StructureNode(scans.get(k))) for k in range(count)]
    images = root.isDefined("images2D") and libe57.VectorNode(root.get("images2D")).childCount()
    head = {"crs": text_of(root, "coordinateMetadata"), "images": int(images)}
    head["scans"] = [about for _, about in found]
    answer.write(json.dumps(head).encode() + b"\\n")
    answer.flush()
    for points, about in found:
        if about["rows"] and about["fields"]:
            write(points, about, int(sys.argv[3]))
    answer.flush()
except MemoryError:
    sys.exit("memory: not enough")
except (libe57.E57Exception, ValueError, KeyError) as error:
    sys.exit(f"wrong: {str(error).strip().splitlines()[0] if str(error) else type(error).__name__}")
"""


PIECE = 1 << 16  # rows
_MOST_HEAD = 1 << 26  # bytes of the description of all scans
_MOST_SAID = 1 << 12  # bytes of a message
_MISSING, _WRONG, _MEMORY = "missing: ", "wrong: ", "memory: "
_BASE = 1 << 28  # bytes that libE57 and a piece of rows take of an ordinary file
_SECONDS, _SLOWEST = 120, 100_000  # of a processor: for any file, and bytes that take one more


@dataclass(frozen=True, slots=True)
class Scan:
    """What an E57 file says of a scan."""

    name: str
    rows: int
    pose: tuple[list[float], list[float]] | None  # rotation (w, x, y, z) and translation
    fields: dict[str, str]  # types by name
    skipped: list[str]  # fields of other kinds
    limits: dict[str, float]  # of colours and intensities


@dataclass(frozen=True, slots=True)
class Limits:
    """What the process may take: bytes of memory, and seconds of a processor."""

    memory: int
    seconds: int

    @classmethod
    def of(cls, size: int, content: int) -> Limits:
        """Return the limits for a file of some bytes, whose content may take as many as stated."""
        return cls(_BASE + content, _SECONDS + size // _SLOWEST)


class Decoder:
    """The process that decodes a file; it is ended at the latest where `decoded` ends."""

    def __init__(
        self, process: subprocess.Popen[bytes], messages: IO[bytes], name: str, limits: Limits
    ) -> None:
        self._process = process
        self._messages = messages
        self._name = name
        self._limits = limits
        self._answer: Any = process.stdout
        head = self._head()
        self.crs: str = head["crs"]
        self.images: int = head["images"]
        self.scans = [Scan(**each) for each in head["scans"]]

    def columns(self, scan: Scan) -> Iterator[dict[str, Array]]:
        """Yield the values of the next scan by field, a piece of its rows at a time."""
        left = scan.rows if scan.fields else 0
        while left:
            count = min(PIECE, left)
            yield {name: self._values(count, kind) for name, kind in scan.fields.items()}
            left -= count

    def _head(self) -> dict[str, Any]:
        line: bytes = self._answer.readline(_MOST_HEAD)
        if not line.endswith(b"\n"):
            raise self._ended()
        head: dict[str, Any] = json.loads(line)
        return head

    def _values(self, count: int, kind: str) -> Array:
        values = np.empty(count, kind)
        left = memoryview(values).cast("B")  # type: ignore[arg-type]
        while left:
            size = self._answer.readinto(left)
            if not size:
                raise self._ended()
            left = left[size:]
        return values

    def _ended(self) -> Exception:
        """Say why the process has ended."""
        code = self._process.wait()
        self._messages.seek(0)
        said = self._messages.read()[-_MOST_SAID:].decode("utf-8", "replace").strip()
        last = said.splitlines()[-1] if said else ""
        if last.startswith(_MISSING):
            return MissingDependencyError(
                f"this needs pye57, which cannot be imported ({last.removeprefix(_MISSING)}): "
                "pip install 'liftmesh[e57]'"
            )
        if last.startswith(_MEMORY):
            return FormatError(
                f"{self._name}: libE57 needs more than {self._limits.memory:,} bytes to decode it, "
                "the limit for this file: if you trust it, raise it with "
                f"{Option('max_bytes', ...)}"
            )
        if code == -getattr(signal, "SIGXCPU", 0) != 0:
            return FormatError(
                f"{self._name}: libE57 does not decode it in {self._limits.seconds:,} s, the limit "
                "for this file: it is damaged"
            )
        cause = last.removeprefix(_WRONG) if last.startswith(_WRONG) else f"libE57 ended ({code})"
        return FormatError(f"{self._name}: the file cannot be decoded: {cause}")


@contextmanager
def decoded(stream: BinaryIO, name: str, limits: Limits) -> Iterator[Decoder]:
    """Start the process that decodes a file."""
    with _path_of(stream, name) as path, tempfile.TemporaryFile() as messages:
        bounds = map(str, (PIECE, limits.memory, limits.seconds))
        words = [*python_command(PROGRAM, "libE57"), path, *bounds]
        process = subprocess.Popen(  # noqa: S603 - our own program and a path
            words,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=messages,
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},
        )
        try:
            yield Decoder(process, messages, name, limits)
        finally:
            process.kill()
            process.communicate()


@contextmanager
def _path_of(stream: BinaryIO, name: str) -> Iterator[str]:
    """Yield the path of a file, or of a copy of what is none."""
    if is_file(stream, name):
        yield os.path.abspath(name)  # noqa: PTH100
        return
    with tempfile.TemporaryDirectory(prefix="liftmesh-") as folder:
        path = Path(folder, "copy.e57")
        with path.open("wb") as copy:
            stream.seek(0)
            shutil.copyfileobj(stream, copy)
        yield str(path)
