"""Designs from files: what they hold, and what they refuse."""

from __future__ import annotations

import dataclasses
import textwrap
from pathlib import Path

import pytest

from squeezefilm import config, presets
from squeezefilm.errors import ConfigError, InputError
from squeezefilm.perception.stimuli import Grating, Stimulus
from squeezefilm.study.design.study_design import (
    AdaptiveCondition,
    CatchTrial,
    StudyDesign,
    load_design,
)
from squeezefilm.study.design.trials import trials
from squeezefilm.study.record.store import StudyStore

TWO_INTERVAL = """
name = "period-jnd"
title = "Just noticeable difference of the period"
task = "two-interval"
displays = ["biet2008-plate"]
reference = "4 mm"
practice = 4
repetitions = 3

[[stimuli]]
name = "4 mm"
spatial_period = "4 mm"
period_means = "period"

[[stimuli]]
name = "5 mm"
spatial_period = "5 mm"
period_means = "period"

[[stimuli]]
name = "6 mm"
spatial_period = "6 mm"
period_means = "period"

[[catch]]
answer = "first"
count = 2
stimulus = { name = "20 mm", spatial_period = "20 mm", period_means = "period" }
"""


def test_the_papers_study_says_what_its_lengths_are() -> None:
    periods = load_design("biet2008-gratings")
    widths = load_design("biet2008-gratings-as-widths")
    assert [one.spatial_period for one in periods.stimuli] == [0.4e-3, 2e-3, 4e-3, 8e-3, 10e-3]
    assert [one.period for one in periods.stimuli] == [0.4e-3, 2e-3, 4e-3, 8e-3, 10e-3]
    assert [one.period for one in widths.stimuli] == [0.8e-3, 4e-3, 8e-3, 16e-3, 20e-3]
    assert {one.ridge_height for one in periods.alternatives} == {70e-6}
    for design in (periods, widths):
        assert [design.answer_to(one) for one in design.stimuli] == list(design.answers)
    assert periods.sha256 != widths.sha256
    assert set(presets.study_names()) >= {periods.name, widths.name}
    assert periods.provenance["repetitions"].evidence == "assumed"


def test_a_period_follows_from_groove_width_and_ridge_share() -> None:
    one = Stimulus("a", 3e-3, "groove width", ridge_share=0.25)
    assert one.period == pytest.approx(4e-3)
    assert one.groove_width == pytest.approx(3e-3)
    assert Grating("a", 3e-3, "groove width", ridge_share=0.25).period == pytest.approx(4e-3)


def test_the_texture_is_slippery_in_the_grooves_and_turns_with_the_orientation() -> None:
    one = Stimulus("a", 4e-3, "period", ridge_share=0.25)
    assert one.surface()(0.5e-3, 0.0, 0.0, 0.0) == 1.0
    assert one.surface()(2e-3, 0.0, 0.0, 0.0) == 0.7
    across = dataclasses.replace(one, orientation=1.5707963267948966).surface()
    assert across(2e-3, 0.5e-3, 0.0, 0.0) == 1.0
    assert across(0.0, 2e-3, 0.0, 0.0) == 0.7
    flat = dataclasses.replace(one, waveform="constant").surface()
    assert flat(2e-3, 0.0, 0.0, 0.0) == 1.0


def test_an_amount_is_varied_and_nothing_else() -> None:
    one = Stimulus("a", 4e-3, "period")
    assert one.varied("b", "spatial_period", 5e-3).period == 5e-3
    deeper = one.varied("b", "friction_depth", 0.5)
    assert (deeper.low, deeper.high, deeper.period) == (0.5, 1.0, 4e-3)
    assert deeper.amount("friction_depth") == 0.5
    with pytest.raises(InputError, match="low"):
        one.varied("b", "friction_depth", 1.5)


