"""Paired comparison of all pairs and ranking: strengths beside another algorithm's, known people
found again, a session of each from its plan to its page, and what is refused."""

from __future__ import annotations

import dataclasses
import itertools
import math
from pathlib import Path

import numpy as np
import pytest

from squeezefilm.core.errors import ConfigError, InputError
from squeezefilm.study.design.plan import plan_study
from squeezefilm.study.design.study_design import StudyDesign, load_design
from squeezefilm.study.design.tasks.surfaces import PAIRED_COMPARISON, RANKING
from squeezefilm.study.design.tasks.task import Percepts
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.record.foreign import read_answers
from squeezefilm.study.report.page import write_study
from squeezefilm.study.report.words import read_first
from squeezefilm.study.simulated.planned_power import pair_scores
from squeezefilm.study.simulated.planned_precision import person_values
from squeezefilm.study.tasks.analyze import analyze_answers
from squeezefilm.study.tasks.findings import TaskAnalysis
from squeezefilm.study.tasks.scales import fitted, likelihood, strengths

PAIRS, ORDERS = load_design("period-pairs"), load_design("period-ranking")
SLOPE = 6.0


def made_up(design: StudyDesign, people: int, seed: int, slope: float = SLOPE) -> Answers:
    """Answers of people who order surfaces by ln period, times a slope, with Gumbel's noise: which
    makes Luce's choices."""
    random = np.random.default_rng(seed)
    plans = [[t for t in s if t.asks] for s in plan_study(design, people).schedules]
    rows = [trial for plan in plans for trial in plan]
    surfaces = (*design.stimuli, *(one.stimulus for one in design.catch))
    number = {one.name: k for k, one in enumerate(surfaces)}
    shown = np.array([[number[name] for name in trial.stimuli] for trial in rows]).T
    nothing, none = np.full(len(rows), np.nan), np.full(len(rows), -1)
    logs = slope * np.log([one.period for one in surfaces])
    order = np.argsort(-(logs[shown] + random.gumbel(size=shown.shape)), axis=0)
    ranks = [tuple(row) for row in order.T.tolist()]
    right = [(*design.answers, "").index(trial.answer) for trial in rows]
    return Answers(
        design=design,
        origin="made up",
        people=tuple(f"p{k}" for k in range(people)),
        surfaces=surfaces,
        participant=np.repeat(np.arange(people), len(plans[0])),
        number=np.array([trial.number for trial in rows]),
        phase=np.array([trial.phase for trial in rows]),
        display=np.zeros(len(rows), dtype=np.int64),
        series=none,
        presented=shown,
        intensity=nothing,
        choice=np.array([design.described.ranks.index(rank) for rank in ranks]),
        right=np.array([-1 if k == len(design.answers) else k for k in right]),
        estimate=nothing,
        response_time=nothing,
    )


def analysed(answers: Answers) -> TaskAnalysis:
    (found,) = analyze_answers(answers, "made up").values()
    assert isinstance(found, TaskAnalysis)
    return found


def by_minorisation(order: np.ndarray, size: int) -> np.ndarray:
    """Strengths by Hunter's MM algorithm (2004, 10.1214/aos/1079120141), in plain loops."""
    w = np.ones(size)
    for _ in range(4000):
        wins, held = np.zeros(size), np.zeros(size)
        for places in order.T.tolist():
            for at in range(len(places) - 1):
                left = places[at:]
                wins[left[0]] += 1
                for one in left:
                    held[one] += 1 / sum(w[k] for k in left)
        new = wins / held
        new /= np.exp(np.log(new).mean())
        if np.abs(new - w).max() < 1e-12:
            break
        w = new
    return w


@pytest.mark.parametrize("design", [PAIRS, ORDERS])
def test_strengths_are_those_of_another_algorithm(design: StudyDesign) -> None:
    main = made_up(design, 3, 1).main(0)
    found, notes = strengths(main, 0.95)
    assert notes == []
    shown, order = np.unique(main.in_order, return_inverse=True)
    expected = by_minorisation(order.reshape(main.presented.shape), shown.size)
    values = {one.name: one.magnitude.value for one in found if one.magnitude is not None}
    for place, surface in enumerate(shown):
        assert values[main.surfaces[surface].name] == pytest.approx(expected[place], rel=1e-5)


