"""The kinds of recordings of a bench, in SI units and zero-to-peak amplitudes, whatever the file
was in.

What was measured may hold NaN where the instrument had no reading: fits leave such points out. The
places, times and frequencies of the points may not.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import Annotated, Any, Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.hard_limits import DENSITY, LAYER, SIDE
from squeezefilm.physics.plate.ring.ceramic_disc import CeramicDisc


@si.checked_numbers
@dataclass(frozen=True)
class CeramicBar:
    """A bar poled through its thickness, with electrodes all over both faces: `length`, `width` and
    `thickness` (m) and its `density` (kg/m³). Raises `InputError` for one that is no bar."""

    length: Annotated[si.Metre, SIDE]
    width: Annotated[si.Metre, SIDE]
    thickness: Annotated[si.Metre, LAYER]
    density: Annotated[si.KilogramPerCubicMetre, DENSITY]

    def __post_init__(self) -> None:
        widest = max(self.width, self.thickness)
        if self.length < 2 * widest:
            raise InputError(
                f"length = {self.length * 1e3:.4g} mm is less than twice the largest other side, "
                f"{widest * 1e3:.4g} mm: the bar would not vibrate along its length alone; cut a "
                "longer or narrower one",
                quantity="length",
            )


@si.checked_numbers
@dataclass(frozen=True)
class Told:
    """Words of the description beside a recording; an empty text is not told.

    `temperature` in kelvin; `name` is the recording's own, `file` its file's name without a folder.
    """

    name: str = ""
    file: str = ""
    who: str = ""
    when: str = ""
    instrument: str = ""
    licence: str = ""
    source: str = ""
    temperature: Annotated[si.AbsoluteKelvin, si.Above(0.0)] | None = None

    @property
    def facts(self) -> list[tuple[str, str]]:
        """What is told of who measured, when and with what, as pairs of what and how."""
        said = (
            ("measured by", self.who),
            ("when", self.when),
            ("instrument", self.instrument),
            ("licence", self.licence),
            ("source", self.source),
        )
        return [(what, how) for what, how in said if how]


@dataclass(frozen=True, eq=False)
class _Rows:
    """Series of one length: all fields that are arrays by their types, or where one was given."""

    def __post_init__(self) -> None:
        given = {entry.name: (entry.type, getattr(self, entry.name)) for entry in fields(self)}
        series = {
            name: values
            for name, (of, values) in given.items()
            if "Array" in str(of) or isinstance(values, np.ndarray)
        }
        si.require_alike(**series)


def finite(*columns: si.Array) -> tuple[Any, ...]:
    """Columns (points,) of a recording without the points where one of them is not finite."""
    known = np.all([np.isfinite(column) for column in columns], axis=0)
    return tuple(np.asarray(column)[known] for column in columns)


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class ImpedanceSweep(_Rows):
    """Admittance (S, complex, time factor e^{iωt}) at rising `frequency` (Hz), both (points,);
    `body` is the bare ceramic that was swept, where it is told to be one, `compensated` whether
    the fixture's leads were (None where that is not told). Without `phase_recorded` the phase is
    that of a passive body (`circuits_read.with_phase`), and the size was recorded of the body and a
    resistance `in_series` (Ω) together."""

    frequency: si.HertzArray
    admittance: si.Array
    told: Told = field(default_factory=Told)
    body: CeramicBar | CeramicDisc | None = None
    compensated: bool | None = None
    phase_recorded: bool = True
    in_series: si.Ohm = 0.0

    def as_recorded(self, admittance: si.ComplexArray) -> si.Array:
        """What such a sweep records of a body's admittance (S, (points,)): all of it; without a
        phase its size, behind what is in series."""
        if self.phase_recorded:
            return admittance
        return np.asarray(np.abs(admittance / (1 + admittance * self.in_series)))


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class FrequencyResponse(_Rows):
    """Displacement per volt (m/V, complex) at one place against `frequency` (Hz), both (points,);
    `voltage` (V) is the drive's amplitude during the sweep, `coherence` (0 to 1) where recorded,
    `place` where on the plate (x, y in m) where told."""

    frequency: si.HertzArray
    displacement_per_volt: si.Array
    voltage: si.Volt | None = None
    coherence: si.DimensionlessArray | None = None
    told: Told = field(default_factory=Told)
    place: tuple[si.Metre, si.Metre] | None = None


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class LineScan(_Rows):
    """Displacement (m, complex; real where the phase was not recorded) at `position` (m) along a
    line, both (points,), at one `frequency` (Hz) and drive `voltage` (V)."""

    position: si.MetreArray
    displacement: si.Array
    frequency: si.Hertz
    voltage: si.Volt | None = None
    told: Told = field(default_factory=Told)


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class GridScan(_Rows):
    """Displacement (m, complex) at places `x`, `y` (m), all (points,), at one `frequency` (Hz) and
    drive `voltage` (V)."""

    x: si.MetreArray
    y: si.MetreArray
    displacement: si.Array
    frequency: si.Hertz
    voltage: si.Volt | None = None
    told: Told = field(default_factory=Told)


@dataclass(frozen=True, eq=False)
class RingDown:
    """Displacement (m, or of a signal that follows it in `unit`) against `time` (s) after the drive
    was switched off, both (points,)."""

    time: si.SecondArray
    displacement: si.MetreArray
    told: Told = field(default_factory=Told)
    unit: str = "m"

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
class FrictionBench(_Rows):
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


FrictionQuantity = Literal["friction_force", "friction_coefficient", "relative_friction"]
"""Quantity of a friction curve: the force (N), µ, or µ′/µ."""


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class FrictionCurve(_Rows):
    """Friction against `vibration_amplitude` (m), both (points,), as it was measured: `friction` is
    a force in newtons, a coefficient or µ′/µ, as `quantity` says.

    `spread` is one standard deviation in the same unit, None where it is not known. `frequency`
    (Hz), `normal_force` (N) and `speed` (m/s) are one number or (points,); force and speed are None
    where they are not told. `display` is the preset or file that describes plate, surface and
    finger, `finger` says in words which finger it was, and `reading_error` is that of numbers read
    off a figure, in the unit of the friction.
    """

    vibration_amplitude: si.MetreArray
    friction: si.FloatArray
    frequency: si.HertzLike
    normal_force: si.NewtonLike | None = None
    speed: si.MetrePerSecondLike | None = None
    spread: si.FloatArray | None = None
    quantity: FrictionQuantity = "relative_friction"
    told: Told = field(default_factory=Told)
    display: str = ""
    finger: str = ""
    reading_error: float = 0.0

    @property
    def deviation(self) -> si.FloatArray | None:
        """Standard deviation of each point: its spread and the reading error together, (points,);
        None where neither is known."""
        if self.spread is None and not self.reading_error:
            return None
        spread = np.zeros(self.friction.size) if self.spread is None else self.spread
        return np.asarray(np.hypot(spread, self.reading_error))

    @property
    def unit(self) -> str:
        """Unit that counts once in statistics: a finger of a source, a source whose fingers are not
        told apart, or the recording itself."""
        return f"{self.told.source}: {self.finger or 'all'}" if self.told.source else self.told.name


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class FrictionDecays(_Rows):
    """Fits of µ = `friction_coefficient` exp(−a²/2τ²) over the amplitude a, as they were published:
    τ is `decay_amplitude` (m), both (strokes,). Force (N) and speed (m/s) are None where they are
    not told."""

    decay_amplitude: si.MetreArray
    friction_coefficient: si.DimensionlessArray
    frequency: si.Hertz
    normal_force: si.Newton | None = None
    speed: si.MetrePerSecond | None = None
    told: Told = field(default_factory=Told)
    display: str = ""


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class FingertipImpedances(_Rows):
    """`damping` (N s/m) and moving `mass` (kg) of fingertips on a vibration, both (touches,), at a
    `frequency` (Hz) and a `normal_force` (N), without sliding."""

    damping: Annotated[si.FloatArray, si.Unit("N*s/m")]
    mass: Annotated[si.FloatArray, si.Unit("kg")]
    frequency: si.Hertz
    normal_force: si.Newton
    told: Told = field(default_factory=Told)
    display: str = ""


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class DetectionThresholds(_Rows):
    """The least `amplitude` (zero-to-peak, 1) of the friction coefficient that is detected of sines
    of a spatial `period` (m), both (periods,): medians over `people` whose fingers slide at a
    `speed` (m/s) under a `normal_force` (N)."""

    period: Annotated[si.MetreArray, si.Above(0.0)]
    amplitude: Annotated[si.DimensionlessArray, si.Above(0.0)]
    normal_force: si.Newton
    speed: si.MetrePerSecond
    people: Annotated[int, si.AtLeast(1)]
    told: Told = field(default_factory=Told)


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
    | FrictionDecays
    | FingertipImpedances
    | DetectionThresholds
)
