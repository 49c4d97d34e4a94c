"""The paper's figures of an analysis: curves, marks and words against numbers written by hand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex
from tests.unit.drawn import labelled, words
from tests.unit.made_curves import AMPLITUDE, CURVES, GRID, made, point

from squeezefilm.core.kit import style
from squeezefilm.core.kit.model_looks import look_of
from squeezefilm.core.kit.style import INK, MUTED
from squeezefilm.design.analysis.curves import PressureProfile, WavelengthCurve
from squeezefilm.validation.report import figures
from squeezefilm.validation.report.figures import friction, pressure, wavelength

pytestmark = pytest.mark.usefixtures("figures_as_described")

# 0.5 N on 1 cm² of contact is a twentieth of an atmosphere of 1 bar.
DISPLAY = SimpleNamespace(
    finger=SimpleNamespace(contact_length=10e-3, ridge_amplitude=50e-6, ridge_period=0.5e-3),
    gas=SimpleNamespace(ambient_pressure=1e5),
    surfaces=("polished", "rough"),
)
PLACE = np.linspace(-5e-3, 5e-3, 101)
GAP = 50e-6 + 50e-6 * np.abs(np.cos(PLACE / 5e-3))
ASYMPTOTE = PressureProfile(PLACE, GAP, 1 + 0.2 * (PLACE / 5e-3) ** 2, "paper2008")
SOLVED = PressureProfile(PLACE, GAP, 1 + 0.1 * (PLACE / 5e-3) ** 2, "solved film")


WAVES = (
    WavelengthCurve(15e-3, 0.4 * GRID, 1 - 0.8 * GRID / 10e-6, 1.5e-6, "paper2008"),
    WavelengthCurve(7.5e-3, 0.4 * GRID, 1 - 0.5 * GRID / 10e-6, 2.4e-6, "paper2008"),
    WavelengthCurve(5e-3, 0.4 * GRID, 1 - 0.1 * GRID / 10e-6, 12e-6, "paper2008"),
)


@pytest.fixture(autouse=True)
def curves_by_hand(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(figures, "pressure_profiles", lambda p: p.profiles)
    monkeypatch.setattr(figures, "wavelength_curves", lambda _: WAVES)


def of_display(**changes: Any) -> Any:
    return made(**{"display": DISPLAY, **changes})


def shown_with(profiles: tuple[PressureProfile, ...] = (ASYMPTOTE, SOLVED), **changes: Any) -> Any:
    return of_display(prediction=point(profiles=profiles), **changes)


def test_gap_and_pressure_are_drawn_whole_and_enlarged() -> None:
    figure = pressure(shown_with())
    gap, near_gap, whole, near, strip = figure.axes
    for axes in (gap, near_gap):
        (line,) = axes.get_lines()
        assert line.get_xdata() == pytest.approx(1e3 * PLACE)
        assert line.get_ydata() == pytest.approx(1e6 * GAP)
        assert axes.get_ylim() == pytest.approx((0, 112))
        skin = axes.collections[0].get_paths()[0].vertices[:, 1]
        assert (skin.min(), skin.max()) == pytest.approx((1e6 * GAP.min(), 112))
    for axes, reach in ((whole, 5.0), (near, 0.65)):
        paper, solved, carries = axes.get_lines()
        assert paper.get_xdata() == pytest.approx(1e3 * PLACE)
        assert paper.get_ydata() == pytest.approx(ASYMPTOTE.mean_pressure)
        assert solved.get_ydata() == pytest.approx(SOLVED.mean_pressure)
        assert [to_hex(one.get_color()) for one in (paper, solved)] == [
            look_of(one.model).color for one in (ASYMPTOTE, SOLVED)
        ]
        assert carries.get_ydata() == pytest.approx([1.05, 1.05])
        assert axes.get_xlim() == pytest.approx((-reach, reach))
        assert axes.get_xlabel() == "position under the finger (mm)"
    assert (gap.get_ylabel(), whole.get_ylabel()) == ("mean gap (µm)", "pressure over ambient")
    titles = [one.get_title(loc="left") for one in (gap, near_gap)]
    assert titles == ["the whole contact: the finger's ridges, and the plate at 0", "enlarged"]
    # The mean of a parabola is a third of its height above the least.
    assert [one.get_text() for one in strip.get_legend().get_texts()] == [
        "paper's asymptote, mean 1.0667",
        "the same film, solved, mean 1.0333",
        "would carry the finger: 1.0500",
    ]
    assert words(figure.get_suptitle()) == (
        "The film's pressure rises over the ridge crests only: to 1.2 times ambient by the paper, "
        "to 1.1 in the solved film"
    )
    assert words(figure.get_supxlabel()) == (
        "Model: paper2008, solved film (grooves sealed at their ends)"
    )


def test_gap_and_pressure_share_what_stands_beside_them() -> None:
    with style.rc():
        figure = pressure(shown_with())
        figure.draw_without_rendering()
    left, right, below, last, strip = figure.axes
    drawn = {"left": left, "right": right, "below": below, "last": last}
    places = {name: axes.get_position() for name, axes in drawn.items()}
    assert places["left"].width == pytest.approx(2.2 * places["right"].width, rel=0.02)
    assert places["left"].height == pytest.approx(places["below"].height, rel=0.02)
    assert places["left"].x0 == pytest.approx(places["below"].x0)
    assert places["right"].x0 == pytest.approx(places["last"].x0)
    assert places["left"].x1 < places["right"].x0
    assert places["below"].y1 < places["left"].y0
    assert places["right"].y0 == pytest.approx(places["left"].y0)
    assert places["last"].y0 == pytest.approx(places["below"].y0)
    assert strip.get_position().y1 < places["below"].y0
    along, up = left.get_shared_x_axes(), left.get_shared_y_axes()
    assert along.joined(left, below)
    assert along.joined(right, last)
    assert not along.joined(left, right)
    assert up.joined(left, right)
    assert up.joined(below, last)
    assert not up.joined(left, below)
    sides = [
        (axes.xaxis.get_tick_params()["labelbottom"], axes.yaxis.get_tick_params()["labelleft"])
        for axes in (left, right, below, last)
    ]
    assert sides == [(False, True), (False, False), (True, True), (True, False)]


def test_a_smooth_finger_with_wide_ridges_and_one_film() -> None:
    finger = SimpleNamespace(contact_length=10e-3, ridge_amplitude=0.0, ridge_period=20e-3)
    display = SimpleNamespace(finger=finger, gas=DISPLAY.gas)
    figure = pressure(shown_with(display=display, profiles=(ASYMPTOTE,)))
    assert words(figure.get_suptitle()) == (
        "The film's pressure rises at the antinode: to 1.2 times ambient by the paper"
    )
    # No part of the contact is wider than the whole.
    assert figure.axes[3].get_xlim() == pytest.approx((-5, 5))


@pytest.mark.parametrize(("most", "adds"), [(1.0004, False), (1.0006, True)])
def test_a_film_that_adds_no_pressure_is_said(most: float, adds: bool) -> None:
    still = PressureProfile(PLACE, GAP, np.full(101, most), "paper2008")
    title = words(pressure(shown_with(profiles=(still,))).get_suptitle())
    said = "The film adds no pressure here; 1.050 times ambient would carry the finger"
    assert (title != said) == adds


def test_friction_is_drawn_for_every_surface_with_what_it_needs() -> None:
    figure = friction(of_display())
    axes = figure.axes[0]
    lines = labelled(axes)
    assert list(lines) == [
        "paper's asymptote, polished (1.5 µm): 0.7 at 2.4 µm, zero at 8 µm",
        "paper's asymptote, rough (1.5 µm): 0.7 at 6 µm, zero at 20 µm",
        "partial levitation, polished (1.5 µm): 0.7 out of reach",
        "0.7: what the paper asks for",
        "this display: 0.81 at 2 µm",
    ]
    *drawn, asked, here = lines.values()
    for line, one in zip(drawn, CURVES, strict=True):
        assert line.get_xdata() == pytest.approx(np.arange(11))
        assert line.get_ydata() == pytest.approx(one.relative_friction)
        assert to_hex(line.get_color()) == look_of(one.model).color
    # Dashes tell the surfaces of one model.
    assert len({str(one._dash_pattern) for one in drawn[:2]}) == 2
    assert asked.get_ydata() == [0.7, 0.7]
    assert to_hex(asked.get_color()) == MUTED
    assert here.get_xydata().tolist() == [[pytest.approx(2), 0.8125]]
    assert to_hex(here.get_color()) == INK
    assert axes.get_xlim() == pytest.approx((0, 10))
    assert axes.get_ylim() == pytest.approx((0, 1.06))
    assert (axes.get_xlabel(), axes.get_ylabel()) == (AMPLITUDE, "relative friction µ′/µ")
    assert words(figure.get_suptitle()) == (
        "At 2 µm the friction on polished is 0.812 of what it is without vibration; 0.7 takes "
        "2.4 µm"
    )
    assert words(figure.get_supxlabel()) == "Model: paper2008, partial-levitation; 0.5 N"
    assert figure.get_figheight() == pytest.approx(4.4 + 5 * 0.24)


def test_what_is_reached_is_marked_and_what_lies_beyond_is_not() -> None:
    axes = friction(of_display()).axes[0]
    marks = [one for one in axes.get_lines() if one.get_label().startswith("_")]
    found = [(one.get_xdata(), one.get_ydata()) for one in marks]
    expected = [
        ([2.4, 2.4], [0, 0.7]), ([2.4], [0.7]), ([8.0], [0]),
        ([6.0, 6.0], [0, 0.7]), ([6.0], [0.7]),
    ]  # fmt: skip
    assert len(found) == len(expected)
    for (x, y), (at, high) in zip(found, expected, strict=True):
        assert x == pytest.approx(at)
        assert list(y) == high


def test_the_title_is_of_the_prediction_s_own_curve() -> None:
    model = "partial-levitation"
    own = of_display(prediction=point(model=model, relative_friction=0.98), own_curve=CURVES[2])
    assert words(friction(own).get_suptitle()) == (
        "At 2 µm the friction on polished is 0.98 of what it is without vibration; 0.7 takes more "
        "than 50 µm"
    )
    rough = of_display(own_curve=CURVES[1])
    assert words(friction(rough).get_suptitle()).endswith("0.7 takes 6 µm")


def test_waves_are_drawn_with_the_amplitude_each_needs() -> None:
    figure = wavelength(of_display())
    axes = figure.axes[0]
    lines = labelled(axes)
    assert list(lines) == [
        "λ/2 = 15 mm: 0.7 at 1.5 µm", "λ/2 = 7.5 mm: 0.7 at 2.4 µm", "λ/2 = 5 mm: 0.7 at 12 µm",
        "0.7: what the paper asks for", "this display by paper2008: 0.25 at 2 µm and λ/2 = 10 mm",
    ]  # fmt: skip
    for line, one in zip(lines.values(), WAVES, strict=False):
        assert line.get_xdata() == pytest.approx(0.4 * np.arange(11))
        assert line.get_ydata() == pytest.approx(one.relative_friction)
    marks = [one for one in axes.get_lines() if one.get_label().startswith("_")]
    assert [one.get_xdata()[0] for one in marks] == pytest.approx([1.5, 1.5, 2.4, 2.4])
    # On curves of the paper's model the display stands at what that model says of it.
    assert [*lines.values()][-1].get_ydata() == [0.25]
    assert axes.get_xlim() == pytest.approx((0, 4))
    assert axes.get_ylim() == pytest.approx((0, 1.06))
    assert (axes.get_xlabel(), axes.get_ylabel()) == (AMPLITUDE, "relative friction µ′/µ")
    assert words(figure.get_suptitle()) == (
        "A shorter wave needs more amplitude for µ′/µ = 0.7: 12 µm at λ/2 = 5 mm, 1.5 µm at 15 mm"
    )
    assert words(figure.get_supxlabel()) == "Model: paper2008, polished, 0.5 N"


def test_a_display_beyond_the_curves_is_left_out() -> None:
    beyond = wavelength(of_display(prediction=point(vibration_amplitude=4.1e-6))).axes[0]
    assert not any(name.startswith("this display") for name in labelled(beyond))
