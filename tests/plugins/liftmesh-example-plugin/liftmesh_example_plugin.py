"""What another package adds to liftmesh: files with the suffix .tri1, and the type `Survey`.

A .tri1 file is text: ``tri1``, a line ``v x y z`` for each vertex, a line ``t a b c`` for each
triangle, its vertices counted from 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from liftmesh import Adapter, Cloud, Format, FormatError


def read_tri1(stream: BinaryIO, name: str) -> Cloud:
    """Read a .tri1 file."""
    first, *lines = stream.read().decode("ascii").splitlines()
    if first != "tri1":
        raise FormatError(f"{name}: line 1: not a tri1 file")
    rows = [line.split() for line in lines]
    points = [[float(value) for value in row[1:]] for row in rows if row[0] == "v"]
    faces = [[int(value) for value in row[1:]] for row in rows if row[0] == "t"]
    return Cloud(
        np.array(points, dtype=np.float64).reshape(-1, 3),
        faces=np.array(faces, dtype=np.int32).reshape(-1, 3) if faces else None,
    )


def write_tri1(stream: BinaryIO, cloud: Cloud, *, title: str = "tri1") -> None:
    """Write a .tri1 file."""
    stream.write(f"{title}\n".encode("ascii"))
    stream.writelines(f"v {x!r} {y!r} {z!r}\n".encode("ascii") for x, y, z in cloud.points.tolist())
    stream.writelines(
        f"t {a} {b} {c}\n".encode("ascii")
        for a, b, c in ([] if cloud.faces is None else cloud.faces.tolist())
    )


@dataclass
class Survey:
    """Heights measured at eastings and northings."""

    eastings: list[float]
    northings: list[float]
    heights: list[float]


def from_survey(survey: object) -> Cloud:
    """Turn a survey into a cloud."""
    assert isinstance(survey, Survey)
    return Cloud(np.column_stack([survey.eastings, survey.northings, survey.heights]))


TRI1 = Format("tri1", (".tri1",), read_tri1, write_tri1, "an example of a format")
SURVEY = Adapter("survey", lambda source: isinstance(source, Survey), from_survey)
