"""Friction under a moving finger: a texture, a stroke and a slow resonator put together."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.motion.stroke import Stroke
from squeezefilm.physics.render.resonator.envelope import envelope_response
from squeezefilm.physics.render.texture.composition import Composable, Texture

RelativeFriction = Callable[[si.MetreArray, si.MetrePerSecondArray], si.DimensionlessArray]
"""Vibration amplitude (m, zero-to-peak) and the finger's signed speed (m/s), each of shape (n,) →
friction divided by that of the unexcited surface (1), of the same shape."""

# 50 samples a time constant draw the exponential smoothly; 128 a period put the extremes of a
# sine within 3e-4 of its swing.
_PER_TIME_CONSTANT = 50
_PER_PERIOD = 128
_PER_STROKE = 1000
_FEWEST_PER_PERIOD = 4


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class FrictionTrace:
    """What a finger meets along a stroke, wanted and rendered; arrays of shape (samples,).

    Attributes:
        texture, stroke, time_constant, sample_rate: the inputs (time constant in s, rate in Hz).
        model: the model of the resonator.
        time: since the stroke began (s).
        position: of the finger along x (m).
        command: vibration amplitude the texture wants at `position` (m, zero-to-peak).
        amplitude: vibration amplitude the resonator has there (m, zero-to-peak).
        relative_friction_wanted: relative friction at `command` (1).
        relative_friction_rendered: relative friction at `amplitude` (1).
    """

    texture: Texture
    stroke: Stroke
    time_constant: si.Second
    sample_rate: si.Hertz
    time: si.SecondArray
    position: si.MetreArray
    command: si.MetreArray
    amplitude: si.MetreArray
    relative_friction_wanted: si.DimensionlessArray
    relative_friction_rendered: si.DimensionlessArray
    model: str = "first-order envelope at resonance, open loop"

    @property
    def lag(self) -> si.Metre:
        """How far behind the finger the texture trails (m): τ·v.

        The delay of a slow pattern; a pattern as fast as the envelope's bandwidth trails less (a
        sine by arctan(ωτ)/ω in time), but has lost swing.
        """
        return self.time_constant * self.stroke.speed


@si.checked_numbers
def friction_trace(
    texture: Texture,
    stroke: Stroke,
    time_constant: Annotated[si.Second, si.Above(0.0)],
    relative_friction: RelativeFriction,
    sample_rate: si.Hertz | None = None,
) -> FrictionTrace:
    """The friction a finger meets along a stroke over a texture, wanted and rendered.

    The texture's amplitude at the middle of each step is held over that step and passed through
    the resonator exactly (`envelope_response`); the amplitude begins settled at what the texture
    wants where the stroke starts, as if the finger had rested there. The stroke runs along y = 0.
    Friction is quasi-static: it follows amplitude and speed at once, which leaves out the skin's
    own transient (some 20 ms, PHYSICS §5).

    Args:
        texture: vibration amplitude wanted, by position, velocity and time.
        stroke: the finger's motion.
        time_constant: of the resonator's envelope (s), see `envelope_time_constant`.
        relative_friction: vibration amplitudes (m, zero-to-peak) and the stroke's velocity (m/s),
            each of shape (n,) → relative friction (1; the same shape). Called twice.
        sample_rate: of the trace (Hz). Without one: 50 samples a time constant, 128 a spatial
            period and 1000 a stroke at least, and for a grating along x a whole even number a
            period, so that the edges of a grating of duty ½ and phase 0 fall on samples. Otherwise
            an edge is misplaced by up to one step.

    Raises:
        InputError: a time constant or rate not above 0, a rate below 4 samples a spatial period,
            more than 20 million samples, a texture or friction whose values are not finite, are
            negative or have another shape than what they were given.
    """
    if isinstance(texture, Composable) and texture.quantity != "amplitude":
        raise InputError(
            f"a texture of {texture.quantity} commands no amplitude; pass "
            "Played(lower(texture, inverse=…)), the amplitude that a display plays it with"
        )
    rate = _rate(texture, stroke, time_constant, sample_rate)
    time, position = stroke.sampled(rate)
    wanted = texture(position, 0.0, stroke.velocity(time), time)
    command = per_sample("texture", wanted, time, si.Unit("m"))
    middle = time[:-1] + 0.5 / rate
    held = texture(stroke.position(middle), 0.0, stroke.velocity(middle), middle)
    # The last sample's command is held over a step that nobody sees.
    steps = np.append(per_sample("texture", held, middle, si.Unit("m")), command[-1])
    amplitude = envelope_response(steps, 1 / rate, time_constant, initial=float(command[0]))
    return FrictionTrace(
        texture=texture,
        stroke=stroke,
        time_constant=time_constant,
        sample_rate=rate,
        time=time,
        position=position,
        command=command,
        amplitude=amplitude,
        relative_friction_wanted=friction_of(relative_friction, command, stroke.velocity(time)),
        relative_friction_rendered=friction_of(relative_friction, amplitude, stroke.velocity(time)),
    )


def period_of(texture: Texture) -> si.Metre | None:
    """The period of a grating along x (m); None for any other texture."""
    period: si.Metre | None = getattr(texture, "spatial_period", None)
    return period


def _rate(
    texture: Texture, stroke: Stroke, time_constant: si.Second, sample_rate: si.Hertz | None
) -> si.Hertz:
    period = period_of(texture)
    passed = None if period is None else stroke.speed / period
    if sample_rate is None:
        rate = max(_PER_TIME_CONSTANT / time_constant, _PER_STROKE / stroke.duration)
        if passed is None:
            return rate
        halves = np.ceil(max(rate / passed, _PER_PERIOD) / 2)
        return float(2 * halves * passed)
    si.require("sample_rate", sample_rate, si.Unit("Hz"), above=0.0)
    if passed is not None and sample_rate < _FEWEST_PER_PERIOD * passed:
        raise InputError(
            f"sample_rate = {si.format_quantity(sample_rate, si.Unit('Hz'))} cannot show a grating "
            f"that passes {si.format_quantity(passed, si.Unit('Hz'))} times a second: it must be "
            f"at least {si.format_quantity(_FEWEST_PER_PERIOD * passed, si.Unit('Hz'))}; leave it "
            "out for one that fits"
        )
    return sample_rate


def friction_of(
    law: RelativeFriction, amplitude: si.MetreArray, speed: si.MetrePerSecondArray
) -> si.DimensionlessArray:
    """What a law says at amplitudes (m) and speeds (m/s), as `per_sample` lets it pass (1)."""
    return per_sample("relative_friction", law(amplitude, speed), amplitude, si.Unit("1"))


def per_sample(
    name: str, values: si.FloatArray, given: si.FloatArray, unit: si.Unit
) -> si.FloatArray:
    """What a callable `name` returned where samples were `given`.

    Raises `InputError` unless that is one finite value, at least 0, per sample.
    """
    array = si.returned(name, values, given, "one value per sample")
    si.require(f"a value returned by {name}", array, unit, at_least=0.0)
    return array
