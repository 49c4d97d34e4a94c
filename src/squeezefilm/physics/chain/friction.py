"""The friction of one display at one frequency and force, as a law of amplitude and speed.

The seam between what film and contact compute and everything that needs friction: predictions,
curves, textures. Each law names its model.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import fields, replace
from functools import cached_property
from typing import Annotated, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, SqueezefilmError
from squeezefilm.physics.chain.pad_law import (
    DEFAULT_MODEL,
    MODEL_KINDS,
    FrictionModel,
    PadLaw,
    require_tabulated,
)
from squeezefilm.physics.chain.pad_place import PadPlace
from squeezefilm.physics.contact.sharing import levitation
from squeezefilm.physics.contact.sharing.levitation import (
    PUBLISHED_DECAY_LENGTH,
    levitation_friction,
    levitation_scale,
    published_rest_gap,
    ridge_films,
    ridge_friction,
)
from squeezefilm.physics.contact.sharing.pad import FrictionRipple, Limit
from squeezefilm.physics.display import Display, Surface
from squeezefilm.physics.film.closed import PaperModel, contact_mean_pressure
from squeezefilm.physics.film.gap import PaperGap
from squeezefilm.physics.render.program.inverse import FrictionTable

TABLE_SPEEDS: si.MetrePerSecondArray = np.append(0.0, np.geomspace(1e-3, 2.0, 47))
"""Speeds at which a law that depends on the speed is tabulated: toward rest, and from creeping to
faster than fingers explore. Linear between; held beyond."""
_RIPPLE_POSITIONS = 24


class FilmLoad(NamedTuple):
    """The mean over-pressure of a film over contact and period, divided by ambient, and the
    solver's estimate of its absolute error (0 for a closed form)."""

    over_pressure: si.Dimensionless
    error: si.Dimensionless


class FrictionLaw(PadLaw):
    """Relative friction µ′/µ as a function of amplitude and speed, at one frequency and force, by
    one model.

    This one is "partial-levitation": at the gap where film and asperities carry each ridge together
    friction is in proportion to what asperities carry. `LAWS` has a class for every other model;
    `friction_law` and `by` choose it. `at` and `curve` answer at the law's own speed. Where the pad
    is, `PadLaw` says.
    """

    def __post_init__(self) -> None:
        assert LAWS[self.model] is type(self), f"'{self.model}' is a {LAWS[self.model].__name__}"
        super().__post_init__()

    def by(self, model: FrictionModel) -> FrictionLaw:
        """The law by another model, over an antinode where that model knows no other place."""
        same = {field.name: getattr(self, field.name) for field in fields(self)}
        if not MODEL_KINDS[model].shares_load:
            same |= {"position": 0.0, "place": None}
        return LAWS[model](**same | {"model": model})

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
        share = self.finger.plateau_width / self.finger.ridge_period
        pressure = float(self.sharing(amplitude).film_pressure[0])
        over = share * pressure / self.gas.ambient_pressure
        return FilmLoad(over, over * self._films.relative_error)

    @si.checked_numbers
    def friction_in(self, limit: Limit, amplitude: si.MetreArray) -> si.DimensionlessArray:
        """Relative friction µ′/µ in a limit of the skin at amplitudes (m), shape (n,), at the law's
        speed: each ridge at its own balance ("own", a skin compliant at rest, the default) or all
        tied to one mean gap ("one-gap")."""
        return np.asarray(self.over_speeds(amplitude, np.array([self.speed]), limit)[0])

    @si.checked_numbers
    def ridge_friction(self, amplitude: si.MetreArray) -> si.DimensionlessArray:
        """Relative friction µ′/µ of one ridge at the amplitudes that it meets (m), shape (n,): the
        pad's in the limit "own" is the mean over its ridges."""
        return self._pad(amplitude, np.ones(1), np.ones(1), "own").relative_friction

    @si.checked_numbers
    def over_speeds(
        self, amplitude: si.MetreArray, speed: si.MetrePerSecondArray, limit: Limit = "own"
    ) -> si.DimensionlessArray:
        """Relative friction µ′/µ at speeds (m/s, from 0) and amplitudes (m), shape (speeds,
        amplitudes), in a limit of the skin as `friction_in` has it."""
        alike = self.sharing(np.ravel(amplitude), limit).relative_friction
        return np.repeat(alike[None, :], np.size(speed), 0)

    @si.checked_numbers
    def at(self, amplitude: si.Metre) -> si.Dimensionless:
        """Relative friction µ′/µ (dimensionless, 0 to 1) at one amplitude (m)."""
        return float(self.curve(np.array([amplitude]))[0])

    @si.checked_numbers
    def curve(self, amplitude: si.MetreArray) -> si.DimensionlessArray:
        """Relative friction µ′/µ (dimensionless, 0 to 1) at an array of amplitudes (m), same shape
        (1-D)."""
        return self.friction_in("own", np.ravel(amplitude))

    @si.checked_numbers
    def ripple(self, amplitude: si.Metre) -> FrictionRipple:
        """Relative friction µ′/µ along an even wave at an amplitude (m), each ridge by itself, as
        the pad crosses the wave's nodes over half a wavelength. Raises `InputError` for a model
        that knows the finger over an antinode only."""
        position = np.arange(_RIPPLE_POSITIONS) / _RIPPLE_POSITIONS * self.half_wavelength
        along = [replace(self, place=None, position=float(x)) for x in position]
        friction = [law.friction_in("own", np.array([amplitude]))[0] for law in along]
        return FrictionRipple(position, np.array(friction), self.contact_side, self.half_wavelength)

    @si.checked_numbers
    def amplitude_for(
        self, relative_friction: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)]
    ) -> si.Metre:
        """The least amplitude (m, zero-to-peak) that brings µ′/µ down to a wanted value.

        Raises `UnreachableError` where no amplitude up to `largest_amplitude` does.
        """
        highest = self.largest_amplitude
        return levitation.least_amplitude(self.at, relative_friction, self.model, highest)

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
        # Denser at small amplitudes, where the law bends within the roughness.
        grid = highest_amplitude * np.linspace(0.0, 1.0, count) ** 2
        if self.kind.fitted:
            # A row of its own for the speed that is asked for most.
            speeds = np.union1d(TABLE_SPEEDS, [self.speed])
            return FrictionTable(grid, speeds, self.over_speeds(grid, speeds), self.speed)
        known = self.curve(grid)
        if known[-1] == 0:
            # The law has a kink where the finger lifts off; a point of its own keeps it sharp.
            kink = self.amplitude_for(0.0)
            at = int(np.searchsorted(grid, kink))
            grid, known = np.insert(grid, at, kink), np.insert(known, at, 0.0)
        return FrictionTable(grid, np.zeros(1), known[None, :], self.speed)


