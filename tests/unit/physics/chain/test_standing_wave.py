"""The working mode under a finger, and the share of the wave that the pad meets."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.physics.chain.pad_law import DEFAULT_MODEL
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.chain.standing_wave import (
    factor_of_law,
    resonance_with_finger,
    wave_factors,
)
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.render.texture.pattern import AlongX, AlongY

STATOR = load_display("biet2008-stator")


@pytest.fixture(scope="module")
def shared() -> Prediction:
    return predict(STATOR)


@pytest.fixture(scope="module")
def asymptote() -> Prediction:
    return predict(STATOR, model="paper2008")


def test_the_finger_counts_where_its_effect_is_known(shared: Prediction) -> None:
    assert resonance_with_finger(shared) == (200.0, 40.5e3)
    loaded = SimpleNamespace(quality_factor=150.0, resonance_frequency=40.1e3)
    touched = dataclasses.replace(shared, touch=dataclasses.replace(shared.touch, mode=loaded))
    assert resonance_with_finger(touched) == (150.0, 40.1e3)


def test_a_model_that_knows_antinodes_only_has_the_default_models_wave(
    asymptote: Prediction,
) -> None:
    found = wave_factors(STATOR, asymptote)
    own = dataclasses.replace(asymptote, law=asymptote.law.by(DEFAULT_MODEL))
    assert found == wave_factors(STATOR, own)
    assert max(found.factors) == 1.0


def test_with_load_sharing_the_factor_explains_the_pads_friction(shared: Prediction) -> None:
    found = wave_factors(STATOR, shared)
    half = shared.mode.half_wavelength
    assert found.half_wavelength == half
    assert max(found.factors) == 1.0
    # A contact of 10 mm on a wave of 9.35 mm smooths it, so even a node leaves most of it.
    assert min(found.factors) > 0.5
    # Symmetric about an antinode.
    places = np.linspace(0.0, half / 2, 9)
    assert found.factor(places) == pytest.approx(found.factor(half - places), rel=1e-3)
    # Where the law has its pad the amplitude is the display's: elsewhere it acts as more or less,
    # whether that is the best place or an antinode.
    for p in (shared, predict(STATOR, position=0.0)):
        factors = wave_factors(STATOR, p)
        for place in (0.0, half / 4, half / 2):
            there = predict(STATOR, position=place).relative_friction
            like = p.vibration_amplitude * float(factors.factor(place)) / factor_of_law(p, factors)
            assert p.law.at(like) == pytest.approx(there, abs=5e-3)


def _plate(across: str) -> object:
    actuator = load_display("biet2008-plate").actuator
    assert isinstance(actuator, RectangularPlate)
    return dataclasses.replace(
        load_display("biet2008-plate"),
        actuator=dataclasses.replace(actuator, lines_across=across),  # type: ignore[arg-type]
    )


def test_the_wave_runs_across_the_nodal_lines(shared: Prediction, asymptote: Prediction) -> None:
    # Only the direction is the plate's here; the numbers are those of the prediction given.
    for p in (shared, asymptote):
        assert wave_factors(STATOR, p).along == AlongX()
        assert wave_factors(_plate("length"), p).along == AlongX()  # type: ignore[arg-type]
        assert wave_factors(_plate("width"), p).along == AlongY()  # type: ignore[arg-type]


def test_a_disc_has_no_wave_along_a_line(shared: Prediction) -> None:
    with pytest.raises(InputError, match=r"^the wave of a disc is no standing wave .* for a disc$"):
        wave_factors(load_display("winfield2007-tpad"), shared)
