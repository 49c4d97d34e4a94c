"""What a task measures, of each person, of the population, and by condition.

Between surfaces that have no amount to compare (shapes, maps, directions) there is no threshold:
each pair has its d′, and each person one over all pairs, from the same "same" trials.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import mstats

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.study.adaptive.series import adaptive_method
from squeezefilm.study.adaptive.staircase import Staircase
from squeezefilm.study.identification.confusion import proportion_interval
from squeezefilm.study.psychometric.discrimination import MODELS, corrected_proportion, sensitivity
from squeezefilm.study.psychometric.estimate import Estimate, student, t_interval
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.findings import ConditionFinding, Measured, PersonEstimate, through
from squeezefilm.study.tasks.scales import (
    exponents,
    magnitude_conditions,
    of_exponents,
    rank_exponents,
    strengths,
)
from squeezefilm.study.tasks.thresholds import on_grid, settings_of

MEASURE = "sensitivity d′"
Rows = NDArray[np.bool_] | si.IntArray
Tell = Callable[[str], None]


def measured(main: Answers, level: float, seed: int, tell: Tell) -> Measured:
    """Results of the analysis that the answers' task has, with a robust number where there is one.

    `level` is of the intervals (1), `seed` of resampling; `tell` hears each step.
    """
    task = main.design.described
    analysis = _magnitudes if task.model is None else _by_difference
    if task.ranks:
        analysis = _ranked
    elif any(series.in_runs for series in main.design.adaptive):
        analysis = settings_of
    found = analysis(main, level, seed, tell)
    return replace(found, robust=found.robust or _trimmed(found.persons, level))


def comparisons(main: Answers) -> tuple[si.IntArray, NDArray[np.bool_]]:
    """The surface that each trial compares with the reference (−1 where all are alike; the only
    one of one), and whether the answer is what is counted: that it has more, where two are
    ordered."""
    shown, ordered = main.presented, main.model.rate is None
    if len(shown) == 1:
        return shown[0], main.told
    names = [surface.name for surface in main.surfaces]
    here = names.index(main.design.reference) if main.design.reference in names else -1
    alike = (shown == shown[0]).all(axis=0)
    other = np.where(alike, -1, np.where(shown != here, shown, -1).max(axis=0))
    return other, (main.told == (shown[0] == other)) if ordered else main.told


def condition_findings(
    main: Answers, level: si.Dimensionless, seed: int
) -> tuple[ConditionFinding, ...]:
    """Each comparison: how often the counted answer was given to it, and its d′; where series
    chose them, eighths of the trials by their difference."""
    if (main.series >= 0).any():
        return _eighths(main, level)
    other, hit = comparisons(main)
    findings = []
    for surface in sorted(np.unique(other), key=lambda k: -math.inf if k < 0 else main.values[k]):
        rows = other == surface
        name, value = "the same", main.design.reference_value
        if surface >= 0:
            name, value = main.surfaces[surface].name, float(main.values[surface])
        is_other = surface >= 0 and name != main.design.reference
        d = _d_prime(main, rows, level, seed) if is_other else None
        findings.append(_finding(main, name, value, rows, hit, level, d))
    return tuple(findings)


def _eighths(main: Answers, level: si.Dimensionless) -> tuple[ConditionFinding, ...]:
    """Pairs that were the same, and those that a series chose in eighths by their difference,
    whose mean is in parts of the reference, as a series has it."""
    order = np.argsort(main.intensity, kind="stable")
    same = int(np.count_nonzero(main.intensity == 0.0))
    hit = main.correct == 1 if main.design.described.right_is_enough else main.told
    parts = {"the same": order[:same]} if same else {}
    parts |= {
        f"eighth {k + 1} of the differences": part
        for k, part in enumerate(np.array_split(order[same:], 8))
        if part.size
    }
    return tuple(
        _finding(main, name, float(main.intensity[part].mean()), part, hit, level)
        for name, part in parts.items()
    )


def _finding(
    main: Answers,
    name: str,
    value: float,
    rows: Rows,
    hit: NDArray[np.bool_],
    level: si.Dimensionless,
    d_prime: Estimate | None = None,
) -> ConditionFinding:
    """The share of hits in some of the trials, with its interval over trials."""
    hits, trials = int(hit[rows].sum()), int(hit[rows].size)
    share = proportion_interval(hits, trials, level)
    people = int(np.unique(main.participant[rows]).size)
    return ConditionFinding(name, value, trials, people, share, d_prime)


def _d_prime(
    main: Answers, rows: NDArray[np.bool_], level: si.Dimensionless, seed: int
) -> Estimate | None:
    """Mean over people of d′ in some of the trials; None of nobody."""
    if main.model.d_prime is not None:
        return _d_prime_of_right(main, rows, level)
    model, each = MODELS[main.model.sensitivity], _counts(main, rows)
    if len(each) == 1:
        (counts,) = each.values()
        return _over_trials(main, counts, level, seed)
    values = [
        model(corrected_proportion(hits, signals), corrected_proportion(alarms, noises))
        for hits, signals, alarms, noises in each.values()
    ]
    return t_interval(np.array(values), level) if values else None


def _d_prime_of_right(main: Answers, rows: NDArray[np.bool_], level: float) -> Estimate:
    """d′ by the share of right answers alone: mean over people, or of one person's trials."""
    d_prime, hit = main.model.d_prime, main.told
    assert d_prime is not None
    mine = [hit[rows & (main.participant == one)] for one in np.unique(main.participant[rows])]
    if len(mine) == 1:
        share = proportion_interval(int(mine[0].sum()), mine[0].size, level, "Jeffreys")
        return through(share, d_prime)
    shares = [corrected_proportion(int(answers.sum()), answers.size) for answers in mine]
    return t_interval(np.array([d_prime(one) for one in shares]), level)


