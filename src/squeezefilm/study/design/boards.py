"""The boards of a match-to-sample study's real gratings: where each ridge lies."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import HardLimit, require_within
from squeezefilm.physics.perception.stimuli import Grating
from squeezefilm.study.design.study_design import StudyDesign

_RIDGES = HardLimit("ridges of a board", 1, 20_000, "a drawing of so many opens nowhere")


@dataclass(frozen=True, slots=True, eq=False)
class Board:
    """A grating as it is made: a plate with ridges across the stroke.

    Attributes:
        grating: what it is.
        ridge_width, groove_width: along the stroke (m).
        begin: where each ridge begins, from the board's left end (m), shape (ridges,).
        end: where it ends (m), likewise; the last may be cut by the board's end.
    """

    grating: Grating
    ridge_width: si.Metre
    groove_width: si.Metre
    begin: si.MetreArray
    end: si.MetreArray

    @property
    def ridges(self) -> int:
        """Number of ridges, a cut one too."""
        return int(self.begin.size)

    @property
    def says(self) -> str:
        """Words for the length that the study calls period."""
        grating = self.grating
        asked, period = (
            si.format_quantity(x, si.Unit("m"), 4) for x in (grating.spatial_period, grating.period)
        )
        if grating.period_means == "period":
            return f"'{grating.name}': the study's {asked} is the whole period, groove plus ridge"
        return f"'{grating.name}': the study's {asked} is the groove width; the period is {period}"


def board_of(grating: Grating) -> Board:
    """The board of a real grating: it begins with a ridge, and each period has its groove after it.

    Raises `InputError` for a board shorter than a period, or with too many ridges to draw.
    """
    count = math.ceil(grating.length / grating.period * (1 - 1e-12))
    require_within(_RIDGES, float(count), enough="make the board shorter or the period longer")
    if grating.length < grating.period:
        period, length = (
            si.format_quantity(one, si.Unit("m"), 4) for one in (grating.period, grating.length)
        )
        raise InputError(
            f"board '{grating.name}' of {length} holds no whole period of {period}; make it longer",
            quantity="length",
        )
    begin: si.MetreArray = grating.period * np.arange(count, dtype=float)
    ridge = grating.period * grating.ridge_share
    end: si.MetreArray = np.minimum(begin + ridge, grating.length)
    return Board(grating, ridge, grating.groove_width, begin, end)


def boards(design: StudyDesign) -> tuple[Board, ...]:
    """The boards of a design's real gratings. Raises `InputError` for a design without any."""
    if not design.alternatives:
        raise InputError(
            f"'{design.name}' is a study of {design.task} and compares with no real gratings, so "
            "that there are no boards to make; take a match-to-sample design"
        )
    return tuple(board_of(alternative) for alternative in design.alternatives)
