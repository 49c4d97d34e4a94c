"""Figures and page of a study: what they say is in the data, and names are only text."""

from __future__ import annotations

import json
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.known_observers import DirichletParticipants, distinction, ordered_observer
from tests.unit.drawn import words

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.analysis import IdentificationAnalysis, analyze_identification
from squeezefilm.study.identification.power import (
    power_curve,
)
from squeezefilm.study.report import figures as study_figures
from squeezefilm.study.report.page import study_figures as figures_of
from squeezefilm.study.report.page import study_page, write_study

pytestmark = pytest.mark.usefixtures("figures_as_described")

HOSTILE = '<script>alert("x")</script> $\\frac{1}{0}$ 漢字 \x1b[31m\u202e & more'


def study(name: str = "gratings", per: int = 4, spacing: float = 1.5) -> IdentificationAnalysis:
    """A small study of eight simulated people."""
    random = np.random.default_rng(7)
    counts = DirichletParticipants(ordered_observer(spacing), per, 50.0)(8, random)
    who, choice, stimulus = (
        np.repeat(index, counts.ravel()) for index in np.indices(counts.shape).reshape(3, -1)
    )
    return analyze_identification(
        who, stimulus, choice, ("0.4 mm", "2 mm", "4 mm", "8 mm", f"10 mm{name[8:]}"), name=name,
        origin="simulated", resamples=50, response_time=random.gamma(3, 0.4, who.size) + 0.2,
        exploration={"mean_speed_m_per_s": random.normal(0.08, 0.01, who.size)},
    )  # fmt: skip


def _left_open(page: str) -> list[str]:
    """The tags of a page that are not closed in order."""
    opened: list[str] = []

    class Reader(HTMLParser):
        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            if tag not in ("meta", "img"):
                opened.append(tag)

        def handle_endtag(self, tag: str) -> None:
            if opened and opened[-1] == tag:
                opened.pop()
            else:
                opened.append(f"/{tag}")

    Reader().feed(page)
    return opened


@pytest.fixture(scope="module")
def analysis() -> IdentificationAnalysis:
    """The study, once."""
    return study()


def test_every_cell_of_the_heat_map_is_a_percentage(analysis: IdentificationAnalysis) -> None:
    axes = study_figures.confusion(analysis).axes[0]
    cells = [text.get_text() for text in axes.texts]
    assert len(cells) == 25
    for text, percent, count in zip(
        cells, analysis.matrix.percent.ravel(), analysis.matrix.counts.ravel(), strict=True
    ):
        assert text == (f"{percent:.0f} %\n({count})" if count else "·")
    assert next(label.get_text() for label in axes.get_xticklabels()) == "0.4 mm"
    assert axes.get_xlabel() == "simulated"
    assert axes.get_ylabel() == "answered"


def test_every_figure_says_whose_answers_these_are(analysis: IdentificationAnalysis) -> None:
    for key, (heading, figure) in figures_of(analysis).items():
        assert heading, key
        assert figure.get_suptitle(), key
        assert "simulated answers" in " ".join(figure.get_supxlabel().split()), key


def test_titles_carry_the_numbers(analysis: IdentificationAnalysis) -> None:
    fit = analysis.sensitivity
    assert fit is not None
    assert f"Δ′ = {fit.total:.2f}" in " ".join(
        study_figures.sensitivity(analysis).get_suptitle().split()
    )


def test_of_one_stimulus_no_time_is_the_longest(analysis: IdentificationAnalysis) -> None:
    times = analysis.response_times
    one, two = (
        " ".join(study_figures.response_times(few).get_suptitle().split())
        for few in (replace(analysis, response_times=times[:count]) for count in (1, 2))
    )
    assert "takes longest" in two
    assert "shortest" in two
    assert one == f"{times[0].name} takes {times[0].geometric_mean:.2g} s"


