"""The figures and the page of a solved plate: messages, marks, and nothing that is not there."""

import dataclasses
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import RectBivariateSpline

from squeezefilm import subjects
from squeezefilm.core.errors import InputError
from squeezefilm.design.plate.command import PlateAnalysis, analyze_plate
from squeezefilm.design.plate.report import page
from squeezefilm.design.plate.report.page import plate_page
from squeezefilm.design.plate.report.plate import (
    admittance,
    driven_shape,
    frequency_response,
    line_scan,
    mode_surface,
    plan_view,
)
from squeezefilm.physics.display import load_display


@pytest.fixture(scope="module")
def result() -> PlateAnalysis:
    return analyze_plate(load_display("biet2008-plate"), points=60)


def _words(figure: object) -> str:
    return str(figure.get_suptitle()).replace("\u00a0", " ").replace("\n", " ")  # type: ignore[attr-defined]


@pytest.mark.slow
def test_the_surface_says_its_exaggeration_and_draws_the_nodal_lines(
    result: PlateAnalysis,
) -> None:
    figure = mode_surface(result)
    assert "(8,0)" in _words(figure)
    assert "163 nm" in _words(figure)
    assert "2 700 times those at 15 V" in figure.get_supxlabel().replace("\n", " ")
    axes = figure.axes[0]
    lines = [line for line in axes.get_lines() if np.size(line.get_data_3d()[0]) > 10]
    # Eight lines across the length, on the surface's zero.
    assert len(lines) == 8
    # On another grid than the figure's own: one phase for all of the face.
    along, across = np.linspace(0, 83e-3, 150), np.linspace(0, 49e-3, 70)
    shape = RectBivariateSpline(along, across, driven_shape(result, along, across))
    for line in lines:
        x, y, z = (np.asarray(part, dtype=float) for part in line.get_data_3d())
        assert np.all(z == 0)
        seen = np.flatnonzero(np.isfinite(x))[::7]
        at = shape(x[seen] / 1e3, y[seen] / 1e3, grid=False)
        assert np.max(np.abs(at)) < 2e-3 * result.amplitude_per_volt
    assert (axes.get_xlabel(), axes.get_ylabel(), axes.get_zlabel()) == (
        "x (mm)", "y (mm)", "w (nm/V)",
    )  # fmt: skip


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
