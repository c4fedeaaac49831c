"""Areas and volumes at many levels: rationals, basins with known answers, and the way back."""

from __future__ import annotations

import json
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from commands import failed, liftmesh as run
from hypothesis import given, settings, strategies as st
from oracles.earthwork import clipped, under_roof
from oracles.surfaces import turn
from surfaces import LATTICE, drawn, exactly, meadow

import liftmesh

LEVELS = st.lists(st.integers(-36, 36).map(lambda each: each / 4), min_size=1, max_size=6)


def exact_stage(surface: liftmesh.Surface, level: float) -> tuple[Fraction, Fraction]:
    """Cut each face along the level: the area and the volume of what is at or below it."""
    oracle = exactly(surface)
    area = volume = Fraction(0)
    for face in oracle.faces:
        corners = [(oracle.points[row], oracle.heights[row] - Fraction(level)) for row in face]
        below = list(clipped(corners, -1))
        volume -= under_roof(below)
        if all(depth <= 0 for _, depth in corners):
            area += turn(*(point for point, _ in corners)) / 2
        else:
            area += sum(turn(below[0][0], one[0], two[0]) / 2 for one, two in pairwise(below[1:]))
    return area, volume


@settings(max_examples=60)
@given(LATTICE, LEVELS)
def test_areas_and_volumes_are_those_of_rationals(points, levels) -> None:
    surface = drawn(points)
    if surface is None:
        return
    found = surface.stage_storage(levels)
    assert found.levels.tolist() == sorted({*levels})
    for level, area, volume in zip(found.levels, found.areas, found.volumes, strict=True):
        exact = exact_stage(surface, level)
        assert area == pytest.approx(float(exact[0]), rel=1e-14)
        assert volume == pytest.approx(float(exact[1]), rel=1e-13)


@settings(max_examples=60)
@given(LATTICE, st.lists(st.floats(0, 60), min_size=1, max_size=5), st.booleans())
def test_levels_of_volumes_hold_them(points, volumes, above: bool) -> None:
    surface = drawn(points)
    if surface is None or surface.volume(99).below == 0:
        return
    volumes = sorted(volumes)
    levels = surface.stage_storage(0, above=above).level_of(volumes)
    steps = np.diff(levels)
    assert (steps <= 0).all() if above else (steps >= 0).all()
    for level, volume in zip(levels, volumes, strict=True):
        held = surface.volume(level)
        assert (held.above if above else held.below) == pytest.approx(volume, rel=1e-12, abs=1e-12)


def test_levels_where_each_cuts_most_faces() -> None:
    table = liftmesh.triangulate(np.random.default_rng(8).random((400, 3))).stage_storage(
        interval=0.05
    )
    levels = table.level_of(table.volumes[1:-1])
    assert levels == pytest.approx(table.levels[1:-1], abs=1e-14)
    assert (np.diff(levels) > 0).all()


@settings(max_examples=40)
@given(LATTICE, LEVELS, st.randoms(use_true_random=False))
def test_no_bit_depends_on_the_order_of_the_rows(points, levels, rng) -> None:
    points = [(x / 3, y / 7, z / 9) for x, y, z in points]
    shuffled = list(points)
    rng.shuffle(shuffled)
    one, two = drawn(points), drawn(shuffled)
    if one is None:
        return
    found, other = one.stage_storage(levels), two.stage_storage(levels)
    assert np.array_equal(found.areas, other.areas)
    assert np.array_equal(found.volumes, other.volumes)
    assert np.array_equal(found.level_of([0.1, 2.0]), other.level_of([0.1, 2.0]))


def test_above_is_below_upside_down() -> None:
    surface = liftmesh.triangulate(meadow())
    turned = liftmesh.triangulate(meadow() * (1, 1, -1))
    found, other = surface.stage_storage([3, 9], above=True), turned.stage_storage([-3, -9])
    assert np.array_equal(found.volumes, other.volumes[::-1])
    assert np.array_equal(found.areas, other.areas[::-1])
    assert found.level_of(5.0) == -other.level_of(5.0)
    assert found.volumes == pytest.approx([surface.volume(each).above for each in (3, 9)])


def test_a_cone_of_many_faces() -> None:
    """A basin of depth 6 and radius 4: volumes grow with the cube of the depth."""
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    rim = np.column_stack([4 * np.cos(angle), 4 * np.sin(angle), np.zeros(400)])
    basin = liftmesh.triangulate([*rim.tolist(), [0, 0, -6]])
    found = basin.stage_storage(np.linspace(-6, 0, 61))
    depths = (found.levels + 6) / 6
    assert found.areas == pytest.approx(found.areas[-1] * depths**2)
    assert found.volumes == pytest.approx(found.volumes[-1] * depths**3)
    assert found.volumes[-1] == pytest.approx(np.pi * 32, rel=1e-3)
    assert found.level_of(found.volumes) == pytest.approx(found.levels, abs=1e-12)


def test_a_shallow_sheet_over_a_deep_pit_keeps_its_digits() -> None:
    """What lies far below does not cost digits of what was added last."""
    corners = [[0, 0, 0], [1e3, 0, 0], [0, 1e3, 0], [1e3, 1e3, 0]]
    pan = liftmesh.triangulate([*corners, [1, 1, -1e-7], [2, 1, -1e-7], [1, 2, -1e-7]])
    found = pan.stage_storage([0, 1e-9])
    assert np.diff(found.volumes)[0] == pytest.approx(1e6 * 1e-9, rel=1e-7)


