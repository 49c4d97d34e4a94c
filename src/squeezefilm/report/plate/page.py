"""The page of a solved plate, disc or stator: numbers, figures, modes, what it depends on."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import TYPE_CHECKING

from squeezefilm.analysis.plate.command import PlateAnalysis
from squeezefilm.analysis.plate.ring import RingAnalysis
from squeezefilm.report.kit.numbers import HZ, M, V, printable, shown
from squeezefilm.report.kit.page_style import html_table, page_head, picture_sections, section
from squeezefilm.report.plate.terminal_modes import (
    drive_rows,
    fit_sentences,
    mode_rows,
    working_rows,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.analysis.plate.sensitivity import SensitivityTable
    from squeezefilm.analysis.plate.solved import SolvedBody

_VOLUME = """ The solved volume for ParaView:
<a href="mode.vtu">mode.vtu</a> (warp by <code>mode_displacement_m</code>, scaled to 1 µm at its
largest)."""


def plate_page(result: SolvedBody, figures: Mapping[str, tuple[str, Figure]]) -> str:
    """The text of index.html; figures (heading and drawing) are the PNG files beside it by name."""
    title = escape(printable(result.display.title))
    sections = [
        section("Working mode", _numbers(result)),
        picture_sections(figures),
        section("Modes in the band", _modes(result)),
    ]
    volume = _VOLUME if isinstance(result, PlateAnalysis) else ""
    if isinstance(result, PlateAnalysis) and result.sensitivities is not None:
        sections.append(section("Sensitivities in numbers", sensitivities(result.sensitivities)))
    stamp = result.summary()["provenance"]
    return f"""{page_head(f"{title}: solved plate")}
<header><h1>{title}</h1>
<p class="name"><code>{escape(printable(result.display.name))}</code>, plate solved by squeezefilm
</p></header>
<main>
{"".join(sections)}
</main>
<footer><p>squeezefilm {escape(str(stamp["squeezefilm_version"]))} ·
made {escape(str(stamp["created_utc"]))} (UTC) ·
description SHA-256 <code>{escape(str(stamp["config_sha256"]))}</code>.
Numbers: <a href="plate.json">plate.json</a>.{volume}</p></footer>
</body>
</html>
"""


def _table(caption: str, head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    cells = [[*map(escape, row)] for row in rows]
    return html_table(escape(caption), map(escape, head), cells, between="")


def _numbers(result: SolvedBody) -> str:
    volts = result.display.drive.voltage
    rows = working_rows(result)
    amplitude = shown(volts * result.amplitude_per_volt, M, 3)
    rows.append((f"Amplitude at {shown(volts, V)}", amplitude, "zero-to-peak, largest"))
    table = _table(result.model, ("Quantity", "Value", "Remark"), rows + drive_rows(result))
    fit = result.body.fit if isinstance(result, RingAnalysis) else None
    said = () if fit is None else fit_sentences(fit)
    return table + "".join(f"<p>{escape(sentence)}</p>" for sentence in said)


def _modes(result: SolvedBody) -> str:
    rows = [
        (label, frequency, f"± {error}", *rest)
        for label, frequency, error, *rest in mode_rows(result.rows, result.amplitude_per_volt)
    ]
    head = ("Mode", "Frequency", "Error", "Q", "Per volt", "Coupling")
    return _table(result.status, head, rows)


def sensitivities(table: SensitivityTable) -> str:
    """The table of sensitivities as HTML."""
    rows = [
        (
            f"{row.name}: {row.change}",
            shown(row.frequency, HZ, 5),
            f"{row.frequency_shift:+.2%}",
            "–" if row.amplitude_shift is None else f"{row.amplitude_shift:+.1%}",
        )
        for row in table.rows
    ]
    head = ("Change", "Frequency", "Shift of frequency", "Shift of amplitude per volt")
    return _table("Each changed plate solved anew", head, rows)
