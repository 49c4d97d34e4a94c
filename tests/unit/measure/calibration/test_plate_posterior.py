"""The posterior of a problem that can be solved by hand: linear answers, Gaussian priors."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import qmc

from squeezefilm.analysis.parameters import Parameter
from squeezefilm.distributions import Normal
from squeezefilm.errors import InputError
from squeezefilm.measure.calibration.discrepancy import (
    ALIKE,
    BELIEVED,
    KINDS,
    SHARED,
    misfit_of,
    scales_of,
    solver_covariance,
    unit_covariances,
)
from squeezefilm.measure.calibration.emulator import emulator_of
from squeezefilm.measure.calibration.identified import identification
from squeezefilm.measure.calibration.plate_posterior import (
    PlatePosterior,
    PlateProblem,
    best_fit,
    predictive,
    sampled_posterior,
)
from squeezefilm.measure.calibration.priors import NormalScores
from squeezefilm.measure.calibration.solved_answers import Asked
from squeezefilm.measure.fits.estimate import Observation
from squeezefilm.quantities import Unit

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
    frequency = made.of(Asked("resonance_frequency"))
    assert frequency.std() < 4e-4
    # The other answer of the same sum is known too, but for what its model may be off by.
    assert abs(np.log(np.median(made.of(Asked("mass")))) - SLOPES[1] @ [1.0, -0.5]) < 2e-3


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
        np.std(predictive(problem(*seen_), one, seed=1).of(Asked("amplitude_per_volt")))
        for seen_, one in ((right, narrow), (wrong, wide))
    ]
    assert spread[1] > spread[0]


@pytest.mark.slow
def test_the_same_seed_gives_the_same_draws() -> None:
    posed = problem(seen("mass", (0.3, 0.3), 1e-3))
    first, second = (sampled_posterior(posed, seed=4, steps=200) for _ in range(2))
    np.testing.assert_array_equal(first.scores, second.scores)


def test_what_cannot_be_observed_is_refused() -> None:
    with pytest.raises(InputError, match="above 0"):
        problem(Observation("mass", 1.0, 0.0))
    with pytest.raises(InputError, match="does not know"):
        problem(Observation("quality_factor", 1.0, 0.1))
    with pytest.raises(InputError, match="nothing"):
        sampled_posterior(problem(), seed=1)


def test_what_was_not_observed_is_as_uncertain_as_the_model_is_believed_to_be() -> None:
    """However well the data fit, and how sharp they are."""
    sharp = [seen(name, (0.5, 0.2), 1e-4) for name in ("resonance_frequency", "mass")]
    posed = problem(*sharp)
    made = predictive(posed, sampled_posterior(posed, seed=3, steps=300), seed=3)
    spread = np.std(np.log(made.of(Asked("amplitude_per_volt"))))
    assert spread > BELIEVED["amplitude_per_volt"]


def test_predicted_errors_are_those_of_a_conditioned_normal() -> None:
    """Against the information form: the precision of the errors, and that of the observations."""
    posed = problem(seen("resonance_frequency", (1, 0), 4e-3), seen("mass", (0, 0), 2e-3))
    draws, scales = 4000, np.array([1.5, 1.0, 0.5, 2.0])
    fixed = PlatePosterior(
        np.zeros((draws, 2)), np.tile(scales, (draws, 1)), np.zeros(2), misfit_of(0, [], scales), 1
    )
    logs = np.log(predictive(posed, fixed, seed=1).values)
    prior = np.tensordot(scales**2, posed.discrepancies, 1) + posed.model_covariance
    precision = np.linalg.inv(prior)
    for column, noise in zip(posed.columns, posed.noise, strict=True):
        precision[column, column] += noise**-2
    pull = np.zeros(3)
    left = posed.residuals(np.zeros((1, 2)))[0]
    pull[posed.columns] = left / posed.noise**2
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
