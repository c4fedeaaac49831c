from collections.abc import Callable, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

VERSION: str
COMPILER: str
INSTRUCTIONS: str
MOST_ROWS: int
ROWS_PER_THREAD: int
WIDEST_RANGE_OF_DISKS: int

Outcome: TypeAlias = tuple[
    str,
    int,
    int,
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
]
Run: TypeAlias = tuple[NDArray[np.floating[Any]], bool, int, bool, Callable[[float], None] | None]
Flaws: TypeAlias = list[tuple[int, list[tuple[int, int]]]]
Verdict: TypeAlias = tuple[str, int, int, int, int, int, int, int, Flaws, int | None]
Merged: TypeAlias = tuple[
    str,
    int,
    NDArray[np.int64],
    NDArray[np.int32],
    NDArray[np.int64],
    NDArray[np.int64],
    NDArray[np.int64],
    NDArray[np.int32],
]
Refined: TypeAlias = tuple[
    NDArray[np.float64],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.uint8],
    NDArray[np.int32],
    NDArray[np.uint8],
    NDArray[np.uint8],
    bool,
]
Counts: TypeAlias = tuple[int, int, int, tuple[int, int, int, int, int, int], int]

def delaunay(
    rows: NDArray[np.floating[Any]],
    skip_non_finite: bool,
    threads: int,
    shared: bool,
    progress: Callable[[float], None] | None,
    folder: str | None = None,
) -> Outcome: ...
def delaunay_many(
    rows: NDArray[np.floating[Any]],
    offsets: NDArray[np.int64],
    skip_non_finite: bool,
    threads: int,
    shared: bool,
    progress: Callable[[float], None] | None,
) -> (
    tuple[int]
    | tuple[
        NDArray[np.int32],
        NDArray[np.int64],
        NDArray[np.int32],
        NDArray[np.int32],
        NDArray[np.int64],
        NDArray[np.int32],
        NDArray[np.int64],
        NDArray[np.int32],
        NDArray[np.int64],
    ]
): ...
def constrained(
    rows: NDArray[np.floating[Any]],
    edges: NDArray[np.int32],
    skip_non_finite: bool,
    threads: int,
    shared: bool,
    progress: Callable[[float], None] | None,
) -> tuple[
    Outcome,
    NDArray[np.uint8],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
]: ...
def carve(
    simplices: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    constrained: NDArray[np.uint8],
    pieces: NDArray[np.int32],
    bounds: NDArray[np.uint8],
    winding: NDArray[np.int32],
    carving: str,
    seeds: NDArray[np.int32],
) -> NDArray[np.uint8]: ...
def refine(
    rows: NDArray[np.floating[Any]],
    simplices: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    hull: NDArray[np.int32],
    marks: NDArray[np.uint8],
    pieces: NDArray[np.int32],
    regions: NDArray[np.int32],
    cosine: float,
    largest: NDArray[np.float64],
    lengths: Callable[[NDArray[np.float64], NDArray[np.int32]], NDArray[np.float64]] | None,
    conforming: bool,
    most: int,
    rounds: int,
    progress: Callable[[float], None] | None,
) -> Refined: ...
def crossing_places(pairs: NDArray[np.float64], places: NDArray[np.float64]) -> None: ...
def distances(edges_and_points: NDArray[np.float64], found: NDArray[np.float64]) -> None: ...
def label_regions(
    neighbors: NDArray[np.int32], constrained: NDArray[np.uint8]
) -> NDArray[np.int32]: ...
def canonical_order(
    points: NDArray[np.floating[Any]] | None,
    simplices: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    bits: NDArray[np.uint8] | None,
    rows: int,
    threads: int,
    shared: bool,
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.uint8]]: ...
def gift_wrap(
    rows: NDArray[np.floating[Any]],
    skip_non_finite: bool,
    threads: int,
    shared: bool,
    progress: Callable[[float], None] | None,
    method: str,
    qx: float,
    qy: float,
) -> tuple[Outcome, Counts]: ...
def lower_hull(
    rows: NDArray[np.floating[Any]], method: str, secret: int
) -> tuple[Outcome, Counts]: ...
def verify(
    rows: NDArray[np.floating[Any]],
    simplices: NDArray[np.int32],
    skip_non_finite: bool,
    threads: int,
    shared: bool,
    progress: Callable[[float], None] | None,
    member: str,
    values: NDArray[np.float64],
    edges: NDArray[np.int32] | None = None,
    carved: bool = False,
) -> Verdict: ...
def verify_part(
    rows: NDArray[np.floating[Any]],
    simplices: NDArray[np.int32],
    threads: int,
    shared: bool,
) -> tuple[Flaws, int, NDArray[np.int32]]: ...
def orient2d(
    a: NDArray[np.float64],
    b: NDArray[np.float64],
    c: NDArray[np.float64],
    signs: NDArray[np.int8],
) -> None: ...
def incircle(
    a: NDArray[np.float64],
    b: NDArray[np.float64],
    c: NDArray[np.float64],
    d: NDArray[np.float64],
    signs: NDArray[np.int8],
    canonical: bool,
) -> None: ...
def tetrahedralize(
    rows: NDArray[np.float64],
    skip_non_finite: bool,
    secret: int,
    threads: int,
    shared: bool,
    progress: Callable[[float], None] | None,
) -> tuple[
    str,
    int,
    int,
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
]: ...
def verify_tetrahedra(
    rows: NDArray[np.float64],
    simplices: NDArray[np.int32],
    skip_non_finite: bool,
    threads: int,
    shared: bool,
    progress: Callable[[float], None] | None,
) -> tuple[str, int, int, int, int, int, int, Flaws]: ...
def circumcentres(
    points: NDArray[np.float64], simplices: NDArray[np.int32], centres: NDArray[np.float64]
) -> None: ...
def edge_rings(
    simplices: NDArray[np.int32], neighbors: NDArray[np.int32]
) -> tuple[NDArray[np.int32], NDArray[np.int64], NDArray[np.uint8], NDArray[np.int32]]: ...
def verify_sphere(
    rows: NDArray[np.float64],
    simplices: NDArray[np.int32],
    skip_non_finite: bool,
    threads: int,
    shared: bool,
    progress: Callable[[float], None] | None,
) -> tuple[str, int, int, int, int, int, int, Flaws]: ...
def circumradii(
    points: NDArray[np.float64],
    simplices: NDArray[np.int32],
    up: bool,
    radii: NDArray[np.float64],
) -> None: ...
def alpha_filtration(
    points: NDArray[np.float64],
    simplices: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    radii: NDArray[np.float64],
) -> tuple[
    tuple[NDArray[np.int32], NDArray[np.float64]],
    tuple[NDArray[np.int32], NDArray[np.float64]],
]: ...
def alpha_surface(
    points: NDArray[np.float64],
    simplices: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    alpha: float,
    is_inside: NDArray[np.uint8],
) -> tuple[NDArray[np.int32], NDArray[np.int32]]: ...
def solid_alpha(
    simplices: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    rows: int,
    radii: NDArray[np.float64],
    components: int,
) -> float: ...
def proximity_graph(
    rows: NDArray[np.floating[Any]],
    simplices: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    kind: str,
) -> NDArray[np.int32]: ...
def lengths(
    rows: NDArray[np.floating[Any]], edges: NDArray[np.int32], found: NDArray[np.float64]
) -> None: ...
def spherical_delaunay(
    rows: NDArray[np.float64],
    skip_non_finite: bool,
    secret: int,
    progress: Callable[[float], None] | None,
) -> tuple[
    str,
    int,
    int,
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
]: ...
def circle_centres(
    points: NDArray[np.float64], simplices: NDArray[np.int32], centres: NDArray[np.float64]
) -> None: ...
def sphere_cells(
    simplices: NDArray[np.int32], neighbors: NDArray[np.int32], rows: int
) -> tuple[NDArray[np.int32], NDArray[np.int32]]: ...

