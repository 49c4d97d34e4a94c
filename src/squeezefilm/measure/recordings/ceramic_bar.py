"""A bare ceramic bar, as a description names it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import DENSITY, LAYER, SIDE


@si.checked_numbers
@dataclass(frozen=True)
class CeramicBar:
    """A bar poled through its thickness, with electrodes all over both faces: `length`, `width` and
    `thickness` (m) and its `density` (kg/m³). Raises `InputError` for one that is no bar."""

    length: Annotated[si.Metre, SIDE]
    width: Annotated[si.Metre, SIDE]
    thickness: Annotated[si.Metre, LAYER]
    density: Annotated[si.KilogramPerCubicMetre, DENSITY]

    def __post_init__(self) -> None:
        widest = max(self.width, self.thickness)
        if self.length < 2 * widest:
            raise InputError(
                f"length = {self.length * 1e3:.4g} mm is less than twice the largest other side, "
                f"{widest * 1e3:.4g} mm: the bar would not vibrate along its length alone; cut a "
                "longer or narrower one",
                quantity="length",
            )
