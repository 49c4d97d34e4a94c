"""Screening of people who do not do the task by a design's rule, before answers are pooled.

A person's trials are compared under three models: of somebody who does the task (a cumulative
Gaussian of the difference, a bias or criterion, 4 % of lapses; among names: somebody who knows a
share of the answers), of the same somebody with the answers mixed up, and of somebody who answers
with a fixed probability whatever is presented. The signed root of twice the difference of their
largest log likelihoods is near a standard normal deviate z for somebody who guesses, so that a
rule on it has a known error. Sums over trials give all parts of the session at once: a person who
changed on the way is found where one model before a trial and another one after it is far likelier
than one for all.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri

from squeezefilm.core import quantities as si
from squeezefilm.study.design.rules import ExclusionRule
from squeezefilm.study.design.study_design import StudyDesign
from squeezefilm.study.identification.condition_means import attention
from squeezefilm.study.psychometric.estimate import Estimate
from squeezefilm.study.record.answers import Answers

_LAPSE = 0.04
_SPREADS, _PLACES, _GUESSES = 24, 21, 13
_LEAST_PART, _LEAST_TRIALS, _LEAST_PEOPLE = 10, 12, 3
_ABOVE_CHANCE = 1.6448536269514722
_BY_CHANCE = 0.05
# Assumed: of honest people few have less ("named" in tests/recovery/test_task_recovery.py).
_OF_MEDIAN = 1 / 3
_SURE = 3.0
"""Least ln ratio by which lapses beyond the rule's must be likelier."""


@dataclass(frozen=True, slots=True)
class PersonJudgement:
    """Judgement of one person on one display by the rule.

    Attributes:
        person: the pseudonym.
        trials: main trials answered.
        follows: signed root of the likelihood ratio of following the surfaces against guessing
            (1): a standard normal deviate for who guesses, negative for answers mixed up.
        reasons: why the person counts as not doing the task; empty for somebody who does it.
        doubts: what is remarkable and excludes nobody.
    """

    person: str
    trials: int
    follows: si.Dimensionless
    reasons: tuple[str, ...]
    doubts: tuple[str, ...] = ()


_Models = tuple[si.FloatArray, si.FloatArray, si.FloatArray]


@dataclass(frozen=True, slots=True)
class Screening:
    """A display's main number with and without people who do not do the task.

    Attributes:
        rule: of the design.
        people: everybody, judged.
        results: the main number (Weber fraction, exponent, d′ or share of right answers) of
            "everybody", "without those named", and "robust, everybody".
        said: of all people together; empty for nothing.
    """

    rule: ExclusionRule
    people: tuple[PersonJudgement, ...]
    results: Mapping[str, Estimate]
    said: str

    @property
    def left_out(self) -> bool:
        """True where those named are left out of the results that are quoted."""
        return self.rule.action == "exclude" and "without those named" in self.results

    @property
    def named(self) -> tuple[PersonJudgement, ...]:
        """People who do not do the task by the rule."""
        return tuple(person for person in self.people if person.reasons)

    @property
    def left_out_sentence(self) -> str:
        """Sentence of a methods section about who was left out; empty for nobody."""
        if not self.left_out:
            return ""
        many = "participant was" if len(self.named) == 1 else "participants were"
        return f" By the rule of the design {len(self.named)} more {many} left out."


def rule_of(design: StudyDesign) -> ExclusionRule:
    """The design's rule, or the one that marks where it has none."""
    return design.exclusion or ExclusionRule()


