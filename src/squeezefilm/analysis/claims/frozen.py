"""The one set of parameters that every claim on friction under vibration shares, and its models.

Nothing here is fitted: published curves are compared by `measure.fits.friction.friction_folder`.
The set is the same for all claims and all models; a claim changes only the quantity that its
statement is about.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.contact.asperities import (
    MINDLIN_RATIO,
    AsperityLaw,
    TangentialStiffness,
)
from squeezefilm.contact.finger.fingertip import Finger
from squeezefilm.contact.finger.skin import Skin
from squeezefilm.contact.rough_contact import ContactLaw, RoughContact
from squeezefilm.contact.sharing.balance import share_load
from squeezefilm.contact.sharing.gas_table import FilmTable, film_table
from squeezefilm.contact.sharing.levitation import levitation_friction, levitation_scale
from squeezefilm.contact.sharing.pad import PadPosture, pad_friction, pad_points
from squeezefilm.contact.sharing.shear import AsperityShear, sheared_friction
from squeezefilm.contact.sharing.tapping import tapping_friction
from squeezefilm.errors import InputError
from squeezefilm.materials import Gas


@dataclass(frozen=True)
class FrozenModel:
    """A model that published directions are asked of: its law of contact and of shear.

    `film` is False for contact alone, without a gas (`contact.sharing.tapping`); a model that is
    `lifted` is the closed form of `contact.sharing.levitation`, which takes neither law.
    """

    law: ContactLaw
    stiffness: TangentialStiffness
    film: bool = True
    lifted: bool = False

    @property
    def words(self) -> str:
        """What it is, in words."""
        if self.lifted:
            return "a film lifts the contact off over a length fitted to people on glass"
        if not self.film:
            return "taps of a linear skin that shears until it slips, no gas"
        shear = {
            "rigid": "all that touches slides",
            "constant": "elastic in shear until it slips, with a constant stiffness",
            "following": "elastic in shear until it slips, with a stiffness that follows the load",
        }
        return f"film and {self.law.words}; {shear[self.stiffness]}"


MODELS: Mapping[str, FrozenModel] = MappingProxyType(
    {
        "partial-levitation": FrozenModel(AsperityLaw(), "rigid"),
        "partial-levitation-shear": FrozenModel(RoughContact(), "following"),
        "levitation": FrozenModel(RoughContact(), "rigid", lifted=True),
        "intermittent-contact": FrozenModel(AsperityLaw(), "constant", film=False),
    }
)
"""The models by name, each law named here and not left to what a finger has by default."""


def _evidence() -> Mapping[str, str]:
    return MappingProxyType(
        {
            "finger.ridge_period": "published: Biet, Giraud and Lemaire-Semail, Table 1",
            "finger.plateau_width": "assumed: 150 to 350 µm are reported, illustrative",
            "finger.skin_roughness": "assumed; the laws of contact hold for this skin on a face "
            "of 0.6 µm, and their heights grow with both together",
            "gas": "published: viscosity and pressure of the paper; assumed: mean free path",
            "slip": "derived: the law that is in range from an atmosphere to a vacuum",
            "frequency": "published: the paper's stator",
            "amplitude": "published: the paper's stator",
            "half_wavelength": "published: the paper's stator, half of 18.7 mm",
            "roughness": "published: the paper's adhesive",
            "plateau_pressure": "assumed: 0.36 N on 1 cm², carried by 5/7 of it",
            "speed": "published: between the 77 and 86 mm/s of Smith, Gosselin and Houde 2002",
            "friction_coefficient": "assumed",
            "stiffness_ratio": "derived: Mindlin, incompressible bodies",
        }
    )


@dataclass(frozen=True)
class FrozenContact:
    """The parameters: a plateau at an antinode, under a skin that does not yield in a period."""

    finger: Finger = field(
        default_factory=lambda: Finger(
            10e-3, 50e-6, 350e-6, 0.5, plateau_width=250e-6, skin_roughness=0.6e-6
        )
    )
    gas: Gas = field(default_factory=lambda: Gas(1.85e-5, 1e5, 1.2, 67e-9))
    slip: str = "fukui-kaneko"
    frequency: si.Hertz = 40.5e3
    amplitude: si.Metre = 2e-6
    half_wavelength: si.Metre = 9.35e-3
    roughness: si.Metre = 0.6e-6
    plateau_pressure: si.Pascal = 5e3
    speed: si.MetrePerSecond = 0.08
    friction_coefficient: si.Dimensionless = 0.9
    stiffness_ratio: si.Dimensionless = MINDLIN_RATIO
    evidence: Mapping[str, str] = field(default_factory=_evidence)

    def law(self, model: str) -> ContactLaw:
        """The law of contact of a model on the frozen roughness: its heights grow with those of
        skin and face together. Raises `InputError` for a model that is not known."""
        law, skin = _model(model).law, self.finger.skin_roughness
        factor = math.hypot(skin, self.roughness) / math.hypot(skin, FROZEN.roughness)
        return law.scaled(factor)

    def relative_friction(
        self,
        model: str,
        *,
        ambient_pressure: si.Pascal | None = None,
        skin: Skin | None = None,
        **changes: Any,
    ) -> si.Dimensionless:
        """µ′/µ by a model, with what is given changed (`changes` by the names above) and all else
        as it is frozen. Raises `InputError` for a model that is not known."""
        here = replace(self, **changes)
        if _model(model).lifted:
            scale = here._levitation_scale(ambient_pressure)
            return float(levitation_friction(np.array([here.amplitude / scale]))[0])
        if not _model(model).film:
            # Without gas neither pressure nor a skin that the gas would move makes a difference.
            return here._tapped(model)
        table = here._films(ambient_pressure)
        shared = share_load(
            table, here.law(model), here.amplitude, here.plateau_pressure, skin=skin
        )
        return float(sheared_friction(shared, here._shear(model), here.frequency))

    def pad_friction(self, model: str, ridge_angle: si.Radian) -> si.Dimensionless:
        """µ′/µ by a model of a whole pad over an antinode, its ridges turned by an angle (rad) out
        of the nodal lines, each place at its own balance. Raises as `relative_friction`."""
        points = pad_points(replace(self.finger, ridge_angle=ridge_angle))
        if _model(model).lifted:
            wave = np.abs(np.cos(np.pi * points.along / self.half_wavelength))
            met = self.amplitude * wave / self._levitation_scale(None)
            return float(levitation_friction(met) @ points.shares)
        found = pad_friction(
            self._films(None),
            self.law(model),
            self.amplitude,
            self.half_wavelength,
            points.along,
            self.plateau_pressure,
            posture=PadPosture(shares=points.shares),
            shear=self._shear(model),
        )
        return float(found.relative_friction[0])

    def _levitation_scale(self, ambient_pressure: si.Pascal | None) -> si.Metre:
        finger, ambient = self.finger, ambient_pressure or self.gas.ambient_pressure
        pressure = self.plateau_pressure * finger.plateau_width / finger.ridge_period
        return levitation_scale(float(finger.decay_length_at(self.speed)), pressure, ambient)

    def _films(self, ambient_pressure: si.Pascal | None) -> FilmTable:
        gas = self.gas if ambient_pressure is None else self.gas.at_pressure(ambient_pressure)
        return film_table(self.frequency, self.finger.plateau_width, gas, self.slip)

    def _shear(self, model: str) -> AsperityShear:
        kind = _model(model).stiffness
        return AsperityShear(self.speed, self.friction_coefficient, kind, self.stiffness_ratio)

    def _tapped(self, model: str) -> si.Dimensionless:
        return tapping_friction(
            self.amplitude,
            self.frequency,
            self.speed,
            self.plateau_pressure,
            friction_coefficient=self.friction_coefficient,
            normal_stiffness=self.plateau_pressure / self.law(model).decay_length,
            stiffness_ratio=self.stiffness_ratio,
        ).relative_friction


def _model(name: str) -> FrozenModel:
    if name not in MODELS:
        raise InputError(
            f"published directions are not asked of a model '{name}'."
            f"{si.did_you_mean(name, MODELS)} Models: {', '.join(MODELS)}"
        )
    return MODELS[name]


FROZEN = FrozenContact()
