"""A rendered texture in the terminal, and the folder of its page: trace, envelope, figures."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from squeezefilm.core.errors import InputError
from squeezefilm.core.formats.traces import Table, Waveform, csv_text, parquet_bytes, wav_bytes
from squeezefilm.core.kit.folder import json_text, require_folder, write_folder
from squeezefilm.core.kit.numbers import HZ, SPEED, M, N, S, V, printable, shown
from squeezefilm.core.kit.page_style import (
    Pictures,
    bullets,
    drawn_figures,
    links,
    page,
    picture_files,
    picture_sections,
    rows_section,
    section,
    stamped,
)
from squeezefilm.core.kit.terminal import heading, say, show_rows, table
from squeezefilm.design.report import texture_figures as draw
from squeezefilm.physics.render.fidelity.report import contrast_rows, lag_rows
from squeezefilm.physics.render.program.renderer import MadeForSpeed
from squeezefilm.physics.texture_files.hjif import HjifExport, ReferenceDevice, hjif_of

if TYPE_CHECKING:
    from squeezefilm.physics.chain.rendered_texture import RenderAnalysis


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
            f"{shown(result.mean_speed, SPEED)}",
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
    saturated, judged = stroke.saturated_top + stroke.saturated_bottom, result.fidelity
    if judged is None:
        rows.append(("Contrast, lag", "–", result.unjudged or ""))
    else:
        rows += contrast_rows(judged, "Contrast kept at") + lag_rows(judged)
    rows += [
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


def show_render(result: RenderAnalysis) -> None:
    """Print a rendered texture."""
    title = f"{result.played.name} on {result.display.title} [{result.display.name}]"
    show_rows(title, render_rows(result), result.prediction.warnings, fixed=(0, 1))


def show_lost(export: HjifExport) -> None:
    """Print what an export to MPEG haptics lost."""
    heading("texture.hjif holds one line of the texture; lost:")
    for text in export.lost:
        say(f"- {text}")
    say(f"- friction differs by {export.rms_error:.2g} RMS, {export.largest_error:.2g} at most")


def show_textures(listing: list[dict[str, str]]) -> None:
    """Print the textures that come with the package."""
    rows = [(texture["name"], texture["title"], texture["quantity"]) for texture in listing]
    table(("texture", "title", "quantity"), rows, fixed=(0,))


_DAC_RATE = 192_000


def trace_table(result: RenderAnalysis) -> Table:
    """Every step of the loop as a table, with the origin in its metadata."""
    return Table(
        result.columns(),
        {**result.provenance(), "texture": result.played.name, "display": result.display.name},
    )


def envelope_waveform(result: RenderAnalysis) -> Waveform:
    """The amplitude commanded over time, full scale being the display's largest amplitude."""
    stroke = result.stroke
    return Waveform(
        stroke.command,
        stroke.control_rate,
        "m",
        stroke.envelope.amplitude_limit,
        {**result.provenance(), "quantity": "amplitude commanded, zero-to-peak"},
    )


def drive_waveform(result: RenderAnalysis) -> Waveform:
    """The drive's voltage at 192 kHz: the commands on a carrier at the drive frequency.

    Full scale is the voltage limit.

    Raises:
        InputError: a display without a voltage, a control rate that does not divide 192 kHz, or a
            carrier above what that rate can carry.
    """
    from squeezefilm.physics.render.resonator.envelope import carrier_block, samples_per_command

    p, stroke = result.prediction, result.stroke
    if p.voltage is None:
        raise InputError("a drive in volts needs a display with a voltage")
    samples = samples_per_command(stroke.control_rate, _DAC_RATE)
    if p.frequency >= 0.5 * _DAC_RATE:
        raise InputError(f"{p.frequency:.6g} Hz cannot be carried at {_DAC_RATE} samples a second")
    volts = p.voltage * stroke.command / stroke.envelope.amplitude_limit
    out = np.empty(stroke.command.size * samples)
    carrier_block(0.0, 2 * np.pi * p.frequency / _DAC_RATE, volts, samples, 1.0, out)
    return Waveform(
        out,
        float(_DAC_RATE),
        "V",
        p.voltage,
        {**result.provenance(), "carrier_frequency_Hz": p.frequency},
    )


def hjif_export(result: RenderAnalysis) -> HjifExport:
    """The texture under the stroke as MPEG haptics. Raises `InputError` as `hjif_of` does."""
    p, played = result.prediction, result.played
    speed = result.mean_speed
    wanted = result.texture.texture(result.finger.x, result.finger.y, speed, result.finger.time)
    made_for = MadeForSpeed.of(played.inverse.friction_at, played.amplitude(wanted, speed), speed)
    frictional = result.texture.texture.quantity == "relative_friction"
    return hjif_of(
        result.texture.texture,
        float(np.floor(1e6 * result.finger.x.min()) * 1e-6),
        float(np.ceil(1e6 * result.finger.x.max()) * 1e-6),
        device=ReferenceDevice(
            result.display.name,
            p.frequency,
            p.voltage or 0.0,
            result.stroke.envelope.amplitude_limit,
        ),
        title=played.name,
        to_friction=None if frictional else partial(draw.friction_of, result, speed=speed),
        made_for=made_for,
    )


def write_render(
    result: RenderAnalysis,
    folder: Path,
    *,
    table: str = "csv",
    drive: bool = False,
    hjif: bool = False,
    progress: Callable[[str], None] | None = None,
) -> Path:
    """Write everything of a rendering into `folder`; the path of index.html.

    All is made in memory first; if a file cannot be written, those before it are taken away again.

    Raises:
        InputError: an unknown kind of table, what `drive_waveform` and `hjif_export` refuse, or a
            folder that cannot be written to.
    """
    tell = progress or (lambda _: None)
    if table not in ("csv", "parquet"):
        raise InputError(f"a table cannot be '{table}'; it may be csv or parquet")
    folder = require_folder(folder)
    tell("figures")
    figures = drawn_figures(draw.FIGURES, result, "render-")
    files = picture_files(figures)
    tell("trace")
    trace = trace_table(result)
    name = f"trace.{table}"
    files[name] = csv_text(trace) if table == "csv" else parquet_bytes(trace)
    files["envelope.wav"] = wav_bytes(envelope_waveform(result))
    if drive:
        files["drive.wav"] = wav_bytes(drive_waveform(result), "int24")
    summary = result.summary()
    if hjif:
        export = hjif_export(result)
        files["texture.hjif"] = (json.dumps(export.document, indent=1) + "\n").encode()
        summary["hjif"] = {
            "lost": list(export.lost),
            "rms_error": export.rms_error,
            "largest_error": export.largest_error,
            **({} if export.made_for is None else export.made_for.summary()),
        }
    files["fidelity.json"] = json_text(summary)
    files["index.html"] = _page(result, figures, sorted({*files, "index.html"}))
    return write_folder(folder, files)


def _page(result: RenderAnalysis, figures: Pictures, files: list[str]) -> str:
    title = escape(printable(result.played.name))
    stamp = result.provenance()
    caption = "What was asked for and what the finger meets"
    beside = links(name for name in files if not name.endswith((".png", ".html")))
    return page(
        f"{title}: rendered texture",
        title,
        f"rendered on <code>{escape(printable(result.display.name))}</code> by squeezefilm",
        rows_section("Numbers", caption, render_rows(result))
        + picture_sections(figures)
        + section("Warnings", bullets(result.prediction.warnings)),
        f"{stamped(stamp, 'SHA-256 of display, texture and motion')} ·\n"
        f"seed {stamp['seed']}. Beside this page: {beside}.",
    )
