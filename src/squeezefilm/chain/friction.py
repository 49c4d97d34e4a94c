"""The friction of one display at one frequency and force, as a law of amplitude and speed.

The seam between what film and contact compute and everything that needs friction: predictions,
curves, textures. Each law names its model.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cached_property
from typing import Annotated, cast

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.chain.amplitude_search import least_amplitude
from squeezefilm.chain.friction_models import (
    DEFAULT_MODEL,
    MODEL_KINDS,
    FrictionModel,
)
from squeezefilm.chain.friction_table import FrictionTable, tabulated
from squeezefilm.chain.pad_law import PadLaw
from squeezefilm.chain.pad_place import PadPlace
from squeezefilm.contact.sharing import paper
from squeezefilm.contact.sharing.film_load import FilmLoad, FilmModel, film_load
from squeezefilm.contact.sharing.pad import Limit
from squeezefilm.display import Display, Surface
from squeezefilm.film.closed.limits import PaperModel, contact_mean_pressure
from squeezefilm.film.gap import PaperGap, squeeze_number

TABLE_SPEEDS: si.MetrePerSecondArray = np.append(0.0, np.geomspace(1e-3, 2.0, 47))
"""Where a law that depends on the speed is tabulated: toward rest, and from creeping to faster than
fingers explore. Linear between; held beyond."""


class FrictionLaw(PadLaw):
    """µ′/µ as a function of amplitude and speed, at one frequency and force, by one model.

    "paper2008" and the "film-" models hold the gap and differ in the film; the "partial-levitation"
    models find the gap at which film and asperities carry the finger together, over each ridge or
    over all of them at once ("…-one-gap"). These take what the film does not carry to be in
    contact, at an unchanged friction coefficient (paper eq 14, corrected). The default,
    "partial-levitation-shear", takes friction to be in proportion to the real contact area, where
    the finger's law of asperities knows it, and what touches within a period to be elastic until
    it slips: it alone depends on `speed`, that of sliding, at which `at` and `curve` answer.
    Where the pad is, `PadLaw` says.
    """

    def by(self, model: FrictionModel) -> FrictionLaw:
        """The law by another model, over an antinode where that model knows no other place."""
        if MODEL_KINDS[model].film == "shared":
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
        """What the film carries at an amplitude (m), with its error. See `film_load`."""
        if self.model == "paper2008-printed":
            over = float(contact_mean_pressure(self.gap(amplitude), "paper2008-printed")) - 1
            return FilmLoad("paper2008", over, 0.0, float("nan"), "closed form, as printed")
        lifted = self.kind.friction == "lift"
        if self.kind.film == "shared":
            return self._lifted_load(amplitude) if lifted else self._shared_load(amplitude)
        gap, model = self.gap(amplitude), cast(FilmModel, self.model)
        width = self.finger.plateau_width
        return film_load(gap, self.frequency, self.gas, model, plateau_width=width)

    def _lifted_load(self, amplitude: si.Metre) -> FilmLoad:
        ambient = self.gas.ambient_pressure
        over = (1 - self.at(amplitude)) * self.contact_pressure / ambient
        gap = self.finger.contact_decay_length
        number = squeeze_number(self.frequency, self.contact_side, gap, self.gas.viscosity, ambient)
        return FilmLoad(self.model, over, 0.0, float(number), "closed form of 2016, length fitted")

    def _shared_load(self, amplitude: si.Metre) -> FilmLoad:
        shared = self.sharing(amplitude)
        # Over the whole contact, grooves included, as the other models have it.
        share = self.finger.plateau_width / self.finger.ridge_period
        over = share * float(shared.film_pressure[0]) / self.gas.ambient_pressure
        table = self._films
        return FilmLoad(
            self.model,
            over,
            over * table.relative_error,
            float(table.length / shared.mean_gap[0]) ** 2,
            f"{shared.ridge_points} points of ridges balanced, residual {shared.residual:.1e}; "
            f"film within {table.relative_error:.1e}",
        )

    @si.checked_numbers
    def over_speeds(
        self, amplitude: si.MetreArray, speed: si.MetrePerSecondArray, limit: Limit | None = None
    ) -> si.DimensionlessArray:
        """µ′/µ at speeds (m/s, from 0) and amplitudes (m), shape (speeds, amplitudes).

        Toward rest a constant tangential stiffness keeps what the least pressure of a period
        holds, one that follows the load nothing."""
        a, speeds = np.ravel(amplitude), np.ravel(speed)
        if not self.kind.knows_speed:
            return np.repeat(self.curve(a)[None, :], speeds.size, axis=0)
        if self.kind.friction == "lift":
            return self._lifted(a, speeds, limit or self.kind.limit)
        # A pad of thousands of ridges takes them in parts, within some 100 MB.
        parts = min(math.ceil(a.size * speeds.size * self.ridge_swings[0].size / 1e7), a.size)
        asked, kind = np.array_split(a, parts), limit or self.kind.limit
        return np.hstack([self._pad(one, speeds, limit=kind).relative_friction for one in asked])

    @si.checked_numbers
    def at(self, amplitude: si.Metre) -> si.Dimensionless:
        """µ′/µ (dimensionless, 0 to 1) at one amplitude (m)."""
        return float(self.curve(np.array([amplitude]))[0])

    @si.checked_numbers
    def curve(self, amplitude: si.MetreArray) -> si.DimensionlessArray:
        """µ′/µ (dimensionless, 0 to 1) at an array of amplitudes (m), same shape (1-D)."""
        ambient = self.gas.ambient_pressure
        if self.kind.film == "asymptote":
            found = paper.relative_friction(
                self.gap(amplitude), self.normal_force, ambient, self._closed_form
            )
            # As printed, the mean pressure of small vibrations is a hair below the ambient one.
            return np.minimum(found, 1.0)
        if self.kind.film == "shared":
            return self.friction_in(self.kind.limit, np.ravel(amplitude))
        pressures = np.array([1 + self.load(float(a)).over_pressure for a in np.ravel(amplitude)])
        return np.asarray(self._shared(pressures))

    @si.checked_numbers
    def under(self, load: FilmLoad, amplitude: si.Metre) -> si.Dimensionless:
        """µ′/µ (dimensionless) with a film already solved at an amplitude (m), as `load` has it."""
        if self.kind.film == "asymptote" or self.kind.knows_speed:
            return self.at(amplitude)
        if self.kind.film == "shared":
            # The contact grows with the force here, so the paper's fixed area will not do.
            carried = load.over_pressure * self.gas.ambient_pressure
            carried *= self.finger.contact_area(self.normal_force)
            return float(np.clip(1 - carried / self.normal_force, 0.0, 1.0))
        return float(self._shared(1 + load.over_pressure))

    def _shared(self, mean_pressure: si.DimensionlessLike) -> si.DimensionlessLike:
        return paper.relative_friction_from_pressure(
            mean_pressure,
            self.normal_force,
            self.finger.contact_length,
            self.gas.ambient_pressure,
        )

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
        if self.kind.film == "asymptote":
            still, ambient = self.gap(0.0), self.gas.ambient_pressure
            return paper.vibration_amplitude_for(
                relative_friction, still, self.normal_force, ambient, self._closed_form
            )
        return least_amplitude(self._falling, relative_friction, self.model, self.largest_amplitude)

    def _falling(self, amplitude: float) -> float:
        """µ′/µ that goes on falling where the finger floats, so that a search finds its way."""
        if self.kind.film == "shared":
            return self.at(amplitude)
        ambient = self.gas.ambient_pressure * self.finger.contact_length**2
        return 1 - self.load(amplitude).over_pressure * ambient / self.normal_force

    @si.checked_numbers
    def table(
        self, highest_amplitude: Annotated[si.Metre, si.Above(0.0)], points: int | None = None
    ) -> FrictionTable:
        """The law as a fast function: a table, linear between its points, for many samples.

        Holds from 0 to `highest_amplitude`, raises `OutOfRangeError` outside. With the default
        points (257; 65 where the film is solved) it is within 1e-4 (1e-3) of the law for the
        paper's devices; over speeds, tabulated at `TABLE_SPEEDS`, within 1e-2.
        """
        count = (257 if self.kind.film == "asymptote" else 65) if points is None else points
        si.require("points", count, at_least=2)
        # A row of its own for the speed that is asked for most.
        speeds = np.union1d(TABLE_SPEEDS, [self.speed]) if self.kind.knows_speed else None
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


def prepare() -> None:
    """Load the compiled code that a friction takes, before any is asked for."""
    from squeezefilm.display import load_display

    law = friction_law(load_display("biet2008-plate"), 10e-3, 30e3)
    # At rest no film is solved.
    law.felt_stiffness(0.0)
    law.limits(0.0)
