"""Figures of film and friction: curves, marks and words against numbers written down by hand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.colors import to_hex
from tests.unit.report.drawn import labelled, words
from tests.unit.report.made_curves import AMPLITUDE, FILMS, GRID, made

from squeezefilm.report.display.friction_figures import film_models, own_friction
from squeezefilm.report.kit.model_looks import look_of
from squeezefilm.report.kit.style import BAND


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
        "At 2 µm the film would carry from 0.4 % to 1.9 times the finger's load: how ridges are "
        "drawn decides"
    )
    assert words(figure.get_supxlabel()) == (
        "Model: all at 40 kHz, with slip but for the asymptote"
    )


def test_where_nothing_vibrates_there_is_no_film_to_compare() -> None:
    assert film_models(made(film_models=None)).get_suptitle() == "Nothing vibrates"
