"""The chain of one display: volts, frequency and force to the friction a finger meets.

Each link names the model that made its numbers: the beam (or the measured stator) the amplitude,
the paper's asymptote or the solved film the friction.
"""

from __future__ import annotations

import dataclasses
import warnings
from dataclasses import dataclass

from squeezefilm.display import Display, Surface
from squeezefilm.errors import InputError, OutOfRangeError, OutOfRangeWarning
from squeezefilm.film.gap import squeeze_number
from squeezefilm.film.validity import FilmValidity, film_validity
from squeezefilm.friction import (
    SOLVED_DEFAULT,
    FrictionLaw,
    FrictionModel,
    friction_law,
    shares_load,
)
from squeezefilm.plate.beam import BeamTheory
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.response import beam_doubt
from squeezefilm.plate.working_mode import WorkingMode, working_mode
from squeezefilm.quantities import (
    Dimensionless,
    Hertz,
    Metre,
    Newton,
    Unit,
    Volt,
    require,
)


@dataclass(frozen=True, eq=False)
class Prediction:
    """What a display does at one voltage, frequency and force on one surface.

    `amplitude_model` made the vibration amplitude (zero-to-peak, at an antinode), `model` the
    pressure and the friction. `mean_pressure` is the film's, averaged over contact and period,
    divided by ambient, `mean_pressure_error` the solver's estimate of its error (0 for a closed
    form). `friction_reduction` is µ − µ′. `validity` says how far the paper's asymptote is from
    where it holds; `law` is the friction as a function of the amplitude.
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
    law: FrictionLaw
    squeeze_number: Dimensionless
    mean_pressure: Dimensionless
    mean_pressure_error: Dimensionless
    relative_friction: Dimensionless
    friction_coefficient: Dimensionless
    friction_reduction: Dimensionless
    validity: FilmValidity
    warnings: tuple[str, ...]


def predict(
    display: Display,
    *,
    voltage: Volt | None = None,
    frequency: Hertz | None = None,
    normal_force: Newton | None = None,
    surface: str | None = None,
    vibration_amplitude: Metre | None = None,
    theory: BeamTheory = "timoshenko",
    model: FrictionModel | None = None,
    strict: bool = False,
) -> Prediction:
    """The friction of a display driven with a voltage (V, zero-to-peak) at a frequency (Hz).

    The frequency defaults to the resonance, voltage, force and surface to the display's own. A
    `vibration_amplitude` (m, zero-to-peak) given directly takes the place of voltage and plate.
    Without a `model`, the paper's asymptote is used where it holds and the solved film elsewhere.

    What is doubtful (contradicting data, an asymptote asked for outside its range) is collected in
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
        law = friction_law(
            display,
            mode.half_wavelength,
            drive_frequency,
            surface=where,
            normal_force=force,
            model=model or "paper2008",
        )
        asked_for_asymptote = model is not None and model.startswith("paper2008")
        validity = film_validity(
            law.gap(amplitude), drive_frequency, display.gas, strict=strict and asked_for_asymptote
        )
        if model is None and not validity.holds:
            law = dataclasses.replace(law, model=SOLVED_DEFAULT)
        load = law.load(amplitude)
        friction = law.under(load, amplitude)
    gap, gas = law.gap(amplitude), display.gas
    sigma = squeeze_number(
        drive_frequency,
        gap.contact_length,
        gap.reference_thickness,
        gas.viscosity,
        gas.ambient_pressure,
    )
    # Where the film is solved, what fails of the asymptote is no doubt about this number.
    solved = not law.model.startswith("paper2008")
    doubt = None
    if isinstance(display.actuator, RectangularPlate) and vibration_amplitude is None:
        doubt = beam_doubt(display.actuator)
    if doubt is not None and strict:
        raise OutOfRangeError(f"{doubt}; leave strictness out to compute it all the same")
    messages = [
        str(item.message)
        for item in caught
        if not (solved and issubclass(item.category, OutOfRangeWarning))
    ]
    if solved:
        inertia = validity.check("inertia")
        messages += [] if inertia.holds else [inertia.sentence]
    if law.model.startswith("film-"):
        messages.append(
            f"the asymptote of the paper does not hold here (σ = {sigma:.4g}); the model "
            f"'{law.model}' solves the film of the same gap, with slip. What a film carries "
            "depends on the shape of the ridges more than on anything else: compare the film models"
        )
    if shares_load(law.model):
        spread = float(law.limits(amplitude).spread[0])
        messages.append(
            f"the model '{law.model}' lets film and asperities share the load of each ridge; its "
            "asperities are assumed, not measured, and decide the answer. Relative friction "
            f"differs by {spread:.2f} between a skin that sinks ridge by ridge and a stiff one"
        )
    if doubt is not None:
        messages.append(doubt)
    return Prediction(
        display=display.name,
        surface=where,
        voltage=volts,
        frequency=drive_frequency,
        normal_force=force,
        mode=mode,
        amplitude_model=source,
        vibration_amplitude=amplitude,
        model=law.model,
        law=law,
        squeeze_number=float(sigma),
        mean_pressure=1 + load.over_pressure,
        mean_pressure_error=load.error,
        relative_friction=friction,
        friction_coefficient=where.friction_coefficient,
        friction_reduction=where.friction_coefficient * (1 - friction),
        validity=validity,
        warnings=tuple(dict.fromkeys(messages)),
    )
