"""The finger on the vibrating surface: what it takes from the vibration, and how it is carried."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.chain.friction import FrictionLaw
from squeezefilm.contact.finger.load import finger_stiffness, interface_stiffness
from squeezefilm.contact.sharing.pad import PadFriction
from squeezefilm.errors import ConvergenceError
from squeezefilm.plate.loaded_mode import LoadedMode, loaded_mode, mean_square_wave
from squeezefilm.plate.working_mode import WorkingMode

_MOST_STEPS = 40
_TOLERANCE = 1e-8  # of the amplitude
_LEAST_AMPLITUDE: si.Metre = 1e-12


@dataclass(frozen=True, eq=False)
class Touch:
    """A finger on a mode: the amplitude it is left with, and how the load is shared there.

    `free_amplitude` is the one without the finger at the same voltage and frequency; `mode` how
    the finger detunes and damps it, None where the modal mass is not known and the finger is taken
    to change nothing; `sharing` None where the surface stands still.
    """

    free_amplitude: si.Metre
    amplitude: si.Metre
    mode: LoadedMode | None
    sharing: PadFriction | None

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
    if mode.modal_mass is None:
        return Touch(free_amplitude, free_amplitude, None, _sharing(law, free_amplitude))
    free = LoadedMode(mode.resonance_frequency, mode.quality_factor, 0j)
    alone = free.amplitude_ratio(law.frequency)
    amplitude, slope, before = free_amplitude, 0.0, None
    for _ in range(_MOST_STEPS):
        sharing = _sharing(law, amplitude)
        loaded = _loaded(mode, mode.modal_mass, law, amplitude, float(sharing.mean_gap[0]))
        new = free_amplitude * loaded.amplitude_ratio(law.frequency) / alone
        if abs(new - amplitude) <= _TOLERANCE * free_amplitude:
            return Touch(free_amplitude, new, loaded, sharing)
        # Where the finger takes much the two chase each other for long: the secant cuts that short.
        if before is not None:
            slope = (new - before[1]) / (amplitude - before[0])
        before = amplitude, new
        # A slope near 1 is held back: the next place is at most three times the last change away.
        further = amplitude + (new - amplitude) / (1 - min(max(slope, -1.0), 2 / 3))
        amplitude = further if further > 0 else new
    raise ConvergenceError(
        f"the amplitude under the finger did not settle (last change "
        f"{abs(new - amplitude):.3g} m of {free_amplitude:.3g} m); the finger may be heavier than "
        "the mode, which is outside of what one mode can tell",
        residual=abs(new - amplitude) / free_amplitude,
        iterations=_MOST_STEPS,
    )


@si.checked_numbers
def kept_at(mode: WorkingMode, law: FrictionLaw, amplitude: si.Metre) -> si.Dimensionless:
    """The amplitude with the finger over the one without, where the former is known (m)."""
    if mode.modal_mass is None or amplitude < _LEAST_AMPLITUDE:
        return 1.0
    gap = float(_sharing(law, amplitude).mean_gap[0])
    loaded = _loaded(mode, mode.modal_mass, law, amplitude, gap)
    free = LoadedMode(mode.resonance_frequency, mode.quality_factor, 0j)
    return loaded.amplitude_ratio(law.frequency) / free.amplitude_ratio(law.frequency)


@si.checked_numbers
def load_ratios(mode: WorkingMode, law: FrictionLaw, amplitude: si.MetreArray) -> si.ComplexArray:
    """The finger's modal stiffness over the mode's own, δ (complex), at amplitudes with the finger
    on (m), shape (n,). Zero where the modal mass is not known: the finger is left out."""
    found: si.ComplexArray = np.zeros(np.shape(amplitude), dtype=complex)
    if mode.modal_mass is None:
        return found
    gaps = _sharing(law, amplitude).mean_gap
    for i, (one, gap) in enumerate(zip(amplitude, gaps, strict=True)):
        found[i] = _loaded(mode, mode.modal_mass, law, float(one), float(gap)).load_ratio
    return found


def _sharing(law: FrictionLaw, amplitude: si.MetreLike) -> PadFriction:
    # Whatever the law: a model that holds the gap says nothing of what the finger takes.
    return law.sharing(amplitude, law.kind.limit)


def _loaded(
    mode: WorkingMode, modal_mass: float, law: FrictionLaw, amplitude: si.Metre, mean_gap: si.Metre
) -> LoadedMode:
    finger = law.finger
    share = finger.plateau_width / finger.ridge_period
    interface = interface_stiffness(
        mean_gap,
        min(amplitude, 0.9 * mean_gap),
        finger.plateau_width,
        law.frequency,
        law.gas,
        finger.asperity_law(law.surface.roughness),
    )
    area = finger.contact_area(law.normal_force)
    return loaded_mode(
        mode.resonance_frequency,
        mode.quality_factor,
        modal_mass,
        finger_stiffness(interface, finger.skin, law.frequency, share),
        area,
        mean_square_wave(law.half_wavelength, area**0.5, law.position),
    )
