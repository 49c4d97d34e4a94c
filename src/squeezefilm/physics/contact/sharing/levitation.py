"""The levitation model of 2016, in closed form and with solved films over single ridges: a film
lifts off a contact that reaches high.

Wiertlewski, Fenton Friesen and Colgate, PNAS 113 (2016) 9210, supporting information: the squeezed
film lifts a skin whose contact pressure falls off with the gap u as exp(−u/ℓ),

    p_s (1 − exp(−(u − u0)/ℓ)) = (5/4) p0 a²/u²,    µ′/µ = exp(−(u − u0)/ℓ),

with the finger's pressure p_s, ambient p0, and the gap u0 at rest. With z = (u − u0)/ℓ and the
scale g = ℓ √(p_s/(1.25 p0)) it is (1 − exp(−z)) (z + u0/ℓ)² = (a/g)². The film's asymptote is that
of a large squeeze number and a small excursion; the excursion is always small, since a/u stays
below √(p_s/(1.25 p0)), 0.15 for 2.8 kPa in air.

The published gap at rest is u0 = ℓ ln(p_c/p_s), p_c = 0.375 q0 u_rms E/(1 − ν²), with skin of
u_rms = 5 µm, q0 = 1e4 1/m, E = 20 MPa, ν = 0.5. As printed ℓ = u_rms, which makes u0 26 µm where
the text says 2 u_rms; with Persson's ℓ = 0.4 u_rms, taken here, it is 10.4 µm.

A finger has ridges, and a film between ambient grooves is no wider than one. With the solved film
of a plateau in place of the asymptote, and what a plateau carries as its pressure, the same curves
of people ask for an ℓ of 1.2 to 2.0 µm, as 0.4 u_rms of skin has it.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Annotated, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import announce
from squeezefilm.core.errors import OutOfRangeError, UnreachableError
from squeezefilm.core.materials import Gas
from squeezefilm.physics.contact.sharing.gas_table import FilmTable, complete
from squeezefilm.physics.film.closed import PaperModel, contact_mean_pressure
from squeezefilm.physics.film.gap import PaperGap

# Of a ridge (m): films at less lie outside of those that come with the package.
_LEAST_AMPLITUDE = 50e-9
# Of z: from where µ′/µ is 1 to rounding to where it has left the range of a float.
_LIFT = np.geomspace(1e-18, 745.0, 12000)


PUBLISHED_DECAY_LENGTH: si.Metre = 0.4 * 5e-6
_PUBLISHED_PRESSURE: si.Pascal = 0.375 * 1e4 * 5e-6 * 20e6 / (1 - 0.5**2)


@si.checked_numbers
def published_rest_gap(contact_pressure: Annotated[si.Pascal, si.Above(0.0)]) -> si.Dimensionless:
    """The gap at rest u0/ℓ with the constants of 2016, under a pressure of the finger (Pa); 0 from
    500 kPa on."""
    return max(0.0, math.log(_PUBLISHED_PRESSURE / contact_pressure))


@si.checked_numbers
def levitation_scale(
    decay_length: Annotated[si.Metre, si.Above(0.0)],
    contact_pressure: Annotated[si.Pascal, si.Above(0.0)],
    ambient_pressure: Annotated[si.Pascal, si.Above(0.0)],
) -> si.Metre:
    """The amplitude g (m) in which the model counts, of a decay length ℓ (m), the pressure of the
    finger on the surface and the ambient one (Pa): g = ℓ √(p_s/(1.25 p0))."""
    return decay_length * float(np.sqrt(contact_pressure / (1.25 * ambient_pressure)))


@si.checked_numbers
def levitation_friction(
    relative_amplitude: Annotated[si.DimensionlessArray, si.AtLeast(0.0), si.AtMost(1e6)],
    rest_gap: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1e6)] = 0.0,
) -> si.DimensionlessArray:
    """Relative friction µ′/µ within 1e-5 over the amplitude in scales g, any shape; `rest_gap` is
    u0/ℓ.

    Without a gap at rest friction falls at once, with one it falls as a Gaussian at first. Range:
    amplitudes small against the gap, a contact of many wavelengths of the squeezed film (a squeeze
    number of hundreds). Raises `InputError` for what is out of range.
    """
    log_amplitude, log_lift = _table(rest_gap)
    # At rest the logarithm is -inf, which the table's first lift answers.
    with np.errstate(divide="ignore"):
        lift = np.interp(np.log(relative_amplitude), log_amplitude, log_lift)
    return np.exp(-np.exp(lift))


@functools.lru_cache(maxsize=8)
def _table(rest_gap: float) -> tuple[si.FloatArray, si.FloatArray]:
    """Logarithms of the amplitude that makes a lift z, and of z."""
    amplitude = np.sqrt(-np.expm1(-_LIFT)) * (_LIFT + rest_gap)
    return np.log(amplitude), np.log(_LIFT)


@si.checked_numbers
@functools.lru_cache(maxsize=16)
def ridge_films(frequency: si.Hertz, width: si.Metre, gas: Gas, slip: str) -> FilmTable:
    """The films of a plateau for `ridge_friction`, in a table of their own: they reach gaps that no
    balance does, which may take more nodes, and no other model's numbers may depend on them."""
    return FilmTable(frequency, width, gas, slip)


