"""Designs from files: what they hold, and what they refuse."""

from __future__ import annotations

import dataclasses
import math
import textwrap
from pathlib import Path

import pytest

from squeezefilm.core import config, presets
from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.study.design.rules import AdaptiveCondition, CatchTrial, TrialRules
from squeezefilm.study.design.study_design import StudyDesign, load_design
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
        ('period_means = "period"\n\n[[stim', "\n[[stim", "does not say which length that is"),
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
    page = (Path(__file__).parents[4] / "docs" / "reference" / "study.md").read_text(
        encoding="utf-8"
    )
    block = page[page.index('    name = "period-jnd"') : page.index("**Period or groove width.**")]
    design = config.load_text(StudyDesign, textwrap.dedent(block))
    assert design.adaptive[0].count == 60
    assert len(trials(design, 0, 1)) == 8 + 60 + 4


def test_what_comes_again_is_as_the_documentation_says() -> None:
    page = (Path(__file__).parents[4] / "docs" / "reference" / "study.md").read_text(
        encoding="utf-8"
    )
    block = page[page.index("practice_criterion =") : page.index("```\n\n`plan --orders DIR`")]
    top, rules = block.split("[rules]")
    first = TWO_INTERVAL.index("[[")
    text = f"{TWO_INTERVAL[:first]}{top}[rules]{rules}\n{TWO_INTERVAL[first:]}"
    if "practice =" not in text:
        text = f"practice = 4\n{text}"
    design = config.load_text(StudyDesign, text)
    assert design.rules == TrialRules(0.02, 0.2, 0.2, 1.0, 0.01, 0.5)
    assert (design.practice_criterion, design.resume_within) == (0.75, 86400.0)


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


def _gratings(**more: object) -> StudyDesign:
    """Three gratings to be told apart, with nothing said that need not be."""
    values: dict[str, object] = {
        "name": "a",
        "title": "",
        "displays": ("biet2008-plate",),
        "task": "match-to-sample",
        "stimuli": tuple(Stimulus(f"{mm} mm", mm * 1e-3, "period") for mm in (2, 4, 8)),
        "alternatives": tuple(Grating(f"{mm} mm", mm * 1e-3, "period") for mm in (2, 4, 8)),
    }
    return StudyDesign(**(values | more))  # type: ignore[arg-type]


def test_what_is_not_said_is_done_once_and_nothing_before_it() -> None:
    design = _gratings()
    assert [one.phase for one in trials(design, 0, 1)] == ["main"] * 3
    assert design.most_trials == 3
    assert (design.blocks, design.repetitions) == (1, 1)
    assert (design.practice, design.familiarisation, design.catch, design.adaptive) == (
        0,
        0,
        (),
        (),
    )
    assert design.order == "williams"
    assert (design.break_between_blocks, design.trial_duration) == (60.0, 20.0)
    assert (design.modulus, design.judged) == (0.0, "spatial_period")


def test_most_trials_count_all_phases_on_every_display() -> None:
    design = _gratings(displays=("biet2008-plate", "biet2008-stator"), blocks=2, repetitions=5,
                       familiarisation=3, practice=4, catch=(
                           CatchTrial(Stimulus("a", 2e-3, "period", matches="2 mm"), "2 mm", 6),
                       ))  # fmt: skip
    assert design.most_trials == 2 * (2 * 5 * 3 + 3 * 3 + 6 + 4)
    assert len(trials(design, 0, 1)) <= design.most_trials
    # Of pairs there are the two orders, and for same/different also both alike.
    two = config.load_text(StudyDesign, TWO_INTERVAL)
    assert two.most_trials == 3 * 2 * 2 + 2 + 4
    assert dataclasses.replace(two, task="same-different", catch=()).most_trials == 3 * 2 * 4 + 4
    series = (AdaptiveCondition("a", "staircase", count=7), AdaptiveCondition("b", "bayesian",
                                                                              count=9))  # fmt: skip
    assert dataclasses.replace(two, adaptive=series).most_trials == 7 + 9 + 2 + 4


