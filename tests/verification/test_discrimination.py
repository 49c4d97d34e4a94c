"""d′ and just noticeable differences against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import ndtr, ndtri

from squeezefilm.core.errors import InputError
from squeezefilm.study.psychometric.discrimination import (
    alternatives_d_prime,
    correct_of_alternatives,
    corrected_proportion,
    differencing_rates,
    differencing_sensitivity,
    independent_observation_sensitivity,
    just_noticeable_difference,
    sensitivity,
    two_interval_sensitivity,
    yes_no_sensitivity,
)
from squeezefilm.study.psychometric.fit import fit_psychometric
from squeezefilm.study.psychometric.function import PsychometricFunction


@pytest.mark.parametrize("correct", [0.55, 0.76, 0.95])
def test_two_interval_d_prime_is_root_two_z(correct: float) -> None:
    closed = math.sqrt(2) * float(ndtri(correct))
    assert two_interval_sensitivity(correct, 1 - correct).d_prime == pytest.approx(closed)
    assert alternatives_d_prime(correct, 2) == pytest.approx(closed, abs=1e-9)


def test_alternatives_agree_with_published_tables() -> None:
    # Hacker & Ratcliff 1979, 10.3758/BF03206121: share correct at d′ = 1.
    for m, share in ((2, 0.760), (3, 0.634), (4, 0.552)):
        assert correct_of_alternatives(1.0, m) == pytest.approx(share, abs=6e-4)
    for m in (2, 3, 5, 10):
        assert correct_of_alternatives(0.0, m) == pytest.approx(1 / m, abs=1e-12)
        assert alternatives_d_prime(correct_of_alternatives(1.7, m), m) == pytest.approx(1.7)


def test_yes_no_moves_the_criterion_and_keeps_d_prime() -> None:
    for c in (-0.5, 0.0, 0.8):
        found = yes_no_sensitivity(float(ndtr(0.7 - c)), float(ndtr(-0.7 - c)))
        assert (found.d_prime, found.criterion) == pytest.approx((1.4, c))


@pytest.mark.parametrize("d_prime", [0.3, 1.0, 2.5])
@pytest.mark.parametrize("criterion", [0.4, 1.5])
def test_differencing_undoes_its_rates(d_prime: float, criterion: float) -> None:
    found = differencing_sensitivity(*differencing_rates(d_prime, criterion))
    assert (found.d_prime, found.criterion) == pytest.approx((d_prime, criterion), abs=1e-9)


def test_same_different_models_are_what_their_percepts_do() -> None:
    # Percepts drawn, decisions made: the observer of either model, not its formula.
    random = np.random.default_rng(1)
    n, d = 400_000, 1.6
    noise = random.standard_normal((2, 2, n))
    # Differencing: pairs (s, s) and (s, s + d), "different" where |difference| > k.
    k = 1.1
    far = np.abs(noise[0, 0] - noise[0, 1] - d) > k
    near = np.abs(noise[1, 0] - noise[1, 1]) > k
    found = differencing_sensitivity(float(far.mean()), float(near.mean()))
    assert found.d_prime == pytest.approx(d, abs=0.02)
    # Independent observations: each percept is put on one side, and the sides are compared.
    side = 0.5 * d
    shift = np.where(random.random(n) < 0.5, side, -side)
    far = ((noise[0, 0] + shift) > 0) != ((noise[0, 1] - shift) > 0)
    near = ((noise[1, 0] + shift) > 0) != ((noise[1, 1] + shift) > 0)
    found = independent_observation_sensitivity(float(far.mean()), float(near.mean()))
    assert found.d_prime == pytest.approx(d, abs=0.02)


def test_the_independent_observer_needs_less_than_the_differencing_one() -> None:
    # The same rates mean more d′ by differencing (Macmillan & Creelman 2005, chapter 9).
    by_difference = differencing_sensitivity(0.8, 0.3).d_prime
    assert by_difference > independent_observation_sensitivity(0.8, 0.3).d_prime > 0
    assert differencing_sensitivity(0.3, 0.3).d_prime == 0
    assert independent_observation_sensitivity(0.3, 0.3).d_prime == pytest.approx(0, abs=1e-7)


def test_counts_of_all_or_none_have_a_finite_d_prime() -> None:
    assert corrected_proportion(20, 20) == pytest.approx(20.5 / 21)
    found = sensitivity(20, 20, 0, 20, "yes-no", seed=1)
    assert math.isfinite(found.interval[1])
    assert found.interval[0] < found.sensitivity.d_prime < found.interval[1]
    with pytest.raises(InputError, match="hit_rate = 1"):
        yes_no_sensitivity(1.0, 0.2)


@pytest.mark.slow
def test_intervals_of_d_prime_cover() -> None:
    random, held = np.random.default_rng(2), 0
    hit, false = float(ndtr(0.9)), float(ndtr(-0.5))
    runs = 200
    for seed in range(runs):
        found = sensitivity(
            int(random.binomial(60, hit)), 60, int(random.binomial(60, false)), 60,
            "yes-no", draws=399, seed=seed,
        )  # fmt: skip
        held += found.interval[0] <= 1.4 <= found.interval[1]
    assert held / runs == pytest.approx(0.95, abs=4 * math.sqrt(0.95 * 0.05 / runs))


def test_the_just_noticeable_difference_of_a_gaussian() -> None:
    # Percepts of standard deviation s: the difference has s√2, and its quartile is 0.6745 of it.
    s, standard = 0.11, 2.0
    width = 2 * 1.6448536269514722 * s * math.sqrt(2)
    truth = PsychometricFunction("gaussian", 2.05, width)
    levels = np.linspace(1.5, 2.5, 9)
    trials = np.full(9, 10_000_000.0)
    fit = fit_psychometric(
        levels, np.round(trials * truth(levels)), trials, shape="gaussian", guess_rate=0.0,
        replicates=0,
    )  # fmt: skip
    found = just_noticeable_difference(fit, standard)
    jnd = 0.6744897501960817 * s * math.sqrt(2)
    assert found.difference == pytest.approx(jnd, rel=1e-3)
    assert found.weber_fraction == pytest.approx(jnd / standard, rel=1e-3)
    assert found.equality == pytest.approx(2.05, abs=1e-3)
    # d′ at the just noticeable difference is √2 z(¾) = 0.954.
    assert found.difference / s == pytest.approx(two_interval_sensitivity(0.75, 0.25).d_prime,
                                                 rel=1e-3)  # fmt: skip
    with pytest.raises(InputError, match="gives no intervals"):
        just_noticeable_difference(fit, standard, by="bootstrap")


def test_the_weber_fraction_on_a_logarithmic_axis_is_half_the_ratio_of_quartiles() -> None:
    truth = PsychometricFunction("logistic", 1.0, 0.8, axis="log")
    levels = np.geomspace(0.5, 2.0, 9)
    trials = np.full(9, 10_000_000.0)
    fit = fit_psychometric(
        levels, np.round(trials * truth(levels)), trials, axis="log", guess_rate=0.0, replicates=0
    )
    ratio = truth.quantile(0.75) / truth.quantile(0.25)
    found = just_noticeable_difference(fit, 1.0).weber_fraction
    assert found == pytest.approx(math.sqrt(ratio) - 1, rel=1e-3)


def test_correct_answers_among_alternatives_have_no_just_noticeable_difference() -> None:
    fit = fit_psychometric([1.0, 2.0, 3.0], [5, 8, 10], [10, 10, 10], replicates=0)
    with pytest.raises(InputError, match="comparison is greater"):
        just_noticeable_difference(fit, 1.0)
