"""The one set of parameters that every claim on friction under vibration shares, and the published
directions that each model is asked for at it.

Nothing here is fitted: published curves are compared by `validation.published_friction`.
The set is the same for all claims and all models; a claim changes only the quantity that its
statement is about.

What is compared are directions and orders of magnitude, from abstracts.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, cast

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import Gas
from squeezefilm.physics.chain.friction import LAWS, FrictionLaw
from squeezefilm.physics.chain.pad_law import FrictionModel
from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.finger.fingertip import Finger, Skin
from squeezefilm.physics.contact.sharing.balance import share_load
from squeezefilm.physics.contact.sharing.gas_table import film_table
from squeezefilm.physics.display import Surface
from squeezefilm.validation.values import ClaimValue, Computes, value_of

MODELS: Mapping[str, str] = MappingProxyType(
    {
        "partial-levitation": f"film and {AsperityLaw().words}; all that touches slides",
        "levitation": "a film lifts the contact off over a length fitted to people on glass",
        "levitation-ridges": "a film solved over each ridge lifts it off over a length fitted to "
        "people",
    }
)
"""The models that published directions are asked of, with words for each."""


@dataclass(frozen=True)
class FrozenContact:
    """The parameters: a plateau at an antinode, under a skin that does not yield in a period."""

    finger: Finger = field(
        default_factory=lambda: Finger(
            10e-3,
            50e-6,
            350e-6,  # published: Biet, Giraud and Lemaire-Semail, Table 1
            0.5,
            plateau_width=250e-6,  # assumed: 150 to 350 µm are reported, illustrative
            # Assumed; the laws of contact hold for this skin on a face of 0.6 µm, and their heights
            # grow with both together.
            skin_roughness=0.6e-6,
            contact_area_exponent=0.0,
            asperities=AsperityLaw(),
        )
    )
    # Published: viscosity and pressure of the paper; assumed: the mean free path.
    gas: Gas = field(default_factory=lambda: Gas(1.85e-5, 1e5, 1.2, 67e-9))
    # The law that is in range from an atmosphere to a vacuum.
    slip: str = "fukui-kaneko"
    # Published: the paper's stator, with half of 18.7 mm, and its adhesive.
    frequency: si.Hertz = 40.5e3
    amplitude: si.Metre = 2e-6
    half_wavelength: si.Metre = 9.35e-3
    roughness: si.Metre = 0.6e-6
    # Assumed: 0.36 N on 1 cm², carried by 5/7 of it.
    plateau_pressure: si.Pascal = 5e3
    # Published: between the 77 and 86 mm/s of Smith, Gosselin and Houde 2002.
    speed: si.MetrePerSecond = 0.08

    def law(self, model: str) -> FrictionLaw:
        """The friction law of a model at these parameters, the pad over an antinode. Raises
        `InputError` for a model that published directions are not asked of."""
        if model not in MODELS:
            raise InputError(
                f"published directions are not asked of a model '{model}'."
                f"{si.did_you_mean(model, MODELS)} Models: {', '.join(MODELS)}"
            )
        finger, asked = self.finger, cast(FrictionModel, model)
        share = finger.plateau_width / finger.ridge_period
        return LAWS[asked](
            surface=Surface("", self.roughness, 1.0),
            finger=finger,
            gas=self.gas,
            half_wavelength=self.half_wavelength,
            frequency=self.frequency,
            normal_force=self.plateau_pressure * share * finger.contact_length**2,
            model=asked,
            speed=self.speed,
            slip=self.slip,
        )

    def relative_friction(
        self,
        model: str,
        *,
        ambient_pressure: si.Pascal | None = None,
        skin: Skin | None = None,
        **changes: Any,
    ) -> si.Dimensionless:
        """µ′/µ by a model, with what is given changed (`changes` by the names above) and all else
        as it is frozen. Raises as `law`."""
        here = replace(self, **changes)
        if ambient_pressure is not None:
            here = replace(here, gas=here.gas.at_pressure(ambient_pressure))
        law = here.law(model)
        if skin is None or law.kind.friction != "load":
            return float(law.ridge_friction(np.array([here.amplitude]))[0])
        films = film_table(here.frequency, here.finger.plateau_width, here.gas, here.slip)
        pressure = here.plateau_pressure
        shared = share_load(films, law.asperities, here.amplitude, pressure, skin=skin)
        return float(shared.relative_friction)

    def pad_friction(self, model: str, ridge_angle: si.Radian) -> si.Dimensionless:
        """µ′/µ by a model of a whole pad over an antinode, its ridges turned by an angle (rad) out
        of the nodal lines, each place at its own balance. Raises as `law`."""
        turned = replace(self, finger=replace(self.finger, ridge_angle=ridge_angle))
        return turned.law(model).at(self.amplitude)


FROZEN = FrozenContact()


# 0.017 atm (Pa).
_THIN = 0.017 * 101325.0

DIRECTION_VALUES: dict[str, Computes] = {}
"""What computes a published direction, from a model's name."""
_direction = functools.partial(value_of, values=DIRECTION_VALUES)