class AsymptoteLaw(FrictionLaw):
    """The law of "paper2008" and "paper2008-printed": what the film does not carry at the paper's
    gap is in contact, at an unchanged friction coefficient (paper eq 14, corrected and as printed).

    Raises `InputError` for a position or place: it knows the finger over an antinode only.
    """

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.position != 0 or self.place is not None:
            raise InputError(
                f"the model '{self.model}' knows the finger over an antinode only; ask a "
                "levitation model, or leave position and place out",
                quantity="place" if self.place is not None else "position",
            )

    @property
    def _closed_form(self) -> PaperModel:
        return "paper2008-printed" if self.model == "paper2008-printed" else "paper2008"

    @si.checked_numbers
    def load(self, amplitude: si.Metre) -> FilmLoad:
        """Load of the film at an amplitude (m) over the whole contact, grooves included."""
        gap = self.gap(amplitude)
        return FilmLoad(float(contact_mean_pressure(gap, self._closed_form)) - 1, 0.0)

    @si.checked_numbers
    def over_speeds(
        self, amplitude: si.MetreArray, speed: si.MetrePerSecondArray, limit: Limit = "own"
    ) -> si.DimensionlessArray:
        """Relative friction µ′/µ at amplitudes (m), shape (speeds, amplitudes), whichever the limit
        and the speed (m/s): this gap does not yield."""
        gap = self.gap(np.ravel(amplitude))
        share = levitation.relative_friction(
            gap, self.normal_force, self.gas.ambient_pressure, self._closed_form
        )
        # As printed, the mean pressure of small vibrations is a hair below the ambient one.
        return np.repeat(np.minimum(share, 1.0)[None, :], np.size(speed), 0)

    @si.checked_numbers
    def amplitude_for(
        self, relative_friction: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)]
    ) -> si.Metre:
        """The least amplitude (m, zero-to-peak) that brings µ′/µ down to a wanted value.

        Raises `UnreachableError` where no amplitude up to 50 µm does.
        """
        still, ambient = self.gap(0.0), self.gas.ambient_pressure
        return levitation.vibration_amplitude_for(
            relative_friction, still, self.normal_force, ambient, self._closed_form
        )


