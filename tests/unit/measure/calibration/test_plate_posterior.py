"""The posterior of a problem that can be solved by hand: linear answers, Gaussian priors."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import qmc

from squeezefilm.analysis.parameters import Parameter
from squeezefilm.distributions import Normal
from squeezefilm.errors import InputError
from squeezefilm.measure.calibration.discrepancy import BELIEVED, SCALES, misfit_of, scale_of
from squeezefilm.measure.calibration.emulator import emulator_of
from squeezefilm.measure.calibration.identified import identification
from squeezefilm.measure.calibration.plate_posterior import (
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
SLOPES = np.array([[0.01, 0.01], [0.012, 0.012], [0.0, 0.05]])


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
    return PlateProblem(scores, emulator, asked, np.zeros(3), observations)


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
    assert np.median(wide.scales) > 3 * np.median(narrow.scales)
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


def test_scales_lie_between_their_ends() -> None:
    found = scale_of(np.array([-9.0, 0.0, 9.0]))
    np.testing.assert_allclose(found[[0, 2]], SCALES, rtol=1e-6)
    assert found[1] == pytest.approx(np.sqrt(SCALES[0] * SCALES[1]))
    assert set(BELIEVED) >= set(NAMES)
    assert misfit_of(0.0, [], np.zeros(0)).judgement == "fits"
