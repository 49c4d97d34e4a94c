"""The friction of one display at one working point, as a law of the vibration amplitude.

The seam between what the film (and later the contact) computes and everything that needs friction:
predictions, curves, textures. Each law names its model.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from squeezefilm.contact import paper
from squeezefilm.contact.film_load import FilmLoad, FilmModel, film_load
from squeezefilm.contact.finger import Finger
from squeezefilm.display import Display, Surface
from squeezefilm.errors import InputError, OutOfRangeError, UnreachableError
from squeezefilm.film.gap import PaperGap
from squeezefilm.film.limits import PaperModel, contact_mean_pressure
from squeezefilm.materials import Gas
from squeezefilm.quantities import (
    Dimensionless,
    DimensionlessArray,
    DimensionlessLike,
    Hertz,
    Metre,
    MetreArray,
    MetreLike,
    Newton,
    Unit,
    did_you_mean,
    format_quantity,
    require,
)

FrictionModel = Literal[
    "paper2008", "paper2008-printed", "film-sealed", "film-open", "film-plateau", "film-smooth"
]
FRICTION_MODELS: tuple[FrictionModel, ...] = get_args(FrictionModel)
SOLVED_DEFAULT: FrictionModel = "film-sealed"
"""What takes the asymptote's place outside its range: the same equation and gap, solved."""

HIGHEST_AMPLITUDE: Metre = 50e-6


def is_solved(model: FrictionModel) -> bool:
    """Whether a model solves the film (and is slower by a factor of a hundred)."""
    return model.startswith("film-")


