"""Models of friction, and the pad of a finger on a vibration: how film and asperities carry it."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import announce
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.core.hard_limits import FINGER_SPEED
from squeezefilm.core.materials import Gas
from squeezefilm.physics.chain.pad_place import PadPlace
from squeezefilm.physics.contact.finger.fingertip import EXPLORING_SPEED, Finger
from squeezefilm.physics.contact.finger.load import compiled_finger
from squeezefilm.physics.contact.rough_contact import ContactLaw, RoughContact
from squeezefilm.physics.contact.sharing.balance import require_balanced
from squeezefilm.physics.contact.sharing.gas_table import FilmTable, film_table
from squeezefilm.physics.contact.sharing.levitation import HIGHEST_AMPLITUDE
from squeezefilm.physics.contact.sharing.pad import Limit, PadFriction, pad_friction, pad_points
from squeezefilm.physics.display import Surface
from squeezefilm.physics.plate.loaded_mode import mean_square_wave

if TYPE_CHECKING:
    from squeezefilm.physics.contact.sharing.kernel import CompiledPad

FrictionModel = Literal[
    "paper2008",
    "paper2008-printed",
    "levitation-2016",
    "levitation-ridges",
    "partial-levitation",
    "levitation",
]
DEFAULT_MODEL: FrictionModel = "levitation"
"""The film lifts the contact off over a length fitted to people (decision 0018)."""


class ModelKind(NamedTuple):
    """Kind of a friction model by what it makes of film and skin.

    `friction` is what the model takes: the paper's closed form at an infinite squeeze number and a
    gap that does not yield ("asymptote"); or films that carry the finger together with asperities,
    at the gap where both balance the load. Of that it takes the part that asperities carry
    ("load"), or the closed form of 2016 ("lift"), while the balance only says what the plate feels
    of the finger. `fitted` is whether that has the finger's length, fitted to people and growing
    with the speed, or the constants published in 2016.
    """

    friction: Literal["asymptote", "load", "lift"]
    fitted: bool = False

    @property
    def shares_load(self) -> bool:
        """True where film and asperities share the load, at a gap that yields."""
        return self.friction != "asymptote"


MODEL_KINDS: dict[FrictionModel, ModelKind] = {
    "paper2008": ModelKind("asymptote"),
    "paper2008-printed": ModelKind("asymptote"),
    "levitation-2016": ModelKind("lift"),
    "levitation-ridges": ModelKind("lift", fitted=True),
    "partial-levitation": ModelKind("load"),
    "levitation": ModelKind("lift", fitted=True),
}


PascalPerMetreComplex = Annotated[complex, si.Unit("Pa/m")]


@si.checked_numbers
@dataclass(frozen=True)
class PadLaw:
    """Law by which film and asperities share the load of a pad, at one frequency and force.

    `position` is the pad's centre from an antinode, along a wave whose antinodes are all alike; a
    `place` on the face, with what the ridges meet there, stands in its stead, and amplitudes are
    still the best antinode's. `slip` is the gas's law of slip where the load is shared.
    Without a place the wave is even. Raises `InputError` for a position and a place.
    """

    surface: Surface
    finger: Finger
    gas: Gas
    half_wavelength: Annotated[si.Metre, si.Above(0)]
    frequency: Annotated[si.Hertz, si.Above(0)]
    normal_force: Annotated[si.Newton, si.Above(0)]
    model: FrictionModel
    position: si.Metre = 0.0
    speed: Annotated[si.MetrePerSecond, FINGER_SPEED] = EXPLORING_SPEED
    slip: str = "first"
    place: PadPlace | None = None

    def __post_init__(self) -> None:
        if self.position and self.place is not None:
            raise InputError("give a position along the wave or a place on the face, not both")

    @property
    def kind(self) -> ModelKind:
        """Kind of the model."""
        return MODEL_KINDS[self.model]

    @si.checked_numbers
    def sharing(self, amplitude: si.MetreLike, limit: Limit = "own") -> PadFriction:
        """Sharing of the load between film and asperities at amplitudes (m), whatever the model, in
        a limit of the skin."""
        met, shares = self.ridge_swings
        require_tabulated(amplitude, met)
        return self._pad(amplitude, met, shares, limit)

    @property
    def _films(self) -> FilmTable:
        return film_table(self.frequency, self.finger.plateau_width, self.gas, self.slip)

    @cached_property
    def asperities(self) -> ContactLaw:
        """Contact law of skin and surface."""
        return self.finger.asperity_law(self.surface.roughness)

    @property
    def contact_side(self) -> si.Metre:
        """The side of the square contact at this force (m)."""
        return float(np.sqrt(self.finger.contact_area(self.normal_force)))

    @property
    def contact_pressure(self) -> si.Pascal:
        """The finger's mean pressure on the contact at this force (Pa), grooves included."""
        return self.normal_force / self.finger.contact_area(self.normal_force)

    @si.checked_numbers
    def felt_stiffness(
        self, amplitude: Annotated[si.Metre, si.AtLeast(0.0)]
    ) -> PascalPerMetreComplex:
        """Stiffness of the finger that the plate feels per area of contact (Pa/m, complex) at an
        amplitude (m) of an even wave, wherever the pad is: of `sharing` what the vibration depends
        on, without the friction. See `finger.load.between`."""
        from squeezefilm.physics.contact.sharing import kernel

        met, known = self._even_swings[0], self._compiled
        require_tabulated(amplitude, met)
        rows, table = np.zeros((met.size, kernel.COLUMNS)), self._films
        while True:
            _, stiffness, lacking = kernel.felt_stiffness(amplitude, known, table.compiled, rows)
            if lacking < 0:
                break
            table.build(lacking)
        if lacking == -2:
            swings, alike = amplitude * met, np.full(met.size, known.pressure)
            with self._named_force():
                require_balanced(rows, self.asperities, swings, alike)
        return complex(stiffness)

    def __getstate__(self) -> dict[str, object]:
        """State to be pickled, without the form for compiled code, whose tables are made anew."""
        return {name: value for name, value in vars(self).items() if name != "_compiled"}

    @cached_property
    def _compiled(self) -> CompiledPad:
        """The pad on an even wave as the compiled code takes it."""
        from squeezefilm.physics.contact.sharing import kernel

        announce(kernel.felt_stiffness, "stiffness under the finger", 20)
        finger, law = self.finger, self.asperities
        share, (met, shares) = finger.plateau_width / finger.ridge_period, self._even_swings
        return kernel.CompiledPad(
            kernel.CompiledRidges(met, shares),
            finger.plateau_pressure(self.normal_force),
            compiled_finger(finger.plateau_width, self.frequency, self.gas, finger.skin, share),
            law.least_gap if isinstance(law, RoughContact) else -math.inf,
            law.compiled(),
        )

    @property
    def mean_square(self) -> si.Dimensionless:
        """The mean square over the contact of the amplitude over the best antinode's."""
        if self.place is None:
            return self.mean_square_even
        met, shares = self.ridge_swings
        return float(met**2 @ shares)

    @property
    def mean_square_even(self) -> si.Dimensionless:
        """The same of an even wave, wherever the pad is."""
        return mean_square_wave(self.half_wavelength, self.contact_side, self.position)

    @cached_property
    def ridge_swings(self) -> tuple[si.DimensionlessArray, si.DimensionlessArray]:
        """The amplitudes that ridges meet over the best antinode's, and the shares that meet them:
        those of an even wave, or, at a place, few that stand for them all."""
        if self.place is None:
            return self._even_swings
        return self.place.met(self.finger, self.contact_side)

    @cached_property
    def largest_amplitude(self) -> si.Metre:
        """The amplitude (m, zero-to-peak) up to which no ridge meets more than 50 µm: less than
        that itself where the face at the place moves further than the antinode."""
        return HIGHEST_AMPLITUDE / max(1.0, float(np.max(self.ridge_swings[0])))

    @cached_property
    def _even_swings(self) -> tuple[si.DimensionlessArray, si.DimensionlessArray]:
        """The same of an even wave, wherever the pad is."""
        points = pad_points(self.finger, self.contact_side)
        phase = np.pi * (points.along + self.position) / self.half_wavelength
        wave: si.DimensionlessArray = np.abs(np.cos(phase))
        kinds, alike = np.unique(np.round(wave, 9), return_inverse=True)
        return kinds, np.bincount(alike, weights=points.shares).astype(float)

    @cached_property
    def friction_coefficient(self) -> si.Dimensionless:
        """µ without vibration, at this force. See `Finger.friction_coefficient`."""
        return self.finger.friction_coefficient(
            self.surface.friction_coefficient, self.surface.roughness, self.normal_force
        )

    def _pad(
        self,
        amplitude: si.MetreLike,
        met: si.DimensionlessArray,
        shares: si.DimensionlessArray,
        limit: Limit,
    ) -> PadFriction:
        with self._named_force():
            return pad_friction(
                self._films,
                self.asperities,
                amplitude,
                met,
                shares,
                self.finger.plateau_pressure(self.normal_force),
                limit,
            )

    @contextlib.contextmanager
    def _named_force(self) -> Iterator[None]:
        """Name the force in what is refused as out of range."""
        try:
            yield
        except OutOfRangeError as error:
            shown = si.format_quantity(self.normal_force, si.Unit("N"))
            raise OutOfRangeError(f"under a normal force of {shown}: {error}") from error


def require_tabulated(amplitude: si.MetreLike, met: si.DimensionlessArray) -> None:
    """Refuse what ridges cannot meet: films at such swings take minutes to tabulate, and no plate
    moves so far."""
    most = float(np.max(amplitude)) * float(np.max(met))
    if most > HIGHEST_AMPLITUDE * (1 + 1e-9):
        shown, highest = (
            si.format_quantity(length, si.Unit("m")) for length in (most, HIGHEST_AMPLITUDE)
        )
        raise OutOfRangeError(
            f"a ridge would meet an amplitude of {shown}; friction is known up to {highest}. "
            "Vibrate less, or take a place where the face moves less"
        )