class LiftedLaw(FrictionLaw):
    """The law of "levitation-2016": a film lifts the contact off over the published length."""

    @si.checked_numbers
    def load(self, amplitude: si.Metre) -> FilmLoad:
        """Load of the film at an amplitude (m) over the whole contact, grooves included."""
        ambient = self.gas.ambient_pressure
        return FilmLoad((1 - self.at(amplitude)) * self.contact_pressure / ambient, 0.0)

    @si.checked_numbers
    def ridge_friction(self, amplitude: si.MetreArray) -> si.DimensionlessArray:
        """Relative friction µ′/µ of one ridge at the amplitudes that it meets (m), shape (n,)."""
        return self._lifted_ridge(amplitude, self.speed)

    @si.checked_numbers
    def over_speeds(
        self, amplitude: si.MetreArray, speed: si.MetrePerSecondArray, limit: Limit = "own"
    ) -> si.DimensionlessArray:
        """Relative friction µ′/µ at speeds (m/s, from 0) and amplitudes (m), shape (speeds,
        amplitudes): the mean over ridges that each meet their own amplitude, or one film that meets
        the root of their mean square."""
        met, shares = self.ridge_swings
        require_tabulated(amplitude, met)
        if limit == "one-gap":
            met, shares = np.sqrt(met**2 @ shares)[None], np.ones(1)
        at_ridges = np.ravel(amplitude)[:, None] * met
        speeds = np.ravel(speed).tolist()
        return np.stack([self._lifted_ridge(at_ridges, pace) @ shares for pace in speeds])

    def _lifted_ridge(
        self, amplitude: si.MetreArray, speed: si.MetrePerSecond
    ) -> si.DimensionlessArray:
        """Relative friction µ′/µ of a ridge at the amplitudes that it meets (m), any shape."""
        pressure, ambient = self.contact_pressure, self.gas.ambient_pressure
        scale = levitation_scale(PUBLISHED_DECAY_LENGTH, pressure, ambient)
        return levitation_friction(amplitude / scale, published_rest_gap(pressure))


class FittedLaw(LiftedLaw):
    """The law of "levitation", the default: a film lifts the contact off over a length fitted to
    people, which grows with `speed`, that of sliding."""

    def _lifted_ridge(
        self, amplitude: si.MetreArray, speed: si.MetrePerSecond
    ) -> si.DimensionlessArray:
        length = float(self.finger.decay_length_at(speed))
        scale = levitation_scale(length, self.contact_pressure, self.gas.ambient_pressure)
        return levitation_friction(amplitude / scale)


class RidgesLaw(FittedLaw):
    """The law of "levitation-ridges": the same with the solved film over each ridge."""

    def _lifted_ridge(
        self, amplitude: si.MetreArray, speed: si.MetrePerSecond
    ) -> si.DimensionlessArray:
        load = self.finger.plateau_pressure(self.normal_force)
        films = ridge_films(self.frequency, self.finger.plateau_width, self.gas, self.slip)
        return ridge_friction(films, amplitude, load, self.finger.ridge_length_at(speed))


LAWS: dict[FrictionModel, type[FrictionLaw]] = {
    "paper2008": AsymptoteLaw,
    "paper2008-printed": AsymptoteLaw,
    "levitation-2016": LiftedLaw,
    "levitation-ridges": RidgesLaw,
    "partial-levitation": FrictionLaw,
    "levitation": FittedLaw,
}
"""The law of each model."""


def where_known(
    friction: Callable[[si.MetreArray], si.DimensionlessArray], amplitude: si.MetreArray
) -> si.DimensionlessArray:
    """What a `friction` gives (1) at amplitudes (m), both of shape (n,); NaN where it refuses."""
    with contextlib.suppress(SqueezefilmError):
        return friction(amplitude)
    known = np.full(amplitude.size, np.nan)
    for k in range(amplitude.size):
        with contextlib.suppress(SqueezefilmError):
            known[k] = friction(amplitude[k : k + 1])[0]
    return known


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
    return LAWS[model](
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
