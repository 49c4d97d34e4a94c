"""Figures of textures that a display renders: a grating under a finger, and which survive."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.patches import Rectangle
from tests.unit.report.drawn import words

from squeezefilm.render.fidelity.survival import FidelityTable
from squeezefilm.render.fidelity.trace import FrictionTrace, friction_trace
from squeezefilm.render.motion.stroke import Stroke
from squeezefilm.render.texture.levels import Amplitude
from squeezefilm.render.texture.shapes import SquareWave
from squeezefilm.report.display.texture_figures import fidelity, texture
from squeezefilm.report.kit.style import BLUE, ORANGE

LOW, HIGH = 0.5e-6, 2e-6
GRATING = Amplitude(SquareWave(2e-3), LOW, HIGH)


def traced(grating: Any = GRATING, tau: float = 0.5e-3, swing: float = 0.2) -> FrictionTrace:
    return friction_trace(
        grating, Stroke(0.1, 0.02, start=5e-3), tau, lambda a, v: 1 - swing * np.asarray(a) / HIGH
    )


def analysis(trace: Any = None, table: Any = None) -> Any:
    return SimpleNamespace(texture=trace, fidelity=table, prediction=SimpleNamespace(model="a law"))


@pytest.fixture(scope="module")
def drawn() -> Any:
    return texture(analysis(traced()))


def test_a_grating_is_drawn_over_some_periods_and_one_rise_enlarged(drawn: Any) -> None:
    wide, close, friction, near = drawn.axes[:4]
    edge = wide.get_xlim()[0] + 0.5
    # The stroke's middle lies at 15 mm; within a period from it the grating rises.
    assert 15 <= edge < 17.01
    assert wide.get_xlim() == pytest.approx((edge - 0.5, edge + 6.5))
    # Ten lags of 50 µm, halved, are what is enlarged.
    assert close.get_xlim() == pytest.approx((edge - 0.0875, edge + 0.4125))
    trace = traced()
    for axes, scale, wanted, rendered in (
        (wide, 1e6, trace.command, trace.amplitude),
        (close, 1e6, trace.command, trace.amplitude),
        (friction, 1, trace.relative_friction_wanted, trace.relative_friction_rendered),
        (near, 1, trace.relative_friction_wanted, trace.relative_friction_rendered),
    ):
        orange, blue = axes.get_lines()
        assert to_hex(orange.get_color()) == ORANGE
        assert to_hex(blue.get_color()) == BLUE
        x = orange.get_xdata()
        assert x[[0, -1]] == pytest.approx(axes.get_xlim(), abs=0.01)
        assert blue.get_xdata() == pytest.approx(x)
        at = np.searchsorted(trace.position, 1e-3 * x - 1e-9)
        assert orange.get_ydata() == pytest.approx(scale * wanted[at])
        assert blue.get_ydata() == pytest.approx(scale * rendered[at])
    before, after = (wide.get_lines()[0].get_ydata()[np.searchsorted(
        wide.get_lines()[0].get_xdata(), edge + step)] for step in (-0.05, 0.05))  # fmt: skip
    assert (before, after) == pytest.approx((0.5, 2))
    # Of 7000 samples in the wide part every fourth is enough; the close one has all of its own.
    assert wide.get_lines()[0].get_xdata().size == pytest.approx(1750, abs=2)
    assert close.get_lines()[0].get_xdata().size == pytest.approx(500, abs=2)
    assert near.get_lines()[0].get_xdata().size == pytest.approx(500, abs=2)


def test_a_grating_s_lag_is_shaded_and_its_labels_say_what_is_shown(drawn: Any) -> None:
    wide, close, friction, near, strip = drawn.axes
    edge = wide.get_xlim()[0] + 0.5
    for axes in (close, near):
        (span,) = axes.patches
        box = span.get_extents().transformed(axes.transData.inverted())
        assert (box.x0, box.x1) == pytest.approx((edge, edge + 0.05))
    assert not wide.patches
    assert [one.get_text() for one in strip.get_legend().get_texts()] == [
        "wanted", "rendered", "lag τ·v = 50 µm",
    ]  # fmt: skip
    assert (wide.get_ylabel(), friction.get_ylabel()) == (
        "amplitude (µm)", "relative friction µ′/µ",
    )  # fmt: skip
    assert friction.get_xlabel() == near.get_xlabel() == "finger position (mm)"
    assert wide.get_ylim()[0] == 0
    assert friction.get_ylim()[0] > 0.5
    titles = [one.get_title(loc="left") for one in (wide, close)]
    assert titles == ["3.5 periods from the middle of the stroke", "one edge, enlarged"]
    assert words(drawn.get_suptitle()) == (
        "A grating of 2 mm at 100 mm/s comes 50 µm late: the resonator needs 0.5 ms to follow"
    )
    assert words(drawn.get_supxlabel()) == (
        "Model: first-order envelope at resonance, open loop; friction by a law, following the "
        "amplitude at once"
    )


@pytest.mark.parametrize(("tau", "shown"), [(0.1e-3, 0.4), (5e-3, 2.0)])
def test_what_is_enlarged_is_between_a_fifth_of_a_period_and_a_whole_one(
    tau: float, shown: float
) -> None:
    close = texture(analysis(traced(tau=tau))).axes[1]
    low, high = close.get_xlim()
    assert high - low == pytest.approx(shown)


def test_a_swing_that_nobody_feels_is_not_stretched() -> None:
    assert texture(analysis(traced(swing=0.01))).axes[2].get_ylim() == (0, 1.05)
    assert texture(analysis(traced(swing=0.02))).axes[2].get_ylim()[0] > 0.9


def test_a_texture_that_never_rises_is_drawn_from_the_middle_of_the_stroke() -> None:
    flat = traced(lambda x, y, v, t: np.full(np.shape(x), HIGH))
    figure = texture(analysis(flat))
    # Without a period of its own, a twentieth of the stroke takes its place.
    assert figure.axes[0].get_xlim() == pytest.approx((14.75, 18.25), abs=0.01)
    assert words(figure.get_suptitle()).startswith("A grating of 1 mm at 100 mm/s")


def test_without_friction_to_change_there_is_a_reason() -> None:
    for draw, title in (
        (texture, "No texture can be rendered here"), (fidelity, "No texture survives here"),
    ):  # fmt: skip
        figure = draw(analysis())
        assert figure.get_suptitle() == title
        (said,) = figure.axes[0].texts
        assert "raise the voltage" in words(said.get_text())


def survival(amplitude: np.ndarray, friction: np.ndarray) -> FidelityTable:
    rows, columns = amplitude.shape
    return FidelityTable(
        shape="square", low=0.0, high=HIGH, time_constant=0.5e-3, kept=0.9,
        spatial_periods=np.array([0.4e-3, 2e-3])[:rows], speeds=0.01 * np.arange(1, columns + 1),
        amplitude_kept=amplitude, friction_kept=friction,
        amplitude_fundamental=0.5 * amplitude, friction_fundamental=0.25 * friction,
        finest_period=1e-3 * np.arange(1, columns + 1), fastest_speed=np.full(rows, 0.1),
        lag=5e-6 * np.arange(1, columns + 1),
    )  # fmt: skip


def test_every_cell_says_what_is_kept_and_whether_it_survives() -> None:
    kept = np.array([[0.0, 0.5, 0.8996], [0.9, 0.904, 1.0]])
    felt = np.array([[0.1, 0.8951, 0.9], [0.894, 0.95, 0.999]])
    figure = fidelity(analysis(table=survival(kept, felt)))
    axes, strip = figure.axes
    # Just below what has to be kept is not rounded up to it.
    expected = [
        ("0 %  ✗", "0 %", "10 %, 2 %"), ("50 %  ✗", "25 %", "89 %, 22 %"),
        ("89 %  ✗", "45 %", "90 %, 22 %"), ("90 %  ✓", "45 %", "89 %, 22 %"),
        ("90 %  ✓", "45 %", "95 %, 24 %"), ("100 %  ✓", "50 %", "100 %, 25 %"),
    ]  # fmt: skip
    said = [(one.get_text(), one.get_position()) for one in axes.texts]
    for number, (above, wave, felt) in enumerate(expected):
        row, column = divmod(number, 3)
        assert said[3 * number : 3 * number + 3] == [
            (above, (column, row - 0.15)),
            (f"fundamental {wave}", (column, row + 0.14)),
            (f"friction {felt}", (column, row + 0.33)),
        ]
    cells = [one for one in axes.patches if isinstance(one, Rectangle)]
    for number, cell in enumerate(cells):
        row, column = divmod(number, 3)
        box = cell.get_bbox()
        assert (box.x0, box.x1) == pytest.approx((column - 0.48, column + 0.48))
        assert (box.y0, box.y1) == pytest.approx((row - 0.46, row + 0.46))
        survives = kept[row, column] >= 0.9
        assert (cell.get_linestyle() == "-") == survives
        assert cell.get_linewidth() == (1.2 if survives else 0.8)
    assert to_hex(cells[0].get_facecolor()) == "#f6efe2"
    assert to_hex(cells[5].get_facecolor()) == "#0d4f6b"
    # Fine gratings stand above, and every cell is in sight.
    assert axes.get_ylim() == (1.5, -0.5)
    assert axes.get_xlim() == pytest.approx((-0.52, 2.52))
    assert [one.get_text() for one in axes.get_yticklabels()] == ["0.4", "2"]
    assert [one.get_text() for one in axes.get_xticklabels()] == [
        "10\nfinest 1 mm\nlag 5 µm", "20\nfinest 2 mm\nlag 10 µm", "30\nfinest 3 mm\nlag 15 µm",
    ]  # fmt: skip
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("finger speed (mm/s)", "spatial period (mm)")
    assert [one.get_text() for one in strip.get_legend().get_texts()] == [
        "✓ keeps 90 % of the amplitude's swing, peak to peak", "✗ loses more",
    ]  # fmt: skip
    assert words(figure.get_suptitle()) == (
        "At 30 mm/s the finest square grating that keeps 90 % of its swing, 68 % of its "
        "fundamental, has a period of 3 mm"
    )
    assert figure.get_supxlabel() == (
        "Model: first-order envelope at resonance, open loop; friction by a law"
    )
    assert figure.get_figheight() == pytest.approx(2.5 + 2 * 0.78)


def test_every_cell_s_text_can_be_read_on_its_colour() -> None:
    shares = np.linspace(0, 1, 26)[None, :]
    axes = fidelity(analysis(table=survival(shares, shares))).axes[0]
    inks = [to_hex(one.get_color()) for one in axes.texts[::3]]
    fills = [to_hex(one.get_facecolor()) for one in axes.patches]
    assert {*inks} == {"#ffffff", "#101820"}
    assert min(map(contrast, inks, fills)) > 4.2


def contrast(one: str, other: str) -> float:
    """The contrast ratio of two colours by WCAG."""
    parts = np.array(
        [[int(color[i : i + 2], 16) / 255 for i in (1, 3, 5)] for color in (one, other)]
    )
    linear = np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)
    low, high = sorted(linear @ [0.2126, 0.7152, 0.0722])
    return (high + 0.05) / (low + 0.05)
