"""Published observations on friction under vibration, against one frozen set of parameters.

No published friction curve could be read, so nothing here is fitted: `FROZEN` is the same for all
of these claims, and each changes only the quantity that its statement is about. What is compared
are directions and orders of magnitude, from abstracts.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

from squeezefilm import quantities as si
from squeezefilm.analysis.claims.values import ClaimValue, value_of
from squeezefilm.contact.finger.fingertip import Finger
from squeezefilm.contact.finger.skin import Skin
from squeezefilm.contact.sharing.balance import share_load
from squeezefilm.contact.sharing.gas_table import film_table
from squeezefilm.contact.sharing.tapping import tapping_friction
from squeezefilm.materials import Gas


def _evidence() -> Mapping[str, str]:
    return MappingProxyType(
        {
            "finger.ridge_period": "published: Biet, Giraud and Lemaire-Semail, Table 1",
            "finger.plateau_width": "assumed: 150 to 350 µm are reported, illustrative",
            "finger.asperities": "assumed: 5 kPa at 2 µm, decay 0.6 µm, illustrative",
            "finger.skin_roughness": "assumed",
            "gas": "published: viscosity and pressure of the paper; assumed: mean free path",
            "slip": "derived: first order, good to Kn 0.1; beyond it the notes give another law",
            "frequency": "published: the paper's stator",
            "amplitude": "published: the paper's stator",
            "roughness": "published: the paper's adhesive",
            "plateau_pressure": "assumed: 0.36 N on 1 cm², carried by 5/7 of it",
        }
    )


@dataclass(frozen=True)
class FrozenContact:
    """The parameters that all claims about friction share: a plateau at an antinode, rigid skin."""

    finger: Finger = field(default_factory=lambda: Finger(10e-3, 50e-6, 350e-6, 0.5))
    gas: Gas = field(default_factory=lambda: Gas(1.85e-5, 1e5, 1.2, 67e-9))
    frequency: si.Hertz = 40.5e3
    amplitude: si.Metre = 2e-6
    roughness: si.Metre = 0.6e-6
    plateau_pressure: si.Pascal = 5e3
    evidence: Mapping[str, str] = field(default_factory=_evidence)

    def relative_friction(
        self,
        *,
        ambient_pressure: si.Pascal | None = None,
        slip: str = "first",
        skin: Skin | None = None,
        **changes: Any,
    ) -> si.Dimensionless:
        """µ′/µ with what is given changed (`changes` by the names above) and all else as it is
        frozen."""
        here = replace(self, **changes)
        gas = here.gas if ambient_pressure is None else here.gas.at_pressure(ambient_pressure)
        table = film_table(here.frequency, here.finger.plateau_width, gas, slip)
        law = here.finger.asperity_law(here.roughness)
        shared = share_load(table, law, here.amplitude, here.plateau_pressure, skin=skin)
        return float(shared.relative_friction)


FROZEN = FrozenContact()


@value_of("contact-near-vacuum")
def _() -> ClaimValue:
    def left(slip: str) -> float:
        inside = FROZEN.relative_friction(ambient_pressure=2e3, slip=slip)
        return (1 - inside) / (1 - FROZEN.relative_friction(slip=slip))

    return ClaimValue(
        (left("first"),),
        note="the mean free path is 3.4 µm there, where first-order slip is out of its range: the "
        f"law of Fukui and Kaneko gives {left('fukui-kaneko'):.3f}",
    )


@value_of("contact-half-atmosphere")
def _() -> ClaimValue:
    change = FROZEN.relative_friction(ambient_pressure=0.5e5) - FROZEN.relative_friction()
    return ClaimValue(
        (abs(change),),
        note=f"signed, {change:+.4f}: at half the pressure the film is half as stiff, and at twice "
        "the squeeze number it leaks less",
    )


@value_of("contact-reach")
def _() -> ClaimValue:
    value = 1 - FROZEN.relative_friction(roughness=5e-9, amplitude=3e-6, plateau_pressure=2e3)
    rough = 1 - FROZEN.relative_friction(amplitude=3e-6)
    return ClaimValue(
        (value,),
        note="glass of 5 nm, 3 µm at 40.5 kHz, 2 kPa on the plateaus (0.14 N on 1 cm²), all of "
        f"them our choice; on the frozen roughness and load {rough:.3f}",
    )


@value_of("contact-frequency")
def _() -> ClaimValue:
    low, high = (FROZEN.relative_friction(frequency=f) for f in (30e3, 60e3))
    return ClaimValue((low - high,), note=f"µ′/µ {low:.3f} at 30 kHz, {high:.3f} at 60 kHz")


@value_of("contact-amplitude")
def _() -> ClaimValue:
    low, high = (FROZEN.relative_friction(amplitude=a) for a in (1e-6, 3e-6))
    return ClaimValue((low - high,), note=f"µ′/µ {low:.3f} at 1 µm, {high:.3f} at 3 µm")


@value_of("contact-roughness")
def _() -> ClaimValue:
    rough, smooth = (FROZEN.relative_friction(roughness=r) for r in (0.6e-6, 0.2e-6))
    return ClaimValue((rough - smooth,), note=f"µ′/µ {rough:.3f} at 0.6 µm, {smooth:.3f} at 0.2 µm")


@value_of("contact-damping")
def _() -> ClaimValue:
    def gain(stiffness: float) -> float:
        free, damped = (
            FROZEN.relative_friction(
                skin=Skin(stiffness_per_area=stiffness, damping_per_area=damping)
            )
            for damping in (0.0, 1e6)
        )
        return free - damped

    # A stiffness of twice the inertia: the skin follows the pressure in phase.
    hard = 2 * Skin().mass_per_area * (2 * math.pi * FROZEN.frequency) ** 2
    return ClaimValue(
        (gain(0.0),),
        note="a damping of 1 MPa·s/m on the frozen skin, which is inertial; on a skin whose "
        f"stiffness is twice its inertia the change is {gain(hard):+.4f}, the observed direction",
    )


@value_of("contact-tapping-load")
def _() -> ClaimValue:
    low, high = (
        tapping_friction(
            FROZEN.amplitude, FROZEN.frequency, 0.1, factor * FROZEN.plateau_pressure
        ).relative_friction
        for factor in (1, 4)
    )
    return ClaimValue(
        (abs(high / low - 1),),
        note="the competing mechanism, without gas; exact by construction, since the stiffness of "
        "exponential asperities grows with the load",
    )


@value_of("contact-tapping-speed")
def _() -> ClaimValue:
    slow, fast = (
        tapping_friction(
            FROZEN.amplitude, FROZEN.frequency, speed, FROZEN.plateau_pressure
        ).relative_friction
        for speed in (0.03, 0.3)
    )
    return ClaimValue(
        (fast - slow,),
        note=f"the competing mechanism, without gas: µ′/µ {slow:.3f} at 30 mm/s, {fast:.3f} at "
        "300 mm/s; partial levitation does not depend on the speed",
    )
