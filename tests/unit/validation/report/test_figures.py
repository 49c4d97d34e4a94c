"""The paper's figures redrawn: frequency against half wavelength, and which display each is of."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from tests.unit.drawn import words

from squeezefilm.core.kit.style import BLUE, ORANGE, message_figure
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.beam_modes import timoshenko_frequency
from squeezefilm.physics.plate.laminate import Laminate, plate_laminate
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.validation.report import figures
from squeezefilm.validation.report.figures import (
    frequency_against_half_wavelength,
    reproduction_figures,
)

pytestmark = pytest.mark.usefixtures("figures_as_described")


@pytest.fixture(scope="module")
def section() -> Laminate:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    return plate_laminate(plate, "paper")


def test_two_beam_theories_are_drawn_with_where_they_meet_the_criterion(section: Laminate) -> None:
    figure = frequency_against_half_wavelength(section)
    axes = figure.axes[0]
    lines = dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))
    assert list(lines) == ["Euler–Bernoulli", "Timoshenko", "20.6 kHz (σ = 10)", "printed: 16.1 mm"]
    euler, timoshenko, criterion, printed = lines.values()
    half = 1e-3 * euler.get_xdata()
    assert half[[0, -1]] == pytest.approx([5e-3, 25e-3])
    # A wave on a beam: ω = k² √(G/M), k being π over half its length.
    stiffness = section.bending_stiffness / section.mass_per_area
    assert euler.get_ydata() == pytest.approx(1e-3 * np.pi / (2 * half**2) * np.sqrt(stiffness))
    assert timoshenko.get_xdata() == pytest.approx(1e3 * half)
    assert np.all(timoshenko.get_ydata() < euler.get_ydata())
    assert timoshenko.get_ydata()[::50] == pytest.approx(
        [1e-3 * float(timoshenko_frequency(one, section)) for one in half[::50]]
    )
    assert criterion.get_ydata() == pytest.approx([20.6, 20.6])
    assert printed.get_xydata() == pytest.approx(np.array([[16.1, 20.6]]))
    low, high = (one for one in axes.get_lines() if one.get_label().startswith("_"))
    longest = np.sqrt(np.pi / (2 * 20.6e3) * np.sqrt(stiffness))
    assert low.get_xydata() == pytest.approx(np.array([[1e3 * longest, 20.6]]), rel=1e-4)
    at = 1e-3 * float(high.get_xdata()[0])
    assert float(timoshenko_frequency(at, section)) == pytest.approx(20.6e3, rel=1e-4)
    assert high.get_ydata() == pytest.approx([20.6])
    assert [to_hex(one.get_color()) for one in (euler, timoshenko, low, high)] == [
        BLUE, ORANGE, BLUE, ORANGE,
    ]  # fmt: skip
    assert axes.get_xlim() == (5, 25)
    assert axes.get_ylim() == (0, 110)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("half wavelength (mm)", "frequency (kHz)")
    assert words(figure.get_suptitle()) == (
        f"20.6 kHz needs a half wavelength below {1e3 * longest:.1f} mm (Euler–Bernoulli) or "
        f"{1e3 * at:.1f} mm (Timoshenko); the paper reads 16.1 mm"
    )


def test_each_figure_is_of_the_paper_s_own_display(monkeypatch: pytest.MonkeyPatch) -> None:
    # The analyses and their figures take a minute, and have tests of their own.
    def analyze(display: Any, **given: Any) -> tuple[str, dict[str, Any]]:
        told.append(f"analysis of {display.name}")
        return display.name, given

    told: list[str] = []
    seen: dict[str, Any] = {}
    monkeypatch.setattr(figures, "analyze", analyze)
    for name in ("pressure", "friction", "wavelength"):
        monkeypatch.setattr(
            figures,
            name,
            lambda one, name=name: seen.update({name: one}) or message_figure(name, "nothing"),
        )
    found = reproduction_figures(told.append)
    assert told == [
        "figures 4 and 5: the stator", "analysis of biet2008-stator",
        "figures 10 and 11: the plate", "analysis of biet2008-plate",
    ]  # fmt: skip
    stator = ("biet2008-stator", {"vibration_amplitude": 2e-6})
    assert seen == {"pressure": stator, "friction": stator, "wavelength": ("biet2008-plate", {})}
    titles = [
        "Figure 4: mean pressure under the finger",
        "Figure 5: relative friction against amplitude",
        "Figure 10: frequency against half wavelength",
        "Figure 11: amplitude for four half wavelengths",
    ]
    assert [title for title, _ in found] == titles
    for (title, drawing), prefix in zip(found, ("fig4", "fig5", "fig10", "fig11"), strict=True):
        assert f'aria-label="{title}"' in drawing
        # One page holds them all: the ids of each begin with its own name.
        assert {one.split("-")[0] for one in re.findall(r'\bid="([^"]*)"', drawing)} == {prefix}
