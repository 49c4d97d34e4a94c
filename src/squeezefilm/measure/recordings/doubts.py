"""Doubts about a recording, a sentence each: nothing here is corrected, and nothing refused."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.recordings.quantities_read import quantity

_HZ, _N = si.Unit("Hz"), si.Unit("N")
_FEW = 20
_USUAL_FREQUENCIES = (1e3, 1e7)
_USUAL_IMPEDANCES = (1e-2, 1e8)
_LEAST_RUN, _TIMES_NEXT = 8, 3
_HUMS = (50.0, 60.0)
# Of a record of length T, a line is 4/T wide under the window: beside it, what is no hum is found.
_WIDTHS, _PERIODS = 4.0, 8.0
_HUM_SHARE, _HUM_TIMES = 0.02, 5.0
_LARGEST_FRICTION = 5.0
_NEAR_A_PEAK = 0.3


def doubts_of(recording: kinds.Recording) -> tuple[str, ...]:
    """The doubts about a recording, in an order that puts what changes its meaning first."""
    look = _OF_KIND.get(type(recording))
    return () if look is None else tuple(look(recording))


def _impedance(sweep: kinds.ImpedanceSweep) -> Iterator[str]:
    y, f = sweep.admittance, sweep.frequency
    if not sweep.phase_recorded:
        yield (
            "no phase was recorded: a circuit is fitted to sizes alone, which tell less of losses; "
            "its intervals are wider"
        )
    # Weighted by nothing: a phase that is off is off at every point, also away from resonance.
    dissipative, capacitive = np.mean(np.cos(np.angle(y))), np.mean(np.sin(np.angle(y)))
    degrees = np.degrees(np.angle(1 / y[0]))
    if dissipative < 0:
        yield (
            f"the conductance is negative at {si.percent(float(np.mean(y.real < 0)))} of the "
            f"points (the impedance's phase begins at {degrees:+.0f} deg): a part that takes power "
            "cannot do that, and a phase that is off by 180 deg looks so. It is left as it is; "
            'write correct = "phase 180 deg" into the description to turn it'
        )
    elif capacitive < 0 and np.angle(y[0]) < -np.pi / 4 and np.angle(y[-1]) < -np.pi / 4:
        yield (
            f"the impedance's phase begins at {degrees:+.0f} deg and ends positive too, as a "
            "coil's does and no capacitor's: the sign of the phase may be the other one. It is "
            "left as it is; "
            'write correct = "phase sign" into the description to turn it'
        )
    elif np.any(y.real < 0):
        yield (
            f"the conductance is negative at {np.count_nonzero(y.real < 0)} of {y.size} points, "
            "which a part that takes power cannot be: noise, or a compensation of the analyser "
            "that is off"
        )
    middle = float(np.median(1 / np.abs(y)))
    if not _USUAL_IMPEDANCES[0] < middle < _USUAL_IMPEDANCES[1]:
        yield f"impedances of {middle:.3g} ohm are unusual: is the unit right?"
    yield from _frequencies(f)


def _frequencies(f: si.HertzArray) -> Iterator[str]:
    if f.size < _FEW:
        yield f"{f.size} points are few for a resonance; sweep more finely"
    if not _USUAL_FREQUENCIES[0] < f[-1] < _USUAL_FREQUENCIES[1]:
        yield (
            f"frequencies up to {quantity(f[-1], _HZ)} are unusual for an ultrasonic plate: is the "
            "unit Hz, kHz or MHz?"
        )
    steps = np.diff(f)
    ratios = np.diff(np.log(f))
    spread = min(np.max(apart) / max(np.median(apart), 1e-300) for apart in (steps, ratios))
    if spread > 1.9 and f.size >= _FEW:
        at = int(np.argmax(steps / np.median(steps)))
        yield (
            f"points are missing between {quantity(f[at], _HZ)} and {quantity(f[at + 1], _HZ)}, or "
            "the step changes there"
        )


def _response(response: kinds.FrequencyResponse) -> Iterator[str]:
    yield from _frequencies(response.frequency)
    h = response.displacement_per_volt
    near = np.abs(h) > _NEAR_A_PEAK * np.max(np.abs(h))
    turned = np.angle(h[1:] * np.conj(h[:-1]))[near[1:] & near[:-1]]
    if np.sum(turned) > np.pi / 4:
        yield (
            f"the phase rises by {np.degrees(np.sum(turned)):.0f} deg through the resonance, and "
            "that of a displacement after its drive falls there: the sign of the phase may be the "
            "other "
            'one. It is left as it is; write correct = "phase sign" into the description to turn it'
        )
    if response.coherence is not None and np.median(response.coherence) < 0.9:
        yield (
            f"the coherence is {float(np.median(response.coherence)):.2f} in the middle of the "
            "points: noise, or something besides the drive moves the plate"
        )


def _sweeps(sweeps: kinds.VoltageSweeps) -> Iterator[str]:
    for number, sweep in enumerate(sweeps.sweeps, 1):
        for doubt in _response(sweep):
            yield f"sweep {number}: {doubt}"
    if len({sweep.voltage for sweep in sweeps.sweeps}) < 2:
        yield "all sweeps are at one voltage: nothing can be told of how the plate depends on it"


def _line(scan: kinds.LineScan) -> Iterator[str]:
    if scan.position.size < _FEW:
        yield f"{scan.position.size} places are few for half wavelengths; scan more finely"
    if not np.iscomplexobj(scan.displacement) or np.all(scan.displacement.imag == 0):
        signed = np.any(scan.displacement.real < 0)
        yield "no phase was recorded" + (
            ": a travelling part cannot be told from the standing one"
            if signed
            else ", and all values are positive: neighbouring antinodes look alike"
        )


def _grid(scan: kinds.GridScan) -> Iterator[str]:
    if np.all(scan.displacement.imag == 0) and not np.any(scan.displacement.real < 0):
        yield (
            "no phase was recorded, and all values are positive: a mode is compared with the sizes "
            "of its displacements alone"
        )


def _ring_down(ring: kinds.RingDown) -> Iterator[str]:
    yield from _of_signal("displacement", ring.time, ring.displacement)
    x = np.abs(ring.displacement - np.mean(ring.displacement))
    half = x.size // 2
    first, second = (float(np.sqrt(np.mean(part**2))) for part in (x[:half], x[half:]))
    if second > 0.9 * first:
        yield (
            "the second half is as large as the first: the drive was not off, or the record is too "
            "short for its decay"
        )
    steps = np.diff(ring.time)
    if np.max(steps) > 1.5 * np.median(steps):
        at = int(np.argmax(steps))
        yield f"samples are missing after {quantity(ring.time[at], si.Unit('s'))}"


def _signals(signals: kinds.RawSignals) -> Iterator[str]:
    yield from _of_signal("voltage", signals.time, signals.voltage)
    yield from _of_signal("displacement", signals.time, signals.displacement)


def _of_signal(name: str, time: si.SecondArray, x: si.FloatArray) -> Iterator[str]:
    """Clipping, hum, an offset, and too slow a sampling of what vibrates."""
    yield from _clipped(name, time, x)
    yield from _hum(name, time, x)
    swing = x - np.mean(x)
    size = float(np.sqrt(np.mean(swing**2)))
    if size == 0:
        yield f"the {name} does not change at all"
        return
    if abs(np.mean(x)) > 0.5 * size:
        yield f"the {name} has an offset of {abs(np.mean(x)) / size:.1f} times its r.m.s. value"
    step = float(np.median(np.diff(time)))
    lines = np.abs(np.fft.rfft(swing * np.hanning(x.size)))
    strongest = float(np.argmax(lines)) / (x.size * step)
    if strongest > 0.2 / step:
        yield (
            f"the {name} has its strongest line at {quantity(strongest, _HZ)}, with "
            f"{1 / step / strongest:.1f} samples a period: lines above half the rate may appear "
            "here"
        )


def _clipped(name: str, time: si.SecondArray, x: si.FloatArray) -> Iterator[str]:
    """A converter at its end gives one value again and again, and its neighbour seldom."""
    for end, sign in (("largest", 1.0), ("smallest", -1.0)):
        values, counts = np.unique(sign * x, return_counts=True)
        if values.size < 4 or counts[-1] < max(_LEAST_RUN, _TIMES_NEXT * counts[-2]):
            continue
        at = np.flatnonzero(sign * x == values[-1])
        yield (
            f"the {name} is at its {end} value in {counts[-1]} samples, first at "
            f"{quantity(time[at[0]], si.Unit('s'))}, as where a converter is at its end: "
            "amplitudes are too small there; record with a larger range"
        )


def _hum(name: str, time: si.SecondArray, x: si.FloatArray) -> Iterator[str]:
    """Mains hum, where a record is long enough to tell it from its neighbours."""
    length = float(time[-1] - time[0])
    reach = float(np.max(np.abs(x - np.mean(x))))
    for mains in _HUMS:
        if length * mains < _PERIODS or reach == 0:
            continue
        away = max(_WIDTHS / length, 0.15 * mains)
        here = _sine(time, x, mains)
        beside = max(_sine(time, x, mains + side * away) for side in (-1.5, -1, 1, 1.5))
        if here > _HUM_SHARE * reach and here > _HUM_TIMES * beside:
            yield (
                f"the {name} holds {mains:.0f} Hz of {si.percent(here / reach)} of its largest "
                "swing, as mains hum is; mend the grounding, or filter before recording"
            )


def _sine(time: si.SecondArray, x: si.FloatArray, frequency: float) -> float:
    """The amplitude of one frequency in a signal, by least squares under a window."""
    window = np.hanning(x.size)
    turn = np.exp(-2j * np.pi * frequency * (time - time[0]))
    return float(
        2 * np.abs(np.sum(window * (x - np.average(x, weights=window)) * turn)) / np.sum(window)
    )


def _bench(bench: kinds.FrictionBench) -> Iterator[str]:
    normal, tangential = bench.normal_force, bench.tangential_force
    if np.median(normal) < 0:
        yield (
            "the normal force is negative most of the time: here pressing counts as positive; give "
            "its column a scale of -1 or its other sign"
        )
    ratio = float(np.median(np.abs(tangential)) / max(np.median(np.abs(normal)), 1e-12))
    if ratio > _LARGEST_FRICTION:
        yield (
            f"the tangential force is {ratio:.1f} times the normal force in the middle: are the "
            "two columns swapped?"
        )
    for name, force in (("normal force", normal), ("tangential force", tangential)):
        yield from _clipped(name, bench.time, force)
        yield from _hum(name, bench.time, force)
    if np.ptp(bench.position) == 0:
        yield "the position does not change: nothing slides"


def _curve(curve: kinds.FrictionCurve) -> Iterator[str]:
    friction = curve.friction
    if np.min(friction) < 0:
        yield f"the friction goes down to {np.min(friction):.3g}, below zero"
    if curve.quantity == "relative_friction":
        if np.max(friction) > 1.5:
            yield (
                f"µ′/µ goes up to {np.max(friction):.3g}: it is friction over that without "
                'vibration, so that 1 is usual where nothing vibrates (is the unit "%"?)'
            )
        still = curve.vibration_amplitude == 0
        if np.any(still) and abs(float(np.mean(friction[still])) - 1) > 0.1:
            yield (
                f"µ′/µ is {float(np.mean(friction[still])):.2f} where nothing vibrates, and 1 by "
                "its meaning"
            )
    if curve.deviation is None or np.all(curve.deviation == 0):
        yield "no spread is given: how sure each point is stays unknown"
    for name in ("normal_force", "speed"):
        if getattr(curve, name) is None:
            yield f"the {name.replace('_', ' ')} is not told: the display's own is taken"
    if not curve.display:
        yield (
            'no display is named: write display = "…" (a preset or a TOML file) to compare it with '
            "the "
            "models"
        )


_OF_KIND: dict[type, Callable[[Any], Iterator[str]]] = {
    kinds.ImpedanceSweep: _impedance,
    kinds.FrequencyResponse: _response,
    kinds.LineScan: _line,
    kinds.GridScan: _grid,
    kinds.RingDown: _ring_down,
    kinds.VoltageSweeps: _sweeps,
    kinds.RawSignals: _signals,
    kinds.FrictionBench: _bench,
    kinds.FrictionCurve: _curve,
}
