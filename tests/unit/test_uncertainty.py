"""Uncertain parameters and the propagation of their distributions."""

import dataclasses

import numpy as np
import pytest

from squeezefilm.analysis.parameters import replaced, uncertain_parameters, value_at
from squeezefilm.analysis.uncertainty import uncertain_friction
from squeezefilm.chain.prediction import predict
from squeezefilm.config.provenance import Provenance
from squeezefilm.display import Display, load_display
from squeezefilm.distributions import Uniform
from squeezefilm.errors import InputError, OutOfRangeError


@pytest.fixture(scope="module")
def stator() -> Display:
    return load_display("biet2008-stator")


def _given(display: Display, **ranges: tuple[float, float]) -> Display:
    """The display with these distributions beside its values (a path with __ for its dots)."""
    known = dict(display.provenance)
    for name, (low, high) in ranges.items():
        known[name.replace("__", ".")] = Provenance("test", "measured", Uniform(low, high))
    return dataclasses.replace(display, provenance=known)


def test_values_are_found_and_replaced_by_their_path(stator: Display) -> None:
    changed = replaced(
        stator,
        {
            "surfaces.1.roughness": 1e-6,
            "finger.asperities.decay_length": 1e-7,
            "gas.viscosity": 2e-5,
        },
    )
    assert value_at(changed, "surfaces.1.roughness")[0] == 1e-6
    assert value_at(changed, "finger.asperities.decay_length")[0] == 1e-7
    assert changed.gas.viscosity == 2e-5
    assert changed.surfaces[0] == stator.surfaces[0]
    assert stator.surfaces[1].roughness == 0.2e-6
    assert value_at(stator, "finger.plateau_width")[1].symbol == "m"


def test_what_is_given_stands_before_what_is_assumed(stator: Display) -> None:
    names = {p.path: p.origin for p in uncertain_parameters(stator, driven=False)}
    assert names["finger.plateau_width"] == "assumed"
    assert "actuator.quality_factor" not in names
    known = _given(stator, finger__plateau_width=(249e-6, 251e-6), drive__voltage=(130.0, 150.0))
    driven = {p.path: p for p in uncertain_parameters(known, "bare", driven=True)}
    assert driven["finger.plateau_width"].origin == "given"
    assert driven["finger.plateau_width"].distribution.support == (249e-6, 251e-6)
    assert "drive.voltage" in driven
    assert "surfaces.1.roughness" in driven
    assert "surfaces.0.roughness" not in driven
    assert "drive.voltage" not in {p.path for p in uncertain_parameters(known, driven=False)}


@pytest.mark.slow
def test_a_range_that_is_known_better_narrows_the_interval(stator: Display) -> None:
    p = predict(stator, vibration_amplitude=2e-6)
    wide = uncertain_friction(stator, p, samples=32)
    ranges = {
        "finger__plateau_width": (249e-6, 251e-6),
        "finger__asperities__reference_gap": (1.99e-6, 2.01e-6),
    }
    narrow = uncertain_friction(_given(stator, **ranges), p, samples=32)
    assert np.ptp(narrow.interval) < 0.6 * np.ptp(wide.interval)
    assert wide.interval[0] < wide.median < wide.interval[1]
    # Both were the most important ones.
    assert {item.parameter.path for item in wide.influences[:2]} == {
        name.replace("__", ".") for name in ranges
    }
    again = uncertain_friction(stator, p, samples=32)
    assert again.interval == wide.interval


@pytest.mark.slow
def test_a_linear_model_has_the_indices_of_its_variances(
    stator: Display, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With µ′/µ replaced by a sum, first and total order are the shares of the variance."""
    from squeezefilm.analysis import uncertainty

    def linear(display, prediction, free, compliance):  # type: ignore[no-untyped-def]
        finger = display.finger
        return (
            2 * finger.plateau_width / 250e-6 + finger.contact_length / 10e-3 + 0.5 * compliance,
            free,
        )

    monkeypatch.setattr(uncertainty, "_one", linear)
    found = uncertainty.uncertain_friction(
        stator, predict(stator, vibration_amplitude=2e-6), samples=1024
    )
    shares = {item.parameter.path: item for item in found.influences}
    # Uniform widths: 0.8 × 2, 0.4 × 1, 1 × 0.5
    variances = {
        "finger.plateau_width": 1.6**2,
        "finger.contact_length": 0.4**2,
        "skin_compliance": 0.5**2,
    }
    for name, variance in variances.items():
        expected = variance / sum(variances.values())
        assert shares[name].first_order == pytest.approx(expected, abs=0.02)
        assert shares[name].total == pytest.approx(expected, abs=0.02)
    assert shares["surfaces.0.roughness"].total == pytest.approx(0, abs=1e-6)
    # The 5 % and 95 % quantiles of that sum, by brute force.
    draw = np.random.default_rng(0).random((3, 10**6))
    total = 2 * (0.6 + 0.8 * draw[0]) + 0.8 + 0.4 * draw[1] + 0.5 * draw[2]
    assert found.interval == pytest.approx(np.quantile(total, [0.05, 0.95]), rel=0.01)


@pytest.mark.slow
def test_impossible_designs_are_refused(stator: Display) -> None:
    p = predict(stator, vibration_amplitude=2e-6)
    with pytest.raises(InputError, match="power of two"):
        uncertain_friction(stator, p, samples=100)
    hard = _given(stator, finger__asperities__reference_gap=(0.01e-6, 2.1e-6))
    p = predict(stator, vibration_amplitude=2e-6, normal_force=5.0)
    with pytest.raises(OutOfRangeError, match="presses its asperities through"):
        uncertain_friction(hard, p, samples=8)
