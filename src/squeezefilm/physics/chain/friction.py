"""The friction of one display at one frequency and force, as a law of amplitude and speed.

The seam between what film and contact compute and everything that needs friction: predictions,
curves, textures. Each law names its model.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Annotated, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.chain.friction_models import (
    DEFAULT_MODEL,
    MODEL_KINDS,
    FrictionModel,
)
from squeezefilm.physics.chain.friction_table import FrictionTable, tabulated
from squeezefilm.physics.chain.pad_law import PadLaw, least_amplitude
from squeezefilm.physics.chain.pad_place import PadPlace
from squeezefilm.physics.contact.sharing import paper
from squeezefilm.physics.contact.sharing.pad import Limit
from squeezefilm.physics.display import Display, Surface
from squeezefilm.physics.film.closed import PaperModel, contact_mean_pressure
from squeezefilm.physics.film.gap import PaperGap

TABLE_SPEEDS: si.MetrePerSecondArray = np.append(0.0, np.geomspace(1e-3, 2.0, 47))
"""Speeds at which a law that depends on the speed is tabulated: toward rest, and from creeping to
faster than fingers explore. Linear between; held beyond."""


class FilmLoad(NamedTuple):
    """The mean over-pressure of a film over contact and period, divided by ambient, and the
    solver's estimate of its absolute error (0 for a closed form)."""

    over_pressure: si.Dimensionless
    error: si.Dimensionless


