"""Patterns of place, speed and time: shapes in space, gates of speed, what comes and goes in time.

`speed` reads like a sentence: ``texture.when(speed > 0.02)``, ``texture.when(speed < 0.1)``.
Time is that of the stroke or the contact, whatever the caller passes as `t`. Each raises
`InputError` for a value outside its range.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.opcodes import (
    BAND,
    BUMP,
    CONSTANT,
    DECAY,
    GAUSSIAN,
    HANN,
    RAMP,
    SINE,
    SMOOTH,
    SPEED,
    SQUARE,
    TIME,
    WITHIN,
    Assembler,
)
from squeezefilm.physics.render.texture.pattern import (
    X_AXIS,
    Coordinate,
    FromPoint,
    Length,
    Pattern,
    Place,
    part,
    require_fade,
)

# Full width at half height of a Gaussian, in standard deviations.
_FULL_WIDTH = 2.0 * math.sqrt(2.0 * math.log(2.0))


@part
class Constant(Pattern):
    """The same `share` (1, from 0 to 1) everywhere. Raises `InputError` outside that."""

    share: Annotated[si.Dimensionless, si.AtLeast(0.0), si.AtMost(1.0)] = 1.0

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(CONSTANT, self.share)


class _Along(Pattern):
    """Base of a shape along a coordinate: it is one."""

    __slots__ = ()
    along: Coordinate


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

    def __post_init__(self) -> None:
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
    end: Annotated[Place, si.Above("start")]
    fade: si.Metre = 0.0
    along: Coordinate = X_AXIS

    def __post_init__(self) -> None:
        require_fade(self.fade, self.end - self.start)

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

    def _lower(self, assembler: Assembler) -> None:
        self.along._lower(assembler)
        sign = 1.0 if self.kind == "bump" else -1.0
        assembler.emit(BUMP, self.centre, self.width, sign)


_FASTEST: si.MetrePerSecond = 1000.0
_LONGEST: si.Second = 86_400.0


@part
class SpeedGate(Pattern):
    """1 while the finger's speed |v| is above `above` and below `below`, else 0.

    Args:
        above, below: speeds (m/s), `above` the lesser; at least 0, at most 1000 m/s (which no
            finger reaches: leave it for no upper end). A finger at rest is above no speed: with
            `above` left out, the gate is open at rest too.
    """

    above: Annotated[si.MetrePerSecond, si.AtLeast(0.0), si.Below(_FASTEST)] | None = None
    below: (
        Annotated[si.MetrePerSecond, si.Above(0.0), si.Above("above"), si.AtMost(_FASTEST)] | None
    ) = None

    def __post_init__(self) -> None:
        if self.above is None and self.below is None:
            raise InputError("a speed gate needs a speed above or below which it is open")

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(SPEED)
        # Infinity has no place in a file of numbers; no finite speed is above this one.
        high = 1e300 if self.below is None else self.below
        assembler.emit(WITHIN, -1.0 if self.above is None else self.above, high)


class Speed:
    """The finger's speed in a comparison: ``speed > 0.02`` is the gate open above 20 mm/s."""

    __slots__ = ()

    def __gt__(self, other: si.MetrePerSecond) -> SpeedGate:
        return SpeedGate(above=other)

    def __lt__(self, other: si.MetrePerSecond) -> SpeedGate:
        return SpeedGate(below=other)


speed = Speed()
"""The finger's speed, for ``texture.when(speed > 0.02)``; ~ and & join comparisons."""


@part
class Attack(Pattern):
    """Rises linearly from 0 at `start` to 1 after `duration`, and stays.

    Args:
        duration: of the rise (s); above 0, at most a day.
        start: when it begins (s); at least 0, at most a day.
    """

    duration: Annotated[si.Second, si.AtLeast(1e-06), si.AtMost(_LONGEST)]
    start: Annotated[si.Second, si.AtLeast(0.0), si.AtMost(_LONGEST)] = 0.0

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(TIME)
        assembler.emit(RAMP, self.start, self.start + self.duration)


@part
class Decay(Pattern):
    """1 until `start`, then exp(−(t − start)/time_constant).

    Args:
        time_constant: of the fall (s); above 0, at most a day.
        start: when it begins (s); at least 0, at most a day.
    """

    time_constant: Annotated[si.Second, si.AtLeast(1e-06), si.AtMost(_LONGEST)]
    start: Annotated[si.Second, si.AtLeast(0.0), si.AtMost(_LONGEST)] = 0.0

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(TIME)
        assembler.emit(DECAY, self.start, self.time_constant)


@part
class Periodic(Pattern):
    """A square or a sine of time: what comes and goes `frequency` times a second.

    Args:
        frequency: above 0, at most 2 kHz (a resonator's envelope follows less; Hz).
        shape: "square", 1 over the first `duty` of every period, or "sine", ½ + ½ sin.
        duty: share of the period at 1, square only; above 0, below 1.
        phase: shifts it earlier by phase/2π of a period (rad).
    """

    frequency: Annotated[si.Hertz, si.AtLeast(1e-06), si.AtMost(2000.0)]
    shape: Literal["square", "sine"] = "square"
    duty: Annotated[si.Dimensionless, si.Above(0.0), si.Below(1.0)] = 0.5
    phase: si.Radian = 0.0

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(TIME)
        period, turns = 1.0 / self.frequency, self.phase / (2 * math.pi)
        if self.shape == "sine":
            assembler.emit(SINE, period, turns)
        else:
            assembler.emit(SQUARE, period, turns, self.duty)
