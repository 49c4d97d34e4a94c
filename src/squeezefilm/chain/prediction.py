"""The chain of one display: volts, frequency and finger to the friction and the tangential force.

Each link names the model that made its numbers: the solved plate, a beam or the measured stator the
amplitude, the finger on it what is left of it, and partial levitation, the paper's asymptote or a
solved film the friction.
"""

from __future__ import annotations

import dataclasses
import functools
import warnings
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squeezefilm.chain.friction import (
    DEFAULT_MODEL,
    FrictionLaw,
    FrictionModel,
    FrictionTable,
    friction_law,
    shares_load,
)
from squeezefilm.chain.touch import Touch, kept_at, touch
from squeezefilm.device.wire.safety import HIGHEST_VOLTAGE
from squeezefilm.display import NamedDisplay, Surface
from squeezefilm.errors import (
    InputError,
    OutOfRangeError,
    OutOfRangeWarning,
    SqueezefilmWarning,
    UnreachableError,
)
from squeezefilm.film.gap import squeeze_number
from squeezefilm.film.validity import FilmValidity, film_validity
from squeezefilm.from_text import reads_text
from squeezefilm.plate.beam.response import beam_doubt
from squeezefilm.plate.layout import Actuator, RectangularPlate
from squeezefilm.plate.working_mode import PlateTheory, WorkingMode, working_mode
from squeezefilm.quantities import (
    Dimensionless,
    Hertz,
    Metre,
    MetrePerVolt,
    Newton,
    Second,
    Unit,
    Volt,
    checked_numbers,
    require,
)
from squeezefilm.render.program.inverse import FrictionInverse
from squeezefilm.render.resonator.envelope import envelope_time_constant
from squeezefilm.results import Result, to_json


@dataclass(frozen=True, eq=False, repr=False)
class Prediction(Result):
    """What a display does at one voltage, frequency and force on one surface.

    `amplitude_model` made the vibration amplitude (zero-to-peak, at an antinode, with the finger
    on it), `touch` says what the finger took from it, `model` made pressure and friction.
    `mean_pressure` is the film's, averaged over contact and period, divided by ambient,
    `mean_pressure_error` the solver's estimate of its error (0 for a closed form).
    `relative_friction_limits` are µ′/µ with each ridge at its own balance and with all ridges at
    one mean gap, None for a model that shares no load. `friction_reduction` is µ − µ′,
    `tangential_force` µ′ F of a finger that slides steadily. `validity` says how far the paper's
    asymptote is from where it holds; `law` is the friction as a function of the amplitude.
    """

    display: str
    surface: Surface
    voltage: Volt | None
    frequency: Hertz
    normal_force: Newton
    mode: WorkingMode
    amplitude_model: str
    vibration_amplitude: Metre
    touch: Touch
    model: FrictionModel
    law: FrictionLaw
    squeeze_number: Dimensionless
    mean_pressure: Dimensionless
    mean_pressure_error: Dimensionless
    relative_friction: Dimensionless
    relative_friction_limits: tuple[Dimensionless, Dimensionless] | None
    friction_coefficient: Dimensionless
    friction_reduction: Dimensionless
    tangential_force: Newton
    validity: FilmValidity
    warnings: tuple[str, ...]
    _shown: ClassVar[str] = (
        "display model voltage frequency normal_force vibration_amplitude relative_friction "
        "tangential_force"
    )

    @functools.cached_property
    def friction(self) -> FrictionTable:
        """µ′/µ against the amplitude, up to this one, as a fast table: see `FrictionLaw.table`."""
        return self.law.table(self.vibration_amplitude)

    @functools.cached_property
    def inverse(self) -> FrictionInverse:
        """The amplitude for a wanted µ′/µ, up to this amplitude: what a renderer needs.

        Raises `InputError` where nothing vibrates or the friction does not fall.
        """
        return FrictionInverse.from_function(self.friction, self.vibration_amplitude)

    @property
    def envelope_time_constant(self) -> Second:
        """Of the resonator's envelope without a finger (s)."""
        mode = self.mode
        return float(envelope_time_constant(mode.quality_factor, mode.resonance_frequency))

    def summary(self) -> dict[str, Any]:
        """The numbers, with units in their keys."""
        return {
            "display": self.display,
            "surface": self.surface.name,
            "mode": self.mode.label,
            "voltage_V": self.voltage,
            "frequency_Hz": self.frequency,
            "normal_force_N": self.normal_force,
            "resonance_frequency_Hz": self.mode.resonance_frequency,
            "resonance_frequency_error_Hz": self.mode.frequency_error,
            "half_wavelength_m": self.mode.half_wavelength,
            "amplitude_per_volt_m_per_V": self.mode.amplitude_per_volt,
            "vibration_amplitude_m": self.vibration_amplitude,
            "amplitude_model": self.amplitude_model,
            "squeeze_number": self.squeeze_number,
            "mean_pressure": self.mean_pressure,
            "mean_pressure_error": self.mean_pressure_error,
            "relative_friction": self.relative_friction,
            "amplitude_kept_under_finger": self.touch.kept,
            "tangential_force_N": self.tangential_force,
            "friction_coefficient": self.friction_coefficient,
            "friction_reduction": self.friction_reduction,
            "model": self.model,
            "quality_factor": self.mode.quality_factor,
            "envelope_time_constant_s": self.envelope_time_constant,
            "validity": to_json(self.validity),
            "warnings": list(self.warnings),
        }


