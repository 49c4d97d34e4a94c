"""Fidelity as a number: which spatial periods survive the resonator at which finger speeds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.physics.render.fidelity.trace import (
    FrictionTrace,
    RelativeFriction,
    friction_trace,
    period_of,
)
from squeezefilm.physics.render.motion.stroke import Stroke
from squeezefilm.physics.render.resonator.envelope import (
    Shape,
    fastest_speed,
    finest_period,
    sine_swing_kept,
    square_swing_kept,
)
from squeezefilm.physics.render.texture.levels import Amplitude
from squeezefilm.physics.render.texture.shapes import SineWave, SquareWave

PAPER_PERIODS: tuple[si.Metre, ...] = (0.4e-3, 2e-3, 4e-3, 8e-3, 10e-3)
"""Spatial periods of the paper's match-to-sample experiment (m)."""

EXPLORING_SPEEDS: tuple[si.MetrePerSecond, ...] = (0.01, 0.02, 0.05, 0.1, 0.2)
"""Finger speeds from slow to brisk exploration (m/s)."""

# After fifteen time constants 3e-7 of a transient is left: nothing even beside a swing of which
# only a hundredth is kept.
_SETTLING = 15
_PERIODS_SHOWN = 2

Signal = Literal["amplitude", "relative_friction"]


def swing_kept(trace: FrictionTrace, signal: Signal = "amplitude") -> si.Dimensionless:
    """Swing (peak to peak) rendered, divided by the swing wanted, measured on a trace (1).

    Only settled stretches count: the first 15 time constants of every pass, the start and the
    turns of the finger, are left out. Friction bends with amplitude, so the share of friction
    swing kept differs from that of amplitude: what the resonator shaves off both ends of a swing
    costs more friction where the law is steepest at its ends (an exponential fall: less is kept),
    and less where it is steepest in the middle (an S-shaped fall: more is kept). The peaks may be
    left where most of the wave is not: see `fundamental_kept`.

    Raises:
        InputError: passes too short to settle and then show a whole period, a wanted signal that
            does not change, or an unknown signal.
    """
    wanted, rendered = _settled(trace, signal)
    return _swing(rendered) / _swing(wanted)


def fundamental_kept(trace: FrictionTrace, signal: Signal = "amplitude") -> si.Dimensionless:
    """The wave of the grating's own period rendered, divided by that wanted, on a trace (1).

    Measured over the last whole periods of the settled stretch, wherever along x the wave lies.

    Raises:
        InputError: as `swing_kept`, and for a texture that is no grating along x.
    """
    period = period_of(trace.texture)
    if period is None:
        raise InputError("the texture has no period, so it has no fundamental; take a grating")
    wanted, rendered = _settled(trace, signal)
    rate = trace.sample_rate * period / trace.stroke.speed
    count = round(rate * max(1, int(wanted.size / rate + 1e-6)))
    wave = np.exp(-2j * np.pi * np.arange(count) / rate)
    of_wanted, of_rendered = (
        abs(complex(wave @ (one[-count:] - np.mean(one[-count:])))) for one in (wanted, rendered)
    )
    return of_rendered / of_wanted


def _settled(trace: FrictionTrace, signal: Signal) -> tuple[si.FloatArray, si.FloatArray]:
    """Wanted and rendered signal where a trace has settled. Raises as `swing_kept`."""
    if signal == "amplitude":
        wanted, rendered = trace.command, trace.amplitude
    elif signal == "relative_friction":
        wanted, rendered = trace.relative_friction_wanted, trace.relative_friction_rendered
    else:
        raise InputError(
            f"signal = {signal!r} is not known; it must be 'amplitude' or 'relative_friction'"
        )
    stroke, settling = trace.stroke, _SETTLING * trace.time_constant
    needed = settling * stroke.speed + (period_of(trace.texture) or 0.0)
    if stroke.length < needed * (1 - 1e-9):
        raise InputError(
            f"passes of {si.format_quantity(stroke.length, si.Unit('m'))} are too short to measure "
            f"a swing: at {si.format_quantity(stroke.speed, si.Unit('m/s'))} settling and one "
            f"period take {si.format_quantity(needed, si.Unit('m'))}; lengthen the stroke or slow "
            "it down"
        )
    settled = np.mod(trace.time, stroke.pass_duration) >= settling
    if _swing(wanted[settled]) == 0:
        raise InputError(
            f"the {signal.replace('_', ' ')} wanted does not change along the stroke, so no share "
            "of its swing can be kept; choose a texture, or amplitudes low and high, that change it"
        )
    return wanted[settled], rendered[settled]


