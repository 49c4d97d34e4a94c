"""An adaptive method stopped at any trial and played again goes on as if it had not been."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from squeezefilm.study.adaptive.bayesian import AdaptiveDesign, BayesianAdaptive
from squeezefilm.study.adaptive.staircase import Staircase, StaircaseRule
from squeezefilm.study.psychometric.function import PsychometricPrior

answers = st.lists(st.booleans(), min_size=1, max_size=40)


@st.composite
def rules(draw: st.DrawFn) -> StaircaseRule:
    step = draw(st.floats(0.01, 1.0))
    return StaircaseRule(
        start=draw(st.floats(1.0, 9.0)),
        step=step,
        smallest_step=step * draw(st.floats(0.01, 1.0)),
        down_after=draw(st.integers(1, 4)),
        lowest=draw(st.one_of(st.just(0.5), st.just(-float("inf")))),
        highest=draw(st.one_of(st.just(9.5), st.just(float("inf")))),
        axis=draw(st.sampled_from(["linear", "log"])),
        most_trials=draw(st.integers(2, 41)),
    )


@given(rules(), answers, st.integers(0, 40), st.booleans())
def test_a_staircase_resumes_where_it_stopped(
    rule: StaircaseRule, given_answers: list[bool], stop: int, rounded: bool
) -> None:
    whole, part = Staircase(rule), Staircase(rule)
    for trial, answer in enumerate(given_answers):
        if trial == stop:
            part = Staircase(rule)
            for one in whole.trials:
                part.update(one.intensity, one.correct)
        assert part.finished == whole.finished
        if whole.finished:
            break
        assert part.next_stimulus() == whole.next_stimulus()
        low, high = rule.lowest, rule.highest
        assert low <= whole.next_stimulus() <= high
        # What was shown may not be just what was asked for.
        shown = round(whole.next_stimulus(), 1) if rounded else whole.next_stimulus()
        for stairs in (whole, part):
            stairs.update(shown, answer)
    assert part.trials == whole.trials


@given(
    answers,
    st.integers(0, 40),
    st.sampled_from(["threshold and width", "all"]),
    st.sampled_from([("logistic", "linear"), ("weibull", "log"), ("gumbel", "linear")]),
)
@settings(settings.get_profile("dear"))
def test_a_bayesian_choice_resumes_where_it_stopped(
    given_answers: list[bool], stop: int, interest: str, kind: tuple[str, str]
) -> None:
    design = AdaptiveDesign(
        tuple(np.geomspace(1.0, 10.0, 9)),
        PsychometricPrior((1.5, 9.0), (0.5, 3.0)),
        shape=kind[0],  # type: ignore[arg-type]
        axis=kind[1],  # type: ignore[arg-type]
        cells=(10, 6, 3),
        interest=interest,  # type: ignore[arg-type]
        most_trials=41,
    )
    whole, part = BayesianAdaptive(design), BayesianAdaptive(design)
    for trial, answer in enumerate(given_answers):
        if trial == stop:
            part = BayesianAdaptive(design)
            for one in whole.trials:
                part.update(one.intensity, one.positive)
        assert part.next_stimulus() == whole.next_stimulus()
        for method in (whole, part):
            method.update(method.next_stimulus(), answer)
    assert np.array_equal(part.probability, whole.probability)
