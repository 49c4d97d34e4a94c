"""The page of a solved plate: its numbers, its figures beside it, its modes, what it depends on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

from squeezefilm.quantities import Unit
from squeezefilm.report.kit.numbers import printable, shown
from squeezefilm.report.kit.page_style import page_head

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.analysis.plate.command import PlateAnalysis
    from squeezefilm.analysis.plate.sensitivity import SensitivityTable

HZ, PER_VOLT = Unit("Hz"), Unit("m/V")


@dataclass(frozen=True, eq=False)
class PlateFigure:
    """A figure of the page: the name of its PNG (without the ending), heading, drawing."""

    name: str
    heading: str
    figure: Figure


def plate_page(result: PlateAnalysis, figures: list[PlateFigure]) -> str:
    """The text of index.html; figures are the PNG files beside it."""
    title = escape(printable(result.display.title))
    sections = [
        _section("Working mode", _numbers(result)),
        *(_section(escape(one.heading), _figure(one)) for one in figures),
        _section("Modes in the band", _modes(result)),
    ]
    if result.sensitivities is not None:
        sections.append(_section("Sensitivities in numbers", sensitivities(result.sensitivities)))
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
Numbers: <a href="plate.json">plate.json</a>. The solved volume for ParaView:
<a href="mode.vtu">mode.vtu</a> (warp by <code>mode_displacement_m</code>, scaled to 1 µm at its
largest).</p></footer>
</body>
</html>
"""


def _section(heading: str, body: str) -> str:
    return f"<section>\n<h2>{heading}</h2>\n{body}\n</section>\n"


def _figure(one: PlateFigure) -> str:
    message = escape(" ".join(one.figure.get_suptitle().split()))
    return f'<figure><img src="{one.name}.png" alt="{message}"></figure>'


def _table(caption: str, head: tuple[str, ...], rows: Sequence[tuple[str, ...]]) -> str:
    columns = "".join(f'<th scope="col">{escape(cell)}</th>' for cell in head)
    body = "\n".join(
        f'<tr><th scope="row">{escape(row[0])}</th>'
        + "".join(f"<td>{escape(cell)}</td>" for cell in row[1:])
        + "</tr>"
        for row in rows
    )
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(caption)}"><table>'
        f"<caption>{escape(caption)}</caption><thead><tr>{columns}</tr></thead>"
        f"<tbody>\n{body}\n</tbody></table></div>"
    )


def _numbers(result: PlateAnalysis) -> str:
    mode, volts = result.working, result.display.drive.voltage
    at = result.response.resonance
    rows: list[tuple[str, ...]] = [
        (f"Mode {mode.label}", shown(mode.frequency, HZ, 5),
         f"± {shown(mode.frequency_error, HZ, 2)} (estimated)"),
        ("Amplitude per volt", shown(result.amplitude_per_volt, PER_VOLT), "largest, upper face"),
        ("", shown(result.centreline_per_volt, PER_VOLT), "centreline, between outer nodes"),
        ("Quality factor", f"{mode.quality_factor:.4g}", "from the losses of its materials"),
        ("Effective coupling", f"{mode.coupling:.3g}", ""),
        (f"Amplitude at {volts:g} V", shown(volts * result.amplitude_per_volt, Unit("m"), 3),
         "zero-to-peak, largest"),
        (f"Current at {volts:g} V", shown(float(result.response.current(volts)[at]), Unit("A"), 3),
         f"{result.response.apparent_power(volts)[at]:.3g} VA, "
         f"{result.response.input_power(volts)[at]:.3g} W"),
    ]  # fmt: skip
    if result.circuit is not None:
        c = result.circuit
        rows.append(
            (
                "Equivalent circuit",
                f"C0 {shown(c.static_capacitance, Unit('F'), 3)}",
                f"R1 {c.motional_resistance:.3g} Ω, "
                f"L1 {shown(c.motional_inductance, Unit('H'), 3)}, "
                f"C1 {shown(c.motional_capacitance, Unit('F'), 3)}",
            )
        )
    return _table(f"{result.modes.model}", ("Quantity", "Value", "Remark"), rows)


def _modes(result: PlateAnalysis) -> str:
    rows = [
        (
            row.label,
            shown(row.frequency, HZ, 5),
            f"± {shown(row.frequency_error, HZ, 2)}",
            f"{row.quality_factor:.3g}",
            "not driven"
            if row.amplitude_per_volt < 1e-4 * result.amplitude_per_volt
            else shown(row.amplitude_per_volt, PER_VOLT, 3),
            f"{row.coupling:.2g}",
        )
        for row in result.rows
    ]
    head = ("Mode", "Frequency", "Error", "Q", "Per volt", "Coupling")
    return _table(result.modes.status, head, rows)


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
