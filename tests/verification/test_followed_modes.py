"""Modes followed over a sweep of a solved plate, against theory and against each plate alone."""

import dataclasses

import numpy as np
import pytest

import squeezefilm as sf
from squeezefilm.core.materials import ElasticMaterial
from squeezefilm.physics.plate.layout import CeramicPatch, RectangularPlate
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.uncertainty.parameters import with_values


@pytest.mark.slow
def test_modes_rise_with_youngs_modulus_and_keep_their_labels() -> None:
    """Rayleigh: a stiffer material lowers no frequency."""
    display = sf.load_display("biet2008-plate")
    plate = display.actuator
    assert isinstance(plate, RectangularPlate)
    small = RectangularPlate(
        40e-3, 20e-3, 1.5e-3, 3, 60.0, ElasticMaterial("steel", 200e9, 0.3, 7800.0),
        plate.ceramic, (CeramicPatch(12e-3, 0.0, 16e-3, 20e-3, 0.5e-3),),
    )  # fmt: skip
    found = sf.sweep(
        dataclasses.replace(display, actuator=small),
        vary={"actuator.substrate.young_modulus": "150 GPa..210 GPa:4"},
        ask="followed",
    )
    assert all(one.least_likeness > 0.9 for one in found.follows)
    bending = next(one for one in found.follows if one.label == "(3,0)")
    assert not bending.driven  # a ceramic in the middle drives no odd mode
    assert not bending.lost
    for column in found.columns:
        known = column.values[np.isfinite(column.values)]
        assert np.all(np.diff(known) > 0)
    end = solve_modes(with_values(small, {"substrate.young_modulus": 150e9}), mode=(3, 0))
    first = found.column("followed.(3,0).frequency")[0]
    assert first == pytest.approx(float(end.frequencies[end.index((3, 0))]), rel=2e-3)
