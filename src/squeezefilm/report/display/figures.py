"""The figures of a report in their order, each with its heading and how to read it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from squeezefilm.report.display import (
    fidelity_figures,
    friction_figures,
    layout_figures,
    plate_figures,
    texture_figures,
)
from squeezefilm.report.friction import figures as friction_report

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squeezefilm.analysis.analyze import Analysis


@dataclass(frozen=True)
class FigureOfReport:
    """A figure of the report: its key (in ids), heading, what it shows, and what draws it."""

    key: str
    heading: str
    reading: str
    draw: Callable[[Analysis], Figure]


FIGURES: tuple[FigureOfReport, ...] = (
    FigureOfReport(
        "layout",
        "Side view and layout",
        "The vibrating body to scale. Parts marked + and − follow the drive with opposite sign.",
        layout_figures.layout,
    ),
    FigureOfReport(
        "mode",
        "Mode shape and nodal lines",
        "Deflection at the two extremes of a period. Along the nodal lines nothing moves, and "
        "nothing is felt.",
        plate_figures.mode_shape,
    ),
    FigureOfReport(
        "response",
        "Frequency response",
        "Vibration amplitude per volt around the working resonance. Outside the half-power band "
        "less than 71 % of it is left.",
        plate_figures.frequency_response,
    ),
    FigureOfReport(
        "pressure",
        "Pressure under the finger",
        "Above, the gap under the ridges of the finger, averaged over a period; below, the mean "
        "pressure of the film, to compare with what would carry the finger. The paper's Fig 4.",
        friction_figures.pressure,
    ),
    FigureOfReport(
        "friction",
        "Friction against amplitude",
        "Friction divided by that without vibration, on each surface; squares mark where the "
        "model's film carries the whole finger. The paper's Fig 5.",
        friction_figures.friction,
    ),
    FigureOfReport(
        "chain",
        "Friction by every model, and how sure it is",
        "The same finger by the paper's model, by solved films and by partial levitation, where "
        "film and asperities share the load. The bar is the interval of what is uncertain in the "
        "description and in the finger.",
        friction_report.chain,
    ),
    FigureOfReport(
        "films",
        "The paper's film and solved films",
        "The film's mean over-pressure divided by the finger's pressure: above 1 the film would "
        "carry the finger alone. The same finger, drawn in five ways.",
        friction_figures.film_models,
    ),
    FigureOfReport(
        "wavelength",
        "Wave length against amplitude",
        "The amplitude that each of the paper's four half wavelengths needs for a relative "
        "friction of 0.7. The paper's Fig 11.",
        friction_figures.wavelength,
    ),
    FigureOfReport(
        "texture",
        "A texture under the moving finger",
        "Amplitude and friction along a stroke over a square grating: as wanted, and as the "
        "resonator lets them through.",
        texture_figures.texture,
    ),
    FigureOfReport(
        "fidelity",
        "Which texture survives at which finger speed",
        "The share of its swing that a grating keeps: of the amplitude in large print, of the "
        "friction in small print.",
        texture_figures.fidelity,
    ),
    FigureOfReport(
        "compensation",
        "Getting a fine grating through the resonator",
        "A grating of 0.4 mm at twice the finger speed that it survives uncompensated, up to 0.8 "
        "of the full amplitude: above the amplitude, below the command that makes it, within the "
        "voltage. Phase inversion asks for an amplifier that can turn its sign.",
        fidelity_figures.compensation,
    ),
    FigureOfReport(
        "survival",
        "Which period survives at which speed, compensated or not",
        "The finest square grating that keeps 90 % of a swing to 0.8 of the full amplitude.",
        fidelity_figures.survival,
    ),
)