def judged_people(answers: Answers, display: int) -> tuple[tuple[PersonJudgement, ...], str]:
    """Judgements of all who answered main trials on a display (number in the design's order), by
    the design's rule, and what must be said of all of them; empty for nothing.

    Somebody is at chance whose z is below what the rule asks, or below a third of the median over
    people where that is less: few trials, or small differences, tell nobody so surely. Where the
    median itself is not above chance, where there are fewer than three people, or where the task is
    match-to-sample, being at chance may be what there is to be found out about the display: it is
    then a doubt and no reason. So it is of somebody who has all catch trials right: who feels
    little does the task, and without them people would seem more sensitive than they are.
    """
    main, rule = answers.main(display), rule_of(answers.design)
    caught = answers.take((answers.display == display) & (answers.phase == "catch"))
    missed = {person.person: person for person in attention(caught)}
    people = [main.take(main.participant == person) for person in np.unique(main.participant)]
    # Surfaces without an amount are in no order that somebody could follow.
    by_amount = main.design.on_a_scale or not main.design.described.ranks
    # Runs go where the answers lead, so that these say little of whether they follow.
    by_amount = by_amount and not any(series.in_runs for series in main.design.adaptive)
    models = [_models(mine) if main.design.answers and by_amount else () for mine in people]
    follows = [_follows(mine, model) for mine, model in zip(people, models, strict=True)]
    middle, asked = float(np.median(follows)), -float(ndtri(rule.chance))
    excused, said = main.design.task == "match-to-sample" or len(people) < _LEAST_PEOPLE, ""
    if len(people) >= _LEAST_PEOPLE and abs(middle) < _ABOVE_CHANCE:
        excused = True
        said = (
            "most people are not above chance: that speaks of the surfaces, and nobody is left out "
            "for it"
        )
    elif middle < 0:
        said = (
            "most people's answers are mixed up: the names of the answers may be exchanged in the "
            "file, which values can say"
        )
    if not excused:
        asked = min(asked, _OF_MEDIAN * abs(middle))
    whole = min(max(mine.trials for mine in people), answers.design.most_main_trials)
    judgements = []
    for mine, model, z in zip(people, models, follows, strict=True):
        name = mine.people[int(mine.participant[0])]
        reasons, doubts = _habits(mine), []
        if model:
            reasons += _changed(mine, model)
        if mine.trials < _LEAST_TRIALS and model:
            doubts.append(f"{mine.trials} trials are too few to tell guessing from doing the task")
        elif z < -asked:
            reasons.insert(0, f"answers are mixed up (z = {z:.1f})")
        elif z < asked:
            chance = f"answers do not follow the surfaces (z = {z:.1f}; {asked:.1f} is asked)"
            kept = excused or (bool(model) and _tells_catch_trials(mine, caught))
            (doubts if kept and not reasons else reasons).append(chance)
        catch = missed.get(name)
        if catch is not None and catch.p_value < rule.catch:
            reasons.append(f"{catch.right} of {catch.asked} catch trials right")
        if mine.trials < rule.complete * whole:
            reasons.append(f"{mine.trials} of {whole} trials answered")
        judgements.append(PersonJudgement(name, mine.trials, z, tuple(reasons), tuple(doubts)))
    return tuple(judgements), said


def _tells_catch_trials(mine: Answers, caught: Answers) -> bool:
    """True for somebody who has all catch trials right, and so many that answers which are given as
    often whatever is presented would seldom be."""
    own = caught.take((caught.participant == mine.participant[0]) & (caught.right >= 0))
    names = len(mine.design.answers)
    shares = (np.bincount(mine.choice, minlength=names) + 0.5) / (mine.trials + 0.5 * names)
    by_chance = float(np.prod(shares[own.right]))
    return bool(np.all(own.choice == own.right)) and by_chance <= _BY_CHANCE


def _habits(mine: Answers) -> list[str]:
    """Habits of somebody's answers that have nothing to do with the surfaces."""
    rule, names, reasons = rule_of(mine.design), mine.design.answers, []
    if not names and mine.trials > 2 and np.unique(mine.estimate).size == 1:
        reasons.append(f"gives the number {mine.estimate[0]:g} to everything")
    if names and mine.trials >= _LEAST_TRIALS:
        counts = np.bincount(mine.choice, minlength=len(names))
        most, share = int(counts.argmax()), float(counts.max() / mine.trials)
        alternates = float(np.mean(np.diff(mine.choice) != 0))
        if share >= rule.one_answer and np.mean(mine.right == most) < 0.8 * share:
            reasons.append(f"answers “{names[most]}” in {si.percent(share)}")
        elif len(names) == 2 and alternates >= rule.one_answer:
            reasons.append(f"alternates the answers in {si.percent(alternates)}")
    times = mine.response_time[np.isfinite(mine.response_time)]
    if times.size and (fast := float(np.mean(times < rule.fastest))) > rule.fast:
        reasons.append(f"{si.percent(fast)} of the answers within {rule.fastest:g} s")
    return reasons


