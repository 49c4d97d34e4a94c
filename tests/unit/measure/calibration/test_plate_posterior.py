"""The posterior of a problem that can be solved by hand: linear answers, Gaussian priors."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import qmc

from squeezefilm.core.distributions import Normal
from squeezefilm.core.errors import InputError
from squeezefilm.core.quantities import Unit
from squeezefilm.measure.calibration import plate_posterior
from squeezefilm.measure.calibration.discrepancy import (
    ALIKE,
    BELIEVED,
    KINDS,
    READ_ALONE,
    SHARED,
    misfit_of,
    scales_of,
    solver_covariance,
    unit_covariances,
)
from squeezefilm.measure.calibration.emulator import emulator_of
from squeezefilm.measure.calibration.identified import identification
from squeezefilm.measure.calibration.plate_posterior import (
    BOUND,
    PlatePosterior,
    PlateProblem,
    best_fit,
    predictive,
    sampled_posterior,
)
from squeezefilm.measure.calibration.priors import NormalScores
from squeezefilm.measure.calibration.solved_answers import Asked
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.physics.uncertainty.parameters import Parameter

NAMES = ("resonance_frequency", "mass", "amplitude_per_volt")
# The first two answers see the sum of both parameters, the third the second one alone.
SLOPES = np.array([[0.05, 0.05], [0.06, 0.06], [0.0, 0.05]])


def problem(*observations: Observation) -> PlateProblem:
    parameters = tuple(
        Parameter(name, 1.0, Unit("1"), Normal(1.0, 0.01), "assumed", "") for name in "ab"
    )
    scores = NormalScores(parameters)
    drawn = np.clip(qmc.Sobol(2, rng=1).random(64), 1e-6, 1 - 1e-6)
    from scipy.special import ndtri

    z = ndtri(drawn)
    emulator = emulator_of(scores.coordinates(z), z @ SLOPES.T)
    asked = tuple(Asked(name) for name in NAMES)
    return PlateProblem(scores, emulator, asked, np.zeros(3), np.zeros(3), observations)


def seen(name: str, score: tuple[float, float], error: float) -> Observation:
    value = float(np.exp(SLOPES[NAMES.index(name)] @ score))
    return Observation(name, value, error * value)


def test_least_squares_are_those_of_the_linear_problem() -> None:
    posed = problem(
        seen("resonance_frequency", (1.0, -0.5), 1e-3),
        seen("amplitude_per_volt", (1.0, -0.5), 5e-3),
    )
    rows = SLOPES[[0, 2]] / np.array([[1e-3], [5e-3]])
    expected = np.linalg.solve(np.eye(2) + rows.T @ rows, rows.T @ (rows @ [1.0, -0.5]))
    np.testing.assert_allclose(best_fit(posed), expected, atol=0.02)


@pytest.mark.slow
def test_a_right_model_is_narrow_and_a_combination_is_named() -> None:
    posed = problem(seen("resonance_frequency", (1.0, -0.5), 3e-4))
    posterior = sampled_posterior(posed, seed=1, steps=600)
    assert posterior.misfit.judgement == "fits"
    # Only the sum is known: each alone keeps some 70 % of its prior spread.
    assert 0.55 < posterior.scores[:, 0].std() < 0.9
    total = posterior.scores.sum(axis=1)
    assert total.mean() == pytest.approx(0.5, abs=0.2)
    found = identification(("a", "b"), posterior.scores)
    assert [{name for name, _ in one.parts} for one in found.combinations] == [{"a", "b"}]
    assert "Only together" in found.sentences[-1]
    made = predictive(posed, posterior, seed=1)
    frequency = made[Asked("resonance_frequency")]
    assert frequency.std() < 4e-4
    # The other answer of the same sum is known too, but for what its model may be off by.
    assert abs(np.log(np.median(made[Asked("mass")])) - SLOPES[1] @ [1.0, -0.5]) < 2e-3


@pytest.mark.slow
def test_a_contradiction_is_a_misfit_and_widens() -> None:
    right = (seen("resonance_frequency", (1, 0), 1e-3), seen("mass", (1, 0), 1e-3))
    wrong = (right[0], seen("mass", (-2, 0), 1e-3))
    narrow, wide = (sampled_posterior(problem(*one), seed=1, steps=600) for one in (right, wrong))
    assert wide.misfit.judgement == "misfit"
    assert "standard errors" in wide.misfit.sentence
    # Of what was observed, and so of what was not.
    assert np.all(np.median(wide.scales, axis=0) > 1.1 * np.median(narrow.scales, axis=0))
    spread = [
        np.std(predictive(problem(*seen_), one, seed=1)[Asked("amplitude_per_volt")])
        for seen_, one in ((right, narrow), (wrong, wide))
    ]
    assert spread[1] > spread[0]


def test_a_misfit_names_the_recording_that_does_not_fit() -> None:
    frequencies = [seen("resonance_frequency", (k, 0), 1e-3) for k in (1.0, 1.01, -2.0)]
    named = [replace(one, recording=f"{k}.csv") for k, one in enumerate(frequencies)]
    misfit = sampled_posterior(problem(*named), seed=1, steps=100).misfit
    assert misfit.judgement == "misfit"
    assert misfit.worst == "resonance frequency (2.csv)"
    assert "Worst is the resonance frequency (2.csv)" in misfit.sentence


def test_draws_are_those_of_the_linear_problem(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every step of every walker after the burn-in, with the discrepancy's spread about them."""
    monkeypatch.setattr(plate_posterior, "BURN_IN", 20)
    posed = problem(seen("resonance_frequency", (1.0, -0.5), 1e-3))
    told: list[tuple[str, float]] = []
    # As large a seed as anybody gives.
    found = sampled_posterior(
        posed, seed=2**32 + 5, steps=50, progress=lambda *said: told.append(said)
    )
    walkers = 32
    assert found.scores.shape == (50 * walkers, 2)
    assert found.scales.shape == (50 * walkers, len(KINDS))
    assert len(np.unique(found.scores[:, 0])) > 3 * walkers
    assert told[1:] == [(f"posterior, {10 * part} %", part / 10) for part in range(10)]
    assert 1 < found.effective < len(found.scores)
    np.testing.assert_allclose(found.best, best_fit(posed, seed=1), atol=1e-4)
    # Across the sum that was observed, the priors' own spread is left.
    along, across = (found.scores @ np.array([[1, 1], [1, -1]]) / np.sqrt(2)).T
    believed = BELIEVED["resonance_frequency"] / (0.05 * np.sqrt(2))
    assert along.std() == pytest.approx(believed, rel=0.5)
    assert along.mean() == pytest.approx(0.5 / np.sqrt(2), abs=0.1)
    assert across.std() == pytest.approx(1.0, rel=0.25)


