"""Figures of a rendered texture: friction along the way, drive and force, the map."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.kit import style
from squeezefilm.core.kit.numbers import M, N, S, V, shown
from squeezefilm.core.kit.page_style import FigureOf
from squeezefilm.physics.chain.played_texture import single_period

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.core.quantities import FloatArray
    from squeezefilm.physics.chain.rendered_texture import RenderAnalysis
    from squeezefilm.physics.texture_files.texture_file import TextureFile

_MOST_POINTS = 3000
_ZOOM = 0.16
_MAP_POINTS = 260
_SPEED = 0.06
_WIDE = 0.05
_HIGH = 0.6
_PERIODS = 12
_LABELS = {
    "relative_friction": ("relative friction µ′/µ", 1.0),
    "friction_reduction": ("friction taken away µ − µ′", 1.0),
    "amplitude": ("vibration amplitude (µm)", 1e6),
}


def _thin(count: int) -> slice:
    return slice(None, None, max(1, count // _MOST_POINTS))


@style.drawn
def friction(result: RenderAnalysis) -> Figure:
    """Friction asked for and rendered over time, whole and enlarged."""
    stroke = result.stroke
    late, lag = "", np.nan if result.fidelity is None else result.fidelity.lag
    if np.isfinite(lag):
        late = f", {shown(abs(lag), M, 2)} {'late' if lag >= 0 else 'early'}"
    figure = style.new_figure(
        f"{style.plain(result.played.name, 40)} on {style.plain(result.display.name, 24)}: "
        f"friction is rendered within {result.rms_error:.2g} RMS of µ′/µ{late}",
        f"{stroke.model}; friction by {result.prediction.model}",
        4.4,
    )
    left, right = figure.subplots(1, 2, sharey=True, width_ratios=[1.6, 1])
    total = float(stroke.time[-1])
    middle = 0.5 * total / int(getattr(result.motion, "passes", 1))
    near = (middle - 0.5 * _ZOOM * middle, middle + 0.5 * _ZOOM * middle)
    least = result.least_friction
    for axes, (low, high) in ((left, (0.0, total)), (right, near)):
        inside = np.flatnonzero((stroke.time >= low) & (stroke.time <= high))
        inside = inside[_thin(inside.size)]
        t = stroke.time[inside]
        rendered = stroke.relative_friction_rendered[inside]
        axes.plot(t, result.asked[inside], **style.WANTED, label="asked for")
        axes.plot(t, rendered, **style.RENDERED, label="rendered")
        axes.axhline(least, **style.REFERENCE, label=f"least this display reaches: {least:.2f}")
        axes.set(xlim=(low, high), xlabel="time (s)")
    left.set(ylabel="relative friction µ′/µ", ylim=(0, max(1.05, 1.03 * float(result.asked.max()))))
    left.set_title("the whole stroke")
    right.set_title("its first pass's middle, enlarged")
    style.legend_below(left, columns=3)
    return figure


@style.drawn
def drive(result: RenderAnalysis) -> Figure:
    """The amplitude commanded and the envelope; the tangential force under the finger."""
    stroke, force = result.stroke, result.force
    largest = stroke.envelope.amplitude_limit
    saturated = stroke.saturated_top + stroke.saturated_bottom
    volts = result.prediction.voltage
    named = f"largest: {shown(largest, M, 3)}"
    named += "" if volts is None else f" at {shown(volts, V, 3)}"
    figure = style.new_figure(
        f"The drive is at a limit {100 * saturated:.2g} % of the time; the finger is dragged with "
        f"{shown(float(np.mean(np.abs(force.friction_force))), N, 2)} on average",
        f"τ = {shown(result.time_constant, S, 3)} with the finger; pad {force.model}",
        5.6,
    )
    above, below = figure.subplots(2, 1, sharex=True)
    thin = _thin(stroke.time.size)
    t = stroke.time[thin]
    above.plot(t, 1e6 * stroke.command[thin], color=style.ORANGE, lw=1.2, label="commanded")
    above.plot(t, 1e6 * stroke.amplitude[thin], **style.RENDERED, label="vibrating")
    above.axhline(1e6 * largest, **style.REFERENCE, label=named)
    above.set(ylabel="amplitude (µm)")
    below.plot(t, force.friction_force[thin], color=style.GREEN, lw=1.4, label="tangential force")
    stuck = np.where(force.sticking[thin], force.friction_force[thin], np.nan)
    below.plot(t, stuck, color=style.INK, lw=2.2, label="while the skin sticks")
    below.set(xlabel="time (s)", ylabel="force (N)", xlim=(0, float(stroke.time[-1])))
    for axes in (above, below):
        style.legend_beside(axes)
    return figure


@style.drawn
def way(result: RenderAnalysis) -> Figure:
    """The texture in the plane, and the finger's way over it."""
    finger = result.finger
    span = max(float(np.ptp(finger.x)), float(np.ptp(finger.y)))
    margin = 0.12 * span
    across = max(float(np.ptp(finger.y)), 0.3 * span)
    centre = 0.5 * (float(finger.y.min()) + float(finger.y.max()))
    low = (float(finger.x.min()) - margin, centre - 0.5 * across - margin)
    high = (float(finger.x.max()) + margin, centre + 0.5 * across + margin)
    speed = float(np.mean(np.abs(finger.speed)))
    figure, axes = style.new_axes(
        f"{shown(float(np.sum(np.abs(np.diff(finger.way)))), M, 3)} of finger motion over "
        f"{style.plain(result.played.name, 40)}, {1e3 * speed:.3g} mm/s on average",
        "the texture as asked for, at the mean speed",
        4.2,
    )
    rows = max(2, round(_MAP_POINTS * (high[1] - low[1]) / (high[0] - low[0])))
    x, y = np.linspace(low[0], high[0], _MAP_POINTS), np.linspace(low[1], high[1], rows)
    values = result.texture.texture(x[None, :], y[:, None], speed, 0.0)
    picture = friction_of(result, values, speed)
    seen = style.seen_from_above(axes, picture, low, high)
    seen.set_clim(0.0, max(1.0, float(np.max(picture))))
    figure.colorbar(seen, ax=axes, label="µ′/µ asked for", shrink=0.9)
    thin = _thin(finger.x.size)
    x, y = 1e3 * finger.x[thin], 1e3 * finger.y[thin]
    axes.plot(x, y, color=style.PAPER, lw=3.4)
    axes.plot(x, y, color=style.ORANGE, lw=1.7, label="finger")
    axes.plot(x[:1], y[:1], "o", color=style.INK, mec=style.PAPER, label="start")
    style.legend_below(axes, columns=2)
    return figure


