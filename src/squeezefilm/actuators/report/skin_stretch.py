"""What the terminal and the page show of a skin-stretch array."""

from __future__ import annotations

import functools
from pathlib import Path

from squeezefilm.actuators.analysis.skin_stretch import SkinStretchAnalysis
from squeezefilm.actuators.report import skin_stretch_figures as drawn
from squeezefilm.actuators.report.effect_rows import EFFECTS, effect_head, effect_rows
from squeezefilm.actuators.report.how_sure import drawn_words, how_sure, with_interval
from squeezefilm.actuators.report.page import assumed_words, write_page
from squeezefilm.actuators.skin_stretch.load_line import (
    PUBLISHED_BLOCKED,
    PUBLISHED_FREE,
    PUBLISHED_LOADED,
)
from squeezefilm.core import quantities as si
from squeezefilm.core.kit.numbers import HZ, M, N, Row, V, W, shown
from squeezefilm.core.kit.page_style import section, text_table
from squeezefilm.core.kit.terminal import bullets, show_rows

_ANSWERS = {
    "deflection_on_skin_m": "deflection on the skin",
    "force_on_skin_N": "force on the skin",
    "crosstalk": "crosstalk",
}
_MOVING = "wave.png"


def skin_stretch_rows(found: SkinStretchAnalysis) -> list[Row]:
    """The key numbers: quantity, value, remark."""
    array, tip, budget = found.array, found.tip, found.array.budget
    heat, driven = found.power
    sure = functools.partial(with_interval, found.drawn)
    count = array.cradle.count
    ways = " or ".join(way.replace("_", " ") for way in found.lines)
    seated = "never all" if found.least_force is None else shown(found.least_force, N, 3)
    return [
        (
            "Free deflection",
            sure(found.free_deflection, "free_deflection_m", M),
            f"at {shown(found.voltage, V, 3)}; the paper says {shown(PUBLISHED_FREE, M, 3)}",
        ),
        (
            "Blocked force",
            sure(found.blocked_force, "blocked_force_N", N),
            f"the paper says {shown(PUBLISHED_BLOCKED, N, 3)}",
        ),
        (
            "Against the skin",
            sure(tip.deflection, "deflection_on_skin_m", M),
            f"and {sure(tip.force, 'force_on_skin_N', N)}; the skin's "
            f"{found.skin.stiffness / 1e3:.3g} N/mm are assumed, as the paper's "
            f"{shown(PUBLISHED_LOADED, M, 3)} imply",
        ),
        (
            "Resonance",
            shown(array.bender.resonance_frequency, HZ, 3),
            f"free; {shown(tip.resonance_frequency, HZ, 3)} on the skin, within 3 dB up to "
            f"{shown(tip.bandwidth, HZ, 3)}",
        ),
        (
            "Crosstalk",
            sure(array.crosstalk, "crosstalk", si.Unit("1")),
            "of its displacement, at the neighbour that moves most",
        ),
        (
            "Contactors",
            f"{found.seating.touching} of {count} touch",
            f"under {shown(array.normal_force, N, 3)}; all from {seated} on",
        ),
        (
            "Slip",
            f"{found.together.slipping} of {count}",
            f"where all pull alike; {found.wave.pull.slipping} in a wave of "
            f"{shown(found.wave.period, M, 3)}",
        ),
        (
            "Actuators alone",
            f"{1e3 * budget.mass:.3g} g",
            f"{1e6 * budget.volume:.3g} cm³, of 60 g and 150 cm³; {1e4 * budget.area:.3g} cm² "
            "active; clamps, drivers and housing are not modelled",
        ),
        (
            "Power at 100 Hz",
            shown(driven, W, 3),
            f"that drivers burn at full swing; {shown(heat, W, 2)} heats the ceramics",
        ),
        ("Wires", " or ".join(map(str, found.lines.values())), f"{ways}; a count, not a circuit"),
    ]


def show_skin_stretch(found: SkinStretchAnalysis) -> None:
    """Print an array: key numbers, warnings, and what is assumed."""
    described = found.described
    title = f"{described.title} [{described.name}]"
    console = show_rows(title, skin_stretch_rows(found), found.warnings, fixed=(0, 1))
    bullets(console, [("interval", drawn_words(found.drawn), "")])
    bullets(console, [("assumed", assumed_words(described.provenance), "yellow")])


def write_skin_stretch(found: SkinStretchAnalysis, folder: Path) -> Path:
    """Write result.json, the figures, the moving texture and report.html into `folder`; the path of
    the page. Raises `InputError` where the folder cannot be written to."""
    summary = found.summary()
    nominal = {name: summary[name] for name in _ANSWERS}
    rows = effect_rows(found.effects, nominal, _ANSWERS)
    moved = f"<p>{EFFECTS}</p>" + text_table(
        "Change of the answers, at the lower value; at the higher one", effect_head(_ANSWERS), rows
    )
    moving = section(
        "The texture as it moves",
        f'<figure><img src="{_MOVING}" alt="The skin while a texture moves past"></figure>',
    )
    return write_page(
        found,
        folder,
        key_numbers=skin_stretch_rows(found),
        figures={
            "actuator": ("One actuator", drawn.actuator_figure(found)),
            "load-line": ("One actuator against the skin", drawn.load_line_figure(found)),
            "strain": ("The skin under the array", drawn.strain_figure(found)),
            "crosstalk": ("Crosstalk and seat", drawn.crosstalk_figure(found)),
        },
        more=moving + how_sure(found.drawn) + section("What each assumed value does", moved),
        pictures={_MOVING: drawn.wave_animation(found)},
    )