class SpaceLocator:
    def __init__(
        self,
        points: NDArray[np.float64],
        simplices: NDArray[np.int32],
        neighbors: NDArray[np.int32],
    ) -> None: ...
    def find(self, queries: NDArray[np.float64], found: NDArray[np.int32]) -> None: ...

def orient3d(
    a: NDArray[np.float64],
    b: NDArray[np.float64],
    c: NDArray[np.float64],
    d: NDArray[np.float64],
    signs: NDArray[np.int8],
) -> None: ...
def insphere(
    a: NDArray[np.float64],
    b: NDArray[np.float64],
    c: NDArray[np.float64],
    d: NDArray[np.float64],
    e: NDArray[np.float64],
    signs: NDArray[np.int8],
    canonical: bool,
) -> None: ...
def lifted_side(
    a: NDArray[np.float64],
    b: NDArray[np.float64],
    c: NDArray[np.float64],
    d: NDArray[np.float64],
    values: NDArray[np.float64],
    lift: str,
    signs: NDArray[np.int8],
    canonical: bool,
) -> None: ...
def regular(
    rows: NDArray[np.floating[Any]],
    values: NDArray[np.floating[Any]],
    are_radii: bool,
    skip_non_finite: bool,
    threads: int,
    shared: bool,
    progress: Callable[[float], None] | None,
) -> tuple[Outcome, NDArray[np.int32]]: ...
def farthest(
    rows: NDArray[np.floating[Any]],
    skip_non_finite: bool,
    threads: int,
    shared: bool,
    progress: Callable[[float], None] | None,
) -> tuple[Outcome, NDArray[np.int32]]: ...
def delaunay_by_metric(
    rows: NDArray[np.floating[Any]],
    a: float,
    b: float,
    c: float,
    skip_non_finite: bool,
    threads: int,
    shared: bool,
    progress: Callable[[float], None] | None,
) -> Outcome: ...
def apollonius(
    disks: NDArray[np.float64], progress: Callable[[float], None] | None
) -> tuple[
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.float64],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
]: ...
def verify_apollonius(
    disks: NDArray[np.float64],
    simplices: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    circles: NDArray[np.float64],
    hull: NDArray[np.int32],
    hidden: NDArray[np.int32],
    duplicates: NDArray[np.int32],
    threads: int,
    shared: bool,
    progress: Callable[[float], None] | None,
) -> tuple[int, Flaws]: ...
def binary_range(disks: NDArray[np.float64]) -> tuple[int, int, int]: ...
def anisotropic_stars(
    points: NDArray[np.float64],
    metrics: NDArray[np.float64],
    starts: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    hull: NDArray[np.int32],
    progress: Callable[[float], None] | None,
) -> tuple[NDArray[np.int64], NDArray[np.int32]]: ...
def vertices(
    rows: NDArray[np.float64],
    values: NDArray[np.float64],
    lift: str,
    simplices: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    threads: int,
    shared: bool,
) -> tuple[NDArray[np.float64], NDArray[np.int32], int]: ...
def regions(
    rows: int,
    simplices: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    vertex_of: NDArray[np.int32],
) -> tuple[
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
    NDArray[np.int32],
]: ...
def clip(
    rows: NDArray[np.float64],
    values: NDArray[np.float64],
    lift: str,
    simplices: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    vertex_of: NDArray[np.int32],
    chain: NDArray[np.int32],
    domain: NDArray[np.float64],
    starts: NDArray[np.int32],
) -> (
    tuple[
        NDArray[np.int32],
        NDArray[np.float64],
        NDArray[np.bool_],
        NDArray[np.int64],
        NDArray[np.int32],
        int,
        NDArray[np.int32],
    ]
    | None
): ...
def height_between(
    a: NDArray[np.float64],
    b: NDArray[np.float64],
    c: NDArray[np.float64],
    values: NDArray[np.float64],
    lift: str,
    signs: NDArray[np.int8],
) -> None: ...
def merge_frontiers(
    records: NDArray[np.int64],
    rim: NDArray[np.int32],
    cell: NDArray[np.float64],
    foreign: NDArray[np.float64],
    is_everything: bool,
    with_neighbors: bool,
    threads: int,
    shared: bool,
    progress: Callable[[float], None] | None,
    folder: str | None = None,
) -> Merged: ...
def find_rows(
    rows: NDArray[np.int64], triangles: NDArray[np.int64], threads: int
) -> NDArray[np.int32]: ...
def reach_of(points: NDArray[np.float64], faces: NDArray[np.int32]) -> NDArray[np.float64]: ...
def find_reaching(
    points: NDArray[np.float64], faces: NDArray[np.int32], box: NDArray[np.float64]
) -> NDArray[np.bool_]: ...
def partition(
    rows: NDArray[np.floating[Any]],
    first: int,
    axes: NDArray[np.uint8],
    at: NDArray[np.float64],
    children: NDArray[np.int32],
    tiles: int,
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64], NDArray[np.int64]]: ...
def find_lines(
    data: bytes, comments: Sequence[str], keep_tabs: bool, threads: int
) -> tuple[NDArray[np.int64], NDArray[np.int64], int]: ...
def find_keywords(
    data: bytes, lines: NDArray[np.int64], keywords: Sequence[str]
) -> NDArray[np.int8]: ...
def count_values(line: bytes, delimiter: str) -> int: ...
def parse_table(
    data: bytes, lines: NDArray[np.int64], width: int, delimiter: str, threads: int
) -> NDArray[np.float64] | None: ...
def parse_numbers(
    data: bytes, lines: NDArray[np.int64], threads: int
) -> tuple[NDArray[np.int64], NDArray[np.int64] | NDArray[np.float64]] | None: ...
def parse_corners(
    data: bytes, lines: NDArray[np.int64], threads: int
) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int32] | None] | None: ...

