"""The chain of one display: volts, frequency and finger to the friction and the tangential force.

Each link names the model that made its numbers: the solved plate, a beam or the measured stator the
amplitude, the finger on it what is left of it, and the closed form of 2016, the paper's
asymptote or a solved film the friction.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import math
import warnings
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError, OutOfRangeError, OutOfRangeWarning
from squeezefilm.core.progress import NO_HURRY, Pace
from squeezefilm.core.results import Result, to_json, values_of
from squeezefilm.physics.chain.area_map import at_best_place
from squeezefilm.physics.chain.friction import FrictionLaw, friction_law
from squeezefilm.physics.chain.pad_law import DEFAULT_MODEL, FrictionModel
from squeezefilm.physics.chain.pad_place import pad_place, place_words
from squeezefilm.physics.chain.touch import (
    FreeVibration,
    Touch,
    chosen_mode,
    free_vibration,
    held_touch,
    touch,
)
from squeezefilm.physics.chain.wanted_voltage import WorkingPoint
from squeezefilm.physics.display import Display, Surface
from squeezefilm.physics.film.validity import FilmValidity, film_validity
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.warming import Warming, warming_of_mode
from squeezefilm.physics.plate.working_mode import PlateTheory, WorkingMode
from squeezefilm.physics.plausibility.checks import require_plausible
from squeezefilm.physics.render.program.inverse import FrictionInverse, FrictionTable
from squeezefilm.physics.render.resonator.envelope import envelope_time_constant


@dataclass(frozen=True, eq=False, repr=False)
class Prediction(Result):
    """Prediction of a display at one voltage, frequency and force on one surface.

    The pad is at the best place of the active area (see `at_best_place`), or where it was asked
    for, on the shape of the vibration; of a plate taken as a beam it is over an antinode of a
    wave whose antinodes are taken to be all alike. `place` is its centre. `amplitude_model` made
    the vibration amplitude (zero-to-peak, at the antinode wherever the finger is, with it on;
    `amplitude_at_place` is that under the pad's centre), `touch` says what the finger took from
    it, `model` made pressure and friction. `mean_pressure` is the film's, averaged over contact
    and period, divided by ambient, `mean_pressure_error` the solver's estimate of its error (0 for
    a closed form).
    `relative_friction_limits` are µ′/µ with each ridge at its own balance and with all ridges at
    one mean gap, None for a model that shares no load or where one of the two is out of range.
    `friction_reduction` is µ − µ′, `tangential_force` µ′ F of a finger that slides steadily.
    `validity` says how far the paper's asymptote is from where it holds; `law` is the friction as
    a function of amplitude and speed. `heat` is what the plate's losses do to it, None
    where they are not known: every other number is of the cold plate. `warnings` is all that is
    doubtful, `objections` those of them while which nothing may be called good: a value that is
    not usual, a model in place of the one that was asked for, a check that failed.
    """

    display: str
    surface: Surface
    voltage: si.Volt | None
    frequency: si.Hertz
    normal_force: si.Newton
    speed: si.MetrePerSecond
    mode: WorkingMode
    amplitude_model: str
    vibration_amplitude: si.Metre
    touch: Touch
    model: FrictionModel
    law: FrictionLaw
    squeeze_number: si.Dimensionless
    mean_pressure: si.Dimensionless
    mean_pressure_error: si.Dimensionless
    relative_friction: si.Dimensionless
    relative_friction_limits: tuple[si.Dimensionless, si.Dimensionless] | None
    friction_coefficient: si.Dimensionless
    friction_reduction: si.Dimensionless
    tangential_force: si.Newton
    validity: FilmValidity
    heat: Warming | None
    warnings: tuple[str, ...]
    objections: tuple[str, ...] = ()
    _shown: ClassVar[str] = (
        "display model voltage frequency normal_force vibration_amplitude relative_friction "
        "tangential_force"
    )

    @functools.cached_property
    def friction(self) -> FrictionTable:
        """Relative friction µ′/µ over amplitude (up to this one) and speed, a fast table: see
        `FrictionLaw.table`."""
        return self.law.table(self.vibration_amplitude)

    @functools.cached_property
    def inverse(self) -> FrictionInverse:
        """The amplitude for a wanted µ′/µ and speed, up to this one: what a renderer needs.

        Raises `InputError` where nothing vibrates or the friction does not fall.
        """
        return self.friction.inverse(self.law.over_speeds, self.vibration_amplitude)

    @property
    def held_amplitude(self) -> si.Metre:
        """Amplitude that stays as it was asked for while all else is uncertain (m): at a voltage
        the amplitude without a finger, where an amplitude was given that with the finger on it."""
        return self.vibration_amplitude if self.voltage is None else self.touch.free_amplitude

    @property
    def drive(self) -> FreeVibration:
        """The vibration without a finger."""
        free = self.touch.free_amplitude
        return FreeVibration(self.frequency, self.voltage, free, self.amplitude_model)

    @property
    def place(self) -> tuple[si.Metre, si.Metre]:
        """Place of the pad's centre (m)."""
        at = self.law.place
        return self.mode.lobe if at is None else (at.x, at.y)

    @property
    def place_was_asked(self) -> bool:
        """True where the pad is at a place on the face that somebody asked for."""
        return self.law.place is not None and not self.law.place.is_best_of_area

    @property
    def place_said(self) -> str:
        """The same for people, with the amplitude there where it is not the best antinode's."""
        at, where = self.law.place, place_words(self.place)
        if at is not None:
            which = "the best place of the active area, " if at.is_best_of_area else ""
            moves = f"the face moves {1e6 * self.amplitude_at_place:.3g} µm"
            if at.at_centre**2 < self.law.mean_square:
                moves = f"the pad meets {1e6 * self.amplitude_under_pad:.3g} µm r.m.s."
            return f"at {which}{where}, where {moves}"
        if self.law.position:
            return f"{1e3 * self.law.position:.4g} mm along the wave from the antinode, {where}"
        half = f"{1e3 * self.mode.half_wavelength:.3g} mm"
        return f"at the antinode, {where}, taken as an even wave of half wavelength {half}"

    @property
    def amplitude_at_place(self) -> si.Metre:
        """The amplitude of the face at the pad's centre (m), zero-to-peak, with the finger on."""
        at = self.law.place
        return self.vibration_amplitude * (1.0 if at is None else at.at_centre)

    @property
    def amplitude_under_pad(self) -> si.Metre:
        """The amplitude (m, zero-to-peak) that the pad meets with the finger on, its root mean
        square over the contact."""
        return self.vibration_amplitude * math.sqrt(self.law.mean_square)

    def place_summary(self) -> dict[str, Any]:
        """Mapping that JSON has under `place`; keys carry units."""
        return {
            "x_m": self.place[0],
            "y_m": self.place[1],
            "is_best_of_area": self.law.place is not None and not self.place_was_asked,
            "is_on_even_wave": self.law.place is None,
            "amplitude_m": self.amplitude_at_place,
            "amplitude_under_pad_m": self.amplitude_under_pad,
            "said": self.place_said,
        }

    @property
    def envelope_time_constant(self) -> si.Second:
        """Time constant of the resonator's envelope without a finger (s)."""
        mode = self.mode
        return float(envelope_time_constant(mode.quality_factor, mode.resonance_frequency))

    def summary(self) -> dict[str, Any]:
        """The numbers, with units in their keys."""
        return {
            "surface": self.surface.name,
            "mode": self.mode.label,
            "finger_speed_m_per_s": self.speed,
            "resonance_frequency_error_Hz": self.mode.frequency_error,
            "place": self.place_summary(),
            "amplitude_kept_under_finger": self.touch.kept,
            "finger_impedance_N_s_per_m": to_json(self.touch.impedance),
            **values_of(
                self,
                "display voltage frequency normal_force mode.resonance_frequency "
                "mode.half_wavelength mode.amplitude_per_volt vibration_amplitude amplitude_model "
                "squeeze_number mean_pressure mean_pressure_error relative_friction "
                "tangential_force friction_coefficient friction_reduction model "
                "mode.quality_factor envelope_time_constant mode.neighbour validity heat warnings "
                "objections",
            ),
        }


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class PredictionRequest(WorkingPoint):
    """Arguments of `predict`."""

    position: si.Metre | None = None
    theory: PlateTheory | None = None
    strict: bool = False
    pace: Pace = NO_HURRY