@dataclass(frozen=True)
class FrictionLaw:
    """µ′/µ as a function of the vibration amplitude, at one frequency and force, by one model.

    All models share the load the same way: what the film does not carry is in contact, at an
    unchanged friction coefficient (paper eq 14, corrected). They differ in the film.
    """

    surface: Surface
    finger: Finger
    gas: Gas
    half_wavelength: Metre
    frequency: Hertz
    normal_force: Newton
    model: FrictionModel

    def __post_init__(self) -> None:
        require("half_wavelength", self.half_wavelength, Unit("m"), above=0)
        require("frequency", self.frequency, Unit("Hz"), above=0)
        require("normal_force", self.normal_force, Unit("N"), above=0)
        if self.model not in FRICTION_MODELS:
            raise InputError(
                f"model = '{self.model}' is not known.{did_you_mean(self.model, FRICTION_MODELS)} "
                f"Allowed: {', '.join(FRICTION_MODELS)}"
            )

    def gap(self, amplitude: MetreLike) -> PaperGap:
        """The gap at an amplitude (m), antinode and groove at the centre of the contact."""
        return PaperGap(
            roughness=self.surface.roughness,
            vibration_amplitude=amplitude,
            ridge_amplitude=self.finger.ridge_amplitude,
            ridge_period=self.finger.ridge_period,
            wavelength=2 * self.half_wavelength,
            contact_length=self.finger.contact_length,
        )

    def load(self, amplitude: Metre) -> FilmLoad:
        """What the film carries at an amplitude (m), with its error. See `film_load`."""
        if self.model == "paper2008-printed":
            over = float(contact_mean_pressure(self.gap(amplitude), "paper2008-printed")) - 1
            return FilmLoad("paper2008", over, 0.0, float("nan"), "closed form, as printed")
        solved: FilmModel = self.model
        return film_load(
            self.gap(amplitude),
            self.frequency,
            self.gas,
            solved,
            plateau_width=self.finger.plateau_width,
        )

    def at(self, amplitude: Metre) -> Dimensionless:
        """µ′/µ (dimensionless, 0 to 1) at one amplitude (m)."""
        return float(self.curve(np.array([amplitude]))[0])

    def curve(self, amplitude: MetreArray) -> DimensionlessArray:
        """µ′/µ (dimensionless, 0 to 1) at an array of amplitudes (m), same shape (1-D)."""
        ambient = self.gas.ambient_pressure
        if not is_solved(self.model):
            return np.asarray(
                paper.relative_friction(
                    self.gap(amplitude), self.normal_force, ambient, self._closed_form
                )
            )
        pressures = np.array([1 + self.load(float(a)).over_pressure for a in np.ravel(amplitude)])
        return np.asarray(self._shared(pressures))

    def under(self, load: FilmLoad, amplitude: Metre) -> Dimensionless:
        """µ′/µ (dimensionless) with a film already solved at an amplitude (m), as `load` has it."""
        if not is_solved(self.model):
            return self.at(amplitude)
        return float(self._shared(1 + load.over_pressure))

    def _shared(self, mean_pressure: DimensionlessLike) -> DimensionlessLike:
        return paper.relative_friction_from_pressure(
            mean_pressure,
            self.normal_force,
            self.finger.contact_length,
            self.gas.ambient_pressure,
        )

    @property
    def _closed_form(self) -> PaperModel:
        return "paper2008-printed" if self.model == "paper2008-printed" else "paper2008"

    def amplitude_for(self, relative_friction: Dimensionless) -> Metre:
        """The least amplitude (m, zero-to-peak) that brings µ′/µ down to a wanted value.

        Raises `InputError` for a value outside [0, 1] and `UnreachableError` where no amplitude up
        to 50 µm does.
        """
        require("relative_friction", relative_friction, at_least=0, at_most=1)
        if not is_solved(self.model):
            return paper.vibration_amplitude_for(
                relative_friction,
                self.gap(0.0),
                self.normal_force,
                self.gas.ambient_pressure,
                self._closed_form,
            )
        return self._search(relative_friction)

    def _search(self, wanted: Dimensionless) -> Metre:
        from scipy.optimize import brentq

        if wanted == 1:
            return 0.0
        pressure = self.normal_force / self.finger.contact_length**2 / self.gas.ambient_pressure

        def excess(amplitude: float) -> float:
            return 1 - self.load(amplitude).over_pressure / pressure - wanted

        low, least = 0.0, 1.0
        for high in np.geomspace(2e-8, HIGHEST_AMPLITUDE, 24):
            left = excess(float(high))
            if left <= 0:
                return float(brentq(excess, max(low, 1e-9), high, xtol=1e-11, rtol=1e-6))
            low, least = float(high), min(least, left + wanted)
        raise UnreachableError(
            f"relative_friction = {wanted:.4g} is not reached by any vibration amplitude up to "
            f"{format_quantity(HIGHEST_AMPLITUDE, Unit('m'))}: the model '{self.model}' gives "
            f"{least:.4g} at the least; press less, take a smoother surface or ask for less"
        )

    def table(
        self, highest_amplitude: Metre, points: int | None = None
    ) -> Callable[[MetreArray], DimensionlessArray]:
        """The law as a fast function: a table, linear between its points, for many samples.

        Holds from 0 to `highest_amplitude`, raises `OutOfRangeError` outside. With the default
        points (257; 65 where the film is solved) it is within 1e-4 (1e-3) of the law for the
        paper's devices.
        """
        require("highest_amplitude", highest_amplitude, Unit("m"), above=0)
        count = points or (65 if is_solved(self.model) else 257)
        # Denser at small amplitudes, where the law bends within the roughness.
        grid = highest_amplitude * np.linspace(0.0, 1.0, count) ** 2
        law = self.curve(grid)
        if law[-1] == 0:
            # The law has a kink where the finger lifts off; a point of its own keeps it sharp.
            kink = self.amplitude_for(0.0)
            at = int(np.searchsorted(grid, kink))
            grid, law = np.insert(grid, at, kink), np.insert(law, at, 0.0)

        def friction(amplitude: MetreArray) -> DimensionlessArray:
            values = np.asarray(amplitude, dtype=float)
            # A hair of slack: an exponential envelope may overshoot its target by rounding.
            slack = 1e-9 * highest_amplitude
            if values.size and (values.min() < -slack or values.max() > highest_amplitude + slack):
                raise OutOfRangeError(
                    f"the friction law was tabulated for amplitudes from 0 to "
                    f"{highest_amplitude:.4g} m and asked at {values.min():.4g} to "
                    f"{values.max():.4g} m; tabulate it higher"
                )
            return np.asarray(np.interp(values, grid, law))

        return friction


def friction_law(
    display: Display,
    half_wavelength: Metre,
    frequency: Hertz,
    *,
    surface: Surface | None = None,
    normal_force: Newton | None = None,
    model: FrictionModel = SOLVED_DEFAULT,
) -> FrictionLaw:
    """The friction law of a display; surface and force default to the display's own."""
    return FrictionLaw(
        surface=surface or display.surface(),
        finger=display.finger,
        gas=display.gas,
        half_wavelength=half_wavelength,
        frequency=frequency,
        normal_force=display.finger.normal_force if normal_force is None else normal_force,
        model=model,
    )