def _counts(main: Answers, rows: NDArray[np.bool_]) -> dict[int, tuple[int, int, int, int]]:
    """Hits, signals, false alarms and noises of each person who had signals among the rows."""
    hit, other = main.told, comparisons(main)[0]
    if len(main.presented) == 2 and main.model.rate is None:
        # "First" where the first has more, and where the second has.
        signal, noise = rows & (main.right == 0), rows & (main.right == 1)
    else:
        signal, noise = rows, _is_reference(main, other)
    counts = {}
    for person in np.unique(main.participant[signal]).tolist():
        mine = main.participant == person
        hits, alarms = hit[signal & mine], hit[noise & mine]
        if hits.size and alarms.size:
            counts[person] = int(hits.sum()), hits.size, int(alarms.sum()), alarms.size
    return counts


def _over_trials(main: Answers, counts: Sequence[int], level: float, seed: int) -> Estimate:
    hits, signals, alarms, noises = counts
    model = main.model.sensitivity
    return sensitivity(hits, signals, alarms, noises, model, level=level, seed=seed)


def _is_reference(main: Answers, other: si.IntArray) -> NDArray[np.bool_]:
    """True for trials of the reference alone, or of one surface several times."""
    names = np.array([surface.name for surface in main.surfaces])
    return np.asarray((other < 0) | (names[other] == main.design.reference))


def more_numbers(
    main: Answers, biases: list[float], level: si.Dimensionless
) -> dict[str, Estimate]:
    """Bias for an interval, criterion, false alarms and ends of series, as far as the task has
    them, over people; `biases` as `thresholds` has them, none where there is no scale."""
    model, people, numbers = main.model, np.unique(main.participant), false_alarms(main, level)
    if model.criterion and biases:
        numbers[model.criterion] = t_interval(np.array(biases), level)
    if len(main.presented) == 2 and model.rate is None:
        extra = [
            np.mean(main.choice[main.participant == person] == 0)
            - np.mean(main.right[main.participant == person] == 0)
            for person in people
        ]
        numbers["bias for the first interval"] = t_interval(np.array(extra), level)
    for number, series in enumerate(main.design.adaptive):
        if series.method != "staircase":
            continue
        ends_of = [_reversals(main, person, number) for person in people]
        logs = np.log([ends for ends in ends_of if ends])
        if logs.size:
            target = 0.5 ** (1.0 / series.down)
            name = f"reversals of '{series.name}' ({100 * target:.1f} % right)"
            numbers[name] = through(t_interval(logs, level), math.exp)
    return numbers


def _reversals(main: Answers, person: int, series: int) -> float:
    mine = (main.participant == person) & (main.series == series)
    answers = zip(main.intensity[mine].tolist(), (main.correct[mine] == 1.0).tolist(), strict=True)
    method = adaptive_method(main.design.adaptive[series], answers)
    assert isinstance(method, Staircase)
    try:
        return method.threshold()
    except InputError:
        return 0.0


def false_alarms(main: Answers, level: si.Dimensionless) -> dict[str, Estimate]:
    """The share of the counted answer where only the reference was, or both were the same, over
    the people who had such a trial; none where no answer to it is right.

    Student's interval knows nothing of shares: of few people it would reach beyond 0 and 1, where
    no share can be, and is cut there.
    """
    model, answers = main.model, main.design.answers
    alike = _is_reference(main, comparisons(main)[0]) & (main.right >= 0)
    if not alike.any() or model.counts < 0:
        return {}
    shares = [
        np.mean(main.told[alike & (main.participant == person)])
        for person in np.unique(main.participant[alike])
    ]
    found = t_interval(np.array(shares), level)
    # NumPy's keep the NaN of one person.
    low, high = float(np.maximum(found.low, 0.0)), float(np.minimum(found.high, 1.0))
    said = f"{answers[main.right[alike][0]]} called {answers[model.counts]}"
    return {f"false alarms ({said})": replace(found, low=low, high=high)}


