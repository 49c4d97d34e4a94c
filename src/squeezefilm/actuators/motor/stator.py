"""The motion of a plate's free face in its working mode, across and along: what a foot stands on.

A solved plate says both by itself. A beam's face, h above its neutral plane, moves along by −h ψ
where the section turns by ψ (without shear the slope dw/dx): as far from an antinode as towards a
node, and not at all on the antinode itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from scipy.interpolate import CubicSpline

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.working_mode import PlateTheory, WorkingMode, working_mode


@dataclass(frozen=True, eq=False)
class FaceMode:
    """A plate's working mode on the middle line of its free face, along its wave.

    `across` and `along` are the motions at `position` (m) for a mode of 1 at its lobe. The mode is
    taken alike along its nodal lines: feet far from the middle line move as those on it.
    `along_width` says that the wave runs along the plate's width.
    """

    working: WorkingMode
    position: si.MetreArray
    across: si.FloatArray
    along: si.FloatArray
    along_width: bool

    @property
    def modal_mass(self) -> si.Kilogram:
        """Of the mode, for 1 m at its lobe (kg)."""
        mass = self.working.modal_mass
        assert mass is not None  # every plate's mode has one
        return mass

    @si.checked_numbers
    def at(
        self, place: Annotated[si.MetreArray, si.AtLeast(0.0)]
    ) -> tuple[si.FloatArray, si.FloatArray]:
        """The motion across and along at places on the wave's line (m, from the plate's edge)."""
        si.require("place", place, si.Unit("m"), at_most=float(self.position[-1]) + 1e-9)
        return (
            np.asarray(CubicSpline(self.position, self.across)(place)),
            np.asarray(CubicSpline(self.position, self.along)(place)),
        )


def face_mode(plate: RectangularPlate, theory: PlateTheory = "solid") -> FaceMode:
    """The working mode of a plate on its free face, see `FaceMode`.

    Raises what `working_mode` raises, and `OutOfRangeError` for a mode without a shape.
    """
    mode = working_mode(plate, theory)
    wide = plate.lines_across == "width"
    if mode.solid is not None:
        solid = mode.solid
        x, middle = solid.position, np.array([(plate.length if wide else plate.width) / 2])
        lengths, widths = (middle, x) if wide else (x, middle)
        field = solid.modes.field(solid.index, lengths, widths, plate.thickness)
        line = field[0] if wide else field[:, 0]
        scale = line[int(np.argmin(np.abs(x - mode.lobe[1 if wide else 0]))), 2]
        along = np.real(line[:, 1 if wide else 0] / scale)
        return FaceMode(mode, x, np.real(line[:, 2] / scale), along, wide)
    beam = mode.beam
    if beam is None or mode.line is None:
        raise OutOfRangeError(f"the model '{mode.model}' has no shape over the face")
    # The feet stand on the substrate: what is bonded beside them lies above that face.
    h = beam.section.neutral_axis - plate.ceramic_thickness_on("top")
    shape = beam.mode
    top = float(shape.deflection_at(mode.lobe[1 if wide else 0]))
    return FaceMode(mode, shape.position, shape.deflection / top, -h * shape.rotation / top, wide)