@pytest.mark.slow
def test_the_same_seed_gives_the_same_draws() -> None:
    posed = problem(seen("mass", (0.3, 0.3), 1e-3))
    first, second = (sampled_posterior(posed, seed=4, steps=200) for _ in range(2))
    np.testing.assert_array_equal(first.scores, second.scores)


def test_what_cannot_be_observed_is_refused() -> None:
    with pytest.raises(InputError, match="above 0"):
        problem(Observation("mass", 1.0, 0.0))


@pytest.mark.slow
def test_what_was_not_observed_is_as_uncertain_as_the_model_is_believed_to_be() -> None:
    """However well the data fit, and how sharp they are."""
    sharp = [seen(name, (0.5, 0.2), 1e-4) for name in ("resonance_frequency", "mass")]
    posed = problem(*sharp)
    made = predictive(posed, sampled_posterior(posed, seed=3, steps=300), seed=3)
    spread = np.std(np.log(made[Asked("amplitude_per_volt")]))
    assert spread > BELIEVED["amplitude_per_volt"]


def test_predicted_errors_are_those_of_a_conditioned_normal() -> None:
    """Against the information form: the precision of the errors, and that of the observations."""
    posed = problem(seen("resonance_frequency", (1, 0), 4e-3), seen("mass", (0, 0), 2e-3))
    draws, scales = 4000, np.array([1.5, 1.0, 0.5, 2.0])
    fixed = PlatePosterior(
        np.zeros((draws, 2)), np.tile(scales, (draws, 1)), np.zeros(2), misfit_of(0, [], scales), 1
    )
    logs = np.log(np.column_stack(list(predictive(posed, fixed, seed=1).values())))
    prior = np.tensordot(scales**2, posed.discrepancies, 1) + posed.model_covariance
    precision = np.linalg.inv(prior)
    variances = posed.noise**2 + [
        READ_ALONE.get(one.answer, 0.0) ** 2 for one in posed.observations
    ]
    for column, variance in zip(posed.columns, variances, strict=True):
        precision[column, column] += 1 / variance
    pull = np.zeros(3)
    left = posed.residuals(np.zeros((1, 2)))[0]
    pull[posed.columns] = left / variances
    covariance = np.linalg.inv(precision)
    np.testing.assert_allclose(
        logs.mean(axis=0) - posed.answers(np.zeros((1, 2)))[0],
        covariance @ pull,
        atol=4 * np.sqrt(covariance.max() / draws),
    )
    np.testing.assert_allclose(np.cov(logs.T), covariance, atol=0.1 * covariance.max())
    np.testing.assert_allclose(logs.std(axis=0), np.sqrt(np.diag(covariance)), rtol=0.06)


