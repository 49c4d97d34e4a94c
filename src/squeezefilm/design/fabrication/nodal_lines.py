"""Where the face of a display stands still: lines to hold it at, and for a vibrometer to find."""

from __future__ import annotations

import math
from dataclasses import dataclass

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.layout import Actuator, AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.ring.body import nodal_circles
from squeezefilm.physics.plate.working_mode import WorkingMode


@dataclass(frozen=True, eq=False)
class NodalLines:
    """Straight lines square to x or y at `positions` (m) along `axis`, circles of `radii` (m) about
    the middle, and radial lines at `angles` (rad); none of a kind where it is empty.

    Those of a plate are taken where the line through the best antinode crosses them: they may bend
    elsewhere. Radial lines are those that the driven sectors put there.
    """

    axis: str = ""
    positions: tuple[si.Metre, ...] = ()
    radii: tuple[si.Metre, ...] = ()
    angles: tuple[si.Radian, ...] = ()


def nodal_lines_of(actuator: Actuator, mode: WorkingMode) -> NodalLines:
    """The nodal lines of a display's working mode."""
    if isinstance(actuator, RectangularPlate):
        axis = "x" if actuator.lines_across == "length" else "y"
        line = mode.line
        found = () if line is None else tuple(map(float, line.nodal_positions))
        return NodalLines(axis=axis, positions=found)
    if isinstance(actuator, DiscPlate):
        radii = () if mode.disc is None else tuple(map(float, nodal_circles(mode.disc)))
        return NodalLines(radii=radii, angles=_radial(actuator.nodal_diameters))
    assert isinstance(actuator, AnnularStator), "there are three kinds of actuator"
    return NodalLines(angles=_radial(round(actuator.wavelengths_around)))


def _radial(diameters: int) -> tuple[si.Radian, ...]:
    """At the ends of the sectors, which begin at the angle 0."""
    return tuple(k * math.pi / diameters for k in range(2 * diameters))
