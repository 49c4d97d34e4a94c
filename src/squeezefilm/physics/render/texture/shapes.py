"""Shapes in space: constant, gratings, pulse, ramp, band, and the slope of a bump or a hole.

Each raises `InputError` for a value outside its range.
"""

from __future__ import annotations

import math
from dataclasses import field
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.opcodes import (
    BAND,
    BUMP,
    CONSTANT,
    GAUSSIAN,
    HANN,
    RAMP,
    SINE,
    SMOOTH,
    SQUARE,
    Assembler,
)
from squeezefilm.physics.render.texture.coordinate import (
    METRE,
    X_AXIS,
    Coordinate,
    FromPoint,
    Length,
    Place,
    require_coordinate,
    require_fade,
)
from squeezefilm.physics.render.texture.pattern import Pattern, part

# Full width at half height of a Gaussian, in standard deviations.
_FULL_WIDTH = 2.0 * math.sqrt(2.0 * math.log(2.0))


@part
class Constant(Pattern):
    """The same `share` (1, from 0 to 1) everywhere. Raises `InputError` outside that."""

    share: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)] = 1.0
    type: Literal["constant"] = field(default="constant", repr=False)

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(CONSTANT, self.share)


class _Along(Pattern):
    """Base of a shape along a coordinate: it is one."""

    __slots__ = ()
    along: Coordinate

    def __post_init__(self) -> None:
        require_coordinate(self.along)


@part
class SquareWave(_Along):
    """1 over the first `duty` of every period, 0 over the rest.

    1 where ``(s/spatial_period + phase/2π) mod 1 < duty``, s being the coordinate `along`.

    `spatial_period` is one whole period, groove plus ridge. The source paper calls 0.4 to 10 mm
    both the "space period" of its gratings and the width of their grooves *and* of their ridges;
    if the latter is meant (groove width = ridge width = w), the period is 2w. A grating whose
    grooves (at 1) and ridges (at 0) have two widths g and r has the period g + r and the duty
    g/(g + r). In an `Amplitude` a stretch at 1 is slippery, so it plays the groove.

    Args:
        spatial_period: one whole period (m); from 1 nm to 0.5 m.
        duty: share of the period at 1; above 0, below 1.
        phase: shifts the pattern back by phase/2π of a period (rad).
        along: the coordinate it runs along.
    """

    spatial_period: Length
    duty: Annotated[si.Dimensionless, si.Above(0.0), si.Below(1.0)] = 0.5
    phase: si.Radian = 0.0
    along: Coordinate = X_AXIS
    type: Literal["square_wave"] = field(default="square_wave", repr=False)

    def _lower(self, assembler: Assembler) -> None:
        self.along._lower(assembler)
        assembler.emit(SQUARE, self.spatial_period, self.phase / (2 * math.pi), self.duty)


@part
class SineWave(_Along):
    """½ + ½ sin(2πs/spatial_period + phase), s being the coordinate `along`.

    Args and errors as for `SquareWave`.
    """

    spatial_period: Length
    phase: si.Radian = 0.0
    along: Coordinate = X_AXIS
    type: Literal["sine_wave"] = field(default="sine_wave", repr=False)

    def _lower(self, assembler: Assembler) -> None:
        self.along._lower(assembler)
        assembler.emit(SINE, self.spatial_period, self.phase / (2 * math.pi))


@part
class Pulse(_Along):
    """A localised rise to 1 at `centre`, ½ at `width`/2 to either side.

    Args:
        centre: its place (m), within ±10 m.
        width: full width at half height (m); from 1 nm to 0.5 m.
        shape: "gaussian", or "raised_cosine", which is 0 from `width` on.
        along: the coordinate it lies on; from a point it is a ring.
    """

    centre: Place
    width: Length
    shape: Literal["gaussian", "raised_cosine"] = "gaussian"
    along: Coordinate = X_AXIS
    type: Literal["pulse"] = field(default="pulse", repr=False)

    def _lower(self, assembler: Assembler) -> None:
        self.along._lower(assembler)
        if self.shape == "gaussian":
            assembler.emit(GAUSSIAN, self.centre, self.width / _FULL_WIDTH)
        else:
            assembler.emit(HANN, self.centre, self.width)