def _trimmed(persons: Sequence[PersonEstimate], level: float) -> Estimate | None:
    """The mean of people's values without the fifth at either end, with Yuen's interval (1974,
    10.1093/biomet/61.1.165); None of fewer than five people."""
    values = np.sort([person.estimate.value for person in persons])
    cut = values.size // 5
    if not cut:
        return None
    kept = values.size - 2 * cut
    error = float(mstats.winsorize(values, (cut / values.size,) * 2).std(ddof=1))
    error *= math.sqrt((values.size - 1) / (kept * (kept - 1.0)))
    mean = float(values[cut : values.size - cut].mean())
    return student(mean, error, kept - 1, level, "trimmed by a fifth at either end")


def _by_difference(main: Answers, level: float, seed: int, tell: Tell) -> Measured:
    if not main.design.on_a_scale:
        return _unlike(main, level, seed, tell)
    people = on_grid(main, tell)
    tell("mixed model over people")
    notes: list[str] = []
    persons = people.estimates(level)
    pooled, spread, robust = persons[0].estimate, None, None
    if len(persons) > 1:
        population = people.population
        mean, spread = population.estimate(level)
        pooled, robust = through(mean, math.exp), through(population.robust(level), math.exp)
        # Answers at random go into a criterion where there is one.
        criterion = main.model.criterion
        notes += [note for note in [population.lapse_note] if note and not criterion]
    else:
        notes.append(
            "one participant: the population's interval is theirs, and says nothing of others"
        )
    return Measured(
        main.design.measure,
        tuple(persons),
        pooled,
        spread,
        () if main.design.described.ranks else condition_findings(main, level, seed),
        tuple(notes),
        more_numbers(main, people.bias, level),
        people.functions(persons),
        robust,
    )


def _ranked(main: Answers, level: float, seed: int, tell: Tell) -> Measured:
    """Strengths, beside the threshold or the exponent where surfaces have amounts."""
    tell("strengths of the surfaces")
    conditions, notes = strengths(main, level)
    design = main.design
    if design.on_a_scale and design.described.model is not None:
        found = _by_difference(main, level, seed, tell)
        return replace(found, conditions=conditions, notes=(*found.notes, *notes))
    if design.on_a_scale and not design.in_amounts:
        persons = rank_exponents(main, level)
        pooled, spread = of_exponents(persons, level)
        return Measured("exponent", tuple(persons), pooled, spread, conditions, tuple(notes))
    notes.append(
        f"the surfaces have no amount of {design.judged} with which strengths grow by a power"
    )
    return Measured("strength", (), None, None, conditions, tuple(notes))


def _unlike(main: Answers, level: float, seed: int, tell: Tell) -> Measured:
    """Each person's d′ over all pairs with the interval of their own trials, and the mean over
    people with Student's."""
    tell("sensitivity of each person")
    persons = tuple(
        PersonEstimate(
            main.people[person],
            _over_trials(main, counts, level, seed),
            int((main.participant == person).sum()),
            False,
        )
        for person, counts in _counts(main, comparisons(main)[0] >= 0).items()
    )
    pooled = persons[0].estimate if persons else None
    if len(persons) > 1:
        pooled = t_interval(np.array([person.estimate.value for person in persons]), level)
    conditions = condition_findings(main, level, seed)
    note = (
        f"the surfaces have no {main.design.judged} to be told apart by, so that there is no Weber "
        "fraction: d′ is of whole surfaces"
    )
    more = more_numbers(main, [], level)
    return Measured(MEASURE, persons, pooled, None, conditions, (note,), more)


def _magnitudes(main: Answers, level: float, _seed: int, tell: Tell) -> Measured:
    tell("power law of each person")
    persons, pooled, spread = exponents(main, level)
    conditions, notes = magnitude_conditions(main, level)
    lacking = np.unique(main.participant).size - len(persons)
    if lacking:
        notes.append(
            f"{lacking} {'person has' if lacking == 1 else 'people have'} no line of their own "
            "(fewer than 3 answers, or to one stimulus only) and no share in the exponent"
        )
    if len(persons) == 1:
        notes.append("one line: the interval is of it, and not of a population")
    return Measured("exponent", tuple(persons), pooled, spread, conditions, tuple(notes))
