"""Two intervals, same or different, and magnitudes: what is counted and what it means."""

from __future__ import annotations

import dataclasses
import json
import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy import stats
from tests.recovery.task_people import DESIGNS, Person, analysed, answered, somebody

from squeezefilm.core.errors import InputError
from squeezefilm.study.identification.condition_means import attention, course_of, drift
from squeezefilm.study.psychometric.estimate import t_interval
from squeezefilm.study.record.answers import Answers
from squeezefilm.study.tasks.analyze import analyze_answers, methods_text
from squeezefilm.study.tasks.findings import TaskAnalysis
from squeezefilm.study.tasks.measures import comparisons, false_alarms
from squeezefilm.study.tasks.scales import exponents, magnitude_conditions
from squeezefilm.study.tasks.thresholds import PeopleOnGrid, on_grid

SHARP = Person(0.02, 0.9, 0.0)


def group(name: str, people: int = 3, seed: int = 0) -> tuple[Answers, list[Person]]:
    random = np.random.default_rng(seed)
    drawn = [somebody(random) for _ in range(people)]
    return answered(DESIGNS[name], drawn, random), drawn


@pytest.mark.parametrize("name", DESIGNS)
def test_numbers_are_plain_and_say_whose_they_are(name: str) -> None:
    random = np.random.default_rng(3)
    found = analysed(name, [somebody(random) for _ in range(3)], random)
    data = json.loads(json.dumps(found.summary()))
    assert data["origin"] == found.origin == "made up"
    assert data["participants"] == 3
    assert data["trials"] == found.trials > 100
    assert data["pooled"]["low"] < data["pooled"]["value"] < data["pooled"]["high"]
    assert [one["person"] for one in data["persons"]] == ["p0", "p1", "p2"]
    assert found.to_pandas().shape[0] == len(found.conditions)
    assert found.methods.startswith("3 participants took part on the display 'biet2008-plate'.")


def test_a_sharp_person_has_a_small_weber_fraction_and_every_answer_counts_once() -> None:
    random = np.random.default_rng(1)
    found = analysed("constant", [SHARP, SHARP], random)
    assert all(one.estimate.low < 0.02 * 1.8 for one in found.persons)
    assert sum(one.trials for one in found.conditions) == found.trials
    # Said to have more, of what has least and most.
    shares = [one.share.value for one in found.conditions if one.share is not None]
    assert shares[0] < 0.1
    assert shares[-1] > 0.9
    assert found.standard == pytest.approx(0.3)


def test_the_comparison_is_found_in_either_order() -> None:
    answers, _ = group("constant", 1)
    main = answers.main(0)
    surface, more = comparisons(main)
    names = np.array([one.name for one in main.surfaces])
    assert "30 %" not in set(names[surface])
    first = names[main.presented[0]] != "30 %"
    assert np.array_equal(more, (main.choice == 0) == first)
    apart = main.differences
    bigger = main.values[main.presented[0]] > main.values[main.presented[1]]
    assert np.array_equal(apart > 0, bigger)


def test_a_bias_for_an_interval_is_no_worse_discrimination() -> None:
    random = np.random.default_rng(5)
    fair = on_grid(answered(DESIGNS["constant"], [Person(0.15, 0.9, 0.0)] * 3, random), str)
    biased = on_grid(answered(DESIGNS["constant"], [Person(0.15, 0.9, 0.25)] * 3, random), str)
    assert np.mean(biased.bias) < -0.1 < np.mean(fair.bias) + 0.1
    for people in (fair, biased):
        estimates = people.estimates(0.95)
        assert all(one.estimate.low < 0.15 < one.estimate.high for one in estimates)


def test_trials_decide_nothing_by_their_order() -> None:
    answers, _ = group("same-different", 2)
    main = answers.main(0)
    order = np.random.default_rng(0).permutation(main.trials)
    mixed = dataclasses.replace(
        main,
        **{
            key: getattr(main, key)[..., order]
            for key in ("participant", "presented", "choice", "right", "display", "series")
        },
    )
    one, other = on_grid(main), on_grid(mixed)
    for a, b in zip(one.likelihood, other.likelihood, strict=True):
        assert a == pytest.approx(b)


def test_one_person_has_no_population() -> None:
    random = np.random.default_rng(2)
    for name in DESIGNS:
        found = analysed(name, [somebody(random)], random)
        assert found.spread is None
        assert found.pooled == found.persons[0].estimate
        assert any("one participant" in note or "one line" in note for note in found.notes)


