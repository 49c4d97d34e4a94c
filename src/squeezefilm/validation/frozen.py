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
from typing import Any, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import Gas
from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.finger.fingertip import Finger, Skin
from squeezefilm.physics.contact.rough_contact import ContactLaw
from squeezefilm.physics.contact.sharing.balance import share_load
from squeezefilm.physics.contact.sharing.gas_table import FilmTable, film_table
from squeezefilm.physics.contact.sharing.levitation import (
    levitation_friction,
    levitation_scale,
    ridge_films,
    ridge_friction,
)
from squeezefilm.physics.contact.sharing.pad import pad_friction, pad_points

Kind = Literal["balance", "closed form", "ridges"]

MODELS: Mapping[str, Kind] = MappingProxyType(
    {"partial-levitation": "balance", "levitation": "closed form", "levitation-ridges": "ridges"}
)
"""The models that published directions are asked of, and what each solves: the balance of a film
with asperities of `FrozenContact.law`, or a film that lifts the contact off over a length fitted to
people, in closed form or solved over a ridge."""

WORDS: Mapping[Kind, str] = MappingProxyType(
    {
        "balance": f"film and {AsperityLaw().words}; all that touches slides",
        "closed form": "a film lifts the contact off over a length fitted to people on glass",
        "ridges": "a film solved over each ridge lifts it off over a length fitted to people",
    }
)


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
    evidence: Mapping[str, str] = field(default_factory=_evidence)

    @property
    def law(self) -> ContactLaw:
        """The law of contact on the frozen roughness: its heights grow with those of skin and face
        together."""
        skin = self.finger.skin_roughness
        factor = math.hypot(skin, self.roughness) / math.hypot(skin, FROZEN.roughness)
        return AsperityLaw().scaled(factor)

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
        if _kind(model) != "balance":
            met = np.array([here.amplitude])
            return float(here._lifted(model, met, ambient_pressure)[0])
        table = here._films(ambient_pressure)
        shared = share_load(table, here.law, here.amplitude, here.plateau_pressure, skin=skin)
        return float(shared.relative_friction)

    def pad_friction(self, model: str, ridge_angle: si.Radian) -> si.Dimensionless:
        """µ′/µ by a model of a whole pad over an antinode, its ridges turned by an angle (rad) out
        of the nodal lines, each place at its own balance. Raises as `relative_friction`."""
        points = pad_points(replace(self.finger, ridge_angle=ridge_angle))
        wave = np.abs(np.cos(np.pi * points.along / self.half_wavelength))
        if _kind(model) != "balance":
            return float(self._lifted(model, self.amplitude * wave, None) @ points.shares)
        films, pressure = self._films(None), self.plateau_pressure
        found = pad_friction(films, self.law, self.amplitude, wave, points.shares, pressure)
        return float(found.relative_friction[0])

    def _lifted(
        self, model: str, amplitude: si.MetreArray, ambient_pressure: si.Pascal | None
    ) -> si.DimensionlessArray:
        """µ′/µ at the amplitudes that a contact meets (m), lifted over a length fitted to people.
        Neither asperities nor the skin's vibration enter."""
        finger, load = self.finger, self.plateau_pressure
        if _kind(model) == "ridges":
            films = ridge_films(*self._film_of(ambient_pressure))
            return ridge_friction(films, amplitude, load, float(finger.ridge_length_at(self.speed)))
        pressure = load * finger.plateau_width / finger.ridge_period
        ambient = ambient_pressure or self.gas.ambient_pressure
        length = float(finger.decay_length_at(self.speed))
        return levitation_friction(amplitude / levitation_scale(length, pressure, ambient))

    def _film_of(self, ambient_pressure: si.Pascal | None) -> tuple[si.Hertz, si.Metre, Gas, str]:
        gas = self.gas if ambient_pressure is None else self.gas.at_pressure(ambient_pressure)
        return self.frequency, self.finger.plateau_width, gas, self.slip

    def _films(self, ambient_pressure: si.Pascal | None) -> FilmTable:
        return film_table(*self._film_of(ambient_pressure))


def _kind(name: str) -> Kind:
    if name not in MODELS:
        raise InputError(
            f"published directions are not asked of a model '{name}'."
            f"{si.did_you_mean(name, MODELS)} Models: {', '.join(MODELS)}"
        )
    return MODELS[name]


FROZEN = FrozenContact()