class FrictionLaw(PadLaw):
    """Relative friction µ′/µ as a function of amplitude and speed, at one frequency and force, by
    one model.

    "paper2008" and "paper2008-printed" hold the gap and take what the film does not carry to be in
    contact, at an unchanged friction coefficient (paper eq 14, corrected and as printed).
    "levitation", the default, lifts the contact off over a length fitted to people, which grows
    with `speed`, that of sliding; "levitation-2016" over the published one. "partial-levitation"
    finds the gap at which film and asperities carry each ridge together: friction is in proportion
    to what asperities carry. `at` and `curve` answer at the law's own speed. Where the pad is,
    `PadLaw` says.
    """

    def by(self, model: FrictionModel) -> FrictionLaw:
        """The law by another model, over an antinode where that model knows no other place."""
        if MODEL_KINDS[model].shares_load:
            return replace(self, model=model)
        return replace(self, model=model, position=0.0, place=None)

    @cached_property
    def on_even_wave(self) -> FrictionLaw:
        """The law over an even wave: itself unless it has a place."""
        if self.place is None:
            return self
        even = replace(self, place=None)
        for known in ("asperities", "friction_coefficient", "_even_swings"):
            vars(even)[known] = getattr(self, known)
        return even

    @si.checked_numbers
    def gap(self, amplitude: si.MetreLike) -> PaperGap:
        """The gap at an amplitude (m), antinode and groove at the centre of the contact."""
        return PaperGap(
            roughness=self.surface.roughness,
            vibration_amplitude=amplitude,
            ridge_amplitude=self.finger.ridge_amplitude,
            ridge_period=self.finger.ridge_period,
            wavelength=2 * self.half_wavelength,
            contact_length=self.finger.contact_length,
        )

    @si.checked_numbers
    def load(self, amplitude: si.Metre) -> FilmLoad:
        """Load of the film at an amplitude (m) over the whole contact, grooves included."""
        ambient = self.gas.ambient_pressure
        if self.kind.friction == "lift":
            return FilmLoad((1 - self.at(amplitude)) * self.contact_pressure / ambient, 0.0)
        if not self.kind.shares_load:
            gap = self.gap(amplitude)
            return FilmLoad(float(contact_mean_pressure(gap, self._closed_form)) - 1, 0.0)
        share = self.finger.plateau_width / self.finger.ridge_period
        over = share * float(self.sharing(amplitude).film_pressure[0]) / ambient
        return FilmLoad(over, over * self._films.relative_error)

    @si.checked_numbers
    def over_speeds(
        self, amplitude: si.MetreArray, speed: si.MetrePerSecondArray, limit: Limit | None = None
    ) -> si.DimensionlessArray:
        """Relative friction µ′/µ at speeds (m/s, from 0) and amplitudes (m), shape (speeds,
        amplitudes)."""
        a, speeds = np.ravel(amplitude), np.ravel(speed)
        if not self.kind.fitted:
            return np.repeat(self.curve(a)[None, :], speeds.size, axis=0)
        return self._lifted(a, speeds, limit or "own")

    @si.checked_numbers
    def at(self, amplitude: si.Metre) -> si.Dimensionless:
        """Relative friction µ′/µ (dimensionless, 0 to 1) at one amplitude (m)."""
        return float(self.curve(np.array([amplitude]))[0])

    @si.checked_numbers
    def curve(self, amplitude: si.MetreArray) -> si.DimensionlessArray:
        """Relative friction µ′/µ (dimensionless, 0 to 1) at an array of amplitudes (m), same shape
        (1-D)."""
        if self.kind.shares_load:
            return self.friction_in("own", np.ravel(amplitude))
        found = paper.relative_friction(
            self.gap(amplitude), self.normal_force, self.gas.ambient_pressure, self._closed_form
        )
        # As printed, the mean pressure of small vibrations is a hair below the ambient one.
        return np.minimum(found, 1.0)

    @property
    def _closed_form(self) -> PaperModel:
        return "paper2008-printed" if self.model == "paper2008-printed" else "paper2008"

    @si.checked_numbers
    def amplitude_for(
        self, relative_friction: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)]
    ) -> si.Metre:
        """The least amplitude (m, zero-to-peak) that brings µ′/µ down to a wanted value.

        Raises `UnreachableError` where no amplitude up to `largest_amplitude` does.
        """
        if self.kind.shares_load:
            highest = self.largest_amplitude
            return least_amplitude(self.at, relative_friction, self.model, highest)
        still, ambient = self.gap(0.0), self.gas.ambient_pressure
        return paper.vibration_amplitude_for(
            relative_friction, still, self.normal_force, ambient, self._closed_form
        )

    @si.checked_numbers
    def table(
        self, highest_amplitude: Annotated[si.Metre, si.Above(0.0)], points: int | None = None
    ) -> FrictionTable:
        """The law as a fast function: a table, linear between its points, for many samples.

        Holds from 0 to `highest_amplitude`, raises `OutOfRangeError` outside. With the default
        points (257; 65 where film and asperities share the load) it is within 1e-4 (1e-3) of the
        law for the paper's devices; over speeds, tabulated at `TABLE_SPEEDS`, within 1e-2.
        """
        count = (65 if self.kind.shares_load else 257) if points is None else points
        si.require("points", count, at_least=2)
        # A row of its own for the speed that is asked for most.
        speeds = np.union1d(TABLE_SPEEDS, [self.speed]) if self.kind.fitted else None
        return tabulated(self, highest_amplitude, count, speeds)


@si.checked_numbers
def friction_law(
    display: Display,
    half_wavelength: si.Metre,
    frequency: si.Hertz,
    *,
    surface: Surface | None = None,
    normal_force: si.Newton | None = None,
    model: FrictionModel = DEFAULT_MODEL,
    position: si.Metre = 0.0,
    speed: si.MetrePerSecond | None = None,
    place: PadPlace | None = None,
) -> FrictionLaw:
    """The friction law of a display; surface, force and the finger's speed default to the display's
    own, the pad to an antinode."""
    return FrictionLaw(
        surface=surface or display.surface(),
        finger=display.finger,
        gas=display.gas,
        half_wavelength=half_wavelength,
        frequency=frequency,
        normal_force=display.finger.normal_force if normal_force is None else normal_force,
        model=model,
        position=position,
        speed=display.finger.speed if speed is None else speed,
        place=place,
    )
