"""The finger on the vibrating surface: what it takes from the vibration, and how it is carried."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.chain.friction import FrictionLaw
from squeezefilm.contact.finger.load import (
    NewtonSecondPerMetreComplex,
    finger_impedance,
    finger_stiffness,
    interface_stiffness,
)
from squeezefilm.contact.rough_contact import RoughContact
from squeezefilm.contact.sharing.pad import PadFriction
from squeezefilm.errors import ConvergenceError
from squeezefilm.plate.loaded_mode import LoadedMode, loaded_mode, mean_square_wave
from squeezefilm.plate.working_mode import WorkingMode

_MOST_STEPS = 40
# Where an amplitude is searched, over the free one: fine where two may lie side by side.
_BELOW = np.concatenate([np.linspace(1.0, 0.05, 120), np.geomspace(0.05, 1e-6, 41)[1:]])
_TOLERANCE = 1e-8  # of the amplitude
_LEAST_AMPLITUDE: si.Metre = 1e-12


@dataclass(frozen=True, eq=False)
class Touch:
    """A finger on a mode: the amplitude it is left with, and how the load is shared there.

    `free_amplitude` is the one without the finger at the same voltage and frequency; `mode` how
    the finger detunes and damps it, None where the modal mass is not known and the finger is taken
    to change nothing; `sharing` None where the surface stands still, and so is `impedance`: what
    the plate feels of the finger at this amplitude, as `finger_impedance` gives it (N·s/m).
    """

    free_amplitude: si.Metre
    amplitude: si.Metre
    mode: LoadedMode | None
    sharing: PadFriction | None
    impedance: NewtonSecondPerMetreComplex | None = None

    @property
    def kept(self) -> si.Dimensionless:
        """The amplitude with the finger over the one without (1 at rest)."""
        return self.amplitude / self.free_amplitude if self.free_amplitude > 0 else 1.0


@si.checked_numbers
def touch(mode: WorkingMode, law: FrictionLaw, free_amplitude: si.Metre) -> Touch:
    """The vibration with a finger on it, whose load depends on the amplitude: solved to 1e-8.

    The finger rests where the law has it, film and asperities in the balance of the law (partial
    levitation, whatever its model). Where several amplitudes fit (a finger that lets go as the film
    lifts it) this is the one reached from the free plate. Range: see `loaded_mode` and
    `interface_stiffness`. Raises `ConvergenceError` if amplitude and finger do not settle, and what
    the load balance raises.
    """
    if free_amplitude < _LEAST_AMPLITUDE:
        return Touch(free_amplitude, free_amplitude, None, None)
    modal_mass = mode.modal_mass
    if modal_mass is None:
        sharing = _sharing(law, free_amplitude)
        felt = _felt(law, free_amplitude, float(sharing.mean_gap[0])).impedance(law.frequency)
        return Touch(free_amplitude, free_amplitude, None, sharing, felt)
    alone = _alone(mode, law)

    def made(amplitude: float) -> Touch:
        """Under a finger that lies on the mode as it does at an amplitude."""
        sharing = _sharing(law, amplitude)
        felt = _felt(law, amplitude, float(sharing.mean_gap[0]))
        loaded = _loaded(mode, modal_mass, felt)
        new = free_amplitude * loaded.amplitude_ratio(law.frequency) / alone
        return Touch(free_amplitude, new, loaded, sharing, felt.impedance(law.frequency))

    return _settled(made, free_amplitude) or _searched(made, free_amplitude, free_amplitude / alone)


def _settled(made: Callable[[float], Touch], free: float) -> Touch | None:
    """The vibration that makes itself, by secants from the free one; None if it takes too long."""
    amplitude, slope, before = free, 0.0, None
    for _ in range(_MOST_STEPS):
        found = made(amplitude)
        new = found.amplitude
        if abs(new - amplitude) <= _TOLERANCE * free:
            return found
        # Where the finger takes much the two chase each other for long: the secant cuts that short.
        if before is not None:
            slope = (new - before[1]) / (amplitude - before[0])
        before = amplitude, new
        # A slope near 1 is held back: the next place is at most three times the last change away.
        further = amplitude + (new - amplitude) / (1 - min(max(slope, -1.0), 2 / 3))
        amplitude = further if further > 0 else new
    return None


def _searched(made: Callable[[float], Touch], free: float, most: float) -> Touch:
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
            found = made(amplitude)
            at_near = found.amplitude - amplitude
            if abs(at_near) <= _TOLERANCE * free:
                return found
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
    felt = _felt(law, amplitude, float(_sharing(law, amplitude).mean_gap[0]))
    loaded = _loaded(mode, mode.modal_mass, felt)
    return loaded.amplitude_ratio(law.frequency) / _alone(mode, law)


@si.checked_numbers
def load_ratios(mode: WorkingMode, law: FrictionLaw, amplitude: si.MetreArray) -> si.ComplexArray:
    """The finger's modal stiffness over the mode's own, δ (complex), at amplitudes with the finger
    on (m), shape (n,). Zero where the modal mass is not known: the finger is left out."""
    found: si.ComplexArray = np.zeros(np.shape(amplitude), dtype=complex)
    if mode.modal_mass is None:
        return found
    gaps = _sharing(law, amplitude).mean_gap
    for i, (one, gap) in enumerate(zip(amplitude, gaps, strict=True)):
        felt = _felt(law, float(one), float(gap))
        found[i] = _loaded(mode, mode.modal_mass, felt).load_ratio
    return found


def _sharing(law: FrictionLaw, amplitude: si.MetreLike) -> PadFriction:
    # Whatever the law: a model that holds the gap says nothing of what the finger takes.
    return law.sharing(amplitude, law.kind.limit)


class _Felt(NamedTuple):
    """What a plate feels of a finger: complex stiffness per area (Pa/m), area of contact (m²), and
    the mean square of the wave over it."""

    stiffness_per_area: complex
    area: float
    mean_square: float

    def impedance(self, frequency: float) -> complex:
        """Of the whole finger, at the antinode (N·s/m)."""
        return finger_impedance(self.stiffness_per_area, self.area, frequency, self.mean_square)


def _felt(law: FrictionLaw, amplitude: si.Metre, mean_gap: si.Metre) -> _Felt:
    finger, asperities = law.finger, law.asperities
    # The plateaus' mean gap beside the antinode's swing, which most of them do not meet: no deeper
    # than the contact's law goes.
    deepest = 0.9 * mean_gap
    if isinstance(asperities, RoughContact):
        deepest = min(deepest, mean_gap - asperities.least_gap)
    interface = interface_stiffness(
        mean_gap,
        min(amplitude, deepest),
        finger.plateau_width,
        law.frequency,
        law.gas,
        asperities,
    )
    share = finger.plateau_width / finger.ridge_period
    area = finger.contact_area(law.normal_force)
    return _Felt(
        finger_stiffness(interface, finger.skin, law.frequency, share),
        area,
        mean_square_wave(law.half_wavelength, area**0.5, law.position),
    )


def _loaded(mode: WorkingMode, modal_mass: float, felt: _Felt) -> LoadedMode:
    return loaded_mode(mode.resonance_frequency, mode.quality_factor, modal_mass, *felt)


def _alone(mode: WorkingMode, law: FrictionLaw) -> float:
    """The amplitude without a finger at the law's frequency, over that at the resonance."""
    free = LoadedMode(mode.resonance_frequency, mode.quality_factor, 0j)
    return free.amplitude_ratio(law.frequency)
