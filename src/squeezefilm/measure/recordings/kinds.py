"""The kinds of recordings of a bench, in SI units and zero-to-peak amplitudes, whatever the file
was in.

What was measured may hold NaN where the instrument had no reading: fits leave such points out. The
places, times and frequencies of the points may not.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from squeezefilm import quantities as si
from squeezefilm.measure.recordings.ceramic_bar import CeramicBar
from squeezefilm.plate.ring.ceramic_disc import CeramicDisc


@si.checked_numbers
@dataclass(frozen=True)
class Told:
    """What the description beside a recording tells of it; an empty text is not told.

    `temperature` in kelvin; `name` is the recording's own, `file` its file's name without a folder.
    """

    name: str = ""
    file: str = ""
    who: str = ""
    when: str = ""
    instrument: str = ""
    licence: str = ""
    source: str = ""
    temperature: si.AbsoluteKelvin | None = None


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class ImpedanceSweep:
    """Admittance (S, complex, time factor e^{iωt}) at rising `frequency` (Hz), both (points,);
    `body` is the bare ceramic that was swept, where it is told to be one."""

    frequency: si.HertzArray
    admittance: si.Array
    told: Told = field(default_factory=Told)
    body: CeramicBar | CeramicDisc | None = None

    def __post_init__(self) -> None:
        si.require_alike(frequency=self.frequency, admittance=self.admittance)


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class FrequencyResponse:
    """Displacement per volt (m/V, complex) at one place against `frequency` (Hz), both (points,);
    `voltage` (V) is the drive's amplitude during the sweep, `coherence` (0 to 1) where recorded,
    `place` where on the plate (x, y in m) where told."""

    frequency: si.HertzArray
    displacement_per_volt: si.Array
    voltage: si.Volt | None = None
    coherence: si.DimensionlessArray | None = None
    told: Told = field(default_factory=Told)
    place: tuple[si.Metre, si.Metre] | None = None

    def __post_init__(self) -> None:
        si.require_alike(
            frequency=self.frequency,
            displacement_per_volt=self.displacement_per_volt,
            coherence=self.coherence,
        )


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class LineScan:
    """Displacement (m, complex; real where the phase was not recorded) at `position` (m) along a
    line, both (points,), at one `frequency` (Hz) and drive `voltage` (V)."""

    position: si.MetreArray
    displacement: si.Array
    frequency: si.Hertz
    voltage: si.Volt | None = None
    told: Told = field(default_factory=Told)

    def __post_init__(self) -> None:
        si.require_alike(position=self.position, displacement=self.displacement)


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class GridScan:
    """Displacement (m, complex) at places `x`, `y` (m), all (points,), at one `frequency` (Hz) and
    drive `voltage` (V)."""

    x: si.MetreArray
    y: si.MetreArray
    displacement: si.Array
    frequency: si.Hertz
    voltage: si.Volt | None = None
    told: Told = field(default_factory=Told)

    def __post_init__(self) -> None:
        si.require_alike(x=self.x, y=self.y, displacement=self.displacement)


@dataclass(frozen=True, eq=False)
class RingDown:
    """Displacement (m) against `time` (s) after the drive was switched off, both (points,)."""

    time: si.SecondArray
    displacement: si.MetreArray
    told: Told = field(default_factory=Told)

    def __post_init__(self) -> None:
        si.require("time", self.time, si.Unit("s"))
        si.require_alike(time=self.time, displacement=self.displacement)


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class VoltageSweeps:
    """Frequency responses at several drive voltages, each swept in one direction ("up", "down")."""

    sweeps: tuple[FrequencyResponse, ...]
    directions: tuple[str, ...]
    told: Told = field(default_factory=Told)


@dataclass(frozen=True, eq=False)
class RawSignals:
    """Drive voltage (V) and displacement (m) against `time` (s), all (points,), evenly sampled."""

    time: si.SecondArray
    voltage: si.VoltArray
    displacement: si.MetreArray
    told: Told = field(default_factory=Told)

    def __post_init__(self) -> None:
        si.require("time", self.time, si.Unit("s"))
        si.require_alike(time=self.time, voltage=self.voltage, displacement=self.displacement)


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class FrictionBench:
    """Strokes of a finger or probe: `time` (s), `normal_force` and `tangential_force` (N),
    `position` (m) and `vibration_amplitude` (m, zero to peak), all (points,); `frequency` (Hz) of
    the vibration where told."""

    time: si.SecondArray
    normal_force: si.NewtonArray
    tangential_force: si.NewtonArray
    position: si.MetreArray
    vibration_amplitude: si.MetreArray
    told: Told = field(default_factory=Told)
    frequency: si.Hertz | None = None

    def __post_init__(self) -> None:
        si.require_alike(
            time=self.time,
            normal_force=self.normal_force,
            tangential_force=self.tangential_force,
            position=self.position,
            vibration_amplitude=self.vibration_amplitude,
        )


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class FrictionCurve:
    """µ′/µ with its spread (one standard deviation) against `vibration_amplitude` (m), all
    (points,), at one `frequency` (Hz), `normal_force` (N) and `speed` (m/s); `display` is the
    preset or file that describes plate, surface and finger."""

    vibration_amplitude: si.MetreArray
    relative_friction: si.DimensionlessArray
    spread: si.DimensionlessArray
    frequency: si.Hertz
    normal_force: si.Newton
    speed: si.MetrePerSecond
    told: Told = field(default_factory=Told)
    display: str = ""

    def __post_init__(self) -> None:
        si.require_alike(
            vibration_amplitude=self.vibration_amplitude,
            relative_friction=self.relative_friction,
            spread=self.spread,
        )


Recording = (
    ImpedanceSweep
    | FrequencyResponse
    | LineScan
    | GridScan
    | RingDown
    | VoltageSweeps
    | RawSignals
    | FrictionBench
    | FrictionCurve
)
