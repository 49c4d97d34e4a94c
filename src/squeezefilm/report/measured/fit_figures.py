"""What was fitted beside what was recorded, and what is left."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, cast

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.measure.fits.by_kind import Fit
from squeezefilm.measure.recordings.kinds import ImpedanceSweep
from squeezefilm.measure.recordings.read import RecordingCheck
from squeezefilm.report.kit import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Modelled(NamedTuple):
    """Recorded and computed values over one abscissa, in the units that their labels say."""

    x: si.FloatArray
    data: si.Array
    model: si.Array
    x_label: str
    y_label: str
    logarithmic: bool = False


# By the name of a fit's abscissa: what it and the fit's `model` and `residual` are shown in.
_OVER = {
    "frequency": ("frequency (kHz)", 1e-3, "amplitude (nm/V)", 1e9),
    "position": ("position (mm)", 1e3, "displacement (µm)", 1e6),
    "time": ("time (ms)", 1e3, "displacement (µm)", 1e6),
}


def modelled(check: RecordingCheck, fit: Fit) -> Modelled | None:
    """What a fit computed at the recording's points; None for a fit that draws itself otherwise.

    A fit has either `admittance`, a function of frequency, or arrays `model` and `residual` over a
    `frequency`, `position` or `time` of its own.
    """
    recording, told = check.recording, cast(Any, fit)
    if isinstance(recording, ImpedanceSweep) and hasattr(told, "admittance"):
        f, y = recording.frequency, recording.admittance
        labels = ("frequency (kHz)", "|Y| (mS)")
        return Modelled(f / 1e3, 1e3 * y, 1e3 * told.admittance(f), *labels, logarithmic=True)
    model, residual = getattr(told, "model", None), getattr(told, "residual", None)
    if not isinstance(model, np.ndarray) or not isinstance(residual, np.ndarray):
        return None
    for name, (x_label, x_scale, y_label, scale) in _OVER.items():
        x = getattr(told, name, None)
        if isinstance(x, np.ndarray) and x.shape == model.shape:
            return Modelled(
                x_scale * x, scale * (model + residual), scale * model, x_label, y_label
            )
    return None


def fit_figure(check: RecordingCheck, fit: Fit) -> Figure | None:
    """Data, model and residual of a fit; None where there is nothing over an abscissa."""
    found = modelled(check, fit)
    return None if found is None else _drawn((check, fit, found))


@style.drawn
def _drawn(subject: tuple[RecordingCheck, Fit, Modelled]) -> Figure:
    check, fit, found = subject
    name = style.plain(check.recording.told.name, 60)
    word = "an adequate fit" if fit.adequacy.adequate else "the fit is NOT adequate"
    figure = style.new_figure(f"{name}: {word}", fit.adequacy.sentence, 6.0)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    signed = not np.iscomplexobj(found.data) or not np.any(np.imag(found.data))
    data, model = (np.real(one) if signed else np.abs(one) for one in (found.data, found.model))
    upper.plot(found.x, data, ".", color=style.BLUE, ms=4, label="recorded")
    upper.plot(found.x, model, **style.WANTED, label="fitted")
    if found.logarithmic:
        upper.set_yscale("log")
        style.plain_log(upper.yaxis)
    upper.set_ylabel(found.y_label)
    upper.legend(loc="best")
    left = found.data - found.model
    left = np.real(left) if signed else np.abs(left)
    lower.plot(found.x, left, ".", color=style.PURPLE, ms=4)
    lower.axhline(0, **style.ZERO)
    lower.set(xlabel=found.x_label, ylabel="residual" if signed else "|residual|")
    return figure