def friction_of(result: RenderAnalysis, values: FloatArray, speed: float) -> FloatArray:
    """The relative friction (1) that values of the texture, in its quantity, ask of the display
    under a finger at a speed (m/s)."""
    played = result.played
    if result.texture.texture.quantity == "amplitude":
        return played.inverse.friction_at(played.amplitude(values, speed), speed)
    return played.friction(values)


@style.drawn
def ripple(result: RenderAnalysis) -> Figure:
    """Figure of what the standing wave leaves of the amplitude along the way."""
    stroke, finger = result.stroke, result.finger
    half = result.prediction.mode.half_wavelength
    done = " The renderer makes up for it." if result.wave == "compensated" else ""
    figure = style.new_figure(
        f"Along the wave, every {shown(half, M, 3)}, the pad meets "
        f"{100 * float(np.min(result.factor)):.3g} to {100 * float(np.max(result.factor)):.3g} % "
        f"of an antinode's amplitude.{done}",
        f"standing wave {result.wave}; x = 0 is an antinode",
        4.6,
    )
    above, below = figure.subplots(2, 1, sharex=True)
    moving = np.flatnonzero(finger.speed)
    turns = moving[1:][np.diff(np.sign(finger.speed[moving])) != 0]
    first = slice(0, int(turns[0]) if turns.size else None)
    x = 1e3 * finger.x[first]
    thin = _thin(x.size)
    amplitude, met = stroke.amplitude, stroke.amplitude * result.factor
    rendered = stroke.relative_friction_rendered
    for axes, values, look in (
        (above, 1e6 * amplitude, {**style.WANTED, "label": "at the antinodes"}),
        (above, 1e6 * met, {**style.RENDERED, "label": "met by the pad"}),
        (below, result.asked, {**style.WANTED, "label": "asked for"}),
        (below, rendered, {**style.RENDERED, "label": "rendered"}),
    ):
        axes.plot(x[thin], values[first][thin], **look)
    above.set(ylabel="amplitude (µm)", ylim=(0, None))
    below.set(ylabel="µ′/µ", xlabel="x (mm)", ylim=(0, 1.05))
    for axes in (above, below):
        style.legend_beside(axes)
    return figure


@style.drawn
def picture(texture: TextureFile) -> Figure:
    """A texture from above, 50 mm or twelve periods wide, and along its middle line at 60 mm/s."""
    period = single_period(texture.texture)
    wide = _WIDE if period is None else min(_WIDE, _PERIODS * period)
    high = _HIGH * wide
    label, scale = _LABELS[texture.texture.quantity]
    figure = style.new_figure(
        texture.title, f"none; {label} as asked for at {1e3 * _SPEED:g} mm/s, towards +x", 3.6
    )
    left, right = figure.subplots(1, 2, width_ratios=[1.0, 1.2])
    x, y = np.linspace(0, wide, 501), np.linspace(0, high, 301)
    values = scale * texture.texture(x[None, :], y[:, None], _SPEED, 0.0)
    seen = style.seen_from_above(left, values, (0, 0), (wide, high))
    figure.colorbar(seen, ax=left, orientation="horizontal", label=label)
    left.axhline(500 * high, color=style.PAPER, lw=2.6)
    left.axhline(500 * high, color=style.INK, lw=1.1, ls=(0, (4, 2)))
    fine = np.linspace(0, wide, 4001)
    along = scale * texture.texture(fine, 0.5 * high, _SPEED, 0.0)
    right.plot(1e3 * fine, along, color=style.BLUE, lw=1.4)
    right.set(xlabel="x (mm), along the dashed line", ylabel=label, xlim=(0, 1e3 * wide))
    return figure


FIGURES = (
    FigureOf("friction", "Friction along the stroke", friction),
    FigureOf("drive", "Drive and tangential force", drive),
    FigureOf("way", "The finger's way over the texture", way),
    FigureOf("wave", "The standing wave", ripple, has=lambda result: result.wave != "ignored"),
)