def test_whoever_says_where_values_are_from_the_design_is_the_same() -> None:
    design = _gratings()
    said = dataclasses.replace(design, provenance=load_design("biet2008-gratings").provenance)
    assert said.provenance
    assert said == design
    assert said.sha256 == design.sha256
    assert "provenance" not in repr(said)
    assert dataclasses.replace(design, note="b").sha256 != design.sha256


@pytest.mark.parametrize(
    ("change", "quantity", "says"),
    [
        ({"displays": ()}, "displays", "displays is empty"),
        ({"displays": ("a", "a")}, "displays", "name twice"),
        ({"stimuli": ()}, "stimuli", "stimuli is empty"),
        ({"reference": "5 mm"}, "reference", "is no stimulus.* Stimuli: 2 mm, 4 mm, 8 mm"),
        ({"alternatives": ()}, "alternatives", "two or more .*; there are 0"),
        ({"alternatives": (Grating("2 mm", 2e-3, "period"),)}, "alternatives", "there are 1"),
        ({"task": "magnitude-estimation"}, "alternatives", "has no alternatives; remove them"),
        ({"task": "two-interval", "alternatives": ()}, "reference", "compares with a reference"),
        ({"task": "two-interval", "alternatives": (), "reference": "2 mm",
          "stimuli": (Stimulus("2 mm", 2e-3, "period"),)}, "stimuli", "only the reference"),
        ({"adaptive": (AdaptiveCondition("a", "staircase"),)}, "adaptive",
         "compare with a reference, in task = .*; 'match-to-sample' does not"),
        ({"task": "same-different", "alternatives": (), "reference": "2 mm",
          "adaptive": (AdaptiveCondition("a", "staircase"),)}, "adaptive",
         "'a' is by method = 'staircase', which would settle .* takes method = 'bayesian'"),
        ({"modulus": 10.0}, "modulus", "needs magnitude-estimation and a reference"),
        ({"modulus": 10.0, "reference": "2 mm"}, "modulus", "needs magnitude-estimation"),
        ({"task": "magnitude-estimation", "alternatives": (), "modulus": 10.0}, "modulus",
         "and a reference"),
        ({"stimuli": (Stimulus("2 mm", 2e-3, "period", matches="9 mm"),)}, "stimuli",
         "matches '9 mm', which is no alternative.* Alternatives: 2 mm, 4 mm, 8 mm"),
    ],
)  # fmt: skip
def test_a_design_that_does_not_fit_its_task_is_refused(
    change: dict[str, object], quantity: str, says: str
) -> None:
    with pytest.raises(InputError, match=says) as refused:
        _gratings(**change)
    assert refused.value.quantity == quantity


def test_a_modulus_and_a_series_with_the_reference_alone_are_fine() -> None:
    one = (Stimulus("2 mm", 2e-3, "period"),)
    rated = _gratings(task="magnitude-estimation", alternatives=(), modulus=10.0, reference="2 mm")
    assert rated.modulus == 10.0
    assert rated.answers == ()
    alone = _gratings(task="two-interval", alternatives=(), reference="2 mm", stimuli=one,
                      adaptive=(AdaptiveCondition("a", "staircase", count=5),))  # fmt: skip
    assert alone.most_trials == 5
    assert alone.answers == ("first", "second")
    found = alone.comparison(alone.adaptive[0], 0.25)
    assert (found.name, found.period) == ("2 mm +25 %", pytest.approx(2.5e-3))
    same = _gratings(task="same-different", alternatives=(), reference="2 mm")
    assert same.answers == ("same", "different")