@_direction("vacuum")
def _(model: str) -> ClaimValue:
    def left(slip: str, speed: float = FROZEN.speed) -> float:
        at = replace(FROZEN, slip=slip, speed=speed)
        inside = at.relative_friction(model, ambient_pressure=_THIN)
        return (1 - inside) / (1 - at.relative_friction(model))

    shares = left("fukui-kaneko"), left("veijola")
    if model == "levitation":
        return ClaimValue(shares)
    path = FROZEN.gas.at_pressure(_THIN).mean_free_path
    return ClaimValue(
        shares,
        note=f"the mean free path is {1e6 * path:.1f} µm there, about as wide as the gap: the laws "
        "of Fukui and Kaneko and of Veijola are in range, that of first order is not and would "
        f"give {left('first'):.3f}; at 300 mm/s {left('fukui-kaneko', 0.3):.3f}",
    )


@_direction("half-atmosphere")
def _(model: str) -> ClaimValue:
    half, whole = (FROZEN.relative_friction(model, ambient_pressure=p) for p in (5e4, 1e5))
    return ClaimValue((abs(half - whole),), note=f"signed, {half - whole:+.4f}")


@_direction("reach")
def _(model: str) -> ClaimValue:
    value = 1 - FROZEN.relative_friction(
        model, roughness=5e-9, amplitude=3e-6, plateau_pressure=2e3
    )
    rough = 1 - FROZEN.relative_friction(model, amplitude=3e-6)
    return ClaimValue(
        (value,),
        note="glass of 5 nm, 3 µm at 40.5 kHz, 2 kPa on the plateaus (0.14 N on 1 cm²), all of "
        f"them our choice; on the frozen roughness and load {rough:.3f}",
    )


def _gain(model: str, name: str, texts: tuple[str, str], values: tuple[float, float]) -> ClaimValue:
    """The fall of friction from the first to the second value of a parameter."""
    changed = (replace(FROZEN, **{name: value}) for value in values)  # type: ignore[arg-type]
    low, high = (pad.relative_friction(model) for pad in changed)
    return ClaimValue((low - high,), note=f"µ′/µ {low:.3f} at {texts[0]}, {high:.3f} at {texts[1]}")


@_direction("frequency")
def _(model: str) -> ClaimValue:
    return _gain(model, "frequency", ("30 kHz", "60 kHz"), (30e3, 60e3))


@_direction("amplitude")
def _(model: str) -> ClaimValue:
    return _gain(model, "amplitude", ("1 µm", "3 µm"), (1e-6, 3e-6))


@_direction("roughness")
def _(model: str) -> ClaimValue:
    return _gain(model, "roughness", ("0.6 µm", "0.2 µm"), (0.6e-6, 0.2e-6))


@_direction("speed")
def _(model: str) -> ClaimValue:
    return _gain(model, "speed", ("300 mm/s", "30 mm/s"), (0.3, 0.03))


@_direction("load")
def _(model: str) -> ClaimValue:
    light, hard = (
        FROZEN.relative_friction(model, plateau_pressure=factor * FROZEN.plateau_pressure)
        for factor in (1, 4)
    )
    return ClaimValue(
        (abs(hard / light - 1),),
        note=f"µ′/µ {light:.3f} at the frozen load, {hard:.3f} at four times it",
    )


@_direction("damping")
def _(model: str) -> ClaimValue:
    inertia = Skin().mass_per_area * (2 * math.pi * FROZEN.frequency) ** 2

    def gain(stiffness: float) -> float:
        free, damped = (
            FROZEN.relative_friction(
                model, skin=Skin(stiffness_per_area=stiffness, damping_per_area=damping)
            )
            for damping in (0.0, 1e6)
        )
        return free - damped

    return ClaimValue(
        (gain(1.1 * inertia),),
        note="a damping of 1 MPa·s/m on an elastic skin whose stiffness is 1.1 times its inertia; "
        f"with twice its inertia {gain(2 * inertia):+.4f}, and on the default skin, which is a "
        f"mass without stiffness, {gain(0.0):+.4f}",
    )


@_direction("orientation")
def _(model: str) -> ClaimValue:
    along, slanted, across = (
        FROZEN.pad_friction(model, math.radians(angle)) for angle in (0, 45, 90)
    )
    found = along, slanted, across
    return ClaimValue(
        (max(found) - min(found),),
        note=f"µ′/µ of the pad {along:.3f} with ridges along the nodal lines, {slanted:.3f} at "
        f"45°, {across:.3f} across them",
    )
