"""Plan of running a design: trials, time, orders, and what of it is assumed."""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.hard_limits import PLANNED_TRIALS, require_within
from squeezefilm.core.regular_file import read_toml_text
from squeezefilm.core.results import Result, values_of, write_named
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.display import load_display
from squeezefilm.physics.perception.observer import NamedObserver, Observer, load_observer
from squeezefilm.physics.perception.senses import (
    D_PRIME_OF_75,
    MEAN_FRICTION,
    Rubbed,
    detected_share,
)
from squeezefilm.physics.perception.stimuli import Grating, Stimulus
from squeezefilm.study.design.study_design import NamedDesign, StudyDesign
from squeezefilm.study.design.trials import (
    Trial,
    expected_duration,
    trials,
    williams_square,
)


@dataclass(frozen=True, repr=False)
class StudyPlan(Result):
    """A design seen by who must run it. `schedules` has the trials of each participant;
    `balanced_participants` is how many give every order equally often (1 where each participant
    has all of them); `doubts` says what to look at before anybody is asked."""

    design: StudyDesign
    participants: int
    seed: int
    schedules: tuple[tuple[Trial, ...], ...]
    duration: si.Second
    balanced_participants: int
    doubts: tuple[str, ...]
    _shown: ClassVar[str] = "design.name participants duration balanced_participants seed"

    @property
    def phases(self) -> dict[str, int]:
        """Trials of one participant by phase."""
        return dict(Counter(trial.phase for trial in self.schedules[0]))

    @property
    def assumed(self) -> tuple[str, ...]:
        """Keys of the file whose values it says are assumed."""
        sources = self.design.provenance.items()
        return tuple(key for key, one in sources if one.evidence == "assumed")

    def summary(self) -> dict[str, Any]:
        """Numbers as plain JSON values; keys carry units."""
        design = self.design
        return {
            **values_of(
                self,
                "design.name design.title design.task design.displays design.exploring "
                "design.matched_with design.order design.note participants balanced_participants "
                "seed doubts assumed",
            ),
            "question": design.spoken_question,
            "stimuli": [
                {
                    **_grooves(stimulus),
                    "second_period_m": _known(stimulus.second_period),
                    "surface": stimulus.kind,
                    **values_of(stimulus, "surface_sha256 waveform friction_depth"),
                    "right_answer": design.answer_to(stimulus) if not design.compares else "",
                }
                for stimulus in design.stimuli
            ],
            "alternatives": [
                {**_grooves(alternative), **values_of(alternative, "ridge_height material")}
                for alternative in design.alternatives
            ],
            "trials_per_participant": len(self.schedules[0]),
            "trials_by_phase": self.phases,
            "duration_per_participant_s": self.duration,
            "duration_s": self.duration * self.participants,
            "first_trials": [
                [" / ".join(trial.stimuli) for trial in schedule if trial.phase == "main"][:10]
                for schedule in self.schedules
            ],
            "design_sha256": design.sha256,
        }

    def _table(self) -> Any:
        return [
            {
                "participant": who,
                "trial": trial.number,
                "phase": trial.phase,
                "display": trial.display,
                "stimuli": " / ".join(trial.stimuli),
            }
            for who, schedule in enumerate(self.schedules)
            for trial in schedule
        ]


