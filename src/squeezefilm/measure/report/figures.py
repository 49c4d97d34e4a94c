"""Recordings as they were read, one picture a kind, before anything is fitted."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import HZ, V, shown
from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.recordings.read import RecordingCheck

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_AS_RECORDED = "none; as recorded, in SI units and zero-to-peak amplitudes"
# More points than this are drawn as their least and largest value in each stretch.
_MOST_POINTS = 6000
_POINTS: dict[str, Any] = {"color": style.BLUE, "marker": ".", "ms": 4, "lw": 0.8}


@style.drawn
def recording_figure(check: RecordingCheck) -> Figure:
    """The picture of a recording: what was recorded against what it was recorded over."""
    recording = check.recording
    title, draw = _OF_KIND[type(recording)]
    name = style.plain(recording.told.name, 60)
    doubts = len(check.doubts)
    said = "nothing doubtful" if not doubts else f"{doubts} doubt{'s' if doubts > 1 else ''}"
    figure = style.new_figure(f"{name}: {title}, {check.points} points, {said}", _AS_RECORDED, 5.2)
    draw(figure, recording)
    return figure


def _two(figure: Figure, labels: tuple[str, str, str]) -> tuple[Axes, Axes]:
    """Two axes, one above the other, over one abscissa."""
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.set_ylabel(labels[0])
    lower.set(ylabel=labels[1], xlabel=labels[2])
    return upper, lower


def _impedance(figure: Figure, sweep: kinds.ImpedanceSweep) -> None:
    phase = "phase of Z (deg)" if sweep.phase_recorded else "phase that goes with |Z| (deg)"
    upper, lower = _two(figure, ("|Z| (ohm)", phase, "frequency (kHz)"))
    z, f = 1 / sweep.admittance, sweep.frequency / 1e3
    upper.semilogy(f, np.abs(z), **_POINTS)
    lower.plot(f, np.degrees(np.unwrap(np.angle(z))), **_POINTS)


def _response(figure: Figure, response: kinds.FrequencyResponse) -> None:
    upper, lower = _two(figure, ("amplitude (nm/V)", "phase (deg)", "frequency (kHz)"))
    h, f = response.displacement_per_volt, response.frequency / 1e3
    upper.plot(f, 1e9 * np.abs(h), **_POINTS)
    lower.plot(f, np.degrees(np.unwrap(np.angle(h))), **_POINTS)


def _sweeps(figure: Figure, sweeps: kinds.VoltageSweeps) -> None:
    axes = figure.subplots()
    axes.set(xlabel="frequency (kHz)", ylabel="amplitude (µm)")
    several = zip(sweeps.sweeps, sweeps.directions, strict=True)
    for number, (sweep, way) in enumerate(several):
        volts = sweep.voltage or 1.0
        color, dashes = style.LINES[number % len(style.LINES)]
        label = f"{shown(volts, V)} {way}"
        amplitude = 1e6 * volts * np.abs(sweep.displacement_per_volt)
        axes.plot(sweep.frequency / 1e3, amplitude, color=color, ls=dashes, label=label)
    style.legend_beside(axes)


def _line(figure: Figure, scan: kinds.LineScan) -> None:
    axes = figure.subplots()
    place, w = 1e3 * scan.position, 1e6 * scan.displacement
    axes.set(xlabel="position (mm)", ylabel=f"displacement at {shown(scan.frequency, HZ)} (µm)")
    axes.plot(place, np.real(w), **_POINTS, label="in phase")
    if np.any(np.imag(w)):
        look = _POINTS | {"color": style.ORANGE, "ls": style.LINES[1][1]}
        axes.plot(place, np.imag(w), **look, label="in quadrature")
        style.legend_beside(axes)
    axes.axhline(0, **style.ZERO)


def _grid(figure: Figure, scan: kinds.GridScan) -> None:
    axes = figure.subplots()
    # At the moment at which most is to be seen.
    moment = np.exp(-0.5j * np.angle(np.sum(scan.displacement**2)))
    w = 1e6 * np.real(moment * scan.displacement)
    reach = float(np.max(np.abs(w))) or 1.0
    label = f"displacement at {shown(scan.frequency, HZ)} (µm)"
    scattered(axes, (scan.x, scan.y), w, reach, label)


def scattered(
    axes: Axes,
    places: tuple[si.MetreArray, si.MetreArray],
    w: si.FloatArray,
    reach: float,
    label: str,
) -> None:
    """Values at places (x, y in m) as dots in two colours, up to `reach`."""
    look: dict[str, Any] = {"cmap": "RdBu_r", "vmin": -reach, "vmax": reach, "s": 28}
    edges: dict[str, Any] = {"edgecolors": style.MUTED, "linewidths": 0.3}
    dots = axes.scatter(1e3 * places[0], 1e3 * places[1], c=w, **look, **edges)
    axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
    axes.figure.colorbar(dots, ax=axes, label=label)


def _ring_down(figure: Figure, ring: kinds.RingDown) -> None:
    upper, lower = figure.subplots(2, 1)
    name, unit, scale = "displacement", "µm", 1e6
    if ring.unit != "m":
        name, unit, scale = "signal", ring.unit, 1.0
    _signal(upper, ring.time, scale * ring.displacement)
    few = slice(0, min(200, ring.time.size))
    lower.plot(1e3 * ring.time[few], scale * ring.displacement[few], **_POINTS)
    upper.set(ylabel=f"{name} ({unit})", xlabel="time (ms)")
    lower.set(ylabel=f"its beginning ({unit})", xlabel="time (ms)")


def _signals(figure: Figure, signals: kinds.RawSignals) -> None:
    upper, lower = _two(figure, ("voltage (V)", "displacement (µm)", "time (ms)"))
    _signal(upper, signals.time, signals.voltage)
    _signal(lower, signals.time, 1e6 * signals.displacement)


def _bench(figure: Figure, bench: kinds.FrictionBench) -> None:
    rows = figure.subplots(3, 1, sharex=True)
    for axes, label in zip(rows, ("force (N)", "position (mm)", "amplitude (µm)"), strict=True):
        axes.set_ylabel(label)
    rows[0].plot(bench.time, bench.normal_force, color=style.BLUE, lw=1, label="normal")
    rows[0].plot(bench.time, bench.tangential_force, **style.WANTED, label="tangential")
    style.legend_beside(rows[0])
    rows[1].plot(bench.time, 1e3 * bench.position, color=style.BLUE, lw=1)
    rows[2].plot(bench.time, 1e6 * bench.vibration_amplitude, color=style.BLUE, lw=1)
    rows[2].set_xlabel("time (s)")


FRICTION_WORDS: Mapping[str, str] = {
    "friction_force": "friction force (N)",
    "friction_coefficient": "coefficient of friction",
    "relative_friction": "µ′/µ",
}
"""Words of an axis for what a friction curve holds."""


def measured_points(axes: Axes, curve: kinds.FrictionCurve) -> None:
    """The points of a measured friction curve, with one standard deviation where that is known."""
    deviation = curve.deviation
    label = "measured" if deviation is None else "measured, ± one deviation"
    axes.errorbar(
        1e6 * curve.vibration_amplitude,
        curve.friction,
        yerr=deviation,
        fmt="o",
        color=style.INK,
        ecolor=style.MUTED,
        ms=5,
        zorder=4,
        label=label,
    )
    top = 1.1 * float(np.max(curve.friction + (0.0 if deviation is None else deviation)))
    style.friction_axes(axes, top=top)
    axes.set_ylabel(FRICTION_WORDS[curve.quantity])


def _scatter(figure: Figure, x: si.FloatArray, y: si.FloatArray, words: tuple[str, str]) -> None:
    axes = figure.subplots()
    axes.plot(x, y, "o", color=style.INK, ms=4)
    axes.set(xlabel=words[0], ylabel=words[1], xlim=(0, None), ylim=(0, None))


def _detection(figure: Figure, measured: kinds.DetectionThresholds) -> None:
    words = ("spatial period (mm)", "amplitude of the friction coefficient detected")
    _scatter(figure, 1e3 * measured.period, measured.amplitude, words)
    figure.axes[0].set(xscale="log", yscale="log")
    # Zero, where the others begin, lies on no such scale.
    figure.axes[0].autoscale()


def _signal(axes: Axes, time: si.SecondArray, values: si.FloatArray) -> None:
    """A signal against milliseconds; of very many samples what they span in each stretch."""
    if values.size <= _MOST_POINTS:
        axes.plot(1e3 * time, values, color=style.BLUE, lw=0.8)
        return
    parts = _MOST_POINTS // 4
    cut = values[: values.size // parts * parts].reshape(parts, -1)
    at = 1e3 * np.linspace(time[0], time[-1], parts)
    axes.fill_between(at, cut.min(axis=1), cut.max(axis=1), color=style.BLUE, lw=0.4)


_OF_KIND: Mapping[type, tuple[str, Callable[[Figure, Any], None]]] = {
    kinds.ImpedanceSweep: ("an impedance", _impedance),
    kinds.FrequencyResponse: ("a frequency response", _response),
    kinds.VoltageSweeps: ("sweeps at several voltages", _sweeps),
    kinds.LineScan: ("a line scan", _line),
    kinds.GridScan: ("a grid scan", _grid),
    kinds.RingDown: ("a ring-down", _ring_down),
    kinds.RawSignals: ("raw signals", _signals),
    kinds.FrictionBench: ("a friction bench", _bench),
    kinds.FrictionCurve: (
        "a friction curve",
        lambda figure, curve: measured_points(figure.subplots(), curve),
    ),
    kinds.FrictionDecays: (
        "published fits of friction",
        lambda figure, decays: _scatter(
            figure,
            1e6 * decays.decay_amplitude,
            decays.friction_coefficient,
            ("τ (µm): µ = µ0 exp(−a²/2τ²)", "coefficient of friction at rest µ0"),
        ),
    ),
    kinds.FingertipImpedances: (
        "impedances of fingertips",
        lambda figure, touches: _scatter(
            figure, touches.damping, 1e3 * touches.mass, ("damping (N s/m)", "moving mass (g)")
        ),
    ),
    kinds.DetectionThresholds: ("detection thresholds", _detection),
}
