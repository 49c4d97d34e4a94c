"""The working mode under a finger: its resonance then, and what the pad meets along the wave."""

from __future__ import annotations

import numpy as np

from squeezefilm.chain.friction import shares_load
from squeezefilm.chain.prediction import Prediction
from squeezefilm.contact.sharing.gas_table import film_table
from squeezefilm.contact.sharing.pad import friction_ripple
from squeezefilm.display import Display
from squeezefilm.errors import InputError
from squeezefilm.plate.layout import DiscPlate, RectangularPlate
from squeezefilm.quantities import Dimensionless, Hertz
from squeezefilm.render.program.inverse import FrictionInverse
from squeezefilm.render.program.wave import WaveCompensation
from squeezefilm.render.texture.coordinate import AlongX, AlongY

# How much more amplitude a pad may seem to meet off an antinode than on it.
_BETTER = 1.5


def resonance_with_finger(p: Prediction) -> tuple[Dimensionless, Hertz]:
    """Quality factor and resonance (Hz) with the finger on the mode, where that is known."""
    if p.touch.mode is None:
        return p.mode.quality_factor, p.mode.resonance_frequency
    return p.touch.mode.quality_factor, p.touch.mode.resonance_frequency


def wave_factors(display: Display, p: Prediction) -> WaveCompensation:
    """The amplitude that the pad meets along the wave, over that at the best place.

    Raises `InputError` for a disc, whose wave is none along a line.
    """
    plate = display.actuator
    if isinstance(plate, DiscPlate):
        raise InputError(
            "the wave of a disc is no standing wave along a line; leave --wave out for a disc"
        )
    across = isinstance(plate, RectangularPlate) and plate.lines_across == "width"
    along = AlongY() if across else AlongX()
    half, law = p.mode.half_wavelength, p.law
    if not shares_load(p.model):
        return WaveCompensation.over_contact(half, law.finger.contact_length, along=along)
    found = friction_ripple(
        film_table(law.frequency, law.finger.plateau_width, law.gas),
        law.finger.asperity_law(law.surface.roughness),
        p.vibration_amplitude,
        half,
        law.finger,
        normal_force=law.normal_force,
    )
    # Off the antinode friction may be less than the display makes centred on it.
    wide = _BETTER * p.vibration_amplitude
    inverse = FrictionInverse.from_function(law.table(wide), wide)
    reached = np.clip(found.relative_friction, inverse.least_friction, 1.0)
    return WaveCompensation.from_ripple(found.position, reached, inverse, half, along=along)
