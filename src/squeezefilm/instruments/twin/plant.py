"""The simulated plate, amplifier, film, finger, hand, sensor and pickup as one object on one clock,
and the record of what really happened.

Python around `plant_kernel.advance`; everything that takes time is compiled.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple, TextIO

import numpy as np
from numpy.typing import NDArray

from squeezefilm.core import quantities as si
from squeezefilm.core.compiled import announce, compiled
from squeezefilm.core.errors import InputError
from squeezefilm.instruments.twin import plant_kernel as k
from squeezefilm.instruments.twin.envelope_step import Fingers, FrictionTables
from squeezefilm.instruments.twin.hand import Hand
from squeezefilm.instruments.twin.settings import PickupModel, TwinSettings
from squeezefilm.instruments.twin.working_point import WorkingPoint
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.contact.sliding.march import substeps
from squeezefilm.physics.plate.heat_states import cooling_of, heat_capacity
from squeezefilm.physics.plate.thermal import driven_thickness, thermal_body

_PICKUP_RE, _PICKUP_IM = 11, 12  # streams of noise
_BUFFER = 2000  # rows between two visits to Python
KEPT = 200_000
"""Rows of the truth that stay in memory, the newest."""


@dataclass(frozen=True, slots=True)
class PlantCounts:
    """Numbers of steps of the plant, since it began, in which something was not as wanted.

    `beyond`: the amplitude left the tables. `failed`: the skin chattered without end. `lost`:
    sensor samples.
    """

    beyond: int
    failed: int
    lost: int


class TruthRecord:
    """Rows of the truth, their columns named in `k.COLUMNS`. Memory is bounded; the file is not.

    The file is a CSV that grows by whole lines and is flushed with each block of them; numbers
    read back exactly.
    """

    def __init__(self, file: Path | None = None) -> None:
        """Keep the newest `KEPT` rows; append all to `file`. `InputError` if it can't be."""
        self._rows: deque[si.FloatArray] = deque(maxlen=KEPT)
        self._file: TextIO | None = None
        if file is not None:
            try:
                self._file = file.open("w", encoding="utf-8", newline="")
            except OSError as error:
                raise InputError(
                    f"cannot write the truth to {file}: {error.strerror}; give another file"
                ) from error
            self._file.write(",".join(k.COLUMNS) + "\n")

    def append(self, rows: si.FloatArray) -> None:
        """Add rows, shape (n, columns)."""
        if self._file is not None:
            lines = (",".join(repr(float(v)) for v in row) for row in rows)
            self._file.write("".join(line + "\n" for line in lines))
            self._file.flush()
        self._rows.extend(rows.copy())

    @property
    def rows(self) -> si.FloatArray:
        """The rows kept, oldest first, shape (n, columns); a copy."""
        return np.array(self._rows).reshape(-1, len(k.COLUMNS))

    def column(self, name: str) -> si.FloatArray:
        """One column of the rows kept. Raises `InputError` for another name."""
        if name not in k.COLUMNS:
            raise InputError(f"the truth has no column '{name}'; it has {', '.join(k.COLUMNS)}")
        return self.rows[:, k.COLUMNS.index(name)]

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()
            self._file = None


class Hearing(NamedTuple):
    """Numbers of a pickup: volts per metre of vibration, ohms for the motional current, the share
    of the capacitance's current that leaks, and noise (V)."""

    per_metre: float
    shunt: float
    feedthrough: float
    noise: float


def hearing(pickup: PickupModel) -> Hearing:
    """Numbers of a pickup; all 0 without one."""
    if pickup.kind == "none":
        return Hearing(0.0, 0.0, 0.0, 0.0)
    if pickup.kind == "sensing_patch":
        return Hearing(pickup.sensitivity, 0.0, 0.0, pickup.noise)
    return Hearing(0.0, pickup.shunt, pickup.feedthrough, pickup.noise)


@compiled()
def heard(plant: k.PlantState, ear: Hearing) -> complex:
    """The complex amplitude at the pickup's input (V) against the drive, with its noise."""
    s, n, c, _ = plant
    z = complex(s[k.Z_RE], s[k.Z_IM])
    frequency = n[k.CARRIER] * 1e-3 if n[k.CARRIER] > 0 else s[k.RESONANCE]
    leak = complex(0.0, ear.feedthrough * c[k.C_C0] * s[k.VOLTAGE])
    current = 2.0 * math.pi * frequency * (c[k.C_FACTOR] * s[k.CHARGE] * z + leak)
    seed, now = int(c[k.C_SEED]), n[k.NOW]
    noise = complex(k.gaussian(seed, _PICKUP_RE, now), k.gaussian(seed, _PICKUP_IM, now))
    return complex(ear.per_metre * z + ear.shunt * current + ear.noise * noise)


