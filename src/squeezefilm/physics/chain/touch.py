"""The vibration of a display: without a finger, and what a finger takes from it."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import ConvergenceError, InputError, OutOfTimeError
from squeezefilm.core.hard_limits import TOUCHED_VIBRATION, require_within
from squeezefilm.core.progress import NO_HURRY, Pace
from squeezefilm.physics.chain.friction import FrictionLaw
from squeezefilm.physics.contact.finger.load import NewtonSecondPerMetreComplex, finger_impedance
from squeezefilm.physics.contact.sharing.pad import PadFriction
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import Actuator, RectangularPlate
from squeezefilm.physics.plate.loaded_mode import LoadedMode, loaded_mode
from squeezefilm.physics.plate.working_mode import PlateTheory, WorkingMode, working_mode

Objections = tuple[str, ...]


def chosen_mode(
    actuator: Actuator,
    theory: PlateTheory | None = None,
    *,
    strict: bool = False,
    pace: Pace = NO_HURRY,
) -> tuple[WorkingMode, Objections]:
    """The working mode of an actuator, and what speaks against it, in sentences.

    Without a `theory` a plate is solved in three dimensions, and taken as a beam, with an
    objection, where that finds no such mode or the budget of `pace` does not allow it; with
    `strict` it raises then. Raises what `working_mode` raises.
    """
    if theory is not None or strict or not isinstance(actuator, RectangularPlate):
        mode = working_mode(actuator, theory or "solid", pace=pace)
        return mode, _coarseness(mode)
    try:
        mode = working_mode(actuator, "solid", pace=pace)
    except OutOfTimeError as error:
        return working_mode(actuator, "timoshenko"), (
            f"{error}; the numbers are those of a beam, whose frequency lies within 13 % of the "
            "solved one (on 95 random plates) and whose amplitude mostly within a factor of two",
        )
    except InputError as error:
        return working_mode(actuator, "timoshenko"), (
            f"the solved plate does not give the working mode ({error}); a beam's, whose numbers "
            "these are, need not exist in such a plate",
        )
    return mode, _coarseness(mode)


def _coarseness(mode: WorkingMode) -> Objections:
    if mode.solid is None or not mode.solid.coarseness:
        return ()
    return (mode.solid.coarseness,)


class FreeVibration(NamedTuple):
    """A plate that vibrates without a finger: its voltage where that is known, and what made the
    amplitude (m, zero-to-peak, at the antinode)."""

    frequency: si.Hertz
    voltage: si.Volt | None
    amplitude: si.Metre
    source: str


@si.checked_numbers
def free_vibration(
    display: Display,
    mode: WorkingMode,
    frequency: Annotated[si.Hertz, si.Above(0)] | None,
    voltage: si.Volt | None,
    vibration_amplitude: si.Metre | None,
) -> FreeVibration:
    """The vibration at a voltage (V), the display's own by default, or the one given (m).

    The frequency (Hz) is the resonance without one. Raises `InputError` for values
    below 0, or an amplitude beyond what is touched.
    """
    frequency = mode.resonance_frequency if frequency is None else frequency
    if vibration_amplitude is not None:
        require_within(TOUCHED_VIBRATION, vibration_amplitude, "vibration_amplitude")
        return FreeVibration(frequency, None, vibration_amplitude, "given")
    volts = display.drive.voltage if voltage is None else voltage
    si.require("voltage", volts, si.Unit("V"), at_least=0)
    amplitude = volts * amplitude_per_volt(mode, frequency)
    return FreeVibration(frequency, volts, float(amplitude), mode.model)


@si.checked_numbers
def amplitude_per_volt(mode: WorkingMode, frequency: si.Hertz) -> si.MetrePerVolt:
    """The amplitude per volt (m/V) without a finger; off resonance with the mode's neighbours."""
    if frequency == mode.resonance_frequency:
        return mode.amplitude_per_volt
    return float(mode.response(np.array([frequency]))[0])


_MOST_STEPS = 40
# Where an amplitude is searched, over the free one: fine where two may lie side by side.
_BELOW = np.concatenate([np.linspace(1.0, 0.05, 120), np.geomspace(0.05, 1e-6, 41)[1:]])
# Of the mean square of the mode under a pad, between which amplitudes are interpolated.
_KNOTS = 17
TOLERANCE: si.Dimensionless = 1e-11
"""Tolerance of amplitude and load where nothing else is asked, a share of the free amplitude."""

_LEAST_AMPLITUDE: si.Metre = 1e-12


@dataclass(frozen=True, eq=False)
class Touch:
    """A finger on a mode: the amplitude it is left with, and what the plate feels of it.

    `free_amplitude` is the one without the finger at the same voltage and frequency; `mode` how
    the finger detunes and damps it, None where the modal mass is not known and the finger is taken
    to change nothing; `law` the pad that is carried, None where the surface stands still, and so
    is `impedance`: what the plate feels of the finger at this amplitude, as `finger_impedance`
    gives it (N·s/m).
    """

    free_amplitude: si.Metre
    amplitude: si.Metre
    mode: LoadedMode | None
    law: FrictionLaw | None
    impedance: NewtonSecondPerMetreComplex | None = None

    @functools.cached_property
    def sharing(self) -> PadFriction | None:
        """Sharing of the load between film and asperities at this amplitude, each ridge where it
        is; None where the surface stands still. Raises what the load balance raises."""
        law = self.law
        return None if law is None else law.sharing(self.amplitude)

    @property
    def kept(self) -> si.Dimensionless:
        """The amplitude with the finger over the one without (1 at rest)."""
        return self.amplitude / self.free_amplitude if self.free_amplitude > 0 else 1.0


