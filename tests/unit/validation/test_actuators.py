"""What the conclusion says of its two actuators, computed of the presets."""

from __future__ import annotations

import pytest

from squeezefilm.actuators.described import load_actuator
from squeezefilm.validation import command
from squeezefilm.validation.values import CLAIM_VALUES


def test_the_surface_is_a_pitch_for_each_contactor() -> None:
    array = command._array()
    found = CLAIM_VALUES["skin-stretch-surface"]()
    assert found.value == pytest.approx(
        (60 * array.cradle.pitch_along * array.cradle.pitch_across,)
    )
    assert found.printed_formula_value == (10e-6,)
    assert "0.41 mm apart" in found.note


def test_an_actuator_is_told_at_the_voltage_that_its_ceramic_bears() -> None:
    array = load_actuator("biet2008-skin-stretch").skin_stretch  # type: ignore[attr-defined]
    (free,) = CLAIM_VALUES["skin-stretch-free"]().value
    (blocked,) = CLAIM_VALUES["skin-stretch-blocked"]().value
    assert blocked / free == pytest.approx(array.bender.stiffness)


@pytest.mark.slow
def test_contact_grows_with_preload_and_falls_with_amplitude() -> None:
    pressed, swung = CLAIM_VALUES["motor-contact"]().value
    assert pressed > 0
    assert swung > 0
    assert pressed != pytest.approx(swung)