@si.checked_numbers
def ridge_friction(
    films: FilmTable,
    amplitude: Annotated[si.MetreArray, si.AtLeast(0.0)],
    plateau_pressure: Annotated[si.Pascal, si.Above(0.0)],
    decay_length: Annotated[si.Metre, si.Above(0.0)],
) -> si.DimensionlessArray:
    """Relative friction µ′/µ of ridges over the amplitudes that they meet (m), any shape: the film
    of a plateau, solved, lifts it until p_s (1 − exp(−u/ℓ)) is what the film carries at the mean
    gap u.

    Within 2e-3 below 50 nm, else 1e-4 beside the table's error. Where the film would have to be
    thinner than the vibration is deep, the gap stays at what the vibration leaves (0.7 % of it at
    the least). Range: that of the films. Raises `ConvergenceError` where a film cannot be solved.
    """
    from squeezefilm.physics.contact.sharing import kernel

    announce(kernel.lifted_rows, "films over ridges", 5)
    met = np.maximum(np.ravel(amplitude), _LEAST_AMPLITUDE)
    gaps = np.empty(met.size)
    load, length = plateau_pressure, decay_length
    complete(films, lambda known: kernel.lifted_rows(met, load, length, known, gaps))
    # Thinner films keep their gap: u³ goes with a².
    lift = gaps / decay_length * (np.ravel(amplitude) / met) ** (2 / 3)
    return np.exp(-lift).reshape(np.shape(amplitude))


# Biet et al., equations 13 and 14. Model "paper2008" is the corrected form, "paper2008-printed" the
# equations as they stand. Both take σ → ∞, which the paper's σ ≈ 20 is far from: ask
# `physics.film.validity.film_validity`.
HIGHEST_AMPLITUDE: si.Metre = 50e-6


def _unclipped(gap: PaperGap, force: Any, ambient: float, model: PaperModel) -> Any:
    """1 − (⟨P̄⟩ − 1)/P_f, below zero where the finger would float away."""
    over_pressure = contact_mean_pressure(gap, model) - 1
    pressure = force / gap.contact_length**2
    return 1 - over_pressure / (pressure if model == "paper2008-printed" else pressure / ambient)


@si.checked_numbers
def relative_friction(
    gap: PaperGap,
    normal_force: Annotated[si.NewtonLike, si.Above(0.0)],
    ambient_pressure: Annotated[si.Pascal, si.Above(0.0)],
    model: PaperModel = "paper2008",
) -> si.DimensionlessLike:
    """The relative friction µ′/µ (dimensionless) of the paper's model at the amplitude(s) of `gap`.

    Scalar, or one value for each amplitude; `normal_force` in N broadcasts against them. The
    contact is l0 × l0, and the pressure that of σ → ∞. "paper2008-printed" takes eqs 1, 2, 12, 13
    and 14 as they stand, P∞ being the normalised pressure that the text calls it: it gives
    practically 1 at every amplitude.

    Raises `InputError` for values that are not finite or positive, or an unknown model.
    """
    value = np.maximum(0.0, _unclipped(gap, normal_force, ambient_pressure, model))
    return value if np.ndim(value) else float(value)


@si.checked_numbers
def vibration_amplitude_for(
    relative_friction: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)],
    gap: PaperGap,
    normal_force: Annotated[si.Newton, si.Above(0.0)],
    ambient_pressure: Annotated[si.Pascal, si.Above(0.0)],
    model: PaperModel = "paper2008",
) -> si.Metre:
    """The least vibration amplitude (m, zero-to-peak) that brings µ′/µ down to a wanted value.

    `relative_friction` in [0, 1]; the amplitude in `gap` is disregarded. Raises `InputError` for
    values out of bounds and `UnreachableError` where no amplitude up to 50 µm brings the friction
    that low.
    """

    def friction(amplitude: float) -> float:
        at = gap.with_amplitude(amplitude)
        return float(_unclipped(at, normal_force, ambient_pressure, model))

    return least_amplitude(friction, relative_friction, model)


@si.checked_numbers
def least_amplitude(
    friction: Callable[[float], float],
    wanted: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)],
    model: str,
    highest: Annotated[si.Metre, si.Above(2e-8)] = HIGHEST_AMPLITUDE,
) -> si.Metre:
    """The least amplitude (m) at which `friction` of an amplitude falls to `wanted`.

    Raises `UnreachableError` where none up to `highest` (m, 50 µm) does.
    """
    from scipy.optimize import brentq

    if wanted == 1:
        return 0.0

    def excess(amplitude: float) -> float:
        return friction(amplitude) - wanted

    # What is asked for may be within the rounding of what a still surface has.
    if excess(0.0) <= 0:
        return 0.0
    low, least = 0.0, 1.0
    for high in np.geomspace(2e-8, highest, 24):
        try:
            left = excess(float(high))
        except OutOfRangeError:
            # So strong a vibration closes the gap at some ridge: it is no way to get there.
            break
        if left <= 0:
            return float(brentq(excess, low, high, xtol=1e-20, rtol=1e-12))
        low, least = float(high), min(least, left + wanted)
    raise UnreachableError(
        f"relative_friction = {wanted:.4g} is not reached by any vibration amplitude up to "
        f"{si.format_quantity(highest, si.Unit('m'))}: the model '{model}' "
        f"gives {least:.4g} at the least; press less, take a smoother surface or ask for less"
    )
