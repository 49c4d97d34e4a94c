"""The figures of a report in their order, each with its heading and how to read it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from squeezefilm.core.kit import style
from squeezefilm.core.kit.page_style import FigureOf
from squeezefilm.design.analysis.report import (
    area_figures,
    friction_figures,
    plate_figures,
)

if TYPE_CHECKING:
    from squeezefilm.design.analysis.analyze import Analysis

FIGURES: tuple[FigureOf, ...] = (
    FigureOf(
        "area",
        "Friction over the active area",
        area_figures.active_area,
        "By the place of the finger's centre; the square is its contact at the best place.",
    ),
    FigureOf(
        "response",
        "Frequency response",
        plate_figures.frequency_response,
        "Vibration amplitude per volt around the working resonance, without a finger. Outside the "
        "half-power band less than 71 % of it is left.",
    ),
    FigureOf(
        "band",
        "Friction against amplitude, and how sure it is",
        friction_figures.own_friction,
        "Friction divided by that without vibration, by the model of the verdict. The band and the "
        "bar hold what is uncertain in the description, in the finger and in the laws; in the bar "
        "the amplitude is uncertain too.",
    ),
)
"""What one decides from, in the order of the page."""


def drawing(analysis: Analysis, key: str) -> str:
    """One of the figures as an SVG element, with its message for those who cannot see it."""
    item = next(one for one in FIGURES if one.key == key)
    with style.rc():
        figure = item.draw(analysis)
        message = " ".join(figure.get_suptitle().split())
        return style.svg(figure, key, f"{item.heading}. {message}. {item.reading}")
