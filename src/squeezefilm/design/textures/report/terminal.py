"""Output for a rendered texture, in the terminal and on the page: asked for against rendered."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import HZ, M, N, S, V, shown
from squeezefilm.core.kit.terminal import heading, plain_console, show_rows, table
from squeezefilm.physics.render.fidelity.report import contrast_rows, lag_rows

if TYPE_CHECKING:
    from squeezefilm.physics.chain.rendered_texture import RenderAnalysis
    from squeezefilm.physics.texture_files.hjif import HjifExport


_SPEED = si.Unit("m/s")


def render_rows(result: RenderAnalysis) -> list[tuple[str, str, str]]:
    """The lines of the table: quantity, value, remark."""
    stroke, p, counters = result.stroke, result.prediction, result.counters
    rendered = stroke.relative_friction_rendered
    drive = "" if p.voltage is None else f"at {shown(p.voltage, V)}, the limit"
    eyes = "the finger's place is known"
    if stroke.sensor is not None:
        eyes = f"{stroke.sensor.name} ({stroke.sensor.evidence})"
    rows = [
        ("Largest amplitude", shown(stroke.envelope.amplitude_limit, M, 3), drive),
        (
            "Least friction µ′/µ",
            f"{result.least_friction:.3f}",
            f"{p.model}, {shown(p.normal_force, N)} on {p.surface.name}, "
            f"{shown(result.mean_speed, _SPEED)}",
        ),
        ("Finger", "", result.display.whose_finger),
        ("Time constant", shown(result.time_constant, S, 3), "of the envelope, finger on it"),
        ("Loop", shown(stroke.control_rate, HZ, 3), f"{eyes}; compensation: {stroke.compensation}"),
        (
            "Friction asked for",
            f"{np.mean(result.asked):.3f} ± {np.std(result.asked):.3f}",
            "mean and RMS swing of µ′/µ",
        ),
        ("Friction rendered", f"{np.mean(rendered):.3f} ± {np.std(rendered):.3f}", ""),
        ("RMS error of µ′/µ", f"{result.rms_error:.3f}", "rendered − asked for"),
    ]
    saturated = stroke.saturated_top + stroke.saturated_bottom
    rows += [
        *_judged_rows(result),
        ("Drive at a limit", f"{100 * saturated:.3g} %", "of the time"),
        (
            "Beyond the display",
            f"{counters.unreachable} of {counters.ticks}",
            f"samples: {counters.too_slippery} too slippery, {counters.too_sticky} too sticky, "
            f"{counters.saturated} too large, {counters.negative} below 0",
        ),
        (
            "Tangential force",
            shown(float(np.mean(np.abs(result.force.friction_force))), N, 3),
            f"on average; the skin sticks {100 * result.force.stuck_share:.2g} % of the time",
        ),
    ]
    if result.wave != "ignored":
        low, high = 100 * float(np.min(result.factor)), 100 * float(np.max(result.factor))
        said = f"of the amplitude on an antinode is met, {result.wave}; period"
        period = shown(p.mode.half_wavelength, M, 3)
        rows.append(("Standing wave", f"{low:.3g}–{high:.3g} %", f"{said} {period}"))
    return rows


def _judged_rows(result: RenderAnalysis) -> list[tuple[str, str, str]]:
    """Contrast and lag of what was rendered, or why there are none."""
    judged = result.fidelity
    if judged is None:
        return [("Contrast, lag", "–", result.unjudged or "")]
    return contrast_rows(judged, "Contrast kept at") + lag_rows(judged)


def show_render(result: RenderAnalysis) -> None:
    """Print a rendered texture."""
    title = f"{result.played.name} on {result.display.title} [{result.display.name}]"
    show_rows(title, render_rows(result), result.prediction.warnings, fixed=(0, 1))


def show_lost(export: HjifExport) -> None:
    """Print what an export to MPEG haptics lost."""
    console = plain_console()
    heading(console, "texture.hjif holds one line of the texture; lost:")
    for text in export.lost:
        console.print(f"- {text}")
    console.print(
        f"- friction differs by {export.rms_error:.2g} RMS, {export.largest_error:.2g} at most"
    )


def show_textures(listing: list[dict[str, str]]) -> None:
    """Print the textures that come with the package."""
    rows = [(texture["name"], texture["title"], texture["quantity"]) for texture in listing]
    table(plain_console(), ("texture", "title", "quantity"), rows, fixed=(0,))
