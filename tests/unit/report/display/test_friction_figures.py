"""Figures of film and friction: curves, marks and words against numbers written down by hand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from matplotlib.colors import to_hex

from squeezefilm.analysis.curves import FrictionCurve, PressureProfile, WavelengthCurve
from squeezefilm.report.display.friction_figures import (
    film_models,
    friction,
    own_friction,
    pressure,
    wavelength,
)
from squeezefilm.report.kit.model_looks import look_of
from squeezefilm.report.kit.style import BAND, INK, MUTED

AMPLITUDE = "vibration amplitude, zero-to-peak (µm)"
GRID = np.linspace(0, 10e-6, 11)
POINT = SimpleNamespace(
    normal_force=0.5, speed=0.08, vibration_amplitude=2e-6, relative_friction=0.8125,
    model="paper2008",
    surface=SimpleNamespace(name="polished"), frequency=40e3,
    mode=SimpleNamespace(half_wavelength=10e-3),
)  # fmt: skip
# 0.5 N on 1 cm² of contact is a twentieth of an atmosphere of 1 bar.
DISPLAY = SimpleNamespace(
    finger=SimpleNamespace(contact_length=10e-3, ridge_amplitude=50e-6, ridge_period=0.5e-3),
    gas=SimpleNamespace(ambient_pressure=1e5),
    surfaces=("polished", "rough"),
)
PLACE = np.linspace(-5e-3, 5e-3, 101)
GAP = 50e-6 + 50e-6 * np.abs(np.cos(PLACE / 5e-3))
ASYMPTOTE = PressureProfile(PLACE, GAP, 1 + 0.2 * (PLACE / 5e-3) ** 2, "paper2008")
SOLVED = PressureProfile(PLACE, GAP, 1 + 0.1 * (PLACE / 5e-3) ** 2, "film-sealed")


def curve(surface: str, model: str, slope: float, **reached: float | None) -> FrictionCurve:
    return FrictionCurve(
        surface=surface, roughness=1.5e-6, amplitude=GRID,
        relative_friction=np.clip(1 - slope * GRID / 10e-6, 0, 1), model=model,
        amplitude_for_criterion=reached.get("criterion"),
        zero_friction_amplitude=reached.get("zero"),
    )  # fmt: skip


CURVES = (
    curve("polished", "paper2008", 1.25, criterion=2.4e-6, zero=8e-6),
    curve("rough", "paper2008", 0.5, criterion=6e-6, zero=20e-6),
    curve("polished", "partial-levitation", 0.1),
)
WAVES = (
    WavelengthCurve(15e-3, 0.4 * GRID, 1 - 0.8 * GRID / 10e-6, 1.5e-6, "paper2008"),
    WavelengthCurve(7.5e-3, 0.4 * GRID, 1 - 0.5 * GRID / 10e-6, 2.4e-6, "paper2008"),
    WavelengthCurve(5e-3, 0.4 * GRID, 1 - 0.1 * GRID / 10e-6, 12e-6, "paper2008"),
)
FILMS = SimpleNamespace(
    results=(
        SimpleNamespace(model="paper2008", load_share=1.9, relative_friction=0.25),
        SimpleNamespace(model="film-smooth", load_share=0.004, relative_friction=0.9),
        SimpleNamespace(model="film-plateau", load_share=np.nan, relative_friction=np.nan),
    ),
    curves=tuple(
        SimpleNamespace(
            model=model, amplitude=top * (GRID + 1e-7), load_share=share * (GRID + 1e-7) / 1e-5
        )
        for model, top, share in (
            ("paper2008", 0.4, 2.0), ("film-smooth", 0.5, 0.01), ("film-plateau", 0.3, 1.0),
        )
    ),
    result=lambda name: SimpleNamespace(relative_friction={"paper2008": 0.25}[name]),
)  # fmt: skip


def made(**changes: Any) -> Any:
    parts: dict[str, Any] = {
        "prediction": POINT, "display": DISPLAY, "pressure": (ASYMPTOTE, SOLVED),
        "friction_curves": CURVES, "wavelength_curves": WAVES, "film_models": FILMS,
        "own_curve": CURVES[0], "own_curves": CURVES[:2], "uncertainty": None, "band": None,
    }  # fmt: skip
    return SimpleNamespace(**{**parts, **changes})


def point(**changes: Any) -> Any:
    return SimpleNamespace(**{**vars(POINT), **changes})


def words(text: str) -> str:
    return text.replace("\u00a0", " ").replace("\n", " ")


def labelled(axes: Any) -> dict[str, Any]:
    return dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))


def test_gap_and_pressure_are_drawn_whole_and_enlarged() -> None:
    figure = pressure(made())
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
        "solved film, grooves sealed, mean 1.0333",
        "would carry the finger: 1.0500",
    ]
    assert words(figure.get_suptitle()) == (
        "The film's pressure rises over the ridge crests only: to 1.2 times ambient by the paper, "
        "to 1.1 in the solved film"
    )
    assert words(figure.get_supxlabel()) == (
        "Model: paper2008, film-sealed (grooves sealed at their ends)"
    )


def test_a_smooth_finger_with_wide_ridges_and_one_film() -> None:
    finger = SimpleNamespace(contact_length=10e-3, ridge_amplitude=0.0, ridge_period=20e-3)
    display = SimpleNamespace(finger=finger, gas=DISPLAY.gas)
    figure = pressure(made(display=display, pressure=(ASYMPTOTE,)))
    assert words(figure.get_suptitle()) == (
        "The film's pressure rises at the antinode: to 1.2 times ambient by the paper"
    )
    # No part of the contact is wider than the whole.
    assert figure.axes[3].get_xlim() == pytest.approx((-5, 5))


@pytest.mark.parametrize(("most", "adds"), [(1.0004, False), (1.0006, True)])
def test_a_film_that_adds_no_pressure_is_said(most: float, adds: bool) -> None:
    still = PressureProfile(PLACE, GAP, np.full(101, most), "paper2008")
    title = words(pressure(made(pressure=(still,))).get_suptitle())
    said = "The film adds no pressure here; 1.050 times ambient would carry the finger"
    assert (title != said) == adds


def test_friction_is_drawn_for_every_surface_with_what_it_needs() -> None:
    figure = friction(made())
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
    axes = friction(made()).axes[0]
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
    own = made(prediction=point(model=model, relative_friction=0.98), own_curve=CURVES[2])
    assert words(friction(own).get_suptitle()) == (
        "At 2 µm the friction on polished is 0.98 of what it is without vibration; 0.7 takes more "
        "than 50 µm"
    )
    rough = made(own_curve=CURVES[1])
    assert words(friction(rough).get_suptitle()).endswith("0.7 takes 6 µm")


def test_the_own_model_is_drawn_within_its_band() -> None:
    band = SimpleNamespace(
        amplitude=GRID[:4], low=np.array([1, 0.5, 0.2, 0.1]), high=np.array([1, 0.9, 0.8, 0.7]),
        level=0.9,
    )  # fmt: skip
    unsure = SimpleNamespace(
        interval=(0.2, 0.8), level=0.9, sentence="µ′/µ = 0.81 as described (0.20–0.80)"
    )
    figure = own_friction(made(band=band, uncertainty=unsure))
    axes = figure.axes[0]
    drawn = labelled(axes)
    assert list(drawn) == [
        "90 % of what the friction may be at an amplitude",
        "as described, on polished (roughness 1.5 µm)", "as described, on rough (roughness 1.5 µm)",
        "0.7: what the paper asks for", "this display: 0.81 (0.20–0.80, 90 % interval) at 2 µm",
    ]  # fmt: skip
    area, own, other, *_ = drawn.values()
    assert to_hex(area.get_facecolor()[0]) == BAND
    assert area.get_paths()[0].vertices[:, 0].max() == pytest.approx(3)
    assert {to_hex(one.get_color()) for one in (own, other)} == {look_of("paper2008").color}
    assert own.get_linewidth() > other.get_linewidth()
    bar = next(one for one in axes.get_lines() if list(one.get_ydata()) == [0.2, 0.8])
    assert bar.get_xdata() == pytest.approx([2, 2])
    assert axes.get_xlim() == pytest.approx((0, 3))
    assert words(figure.get_suptitle()) == (
        "At 2 µm on polished µ′/µ = 0.81 as described (0.20–0.80); 0.7 takes 2.4 µm"
    )
    alone = own_friction(made())
    assert words(alone.get_suptitle()) == "At 2 µm on polished µ′/µ = 0.81; 0.7 takes 2.4 µm"
    assert len(labelled(alone.axes[0])) == 4


def test_films_are_compared_by_the_share_they_carry() -> None:
    figure = film_models(made())
    axes = figure.axes[0]
    lines = labelled(axes)
    assert list(lines) == [
        "paper's asymptote", "solved film, no ridges", "solved film, ridges pressed flat",
        "carries the whole finger",
    ]  # fmt: skip
    for line, one in zip(lines.values(), FILMS.curves, strict=False):
        assert line.get_xdata() == pytest.approx(1e6 * one.amplitude)
        assert line.get_ydata() == pytest.approx(one.load_share)
    assert lines["carries the whole finger"].get_ydata() == [1, 1]
    marks = [one for one in axes.get_lines() if one.get_label().startswith("_")]
    assert [one.get_xdata() for one in marks] == [pytest.approx([2])] * 3
    assert [one.get_ydata()[0] for one in marks[:2]] == [1.9, 0.004]
    for line, mark in zip(lines.values(), marks, strict=False):
        assert line.get_color() == mark.get_color()
    assert axes.get_yscale() == "log"
    assert axes.get_xscale() == "log"
    ends = 1e6 * FILMS.curves[0].amplitude[[0, -1]]
    assert axes.get_xlim() == pytest.approx(ends)
    assert axes.get_ylim() == pytest.approx((1e-4, 30))
    assert (axes.get_xlabel(), axes.get_ylabel()) == (
        AMPLITUDE,
        "film's pressure over the finger's",
    )
    assert axes.yaxis.get_major_formatter()(0.01) == "0.01"
    # A film that could not be solved counts neither as the least nor as the most.
    assert words(figure.get_suptitle()) == (
        "At 2 µm the film carries from 0.4 to 190 % of the finger: how ridges are drawn decides"
    )
    assert words(figure.get_supxlabel()) == (
        "Model: all at 40 kHz, with slip but for the asymptote"
    )


def test_where_nothing_vibrates_there_is_no_film_to_compare() -> None:
    assert film_models(made(film_models=None)).get_suptitle() == "Nothing vibrates"


def test_waves_are_drawn_with_the_amplitude_each_needs() -> None:
    figure = wavelength(made())
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
    beyond = wavelength(made(prediction=point(vibration_amplitude=4.1e-6))).axes[0]
    assert not any(name.startswith("this display") for name in labelled(beyond))
    still = wavelength(made(film_models=None)).axes[0]
    assert "this display by paper2008: 0.81 at 2 µm and λ/2 = 10 mm" in labelled(still)