def _swing(values: si.FloatArray) -> float:
    return float(np.max(values) - np.min(values)) if values.size else 0.0


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False)
class FidelityTable:
    """Which spatial periods keep their swing at which finger speeds.

    Attributes:
        shape, low, high, time_constant: the grating (amplitudes in m, zero-to-peak) and the
            envelope's time constant (s); a square has equal grooves and ridges.
        kept: the share of its swing a grating must keep to survive (1).
        spatial_periods: rows (m), shape (p,).
        speeds: columns (m/s), shape (v,).
        amplitude_kept: share of the swing of amplitude, peak to peak, closed form (1), shape
            (p, v).
        friction_kept: share of the swing of relative friction, peak to peak, measured on traces
            (1), shape (p, v).
        amplitude_fundamental, friction_fundamental: the same of the wave of the grating's own
            period (1), shape (p, v).
        finest_period: finest period whose amplitude survives at each speed (m), shape (v,).
        fastest_speed: fastest finger under which the amplitude of each period survives (m/s),
            shape (p,).
        lag: by which the texture trails the finger at each speed, τ·v (m), shape (v,).
        model: the model of the resonator.
    """

    shape: Shape
    low: si.Metre
    high: si.Metre
    time_constant: si.Second
    kept: si.Dimensionless
    spatial_periods: si.MetreArray
    speeds: si.MetrePerSecondArray
    amplitude_kept: si.DimensionlessArray
    friction_kept: si.DimensionlessArray
    amplitude_fundamental: si.DimensionlessArray
    friction_fundamental: si.DimensionlessArray
    finest_period: si.MetreArray
    fastest_speed: si.MetrePerSecondArray
    lag: si.MetreArray
    model: str = "first-order envelope at resonance, open loop"

    @property
    def amplitude_survives(self) -> Annotated[NDArray[np.bool_], si.Unit("1")]:
        """True where each period keeps its swing of amplitude at each speed, shape (p, v)."""
        return self.amplitude_kept >= self.kept

    @property
    def fundamental_at_limit(self) -> si.Dimensionless:
        """Share of the fundamental of amplitude left of a grating that just survives (1)."""
        period = finest_period(1.0, self.time_constant, self.kept, self.shape)
        return float(sine_swing_kept(period, 1.0, self.time_constant))


@si.checked_numbers
def fidelity_table(
    time_constant: Annotated[si.Second, si.Above(0.0)],
    relative_friction: RelativeFriction,
    *,
    low: si.Metre,
    high: si.Metre,
    shape: Shape = "square",
    kept: si.Dimensionless = 0.9,
    spatial_periods: Sequence[si.Metre] | si.MetreArray = PAPER_PERIODS,
    speeds: Sequence[si.MetrePerSecond] | si.MetrePerSecondArray = EXPLORING_SPEEDS,
) -> FidelityTable:
    """Which spatial periods keep a share `kept` of their swing at which finger speeds.

    Amplitude from the closed forms of `envelope`; friction measured on a trace of the settled
    grating, two periods long, so that the table doesn't depend on how long a stroke is.

    Args:
        time_constant: of the resonator's envelope (s).
        relative_friction: vibration amplitudes (m, zero-to-peak) and the finger's signed speed
            (m/s), each of shape (n,) → relative friction (1; the same shape). Called twice per cell
            with up to some 10⁶ samples: pass a table of a friction law that is slow.
        low, high: vibration amplitudes between which the grating changes (m, zero-to-peak).
        shape: "square" (equal grooves and ridges) or "sine".
        kept: share of the swing to keep (1); above 0, below 1.
        spatial_periods: rows (m).
        speeds: columns (m/s).

    Raises:
        InputError: a value outside its range, no period or no speed, or a friction that doesn't
            change between `low` and `high`.
    """
    periods = _axis("spatial_periods", spatial_periods, si.Unit("m"))
    columns = _axis("speeds", speeds, si.Unit("m/s"))
    finest = np.asarray(finest_period(columns, time_constant, kept, shape))
    fastest = np.asarray(fastest_speed(periods, time_constant, kept, shape))
    law = square_swing_kept if shape == "square" else sine_swing_kept
    amplitude = np.asarray(law(periods[:, None], columns, time_constant))
    friction, friction_wave = np.empty((2, *amplitude.shape))
    for row, period in enumerate(periods.tolist()):
        wave = SquareWave(period) if shape == "square" else SineWave(period)
        texture = Amplitude(wave, low, high)
        for column, speed in enumerate(columns.tolist()):
            length = _PERIODS_SHOWN * period + _SETTLING * time_constant * speed
            trace = friction_trace(texture, Stroke(speed, length), time_constant, relative_friction)
            friction[row, column] = swing_kept(trace, "relative_friction")
            friction_wave[row, column] = fundamental_kept(trace, "relative_friction")
    return FidelityTable(
        shape=shape,
        low=low,
        high=high,
        time_constant=time_constant,
        kept=kept,
        spatial_periods=periods,
        speeds=columns,
        amplitude_kept=amplitude,
        friction_kept=friction,
        # The envelope is linear, so each wave of a grating is damped as if it were alone.
        amplitude_fundamental=np.asarray(sine_swing_kept(periods[:, None], columns, time_constant)),
        friction_fundamental=friction_wave,
        finest_period=finest,
        fastest_speed=fastest,
        lag=time_constant * columns,
    )


def _axis(name: str, values: Sequence[float] | si.FloatArray, unit: si.Unit) -> si.FloatArray:
    array = np.array(values, dtype=float)
    if array.ndim != 1 or array.size == 0:
        raise InputError(
            f"{name} of shape {array.shape} cannot be used: give a list of at least one"
        )
    si.require(name, array, unit, above=0.0)
    return array
