"""The impedance that two recorded quantities make: |Z| and phase, capacitance and loss, reflection,
two voltages and a shunt; the phase that goes with a size alone; and the device alone, out of
sweeps of it in its fixture, of the open and of the shorted fixture."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, cast

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.measure.recordings.description import DescribedImpedance, Description
from squeezefilm.measure.recordings.kinds import ImpedanceSweep, Recording


class Fixture(NamedTuple):
    """Quantities beside the two: angular frequency (rad/s), the reference impedance of
    a network analyser (Ω), and the shunt (Ω)."""

    omega: si.FloatArray
    reference: si.Ohm
    shunt: si.Ohm


# NumPy's types of quotients are wider than any of these arrays.
Made = Callable[[Any, Any, Fixture], Any]
"""The impedance (Ω) that two recorded quantities make, all (points,)."""


def _polar(size: si.FloatArray, phase: si.FloatArray) -> si.ComplexArray:
    return np.asarray(size * np.exp(1j * phase))


def _reflected(wave: si.ComplexArray, at: Fixture) -> si.ComplexArray:
    """Impedance of a one-port at the end of a line."""
    return np.asarray(at.reference * (1 + wave) / (1 - wave))


def _through(wave: si.ComplexArray, at: Fixture) -> si.ComplexArray:
    """Impedance of what stands in series between two ports."""
    return np.asarray(2 * at.reference * (1 - wave) / wave)


# The reactance of what is in series, the susceptance of what is in parallel, by its value and ω.
_REACTIVE: Mapping[str, Callable[[Any, Any], Any]] = {
    "series_capacitance": lambda c, omega: -1 / (omega * c),
    "series_inductance": lambda coil, omega: omega * coil,
    "parallel_capacitance": lambda c, omega: omega * c,
    "parallel_inductance": lambda coil, omega: -1 / (omega * coil),
}
# The resistance or conductance beside it, by what was recorded of it and the size of that.
_LOSSES: Mapping[str, Callable[[Any, Any], Any]] = {
    "resistance": lambda r, x: r,
    "conductance": lambda g, b: g,
    "parallel_resistance": lambda r, b: 1 / r,
    "dissipation_factor": lambda d, x: x * d,
    "quality_factor": lambda q, x: x / q,
    "magnitude": lambda z, x: np.sqrt(np.maximum(z**2 - x**2, 0)),
}
_RATIOS, _PARALLEL = (
    ("dissipation_factor", "quality_factor"),
    ("conductance", "parallel_resistance"),
)


def _beside(part: str, loss: str, *, swapped: bool = False) -> Made:
    """What a reactive part makes with a loss, or with the size of both. A ratio of a negative part
    is taken as positive, to which some instruments give its sign and others none."""

    def made(value: Any, other: Any, at: Fixture) -> Any:
        value, other = (other, value) if swapped else (value, other)
        parallel = part.startswith("parallel")
        if loss in _RATIOS:
            other = np.where(value < 0, np.abs(other), other)
        elif loss == "magnitude" and parallel:
            other = 1 / other
        x = _REACTIVE[part](value, at.omega)
        whole = _LOSSES[loss](other, np.abs(x)) + 1j * x
        return 1 / whole if parallel else whole

    return made


IMPEDANCES: Mapping[tuple[str, ...], Made] = {
    ("magnitude", "phase"): lambda z, phase, at: _polar(z, phase),
    ("resistance", "reactance"): lambda r, x, at: r + 1j * x,
    ("admittance_magnitude", "phase"): lambda y, phase, at: 1 / _polar(y, phase),
    ("conductance", "susceptance"): lambda g, b, at: 1 / (g + 1j * b),
    **{
        (part, loss): _beside(part, loss)
        for part in _REACTIVE
        for loss in (*(_PARALLEL if part.startswith("parallel") else ("resistance",)), *_RATIOS)
    },
    **{("magnitude", part): _beside(part, "magnitude", swapped=True) for part in _REACTIVE},
    ("reflection", "reflection_imaginary"): lambda re, im, at: _reflected(re + 1j * im, at),
    ("reflection", "phase"): lambda s, phase, at: _reflected(_polar(s, phase), at),
    ("transmission", "transmission_imaginary"): lambda re, im, at: _through(re + 1j * im, at),
    ("transmission", "phase"): lambda s, phase, at: _through(_polar(s, phase), at),
    # Of what stands above a shunt, by the shunt's voltage over that of both.
    ("gain", "phase"): lambda h, phase, at: at.shunt * (1 / _polar(h, phase) - 1),
}
"""The pairs of which one must be named, those first that say most, and what each makes."""

SIZES = ("magnitude", "admittance_magnitude", "gain")
"""Quantities that make a sweep by themselves, without a phase."""
_BEYOND, _LOSSY = 200, 1 + 0.02j


def with_phase(frequency: si.HertzArray, size: si.FloatArray) -> si.ComplexArray:
    """The admittance (S, (points,)) of a passive body at rising frequencies (Hz) by its size (S).

    The phase is π/2 + (1/π) ∫ (dg/du) ln coth |u/2| du with g = ln(size/f) over u = ln f (Bode
    1945, Network Analysis and Feedback Amplifier Design, section 14.3). Beyond the sweep g is that
    of one resonance, at the largest size, with a parallel one at the least. As good as a start of a
    fit: it may be off by some degrees.
    """
    away = np.geomspace(1e-5, 0.9, _BEYOND)
    below, above = frequency[0] * (1 - away[::-1]), frequency[-1] / (1 - away)
    own, parallel = (frequency[int(at)] ** 2 * _LOSSY for at in (size.argmax(), size.argmin()))
    middle, rise = [], []
    for f, g in (
        (below, np.log(np.abs((parallel - below**2) / (own - below**2)))),
        (frequency, np.log(size / frequency)),
        (above, np.log(np.abs((parallel - above**2) / (own - above**2)))),
    ):
        middle.append(np.log(f[1:] * f[:-1]) / 2)
        rise.append(np.diff(g))
    places, rises = np.concatenate(middle), np.concatenate(rise) / np.pi
    turned = [-np.log(np.tanh(np.abs(places - u) / 2)) @ rises for u in np.log(frequency)]
    return np.asarray(size * np.exp(1j * np.clip(np.pi / 2 + np.array(turned), -1.55, 1.55)))


_HZ = si.Unit("Hz")


def fixture_description(description: Description) -> Description:
    """The description of a device's sweep as that of its fixture alone.

    Raises `ConfigError` where the leads are to be fitted as well.
    """
    said = cast(DescribedImpedance, description.said)
    if said.compensated is False:
        raise description.error(
            "compensated = false and files of an open or shorted fixture exclude each other; "
            "leave one of them out",
            ["compensated"],
        )
    alone = dataclasses.replace(said, bar=None, disc=None, band=None, points=None)
    return dataclasses.replace(description, said=alone)


def without_fixture(
    device: Recording, fixtures: Mapping[str, Recording], description: Description
) -> ImpedanceSweep:
    """A sweep of the device alone; `fixtures` are "open", "short" or both.

    What lies in series with the device is told by the shorted fixture, what lies across it by the
    open one. Both are taken between their points by straight lines, and without their noise, which
    averages should make small. Raises `ConfigError` where a fixture was not swept as far, and
    where it is as the device.
    """
    sweep = cast(ImpedanceSweep, device)

    def impedance(key: str) -> si.ComplexArray:
        fixture = cast(ImpedanceSweep, fixtures[key])
        low, high = fixture.frequency[[0, -1]].tolist()
        if not low <= sweep.frequency[0] <= sweep.frequency[-1] <= high:
            ends = f"{si.format_quantity(low, _HZ)} to {si.format_quantity(high, _HZ)}"
            raise description.error(
                f"the file goes from {ends}, and the device was swept beyond; sweep the fixture "
                "over the same frequencies",
                [key],
            )
        admittance = np.interp(sweep.frequency, fixture.frequency, fixture.admittance)
        return np.asarray(1 / admittance, dtype=complex)

    in_series = impedance("short") if "short" in fixtures else 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        across = 1 / (impedance("open") - in_series) if "open" in fixtures else 0.0
        admittance = 1 / (1 / sweep.admittance - in_series) - across
    if not np.all(np.isfinite(admittance)):
        raise description.error(
            "the fixture measures as the device does, so that nothing of it is left; name sweeps "
            "of the fixture alone",
            [next(iter(fixtures))],
        )
    return dataclasses.replace(sweep, admittance=admittance, compensated=True)
