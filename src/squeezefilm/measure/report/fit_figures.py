"""Figures of what was fitted beside what was recorded, and of what is left."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import HZ, SPEED, N, shown
from squeezefilm.measure.fits.estimate import FitResult
from squeezefilm.measure.fits.friction.friction_curve import CurveComparison
from squeezefilm.measure.recordings import kinds
from squeezefilm.measure.recordings.read import RecordingCheck
from squeezefilm.measure.report.figures import measured_points, scattered

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Modelled(NamedTuple):
    """Recorded and computed values over one abscissa, in the units that their labels say;
    `relative` where they span decades, so that what is left is shown over what was recorded."""

    x: si.FloatArray
    data: si.Array
    model: si.Array
    x_label: str
    y_label: str
    relative: bool = False


# By the name of a fit's abscissa: what it and the fit's `model` and `residual` are shown in.
_OVER = {
    "frequency": ("frequency (kHz)", 1e-3, "amplitude (nm/V)", 1e9),
    "position": ("position (mm)", 1e3, "displacement (µm)", 1e6),
    "time": ("time (ms)", 1e3, "displacement (µm)", 1e6),
    "sweeps": ("frequency (kHz)", 1e-3, "displacement (µm)", 1e6),
}


def fit_figure(check: RecordingCheck, fit: FitResult) -> Figure | None:
    """Data, model and residual of a fit; None for a fit that has nothing to draw."""
    if isinstance(fit, CurveComparison):
        return comparison_figure(fit)
    name = style.plain(check.recording.told.name, 60)
    word = "an adequate fit" if fit.adequacy.adequate else "the fit is NOT adequate"
    title = f"{name}: {word}"
    own = _OWN.get(type(check.recording))
    if own is not None:
        return own(title, check.recording, fit)
    compared = modelled(check, fit)
    return None if compared is None else _over_abscissa(title, compared, fit)


def modelled(check: RecordingCheck, fit: FitResult) -> Modelled | None:
    """Model of a fit at the recording's points, over one abscissa; None where it has no such.

    A fit has either `admittance`, a function of frequency, or arrays `model` and `residual` over a
    `frequency`, `position` or `time` of its own; that of several sweeps over theirs in a row.
    """
    recording, told = check.recording, cast(Any, fit)
    if isinstance(recording, kinds.ImpedanceSweep) and hasattr(told, "admittance"):
        return _admittances(recording, told.admittance(recording.frequency))
    if isinstance(recording, kinds.ImpedanceSweep) and recording.body is not None:
        return _admittances(recording, told.model)
    model, residual = getattr(told, "model", None), getattr(told, "residual", None)
    if not isinstance(model, np.ndarray) or not isinstance(residual, np.ndarray):
        return None
    abscissas = {name: getattr(told, name, None) for name in _OVER}
    if isinstance(recording, kinds.VoltageSweeps):
        abscissas = {"sweeps": np.concatenate([sweep.frequency for sweep in recording.sweeps])}
    for name, x in abscissas.items():
        x_label, x_scale, y_label, scale = _OVER[name]
        if isinstance(x, np.ndarray) and x.shape == model.shape:
            data = scale * (model + residual)
            return Modelled(x_scale * x, data, scale * model, x_label, y_label)
    return None


def _admittances(sweep: kinds.ImpedanceSweep, model: si.ComplexArray) -> Modelled:
    labels = ("frequency (kHz)", "|Y| (mS)")
    data, fitted = (1e3 * sweep.as_recorded(y) for y in (sweep.admittance, model))
    return Modelled(sweep.frequency / 1e3, data, fitted, *labels, relative=True)


@style.drawn
def _over_abscissa(title: str, compared: Modelled, fit: FitResult) -> Figure:
    figure = style.new_figure(title, fit.adequacy.sentence, 6.0)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    signed = not np.iscomplexobj(compared.data) or not np.any(np.imag(compared.data))
    data, model = (
        np.real(part) if signed else np.abs(part) for part in (compared.data, compared.model)
    )
    upper.plot(compared.x, data, ".", color=style.BLUE, ms=4, label="recorded")
    # Points of several sweeps do not follow one another.
    line = style.WANTED if np.all(np.diff(compared.x) > 0) else {"color": style.ORANGE, "ls": ""}
    upper.plot(compared.x, model, **line, marker="" if line["ls"] else "_", label="fitted")
    upper.set_ylabel(compared.y_label)
    style.legend_beside(upper)
    left = compared.data - compared.model
    left = np.real(left) if signed else np.abs(left)
    label = "residual" if signed else "|residual|"
    if compared.relative:
        upper.set_yscale("log")
        left, label = 100 * left / np.abs(compared.data), f"{label} (%)"
    lower.plot(compared.x, left, ".", color=style.PURPLE, ms=4)
    lower.axhline(0, **style.ZERO)
    lower.set(xlabel=compared.x_label, ylabel=label)
    return figure


@style.drawn
def _grid(title: str, scan: kinds.GridScan, fit: Any) -> Figure:
    """A scan, and what its shapes leave of it, in the same colours."""
    figure = style.new_figure(f"{title}, most like {fit.label}", fit.adequacy.sentence, 6.0)
    upper, lower = figure.subplots(2, 1, sharex=True)
    known = np.isfinite(scan.displacement)
    reach = 1e6 * float(np.max(np.abs(scan.displacement[known])))
    places = (scan.x[known], scan.y[known])
    turn = np.exp(-0.5j * np.angle(np.sum(scan.displacement[known] ** 2)))
    scattered(upper, places, 1e6 * np.real(turn * scan.displacement[known]), reach, "recorded (µm)")
    scattered(lower, places, 1e6 * np.real(turn * fit.residual), reach, "left (µm)")
    upper.set_xlabel("")
    return figure


@style.drawn
def _raw(title: str, _: kinds.RawSignals, fit: Any) -> Figure:
    """The response between two signals with its standard error, and its coherence."""
    figure = style.new_figure(title, fit.adequacy.sentence, 5.6)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    f, h = fit.response.frequency / 1e3, 1e9 * np.abs(fit.response.displacement_per_volt)
    error = 1e9 * np.asarray(fit.standard_error)
    upper.fill_between(f, h - error, h + error, color=style.BAND, label="± one standard error")
    upper.plot(f, h, color=style.BLUE, lw=1, label="H1")
    upper.set_ylabel("amplitude (nm/V)")
    style.legend_beside(upper)
    if fit.response.coherence is not None:
        lower.plot(f, fit.response.coherence, color=style.PURPLE, lw=1)
    lower.set(xlabel="frequency (kHz)", ylabel="coherence", ylim=(0, 1.05))
    return figure


@style.drawn
def _bench(title: str, _: kinds.FrictionBench, fit: Any) -> Figure:
    """µ at each amplitude with its interval."""
    figure, axes = style.new_axes(title, fit.adequacy.sentence, 4.6)
    for amplitude, estimate in zip(fit.amplitudes, fit.coefficients, strict=True):
        style.estimate(axes, 1e6 * amplitude, estimate.value, *estimate.interval)
    axes.set_ylim(0, None)
    axes.set(xlabel="vibration amplitude, zero-to-peak (µm)", ylabel="friction coefficient µ")
    return figure


_OWN: dict[type, Callable[[str, Any, Any], Figure]] = {
    kinds.GridScan: _grid,
    kinds.RawSignals: _raw,
    kinds.FrictionBench: _bench,
}


def conditions(compared: CurveComparison) -> str:
    """Words for the display on which a curve was measured, and how."""
    c = compared.curve
    words = [
        compared.display,
        _spanned(c.frequency, HZ),
        _spanned(compared.normal_force, N) + _assumed(compared, "normal_force"),
        f"finger at {_spanned(compared.speed, SPEED)}" + _assumed(compared, "speed"),
    ]
    return ", ".join(words)


def _assumed(compared: CurveComparison, name: str) -> str:
    return " (assumed)" if name in compared.assumed else ""


def _spanned(values: si.FloatLike, unit: si.Unit) -> str:
    low, high = shown(float(np.min(values)), unit), shown(float(np.max(values)), unit)
    return low if low == high else f"{low} to {high}"


@style.drawn
def comparison_figure(compared: CurveComparison) -> Figure:
    """The measured points, our interval, and the models: the nearest, the default, all others."""
    curve, nearest = compared.curve, compared.nearest
    name = style.plain(curve.told.name, 50)
    title = f"{name}: nearest is {nearest.model}, off by {nearest.difference or np.nan:.3f}"
    figure, axes = style.new_axes(title, f"friction at rest fitted; {conditions(compared)}", 5)
    amplitude = 1e6 * curve.vibration_amplitude
    level = si.percent(compared.band.level)
    axes.fill_between(
        amplitude,
        compared.fitted_at_rest * compared.band.low,
        compared.fitted_at_rest * compared.band.high,
        color=style.BAND,
        label=f"{level} interval of the default",
    )
    strong = {compared.default.model: style.RENDERED, nearest.model: style.WANTED}
    for score in compared.models:
        look = strong.get(score.model, style.GUIDE)
        label = score.model if score.model in strong else None
        axes.plot(amplitude, score.friction, **look, label=label)
    axes.plot([], [], **style.GUIDE, label="other models and shapes")
    measured_points(axes, curve)
    style.legend_beside(axes)
    return figure
