"""Calibrations of synthetic benches: the truth is known, and so is what the model lacks.

200 benches through the emulator say whether the ranks of the truth are flat (Talts et al. 2018,
arXiv:1804.06788); what they printed stands in campaigns/statistics.jsonl. Seeds stand in the tests.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import chisquare

from squeezefilm.measure.calibration.priors import with_calibrated
from squeezefilm.measure.calibration.solved_answers import Asked, solved_answers
from squeezefilm.physics.plate.layout import RectangularPlate

from .synthetic_benches import (
    Fingers,
    PlateBench,
    Plates,
    drawn_scales,
    plate_bench,
)
from .wrong_plates import MECHANISMS

BENCHES = 200
Mechanism = Callable[[RectangularPlate, np.random.Generator], RectangularPlate]


@pytest.fixture(scope="module")
def plates() -> Plates:
    return Plates.of(72)


@pytest.fixture(scope="module")
def fingers() -> Fingers:
    return Fingers.of(8192 + 512)


def flat(ranks: np.ndarray) -> float:
    """The probability that ranks as uneven as these come of flat ones."""
    counts, _ = np.histogram(ranks, bins=10, range=(0, 1))
    return float(chisquare(counts).pvalue)


@pytest.mark.campaign
def test_ranks_of_a_plates_parameters_and_blind_answers_are_flat(plates: Plates) -> None:
    random = np.random.default_rng(2026)
    found = []
    for number in range(BENCHES):
        scores = random.normal(size=len(plates.problem.scores.parameters))
        answers = plates.truth(scores, drawn_scales(random), random)
        found.append(plate_bench(plates, scores, answers, seed=number, misread=True))
    ranks = np.array([[*one.ranks, *one.blind_ranks] for one in found])
    odds = [flat(column) for column in ranks.T]
    inside = np.mean([one.inside for one in found], axis=0)
    misfits = float(np.mean([not one.fits for one in found]))
    print(f"odds of flat ranks {np.round(odds, 3)}, 90 % intervals cover {inside}, {misfits=}")
    assert min(odds) > 0.01 / len(odds)
    assert np.all(np.abs(inside - 0.9) < 0.07)


@pytest.mark.campaign
def test_where_the_model_is_right_blind_answers_are_met(plates: Plates) -> None:
    random = np.random.default_rng(7)
    found, least = [], []
    for number in range(60):
        scores = random.normal(size=len(plates.problem.scores.parameters))
        answers = plates.truth(scores, 0.0, random)
        found.append(plate_bench(plates, scores, answers, seed=number))
        least.append(plates.least_errors(scores))
    errors = np.abs([one.errors for one in found])
    widths = np.median([one.widths for one in found], axis=0)
    unmeasured = np.std(
        np.log([plates.truth(random.normal(size=8), 0.0, random) for _ in range(300)]), axis=0
    )
    rms, bound = (np.sqrt(np.mean(np.square(one), axis=0)) for one in (errors, least))
    print(
        f"blind errors, median {np.median(errors, axis=0)}, 95 % "
        f"{np.quantile(errors, 0.95, axis=0)}, "
        f"interval widths {widths}; spread without data {unmeasured[:6]}; root mean square error "
        f"{rms}, at least {bound}"
    )
    assert np.all(np.median(errors, axis=0) < [0.001, 0.05])
    assert np.quantile(errors[:, 0], 0.95) < 0.002
    # No estimate could be much nearer: what is left is the instruments' noise.
    assert np.all(np.abs(rms / bound - 1) < 0.35)
    assert np.mean([one.fits for one in found]) > 0.9


@pytest.mark.campaign
def test_a_wrong_plate_is_a_misfit_or_covered(plates: Plates) -> None:
    """A frequency that another mode pushed, a capacitance of a cracked ceramic, a lossy clamp. An
    error of the blind answer alone leaves no trace in what was observed: only what the model is
    believed to be off by can hold it."""
    random = np.random.default_rng(2027)
    asked = plates.problem.asked
    wrong = {
        "mass": -0.01,
        "resonance_frequency": 0.012,
        "coupling_coefficient": -0.08,
        "static_capacitance": -0.1,
        "amplitude_per_volt": -0.25,
    }
    covered, misfits = [], []
    for number in range(100):
        scores = random.normal(size=len(plates.problem.scores.parameters))
        answers = plates.truth(scores, 0.0, random)
        # Each bench suffers two of them.
        logs = np.log(answers)
        for name in random.choice(list(wrong), 2, replace=False):
            logs[asked.index(Asked(name))] += np.log1p(wrong[name])
        answers = plates.bound(logs)
        one = plate_bench(plates, scores, answers, seed=number)
        covered.append(one.inside)
        misfits.append(not one.fits)
    held = np.logical_or(np.array(covered), np.array(misfits)[:, None]).mean(axis=0)
    print(f"covered {np.mean(covered, axis=0)}, misfits {np.mean(misfits)}, either {held}")
    assert np.all(held > 0.88)


@pytest.mark.campaign
def test_ranks_of_blind_friction_are_flat(fingers: Fingers) -> None:
    random = np.random.default_rng(3)
    bank, truths = slice(0, 8192), range(8192, 8192 + 512)
    ranks, inside, effective = [], [], []
    for number in truths:
        curve = fingers.curves[number]
        if not np.isfinite(curve).all():
            continue
        true = curve + fingers.discrepancy(random)
        drawn, _, worth = fingers.blind(true, bank, number)
        value = float(np.clip(true[-1], 0.0, 1.2))
        # What is cut off at an end of the range lies anywhere among its equals.
        below, equal = np.mean(drawn < value), np.mean(drawn == value)
        ranks.append(below + random.random() * equal)
        inside.append(np.quantile(drawn, 0.05) <= value <= np.quantile(drawn, 0.95))
        effective.append(worth)
        if len(ranks) == BENCHES:
            break
    odds = flat(np.array(ranks))
    print(
        f"{odds=:.3f}, 90 % intervals cover {np.mean(inside):.3f}, worth {np.median(effective):.0f}"
    )
    assert odds > 0.005
    assert abs(np.mean(inside) - 0.9) < 0.07


@pytest.mark.campaign
def test_friction_of_the_right_and_of_other_laws(fingers: Fingers) -> None:
    """Blind µ′/µ within 0.05 where a law of the mixture made it; else a misfit, or covered."""
    random = np.random.default_rng(4)
    bank = slice(0, 8192)
    amplitude = np.array([one.amplitude for one in fingers.WHERE])
    errors, covered, widths = [], [], []
    for number in range(8192, 8192 + 100):
        curve = fingers.curves[number]
        if not np.isfinite(curve).all():
            continue
        drawn, _, _ = fingers.blind(curve, bank, number)
        errors.append(abs(float(np.median(drawn)) - curve[-1]))
        low, high = np.quantile(drawn, [0.05, 0.95])
        widths.append(high - low)
    for number in range(60):
        # A contact that hammers, one with a threshold, one that sticks again: not the mixture's.
        kind, place = number % 3, random.uniform(0.5e-6, 2.5e-6)
        if kind == 0:
            other = 1 / (1 + (amplitude / place) ** 3)
        elif kind == 1:
            other = np.clip(1.2 - amplitude / (2 * place), 0.1, 1.0)
        else:
            other = 0.4 + 0.6 * np.exp(-amplitude / place) + 0.15 * np.sin(amplitude / place * 3)
        drawn, fits, _ = fingers.blind(other, bank, number)
        low, high = np.quantile(drawn, [0.05, 0.95])
        covered.append((not fits) or low <= other[-1] <= high)
    prior = np.nanquantile(fingers.curves[bank, -1], [0.05, 0.95])
    print(
        f"right: median error {np.median(errors):.3f}, 95 % {np.quantile(errors, 0.95):.3f}, width "
        f"{np.median(widths):.3f} of {np.diff(prior)[0]:.3f} without data; other laws held "
        f"{np.mean(covered):.3f}"
    )
    assert np.median(errors) < 0.05
    assert np.mean(covered) > 0.8


def solved_bench(
    plates: Plates, mechanism: Mechanism | None, random: np.random.Generator, seed: int
) -> PlateBench:
    """A bench whose answers the full solver gave, of a plate drawn from the priors."""
    parameters = plates.problem.scores.parameters
    scores = random.normal(size=len(parameters))
    values = plates.problem.scores.values(scores[None, :])[0].tolist()
    paths = [one.path for one in parameters]
    actuator = with_calibrated(plates.display, dict(zip(paths, values, strict=True))).actuator
    assert isinstance(actuator, RectangularPlate)
    if mechanism is not None:
        actuator = mechanism(actuator, random)
    answers = solved_answers(actuator, plates.problem.asked).values
    return plate_bench(plates, scores, answers, seed=seed)


@pytest.mark.campaign
def test_five_fully_solved_benches(plates: Plates) -> None:
    random = np.random.default_rng(9)
    found = [solved_bench(plates, None, random, seed=number) for number in range(5)]
    errors = np.abs([one.errors for one in found])
    print(f"errors {errors.tolist()}, widths {np.median([one.widths for one in found], axis=0)}")
    assert np.all(np.median(errors, axis=0) < [0.002, 0.05])
    assert all(one.fits and np.all(one.inside) for one in found)


@pytest.mark.campaign
def test_solved_plates_that_no_description_has_are_a_misfit_or_covered(plates: Plates) -> None:
    """Never narrow and wrong, where a mechanism and not a table of errors made the bench."""
    random = np.random.default_rng(10)
    held, misfits, parameters = [], [], []
    for number in range(6 * len(MECHANISMS)):
        mechanism = MECHANISMS[number % len(MECHANISMS)]
        one = solved_bench(plates, mechanism, random, seed=number)
        print(mechanism.__name__, one.errors, one.widths, one.inside, one.fits)
        misfits.append(not one.fits)
        held.append(one.inside | (not one.fits))
        parameters.append((not one.fits) | (np.abs(one.ranks - 0.5) < 0.45))
    print(
        f"held {np.mean(held, axis=0)}, misfits {np.mean(misfits)}, parameters held "
        f"{np.mean(parameters, axis=0)}"
    )
    assert np.all(np.mean(held, axis=0) > 0.88)


@pytest.mark.campaign
def test_the_next_measurement_tells_what_was_expected_of_it(fingers: Fingers) -> None:
    """After one point of friction: what each further one is expected to leave, and what it leaves
    on benches whose truth is known, calibrated anew with it."""
    expected, achieved = fingers.next_measurements(slice(0, 8192), range(8192, 8192 + 60))
    print(f"left of the interval, expected {expected.round(3)}, achieved {achieved.round(3)}")
    assert np.argmin(expected) == np.argmin(achieved)
    np.testing.assert_allclose(expected, achieved, atol=0.12)