def test_scales_and_covariances_are_those_that_are_believed() -> None:
    scales = scales_of(np.random.default_rng(1).normal(size=(20000, len(KINDS))))
    for one in scales.T:
        np.testing.assert_allclose(np.quantile(one, [0.05, 0.5, 0.95]), [0.5, 1, 2], 0.04)
    alike = np.corrcoef(np.log(scales.T))[np.triu_indices(len(KINDS), 1)]
    np.testing.assert_allclose(alike, ALIKE, atol=0.03)
    names = [name for kind in KINDS for name in kind]
    # Every answer of a plate has an error of one kind; that of friction is another module's.
    assert sorted(names) == sorted(set(BELIEVED) - {"relative_friction"})
    total = unit_covariances(names).sum(axis=0)
    np.testing.assert_allclose(np.diag(total), [BELIEVED[name] ** 2 for name in names])
    assert np.linalg.eigvalsh(total).min() > 0
    assert total[0, 1] == pytest.approx(SHARED * np.sqrt(total[0, 0] * total[1, 1]))
    assert total[0, names.index("mass")] == 0
    # One mesh moves all frequencies alike: their difference has no error.
    mesh = solver_covariance(["resonance_frequency", "mode_frequency", "mass"], np.full(3, 1e-3))
    assert np.array([1, -1, 0]) @ mesh @ [1, -1, 0] == pytest.approx(0)
    assert mesh[2, 2] == pytest.approx(1e-6)
    assert misfit_of(0.0, [], np.zeros(0)).judgement == "fits"


RESONANCES = tuple(Asked(name) for name in BOUND)


def resonances(*observations: Observation, readings: tuple[float, ...] = (0, 0, 0)) -> PlateProblem:
    """Resonance, parallel resonance (as an emulator that errs has it) and coupling, of two
    parameters."""
    known = problem()
    z = np.random.default_rng(2).normal(size=(64, 2))
    logs = np.log([3e4, 3.2e4, 0.25]) + z @ np.array([[0.02, 0.0], [0.02, 0.01], [0.0, 0.1]]).T
    emulator = emulator_of(known.scores.coordinates(z), logs)
    return PlateProblem(
        known.scores, emulator, RESONANCES, np.zeros(3), np.array(readings), observations
    )


def fixed(scales: float = 1.0, draws: int = 4000) -> PlatePosterior:
    """Draws at the middle of the priors."""
    zeros = np.zeros((draws, 2))
    of_kinds = np.full((draws, len(KINDS)), scales)
    return PlatePosterior(zeros, of_kinds, np.zeros(2), misfit_of(0, [], of_kinds), 1)