class Plant:
    """Plate and finger. Not thread-safe. Advance it to a time; read what it does there.

    `hand` None leaves the plate alone. The truth is appended to `truth_file` where one is named.
    """

    def __init__(
        self,
        point: WorkingPoint,
        settings: TwinSettings,
        hand: Hand | None = None,
        truth_file: Path | None = None,
    ) -> None:
        self.point, self.settings, self.hand = point, settings, hand
        self._ear = hearing(settings.pickup)
        self.truth = TruthRecord(truth_file)
        friction = _friction(point)
        self._c = _constants(point, settings, hand, friction)
        self._places, self._plan = _path(hand, settings.tick_us)
        self._s, self._n = np.zeros(k.STATE), np.zeros(k.COUNTS, dtype=np.int64)
        self._s[k.X] = self._s[k.SKIN_X] = self._places[0, 0]
        self._s[k.Y] = self._places[1, 0]
        self._s[k.RELATIVE] = math.nan
        self._s[k.CHARGE] = 1.0
        self._s[k.RESONANCE] = k.resonance(0, 0.0, self._c)
        sensor = settings.sensor
        waiting = math.ceil((sensor.latency + 10 * sensor.jitter) * sensor.rate) + 16
        self._ring = np.zeros((waiting, 5))
        self._buffer = np.empty((_BUFFER, len(k.COLUMNS)))
        forces = np.ascontiguousarray(point.forces, dtype=float)
        highest = float(point.highest_amplitude)
        self._rest = (
            k.PlantState(self._s, self._n, self._c, k.untouched(friction)),
            Fingers(forces, point.load, highest),
            k.HandPath(self._places, self._plan),
            self._ring,
            self._buffer,
        )
        announce(k.advance, "twin's plant", 20)

    @property
    def now(self) -> int:
        """The time it has reached (µs), which never wraps."""
        return int(self._n[k.NOW])

    def advance(self, until: int, level: int, carrier: int) -> None:
        """Advance to a time (µs) at an amplitude (µV) and a carrier frequency (mHz).

        Raises `InputError` for a time that has passed.
        """
        if until < self.now:
            raise InputError(f"the plant is at {self.now} us and was asked to go to {until} us")
        reached = self.now
        while reached < until:
            reached = k.advance(until, level, carrier, *self._rest)
            if reached < until:
                self.drain()

    def drain(self) -> None:
        """Hand the rows of truth made so far to `truth`."""
        self.truth.append(self._buffer[: self._n[k.ROWS]])
        self._n[k.ROWS] = 0

    def close(self) -> None:
        """Hand over the last rows and close their file."""
        self.drain()
        self.truth.close()

    @property
    def envelope(self) -> complex:
        """z (m): the vibration is Re(−i z e^{iωt}), real when driven at resonance."""
        return complex(self._s[k.Z_RE], self._s[k.Z_IM])

    @property
    def amplitude(self) -> si.Metre:
        """Amplitude of the vibration (m, zero-to-peak, at an antinode)."""
        return abs(self.envelope)

    @property
    def resonance_frequency(self) -> si.Hertz:
        """Resonance frequency of the plate now, without the finger (Hz)."""
        return float(self._s[k.RESONANCE])

    @property
    def temperature_rise(self) -> si.Kelvin:
        """Temperature rise of the plate above the room by its own losses (K)."""
        return float(self._s[k.WARMTH])

    @property
    def voltage(self) -> si.Volt:
        """On the plate (V, peak), what limits allow."""
        return float(self._s[k.VOLTAGE])

    @property
    def tangential_force(self) -> si.Newton:
        """Force of friction between skin and surface (N), positive while the skin goes to +x."""
        return float(self._s[k.FRICTION])

    @property
    def counts(self) -> PlantCounts:
        """Numbers of steps in which something was not as wanted."""
        return PlantCounts(*(int(self._n[i]) for i in (k.BEYOND, k.FAILED, k.LOST_SAMPLES)))

    def sensed(self) -> tuple[int, int, bool]:
        """Reading of the device's position sensor now: x and y (µm), and contact."""
        x, y = self._s[k.SEEN_X], self._s[k.SEEN_Y]
        return round(x * 1e6), round(y * 1e6), bool(self._n[k.SEEN_TOUCHING])

    @cached_property
    def pickup_calibration(self) -> si.MetrePerVolt:
        """Vibration amplitude per signal of the pickup (m/V), at the predicted resonance."""
        return self.point.pickup_calibration(self.settings.pickup)

    def phases(self) -> tuple[int, int]:
        """Reading of the pickup now (µV): in phase with the drive, and 90° ahead, with noise."""
        signal = heard(self._rest[0], self._ear)
        return round(signal.real * 1e6), round(signal.imag * 1e6)

    def millidegrees(self) -> int:
        """The plate's temperature (1/1000 °C)."""
        room = self.point.display.thermal.ambient_temperature
        return round(1e3 * (room - 273.15 + self.temperature_rise))

    def pickup_level(self) -> int:
        """The amplitude at the pickup's input now (µV), with its noise; 0 without a pickup."""
        if self.settings.pickup.kind == "none":
            return 0
        return round(abs(heard(self._rest[0], self._ear)) * 1e6)