@reads_text
def plan_study(
    design: NamedDesign,
    participants: int = 1,
    seed: int = 0,
    *,
    observer: NamedObserver | None = None,
    reach: bool = False,
) -> StudyPlan:
    """The plan of a design for a number of participants, and what is doubtful of the design.

    `observer` says which threshold is predicted (the preset "fingertip" without); with `reach` each
    display is solved, to say which stimuli ask for less friction than it makes.

    Raises `InputError` for less than 1 or more than 1000 participants, or a seed below 0, and
    `ConfigError` for a surface whose file cannot be read.
    """
    si.require("participants", participants, at_least=1, at_most=1000)
    si.require("seed", seed, at_least=0)
    for stimulus in design.stimuli:
        # A texture's file or picture that is not there is told before anybody is planned.
        stimulus.surface()
    most = int(PLANNED_TRIALS.most // design.most_trials)
    enough = f"of {design.most_trials} trials each, at most {most} participants are planned at once"
    require_within(PLANNED_TRIALS, participants * design.most_trials, enough=enough)
    schedules = tuple(trials(design, number, seed) for number in range(participants))
    return StudyPlan(
        design,
        participants,
        seed,
        schedules,
        expected_duration(design),
        _balanced(design),
        doubts_of(design, observer or load_observer(), reach),
    )


def _grooves(surface: Stimulus | Grating) -> dict[str, Any]:
    return {
        "name": surface.name,
        "spatial_period_m": _known(surface.period),
        "groove_width_m": _known(surface.groove_width),
        "length_means": surface.period_means,
    }


def _known(length: si.Metre) -> si.Metre | None:
    """A length (m) as JSON has it: a shape's is none."""
    return None if math.isnan(length) else length


def _balanced(design: StudyDesign) -> int:
    """Participants after which every row of every square in use has come equally often."""
    # Displays are in a Williams square over participants, once each.
    displays = len(williams_square(len(design.displays)))
    if design.adaptive or design.order == "shuffled":
        return displays
    count = len(design.conditions)
    rows = len(williams_square(count)) if design.order == "williams" else count
    alone = (design.blocks * design.repetitions) % rows == 0
    return displays if alone else math.lcm(rows, displays)


def new_study_file(
    file: Path, preset: str, *, displays: Sequence[str] = (), replace: bool = False
) -> None:
    """Write a commented TOML file that starts from a preset study, named for the file, on other
    `displays` (preset names or paths) where any are given.

    Raises `InputError` if the file exists and is not to be replaced, `ConfigError` for a preset or
    a display that is not known.
    """
    from squeezefilm.core import config, presets

    text = read_toml_text(presets.path(preset, "study"))
    if displays:
        for display in displays:
            presets.resolve(display)
        own = ", ".join(json.dumps(str(display)) for display in displays)
        text = re.sub(r"(?m)^displays = .*$", lambda _: f"displays = [{own}]", text, count=1)
    header = (
        f"# Started from the preset {preset}: change what is yours, the title too.\n"
        f"# squeezefilm study plan {file.name} says what is doubtful of it.\n\n"
    )
    config.load_text(StudyDesign, header + text, file=str(file))
    write_named(file, header + text, replace=replace)


def predicted_fraction(design: StudyDesign, observer: Observer) -> si.Dimensionless | None:
    """The observer's Weber fraction of what a design judges; None where it has no sense of it."""
    return {
        "spatial_period": observer.period_weber_fraction,
        "friction_depth": observer.strength_weber_fraction,
    }.get(design.judged)


def doubts_of(design: StudyDesign, observer: Observer, reach: bool = False) -> tuple[str, ...]:
    """Sentences about a design, each with what to do; none where nothing is doubtful.

    With `reach` each display is solved, and stimuli are named that ask for less friction than it
    makes at its largest amplitude. Raises what `load_display` and `predict` raise.
    """
    sentences = [*_of_range(design, observer)]
    if design.answers and not design.catch:
        sentences.append(
            "there are no catch trials: who does not attend is told by the answers alone; add "
            "[[catch]] with a surface that everybody tells"
        )
    if reach:
        sentences += [said for name in design.displays for said in _of_display(design, name)]
    return tuple(sentences)


def predicted_depth(design: StudyDesign, observer: Observer) -> si.Dimensionless | None:
    """Change of relative friction (1) of a square grating with the period of a design's first
    textured stimulus that the observer tells from a flat surface in 75 % of two intervals, by a
    display without limits; infinite where no depth is felt; None without such a stimulus.
    Source: `physics.perception.senses`."""
    textured = [stimulus for stimulus in design.stimuli if stimulus.name != design.reference]
    if not textured or math.isnan(textured[0].period):
        return None
    pad = FingerpadDynamics.pressed(observer.normal_force)
    # A relative depth hardly depends on the mean.
    rubbed = Rubbed(MEAN_FRICTION * observer.normal_force, pad, observer.speed)
    square = np.repeat([[0.5, -0.5]], 128, axis=1)
    period = np.array([textured[0].period])
    return float(D_PRIME_OF_75 * detected_share(observer, period, square, rubbed)[0])


def _of_range(design: StudyDesign, observer: Observer) -> list[str]:
    """Doubt of differences from the reference that do not bracket the predicted threshold."""
    task, ends = design.described, design.differences
    if task.model is None or not design.on_a_scale:
        return []
    if task.reference == "flat":
        predicted = predicted_depth(design, observer) if design.judged == "friction_depth" else None
    elif design.in_amounts:
        return []
    else:
        predicted = predicted_fraction(design, observer)
        ends = [math.expm1(difference) for difference in ends]
    if predicted is None:
        return []
    least = "from the reference" if design.reference else "between two surfaces"
    if math.isinf(predicted):
        return [f"no depth of the first stimulus' period is felt ('{observer.name}'); take another"]
    threshold = f"the predicted threshold of {si.percent(predicted, 1)} ('{observer.name}')"
    if min(ends) > predicted:
        return [
            f"the least difference {least}, {si.percent(min(ends), 1)}, is above "
            f"{threshold}: most people tell all of them; add smaller ones"
        ]
    if max(ends) < predicted:
        return [
            f"the greatest difference {least}, {si.percent(max(ends), 1)}, is below "
            f"{threshold}: most people tell none of them; add larger ones"
        ]
    return []


def _of_display(design: StudyDesign, name: str) -> list[str]:
    """The stimuli, a series' farthest comparison too, that ask for less friction than a display
    makes."""
    # It solves a plate, which a plan without it need not load.
    from squeezefilm.physics.chain.prediction import predict

    least = float(predict(load_display(name)).relative_friction)
    chosen = [design.comparison(series, series.highest) for series in design.adaptive]
    every = [*design.stimuli, *(trial.stimulus for trial in design.catch), *chosen]
    lacking = [surface for surface in every if not surface.texture and surface.low < least]
    if not lacking:
        return []
    asked = ", ".join(f"'{stimulus.name}' for {stimulus.low:.3g}" for stimulus in lacking)
    return [
        f"'{name}' reaches a relative friction of {least:.3g} at its largest amplitude, and the "
        f"design asks it: {asked}; take shallower surfaces, or another display"
    ]