def test_exponents_are_those_of_peoples_own_lines() -> None:
    answers, drawn = group("magnitude", 5)
    main = answers.main(0)
    persons, pooled, spread = exponents(main, 0.95)
    assert pooled is not None
    assert spread is not None
    for one, person in zip(persons, drawn, strict=True):
        mine = main.participant == main.people.index(one.person)
        x, y = np.log(main.values[main.presented[0][mine]]), np.log(main.estimate[mine])
        line = stats.linregress(x, y)
        reach = stats.t.ppf(0.975, x.size - 2) * line.stderr
        assert one.estimate.value == pytest.approx(line.slope)
        assert (one.estimate.low, one.estimate.high) == pytest.approx(
            (line.slope - reach, line.slope + reach)
        )
        assert abs(one.estimate.value - person.exponent) < 0.3
    slopes = np.array([one.estimate.value for one in persons])
    assert pooled.value == pytest.approx(np.mean(slopes))
    errors = np.array([one.estimate.high - one.estimate.low for one in persons]) / 2 / 1.959964

    def scatter(deviation: float) -> float:
        weight = 1 / (errors**2 + deviation**2)
        return float(weight @ (slopes - weight @ slopes / weight.sum()) ** 2)

    # The scatter that is expected of four degrees of freedom, and at each end a rare one.
    assert scatter(spread.value) == pytest.approx(4.0, rel=1e-2)
    for end, chance in ((spread.low, 0.975), (spread.high, 0.025)):
        assert stats.chi2.cdf(scatter(end), 4) == pytest.approx(chance, rel=1e-2)
    conditions, notes = magnitude_conditions(main, 0.95)
    numbers = [one.magnitude.value for one in conditions if one.magnitude is not None]
    assert numbers == sorted(numbers)
    assert notes == []


def test_a_scale_of_ones_own_changes_no_exponent() -> None:
    answers, _ = group("magnitude", 3)
    scaled = dataclasses.replace(answers, estimate=answers.estimate * (1.0 + answers.participant))
    one = analyze_answers(answers, "a")["biet2008-plate"]
    other = analyze_answers(scaled, "a")["biet2008-plate"]
    assert isinstance(one, TaskAnalysis)
    assert isinstance(other, TaskAnalysis)
    assert one.pooled is not None
    assert other.pooled is not None
    assert other.pooled.value == pytest.approx(one.pooled.value)
    ratio = [
        b.magnitude.value / a.magnitude.value
        for a, b in zip(one.conditions, other.conditions, strict=True)
        if a.magnitude is not None and b.magnitude is not None
    ]
    assert ratio == pytest.approx([ratio[0]] * len(ratio))


def test_stimuli_without_an_amount_have_no_power_law() -> None:
    answers, _ = group("magnitude", 2)
    flat = dataclasses.replace(answers.surfaces[0], waveform="constant")
    design = dataclasses.replace(answers.design, judged="friction_depth")
    odd = dataclasses.replace(answers, design=design, surfaces=(flat, *answers.surfaces[1:]))
    with pytest.raises(InputError, match="power law"):
        analyze_answers(odd, "odd")


def test_attention_is_judged_by_catch_trials_and_drift_by_people() -> None:
    answers, _ = group("adaptive", 3)
    caught = answers.take(answers.phase == "catch")
    all_right = dataclasses.replace(caught, choice=caught.right)
    assert all(one.attended and one.p_value == 1.0 for one in attention(all_right))
    none_right = dataclasses.replace(caught, choice=1 - caught.right)
    assert not any(one.attended for one in attention(none_right))
    course = course_of(answers, 0)
    assert [one.quantity for one in course.drift] == ["ln response time"]
    assert len(course.attention) == 3
    # Numbers rise by a thousandth of a second a trial.
    assert course.drift[0].change > 0


def test_a_known_drift_is_found() -> None:
    answers, _ = group("constant", 4)
    main = answers.main(0)
    place = np.empty(main.trials)
    for person in range(4):
        mine = main.participant == person
        number = main.number[mine] - main.number[mine].min()
        place[mine] = number / number.max()
    found = drift(main, 2.0 - 0.5 * place, "made up")
    assert found is not None
    assert found.change == pytest.approx(-0.5)
    assert drift(main.take(main.number < 5), place[main.number < 5], "too few") is None


def test_t_of_two_people_is_students() -> None:
    found = t_interval(np.array([1.0, 2.0]), 0.95)
    assert (found.low, found.high) == pytest.approx((1.5 - 6.3531, 1.5 + 6.3531), abs=1e-3)
    assert math.isnan(t_interval(np.array([1.0]), 0.95).low)


