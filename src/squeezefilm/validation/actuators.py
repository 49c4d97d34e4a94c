"""Values of the paper's two neighbours by its conclusion: a planar standing-wave motor, of which it
gives no number, and a display of 60 actuators that stretch the skin, whose sizes it does not give.
"""

from __future__ import annotations

import math

from squeezefilm.actuators.described import load_actuator
from squeezefilm.actuators.motor.assembled import Working, assembled
from squeezefilm.actuators.motor.averaged import averaged, no_load_speed
from squeezefilm.actuators.skin_stretch.array import SkinStretchArray
from squeezefilm.actuators.skin_stretch.load_line import loaded_tip
from squeezefilm.validation.values import ClaimValue, value_of

_PRELOADS, _AMPLITUDES = (10.0, 20.0), (1.5e-6, 4e-6)
_PRINTED_SURFACE = 10e-6


def _array() -> SkinStretchArray:
    described: SkinStretchArray = load_actuator("biet2008-skin-stretch").skin_stretch  # type: ignore[union-attr]
    return described


@value_of("skin-stretch-free")
def _() -> ClaimValue:
    array, volts = _array(), _array().actuator.largest_voltage
    return ClaimValue((array.bender.deflection_per_volt * volts,), note=f"at {volts:.3g} V")


@value_of("skin-stretch-blocked")
def _() -> ClaimValue:
    array, volts = _array(), _array().actuator.largest_voltage
    return ClaimValue((array.bender.force_per_volt * volts,), note=f"at {volts:.3g} V")


@value_of("skin-stretch-loaded")
def _() -> ClaimValue:
    array = _array()
    skin = array.tissue.under_contactor(*array.cradle.size)
    tip = loaded_tip(array.bender, skin, array.actuator.largest_voltage)
    return ClaimValue((tip.deflection,), note=f"with {1e3 * tip.force:.3g} mN on the skin")


@value_of("skin-stretch-surface")
def _() -> ClaimValue:
    array = _array()
    apart = math.sqrt(_PRINTED_SURFACE / array.cradle.count)
    return ClaimValue(
        (array.cradle.active_area,),
        (_PRINTED_SURFACE,),
        note=f"60 contactors on 10 mm² would stand {1e3 * apart:.2g} mm apart",
    )


@value_of("skin-stretch-mass")
def _() -> ClaimValue:
    return ClaimValue((_array().budget.mass,), note="of the actuators alone, without clamps")


@value_of("skin-stretch-count")
def _() -> ClaimValue:
    return ClaimValue((float(_array().cradle.count),), note="in 10 columns and 6 rows")


@value_of("skin-stretch-volume")
def _() -> ClaimValue:
    return ClaimValue((_array().budget.volume,), note="of the actuators alone, without clamps")


@value_of("motor-tangential")
def _() -> ClaimValue:
    motor = assembled(load_actuator("biet2008-motor").motor)  # type: ignore[union-attr]
    small, large = (Working(amplitude=amplitude) for amplitude in _AMPLITUDES)
    faster = no_load_speed(motor, large) - no_load_speed(motor, small)
    # Where feet hardly leave the slider, they drag it back after they pushed it.
    slow = no_load_speed(motor, small)
    stronger = averaged(motor, large, speed=slow).thrust - averaged(motor, small, speed=slow).thrust
    return ClaimValue(
        (faster, stronger),
        note="faster without a load (m/s), and a larger thrust at the same speed (N), at 4 µm "
        "than at 1.5 µm",
    )


@value_of("motor-contact")
def _() -> ClaimValue:
    motor = assembled(load_actuator("biet2008-motor").motor)  # type: ignore[union-attr]

    def share(preload: float, amplitude: float) -> float:
        return averaged(motor, Working(amplitude=amplitude, preload=preload)).contact_share

    (light, hard), (small, large) = _PRELOADS, _AMPLITUDES
    pressed = share(hard, small) - share(light, small)
    swung = share(hard, small) - share(hard, large)
    return ClaimValue(
        (pressed, swung),
        note="how much longer feet touch under 20 N than under 10 N, and at 1.5 µm than at 4 µm",
    )
