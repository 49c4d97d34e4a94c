"""Doubts of a design before anybody is asked: its range, its displays, its attention."""

from __future__ import annotations

import math

from squeezefilm.core import quantities as si
from squeezefilm.physics.display import load_display
from squeezefilm.physics.perception.observer import Observer
from squeezefilm.physics.perception.stimuli import Stimulus
from squeezefilm.study.design.study_design import StudyDesign


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


def _of_range(design: StudyDesign, observer: Observer) -> list[str]:
    """Doubt of differences from the reference that do not bracket the predicted threshold."""
    fraction = predicted_fraction(design, observer)
    if not design.compares or not design.on_a_scale or fraction is None:
        return []
    if design.adaptive:
        ends = [x for series in design.adaptive for x in (series.lowest, series.highest)]
    else:
        here = design.judged_value(design.stimulus(design.reference))
        others = [stimulus for stimulus in design.stimuli if stimulus.name != design.reference]
        logs = [abs(math.log(design.judged_value(other) / here)) for other in others]
        ends = [math.expm1(log) for log in logs]
    threshold = f"the predicted threshold of {_percent(fraction)} ('{observer.name}')"
    if min(ends) > fraction:
        return [
            f"the least difference from the reference, {_percent(min(ends))}, is above "
            f"{threshold}: most people tell all of them; add smaller ones"
        ]
    if max(ends) < fraction:
        return [
            f"the greatest difference from the reference, {_percent(max(ends))}, is below "
            f"{threshold}: most people tell none of them; add larger ones"
        ]
    return []


def _of_display(design: StudyDesign, name: str) -> list[str]:
    """The stimuli that ask for less friction than a display makes."""
    # It solves a plate, which a plan without it need not load.
    from squeezefilm.physics.chain.prediction import predict

    least = float(predict(load_display(name)).relative_friction)
    lacking = [one for one in _presented(design) if not one.texture and one.low < least]
    if not lacking:
        return []
    asked = ", ".join(f"'{stimulus.name}' for {stimulus.low:.3g}" for stimulus in lacking)
    return [
        f"'{name}' reaches a relative friction of {least:.3g} at its largest amplitude, and the "
        f"design asks it: {asked}; take shallower surfaces, or another display"
    ]


def _percent(share: si.Dimensionless) -> str:
    return f"{100 * share:.3g} %"


def _presented(design: StudyDesign) -> list[Stimulus]:
    """Every surface that may be presented, a series' farthest comparison too."""
    chosen = [design.comparison(series, series.highest) for series in design.adaptive]
    return [*design.stimuli, *(trial.stimulus for trial in design.catch), *chosen]
