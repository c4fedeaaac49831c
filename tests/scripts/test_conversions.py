"""Every pair of formats and objects: what comes back is the same bit for bit, or its loss named."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from conversions import campaign, given as given_files
from conversions.campaign import BY_NAME, IN_CHUNKS, WAYS
from conversions.checking import check_chunks, check_pairs, went_through
from conversions.comparing import ChangedError, losses, same, unnamed, untrue
from conversions.drawn import clouds
from conversions.objects import MAKERS, REFUSING
from conversions.passages import Arrival, Passage
from conversions.table import PAGE, page
from conversions.tetrahedra import TRIPS
from file_samples import full_mesh
from hypothesis import HealthCheck, given, settings, strategies as st

from liftmesh import Cloud
from liftmesh.io.registry import ADAPTERS, FALLBACKS, known_formats

QUICK = [way for way in WAYS if way.place != "e57"]  # which starts a process for each file
SLOW = settings(max_examples=25, suppress_health_check=[HealthCheck.too_slow])


def test_every_adapter_and_every_format_has_a_way() -> None:
    elsewhere = {"pyvista"}  # which scripts/check_hosts.sh sends clouds through
    assert {each.name for each in (*ADAPTERS, *FALLBACKS)} == {*MAKERS, *REFUSING, *elsewhere}
    ways = {way.place for way in WAYS}
    written = {name for name, each in known_formats().items() if each.write is not None}
    assert written - ways == {"su2"}  # which holds all of the boundary, whatever the edges
    readable = {name: each for name, each in known_formats().items() if each.read is not None}
    own = {name for name, each in readable.items() if each.read.__module__.startswith("liftmesh.")}
    assert own <= ways
    assert {f"{name}.gz" for name in own if readable[name].gzip} <= ways


@pytest.mark.slow
@SLOW
@given(clouds())
def test_every_way_keeps_every_value_or_names_the_loss(cloud: Cloud) -> None:
    for way in WAYS:
        went_through(way, cloud)


@pytest.mark.slow
@SLOW
@given(clouds(), st.lists(st.sampled_from([*BY_NAME]), min_size=2, max_size=2, unique=True))
def test_every_pair_keeps_every_value_or_names_the_loss(cloud: Cloud, first: list[str]) -> None:
    check_pairs(cloud, [BY_NAME[name] for name in first], QUICK)


@pytest.mark.slow
@SLOW
@given(clouds())
def test_files_of_tetrahedra_keep_every_row(cloud: Cloud) -> None:
    for trip in TRIPS:
        trip(cloud)


def test_files_of_tetrahedra_that_are_wrong_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    cloud, (trip, *_) = Cloud(np.eye(4, 3)), TRIPS
    for wrong in ((-cloud.points, np.zeros((10, 4))), (cloud.points, np.zeros((10, 4)))):
        monkeypatch.setattr("conversions.tetrahedra.read_tetrahedra", lambda _, got=wrong: got)
        with pytest.raises(ChangedError, match="vtu changes"):
            trip(cloud)


@pytest.mark.slow
@SLOW
@given(clouds())
def test_files_in_pieces_have_the_rows_of_the_whole(cloud: Cloud) -> None:
    for way in IN_CHUNKS:
        if way in QUICK:
            check_chunks(way, cloud)


@pytest.mark.campaign
def test_a_plain_mesh_goes_through_every_pair() -> None:
    mesh = Cloud(
        np.array([[0, 0, 1], [4, 0, 2.5], [0, 3, 0.25], [4, 3, 8]]),
        colors=np.array([[0, 128, 255], [1, 2, 3], [254, 127, 64], [9, 9, 9]], dtype=np.uint8),
        normals=np.eye(3)[[0, 1, 2, 2]],
        attributes={"intensity": np.arange(4, dtype=np.uint8)},
        faces=np.array([[0, 1, 2], [1, 3, 2]], dtype=np.int32),
    )
    with_intensity = [way.place for way in WAYS if went_through(way, mesh) is None]
    assert with_intensity == ["laspy.LasData"]  # has one of its own
    renamed = replace(mesh, attributes={"age": np.arange(4, dtype=np.uint8)})
    refused = {way.place for way in WAYS if went_through(way, renamed) is None}
    assert refused == set()


def test_the_table_of_formats_is_up_to_date() -> None:
    text = PAGE.read_text("utf-8")
    assert page(text) == text, "run python scripts/conversions"


def test_a_page_without_markers_is_refused() -> None:
    with pytest.raises(SystemExit, match="files: begin"):
        page("# Formats")


def test_the_campaign_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[Cloud] = []

    @settings(max_examples=20)
    @given(clouds())
    def remember(cloud: Cloud) -> None:
        drawn.append(cloud)

    monkeypatch.setattr(campaign, "_property", remember)
    assert campaign.hunt(0.01, 1) == len(drawn) == 20


# --- the comparison itself ----------------------------------------------------------------------

FULL = replace(
    full_mesh(), points=np.array([[0.1, -0.0, 1], [2, 0, 3], [4, 5, 6], [7, 8, 9], [1, 1, 1]])
)
OTHERS = {  # of the mesh
    "another row": replace(FULL, points=FULL.points[::-1]),
    "other faces": replace(FULL, faces=FULL.faces[:, ::-1]),
    "a face less": replace(FULL, faces=FULL.faces[:1]),
    "other colours": replace(FULL, colors=FULL.colors[::-1]),
    "an invented alpha": replace(
        FULL, colors=np.column_stack([FULL.colors, np.zeros(5)]).astype("u1")
    ),
    "another value": replace(FULL, attributes={**FULL.attributes, "class": np.arange(5)}),
    "a new value": replace(FULL, attributes={**FULL.attributes, "new": np.arange(5)}),
    "a new crs": replace(FULL, crs="EPSG:25832"),
    "a new entry": replace(FULL, metadata={"survey": 1}),
}


@pytest.mark.parametrize("change", OTHERS)
def test_a_changed_value_has_no_name(change: str) -> None:
    with pytest.raises(ChangedError):
        losses(FULL, OTHERS[change])


CLASS = FULL.attributes["class"]
LESS = {
    "double precision": replace(FULL, points=np.abs(FULL.points)),  # the sign of a zero
    "faces": replace(FULL, faces=None),
    "colors": replace(FULL, colors=None),
    "normals": replace(FULL, normals=None),
    "rounded normals": replace(FULL, normals=FULL.normals.astype(np.float32)),
    "type of class": replace(FULL, attributes={**FULL.attributes, "class": CLASS.astype(float)}),
    "attribute class": replace(
        FULL, attributes={k: v for k, v in FULL.attributes.items() if k != "class"}
    ),
}


@pytest.mark.parametrize("loss", LESS)
def test_a_loss_has_a_name(loss: str) -> None:
    assert losses(FULL, LESS[loss]) == {loss}
    assert losses(FULL, FULL) == set()


def test_complex_numbers_are_the_same_part_by_part() -> None:
    values = np.array([complex(0.0, np.nan), 1j])
    assert same(values, values.copy())
    assert not same(values, values.conj())


def test_names_of_losses() -> None:
    lost = {"attribute a", "rounded b", "alpha beyond 8 bits", "crs"}
    assert unnamed(lost, ("a (not numbers)", "double precision of b", "alpha")) == {"crs"}
    assert untrue(lost, ("a", "whole numbers of b beyond 2**53", "faces", "normals")) == {
        "faces",
        "normals",
    }


@pytest.mark.parametrize("named", [(), ("colors", "crs")])
def test_a_way_that_names_too_little_or_too_much_is_found(named: tuple[str, ...]) -> None:
    def send(cloud: Cloud) -> Arrival:
        return Arrival(replace(cloud, colors=None), cloud, named)

    with pytest.raises(ChangedError, match="colors"):
        went_through(Passage(f"careless {named}", send), FULL)


def test_files_as_they_are_found(tmp_path: Path) -> None:
    (tmp_path / "below").mkdir()
    (tmp_path / "below" / "a.csv").write_text("x,y,z,class\n0.1,0,1,2\n1,0,2,2\n0,1,3,5\n")
    (tmp_path / "b.las").write_bytes(b"LASF")
    (tmp_path / "c.md").write_text("no cloud")
    found = [*given_files.files_in([tmp_path])]
    assert [each.name for each in found] == ["b.las", "a.csv"]
    assert given_files.there_and_back(found[0]).startswith("refused: ")
    told = given_files.there_and_back(found[1])
    assert told.startswith("3 rows, 1 faces: ")
    assert told.endswith(" ways, no change unsaid")