def test_what_is_right_in_each_task() -> None:
    design = config.load_text(StudyDesign, TWO_INTERVAL)
    four, five = design.stimulus("4 mm"), design.stimulus("5 mm")
    assert design.answer_to(four, five) == "second"
    assert design.answer_to(five, four) == "first"
    assert design.catch_condition(design.catch[0]) == ("20 mm", "4 mm")
    same = dataclasses.replace(design, task="same-different", catch=())
    assert same.answer_to(four, dataclasses.replace(four, name="twin")) == "same"
    assert same.answer_to(four, five) == "different"


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('period_means = "period"\n\n[[stim', "\n[[stim", "the key 'period_means' is missing"),
        ('reference = "4 mm"', 'reference = "4mm"', "Did you mean '4 mm'"),
        ('reference = "4 mm"', "", "compares with a reference"),
        ('spatial_period = "5 mm"', 'spatial_period = "4 mm"', "no answer would be right"),
        ('spatial_period = "5 mm"', "spatial_period = 5", "no unit"),
        ('name = "5 mm"', 'name = "4 mm"', "name twice"),
        ('name = "period-jnd"', 'name = "../x"', "file names"),
        ('task = "two-interval"', 'task = "two-intervals"', "task"),
        ('task = "two-interval"', 'task = "match-to-sample"', "real gratings"),
        ('answer = "first"', 'answer = "third"', "none of: first, second"),
        ("repetitions = 3", "repetitions = 0", "a whole number at least 1"),
        ("practice = 4", "practise = 4", "Did you mean 'practice'"),
    ],
)  # fmt: skip
def test_mistakes_are_refused_with_what_is_allowed(old: str, new: str, says: str) -> None:
    assert old in TWO_INTERVAL
    with pytest.raises(ConfigError, match=says):
        config.load_text(StudyDesign, TWO_INTERVAL.replace(old, new, 1))


def test_a_catch_trial_that_is_never_right_is_refused() -> None:
    design = config.load_text(StudyDesign, TWO_INTERVAL)
    same = Stimulus("twin", 4e-3, "period")
    with pytest.raises(InputError, match="never right"):
        dataclasses.replace(design, catch=(CatchTrial(same, "first"),))


def test_a_study_that_is_not_there_is_named_with_those_that_are(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="Did you mean 'biet2008-gratings'"):
        load_design("biet2008-grating")
    with pytest.raises(ConfigError, match="does not exist"):
        load_design(tmp_path / "none.toml")


def test_the_design_in_the_documentation_is_one() -> None:
    page = (Path(__file__).parents[4] / "docs" / "study.md").read_text(encoding="utf-8")
    block = page[page.index('    name = "period-jnd"') : page.index("**Period or groove width.**")]
    design = config.load_text(StudyDesign, textwrap.dedent(block))
    assert design.adaptive[0].count == 60
    assert len(trials(design, 0, 1)) == 8 + 60 + 4


def test_practice_and_series_that_cannot_be_are_refused() -> None:
    design = config.load_text(StudyDesign, TWO_INTERVAL)
    alone = dataclasses.replace(
        design,
        stimuli=design.stimuli[:1],
        practice=0,
        adaptive=(AdaptiveCondition("a", "staircase"),),
    )
    with pytest.raises(InputError, match="practice needs a stimulus"):
        dataclasses.replace(alone, practice=1)
    deep = (AdaptiveCondition("a", "staircase", "friction_depth", highest=5.0),)
    with pytest.raises(InputError, match="make them the same"):
        dataclasses.replace(alone, adaptive=deep)
    with pytest.raises(InputError, match="cannot go up to highest = 5"):
        dataclasses.replace(alone, adaptive=deep, judged="friction_depth", catch=())


@pytest.mark.parametrize("name", presets.study_names())
def test_every_preset_is_kept_whole_in_a_studys_file(name: str, tmp_path: Path) -> None:
    design = load_design(name)
    assert design.name == name
    with StudyStore.create(tmp_path / "a.sqlite", design, 7) as store:
        assert store.design == design
        assert store.design.sha256 == design.sha256 == store.study["design_sha256"]
        assert len(trials(design, 0, 7)) > 0