def test_a_stimulus_is_found_by_its_name_or_told() -> None:
    odd = Stimulus("odd", 4e-3, "period")
    design = _gratings(catch=(CatchTrial(odd, "4 mm"),))
    assert design.stimulus("odd") is odd
    assert design.stimulus("8 mm").period == 8e-3
    with pytest.raises(InputError, match=r"has no stimulus '8mm'\. Did you mean '8 mm'"):
        design.stimulus("8mm")
    # One surface is presented alone, whatever its answer.
    assert design.catch_condition(design.catch[0]) == ("odd",)


def test_each_task_asks_its_own_question() -> None:
    two = config.load_text(StudyDesign, TWO_INTERVAL)
    assert two.spoken_question == "Which of the two surfaces was coarser?"
    deep = dataclasses.replace(
        two,
        judged="friction_depth",
        catch=(),
        stimuli=(two.stimuli[0], dataclasses.replace(two.stimuli[1], low=0.5)),
    )
    assert deep.spoken_question == "Which of the two surfaces was more strongly felt?"
    assert dataclasses.replace(deep, question="Which?").spoken_question == "Which?"
    assert _gratings().spoken_question.startswith("Which of the gratings")
    same = dataclasses.replace(two, task="same-different", catch=())
    assert same.spoken_question == "Were the two surfaces the same or different?"
    assert "number" in _gratings(task="magnitude-estimation", alternatives=()).spoken_question


def test_what_is_right_where_something_is() -> None:
    design = _gratings()
    flat = Stimulus("flat", 2e-3, "period", waveform="constant")
    assert design.answer_to(flat) == ""
    assert design.answer_to(dataclasses.replace(flat, matches="8 mm")) == "8 mm"
    assert design.answer_to(Stimulus("x", 2e-3 + 0.5e-9, "period")) == "2 mm"
    assert design.answer_to(Stimulus("x", 2e-3 + 2e-9, "period")) == ""
    assert design.answer_to(Stimulus("x", 2e-3, "period", matches="4 mm")) == "4 mm"
    twice = _gratings(alternatives=(*design.alternatives, Grating("again", 2e-3, "period")))
    assert twice.answer_to(design.stimuli[0]) == ""
    two = config.load_text(StudyDesign, TWO_INTERVAL)
    four = two.stimulus("4 mm")
    assert two.answer_to(four) == ""
    assert two.answer_to(four, dataclasses.replace(four, low=0.5)) == ""
    deep = dataclasses.replace(four, low=0.5)
    by_depth = dataclasses.replace(
        two,
        judged="friction_depth",
        catch=(),
        stimuli=(four, dataclasses.replace(deep, name="deep")),
    )
    assert by_depth.answer_to(four, deep) == "second"
    assert by_depth.answer_to(deep, four) == "first"
    same = dataclasses.replace(two, task="same-different", catch=())
    assert same.answer_to(four, deep) == "different"
    assert same.answer_to(four) == ""
    rated = _gratings(task="magnitude-estimation", alternatives=())
    assert rated.answer_to(four) == ""


def test_a_catch_trial_is_put_in_the_order_in_which_it_is_right() -> None:
    design = config.load_text(StudyDesign, TWO_INTERVAL)
    odd = design.catch[0].stimulus
    assert design.catch_condition(CatchTrial(odd, "second")) == ("4 mm", "20 mm")
    same = dataclasses.replace(design, task="same-different", catch=(CatchTrial(odd, "same"),))
    assert same.catch_condition(same.catch[0]) == ("20 mm", "20 mm")
    assert same.catch_condition(CatchTrial(odd, "different")) == ("20 mm", "4 mm")


def test_the_differences_of_adaptive_series_are_their_ends() -> None:
    """Of a scale of logarithms: ln(1 + x) of each series' lowest and highest difference."""
    design = load_design("period-jnd")
    ends = [x for one in design.adaptive for x in (one.lowest, one.highest)]
    assert design.differences == pytest.approx([math.log(1 + x) for x in ends])
    assert design.series("bayesian") is design.adaptive[1]
    with pytest.raises(InputError, match="'stairs' is none of: staircase, bayesian"):
        design.series("stairs")
