"""A synthetic curve, made by one of our models, beside all of them: its maker is the nearest."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.friction.friction_curve import CurveComparison, compare_friction_curve
from squeezefilm.measure.fits.friction.friction_scores import SHAPES
from squeezefilm.measure.recordings.kinds import FrictionCurve, Told
from squeezefilm.physics.chain.pad_law import MODEL_KINDS
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.display import load_display

AMPLITUDE = np.linspace(0.0, 2e-6, 9)
BARE = FrictionCurve(
    AMPLITUDE,
    np.ones(9),
    30e3,
    0.5,
    0.02,
    np.full(9, 0.02),
    told=Told(name="synthetic"),
    display="biet2008-plate",
)


@pytest.fixture(scope="module")
def compared() -> CurveComparison:
    """A curve by partial levitation without shear, with noise of its spread."""
    law = predict(
        "biet2008-plate", vibration_amplitude=2e-6, frequency=30e3, normal_force=0.5, speed=0.02
    ).law
    noise = 0.02 * np.random.default_rng(3).standard_normal(9)
    made = law.by("partial-levitation").curve(AMPLITUDE) + noise
    return compare_friction_curve(replace(BARE, friction=made))


@pytest.mark.slow
def test_every_model_is_compared_and_the_maker_is_nearest(compared: CurveComparison) -> None:
    assert {score.model for score in compared.models} == {*MODEL_KINDS, *SHAPES}
    assert compared.nearest.model == "partial-levitation"
    for score in compared.models:
        off = np.sqrt(np.mean((compared.curve.friction - score.friction) ** 2))
        assert score.difference == pytest.approx(off / compared.at_rest)
        assert score.in_spreads == pytest.approx(off / 0.02)
    assert compared.nearest.in_spreads == pytest.approx(1.0, abs=0.5)


@pytest.mark.slow
def test_the_default_is_said_to_miss_it_and_points_are_counted_in_our_interval(
    compared: CurveComparison,
) -> None:
    assert not compared.adequacy.adequate
    assert "does not describe the curve" in compared.adequacy.sentence
    assert compared.adequacy.where in compared.adequacy.sentence
    low, high = compared.band.low, compared.band.high
    friction = compared.curve.friction / compared.fitted_at_rest
    expected = [bool(a <= x <= b) for a, x, b in zip(low, friction, high, strict=True)]
    # Where nothing vibrates no model can be wrong, and no point is judged.
    assert list(compared.inside) == [None, *expected[1:]]
    assert compared.points_inside == (sum(expected[1:]), 8)
    # A wider interval holds what a narrower one does, and the widest is the band.
    levels = compared.inside_levels
    assert np.all(levels[1:] >= levels[:-1])
    assert levels[-1].tolist() == [bool(x) for x in (low <= friction) & (friction <= high)]
    # What a level between them fits is not far off.
    assert sum(expected[1:]) >= 5
    json.dumps(compared.summary(), allow_nan=False)


@pytest.mark.slow
def test_a_curve_of_the_default_is_described(compared: CurveComparison) -> None:
    own = compared.default.friction
    found = compare_friction_curve(replace(compared.curve, friction=own))
    assert found.nearest.model == found.default.model
    assert found.adequacy.adequate
    assert "within its spread" in found.adequacy.sentence
    assert len(found.observations) == 8
    first = found.observations[2]
    assert (first.answer, first.standard_error) == ("relative_friction", 0.02)
    assert first.conditions["vibration_amplitude"] == AMPLITUDE[3]


@pytest.mark.slow
def test_newtons_without_spread_or_rest_and_conditions_in_columns_are_compared(
    compared: CurveComparison,
) -> None:
    """As it is typed off a figure: no spread, no point at rest, a force and speed a point."""
    bare = replace(compared.curve, friction=0.4 * compared.curve.friction, spread=None)
    part = slice(2, None)
    newtons = replace(
        bare,
        vibration_amplitude=AMPLITUDE[part],
        friction=bare.friction[part],
        quantity="friction_force",
        normal_force=np.full(7, 0.5),
        speed=np.full(7, 0.02),
    )
    found = compare_friction_curve(newtons)
    # Of seven points with noise another model may be nearer than the maker of the curve.
    maker = next(score for score in found.models if score.model == "partial-levitation")
    assert maker.difference is not None
    assert maker.difference < 0.03
    assert found.nearest.difference == min(
        score.difference for score in found.models
        if score.model in MODEL_KINDS and score.difference is not None
    )  # fmt: skip
    assert found.nearest.in_spreads is None
    assert not found.adequacy.adequate
    assert "no spread" in found.adequacy.sentence
    assert found.observations == ()
    assert found.band.low == pytest.approx(compared.band.low[part], abs=1e-9)
    untold = compare_friction_curve(replace(newtons, speed=None))
    assert untold.assumed == ("speed",)
    assert untold.speed == load_display("biet2008-plate").finger.speed


def test_a_pull_in_newtons_is_observed_over_the_one_without_vibration() -> None:
    pull = replace(
        BARE,
        vibration_amplitude=np.array([0.0, 0.0, 1e-6]),
        friction=np.array([0.39, 0.41, 0.3]),
        spread=np.array([0.03, 0.03, 0.02]),
        quantity="friction_force",
        normal_force=0.5,
        speed=0.02,
    )
    found = compare_friction_curve(pull)
    (only,) = found.observations
    assert only.value == pytest.approx(0.75)
    expected = np.hypot(0.02 / 0.4, 0.75 * 0.03 / np.sqrt(2) / 0.4)
    assert only.standard_error == pytest.approx(expected)
    assert replace(found, normal_force=np.array([0.5, 0.5, 0.6])).observations == ()


def test_a_curve_must_name_its_display() -> None:
    with pytest.raises(InputError, match="names no display"):
        compare_friction_curve(replace(BARE, display=""))
