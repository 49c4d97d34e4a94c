"""Sentences of the methods section say what was presented."""

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.study.design.study_design import load_design
from squeezefilm.study.simulated.answers import SimulatedStudy
from squeezefilm.study.tasks.analyze import _stimuli, _trials


def test_a_series_has_its_reference_and_fixed_stimuli_have_all() -> None:
    series = load_design("period-jnd")
    assert _stimuli(series).startswith("The reference was a square grating of friction")
    assert _stimuli(series).count(" mm (") == 1
    # Others of a series are for practice.
    more = dataclasses.replace(series.stimuli[0], name="2 mm", spatial_period=2e-3)
    practised = dataclasses.replace(series, stimuli=(*series.stimuli, more))
    assert _stimuli(practised) == _stimuli(series)
    fixed = load_design("friction-jnd")
    assert _stimuli(fixed).startswith("Stimuli were square gratings of friction")
    assert _stimuli(fixed).count(" mm (") == len(fixed.stimuli)


def test_surfaces_that_are_no_gratings_are_named() -> None:
    series = load_design("period-jnd")
    crossed = dataclasses.replace(series.stimuli[0], crossed_period=3e-3)
    named = dataclasses.replace(series, stimuli=(crossed, *series.stimuli[1:]))
    said = _stimuli(named)
    assert said.startswith(f"The reference was the surface “{crossed.name}” (")
    assert " by 3 mm, " in said
    assert crossed.surface_sha256[:12] in said
    fixed = load_design("friction-jnd")
    other = dataclasses.replace(fixed.stimuli[0], crossed_period=3e-3)
    several = dataclasses.replace(fixed, stimuli=(other, *fixed.stimuli[1:]))
    assert _stimuli(several).startswith("Stimuli were surfaces of friction: “")
    assert _stimuli(several).count("; “") == len(fixed.stimuli) - 1


def test_a_simulated_study_of_another_task_has_no_confusions() -> None:
    study = object.__new__(SimulatedStudy)
    tables = dataclasses.make_dataclass("Tables", ["design"])(load_design("friction-jnd"))
    object.__setattr__(study, "tables", tables)
    for ask in (study.confusion, study.proportion_correct):
        with pytest.raises(InputError, match="'two-interval' has no confusions"):
            ask()


def test_trials_are_counted_per_participant_on_the_display_itself() -> None:
    design = dataclasses.replace(load_design("friction-jnd"), blocks=1)
    phase = np.array(["main"] * 6 + ["practice"] * 2 + ["catch"] * 3 + ["main"])
    whole = {
        "display": np.array([0] * 11 + [1]),
        "participant": np.array([0, 0, 0, 1, 1, 1, 0, 1, 0, 0, 1, 0]),
        "phase": phase,
    }

    def taken(keep: Any) -> Any:
        return SimpleNamespace(**{key: value[keep] for key, value in whole.items()}, take=taken)

    answers: Any = taken(np.ones(12, dtype=bool))
    said = _trials(design, answers, 0)
    begin = "There were 3 trials a participant beside 1 of practice with feedback and 1.5 catch"
    assert said.startswith(f"{begin} trials, ")
    assert _trials(design, answers, 1).startswith("There were 1 trials a participant, ")
    blocks = _trials(dataclasses.replace(design, blocks=3), answers, 1)
    assert blocks.startswith("There were 1 trials a participant in 3 blocks, ")
