"""Which values move, and their normal scores."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.special import ndtri

from squeezefilm.core.distributions import Normal, Uniform
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import Piezoceramic
from squeezefilm.design.plate.solved import with_ceramic_stiffness, with_glue
from squeezefilm.measure.calibration.priors import (
    CHARGE_SHARE,
    PERMITTIVITY_SHARE,
    SHARES,
    STIFFNESS_SHARE,
    NormalScores,
    calibration_parameters,
    share_of,
    with_calibrated,
)
from squeezefilm.physics.display import load_display

PAPER = load_display("biet2008-plate")


def test_glue_moves_where_there_is_glue() -> None:
    glued = dataclasses.replace(PAPER, actuator=with_glue(PAPER.actuator, 30e-6, 2e9))  # type: ignore[type-var]
    plain = {one.path for one in calibration_parameters(PAPER)}
    assert {one.path for one in calibration_parameters(glued)} - plain == {
        "actuator.glue.thickness",
        "actuator.glue.young_modulus",
    }
    assert all(one.origin == "assumed" for one in calibration_parameters(PAPER))


def test_paths_of_ones_own() -> None:
    chosen = {"actuator.length": Uniform(0.0829, 0.0831), "actuator.thickness": None}
    found = calibration_parameters(PAPER, chosen)
    assert [one.path for one in found] == list(chosen)
    assert found[0].distribution == chosen["actuator.length"]
    with pytest.raises(InputError, match="nothing says how uncertain"):
        calibration_parameters(PAPER, {"actuator.length": None})
    with pytest.raises(InputError, match="change its sign"):
        calibration_parameters(PAPER, {"actuator.length": Uniform(-1.0, 1.0)})
    with pytest.raises(InputError, match="measured"):
        calibration_parameters(load_display("biet2008-stator"))


def test_shares_scale_what_they_name() -> None:
    def with_shares(stiffness: float, charge: float, permittivity: float) -> Piezoceramic:
        values = dict(zip(SHARES, (stiffness, charge, permittivity), strict=True))
        return with_calibrated(PAPER, values).actuator.ceramic  # type: ignore[union-attr]

    ceramic = PAPER.actuator.ceramic  # type: ignore[union-attr]
    same = with_shares(1.0, 1.0, 1.0)
    assert same.full_constants == ceramic.full_constants
    softer = with_shares(0.9, 1.0, 1.0)
    stated = dataclasses.replace(PAPER.actuator, ceramic=same)  # type: ignore[type-var]
    assert softer.full_constants.compliance_33 == pytest.approx(
        with_ceramic_stiffness(stated, 0.9).ceramic.full_constants.compliance_33
    )
    other = with_shares(1.0, 1.2, 0.8).full_constants
    own = ceramic.full_constants
    assert other.charge_coefficient_33 == pytest.approx(1.2 * own.charge_coefficient_33)
    assert other.clamped_permittivity_33 == pytest.approx(0.8 * own.clamped_permittivity_33)
    assert other.compliance_11 == own.compliance_11
    with pytest.raises(InputError, match="stiffness"):
        with_shares(0.0, 1.0, 1.0)


def test_values_and_shares_reach_the_display() -> None:
    made = with_calibrated(
        PAPER,
        {"actuator.patches.*.thickness": 0.9e-3, STIFFNESS_SHARE: 0.95, CHARGE_SHARE: 1.1},
    )
    assert {one.thickness for one in made.actuator.patches} == {0.9e-3}  # type: ignore[union-attr]
    ceramic, own = made.actuator.ceramic, PAPER.actuator.ceramic  # type: ignore[union-attr]
    assert ceramic.in_plane_stiffness == pytest.approx(0.95 * own.in_plane_stiffness)
    assert with_calibrated(PAPER, {}) == PAPER
    assert with_calibrated(PAPER, {PERMITTIVITY_SHARE: 1.0}) != PAPER  # its constants are stated


def test_scores_and_values_are_inverse_and_standard() -> None:
    parameters = calibration_parameters(
        PAPER, {"actuator.thickness": Normal(2e-3, 2e-5), STIFFNESS_SHARE: None}
    )
    scores = NormalScores(parameters)
    drawn = np.random.default_rng(1).normal(size=(4000, 2))
    values = scores.values(drawn)
    for k, one in enumerate(parameters):
        back = ndtri(share_of(one.distribution, values[:, k]))
        np.testing.assert_allclose(back, drawn[:, k], atol=1e-6)
    assert values[:, 0].std() == pytest.approx(2e-5, rel=0.05)
    low, high = parameters[1].distribution.support
    assert low < values[:, 1].min()
    assert values[:, 1].max() < high
    inside = np.abs(scores.coordinates(drawn))
    assert inside.max() <= 1 + 1e-9
    for one in parameters:
        share = np.linspace(0, 1, 11)
        back = share_of(one.distribution, one.distribution.quantile(share))
        np.testing.assert_allclose(back, share, atol=1e-9)
