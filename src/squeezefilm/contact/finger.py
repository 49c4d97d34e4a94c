"""The fingertip as the film and the contact see it."""

from __future__ import annotations

from dataclasses import dataclass

from squeezefilm.errors import InputError
from squeezefilm.quantities import Metre, Newton, Pascal, Unit, format_quantity, require


@dataclass(frozen=True)
class Finger:
    """A fingertip resting on the surface.

    `contact_length` l0 along the wave (the contact is a square of that side, as in the paper's
    eq 13); ridges of `ridge_amplitude` h_e (half their height) and `ridge_period` L;
    `normal_force` F. Pressed on a surface the ridges flatten: `plateau_width` is that of the flat
    part of each (illustrative; 150 to 350 µm are reported).
    """

    contact_length: Metre
    ridge_amplitude: Metre
    ridge_period: Metre
    normal_force: Newton
    plateau_width: Metre = 250e-6

    def __post_init__(self) -> None:
        for name in ("contact_length", "ridge_period"):
            require(name, getattr(self, name), Unit("m"), above=0)
        require("ridge_amplitude", self.ridge_amplitude, Unit("m"), at_least=0)
        require("normal_force", self.normal_force, Unit("N"), above=0)
        require("plateau_width", self.plateau_width, Unit("m"), above=0)
        if self.plateau_width > self.ridge_period:
            raise InputError(
                f"plateau_width = {format_quantity(self.plateau_width, Unit('m'))} is wider than "
                f"the ridge_period of {format_quantity(self.ridge_period, Unit('m'))}; make it "
                "narrower",
                quantity="plateau_width",
            )

    @property
    def mean_pressure(self) -> Pascal:
        """P_f = F / l0² (paper eq 13)."""
        return self.normal_force / self.contact_length**2
