"""The fingertip as the film and the contact see it."""

from __future__ import annotations

from dataclasses import dataclass

from squeezefilm.quantities import Metre, Newton, Pascal, Unit, require


@dataclass(frozen=True)
class Finger:
    """A fingertip resting on the surface.

    `contact_length` l0 along the wave (the contact is a square of that side, as in the paper's
    eq 13); ridges of `ridge_amplitude` h_e (half their height) and `ridge_period` L;
    `normal_force` F.
    """

    contact_length: Metre
    ridge_amplitude: Metre
    ridge_period: Metre
    normal_force: Newton

    def __post_init__(self) -> None:
        for name in ("contact_length", "ridge_period"):
            require(name, getattr(self, name), Unit("m"), above=0)
        require("ridge_amplitude", self.ridge_amplitude, Unit("m"), at_least=0)
        require("normal_force", self.normal_force, Unit("N"), above=0)

    @property
    def mean_pressure(self) -> Pascal:
        """P_f = F / l0² (paper eq 13)."""
        return self.normal_force / self.contact_length**2