def test_power_is_drawn_with_what_is_needed() -> None:
    curve = power_curve(
        DirichletParticipants(ordered_observer(1.5), 3, 20.0),
        lambda n: distinction(n, 3, 4), (4, 12), studies=50,
    )  # fmt: skip
    figure = study_figures.power(curve)
    assert curve.needed == 12
    assert "12 people reach 80" in " ".join(figure.get_suptitle().split())
    axes = figure.axes[0]
    assert axes.get_xlim()[0] == axes.get_ylim()[0] == 0


def test_more_or_fewer_people_than_were_simulated_are_needed() -> None:
    shares = np.array([0.4, 0.75])
    for needed, surely, said in (
        (None, None, "8 people do not reach 80 % power"),
        (4, 8, "4 people reach 80 % power; 8 do beyond the simulation's error"),
        (4, 4, "4 people reach 80 % power"),
    ):
        made: Any = SimpleNamespace(
            needed=needed, needed_surely=surely, target=0.8, studies=20, alpha=0.05,
            participants=np.array([4, 8]), power=shares, low=shares - 0.1, high=shares + 0.1,
        )  # fmt: skip
        assert words(study_figures.power(made).get_suptitle()) == said


@pytest.mark.parametrize("needed", [12, None])
@pytest.mark.parametrize("measure", ["Weber fraction", "exponent"])
def test_precision_says_how_many_people_give_it(measure: str, needed: int | None) -> None:
    reached = np.array([0.2, 0.9])
    curve = SimpleNamespace(
        needed=needed, target=0.8, studies=40, participants=np.array([4, 12]), power=reached,
        low=reached - 0.1, high=reached + 0.05,
    )  # fmt: skip
    held = np.array([0.94, 0.96])
    found: Any = SimpleNamespace(precision=0.1, measure=measure, curve=curve, held=held)
    figure = study_figures.precision(found)
    said = words(figure.get_suptitle())
    within = "± 10 %" if measure == "Weber fraction" else "± 0.1"
    assert within in said
    assert said.startswith("12 people " + ("give" if needed else "do not give"))
    assert said.endswith("in 80 % of studies")
    (axes,) = figure.axes
    assert list(axes.lines[0].get_ydata()) == list(100 * reached)


def test_too_few_data_make_a_message() -> None:
    found = analyze_identification([0, 1], [0, 1], [1, 1], ("a", "b", "c"), resamples=10)
    assert found.sensitivity is None
    for figure in figures_of(found).values():
        assert figure[1].get_suptitle()
    assert study_figures.sensitivity(found).get_suptitle() == "No d′"


@pytest.mark.slow
def test_the_page_is_whole_and_escaped(tmp_path: Path) -> None:
    hostile = study(HOSTILE)
    page = write_study(hostile, tmp_path / "deep" / "study").read_text(encoding="utf-8")
    assert "<script>" not in page
    assert "\x1b" not in page
    assert "<b>simulated answers</b>" in page
    assert _left_open(page) == []
    folder = tmp_path / "deep" / "study"
    for name in [part.split('"')[0] for part in page.split('img src="')[1:]]:
        assert (folder / name).read_bytes().startswith(b"\x89PNG")
    data = json.loads((folder / "identification.json").read_text(encoding="utf-8"))
    assert data["proportion_correct"] == hostile.proportion_correct
    assert np.array(data["confusion"]).shape == (5, 5)


def test_notes_are_on_the_page() -> None:
    found = analyze_identification([0] * 4, [0, 0, 1, 1], [0, 0, 1, 1], ("a", "b"), resamples=10)
    page = study_page(found, {}, found.summary()["provenance"])
    assert "one participant" in page
    assert "d′ is too low" in page


def test_a_file_is_no_folder(tmp_path: Path, analysis: IdentificationAnalysis) -> None:
    (tmp_path / "taken").write_text("x")
    with pytest.raises(InputError, match="is a file"):
        write_study(analysis, tmp_path / "taken")