class Printer:
    def __init__(self, around: Sequence[str], shortest: bool, threads: int) -> None: ...
    def begin(self, columns: Sequence[NDArray[Any]]) -> None: ...
    def finish(self) -> list[memoryview]: ...

def simplify(
    points: NDArray[np.float64],
    heights: NDArray[np.float64],
    hull: NDArray[np.int32],
    edges: NDArray[np.int32],
    tolerance: float,
    most: int,
    prunes: bool,
    progress: Callable[[float], None] | None,
) -> tuple[NDArray[np.int32], bool, int]: ...
def thin(
    points: NDArray[np.float64],
    heights: NDArray[np.float64],
    hull: NDArray[np.int32],
    most: int,
    progress: Callable[[float], None] | None,
) -> tuple[NDArray[np.int32], bool, int]: ...

class DynamicMesh:
    def insert(self, rows: NDArray[np.floating[Any]], found: NDArray[np.int32]) -> None: ...
    def remove(self, numbers: NDArray[np.int32]) -> None: ...
    def insert_constraints(self, edges: NDArray[np.int32]) -> tuple[int, NDArray[np.int32]]: ...
    def remove_constraint(self, a: int, b: int) -> bool: ...
    def first_held(self, numbers: NDArray[np.int32]) -> tuple[int, NDArray[np.int32]]: ...
    def constraints(
        self,
    ) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]: ...
    def marks(self) -> NDArray[np.uint8]: ...
    def find(self, positions: NDArray[np.float64], found: NDArray[np.int32]) -> None: ...
    def count(self) -> int: ...
    def end(self) -> int: ...
    def first_absent(self, numbers: NDArray[np.int32]) -> int: ...
    def points(self) -> NDArray[np.float64]: ...
    def triangles(
        self,
    ) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32]]: ...

