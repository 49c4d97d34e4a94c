"""Preparation of `squeezefilm play`: texture, display and drive as a loop's plan."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import announce
from squeezefilm.core.drive_limits import Limits
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.control.gains import IdentifiedPlate, LoopAims
from squeezefilm.instruments.session.loop.plan import LoopCompensation, LoopPlan
from squeezefilm.instruments.session.loop.tick import make_tick
from squeezefilm.instruments.session.play.plan import (
    NOTHING_KNOWN,
    KnownDevice,
    PlayMode,
    PlayPlan,
    tile_of,
)
from squeezefilm.physics.chain.played_texture import lowered
from squeezefilm.physics.chain.prediction import Prediction, predict
from squeezefilm.physics.display import Display
from squeezefilm.physics.render.motion.estimator import MotionEstimator
from squeezefilm.physics.render.resonator.envelope import DrivenEnvelope, envelope_time_constant
from squeezefilm.physics.texture_files.texture_file import TextureFile

OUTPUT_DELAY: si.Second = 6e-3
"""Time from a tick to its command at the plate: the player's pause, a block's length, the link and
what its jitter may be (assumed; commands that come later than this are counted, and not played)."""
_SEARCHED, _SEARCH_SHARE = 8.0, 0.1
"""Half-bandwidths above the resonance from which a search comes; of the voltage in it."""
_PICKUP_NOISE: si.Volt = 1e-3
"""Noise of each quadrature in a tick (assumed); the loops learn less at amplitudes near it. A sweep
that averages over more than a tick shows less, which is not believed."""
_TILE_WAY: tuple[si.Metre, si.Metre] = (0.0, 0.1)
"""Where a tile lies for a finger whose way is not known."""


@si.checked_numbers
@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class HowToPlay:
    """What may be chosen of how a texture is played, see `play.play_texture`.

    Where the device's loops `hold`, levels are those of the free plate, and what the plate's
    slowness is compensated for is the loops'.
    """

    mode: PlayMode = "stream"
    rate: si.Hertz = 5e3
    voltage: si.Volt | None = None
    surface: str | None = None
    compensation: LoopCompensation = "none"
    hold: bool = False


_AS_USUAL = HowToPlay()


@dataclass(frozen=True, slots=True, eq=False)
class PlaySetup:
    """A texture on a display, ready to be played.

    Attributes:
        display, texture, prediction: the inputs, and the display at its largest voltage.
        plan: for the player.
    """

    display: Display
    texture: TextureFile
    prediction: Prediction
    plan: PlayPlan

    @property
    def name(self) -> str:
        """Name of the texture."""
        return self.texture.title or f"a texture of {self.texture.texture.quantity}"

    @property
    def assumed_limits(self) -> tuple[str, ...]:
        """Names of the drive's limits that the display does not give."""
        return self.display.drive.assumed_limits

    def friction(
        self, amplitude: si.MetreArray, speed: si.MetrePerSecondArray
    ) -> si.DimensionlessArray:
        """Relative friction (1) by the display's law at amplitudes (m, held beyond the largest)
        under a finger at speeds (m/s); not a number where one of them is none."""
        known = np.isfinite(amplitude) & np.isfinite(speed)
        relative = np.full(np.shape(amplitude), np.nan)
        if np.any(known):
            relative[known] = self.prediction.inverse.friction_at(amplitude[known], speed[known])
        return relative


def play_setup(
    display: Display,
    texture: TextureFile,
    device: KnownDevice = NOTHING_KNOWN,
    how: HowToPlay = _AS_USUAL,
) -> PlaySetup:
    """The plan for a texture on a display, whose drive's limits are the device's.

    Raises:
        InputError: a display that does not vibrate, limits that do not fit, a texture that no tile
            can hold, or a device that shall hold and whose pickup is not known.
    """
    p = predict(display, voltage=how.voltage, surface=how.surface)
    largest = p.vibration_amplitude
    if p.voltage is None or largest <= 0.0 or p.relative_friction >= 1.0:
        raise InputError(
            f"display '{display.name}' changes no friction at {p.voltage or 0.0:g} V, so it "
            "plays no texture; give it a voltage"
        )
    limits = display.limits(p.frequency, p.voltage, twin=device.twin)
    loaded = p.touch.mode or p.mode
    tau = float(envelope_time_constant(loaded.quality_factor, loaded.resonance_frequency))
    held, per_volt = None, largest / p.voltage
    if how.hold:
        held, per_volt = _held(p, device, limits)
        tau = held[1].amplitude_time
    loop = LoopPlan(
        program=lowered(texture, p, p.inverse),
        rate=how.rate,
        envelope=DrivenEnvelope(tau, tau, largest),
        amplitude_per_volt=per_volt,
        estimator=MotionEstimator.for_sensor(device.sensor),
        compensation=how.compensation,
        relative_friction=p.inverse,
        output_delay=OUTPUT_DELAY,
    )
    tile = None
    if how.mode == "tile":
        tile = tile_of(loop.program, device.way or _TILE_WAY, p.speed, p.friction)
    announce(make_tick, "real-time loop", 20)
    plan = PlayPlan(
        loop=loop,
        limits=limits,
        frequency=p.frequency,
        tile=tile,
        device=device,
        hold=held,
    )
    return PlaySetup(display, texture, p, plan)


def _held(
    p: Prediction, device: KnownDevice, limits: Limits
) -> tuple[tuple[IdentifiedPlate, LoopAims], si.MetrePerVolt]:
    """The free plate as identified or predicted, aims within the limits, and its amplitude per
    volt (m/V); the search begins just above it."""
    if device.amplitude_per_pickup is None:
        raise InputError(
            "to hold its amplitude a device needs a pickup that is known; give "
            "amplitude_per_pickup, or do not hold",
            quantity="amplitude_per_pickup",
        )
    mode, per_pickup = p.mode, device.amplitude_per_pickup
    ratio = mode.amplitude_per_volt / per_pickup
    predicted = IdentifiedPlate(mode.resonance_frequency, mode.quality_factor, ratio)
    plate, noise = device.identified or (predicted, 0.0)
    aims = LoopAims(
        limits.lowest_frequency,
        min(limits.highest_frequency, plate.frequency + _SEARCHED * plate.half_bandwidth),
        limits.voltage,
        _SEARCH_SHARE * limits.voltage,
        noise=max(noise, _PICKUP_NOISE),
    )
    return (plate, aims), plate.ratio * per_pickup
