"""The mode shape as a surface in space, its nodal lines drawn on it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from squeezefilm.core.kit import style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.core.quantities import FloatArray
    from squeezefilm.design.plate.command import PlateAnalysis

_DRAWN_HEIGHT = 0.16  # peak to peak, of the plate's length
_POINTS = (249, 99)


def driven_shape(result: PlateAnalysis, x: FloatArray, y: FloatArray) -> FloatArray:
    """w per volt (m/V) over the upper face at resonance, at the instant when its largest point
    stands highest; shape (x, y)."""
    w = result.response.motion(result.resonance, x, y)
    phase = w.flat[int(np.argmax(np.abs(w)))]
    return np.asarray((w * np.conj(phase) / np.abs(phase)).real)


@style.drawn
def mode_surface(result: PlateAnalysis) -> Figure:
    """The driven shape at resonance as a surface, heights exaggerated by a factor that is said."""
    from contourpy import LineType, contour_generator

    plate, volts = result.plate, result.display.drive.voltage
    x, y = np.linspace(0, plate.length, _POINTS[0]), np.linspace(0, plate.width, _POINTS[1])
    w = 1e9 * driven_shape(result, x, y)
    reach = float(np.max(np.abs(w)))
    lines: Any = contour_generator(x, y, w.T, line_type=LineType.Separate).lines(0.0)
    exaggeration = _DRAWN_HEIGHT * plate.length / (2 * reach * 1e-9 * (volts or 1.0))
    factor = f"{float(f'{exaggeration:.2g}'):,.0f}".replace(",", " ")
    figure = style.new_figure(
        f"Mode {result.working.label} at {result.working.frequency / 1e3:.2f} kHz: up to "
        f"{reach:.3g} nm per volt",
        f"{result.modes.model}, all electrodes driven at resonance; heights drawn {factor} times "
        f"those at {volts or 1:g} V, length and width to scale; nodal lines in black",
        5.4,
    )
    # Placed by hand: the layout engine does not know how far a box in space reaches, and warns of a
    # figure that leaves it nothing to do.
    figure.set_layout_engine("none")
    axes: Any = figure.add_axes((-0.02, 0.08, 0.88, 0.9), projection="3d", computed_zorder=False)
    X, Y = np.meshgrid(1e3 * x, 1e3 * y, indexing="ij")
    surface = axes.plot_surface(
        X,
        Y,
        w,
        cmap="RdBu_r",
        vmin=-reach,
        vmax=reach,
        rcount=x.size,
        ccount=y.size,
        linewidth=0,
        antialiased=False,
        zorder=1,
        clip_on=False,
    )
    hidden = _Hidden(x, y, w, (plate.length, plate.width, _DRAWN_HEIGHT * plate.length), reach)
    for line in lines:
        seen = np.array([not hidden(a, b) for a, b in line])
        a, b = 1e3 * np.where(seen, line[:, 0], np.nan), 1e3 * np.where(seen, line[:, 1], np.nan)
        axes.plot(a, b, np.zeros(a.size), color=style.INK, lw=1.5, zorder=2, clip_on=False)
    axes.set_box_aspect((plate.length, plate.width, _DRAWN_HEIGHT * plate.length), zoom=1.22)
    axes.view_init(elev=_ELEVATION, azim=_AZIMUTH)
    axes.set(xlim=(0, 1e3 * plate.length), ylim=(0, 1e3 * plate.width), zlim=(-reach, reach))
    axes.set_xlabel("x (mm)", labelpad=10)
    axes.set_ylabel("y (mm)", labelpad=6)
    axes.set_zlabel("w (nm/V)", labelpad=4)
    axes.locator_params(axis="z", nbins=3)
    for axis in (axes.xaxis, axes.yaxis, axes.zaxis):
        axis.set_pane_color(style.PAPER)
    bar = figure.add_axes((0.89, 0.24, 0.016, 0.52))
    figure.colorbar(surface, cax=bar, label="w per volt (nm/V)")
    return figure


_ELEVATION, _AZIMUTH = 38.0, -62.0


class _Hidden:
    """Whether the surface stands between a point of a nodal line and the eye."""

    def __init__(
        self,
        x: FloatArray,
        y: FloatArray,
        w: FloatArray,
        box: tuple[float, float, float],
        reach: float,
    ) -> None:
        from scipy.interpolate import RegularGridInterpolator

        self._height = RegularGridInterpolator(
            (x, y), w * box[2] / (2 * reach), bounds_error=False, fill_value=-np.inf
        )
        up, turn = np.radians(_ELEVATION), np.radians(_AZIMUTH)
        # Along the ground, per height that is gained: the sight line is taken as parallel.
        self._step = np.array([np.cos(turn), np.sin(turn)]) / np.tan(up)
        self._rises = np.linspace(0.02, 1.0, 50) * box[2] / 2

    def __call__(self, x: float, y: float) -> bool:
        points = np.array([x, y]) + self._rises[:, None] * self._step
        return bool(np.any(self._height(points) > self._rises * 1.02))
