"""The figures of a solved plate: mode shape, line scan, frequency response, admittance."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.report.style import (
    BLUE,
    INK,
    MUTED,
    ORANGE,
    drawn,
    legend_below,
    new_figure,
    plain_log,
    png,
)
from squeezefilm.results import write_whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.analysis.plate_command import PlateAnalysis


@drawn
def shape(result: PlateAnalysis) -> Figure:
    """The driven shape over the upper face with its nodal lines, and the scan along the centre."""
    from matplotlib.ticker import MaxNLocator

    from squeezefilm.analysis.plate_command import scan_axis

    plate, response, at = result.plate, result.response, result.response.resonance
    x, y = np.linspace(0, plate.length, 166), np.linspace(0, plate.width, 99)
    w = response.displacement(x, y)[at]
    # Turned to the phase of its largest point: what stands there moves along.
    phase = w.flat[int(np.argmax(np.abs(w)))]
    w = 1e9 * (w * np.conj(phase) / np.abs(phase)).real
    figure = new_figure(
        f"Mode {result.working.label} at {result.working.frequency / 1e3:.2f} kHz moves up to "
        f"{result.amplitude_per_volt * 1e9:.0f} nm per volt; along the centre up to "
        f"{result.centreline_per_volt * 1e9:.0f} nm per volt",
        f"{result.modes.model}, all electrodes driven at resonance",
        6.4,
    )
    axis = scan_axis(result.working_label)
    above, below = figure.subplots(2, 1, sharex=axis == 0, height_ratios=[1.6, 1])
    reach = float(np.max(np.abs(w)))
    levels = np.linspace(-reach, reach, 21)
    field = above.contourf(1e3 * x, 1e3 * y, w.T, levels=levels, cmap="RdBu_r")
    above.contour(1e3 * x, 1e3 * y, w.T, levels=[0.0], colors=INK, linewidths=1.2)
    ticks = MaxNLocator(nbins=6, symmetric=True)
    figure.colorbar(field, ax=above, label="per volt (nm/V)", ticks=ticks)
    above.set(ylabel="y (mm)")
    above.set_title("upper face; nodal lines in black")
    if axis == 0:
        below.plot(1e3 * x, w[:, y.size // 2], color=BLUE, label="centreline")
        below.plot(1e3 * x, w[:, 0], color=ORANGE, ls="--", label="edge")
        below.set(xlabel="x (mm)", xlim=(0, 1e3 * plate.length))
    else:
        below.plot(1e3 * y, w[x.size // 2], color=BLUE, label="across the middle")
        below.plot(1e3 * y, w[0], color=ORANGE, ls="--", label="edge x = 0")
        above.set(xlabel="x (mm)")
        below.set(xlabel="y (mm)", xlim=(0, 1e3 * plate.width))
    below.axhline(0, color=MUTED, lw=0.8)
    below.set(ylabel="per volt (nm/V)")
    legend_below(below, gap=0.3)
    return figure


@drawn
def admittance(result: PlateAnalysis) -> Figure:
    """Amplitude per volt and admittance around the working mode."""
    response = result.response
    f = response.frequencies / 1e3
    figure = new_figure(
        f"Resonance at {f[response.resonance]:.2f} kHz: "
        f"{np.abs(response.admittance[response.resonance]) * 1e3:.3g} mS",
        f"{response.method}; truncation {response.truncation_error:.1g} of the admittance",
        6.0,
    )
    above, below = figure.subplots(2, 1, sharex=True)
    above.plot(f, 1e9 * response.maximum, color=BLUE)
    above.set(ylabel="largest amplitude (nm/V)", ylim=(0, None))
    below.semilogy(f, 1e3 * np.abs(response.admittance), color=BLUE, label="|Y|")
    below.semilogy(f, 1e3 * response.admittance.real, color=ORANGE, ls="--", label="Re Y")
    plain_log(below.yaxis)
    below.set(xlabel="frequency (kHz)", ylabel="admittance (mS)")
    legend_below(below, gap=0.28)
    return figure


def write_plate(result: PlateAnalysis, folder: Path) -> Path:
    """Write plate.json, plate-shape.png and plate-response.png into `folder`; the folder."""
    data = json.dumps(result.summary(), indent=1, ensure_ascii=False, allow_nan=False)
    pictures = {
        "plate-shape.png": png(shape(result)),
        "plate-response.png": png(admittance(result)),
    }
    write_whole(folder / "plate.json", data + "\n")
    for name, picture in pictures.items():
        write_whole(folder / name, picture)
    return folder