@si.checked_numbers
def touch(
    mode: WorkingMode,
    law: FrictionLaw,
    free_amplitude: si.Metre,
    *,
    tolerance: Annotated[si.Dimensionless, si.AtLeast(1e-12), si.AtMost(0.01)] = TOLERANCE,
) -> Touch:
    """The vibration with a finger on it, whose load depends on the amplitude.

    Solved until amplitude and load fit to a `tolerance`, a share of the free amplitude.

    The finger rests where the law has it, film and asperities in the balance of the law (partial
    levitation, whatever its model). Where several amplitudes fit (a finger that lets go as the film
    lifts it) this is the one reached from the free plate. Range: see `loaded_mode` and
    `finger.load.between`. Raises `ConvergenceError` if amplitude and finger do not settle, and what
    the load balance raises.
    """
    if free_amplitude < _LEAST_AMPLITUDE:
        return Touch(free_amplitude, free_amplitude, None, None)
    left = _touched(mode, _Pad.of(law), free_amplitude, tolerance)
    impedance = left.felt.impedance(law.frequency)
    return Touch(free_amplitude, left.amplitude, left.mode, law, impedance)


@si.checked_numbers
def held_touch(mode: WorkingMode, law: FrictionLaw, amplitude: si.Metre) -> Touch:
    """The finger on a vibration whose amplitude with the finger on it is known (m): `touch` from
    its end to its beginning. Range and errors as those of `touch`."""
    if amplitude == 0:
        return Touch(amplitude, amplitude, None, None)
    felt = _carried(_Pad.of(law), amplitude)
    loaded = None if mode.modal_mass is None else _loaded(mode, mode.modal_mass, felt)
    kept = 1.0 if loaded is None else loaded.amplitude_ratio(law.frequency) / _alone(mode, law)
    if amplitude / kept < _LEAST_AMPLITUDE:
        return Touch(amplitude, amplitude, None, None)
    return Touch(amplitude / kept, amplitude, loaded, law, felt.impedance(law.frequency))


@si.checked_numbers
def touched_amplitudes(
    mode: WorkingMode,
    law: FrictionLaw,
    free_amplitude: si.Metre,
    mean_square: Annotated[si.DimensionlessArray, si.AtLeast(0.0)],
) -> si.MetreArray:
    """The best antinode's amplitude (m) with the finger at places of other mean squares.

    `mean_square` of the mode over the contact, the best antinode at 1, any shape: a finger beside
    the antinodes takes less. As `touch` at some dozen of them, interpolated within 1e-4 of the
    amplitude. Raises as `touch` does.
    """
    if mode.modal_mass is None or free_amplitude < _LEAST_AMPLITUDE:
        return np.full(mean_square.shape, free_amplitude)
    low, high = float(np.min(mean_square)), float(np.max(mean_square))
    # Amplitudes fall fastest where a pad just begins to lie on the mode, nearly as 1/(1 + c x).
    knots = low + (high - low) * np.linspace(0, 1, _KNOTS if high > low else 1) ** 2
    over = dataclasses.replace(law, place=None, position=0.0)
    left = [
        _touched(mode, _Pad.at(over, float(knot)), free_amplitude, TOLERANCE).amplitude
        for knot in knots
    ]
    if high == low:
        return np.full(mean_square.shape, left[0])
    return 1 / np.asarray(PchipInterpolator(knots, 1 / np.array(left))(mean_square))


class _Pad(NamedTuple):
    """A pad by how much of the mode it lies on: its law, the mean square of the mode there, and
    what an antinode of an even wave with that mean square moves over the best one."""

    law: FrictionLaw
    mean_square: float
    scale: float

    @classmethod
    def of(cls, law: FrictionLaw) -> _Pad:
        """Pad as a law has it."""
        return cls.at(law, law.mean_square)

    @classmethod
    def at(cls, law: FrictionLaw, mean_square: float) -> _Pad:
        """Pad where the mode has a mean square."""
        return cls(law, mean_square, (mean_square / law.mean_square_even) ** 0.5)


def _touched(mode: WorkingMode, pad: _Pad, free_amplitude: si.Metre, tolerance: float) -> _Left:
    """The vibration with a pad on it."""
    modal_mass, frequency = mode.modal_mass, pad.law.frequency
    if modal_mass is None:
        return _Left(free_amplitude, None, _carried(pad, free_amplitude))
    alone = _alone(mode, pad.law)

    def made(amplitude: float) -> _Left:
        """Vibration under a finger that lies on the mode as it does at an amplitude."""
        felt = _carried(pad, amplitude)
        loaded = _loaded(mode, modal_mass, felt)
        new = free_amplitude * loaded.amplitude_ratio(frequency) / alone
        return _Left(new, loaded, felt)

    return _settled(made, free_amplitude, tolerance) or _searched(
        made, free_amplitude, free_amplitude / alone, tolerance
    )