@pytest.mark.parametrize(
    ("left_out", "scale"),
    [
        *((0, 1.0), (1, 3.0), (2, 1.0)),
        *(pytest.param(*one, marks=pytest.mark.slow) for one in ((0, 3.0), (1, 1.0), (2, 3.0))),
    ],
)
def test_of_resonance_parallel_resonance_and_coupling_two_tell_the_third(
    left_out: int, scale: float
) -> None:
    """However far the model is off, since the third is what the other two are called."""
    true = np.array([3.03e4, 3.03e4 / np.sqrt(1 - 0.252**2), 0.252])
    seen_ = [
        Observation(one.name, float(value), float(1e-7 * value))
        for k, (one, value) in enumerate(zip(RESONANCES, true, strict=True))
        if k != left_out
    ]
    posed = resonances(*seen_)
    values = np.column_stack(list(predictive(posed, fixed(scale), seed=1).values()))
    np.testing.assert_allclose(values[:, 2] ** 2, 1 - (values[:, 0] / values[:, 1]) ** 2)
    # By the law of errors of k² = 1 − (fs/fp)², from what each recording may misread.
    slope = 0.252**2 / (1 - 0.252**2)
    own = np.array([READ_ALONE[name] for name in BOUND])
    parts = {
        0: (own[1], slope * own[2]),
        1: (own[0], slope * own[2]),
        2: (own[0] / slope, own[1] / slope),
    }
    expected = np.hypot(*parts[left_out])
    logs = np.log(values[:, left_out])
    assert logs.std() == pytest.approx(expected, rel=0.1)
    assert logs.mean() == pytest.approx(np.log(true[left_out]), abs=0.2 * expected)


def test_the_slopes_of_what_is_bound_are_its_differences() -> None:
    posed = resonances()
    logs = np.log([[3e4, 1.0, 0.25], [3e4, 1.0, 0.6]])
    step = 1e-6
    differences = np.stack(
        [
            (posed.bound(logs + step * one) - posed.bound(logs - step * one)) / (2 * step)
            for one in np.eye(3)
        ],
        axis=2,
    )
    np.testing.assert_allclose(posed.moved(logs), differences, atol=1e-6)
    # A coupling that a sampler strays to has a parallel resonance, too.
    assert np.isfinite(posed.bound(np.log([[3e4, 1.0, 1.2]]))).all()
    assert problem().bound(logs) is logs


@pytest.mark.slow
def test_an_error_that_all_readings_share_is_not_averaged_away() -> None:
    """Of many sharp recordings that all misread an answer alike the interval stays so wide."""
    shared, count = 0.01, 30
    seen_ = [Observation("resonance_frequency", 3e4, 0.3) for _ in range(count)]
    for readings, expected in (
        ((shared, 0, 0), shared),
        ((0, 0, 0), READ_ALONE["resonance_frequency"] / np.sqrt(count)),
    ):
        posed = resonances(*seen_, readings=readings)
        # Of a model that is believed of little, so that only the readings tell.
        logs = np.log(predictive(posed, fixed(20.0), seed=1)[RESONANCES[0]])
        assert logs.std() == pytest.approx(expected, rel=0.1)


def test_a_proposal_far_from_anything_has_no_density() -> None:
    """The sampler's moves along differences of walkers propose what no walker would accept."""
    asked = problem(seen("mass", (0.5, 0.0), 0.01), seen("amplitude_per_volt", (0.0, 0.5), 0.02))
    random = np.random.default_rng(3)
    near = random.normal(size=(50, 2 + len(KINDS)))
    far = near * 40
    found = asked.log_posterior(np.vstack([near, far]))
    assert np.all(np.isfinite(found[:50]))
    np.testing.assert_array_equal(found[:50], asked.log_posterior(near))
    assert not np.any(np.isnan(found))
    assert np.mean(np.isneginf(found[50:])) > 0.9
