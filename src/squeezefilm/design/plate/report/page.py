"""The page of a solved plate, disc or stator: numbers, figures, modes, what it depends on."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import TYPE_CHECKING

from squeezefilm.core.kit.numbers import M, V, printable, shown
from squeezefilm.core.kit.page_style import page, picture_sections, section, stamped, text_table
from squeezefilm.design.plate.command import PlateAnalysis
from squeezefilm.design.plate.report.terminal import (
    drive_rows,
    fit_sentences,
    mode_rows,
    working_rows,
)
from squeezefilm.design.plate.ring import RingAnalysis

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.design.plate.solved import SolvedBody

_VOLUME = """ The solved volume for ParaView:
<a href="mode.vtu">mode.vtu</a> (warp by <code>mode_displacement_m</code>, scaled to 1 µm at its
largest)."""


def plate_page(result: SolvedBody, figures: Mapping[str, tuple[str, Figure]]) -> str:
    """The text of index.html; figures (heading and drawing) are the PNG files beside it by name."""
    title = escape(printable(result.display.title))
    body = (
        section("Working mode", _numbers(result))
        + picture_sections(figures)
        + section("Modes in the band, each alone at its antinode", _modes(result))
    )
    volume = _VOLUME if isinstance(result, PlateAnalysis) else ""
    stamp = stamped(result.summary()["provenance"], "description SHA-256")
    return page(
        f"{title}: solved plate",
        title,
        f"<code>{escape(printable(result.display.name))}</code>, plate solved by squeezefilm",
        body,
        f'{stamp}.\nNumbers: <a href="plate.json">plate.json</a>.{volume}',
    )


def _numbers(result: SolvedBody) -> str:
    volts = result.display.drive.voltage
    rows = working_rows(result)
    amplitude = shown(volts * result.amplitude_per_volt, M, 3)
    rows.append((f"Amplitude at {shown(volts, V)}", amplitude, "zero-to-peak, at the antinode"))
    table = text_table(result.model, ("Quantity", "Value", "Remark"), rows + drive_rows(result))
    fit = result.body.fit if isinstance(result, RingAnalysis) else None
    said = (*(() if fit is None else fit_sentences(fit)), *result.objections, *result.heat.doubts)
    return table + "".join(f"<p>{escape(sentence)}</p>" for sentence in said)


def _modes(result: SolvedBody) -> str:
    rows = [
        (label, frequency, f"± {error}", *rest)
        for label, frequency, error, *rest in mode_rows(result.rows, result.amplitude_per_volt)
    ]
    head = ("Mode", "Frequency", "Error", "Q", "Per volt", "Coupling")
    return text_table(result.status, head, rows)
