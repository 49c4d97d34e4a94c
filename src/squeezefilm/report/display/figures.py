"""The figures of a report in their order, each with its heading and how to read it."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from squeezefilm.report.display import (
    area_figures,
    friction_figures,
    layout_figures,
    plate_figures,
    texture_figures,
)
from squeezefilm.report.friction import figures as friction_report
from squeezefilm.report.kit import style
from squeezefilm.report.kit.page_style import FigureOf

if TYPE_CHECKING:
    from squeezefilm.analysis.analyze import Analysis

DECISION: tuple[FigureOf, ...] = (
    FigureOf(
        "layout",
        "Side view and layout",
        layout_figures.layout,
        "The vibrating body to scale. Parts marked + and − follow the drive with opposite sign.",
    ),
    FigureOf(
        "mode",
        "Mode shape and nodal lines",
        plate_figures.mode_shape,
        "Deflection at the two extremes of a period, along the line through the antinode of which "
        "amplitudes are told. The dashed lines are its zeros: nothing moves there, but a finger is "
        "wide enough to meet the antinodes beside them.",
    ),
    FigureOf(
        "area",
        "Amplitude and friction over the active area",
        area_figures.active_area,
        "What the face does and what a finger with its centre there meets of it. The finger damps "
        "the vibration at each place as it does there.",
    ),
    FigureOf(
        "response",
        "Frequency response",
        plate_figures.frequency_response,
        "Vibration amplitude per volt around the working resonance, without a finger. Outside the "
        "half-power band less than 71 % of it is left.",
        needs=("response",),
    ),
    FigureOf(
        "band",
        "Friction against amplitude, and how sure it is",
        friction_figures.own_friction,
        "Friction divided by that without vibration, by the model of the verdict. The band and the "
        "bar hold what is uncertain in the description, in the finger and in the laws; in the bar "
        "the amplitude is uncertain too.",
        needs=("band", "own_curves"),
    ),
)
"""What one decides from."""

MODELS: tuple[FigureOf, ...] = (
    FigureOf(
        "chain",
        "Friction by every model",
        friction_report.chain,
        "The same finger by every model that can be asked for. The default is fitted to measured "
        "curves; the paper's closed form, the levitation published in 2016 and partial levitation, "
        "where film and asperities share the load, are not.",
        needs=("model_curves",),
    ),
)
"""What other models say."""

TEXTURES: tuple[FigureOf, ...] = (
    FigureOf(
        "texture",
        "A texture under the moving finger",
        texture_figures.texture,
        "Amplitude and friction along a stroke over a square grating: as wanted, and as the "
        "resonator lets them through.",
        needs=("texture",),
    ),
    FigureOf(
        "fidelity",
        "Which texture survives at which finger speed",
        texture_figures.fidelity,
        "The share of its swing that a grating keeps, peak to peak: of the amplitude in large "
        "print. In small print the share of its fundamental, the wave of its own period, which "
        "rounded edges lose first; then both of the friction.",
    ),
    FigureOf(
        "survival",
        "Which period survives at which speed, compensated or not",
        texture_figures.survival,
        "The finest square grating that keeps 90 % of a swing to 0.8 of the full amplitude, peak "
        "to peak; the legend says how much of its fundamental that leaves.",
        needs=("survival",),
    ),
)
"""What a texture becomes along a stroke."""

FIGURES = (*DECISION, *MODELS, *TEXTURES)


def prepare() -> None:
    """Load what drawing takes, before there is anything to draw."""
    style.svg(style.message_figure("Fonts", "are looked for"), "fonts", "")


def drawing(analysis: Analysis, key: str) -> str:
    """One of the figures as an SVG element, with its message for those who cannot see it."""
    item = next(one for one in FIGURES if one.key == key)
    with style.rc():
        figure = item.draw(analysis)
        message = " ".join(figure.get_suptitle().split())
        return style.svg(figure, key, f"{item.heading}. {message}. {item.reading}")


def drawing_of(analysis: Analysis, key: str, shows: Mapping[str, Any]) -> str:
    """As `drawing`, of an analysis of which what the figure `shows` is given, by name."""
    whole = copy.copy(analysis)
    vars(whole).update(shows)
    return drawing(whole, key)
