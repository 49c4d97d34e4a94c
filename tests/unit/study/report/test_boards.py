"""Boards of real gratings: what a workshop is given is what the design says."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from ezdxf.filemanagement import readfile

from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.drawing import MILLIMETRES
from squeezefilm.physics.perception.stimuli import Grating
from squeezefilm.study.design.study_design import load_design
from squeezefilm.study.report.boards import board_of, boards, drawing_of, write_boards

DESIGN = load_design("biet2008-gratings-as-widths")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_boards(DESIGN, tmp_path_factory.mktemp("boards")).parent


def test_the_drawing_is_sound_and_its_outlines_are_the_designs(folder: Path) -> None:
    found = readfile(folder / "boards.dxf")
    assert not found.audit().has_errors
    assert found.header["$INSUNITS"] == MILLIMETRES
    space = found.modelspace()
    outlines = [list(one.get_points("xy")) for one in space.query('LWPOLYLINE[layer=="BOARD"]')]
    sizes = [(c[2][0] - c[0][0], c[2][1] - c[0][1]) for c in outlines]
    wanted = [(1e3 * one.length, 1e3 * one.width) for one in DESIGN.alternatives]
    assert np.array(sizes) == pytest.approx(np.array(wanted))
    ridges = [list(one.get_points("xy")) for one in space.query('LWPOLYLINE[layer=="RIDGES"]')]
    assert len(ridges) == sum(one.ridges for one in boards(DESIGN))
    for number, grating in enumerate(DESIGN.alternatives):
        alone = readfile(folder / f"board-{number + 1}.dxf").modelspace()
        left = sorted(
            one.get_points("xy")[0][0] for one in alone.query('LWPOLYLINE[layer=="RIDGES"]')
        )
        assert np.diff(left) == pytest.approx(1e3 * grating.period)


def test_dimensions_measure_ridge_groove_and_length(folder: Path) -> None:
    alone = readfile(folder / "board-2.dxf").modelspace()
    measured = sorted(one.get_measurement() for one in alone.query("DIMENSION"))
    one = DESIGN.alternatives[1]
    assert measured == pytest.approx(
        sorted([1e3 * one.period / 2, 1e3 * one.groove_width, 1e3 * one.length])
    )


def test_numbers_and_page_say_what_the_study_calls_period(folder: Path) -> None:
    data = json.loads((folder / "boards.json").read_text(encoding="utf-8"))
    first = data["boards"][0]
    assert first["length_means"] == "groove width"
    assert first["spatial_period_m"] == pytest.approx(0.8e-3)
    assert data["tolerance_m"] == pytest.approx(20e-6)
    page = (folder / "index.html").read_text(encoding="utf-8")
    assert "is the groove width; the period is" in page
    assert (folder / "boards.png").stat().st_size > 5000


@pytest.mark.slow
def test_the_same_boards_are_the_same_file(folder: Path, tmp_path: Path) -> None:
    again = write_boards(DESIGN, tmp_path / "again").parent
    assert (again / "boards.dxf").read_bytes() == (folder / "boards.dxf").read_bytes()


def test_all_boards_lie_on_the_paper() -> None:
    drawing = drawing_of(boards(DESIGN))
    outlines = drawing.document.modelspace().query("LWPOLYLINE")
    points = 1e-3 * np.array([point for one in outlines for point in one.get_points("xy")])
    assert np.all(points >= drawing.corner)
    assert np.all(points <= np.add(drawing.corner, drawing.paper))


def test_the_last_ridge_ends_with_the_board() -> None:
    board = board_of(Grating("a", 4e-3, "period", length=0.013))
    assert board.ridges == 4
    assert board.end[-1] == pytest.approx(0.013)
    with pytest.raises(InputError, match="holds no whole period"):
        board_of(Grating("a", 4e-3, "period", length=0.003))
    with pytest.raises(InputError, match="opens nowhere"):
        board_of(Grating("a", 1e-6, "period"))


def test_what_cannot_be_made_is_refused_before_anything_is_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no boards to make"):
        write_boards(load_design("friction-jnd"), tmp_path / "a")
    with pytest.raises(InputError, match="tolerance"):
        write_boards(DESIGN, tmp_path / "a", 0.3e-3)
    assert not (tmp_path / "a").exists()


def test_each_board_is_drawn_above_the_one_before_with_three_dimensions() -> None:
    made = board_of(Grating("a", 4e-3, "period", length=0.02, width=0.03, ridge_height=50e-6))
    other = board_of(Grating("b", 8e-3, "groove width", length=0.05, width=0.01))
    drawing = drawing_of((made, other))
    assert drawing.layers.keys() == {"BOARD", "RIDGES"}
    space = drawing.document.modelspace()
    lower = [board.get_points("xy")[0] for board in space.query('LWPOLYLINE[layer=="BOARD"]')]
    # Three dimensions of 3 mm each, one's own 4 mm, a text below: they have room between boards.
    (_, first), (_, second) = lower
    assert first == 0.0
    dimensions = space.query("DIMENSION")
    assert [one.get_measurement() for one in dimensions] == pytest.approx([2, 2, 20, 8, 8, 50])
    starts = [one.dxf.defpoint2 for one in dimensions]
    assert [start.x for start in starts] == pytest.approx([0, 2, 0, 0, 8, 0], abs=1e-9)
    highest = max(one.dxf.defpoint.y for one in dimensions[:3])
    texts = space.query("TEXT")
    assert [one.dxf.text for one in texts] == ["a: ridges 50 um high", "b: ridges 70 um high"]
    lower_text, upper_text = (one.get_placement()[1].y for one in texts)
    assert 30 < highest < upper_text < second
    assert lower_text < first
    above = [one.dxf.defpoint.y - one.dxf.defpoint2.y for one in dimensions[:3]]
    assert above == pytest.approx([4] * 3)
    middles = [(one.dxf.defpoint2.x + one.dxf.defpoint3.x) / 2 for one in dimensions]
    assert [one.dxf.text_midpoint.x for one in dimensions] == pytest.approx(middles)
