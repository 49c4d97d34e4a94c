"""Modes of a shear plate: what no memory holds, or the theory does not know, is refused before an
element is made."""

from __future__ import annotations

import pytest

from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.shear.modes import shear_modes
from squeezefilm.physics.plate.shear.section import shear_layout


@pytest.fixture(name="plate")
def _plate() -> RectangularPlate:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    return plate


@pytest.mark.parametrize(
    ("near", "said"), [(370e3, "unknowns of a shear plate"), (2e10, "near = 20 GHz")]
)
def test_a_frequency_with_too_many_waves_is_refused(
    plate: RectangularPlate, near: float, said: str
) -> None:
    with pytest.raises(InputError, match=said):
        shear_modes(plate, near, 2, degree=14)


def test_a_frequency_of_waves_across_the_thickness_is_refused(
    plate: RectangularPlate, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(
        "squeezefilm.physics.plate.shear.modes.shear_system", None
    )  # Nothing is meshed.
    with pytest.raises(OutOfRangeError, match=r"near = 2 MHz.*across the plate.* kHz at most"):
        shear_modes(plate, 2e6)


def test_a_bare_section_shears_as_half_a_wave_across_it(plate: RectangularPlate) -> None:
    bare = shear_layout(plate).sections[0]
    assert bare.stress_coefficient == 0
    speed = (plate.substrate.shear_modulus / plate.substrate.density) ** 0.5
    # Reissner's factor 5/6 has it as √(π²/10) of the half wave's.
    assert bare.shear_time == pytest.approx(plate.thickness / speed, rel=0.01)
