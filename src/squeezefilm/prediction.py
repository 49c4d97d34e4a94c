"""The chain of one display: volts, frequency and force to the friction a finger meets.

Each link names the model that made its numbers. Today's links are the beam (or the measured
stator) and the paper's asymptotic film; a solved plate and a solved film take their places behind
the same two seams, `WorkingMode` and `relative_friction_curve`.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from squeezefilm.contact import paper
from squeezefilm.display import Display, Surface
from squeezefilm.errors import InputError, OutOfRangeError
from squeezefilm.film.gap import PaperGap, squeeze_number
from squeezefilm.film.limits import PaperModel
from squeezefilm.film.validity import FilmValidity, film_validity
from squeezefilm.plate.beam import BeamTheory
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.working_mode import WorkingMode, working_mode
from squeezefilm.quantities import (
    Dimensionless,
    DimensionlessArray,
    Hertz,
    Metre,
    MetreArray,
    MetreLike,
    Newton,
    Unit,
    Volt,
    require,
)

FrictionModel = PaperModel
"""The names of the models of film and friction that can be asked for."""


@dataclass(frozen=True, eq=False)
class Prediction:
    """What a display does at one voltage, frequency and force on one surface.

    `amplitude_model` made the vibration amplitude (zero-to-peak, at an antinode), `model` the
    pressure and the friction. `mean_pressure` is the film's, averaged over contact and period,
    divided by ambient. `friction_reduction` is µ − µ′. `validity` says how far the film's model is
    from where it holds.
    """

    display: str
    surface: Surface
    voltage: Volt | None
    frequency: Hertz
    normal_force: Newton
    mode: WorkingMode
    amplitude_model: str
    vibration_amplitude: Metre
    model: FrictionModel
    squeeze_number: Dimensionless
    mean_pressure: Dimensionless
    relative_friction: Dimensionless
    friction_coefficient: Dimensionless
    friction_reduction: Dimensionless
    validity: FilmValidity
    warnings: tuple[str, ...]


def paper_gap(
    display: Display, surface: Surface, half_wavelength: Metre, amplitude: MetreLike
) -> PaperGap:
    """The paper's gap between this display's surface and finger, antinode and groove centred."""
    return PaperGap(
        roughness=surface.roughness,
        vibration_amplitude=amplitude,
        ridge_amplitude=display.finger.ridge_amplitude,
        ridge_period=display.finger.ridge_period,
        wavelength=2 * half_wavelength,
        contact_length=display.finger.contact_length,
    )


def relative_friction_curve(
    display: Display,
    amplitude: MetreArray,
    half_wavelength: Metre,
    *,
    surface: Surface | None = None,
    normal_force: Newton | None = None,
    model: FrictionModel = "paper2008",
) -> DimensionlessArray:
    """µ′/µ (dimensionless) at an array of vibration amplitudes (m), same shape.

    Source and range: see `contact.paper.relative_friction`.
    """
    gap = paper_gap(display, surface or display.surface(), half_wavelength, amplitude)
    force = display.finger.normal_force if normal_force is None else normal_force
    return np.asarray(
        paper.relative_friction(gap, force, display.gas.ambient_pressure, model=model)
    )


def friction_law(
    display: Display,
    highest_amplitude: Metre,
    half_wavelength: Metre,
    *,
    surface: Surface | None = None,
    normal_force: Newton | None = None,
    model: FrictionModel = "paper2008",
    points: int = 257,
) -> Callable[[MetreArray], DimensionlessArray]:
    """µ′/µ as a fast function of the vibration amplitude (m): a table, linear between its points.

    For the many samples of a trace. Holds from 0 to `highest_amplitude`, raises `OutOfRangeError`
    outside. With the default points the table is within 1e-4 of the law for the paper's devices.
    """
    require("highest_amplitude", highest_amplitude, Unit("m"), above=0)
    # Denser at small amplitudes, where the law bends within the roughness.
    grid = highest_amplitude * np.linspace(0.0, 1.0, points) ** 2
    law = relative_friction_curve(
        display, grid, half_wavelength, surface=surface, normal_force=normal_force, model=model
    )
    if law[-1] == 0:
        # The law has a kink where the finger lifts off; a point of its own keeps it sharp.
        gap = paper_gap(display, surface or display.surface(), half_wavelength, 0.0)
        force = display.finger.normal_force if normal_force is None else normal_force
        kink = paper.zero_friction_amplitude(gap, force, display.gas.ambient_pressure, model)
        at = int(np.searchsorted(grid, kink))
        grid, law = np.insert(grid, at, kink), np.insert(law, at, 0.0)

    def friction(amplitude: MetreArray) -> DimensionlessArray:
        values = np.asarray(amplitude, dtype=float)
        # A hair of slack: an exponential envelope may overshoot its target by rounding.
        slack = 1e-9 * highest_amplitude
        if values.size and (values.min() < -slack or values.max() > highest_amplitude + slack):
            raise OutOfRangeError(
                f"the friction law was tabulated for amplitudes from 0 to {highest_amplitude:.4g} "
                f"m and asked at {values.min():.4g} to {values.max():.4g} m; tabulate it higher"
            )
        return np.asarray(np.interp(values, grid, law))

    return friction


def predict(
    display: Display,
    *,
    voltage: Volt | None = None,
    frequency: Hertz | None = None,
    normal_force: Newton | None = None,
    surface: str | None = None,
    vibration_amplitude: Metre | None = None,
    theory: BeamTheory = "timoshenko",
    model: FrictionModel = "paper2008",
    strict: bool = False,
) -> Prediction:
    """The friction of a display driven with a voltage (V, zero-to-peak) at a frequency (Hz).

    The frequency defaults to the resonance, voltage, force and surface to the display's own. A
    `vibration_amplitude` (m, zero-to-peak) given directly takes the place of voltage and plate.

    What is doubtful (contradicting data, a film model outside its range) is collected in
    `warnings`; with `strict` it raises instead: `ContradictionError`, `OutOfRangeError`. Raises
    `InputError` for a value that cannot be used, or an amplitude given together with a voltage.
    """
    if vibration_amplitude is not None and voltage is not None:
        raise InputError("a voltage and an amplitude were both given; give one of them")
    force = display.finger.normal_force if normal_force is None else normal_force
    require("normal_force", force, Unit("N"), above=0)
    where = display.surface(surface)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        if isinstance(display.actuator, RectangularPlate):
            display.actuator.ceramic.check_consistency(strict=strict)
        mode = working_mode(display.actuator, theory)
        drive_frequency = mode.resonance_frequency if frequency is None else frequency
        require("frequency", drive_frequency, Unit("Hz"), above=0)
        volts: Volt | None
        if vibration_amplitude is None:
            volts = display.drive.voltage if voltage is None else voltage
            require("voltage", volts, Unit("V"), at_least=0)
            amplitude = float(volts * mode.amplitude_per_volt_at(drive_frequency))
            source = mode.model
        else:
            require("vibration_amplitude", vibration_amplitude, Unit("m"), at_least=0)
            volts, amplitude, source = None, vibration_amplitude, "given"
        gap = paper_gap(display, where, mode.half_wavelength, amplitude)
        gas = display.gas
        sigma = squeeze_number(
            drive_frequency,
            display.finger.contact_length,
            gap.reference_thickness,
            gas.viscosity,
            gas.ambient_pressure,
        )
        validity = film_validity(gap, drive_frequency, gas, strict=strict)
        pressure = float(paper.mean_pressure(gap, model))
        friction = float(paper.relative_friction(gap, force, gas.ambient_pressure, model))
    messages = [str(item.message) for item in caught]
    return Prediction(
        display=display.name,
        surface=where,
        voltage=volts,
        frequency=drive_frequency,
        normal_force=force,
        mode=mode,
        amplitude_model=source,
        vibration_amplitude=amplitude,
        model=model,
        squeeze_number=float(sigma),
        mean_pressure=pressure,
        relative_friction=friction,
        friction_coefficient=where.friction_coefficient,
        friction_reduction=where.friction_coefficient * (1 - friction),
        validity=validity,
        warnings=tuple(dict.fromkeys(messages)),
    )