def _settled(made: Callable[[float], _Left], free: float, tolerance: float) -> _Left | None:
    """The vibration that makes itself, by secants from the free one; None if it takes too long."""
    amplitude, slope, before = free, 0.0, None
    for _ in range(_MOST_STEPS):
        touch = made(amplitude)
        new = touch.amplitude
        if abs(new - amplitude) <= tolerance * free:
            return touch
        # Where the finger takes much the two chase each other for long: the secant cuts that short.
        if before is not None:
            slope = (new - before[1]) / (amplitude - before[0])
        before = amplitude, new
        # A slope near 1 is held back: the next place is at most three times the last change away.
        further = amplitude + (new - amplitude) / (1 - min(max(slope, -1.0), 2 / 3))
        amplitude = further if further > 0 else new
    return None


def _searched(made: Callable[[float], _Left], free: float, most: float, tolerance: float) -> _Left:
    """The vibration that makes itself nearest to the free one, below `most` (m, the mode's free
    amplitude at its resonance): where two such are about to become one and vanish, secants crawl.
    """
    from scipy.optimize import brentq

    def gain(amplitude: float) -> float:
        return made(amplitude).amplitude - amplitude

    near, at_near = free, gain(free)
    # A finger takes energy and gives none, so that nothing above `most` is made.
    end = most * (1 + 1e-9)
    places = free * _BELOW if at_near < 0 else np.linspace(free, end, _BELOW.size)
    for far in places[1:].tolist():
        at_far = gain(far)
        if at_near * at_far <= 0:
            amplitude = float(brentq(gain, near, far, xtol=1e-12 * free, rtol=1e-14))
            touch = made(amplitude)
            at_near = touch.amplitude - amplitude
            if abs(at_near) <= tolerance * free:
                return touch
            break
        near, at_near = far, at_far
    raise ConvergenceError(
        f"the amplitude under the finger did not settle (last change {abs(at_near):.3g} m of "
        f"{free:.3g} m); the finger may be heavier than the mode, which is outside of what one "
        "mode can tell",
        residual=abs(at_near) / free,
        iterations=_MOST_STEPS + _BELOW.size,
    )


@si.checked_numbers
def kept_at(mode: WorkingMode, law: FrictionLaw, amplitude: si.Metre) -> si.Dimensionless:
    """The amplitude with the finger over the one without, where the former is known (m)."""
    if mode.modal_mass is None or amplitude < _LEAST_AMPLITUDE:
        return 1.0
    loaded = _loaded(mode, mode.modal_mass, _carried(_Pad.of(law), amplitude))
    return loaded.amplitude_ratio(law.frequency) / _alone(mode, law)


@si.checked_numbers
def load_ratios(mode: WorkingMode, law: FrictionLaw, amplitude: si.MetreArray) -> si.ComplexArray:
    """The finger's modal stiffness over the mode's own, δ (complex), at amplitudes with the finger
    on (m), shape (n,). Zero where the modal mass is not known: the finger is left out."""
    ratio: si.ComplexArray = np.zeros(np.shape(amplitude), dtype=complex)
    if mode.modal_mass is None:
        return ratio
    pad = _Pad.of(law)
    for i, each in enumerate(np.ravel(amplitude).tolist()):
        ratio.flat[i] = _loaded(mode, mode.modal_mass, _carried(pad, each)).load_ratio
    return ratio


def _carried(pad: _Pad, amplitude: si.Metre) -> _Felt:
    """Finger as the plate feels it at an amplitude of the best antinode."""
    law = pad.law
    stiffness = law.felt_stiffness(pad.scale * amplitude)
    return _Felt(stiffness, law.finger.contact_area(law.normal_force), pad.mean_square)


class _Felt(NamedTuple):
    """Finger as a plate feels it: complex stiffness per area (Pa/m), area of contact (m²), and the
    mean square of the wave over it."""

    stiffness_per_area: complex
    area: float
    mean_square: float

    def impedance(self, frequency: float) -> complex:
        """Impedance of the whole finger, at the antinode (N·s/m)."""
        return finger_impedance(self.stiffness_per_area, self.area, frequency, self.mean_square)


class _Left(NamedTuple):
    """Vibration that is left: its amplitude (m), the mode and what the plate feels then."""

    amplitude: float
    mode: LoadedMode | None
    felt: _Felt


def _loaded(mode: WorkingMode, modal_mass: float, felt: _Felt) -> LoadedMode:
    return loaded_mode(mode.resonance_frequency, mode.quality_factor, modal_mass, *felt)


def _alone(mode: WorkingMode, law: FrictionLaw) -> float:
    """The amplitude without a finger at the law's frequency, over that at the resonance."""
    free = LoadedMode(mode.resonance_frequency, mode.quality_factor, 0j)
    return free.amplitude_ratio(law.frequency)
