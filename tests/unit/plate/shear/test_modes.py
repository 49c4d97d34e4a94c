"""Modes of a shear plate: searches that no memory holds are refused before an element is made."""

from __future__ import annotations

import pytest

from squeezefilm.display import load_display
from squeezefilm.errors import InputError
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.shear.modes import shear_modes


@pytest.mark.parametrize(
    ("near", "said"), [(1e8, "unknowns of a shear plate"), (2e10, "near = 20 GHz")]
)
def test_a_frequency_with_too_many_waves_is_refused(near: float, said: str) -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    with pytest.raises(InputError, match=said):
        shear_modes(plate, near, 2)
