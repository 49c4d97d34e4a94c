"""What is asked of a track, in texts."""

from __future__ import annotations

import pytest

from squeezefilm.analysis.plate.tracking import PARAMETERS, TrackRequest, parse_track
from squeezefilm.errors import InputError


def test_ends_have_the_unit_of_the_parameter() -> None:
    found = parse_track("thickness", "0.5 mm", "1.5 mm", 5)
    assert found == TrackRequest("thickness", 0.5e-3, 1.5e-3, 5)
    assert parse_track("young_modulus", "60 GPa", "70 GPa", 2).stop == 70e9
    assert parse_track("poisson_ratio", "0.2", "0.4", 3) == TrackRequest(
        "poisson_ratio", 0.2, 0.4, 3
    )


@pytest.mark.parametrize("name", PARAMETERS)
def test_every_parameter_can_be_asked_for_in_its_unit(name: str) -> None:
    unit = PARAMETERS[name][0].label
    assert parse_track(name, f"0.1 {unit}".strip(), f"0.3 {unit}".strip(), 2).stop == 0.3
    if unit:
        with pytest.raises(InputError):
            parse_track(name, "0.1", "0.3", 2)