def _models(mine: Answers, lapse: float = _LAPSE) -> _Models:
    """ln likelihood of each trial's answer by who does the task, who mixes up the answers, and who
    guesses, each of shape (trials, models)."""
    model = mine.design.described.model
    if model is None or model.counts < 0:
        return _among_names(mine)
    shown = mine.presented
    x = mine.differences if mine.design.on_a_scale else (shown[0] != shown[-1]).astype(float)
    y = mine.told
    reach = max(float(np.abs(x).max()), 1e-9)
    least = float(np.abs(x[x != 0]).min()) if np.any(x) else reach
    least_place, most_place = model.criteria[[0, -1]] if model.rate is None else (-1.0, 1.5)
    places = np.linspace(least_place, most_place, _PLACES) * reach
    spreads = np.geomspace(least / 4, 8 * reach, _SPREADS)
    place, spread = (axis.ravel() for axis in np.meshgrid(places, spreads))
    rise = ndtr((x[:, None] - place) / spread)
    p = 0.5 * lapse + (1 - lapse) * rise
    said = y[:, None]
    task, turned = np.log(np.where(said, p, 1 - p)), np.log(np.where(said, 1 - p, p))
    guesses = np.linspace(0.5 * _LAPSE, 1 - 0.5 * _LAPSE, _GUESSES)
    return task, turned, np.log(np.where(said, guesses, 1 - guesses))


def _among_names(mine: Answers) -> _Models:
    """The same of names: a share of the answers is known, the others follow a person's own
    frequencies; mixed up is the scale from its other end."""
    names = len(mine.design.answers)
    own = (np.bincount(mine.choice, minlength=names) + 0.5) / (mine.trials + 0.5 * names)
    guess = own[mine.choice][:, None]
    known = np.linspace(0.0, 1 - _LAPSE, _SPREADS)
    right, mirrored = (
        (mine.choice == name)[:, None] for name in (mine.right, names - 1 - mine.right)
    )
    # Who has the middle of an odd scale right is not mixed up by it.
    mirrored = mirrored & ~right
    task, turned = (np.log(known * hit + (1 - known) * guess) for hit in (right, mirrored))
    return task, turned, np.log(guess)


def _best(logs: si.FloatArray) -> float:
    return float(logs.sum(axis=0).max())


def _follows(mine: Answers, models: _Models | tuple[()]) -> float:
    """z of following the surfaces."""
    if not models:
        return _numbers_follow(mine) if not mine.design.answers else math.nan
    task, turned, guess = (_best(model) for model in models)
    return math.sqrt(2 * max(max(task, turned) - guess, 0.0)) * (1 if task >= turned else -1)


def _changed(mine: Answers, models: _Models) -> list[str]:
    """Doubts of a part of the session, from its begin or to its end, guessed or mixed up; or
    all of it has more lapses than the rule allows."""
    rule, said = rule_of(mine.design), []
    whole = max(_best(model) for model in models)
    least = max(_LEAST_PART, mine.trials // 4)
    at = np.arange(least, mine.trials - least + 1)
    if at.size:
        sums = [
            np.concatenate([np.zeros((1, model.shape[1])), model.cumsum(axis=0)])
            for model in models
        ]
        before = [values[at].max(axis=1) for values in sums]
        after = [(values[-1] - values[at]).max(axis=1) for values in sums]
        # Who shifts a criterion on the way is as sharp as before.
        sharp = sums[0].reshape(len(sums[0]), _SPREADS, -1)
        shifted = sharp[at].max(axis=2) + (sharp[-1] - sharp[at]).max(axis=2)
        one_for_all = np.maximum(whole, shifted.max(axis=1))
        gains = {
            words.format(part): gain - one_for_all
            for kind, words in (
                (1, "answers are mixed up {} of " + f"{mine.trials}"),
                (2, "answers do not follow the surfaces {} of " + f"{mine.trials}"),
            )
            for part, gain in (
                ("after trial {}", before[0] + after[kind]),
                ("up to trial {}", before[kind] + after[0]),
            )
        }
        words, gain = max(gains.items(), key=lambda pair: float(pair[1].max()))
        if gain.max() > rule.turned:
            said.append(words.format(int(at[gain.argmax()])))
    if len(models[0][0]) == _PLACES * _SPREADS:
        usual, many = (
            max(_best(_models(mine, times * rule.lapses)[0]) for times in pair)
            for pair in ((0.5, 1.0), (1.5, 2.0))
        )
        if many - max(whole, usual) > _SURE:
            said.append(f"lapses in more than {si.percent(rule.lapses)} of the trials")
    return said


def _numbers_follow(mine: Answers) -> float:
    """Fisher's z of the correlation of given numbers with what is judged, over its error."""
    x, y = np.log(mine.values[mine.presented[0]]), np.log(mine.estimate)
    if mine.trials < 4 or not (np.ptp(x) > 0 and np.ptp(y) > 0):
        return 0.0
    r = min(max(float(np.corrcoef(x, y)[0, 1]), -1 + 1e-12), 1 - 1e-12)
    return math.atanh(r) * math.sqrt(mine.trials - 3)