@pytest.mark.slow
def test_strengths_of_pairs_are_those_of_a_logistic_regression() -> None:
    api = pytest.importorskip("statsmodels.api")
    main = made_up(PAIRS, 6, 2).main(0)
    first, then = main.presented
    ids = np.unique(main.presented)
    rows = np.arange(main.trials)
    terms = np.zeros((main.trials, ids.size))
    terms[rows, np.searchsorted(ids, first)] += 1
    terms[rows, np.searchsorted(ids, then)] -= 1
    fit = api.Logit(main.choice == 0, terms[:, 1:]).fit(
        disp=0, cov_type="cluster", cov_kwds={"groups": main.participant, "df_correction": True}
    )
    logs = np.append(0.0, fit.params)
    found = {one.name: one.magnitude for one in strengths(main, 0.95)[0]}
    mine = [found[main.surfaces[k].name] for k in ids]
    values = np.log([one.value for one in mine if one is not None])
    assert values == pytest.approx(logs - logs.mean(), abs=1e-5)
    away = np.eye(ids.size)[1:] - 1 / ids.size
    own = np.sqrt(np.diag(away.T @ fit.cov_params() @ away))
    reach = [math.log(one.high / one.low) / 2 for one in mine if one is not None]
    # Its correction for few parameters is another: (n - 1)/(n - k).
    ratio = np.array(reach) / own
    assert ratio == pytest.approx(np.full(ids.size, ratio[0]), rel=1e-4)
    assert ratio[0] == pytest.approx(2.5706, rel=0.02)


def test_derivatives_and_information_are_those_of_the_likelihood() -> None:
    random = np.random.default_rng(4)
    order = np.array([random.permutation(5)[:3] for _ in range(40)]).T
    logs, h = random.standard_normal(5), 1e-5
    _, scores, information = likelihood(order, logs)
    steps = h * np.eye(5)
    slope = [(likelihood(order, logs + s)[0] - likelihood(order, logs - s)[0]) / (2 * h)
             for s in steps]  # fmt: skip
    bend = [(likelihood(order, logs - s)[1] - likelihood(order, logs + s)[1]).sum(axis=0) / (2 * h)
            for s in steps]  # fmt: skip
    assert scores.sum(axis=0) == pytest.approx(slope, abs=1e-6)
    assert information == pytest.approx(np.array(bend), abs=1e-6)


@pytest.mark.parametrize("design", [PAIRS, ORDERS])
def test_known_people_come_back_to_their_page(design: StudyDesign, tmp_path: Path) -> None:
    answers = made_up(design, 8, 3)
    found = analysed(answers)
    logs = SLOPE * np.log([one.period for one in design.stimuli])
    truth = dict(zip([one.name for one in design.stimuli], np.exp(logs - logs.mean()), strict=True))
    for one in found.conditions:
        assert one.magnitude is not None
        # Of ten intervals of 95 % one may miss; how many do is counted below.
        assert one.magnitude.value == pytest.approx(truth[one.name], rel=0.4)
        assert 1.1 * one.magnitude.low < one.magnitude.high < 4 * one.magnitude.low
    assert found.pooled is not None
    # A logistic difference of 75 % is ln 3.
    wanted = SLOPE if design is ORDERS else math.expm1(math.log(3) / SLOPE)
    assert found.pooled.low < wanted < found.pooled.high
    assert found.screening is not None
    assert not found.screening.named
    assert "Bradley and Terry" in found.methods
    assert "Put first most often: 7.5 mm" in read_first(found)[1]
    page = write_study(found, tmp_path / "page").read_text(encoding="utf-8")
    assert "Strength" in page
    scores = pair_scores(answers, "4 mm", "7.5 mm")
    assert scores.mean() > 0.3
    assert person_values(answers.main(0))[0] == found.measure


def test_intervals_hold_the_strengths_as_often_as_they_say() -> None:
    held, logs = [], SLOPE * np.log([one.period for one in PAIRS.stimuli])
    truth = dict(zip([one.name for one in PAIRS.stimuli], np.exp(logs - logs.mean()), strict=True))
    for seed in range(40):
        for one in strengths(made_up(PAIRS, 8, seed).main(0), 0.9)[0]:
            assert one.magnitude is not None
            held.append(one.magnitude.low < truth[one.name] < one.magnitude.high)
    assert np.mean(held) == pytest.approx(0.9, abs=0.07)


