"""How the time of a plate's analysis is shared out under a budget: mode, response, band."""

from __future__ import annotations

from dataclasses import dataclass

from squeezefilm.core import quantities as si
from squeezefilm.core.progress import Deadline, Pace
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.guess import estimated_frequency
from squeezefilm.physics.plate.solid.modes import Label, PlateModes
from squeezefilm.physics.plate.solid.size import SolveSize, band_seconds, solve_size
from squeezefilm.physics.plausibility.expected import expectation

ALONE = "the budget left no time for the other modes of the band"
"""What is said where only the working mode was solved."""


@dataclass(frozen=True)
class Hurry:
    """The deadlines of the parts, None where there is no budget: the working mode's leaves time for
    its response, and the band takes what these two leave."""

    size: SolveSize | None = None
    whole: Deadline | None = None

    @classmethod
    def of(cls, plate: RectangularPlate, label: Label, pace: Pace) -> Hurry:
        """What a pace leaves of each part of a plate's analysis.

        Raises `OutOfTimeError`, with the answer of a closed estimate, where the budget does not
        allow the coarse meshes.
        """
        whole = pace.deadline()
        if whole is None or pace.budget is None:
            return cls()
        size = solve_size(plate, label, estimated_frequency(plate, label))
        seen = expectation(plate)
        instead = "" if seen is None else f". Without a solve: {seen.sentence}."
        size.require_within(whole, pace.budget, instead)
        return cls(size, whole)

    def allows_band(self, plate: RectangularPlate, band: tuple[si.Hertz, si.Hertz]) -> bool:
        """Whether all modes of a band (Hz, Hz) can be looked for, on the coarse meshes at least."""
        return self.whole is None or self.whole.allows(band_seconds(plate, band[1]))

    def left_out(self, alone: PlateModes, modes: PlateModes) -> tuple[str, ...]:
        """What the budget left out of the working mode and the band's modes, in sentences."""
        said = [alone.coarseness] if alone.coarseness else []
        if self.whole is not None and modes is alone:
            said.append(ALONE)
        return tuple(said)
