"""The friction of one display at one working point, as a law of the vibration amplitude.

The seam between what film and contact compute and everything that needs friction: predictions,
curves, textures. Each law names its model.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, cast

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.chain.friction_models import DEFAULT_MODEL, MODEL_KINDS, FrictionModel, ModelKind
from squeezefilm.chain.friction_table import FrictionTable
from squeezefilm.contact.asperities import AsperityLaw
from squeezefilm.contact.finger.fingertip import Finger
from squeezefilm.contact.sharing import paper
from squeezefilm.contact.sharing.balance import share_load
from squeezefilm.contact.sharing.film_load import FilmLoad, FilmModel, film_load
from squeezefilm.contact.sharing.gas_table import FilmTable, film_table
from squeezefilm.contact.sharing.pad import (
    FrictionRipple,
    Limit,
    PadFriction,
    PadPosture,
    friction_ripple,
    pad_friction,
    ridge_points,
)
from squeezefilm.contact.sharing.shear import (
    AsperityShear,
    TangentialStiffness,
    sheared_friction,
)
from squeezefilm.contact.sharing.tapping import tapping_friction
from squeezefilm.display import Display, Surface
from squeezefilm.errors import InputError, OutOfRangeError, UnreachableError
from squeezefilm.film.closed.limits import PaperModel, contact_mean_pressure
from squeezefilm.film.gap import PaperGap
from squeezefilm.materials import Gas

HIGHEST_AMPLITUDE: si.Metre = 50e-6


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class FrictionLimits:
    """µ′/µ (dimensionless) at amplitudes (m) in the two limits of the skin; how far they are apart
    belongs in the uncertainty of µ′/µ.

    `own`: each ridge at its own balance (a skin compliant at rest, the default); `one_gap`: all
    ridges tied to one mean gap.
    """

    amplitude: si.MetreArray
    own: si.DimensionlessArray
    one_gap: si.DimensionlessArray


@si.checked_numbers
@dataclass(frozen=True)
class FrictionLaw:
    """µ′/µ as a function of the vibration amplitude, at one frequency and force, by one model.

    All models take what the film does not carry to be in contact, at an unchanged friction
    coefficient (paper eq 14, corrected). "paper2008" and the "film-" models hold the gap and differ
    in the film; the "partial-levitation" models find the gap at which film and asperities carry
    the finger together, over each ridge ("partial-levitation") or over all of them at once
    ("partial-levitation-one-gap"). `position` is the pad's centre from an antinode, along the wave.
    """

    surface: Surface
    finger: Finger
    gas: Gas
    half_wavelength: Annotated[si.Metre, si.Above(0)]
    frequency: Annotated[si.Hertz, si.Above(0)]
    normal_force: Annotated[si.Newton, si.Above(0)]
    model: FrictionModel
    position: si.Metre = 0.0

    def __post_init__(self) -> None:
        if self.position and self.kind.film != "shared":
            raise InputError(
                f"position = {si.format_quantity(self.position, si.Unit('m'))} from the antinode: "
                f"the model '{self.model}' knows the finger over an antinode only; ask a "
                "partial-levitation model",
                quantity="position",
            )

    @property
    def kind(self) -> ModelKind:
        """What the model makes of film and skin."""
        return MODEL_KINDS[self.model]

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
        if self.kind.film == "shared":
            return self._shared_load(amplitude)
        gap, model = self.gap(amplitude), cast(FilmModel, self.model)
        width = self.finger.plateau_width
        return film_load(gap, self.frequency, self.gas, model, plateau_width=width)

    @si.checked_numbers
    def sharing(
        self,
        amplitude: si.MetreLike,
        limit: Limit | None = None,
        *,
        posture: PadPosture | None = None,
        yielding: bool = False,
    ) -> PadFriction:
        """How film and asperities share the load at amplitudes (m), in the model's limit or in
        the one named; how the pad lies (None: at `position`, level); and whether the
        finger's skin yields at the ultrasonic frequency. Raises `InputError` for a model that does
        not share the load."""
        if limit is None:
            if self.kind.film != "shared":
                raise InputError(
                    f"the model '{self.model}' holds the gap and shares no load; ask a "
                    "partial-levitation model, or name a limit"
                )
            limit = self.kind.limit
        return pad_friction(
            self._films,
            self._asperities,
            amplitude,
            self.half_wavelength,
            self._ridges,
            self.finger.plateau_pressure(self.normal_force),
            limit=limit,
            posture=posture or PadPosture(position=self.position),
            skin=self.finger.skin if yielding else None,
        )

    @si.checked_numbers
    def limits(self, amplitude: si.MetreLike) -> FrictionLimits:
        """µ′/µ in both limits of partial levitation at amplitudes (m), whatever the model."""
        a = np.atleast_1d(np.asarray(amplitude, dtype=float))
        own, tied = self.sharing(a, "own"), self.sharing(a, "one-gap")
        return FrictionLimits(a, own.relative_friction, tied.relative_friction)

    def ripple(self, amplitude: si.Metre) -> FrictionRipple:
        """µ′/µ along the wave by partial levitation at an amplitude (m), each ridge at its own
        balance, whatever the model. See `friction_ripple`."""
        return friction_ripple(
            self._films,
            self._asperities,
            amplitude,
            self.half_wavelength,
            self.finger,
            normal_force=self.normal_force,
        )

    @si.checked_numbers
    def sheared(
        self,
        amplitude: si.MetreLike,
        speed: Annotated[si.MetrePerSecond, si.Above(0.0)],
        stiffness: TangentialStiffness = "following",
    ) -> si.DimensionlessArray:
        """µ′/µ at amplitudes (m) and a finger speed (m/s) where what touches within a period is
        elastic until it slips, each ridge at its own balance, whatever the model: the mean over the
        ridges. See `sheared_friction`.
        """
        swings = np.atleast_1d(np.asarray(amplitude, dtype=float))
        kinds, weights = self._kinds_of_ridges()
        pressure = self.finger.plateau_pressure(self.normal_force)
        shared = share_load(self._films, self._asperities, np.outer(swings, kinds), pressure)
        shear = AsperityShear(speed, self._coefficient, stiffness)
        return np.asarray(sheared_friction(shared, shear, self.frequency) @ weights)

    @si.checked_numbers
    def tapped(self, amplitude: si.MetreLike, speed: si.MetrePerSecond) -> si.DimensionlessArray:
        """µ′/µ by the competing mechanism, intermittent contact without gas, at amplitudes (m) and
        a finger speed (m/s), whatever the model: the mean over the ridges. See `contact.tapping`.
        """
        swings = np.atleast_1d(amplitude)
        si.require("amplitude", swings, si.Unit("m"), at_least=0, axes=1)
        pressure = self.finger.plateau_pressure(self.normal_force)
        kinds, weights = self._kinds_of_ridges()

        def tap(swing: float) -> float:
            return tapping_friction(
                swing,
                self.frequency,
                speed,
                pressure,
                friction_coefficient=self._coefficient,
                normal_stiffness=pressure / self._asperities.decay_length,
            ).relative_friction

        each = np.array([[tap(float(a * k)) for k in kinds] for a in swings])
        return np.asarray(each @ weights)

    @property
    def _films(self) -> FilmTable:
        return film_table(self.frequency, self.finger.plateau_width, self.gas)

    @property
    def _asperities(self) -> AsperityLaw:
        return self.finger.asperity_law(self.surface.roughness)

    @property
    def _ridges(self) -> si.MetreArray:
        side = float(np.sqrt(self.finger.contact_area(self.normal_force)))
        return ridge_points(self.finger, side)

    @property
    def _coefficient(self) -> si.Dimensionless:
        """The friction coefficient without vibration."""
        return self.surface.friction_coefficient * self.finger.friction_factor

    def _kinds_of_ridges(self) -> tuple[si.FloatArray, si.FloatArray]:
        """The amplitudes that ridges meet, over an antinode's, each once, and their shares."""
        points = self._ridges
        wave = np.abs(np.cos(np.pi * (points + self.position) / self.half_wavelength))
        kinds, counts = np.unique(np.round(wave, 9), return_counts=True)
        return np.asarray(kinds, dtype=float), counts / points.size

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
    def at(self, amplitude: si.Metre) -> si.Dimensionless:
        """µ′/µ (dimensionless, 0 to 1) at one amplitude (m)."""
        return float(self.curve(np.array([amplitude]))[0])

    @si.checked_numbers
    def curve(self, amplitude: si.MetreArray) -> si.DimensionlessArray:
        """µ′/µ (dimensionless, 0 to 1) at an array of amplitudes (m), same shape (1-D)."""
        ambient = self.gas.ambient_pressure
        if self.kind.film == "asymptote":
            return np.asarray(
                paper.relative_friction(
                    self.gap(amplitude), self.normal_force, ambient, self._closed_form
                )
            )
        if self.kind.film == "shared":
            return self.sharing(np.ravel(amplitude)).relative_friction
        pressures = np.array([1 + self.load(float(a)).over_pressure for a in np.ravel(amplitude)])
        return np.asarray(self._shared(pressures))

    @si.checked_numbers
    def under(self, load: FilmLoad, amplitude: si.Metre) -> si.Dimensionless:
        """µ′/µ (dimensionless) with a film already solved at an amplitude (m), as `load` has it."""
        if self.kind.film == "asymptote":
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

        Raises `InputError` for a value outside [0, 1] and `UnreachableError` where no amplitude up
        to 50 µm does.
        """
        if self.kind.film == "asymptote":
            return paper.vibration_amplitude_for(
                relative_friction,
                self.gap(0.0),
                self.normal_force,
                self.gas.ambient_pressure,
                self._closed_form,
            )
        return self._search(relative_friction)

    def _search(self, wanted: si.Dimensionless) -> si.Metre:
        from scipy.optimize import brentq

        if wanted == 1:
            return 0.0
        pressure = self.normal_force / self.finger.contact_length**2 / self.gas.ambient_pressure

        def excess(amplitude: float) -> float:
            if self.kind.film == "shared":
                return self.at(amplitude) - wanted
            return 1 - self.load(amplitude).over_pressure / pressure - wanted

        low, least = 0.0, 1.0
        for high in np.geomspace(2e-8, HIGHEST_AMPLITUDE, 24):
            try:
                left = excess(float(high))
            except OutOfRangeError:
                # So strong a vibration closes the gap at some ridge: it is no way to get there.
                break
            if left <= 0:
                return float(brentq(excess, max(low, 1e-9), high, xtol=1e-11, rtol=1e-6))
            low, least = float(high), min(least, left + wanted)
        raise UnreachableError(
            f"relative_friction = {wanted:.4g} is not reached by any vibration amplitude up to "
            f"{si.format_quantity(HIGHEST_AMPLITUDE, si.Unit('m'))}: the model '{self.model}' "
            f"gives {least:.4g} at the least; press less, take a smoother surface or ask for less"
        )

    @si.checked_numbers
    def table(
        self, highest_amplitude: Annotated[si.Metre, si.Above(0.0)], points: int | None = None
    ) -> FrictionTable:
        """The law as a fast function: a table, linear between its points, for many samples.

        Holds from 0 to `highest_amplitude`, raises `OutOfRangeError` outside. With the default
        points (257; 65 where the film is solved) it is within 1e-4 (1e-3) of the law for the
        paper's devices.
        """
        if points is not None:
            si.require("points", points, at_least=2)
        count = points or (257 if self.kind.film == "asymptote" else 65)
        # Denser at small amplitudes, where the law bends within the roughness.
        grid = highest_amplitude * np.linspace(0.0, 1.0, count) ** 2
        law = self.curve(grid)
        if law[-1] == 0:
            # The law has a kink where the finger lifts off; a point of its own keeps it sharp.
            kink = self.amplitude_for(0.0)
            at = int(np.searchsorted(grid, kink))
            grid, law = np.insert(grid, at, kink), np.insert(law, at, 0.0)

        return FrictionTable(grid, law)


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
) -> FrictionLaw:
    """The friction law of a display; surface and force default to the display's own, the pad to an
    antinode."""
    return FrictionLaw(
        surface=surface or display.surface(),
        finger=display.finger,
        gas=display.gas,
        half_wavelength=half_wavelength,
        frequency=frequency,
        normal_force=display.finger.normal_force if normal_force is None else normal_force,
        model=model,
        position=position,
    )