def test_levels_between_equal_heights_and_beyond_all() -> None:
    flat = liftmesh.triangulate([[0, 0, 7], [2, 0, 7], [0, 2, 7], [2, 2, 7]])
    found = flat.stage_storage([6, 7, 8])
    assert (found.areas.tolist(), found.volumes.tolist()) == ([0, 4, 4], [0, 0, 4])
    assert found.level_of([[0, 2], [4, 8]]).tolist() == [[7, 7.5], [8, 9]]
    assert flat.stage_storage(6, above=True).level_of([0, 4]).tolist() == [7, 6]


def test_multiples_of_an_interval() -> None:
    slope = liftmesh.triangulate([[0, 0, 0.3], [4, 0, 2.2], [0, 4, 0.3]])
    assert slope.stage_storage(interval=0.5).levels.tolist() == [0, 0.5, 1, 1.5, 2, 2.5]
    assert slope.stage_storage(interval=1, above=True).levels.tolist() == [0, 1, 2, 3]


def test_many_levels_are_cut_in_parts(monkeypatch) -> None:
    surface = liftmesh.triangulate(meadow())
    levels = np.linspace(-1, 12, 40)
    whole = surface.stage_storage(levels)
    monkeypatch.setattr("liftmesh.terrain.stages._PAIRS", 50)
    parts = surface.stage_storage(levels)
    assert np.array_equal(whole.volumes, parts.volumes)
    assert np.array_equal(whole.areas, parts.areas)


def test_few_heights_are_tried_at_once(monkeypatch) -> None:
    found = liftmesh.triangulate(meadow()).stage_storage(0)
    volumes = np.linspace(0, 2e4, 9)
    levels = found.level_of(volumes)
    monkeypatch.setattr("liftmesh.terrain.stages._STEPS", 3)
    assert found.level_of(volumes) == pytest.approx(levels, rel=1e-12)


@pytest.mark.parametrize(
    ("levels", "said"),
    [
        ([1, np.nan], "levels are"),
        (np.inf, "levels are"),
        ("sea", "levels cannot be read as numbers"),
        ([], "levels are .*: give a height"),
        (None, "give either levels or interval"),
    ],
)
def test_what_are_no_levels_is_refused(levels, said: str) -> None:
    with pytest.raises(liftmesh.InputError, match=said):
        liftmesh.triangulate([[0, 0, 0], [1, 0, 1], [0, 1, 0]]).stage_storage(levels)


@pytest.mark.parametrize("volumes", [-1, [2, np.nan], np.inf, "much", None])
def test_what_are_no_volumes_is_refused(volumes) -> None:
    found = liftmesh.triangulate([[0, 0, 0], [1, 0, 1], [0, 1, 0]]).stage_storage(1)
    with pytest.raises(liftmesh.InputError, match="volumes are"):
        found.level_of(volumes)


@pytest.mark.parametrize("scale", [1e-160, 1e150, 1e300])
def test_far_away_it_is_right_or_says_so(scale: float) -> None:
    corners = np.array([[0, 0, 0], [1, 0, 1], [0, 1, 0], [1, 1, 1]]) * scale
    surface = liftmesh.triangulate(corners)
    if scale > 1:
        with pytest.raises(liftmesh.InputError, match="beyond the largest double"):
            surface.stage_storage(scale)
    else:
        assert surface.stage_storage(scale).level_of(0.0) == 0


class TestCommand:
    @pytest.fixture
    def pit(self, tmp_path: Path) -> Path:
        corners = [[0, 0, 0], [20, 0, 0], [0, 20, 0], [20, 20, 0], [10, 10, -3.0]]
        liftmesh.triangulate(corners, crs="EPSG:7415").save(tmp_path / "pit.ply")
        return tmp_path / "pit.ply"

    def test_a_table(self, pit) -> None:
        done = run("volume", pit, "--levels", "-1.5,0")
        assert done.returncode == 0, done.stderr
        lines = [line.split() for line in done.stdout.splitlines()]
        assert lines[0] == ["level", "planar", "area", "below", "volume", "below"]
        assert lines[1:] == [["-1.5", "100", "50"], ["0", "400", "400"]]
        assert done.stderr == ""

    def test_json_of_volumes(self, pit) -> None:
        found = json.loads(run("volume", pit, "--volumes", "50,400", "--json").stdout)
        assert [each["level"] for each in found["stages"]] == pytest.approx([-1.5, 0], abs=1e-12)
        assert [each["below"] for each in found["stages"]] == pytest.approx([50, 400])
        assert found["cubic_metres_per_unit"] == 1

    def test_units_that_are_not_known_are_said(self, pit) -> None:
        liftmesh.triangulate([[0, 0, 0], [1, 0, 1], [0, 1, 0]]).save(pit)
        done = run("volume", pit, "--interval", "1", "--above")
        assert "units of x, y and z are not all known" in done.stderr

    @pytest.mark.parametrize(
        ("words", "said"),
        [
            (("--levels", "1", "--interval", "2"), "give one of --levels, --interval"),
            (("--levels", "1", "--level", "2"), "--levels goes with one surface"),
            (("--above",), "--above goes with --levels"),
            (("--interval", "0"), "is 0: give a positive"),
        ],
    )
    def test_bad_input_is_one_line(self, pit, words, said: str) -> None:
        failed(run("volume", pit, *words), 2, said)

    def test_a_negative_volume_is_one_line(self, pit) -> None:
        failed(run("volume", pit, "--volumes", "-4"), 3, "--volumes are [-4.0]: give volumes of")