@reads_text
@called_with(PredictionRequest)
def predict(asked: PredictionRequest) -> Prediction:
    """The friction of a display driven with a voltage (V, zero-to-peak) at a frequency (Hz).

    The frequency defaults to the resonance without a finger; voltage, force, surface and the
    finger's `speed` of sliding (m/s) to the display's own. A `vibration_amplitude` (m,
    zero-to-peak, at the antinode with the finger on) given directly takes the place of the voltage:
    that of a prediction gives the same friction again.
    The pad is at the best place of the active area, where the solved shape of the vibration says
    what each of its ridges meets; `place` (x, y in m, from a plate's corner, a disc's middle or
    along a stator's track) puts it elsewhere on that shape, and `position` that far from an
    antinode along a wave whose antinodes are all alike. Such a wave's antinode it is also over
    where a plate is taken as a beam, or by a model that knows no other place.
    `theory` says how a plate is computed; without one it is solved in three dimensions, and taken
    as a beam, with a warning, where its working mode cannot be found so.
    Without a `model`, the film lifts the contact off over a length fitted to published friction of
    people; film and asperities share the load of each ridge in what the plate feels of the finger.

    `pace` says how long a solve may take and who is told of it; what its budget does not allow is
    left coarser, with a warning.

    What is doubtful (values that are not usual, contradicting data, an asymptote asked for outside
    its range) is collected in `warnings`; with `strict` the last two raise instead:
    `ContradictionError`, `OutOfRangeError`. Before anything is solved a display that cannot be
    right is refused, see `require_plausible`. Raises `InputError` for a value that cannot be used,
    or an amplitude given together with a voltage.
    """
    display, frequency, strict = asked.display, asked.frequency, asked.strict
    voltage, amplitude = asked.voltage, asked.vibration_amplitude
    if amplitude is not None and voltage is not None:
        raise InputError("a voltage and an amplitude were both given; give one of them")
    force = display.finger.normal_force if asked.normal_force is None else asked.normal_force
    si.require("normal_force", force, si.Unit("N"), above=0)
    where = display.surface(asked.surface)
    unusual = require_plausible(display, voltage if amplitude is None else 0.0)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        if isinstance(display.actuator, RectangularPlate):
            display.actuator.ceramic.check_consistency(strict=strict)
        mode, replaced = chosen_mode(display.actuator, asked.theory, strict=strict, pace=asked.pace)
        drive = free_vibration(display, mode, frequency, voltage, amplitude)
        law = friction_law(
            display,
            mode.half_wavelength,
            drive.frequency,
            surface=where,
            normal_force=force,
            model=asked.model or DEFAULT_MODEL,
            position=asked.position or 0.0,
            speed=asked.speed,
            place=pad_place(display.actuator, mode, drive.frequency, asked.place),
        )
        if asked.place is None and asked.position is None:
            law = at_best_place(display, mode, law)
        asked_for_asymptote = asked.model is not None and not law.kind.shares_load
        found = _felt(display, mode, drive, law, strict=strict and asked_for_asymptote)
    objections = (*unusual, *replaced)
    doubts = (*objections, *_doubts(caught, found))
    return dataclasses.replace(found, warnings=tuple(dict.fromkeys(doubts)), objections=objections)


