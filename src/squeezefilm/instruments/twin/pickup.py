"""What the twin's pickup hears of its plate, and what a sweep would say of it."""

from __future__ import annotations

import math
from typing import NamedTuple

from squeezefilm.core.compiled import compiled
from squeezefilm.instruments.control.gains import IdentifiedPlate
from squeezefilm.instruments.twin import plant_kernel as k
from squeezefilm.instruments.twin.settings import PickupModel, TwinSettings
from squeezefilm.instruments.twin.working_point import WorkingPoint

_PICKUP_RE, _PICKUP_IM = 11, 12


class Hearing(NamedTuple):
    """Numbers of a pickup: volts per metre of vibration, ohms for the motional current, the share
    of the capacitance's current that leaks, and noise (V)."""

    per_metre: float
    shunt: float
    feedthrough: float
    noise: float


def hearing(pickup: PickupModel) -> Hearing:
    """Numbers of a pickup; all 0 without one."""
    if pickup.kind == "none":
        return Hearing(0.0, 0.0, 0.0, 0.0)
    if pickup.kind == "sensing_patch":
        return Hearing(pickup.sensitivity, 0.0, 0.0, pickup.noise)
    return Hearing(0.0, pickup.shunt, pickup.feedthrough, pickup.noise)


def identified(point: WorkingPoint, settings: TwinSettings) -> IdentifiedPlate:
    """What a sweep would say of the twin's plate before it drifts, for `loop_gains`.

    Raises `InputError` for a plate or a pickup that no loop can use.
    """
    mode = point.mode
    ratio = mode.amplitude_per_volt / point.pickup_calibration(settings.pickup)
    return IdentifiedPlate(
        mode.resonance_frequency, mode.quality_factor, ratio * settings.amplifier.gain
    )


@compiled()
def heard(plant: k.State, ear: Hearing) -> complex:
    """The complex amplitude at the pickup's input (V) against the drive, with its noise."""
    s, n, c, _ = plant
    z = complex(s[k.Z_RE], s[k.Z_IM])
    frequency = n[k.CARRIER] * 1e-3 if n[k.CARRIER] > 0 else s[k.RESONANCE]
    leak = complex(0.0, ear.feedthrough * c[k.C_C0] * s[k.VOLTAGE])
    current = 2.0 * math.pi * frequency * (c[k.C_FACTOR] * s[k.CHARGE] * z + leak)
    seed, now = int(c[k.C_SEED]), n[k.NOW]
    noise = complex(k.gaussian(seed, _PICKUP_RE, now), k.gaussian(seed, _PICKUP_IM, now))
    return complex(ear.per_metre * z + ear.shunt * current + ear.noise * noise)
