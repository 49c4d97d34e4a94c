"""A colour, a line and a name for each model of film and friction, in every figure."""

from __future__ import annotations

from typing import NamedTuple

from squeezefilm.core.kit import style


class Look(NamedTuple):
    """The line and the name of a model."""

    color: str
    dashes: str | tuple[int, tuple[float, ...]]
    name: str


_LOOKS = {
    "levitation": Look(style.INK, "-", "levitation, fitted to people"),
    "partial-levitation": Look(style.BLUE, "-", "partial levitation"),
    "paper2008": Look(*style.LINES[1], "paper's asymptote"),
    "paper2008-printed": Look(*style.LINES[1], "paper's asymptote, as printed"),
    "levitation-2016": Look(*style.LINES[2], "levitation, as published in 2016"),
    "levitation-ridges": Look(style.GREEN, (0, (4, 1.2)), "levitation, films over single ridges"),
    "solved film": Look(*style.LINES[3], "the same film, solved"),
}


def look_of(model: str) -> Look:
    """The look of a model; one that has none is drawn as a plain line under its own name."""
    return _LOOKS.get(model, Look(style.INK, "-", model))