def _felt(
    display: Display, mode: WorkingMode, drive: FreeVibration, law: FrictionLaw, *, strict: bool
) -> Prediction:
    """The finger on the vibration, the film under it, and the friction that is left."""
    if drive.voltage is None:
        felt = held_touch(mode, law, drive.amplitude)
    else:
        felt = touch(mode, law, drive.amplitude)
    gap = law.gap(felt.amplitude)
    validity = film_validity(gap, drive.frequency, law.gas, strict=strict)
    load = law.load(felt.amplitude)
    friction, limits = law.at(felt.amplitude), None
    if law.kind.shares_load:
        # The limit that is not the model's own may be out of reach where the model is not.
        with contextlib.suppress(OutOfRangeError):
            tied = law.friction_in("one-gap", np.array([felt.amplitude]))
            limits = friction, float(tied[0])
    base = law.friction_coefficient
    return Prediction(
        display=display.name,
        surface=law.surface,
        voltage=drive.voltage,
        frequency=drive.frequency,
        normal_force=law.normal_force,
        speed=law.speed,
        mode=mode,
        amplitude_model=drive.source,
        vibration_amplitude=felt.amplitude,
        touch=felt,
        model=law.model,
        law=law,
        squeeze_number=validity.squeeze_number,
        mean_pressure=1 + load.over_pressure,
        mean_pressure_error=load.error,
        relative_friction=friction,
        relative_friction_limits=limits,
        friction_coefficient=base,
        friction_reduction=base * (1 - friction),
        tangential_force=base * friction * law.normal_force,
        validity=validity,
        heat=warming_of_mode(
            display.actuator, display.thermal, mode, drive.voltage or 0.0, drive.frequency
        ),
        warnings=(),
    )


def _doubts(caught: list[warnings.WarningMessage], p: Prediction) -> list[str]:
    """Doubts that were warned of on the way, and what the models leave out."""
    kind, limits = p.law.kind, p.relative_friction_limits
    # Of a film that is solved, what fails of the asymptote is no doubt about this number.
    messages = [
        str(item.message)
        for item in caught
        if not kind.shares_load or not issubclass(item.category, OutOfRangeWarning)
    ]
    if (company := p.mode.company) is not None:
        messages.append(company)
    if p.voltage is not None and p.mode.modal_mass is None:
        messages.append(
            "the amplitude is the measured one; what a finger takes from it is not known and left "
            "out"
        )
    most = p.law.finger.largest_force(p.surface.roughness)
    if kind.shares_load and p.normal_force > most:
        asked, held = (si.format_quantity(f, si.Unit("N")) for f in (p.normal_force, most))
        messages.append(
            f"under {asked} most asperities are pressed flat even at rest: this contact's law "
            f"holds to {held}. Press less, or take asperities of type 'rough_contact'"
        )
    if kind.fitted:
        messages.append(
            f"the model '{p.model}' is fitted to people on glass, in two laboratories, each at its "
            "own speed: a new person differs, and so may another surface"
        )
    elif kind.friction == "lift":
        messages.append(
            f"the model '{p.model}' has constants that were published for skin, and no number of "
            "this finger but its pressure"
        )
    elif kind.shares_load:
        spread = (
            "A skin so stiff that all ridges hang on one mean gap is out of this contact's range"
            if limits is None
            else f"Relative friction differs by {abs(limits[0] - limits[1]):.2f} between a skin "
            "that sinks ridge by ridge and a stiff one"
        )
        messages.append(
            f"the model '{p.model}' lets film and asperities share the load of each ridge; "
            "its asperities and plateaus are assumed, not measured, and decide the answer: see the "
            f"interval of squeezefilm friction. {spread}"
        )
    return messages if p.heat is None else [*messages, *p.heat.doubts]
