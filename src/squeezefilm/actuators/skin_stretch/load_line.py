"""A bending actuator against the skin: where its load line meets that of the skin, and how fast.

The actuator gives way as a spring: F = F_blocked − k x. The skin under one contactor is the contact
room's lumped fingertip (`FingerpadDynamics`: stiffness, damping, mass), here of one contactor.

What is published of the skin and could be read: it is linearly viscoelastic in loading and relaxes
for 12 s with the logarithm of time, and its stiffness grows with the normal force (Pataky, Latash
and Zatsiorsky 2005, J. Biomech. 38(7) 1441–1449, abstract); under large local traction it stiffens,
is more elastic across its ridges, and loses 80 % in a cycle (Wang and Hayward 2007, J. Biomech.
40(4) 851–860, abstract). No number of newtons per metre could be read there: `IMPLIED_STIFFNESS`
follows from what the source paper says of its array.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, cast

import numpy as np

from squeezefilm.actuators.skin_stretch.bimorph import Bender
from squeezefilm.core import quantities as si
from squeezefilm.physics.contact.finger.fingerpad import FingerpadDynamics

PUBLISHED_FREE: si.Metre = 0.1e-3
PUBLISHED_BLOCKED: si.Newton = 0.15
PUBLISHED_LOADED: si.Metre = 0.075e-3
"""Deflection of each of the paper's 60 actuators: free, blocked, and against a load whose force
stands in no text that could be read (the sentence breaks off after "0.075 mm and")."""

IMPLIED_STIFFNESS: si.NewtonPerMetre = 500.0
"""The skin's stiffness that a linear actuator of the three figures above works against: derived,
0.15 N (1 − 0.075/0.1) = 0.0375 N at 0.075 mm."""


@si.closed_form(positive="free_deflection actuator_stiffness", nonnegative="load_stiffness")
def loaded_deflection(
    free_deflection: si.MetreLike,
    actuator_stiffness: si.NewtonPerMetreLike,
    load_stiffness: si.NewtonPerMetreLike,
) -> si.MetreLike:
    """x = δ k/(k + k_s): where a linear actuator's load line meets that of a spring (m).

    Arguments (m, N/m, N/m) broadcast; the force there is k_s x. Raises `InputError` for a
    deflection or an actuator's stiffness not above 0, or a negative load. Source: statics.
    """
    return free_deflection * actuator_stiffness / (actuator_stiffness + load_stiffness)


@si.checked_numbers
@dataclass(frozen=True)
class LoadedTip:
    """An actuator with the skin at its tip: quasi-static `deflection` and `force` on the skin,
    `resonance_frequency` (undamped) and `bandwidth`, up to which the deflection stays within 3 dB
    of the quasi-static one; one mode, so for frequencies below the actuator's second (6 times its
    first)."""

    deflection: si.Metre
    force: si.Newton
    resonance_frequency: si.Hertz
    bandwidth: si.Hertz


@si.checked_numbers
def loaded_tip(bender: Bender, load: FingerpadDynamics, voltage: si.Volt) -> LoadedTip:
    """Tip of an actuator on the skin at a voltage (V, either sign).

    Whether the voltage undoes the poling is asked of `Bimorph.require_voltage`.
    """
    free = bender.deflection_per_volt * voltage
    x = math.copysign(
        float(loaded_deflection(abs(free), bender.stiffness, load.stiffness)) if free else 0.0, free
    )
    stiffness, mass = bender.stiffness + load.stiffness, bender.effective_mass + load.mass
    square = stiffness / mass
    damping = (load.damping / mass) ** 2
    crossings = []
    # |K/(K − Mω² + icω)|² is 1/2 or 2: two quadratics in ω², of which the least root counts.
    for share in (2.0, 0.5):
        middle, rest = damping - 2 * square, square**2 * (1 - share)
        root = middle**2 - 4 * rest
        if root >= 0:
            crossings += [(-middle - math.sqrt(root)) / 2, (-middle + math.sqrt(root)) / 2]
    first = min((crossing for crossing in crossings if crossing > 0), default=math.nan)
    return LoadedTip(
        x,
        load.stiffness * x,
        math.sqrt(square) / (2 * math.pi),
        math.sqrt(first) / (2 * math.pi),
    )


@si.checked_numbers
def tip_motion(
    bender: Bender,
    load: FingerpadDynamics,
    voltage: si.Volt,
    frequency: Annotated[si.HertzArray, si.AtLeast(0)],
) -> si.ComplexArray:
    """The complex amplitude of the tip (m) at frequencies (Hz) of a sinusoidal voltage (V).

    δ k/(k + k_s − (m + m_s) ω² + iωc), in the shape of `frequency`. One mode.
    """
    omega = 2 * np.pi * frequency
    mass = bender.effective_mass + load.mass
    dynamic = bender.stiffness + load.stiffness - mass * omega**2 + 1j * omega * load.damping
    drive = bender.deflection_per_volt * voltage * bender.stiffness
    return cast(si.ComplexArray, np.asarray(drive / dynamic))
