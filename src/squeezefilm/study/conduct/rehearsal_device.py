"""A study's device that is a display's twin: to rehearse a study, its files and its analysis.

The plate's state is the twin's: with its drift, its amplifier and the noise of its pickup, so
that a verification measures something and may fail. Nobody can feel it; a simulated hand explores
every surface instead, which says how a finger moves, not what a person would answer.
"""

from __future__ import annotations

import math

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.bench.resonance_sweep import peak
from squeezefilm.chain.friction import friction_law
from squeezefilm.display import Display
from squeezefilm.formats.traces import Table, csv_text
from squeezefilm.perception.stimuli import Stimulus
from squeezefilm.render.texture.composition import Composable
from squeezefilm.results import config_hash, to_json
from squeezefilm.study.conduct.study_device import DeviceIdentity, DeviceVerification, Exploration
from squeezefilm.twin.hand import Hand, hand_from
from squeezefilm.twin.plant import Plant
from squeezefilm.twin.settings import TwinSettings
from squeezefilm.twin.working_point import WorkingPoint, working_point

_SPAN = 4.0
"""Frequencies are swept over so many bandwidths to either side of the prediction."""
_POINTS = 41
_SETTLE = 10.0
"""Time constants waited at each frequency: e⁻¹⁰ of the change is left."""
_READINGS = 16
_CONTROL = 1000
"""µs between two commands of amplitude."""
_TRACE = ("time_s", "x_m", "y_m", "amplitude_m", "relative_friction", "tangential_force_N")


class StudyTwin:
    """A `StudyDevice` made of a display's twin on its own virtual clock.

    Args:
        display: whose twin; driven at its own voltage.
        settings: what is assumed of it; all defaults are assumed.
        hand: that explores each surface; one there and back at people's speed if None.
        point: the display's working point where it has been solved before.

    Raises what `working_point` raises.
    """

    def __init__(
        self,
        display: Display,
        settings: TwinSettings | None = None,
        hand: Hand | None = None,
        point: WorkingPoint | None = None,
    ) -> None:
        self.display = display
        self.settings = settings or TwinSettings(truth_rows=20_000)
        self.hand = hand or hand_from(begin=0.05, repeats=2)
        self.point = point or working_point(display, self.settings)
        self._levels = _levels(self.point, self.hand.normal_force)
        self._surface: Composable | None = None
        self._plate = Plant(self.point, self.settings)
        self._now = 0

    def identity(self) -> DeviceIdentity:
        """ "rehearsal", with the hashes of the display and of the twin's settings."""
        return DeviceIdentity("rehearsal", config_hash(self.display), config_hash(self.settings))

    def verify_device(self) -> DeviceVerification:
        """A sweep of the carrier over the resonance, read at the pickup, without a finger.

        The peak is that of a parabola through the three largest readings. Without a pickup
        nothing can be measured.
        """
        mode, volts = self.point.mode, self.display.drive.voltage
        if self.settings.pickup.kind == "none":
            return DeviceVerification(measurable=False, remark="the twin has no pickup")
        half = _SPAN * mode.resonance_frequency / (2 * mode.quality_factor)
        carrier = mode.resonance_frequency + half * np.linspace(-1, 1, _POINTS)
        read = np.array([self._amplitude(float(one)) for one in carrier])
        self._step(_seconds_to_us(self._time_constant), 0.0, float(carrier[-1]))
        frequency, amplitude = peak(carrier, read)
        return DeviceVerification(
            amplitude=amplitude,
            expected_amplitude=mode.amplitude_per_volt * volts,
            resonance_frequency=frequency,
            expected_resonance_frequency=mode.resonance_frequency,
            remark="swept on the twin, read at its pickup, no finger",
        )

    def present(self, stimulus: Stimulus, seed: int) -> None:
        """Take the surface; the hand explores it when it is stopped. The twin has no noise that
        `seed` could fix: its own is fixed by its settings."""
        self._surface = stimulus.surface()

    def stop(self) -> Exploration:
        """Let the hand explore the surface presented, and say how it went."""
        if self._surface is None:
            return Exploration()
        plant = Plant(self.point, self.settings, self.hand)
        end = self.hand.begin + (self.hand.repeats or 1) * self.hand.motion.duration
        carrier = round(self.point.mode.resonance_frequency * 1e3)
        surface, self._surface = self._surface, None
        for now in range(_CONTROL, _seconds_to_us(end) + 1, _CONTROL):
            x, y, touching = plant.sensed()
            level = 0
            if touching:
                asked = float(np.asarray(surface(x * 1e-6, y * 1e-6, 0.0, now * 1e-6)))
                level = self._level(asked, surface.quantity)
            plant.advance(now, level, carrier)
        plant.drain()
        columns = {name: plant.truth.column(name) for name in _TRACE}
        way = np.hypot(np.diff(columns["x_m"]), np.diff(columns["y_m"]))
        moving = float(np.ptp(columns["time_s"])) - self.hand.begin
        about = {"device": "rehearsal", "settings_sha256": config_hash(self.settings)}
        return Exploration(
            path_length=float(way.sum()),
            mean_speed=float(way.sum()) / moving,
            mean_normal_force=self.hand.normal_force,
            trace=csv_text(Table(columns, to_json(about))),
        )

    @property
    def _time_constant(self) -> si.Second:
        mode = self.point.mode
        return mode.quality_factor / (math.pi * mode.resonance_frequency)

    def _amplitude(self, carrier: si.Hertz) -> float:
        """The settled amplitude (m) as the pickup has it: the mean of its readings' squares, less
        the noise it is known to have."""
        plate, volts = self._plate, self.display.drive.voltage
        self._step(_seconds_to_us(_SETTLE * self._time_constant), volts, carrier)
        squares = []
        for _ in range(_READINGS):
            self._step(self.settings.tick_us, volts, carrier)
            squares.append((plate.pickup_level() * 1e-6) ** 2)
        noise = 2 * self.settings.pickup.noise**2
        signal = math.sqrt(max(float(np.mean(squares)) - noise, 0.0))
        return signal * plate.pickup_calibration

    def _step(self, duration: int, volts: float, carrier: si.Hertz) -> None:
        self._now += duration
        self._plate.advance(self._now, round(volts * 1e6), round(carrier * 1e3))

    def _level(self, asked: float, quantity: str) -> int:
        """µV for what a surface asks: an amplitude, or the friction looked up in reverse."""
        amplitude = asked
        if quantity != "amplitude":
            wanted = asked if quantity == "relative_friction" else 1.0 - asked
            friction, amplitudes = self._levels
            amplitude = float(np.interp(-wanted, -friction, amplitudes))
        volts = amplitude / self.point.mode.amplitude_per_volt
        return round(min(volts, self.display.drive.voltage) * 1e6)


def _levels(point: WorkingPoint, force: float) -> tuple[si.FloatArray, si.FloatArray]:
    """Relative friction, falling, and the amplitudes (m) that make it, at a normal force (N)."""
    law = friction_law(
        point.display,
        point.mode.half_wavelength,
        point.mode.resonance_frequency,
        normal_force=force,
    )
    amplitudes = point.amplitudes
    friction = np.minimum.accumulate(law.curve(amplitudes))
    falling = np.r_[True, np.diff(friction) < 0]
    return friction[falling], amplitudes[falling]


def _seconds_to_us(duration: si.Second) -> int:
    return round(duration * 1e6)
