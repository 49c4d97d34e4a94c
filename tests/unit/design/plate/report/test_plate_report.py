"""The figures and the page of a solved plate: messages, marks, and nothing that is not there."""

import dataclasses
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm import subjects
from squeezefilm.core.errors import InputError
from squeezefilm.design.plate.command import PlateAnalysis, solve_plate
from squeezefilm.design.plate.report import page
from squeezefilm.design.plate.report.figures import (
    admittance,
    frequency_response,
    line_scan,
    plan_view,
)
from squeezefilm.design.plate.report.page import plate_page
from squeezefilm.physics.display import load_display


@pytest.fixture(scope="module")
def result() -> PlateAnalysis:
    solved = solve_plate(load_display("biet2008-plate"), points=60)
    assert isinstance(solved, PlateAnalysis)
    return solved


def _words(figure: object) -> str:
    return str(figure.get_suptitle()).replace("\u00a0", " ").replace("\n", " ")  # type: ignore[attr-defined]


@pytest.mark.slow
def test_the_line_scan_has_the_modes_nodes(result: PlateAnalysis) -> None:
    axes = line_scan(result).axes[0]
    nodes = axes.get_lines()[-1].get_xdata()
    # The specification's nodal lines of the beam; the solved centreline is near them.
    beam = [4.38, 13.80, 24.11, 35.50, 47.50, 58.89, 69.20, 78.62]
    assert nodes == pytest.approx(beam, abs=0.4)
    legend = axes.get_legend()
    assert legend is not None
    assert "8 nodes of the centreline" in [text.get_text() for text in legend.get_texts()]
    volts = result.display.drive.voltage
    assert axes.child_axes[0].get_ylabel() == f"w at {volts:g} V (µm)"


@pytest.mark.slow
def test_each_figure_has_its_message(result: PlateAnalysis) -> None:
    for draw, words in (
        (plan_view, "from above"),
        (frequency_response, "Hz wide at half power"),
        (admittance, "mS"),
    ):
        assert words in _words(draw(result))


@pytest.mark.slow
def test_a_name_in_the_page_is_text(result: PlateAnalysis) -> None:
    display = dataclasses.replace(result.display, title="<script>alert(1)</script>")
    figures = {"line-scan": ("Line scan", line_scan(result))}
    page = plate_page(dataclasses.replace(result, display=display), figures)
    assert "<script>" not in page
    assert 'src="line-scan.png"' in page


def test_a_volume_is_written_of_a_plate_and_under_its_own_ending(tmp_path: Path) -> None:
    unused: Any = None
    with pytest.raises(InputError, match=r"a\.txt does not end in \.vtu; ParaView tells"):
        page.write_vtu(tmp_path / "a.txt", unused, 0)
    ring: Any = SimpleNamespace(display=SimpleNamespace(name="a stator"))
    with pytest.raises(InputError, match=r"'a stator' is no rectangular plate: .* no volume"):
        subjects.write_mode(ring, tmp_path / "a.vtu")
    assert list(tmp_path.iterdir()) == []
