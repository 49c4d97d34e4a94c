"""Masks of speed and time: gates, attacks, decays, and what comes and goes.

`speed` reads like a sentence: ``texture.when(speed > 0.02)``, ``texture.when(speed < 0.1)``.
Time is that of the stroke or the contact, whatever the caller passes as `t`. Each raises
`InputError` for a value outside its range.
"""

from __future__ import annotations

import math
from dataclasses import field
from typing import Annotated, Literal

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render import opcodes
from squeezefilm.physics.render.opcodes import Assembler
from squeezefilm.physics.render.texture.pattern import Pattern, part

_SECOND = si.Unit("s")
_SPEED = si.Unit("m/s")
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
    below: si.MetrePerSecond | None = None
    type: Literal["speed_gate"] = field(default="speed_gate", repr=False)

    def __post_init__(self) -> None:
        if self.above is None and self.below is None:
            raise InputError("a speed gate needs a speed above or below which it is open")
        if self.below is not None:
            least = 0.0 if self.above is None else self.above
            si.require("below", self.below, _SPEED, above=least, at_most=_FASTEST)

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(opcodes.SPEED)
        # Infinity has no place in a file of numbers; no finite speed is above this one.
        high = 1e300 if self.below is None else self.below
        assembler.emit(opcodes.WITHIN, -1.0 if self.above is None else self.above, high)


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
    type: Literal["attack"] = field(default="attack", repr=False)

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(opcodes.TIME)
        assembler.emit(opcodes.RAMP, self.start, self.start + self.duration)


@part
class Decay(Pattern):
    """1 until `start`, then exp(−(t − start)/time_constant).

    Args:
        time_constant: of the fall (s); above 0, at most a day.
        start: when it begins (s); at least 0, at most a day.
    """

    time_constant: Annotated[si.Second, si.AtLeast(1e-06), si.AtMost(_LONGEST)]
    start: Annotated[si.Second, si.AtLeast(0.0), si.AtMost(_LONGEST)] = 0.0
    type: Literal["decay"] = field(default="decay", repr=False)

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(opcodes.TIME)
        assembler.emit(opcodes.DECAY, self.start, self.time_constant)


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
    type: Literal["periodic"] = field(default="periodic", repr=False)

    def _lower(self, assembler: Assembler) -> None:
        assembler.emit(opcodes.TIME)
        period, turns = 1.0 / self.frequency, self.phase / (2 * math.pi)
        if self.shape == "sine":
            assembler.emit(opcodes.SINE, period, turns)
        else:
            assembler.emit(opcodes.SQUARE, period, turns, self.duty)