def test_who_mixes_the_order_up_is_named() -> None:
    answers = made_up(ORDERS, 6, 5)
    turned = np.where(answers.participant == 2, 5 - answers.choice, answers.choice)
    found = analysed(dataclasses.replace(answers, choice=turned))
    assert found.screening is not None
    assert [one.person for one in found.screening.named] == ["p2"]


def test_a_surface_that_always_wins_has_no_bound_and_that_is_said() -> None:
    answers = made_up(PAIRS, 4, 6, slope=400.0)
    found = analysed(answers)
    assert any("always put before all others" in note for note in found.notes)
    for one in found.conditions:
        assert one.magnitude is not None
        assert 0 < one.magnitude.low < one.magnitude.value < one.magnitude.high < math.inf
    values, _, information = fitted(np.array([[0, 0], [1, 1]]), np.eye(2), True)
    assert np.isfinite(values).all()
    assert information[0, 0] > 1 / 16


def test_surfaces_without_an_amount_have_strengths_alone(tmp_path: Path) -> None:
    shapes = load_design("shapes-match").stimuli[:4]
    for task, answer in (("paired-comparison", "first"), ("ranking", "213")):
        design = dataclasses.replace(PAIRS, task=task, stimuli=shapes, catch=(), practice=0)
        plan = plan_study(design, 5)
        rows = ["participant_id,stimulus,second_stimulus,third_stimulus,choice,response_time_s"]
        random = np.random.default_rng(7)
        for who, schedule in enumerate(plan.schedules):
            for trial in schedule:
                said = answer if random.random() < 0.6 else random.choice(design.answers)
                names = [*trial.stimuli, ""][:3]
                rows.append(f"p{who},{','.join(names)},{said},{random.uniform(1, 3):.4f}")
        file = tmp_path / f"{task}.csv"
        file.write_text("\n".join(rows) + "\n", "utf-8")
        found = analysed(read_answers(file, design))
        assert found.pooled is None
        assert found.measure == "strength"
        assert len(found.conditions) == 4
        assert any("no amount" in note for note in found.notes)
        text = write_study(found, tmp_path / task).read_text(encoding="utf-8")
        assert "Put first most often" in text
        assert ">nan<" not in text


def test_every_surface_meets_every_other_as_often_in_each_place() -> None:
    assert sorted(PAIRS.conditions) == sorted(
        itertools.permutations([one.name for one in PAIRS.stimuli], 2)
    )
    assert len(ORDERS.conditions) == 30
    for place in range(3):
        names = [condition[place] for condition in ORDERS.conditions]
        assert {names.count(name) for name in names} == {6}


def test_a_catch_trial_has_its_surface_and_others_have_all() -> None:
    for task, number in ((PAIRED_COMPARISON, 4), (RANKING, 3)):
        caught = list(task.conditions("caught", ("one", "two")))
        assert len(caught) == number
        assert all("caught" in names for names in caught)
        assert list(task.conditions("one", ("one", "two", "three"))) == list(
            task.conditions("", ("one", "two", "three"))
        )
    one, other = PAIRS.stimuli[:2]
    assert PAIRED_COMPARISON.right((one, other), lambda s: s.period) == "second"
    assert PAIRED_COMPARISON.right((one, other), lambda _: math.nan) == ""


def test_percepts_are_put_in_their_order() -> None:
    level = np.array([[1.0, 3.0], [2.0, 2.0], [3.0, 1.0]])
    assert RANKING.decides is not None
    given = RANKING.decides(Percepts(level, np.ones((3, 2), dtype=bool), np.ones(2), 1.0))
    assert [RANKING.answers[k] for k in given.choice] == ["321", "123"]


def test_what_cannot_be_ordered_is_refused() -> None:
    for design in (PAIRS, ORDERS):
        with pytest.raises(InputError, match="three or more"):
            dataclasses.replace(design, catch=(), stimuli=design.stimuli[:2])
    with pytest.raises(InputError, match="adaptive series compare with a reference"):
        dataclasses.replace(PAIRS, adaptive=load_design("period-jnd").adaptive)


def test_a_surface_compared_with_itself_is_refused_by_its_line(tmp_path: Path) -> None:
    file = tmp_path / "answers.csv"
    file.write_text(
        "participant_id,stimulus,second_stimulus,choice\nanna,4 mm,4 mm,first\n", "utf-8"
    )
    with pytest.raises(ConfigError, match="compared with itself"):
        read_answers(file, PAIRS)