@part
class Ramp(_Along):
    """Rise from 0 at `start` to 1 at `end`, held beyond; falling if `end` lies before `start`.

    Args:
        start, end: its ends (m), within ±10 m and not the same.
        profile: "linear", or "smooth" (the cubic 3u² − 2u³, level at both ends).
        along: the coordinate it runs along.
    """

    start: Place
    end: Place
    profile: Literal["linear", "smooth"] = "linear"
    along: Coordinate = X_AXIS
    type: Literal["ramp"] = field(default="ramp", repr=False)

    def __post_init__(self) -> None:
        _Along.__post_init__(self)
        if abs(self.end - self.start) < 1e-9:
            raise InputError(
                "start and end of a ramp are the same; they must be a nanometre apart at least; "
                "take a Band for a step",
                quantity="end",
            )

    def _lower(self, assembler: Assembler) -> None:
        self.along._lower(assembler)
        assembler.emit(RAMP, self.start, self.end)
        if self.profile == "smooth":
            assembler.emit(SMOOTH)


@part
class Band(_Along):
    """1 from `start` to `end`, 0 outside, with edges linear over `fade`: a mask in space.

    With `fade` 0 the start belongs to the band and the end does not, so that bands side by side
    neither overlap nor leave a seam. `Band.disc` makes a round mask.

    Args:
        start, end: its ends (m), within ±10 m, `start` below `end`.
        fade: width of each edge (m), centred on it; 0, or from 1 nm to the band's width.
        along: the coordinate it lies on; from a point it is a ring.
    """

    start: Place
    end: Place
    fade: si.Metre = 0.0
    along: Coordinate = X_AXIS
    type: Literal["band"] = field(default="band", repr=False)

    def __post_init__(self) -> None:
        si.require("end", self.end, METRE, above=self.start)
        require_fade(self.fade, self.end - self.start)
        _Along.__post_init__(self)

    @classmethod
    @reads_text
    @si.checked_numbers
    def disc(
        cls,
        x: si.Metre,
        y: si.Metre,
        radius: Annotated[si.Metre, si.Above(0.0)],
        fade: si.Metre = 0.0,
    ) -> Band:
        """1 within `radius` (m) of the point (`x`, `y`) (m)."""
        return cls(-radius, radius, fade, FromPoint(x, y))

    def _lower(self, assembler: Assembler) -> None:
        self.along._lower(assembler)
        assembler.emit(BAND, self.start, self.end, self.fade)


@part
class Bump(_Along):
    """The slope of a Gaussian bump or hole, felt as its shape: ½ far away, 1 and 0 on its flanks.

    Lateral force alone makes a flat surface feel like a bump or a hole: it resists on the way up
    and helps on the way down (Robles-De-La-Torre & Hayward 2001, Nature 412, 445). Friction
    cannot push, so here it stands between a resting level (½) and rises before the centre of a
    bump and falls after it; a hole is the reverse. With d = (s − centre)/width,

        ½ ∓ ½ d exp(½(1 − d²)),

    the upper sign for a bump. "Before" depends on the way the finger goes: for v < 0 the sides
    are exchanged, so pass v negative where the finger goes back along the coordinate. As a
    pattern this is greater where friction should be greater: use it in `RelativeFriction`, and
    complemented (~) in `FrictionReduction` or `Amplitude`.

    Args:
        centre: of the Gaussian (m), within ±10 m.
        width: its standard deviation (m), at which the slope is steepest; from 1 nm to 0.5 m.
        kind: "bump" or "hole".
        along: the coordinate it lies on.
    """

    centre: Place
    width: Length
    kind: Literal["bump", "hole"] = "bump"
    along: Coordinate = X_AXIS
    type: Literal["bump"] = field(default="bump", repr=False)

    def _lower(self, assembler: Assembler) -> None:
        self.along._lower(assembler)
        assembler.emit(BUMP, self.centre, self.width, self._sign)

    @property
    def _sign(self) -> float:
        return 1.0 if self.kind == "bump" else -1.0
