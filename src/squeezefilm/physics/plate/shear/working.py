"""The working mode of a plate by first-order shear theory: to screen edge strips."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.plate.elements.nodal_lines import line_distance, profiles, zero_crossings
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.shear.modes import ShearMode, shear_mode

# A screening: the model's own error of some percent is larger than what a higher degree saves.
_DEGREE = 4


@dataclass(frozen=True, eq=False)
class ShearWorking:
    """A mode of a shear plate along the line that crosses its nodal lines in the middle.

    `deflection` along `position` (m) is 1 at the largest lobe between the outermost lines, at
    `lobe` (x, y); `half_wavelength` (m) is that of `line_distance` on the shape's nearest product;
    `amplitude_per_volt` (m/V) and `modal_mass` (kg) are those of that lobe.
    """

    mode: ShearMode
    position: si.MetreArray
    deflection: si.FloatArray
    lobe: tuple[si.Metre, si.Metre]
    half_wavelength: si.Metre
    amplitude_per_volt: si.MetrePerVolt
    modal_mass: si.Kilogram


def shear_working(plate: RectangularPlate, near: si.Hertz) -> ShearWorking:
    """The working mode of a free plate with ceramics on its lower face, near a frequency (Hz).

    Glue and supports are left out. Raises `InputError` for ceramics on the upper face, or where no
    mode near the frequency has the nodal lines.
    """
    if any(patch.face == "top" for patch in plate.patches):
        raise InputError(
            "the shear plate knows ceramics on the lower face only; take theory = 'timoshenko' or "
            "'solid'",
            quantity="theory",
        )
    mode = shear_mode(plate, plate.working_label, near, degree=_DEGREE)
    along_x = plate.lines_across == "length"
    line = mode.x if along_x else mode.y
    across, side = (mode.y, plate.width) if along_x else (mode.x, plate.length)
    at = int(np.argmin(np.abs(across - side / 2)))
    w = mode.deflection[:, at] if along_x else mode.deflection[at, :]
    lengthwise, crosswise, _ = profiles(mode.deflection)
    turns = np.flatnonzero(np.signbit(w[1:]) != np.signbit(w[:-1]))
    if turns.size < 2:
        raise InputError(
            f"the mode {mode.label} has fewer than two nodal lines in the plate's middle, so no "
            "half wavelength; choose a mode with more",
            quantity="nodal_lines",
        )
    inside = slice(turns[0], turns[-1] + 1)
    peak = turns[0] + int(np.argmax(np.abs(w[inside])))
    size = abs(float(w[peak]))
    place = float(line[peak]), float(across[at])
    return ShearWorking(
        mode=mode,
        position=line,
        deflection=w / float(w[peak]),
        lobe=place if along_x else place[::-1],
        half_wavelength=line_distance(zero_crossings(line, lengthwise if along_x else crosswise)),
        amplitude_per_volt=size * mode.amplitude_per_volt(plate.quality_factor),
        modal_mass=mode.modal_mass / size**2,
    )