class Locator:
    def __init__(
        self,
        points: NDArray[np.floating[Any]],
        simplices: NDArray[np.int32],
        neighbors: NDArray[np.int32],
    ) -> None: ...
    def find(
        self,
        queries: NDArray[np.float64],
        found: NDArray[np.int32],
        threads: int,
        shared: bool,
    ) -> None: ...

def leave_out_from_rim(
    neighbors: NDArray[np.int32], is_long: NDArray[np.uint8], left_out: NDArray[np.uint8]
) -> None: ...
def rings(
    points: NDArray[np.floating[Any]],
    simplices: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    left_out: NDArray[np.uint8] | None,
) -> tuple[NDArray[np.int32], NDArray[np.int64]]: ...
def passages(
    points: NDArray[np.floating[Any]],
    simplices: NDArray[np.int32],
    neighbors: NDArray[np.int32],
    ends: NDArray[np.float64],
    starts: NDArray[np.int32],
) -> tuple[NDArray[np.int32], NDArray[np.int32]]: ...

class Relief:
    def __init__(
        self,
        points: NDArray[np.floating[Any]],
        simplices: NDArray[np.int32],
        neighbors: NDArray[np.int32],
        heights: NDArray[np.float64],
        left_out: NDArray[np.uint8] | None,
    ) -> None: ...
    def sample(
        self,
        locator: Locator,
        queries: NDArray[np.float64],
        heights: NDArray[np.float64],
        method: str,
        threads: int,
        shared: bool,
    ) -> None: ...
    def weights(
        self,
        locator: Locator,
        queries: NDArray[np.float64],
        method: str,
        threads: int,
        shared: bool,
    ) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.float64]] | None: ...
    def gradients(
        self,
        locator: Locator,
        queries: NDArray[np.float64],
        gradients: NDArray[np.float64],
        threads: int,
        shared: bool,
    ) -> None: ...
    def owners(
        self,
        locator: Locator,
        queries: NDArray[np.float64],
        faces: NDArray[np.int32],
        threads: int,
        shared: bool,
    ) -> None: ...
    def scan(
        self,
        locator: Locator,
        transform: tuple[float, float, float, float, float, float],
        first_row: int,
        pixels: NDArray[np.float64] | NDArray[np.float32] | NDArray[np.int32],
        threads: int,
        shared: bool,
    ) -> None: ...
    def height_range(self, threads: int, shared: bool) -> tuple[float, float]: ...
    def contours(
        self, levels: NDArray[np.float64], threads: int, shared: bool
    ) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int32], NDArray[np.uint8]]: ...
    def between(self, other: Relief, face: int, touching: int) -> tuple[float, float, float]: ...
    def overlay(
        self,
        other: Relief,
        face: int,
        touching: int,
        threads: int,
        shared: bool,
        progress: Callable[[float], None] | None,
    ) -> (
        tuple[
            NDArray[np.float64],
            NDArray[np.float64],
            NDArray[np.int32],
            NDArray[np.int32],
            NDArray[np.uint8],
            int,
            float,
        ]
        | None
    ): ...
    def between_within(
        self,
        other: Relief,
        parts: NDArray[np.float64],
        faces: NDArray[np.int32],
        touching: NDArray[np.int32],
    ) -> tuple[float, float, float]: ...