def _path(hand: Hand | None, tick: int) -> tuple[si.FloatArray, NDArray[np.int64]]:
    if hand is not None:
        return hand.path(tick)
    # A hand that never begins.
    plan = np.array([1 << 61, 1, 0, 1, 1, 0], dtype=np.int64)
    return np.zeros((2, 2)), plan


def _friction(point: WorkingPoint) -> FrictionTables:
    """Friction tables for the kernel, the speeds side by side."""
    display = point.display
    surface, finger = display.surface(), display.finger
    rest = [
        finger.friction_coefficient(surface.friction_coefficient, surface.roughness, float(force))
        for force in point.forces
    ]
    speeds = np.array(point.speeds, dtype=float)
    relative = np.ascontiguousarray(np.swapaxes(point.relative_friction, 1, 2), dtype=float)
    if speeds.size == 1:
        # A law without a speed, by two speeds that are alike.
        speeds, relative = np.array([0.0, 1.0]), np.repeat(relative, 2, axis=2)
    return FrictionTables(speeds, relative, np.array(rest))


def _parts(
    friction: FrictionTables, settings: TwinSettings, pad: FingerpadDynamics, force: float
) -> int:
    """Number of parts in which the skin is marched over a step of the plant."""
    step, dry = 1e-6 * (settings.tick_us // settings.steps_per_tick), settings.dry
    strongest = float(dry.kinetic_force(friction.coefficient.max(), force))
    fall = -float(np.min(np.diff(friction.relative, axis=2) / np.diff(friction.speed)))
    return substeps(step, pad, strongest * max(fall, 0.0))


def _constants(
    point: WorkingPoint, settings: TwinSettings, hand: Hand | None, friction: FrictionTables
) -> si.FloatArray:
    display, mode = point.display, point.mode
    drift, amplifier, arm = settings.drift, settings.amplifier, settings.arm
    sensor, dry, pad = settings.sensor, settings.dry, display.finger.fingerpad
    step = settings.tick_us // settings.steps_per_tick
    force = 0.0 if hand is None else hand.normal_force
    ratio = drift.quality_factor_ratio
    thermal, body = drift.on(display.thermal), thermal_body(display.actuator)
    thickness = driven_thickness(display.actuator)
    c = np.full(k.CONSTANTS, math.nan)
    c[k.C_STEP] = step
    c[k.C_ROW] = round(settings.truth_period * 1e6)
    c[k.C_SEED] = settings.seed
    c[k.C_F0] = mode.resonance_frequency
    c[k.C_FACTOR] = point.force_factor
    c[k.C_Q] = mode.quality_factor * ratio
    c[k.C_PER_VOLT] = mode.amplitude_per_volt * ratio
    c[k.C_OFFSET] = drift.offset
    c[k.C_AGEING] = drift.ageing
    c[k.C_COEFFICIENT] = thermal.temperature_coefficient
    c[k.C_SWING] = drift.ambient_swing
    c[k.C_PERIOD] = round(drift.ambient_period * 1e6)
    c[k.C_COOLING : k.C_ROOM + 1] = cooling_of(thermal, body)
    c[k.C_CAPACITY] = heat_capacity(thermal, body)
    c[k.C_QUALITY_DRIFT] = thermal.quality_temperature_coefficient
    c[k.C_CHARGE_DRIFT] = thermal.charge_temperature_coefficient
    c[k.C_SOFTENING] = thermal.rayleigh_softening
    # Of a stator no ceramic is described, and so no field.
    c[k.C_FIELD_DRIFT] = 0.0 if thickness is None else thermal.rayleigh_charge / thickness
    c[k.C_GAIN] = amplifier.gain
    c[k.C_RAIL] = amplifier.highest_voltage
    c[k.C_CURRENT] = amplifier.highest_current
    c[k.C_SLEW] = amplifier.slew_rate
    c[k.C_C0] = point.capacitance
    c[k.C_LOSS] = amplifier.loss_tangent
    c[k.C_MASS] = arm.mass
    c[k.C_STIFFNESS] = arm.stiffness
    c[k.C_DAMPING] = arm.damping
    c[k.C_PAD_MASS] = pad.mass
    c[k.C_PAD_DAMPING] = pad.damping
    c[k.C_PAD_STIFFNESS] = pad.stiffness
    c[k.C_FORCE] = force
    c[k.C_SUBSTEPS] = _parts(friction, settings, pad, force)
    c[k.C_STATIC] = dry.static_ratio
    c[k.C_EXPONENT] = dry.load_exponent
    c[k.C_REFERENCE] = dry.reference_force
    c[k.C_RATE] = sensor.rate
    c[k.C_SHARE_LOST] = sensor.loss
    c[k.C_LAG] = settings.friction_lag
    c[k.C_LATENCY] = sensor.latency * 1e6
    c[k.C_JITTER] = sensor.jitter * 1e6
    c[k.C_NOISE] = sensor.noise
    c[k.C_QUANTUM] = sensor.quantisation
    if np.isnan(c).any():
        missing = np.flatnonzero(np.isnan(c)).tolist()
        raise RuntimeError(f"the plant's constants {missing} are not numbers; were they all set?")
    return c