@reads_text
@checked_numbers
def predict(
    display: NamedDisplay,
    *,
    voltage: Volt | None = None,
    frequency: Hertz | None = None,
    normal_force: Newton | None = None,
    surface: str | None = None,
    vibration_amplitude: Metre | None = None,
    position: Metre = 0.0,
    theory: PlateTheory | None = None,
    model: FrictionModel | None = None,
    strict: bool = False,
) -> Prediction:
    """The friction of a display driven with a voltage (V, zero-to-peak) at a frequency (Hz).

    The frequency defaults to the resonance without a finger, voltage, force and surface to the
    display's own. A `vibration_amplitude` (m, zero-to-peak, with the finger on it) given directly
    takes the place of voltage and plate. `position` is the pad's centre from an antinode, along the
    wave.
    `theory` says how a plate is computed; without one it is solved in three dimensions, and taken
    as a beam, with a warning, where its working mode cannot be found so.
    Without a `model`, film and asperities share the load of each ridge (partial levitation).

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
        mode = _mode(display.actuator, theory, strict)
        drive_frequency = mode.resonance_frequency if frequency is None else frequency
        require("frequency", drive_frequency, Unit("Hz"), above=0)
        volts: Volt | None
        if vibration_amplitude is None:
            volts = display.drive.voltage if voltage is None else voltage
            require("voltage", volts, Unit("V"), at_least=0)
            free = float(volts * _per_volt(mode, drive_frequency))
            source = mode.model
        else:
            require("vibration_amplitude", vibration_amplitude, Unit("m"), at_least=0)
            volts, free, source = None, vibration_amplitude, "given"
        law = friction_law(
            display,
            mode.half_wavelength,
            drive_frequency,
            surface=where,
            normal_force=force,
            model=model or DEFAULT_MODEL,
            position=position,
        )
        felt = touch(
            mode if volts is not None else dataclasses.replace(mode, modal_mass=None), law, free
        )
        amplitude = felt.amplitude
        asked_for_asymptote = model is not None and model.startswith("paper2008")
        validity = film_validity(
            law.gap(amplitude), drive_frequency, display.gas, strict=strict and asked_for_asymptote
        )
        load = law.load(amplitude)
        friction = law.under(load, amplitude)
        limits = _limits(law, amplitude)
    gap, gas = law.gap(amplitude), display.gas
    base = where.friction_coefficient * display.finger.friction_factor
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
    plate = display.actuator
    if isinstance(plate, RectangularPlate) and mode.solid is None and vibration_amplitude is None:
        doubt = beam_doubt(plate)
    if doubt is not None and strict:
        raise OutOfRangeError(f"{doubt}; leave strictness out to compute it all the same")
    messages = [
        str(item.message)
        for item in caught
        if not (solved and issubclass(item.category, OutOfRangeWarning))
    ]
    if law.model.startswith("film-"):
        inertia = validity.check("inertia")
        messages += [] if inertia.holds else [inertia.sentence]
    if volts is not None and mode.modal_mass is None:
        messages.append(
            "the amplitude is the measured one; what a finger takes from it is not known and left "
            "out"
        )
    if shares_load(law.model):
        assert limits is not None
        spread = abs(limits[0] - limits[1])
        messages.append(
            f"the model '{law.model}' lets film and asperities share the load of each ridge; its "
            "asperities and plateaus are assumed, not measured, and decide the answer: see the "
            "interval of squeezefilm friction. Relative friction differs by "
            f"{spread:.2f} between a skin that sinks ridge by ridge and a stiff one"
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
        touch=felt,
        model=law.model,
        law=law,
        squeeze_number=float(sigma),
        mean_pressure=1 + load.over_pressure,
        mean_pressure_error=load.error,
        relative_friction=friction,
        relative_friction_limits=limits,
        friction_coefficient=base,
        friction_reduction=base * (1 - friction),
        tangential_force=base * friction * force,
        validity=validity,
        warnings=tuple(dict.fromkeys(messages)),
    )


def _limits(law: FrictionLaw, amplitude: Metre) -> tuple[Dimensionless, Dimensionless] | None:
    if not shares_load(law.model):
        return None
    found = law.limits(amplitude)
    return float(found.own[0]), float(found.one_gap[0])


@reads_text
@checked_numbers
def voltage_for_friction(
    display: NamedDisplay,
    relative_friction: Dimensionless,
    *,
    frequency: Hertz | None = None,
    normal_force: Newton | None = None,
    surface: str | None = None,
    theory: PlateTheory | None = None,
    model: FrictionModel | None = None,
) -> tuple[Volt, Metre]:
    """The voltage (V, zero-to-peak) that brings µ′/µ down to a wanted value, and its amplitude (m).

    The inverse of `predict`, the finger's damping and detuning included; linear in the voltage up
    to there. Raises `UnreachableError` where no amplitude does, or where the voltage would be more
    than the 2 kV that a `Drive` may have.
    """
    mode = _mode(display.actuator, theory, False)
    drive_frequency = mode.resonance_frequency if frequency is None else frequency
    require("frequency", drive_frequency, Unit("Hz"), above=0)
    law = friction_law(
        display,
        mode.half_wavelength,
        drive_frequency,
        surface=display.surface(surface),
        normal_force=normal_force,
        model=model or DEFAULT_MODEL,
    )
    amplitude = law.amplitude_for(relative_friction)
    if amplitude == 0:
        return 0.0, 0.0
    volts = amplitude / (_per_volt(mode, drive_frequency) * kept_at(mode, law, amplitude))
    if volts > HIGHEST_VOLTAGE:
        raise UnreachableError(
            f"relative_friction = {relative_friction:.4g} needs {amplitude * 1e6:.3g} µm and so "
            f"{volts:.4g} V; a drive may have {HIGHEST_VOLTAGE:.4g} V. Drive at the resonance, ask "
            "for less, or take a plate with more amplitude per volt"
        )
    return float(volts), amplitude


def _per_volt(mode: WorkingMode, frequency: Hertz) -> MetrePerVolt:
    """The amplitude per volt (m/V) without a finger; off resonance with the mode's neighbours."""
    if frequency == mode.resonance_frequency:
        return mode.amplitude_per_volt
    return float(mode.response(np.array([frequency]))[0])


def _mode(actuator: Actuator, theory: PlateTheory | None, strict: bool) -> WorkingMode:
    if theory is not None or strict or not isinstance(actuator, RectangularPlate):
        return working_mode(actuator, theory or "solid")
    try:
        return working_mode(actuator, "solid")
    except InputError as error:
        mode = working_mode(actuator, "timoshenko")
        warnings.warn(
            f"the solved plate does not give the working mode ({error}); a beam's, whose numbers "
            "these are, need not exist in such a plate",
            SqueezefilmWarning,
            stacklevel=2,
        )
        return mode
