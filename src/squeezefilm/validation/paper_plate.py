"""The paper's plate: what the paper computed and measured of it, and this program's solution.

Why the two differ is the worked case of `validation.prototype`.
"""

from __future__ import annotations

import functools

from squeezefilm.core import quantities as si
from squeezefilm.design.analysis.published_claims import measured_of_preset
from squeezefilm.design.plate.sensitivity import WorkingPoint, with_other_data_set, working_point
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate

MODAL_FREQUENCY: si.Hertz = 35.6e3  # section 3.1.3, Fig 13
HARMONIC_FREQUENCY: si.Hertz = 34.77e3  # section 3.1.3, Fig 14
HARMONIC_AMPLITUDE: si.Metre = 3.2e-6
MEASURED_FREQUENCY: si.Hertz = measured_of_preset("biet2008-plate", "resonance_frequency")
MEASURED_AMPLITUDE: si.Metre = measured_of_preset("biet2008-plate", "vibration_amplitude")
DRIVE_VOLTAGE: si.Volt = 15.0


@functools.cache
def paper_plate() -> RectangularPlate:
    """The plate of the preset biet2008-plate."""
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    return plate


@functools.cache
def paper_points() -> tuple[WorkingPoint, WorkingPoint]:
    """Mode (8,0) of the paper's plate with d31 and with the printed e31."""
    plate = paper_plate()
    return working_point(plate), working_point(with_other_data_set(plate))