def test_methods_name_what_was_done_and_cite_it() -> None:
    answers, _ = group("adaptive", 2)
    text = methods_text(answers, 0)
    assert "2 participants took part" in text
    assert "staircase, 2 down and 1 up" in text
    assert "10.1016/S0042-6989(98)00285-5" in text
    assert "6 catch trials" in text
    assert "Moscatelli" in text
    constant, _ = group("constant", 2)
    assert "in the order of a Williams square" in methods_text(constant, 0)


def test_somebody_without_a_same_trial_has_no_share_in_false_alarms() -> None:
    made, _ = group("same-different", 4)
    lacking = made.take((made.participant != 0) | (made.presented[0] != made.presented[1]))
    others = made.take(made.participant != 0)
    assert false_alarms(lacking.main(0), 0.95) == false_alarms(others.main(0), 0.95)
    (found,) = analyze_answers(lacking, "lacking").values()
    assert isinstance(found, TaskAnalysis)
    assert all(math.isfinite(one.value) for one in found.more.values())


def test_no_interval_of_false_alarms_reaches_beyond_what_a_share_can_be() -> None:
    """Of two people, Student's would: here from -5.85 to 6.85."""
    made, _ = group("same-different", 2)
    same = made.presented[0] == made.presented[1]
    choice = np.where(same, np.where(made.participant == 0, 0, 1), made.choice)
    (found,) = false_alarms(dataclasses.replace(made, choice=choice).main(0), 0.95).values()
    assert (found.low, found.value, found.high) == (0.0, 0.5, 1.0)
    (alone,) = false_alarms(made.take(made.participant == 0).main(0), 0.95).values()
    assert math.isnan(alone.low)
    assert math.isnan(alone.high)


def test_the_same_twice_has_response_times_of_its_own() -> None:
    made, _ = group("same-different")
    times = np.where(made.presented[0] == made.presented[1], 2.0, 1.0)
    (found,) = analyze_answers(dataclasses.replace(made, response_time=times), "timed").values()
    assert isinstance(found, TaskAnalysis)
    means = {one.name: one.geometric_mean for one in found.response_times}
    assert means.pop("the same") == pytest.approx(2.0)
    assert set(means.values()) == {1.0}


def test_place_in_the_session_is_the_order_of_answers_and_not_their_numbers() -> None:
    """What was asked again has a late number; a foreign file may number all trials alike."""
    made, _ = group("constant")
    main = made.main(0)
    late = dataclasses.replace(main, number=main.number[::-1])
    alike = dataclasses.replace(main, number=np.ones_like(main.number))
    wanted = drift(main, main.correct, "right")
    assert wanted is not None
    assert drift(late, main.correct, "right") == wanted == drift(alike, main.correct, "right")


def test_people_without_a_line_are_counted() -> None:
    made, _ = group("magnitude")
    few = made.take((made.participant != 0) | (np.cumsum(made.participant == 0) <= 2))
    (found,) = analyze_answers(few, "few").values()
    assert found.methods.endswith("By the rule of the design 1 more participant was left out.")
    lenient = dataclasses.replace(few.design, exclusion=None)
    (found,) = analyze_answers(dataclasses.replace(few, design=lenient), "few").values()
    assert any(note.startswith("1 person has no line of their own") for note in found.notes)


def test_a_persons_interval_holds_the_middle_of_the_posterior() -> None:
    """Two rows of likelihood, for two lapse rates, weighed 3 to 1; cells of unlike widths."""
    edges = np.array([-3.0, -2.0, -1.0, 0.0, 2.0])
    flat = np.diff(edges)
    one = np.array([[0.0, 0.4, 0.2, 0.0], [0.0, 0.0, 0.8, 0.0]])
    edge = np.array([[1.0, 0.2, 0.1, 0.0]] * 2)
    people = PeopleOnGrid(
        ["a", "b"], edges, flat, [one, edge], [0.0] * 2, [0.0] * 2, [40, 41], [1.0] * 2
    )
    weighed: Any = SimpleNamespace(lapses=lambda: np.array([0.75, 0.25]))
    vars(people)["population"] = weighed
    first, second = people.estimates(0.8)
    # 0.3 and 0.35 in the second and the third cell, nothing beside them.
    for value, share in ((first.estimate.value, 0.5), (first.estimate.low, 0.1),
                         (first.estimate.high, 0.9)):  # fmt: skip
        below = share * 0.65
        at = -2.0 + below / 0.3 if below < 0.3 else -1.0 + (below - 0.3) / 0.35
        assert math.log(value) == pytest.approx(at)
    assert (first.person, first.trials, first.unbounded) == ("a", 40, False)
    assert (second.person, second.trials, second.unbounded) == ("b", 41, True)
