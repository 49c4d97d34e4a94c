"""A noisy, complete bench made by the physics: every kind of recording of one display, whose true
values are drawn from its own ranges. Nothing here was measured."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from tests.made_bench.duffing import SofteningResonance
from tests.made_bench.strokes import PlannedStrokes, recorded_strokes

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.recordings import kinds
from squeezefilm.physics.chain.friction import friction_law
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.working_mode import WorkingMode, working_mode
from squeezefilm.physics.uncertainty.parameters import (
    SKIN_COMPLIANCE,
    uncertain_parameters,
    with_values,
)

_POINTS = 161
# Half-bandwidths f/2Q that a sweep covers on each side.
_BAND = 8.0
# Small enough that what depends on the amplitude does not show in what is read as linear.
_SMALL = 0.02
_PER_HALF_WAVELENGTH = 16
_GRID = (30, 15)
_DECAYS, _PER_PERIOD = 5.0, 8
_SWEEPS = (0.2, 0.5, 1.0)
_LEVELS, _REPEATS = 5, 10
_CHIRP = 32768
_LONGEST_AMPLITUDE: si.Metre = 3e-6
_SPREADS = {"speed": 0.25, "force": 0.15}


_TRIED = 40


@dataclass(frozen=True)
class BenchOptions:
    """How a made-up bench errs.

    `noise` is one standard deviation of a recording over its largest value, of forces too;
    `stroke_spread` that of ln µ between strokes, `sweating` how much ln µ rises during the session;
    `background` the size of a straight remainder of frequency responses and the drift of a line
    scan, over the largest value; `missing` the share of points that are not there; with
    `phase_reversed` phases have the other sign. `backbone` and `damping_rise` are what frequency
    and loss change by at the display's own voltage, as shares. With `fixture` what holds the plate
    has a resonance of its own.
    """

    noise: float = 0.01
    stroke_spread: float = 0.08
    sweating: float = 0.2
    background: float = 0.02
    missing: float = 0.0
    phase_reversed: bool = False
    backbone: float = -0.004
    damping_rise: float = 0.15
    fixture: bool = False


@dataclass(frozen=True, eq=False)
class MadeBench:
    """Recordings by their names, and the display with the true values, which they do not tell."""

    recordings: Mapping[str, kinds.Recording]
    display: Display
    options: BenchOptions


def made_bench(display: Display, seed: int, options: BenchOptions | None = None) -> MadeBench:
    """Noisy recordings of a display with values drawn from its own ranges by a seed.

    Impedance and grid scan only of a plate solved in three dimensions, which is solved once. What
    is small in the recordings is linear: they are made at 2 % of the display's voltage, the
    voltage sweeps and the decay at all of it.
    """
    options = options or BenchOptions()
    true = drawn_display(display, seed)
    bench = _Bench(true, seed, options, np.random.default_rng([seed, 91]))
    made: dict[str, Callable[[], kinds.Recording]] = {
        "frequency-response": bench.frequency_response,
        "ring-down": bench.ring_down,
        "voltage-sweeps": bench.voltage_sweeps,
        "raw-signals": bench.raw_signals,
        "line-scan": bench.line_scan,
        "friction-bench": bench.friction_bench,
        "friction-curve": bench.friction_curve,
    }
    if bench.mode.solid is not None:
        made |= {"impedance": bench.impedance, "grid-scan": bench.grid_scan}
    return MadeBench({name: make() for name, make in made.items()}, true, options)


def drawn_display(display: Display, seed: int) -> Display:
    """A display with values drawn from its own ranges; draws that make none are drawn again."""
    random = np.random.default_rng([seed, 19])
    uncertain = uncertain_parameters(display, driven=True)
    # How soft a pad is belongs to the model, not to a value of the display.
    parameters = [parameter for parameter in uncertain if parameter.path != SKIN_COMPLIANCE]
    for _ in range(_TRIED):
        shares = random.random(len(parameters))
        values = {
            parameter.path: parameter.drawn(np.array([share]))[0]
            for parameter, share in zip(parameters, shares, strict=True)
        }
        with contextlib.suppress(InputError):
            return with_values(display, values)
    raise AssertionError(f"none of {_TRIED} draws makes a display")


@dataclass(frozen=True, eq=False)
class _Bench:
    """The drawn display, solved once, and the random numbers of its instruments."""

    display: Display
    seed: int
    options: BenchOptions
    random: np.random.Generator

    @cached_property
    def mode(self) -> WorkingMode:
        return working_mode(self.display.actuator)

    @property
    def voltage(self) -> si.Volt:
        return self.display.drive.voltage

    @cached_property
    def resonance(self) -> SofteningResonance:
        mode = self.mode
        largest = mode.amplitude_per_volt * self.voltage
        return SofteningResonance(
            mode.resonance_frequency,
            mode.quality_factor,
            mode.amplitude_per_volt,
            self.options.backbone / largest**2,
            self.options.damping_rise / largest,
        )

    @cached_property
    def fixture(self) -> tuple[float, float, complex]:
        """Frequency, Q and strength (over the plate's mode) of what holds the plate; no strength
        where the bench is as described."""
        random = np.random.default_rng([self.seed, 7])
        way = float(random.choice([-1.0, 1.0])) * random.uniform(0.6, 2.0)
        f = self.mode.resonance_frequency * (1 + way / self.mode.quality_factor)
        size = random.uniform(0.25, 0.6) * np.exp(2j * np.pi * random.random())
        return float(f), self.mode.quality_factor, complex(size) if self.options.fixture else 0j

    def motion(self, f: si.HertzArray) -> si.ComplexArray:
        """Displacement per volt (m/V) of the best antinode at frequencies (Hz)."""
        mode = self.mode
        if mode.solid is not None:
            x, y = (np.array([place]) for place in mode.lobe)
            found = mode.solid.response.at(f).displacement(x, y)[:, 0, 0]
        else:
            found = mode.amplitude_per_volt * _one_mode(
                f, mode.resonance_frequency, mode.quality_factor
            )
        own, quality, strength = self.fixture
        return np.asarray(found + strength * mode.amplitude_per_volt * _one_mode(f, own, quality))

    @cached_property
    def band(self) -> si.HertzArray:
        half = self.mode.resonance_frequency / (2 * self.mode.quality_factor)
        f = self.mode.resonance_frequency + np.linspace(-_BAND, _BAND, _POINTS) * half
        solid = self.mode.solid
        if solid is not None:
            known = solid.response.frequencies
            f = np.linspace(max(f[0], known[0]), min(f[-1], known[-1]), _POINTS)
        return np.asarray(f)

    def kept(self, count: int) -> np.ndarray[tuple[int, ...], np.dtype[np.bool]]:
        """Which points are there."""
        return np.asarray(self.random.random(count) >= self.options.missing)

    def noisy(self, values: si.ComplexArray) -> si.ComplexArray:
        """Complex values with the bench's noise, and its sign of the phase."""
        size = self.options.noise * float(np.max(np.abs(values))) / np.sqrt(2)
        noise = self.random.standard_normal((2, values.size)) * size
        found = values + noise[0] + 1j * noise[1]
        return np.asarray(found.conj() if self.options.phase_reversed else found)

    def told(self, name: str) -> kinds.Told:
        source = f"synthetic: computed by the tests, seed {self.seed}; nothing was measured"
        return kinds.Told(name=f"synthetic {name}", instrument="none", source=source)

    def frequency_response(self) -> kinds.FrequencyResponse:
        H = self.motion(self.band)
        place = (self.band - self.band[0]) / np.ptp(self.band)
        H = H + self.options.background * np.max(np.abs(H)) * (0.5 + place) * (1 + 0.5j)
        keep = self.kept(H.size)
        return kinds.FrequencyResponse(
            self.band[keep],
            self.noisy(H)[keep],
            _SMALL * self.voltage,
            told=self.told("frequency response"),
            place=self.mode.lobe,
        )

    def impedance(self) -> kinds.ImpedanceSweep:
        assert self.mode.solid is not None
        admittance = self.mode.solid.response.at(self.band).admittance
        keep = self.kept(self.band.size)
        return kinds.ImpedanceSweep(
            self.band[keep], self.noisy(admittance)[keep], told=self.told("impedance")
        )

    def line_scan(self) -> kinds.LineScan:
        mode, line = self.mode, self.mode.line
        half, volts = mode.half_wavelength, _SMALL * self.voltage
        if line is None:
            # A measured stator: some wavelengths of its track.
            x = np.linspace(0.0, 6 * half, 6 * _PER_HALF_WAVELENGTH)
            w: si.Array = -1j * mode.amplitude_per_volt * np.cos(np.pi * x / half)
        else:
            ends = float(line.position[0]), float(line.position[-1])
            count = int(_PER_HALF_WAVELENGTH * (ends[1] - ends[0]) / half) + 2
            x = np.linspace(*ends, count)
            shape = np.interp(x, line.position, line.deflection)
            w = -1j * mode.amplitude_per_volt * shape
        if mode.solid is not None:
            w = np.asarray(self._solved_line(x))
        if self.options.fixture:
            # What holds the plate lets it rock.
            w = w + self.fixture[2] * 0.3 * mode.amplitude_per_volt * (x / x[-1] - 0.3)
        w = w * volts * (1 + self.options.background * (x / x[-1] - 0.5))
        keep = self.kept(x.size)
        return kinds.LineScan(
            x[keep],
            self.noisy(w)[keep],
            mode.resonance_frequency,
            volts,
            told=self.told("line scan"),
        )

    def _solved_line(self, x: si.MetreArray) -> si.ComplexArray:
        """Displacement per volt (m/V) along the line through the best antinode."""
        assert self.mode.solid is not None
        response, at = self.mode.solid.driven_at()
        lengthwise = getattr(self.display.actuator, "lines_across", "length") == "length"
        across = np.array([self.mode.lobe[1]])
        if lengthwise:
            return np.asarray(response.motion(at, x, across)[:, 0])
        return np.asarray(response.motion(at, np.array([self.mode.lobe[0]]), x)[0])

    def grid_scan(self) -> kinds.GridScan:
        assert self.mode.solid is not None
        response, at = self.mode.solid.driven_at()
        extent = self.display.actuator.extent
        x, y = (
            np.linspace(0.02 * side, 0.98 * side, count)
            for side, count in zip(extent, _GRID, strict=True)
        )
        volts = _SMALL * self.voltage
        w = volts * response.motion(at, x, y).ravel()
        X, Y = (one.ravel() for one in np.meshgrid(x, y, indexing="ij"))
        if self.options.fixture:
            w = w + self.fixture[2] * 0.3 * volts * self.mode.amplitude_per_volt * (X / x[-1] - 0.3)
        keep = self.kept(w.size)
        return kinds.GridScan(
            X[keep],
            Y[keep],
            self.noisy(w)[keep],
            self.mode.resonance_frequency,
            volts,
            told=self.told("grid scan"),
        )

    def ring_down(self) -> kinds.RingDown:
        f, decay = self.mode.resonance_frequency, self.resonance.quality_factor / np.pi
        t = np.arange(int(_DECAYS * decay * _PER_PERIOD)) / (_PER_PERIOD * f)
        t = t[self.kept(t.size)]
        largest = self.mode.amplitude_per_volt * self.voltage / (1 + self.options.damping_rise)
        w = self.resonance.ringing(t - t[0], largest, float(2 * np.pi * self.random.random()))
        own, quality, strength = self.fixture
        beat = largest * np.exp(-np.pi * own / quality * t) * np.cos(2 * np.pi * own * t)
        noise = self.options.noise * largest * self.random.standard_normal(t.size)
        return kinds.RingDown(t, w + abs(strength) * beat + noise, told=self.told("ring-down"))

    def voltage_sweeps(self) -> kinds.VoltageSweeps:
        f, sweeps, directions = self.band[::2], [], []
        size = self.options.noise * self.mode.amplitude_per_volt * self.voltage / np.sqrt(2)
        own, quality, strength = self.fixture
        for share in _SWEEPS:
            volts = share * self.voltage
            for way in ("up", "down"):
                row = f if way == "up" else f[::-1]
                x = self.resonance.swept(row, volts)
                more = strength * self.mode.amplitude_per_volt * volts
                x = x + more * _one_mode(row, own, quality)
                noise = size * self.random.standard_normal((2, row.size))
                x = x + noise[0] + 1j * noise[1]
                x = x.conj() if self.options.phase_reversed else x
                keep = self.kept(row.size)
                sweeps.append(kinds.FrequencyResponse(row[keep], (x / volts)[keep], volts))
                directions.append(way)
        return kinds.VoltageSweeps(
            tuple(sweeps), tuple(directions), told=self.told("voltage sweeps")
        )

    def raw_signals(self) -> kinds.RawSignals:
        """A chirp over the band, and the plate's answer by its response."""
        rate = 6 * self.band[-1]
        t = np.arange(_CHIRP) / rate
        low, high = self.band[0], self.band[-1]
        turned = 2 * np.pi * (low * t + (high - low) * t**2 / (2 * t[-1]))
        # Quiet ends: what the plate still rings with after the chirp is in the recording.
        v = _SMALL * self.voltage * np.sin(turned) * np.clip(20 * np.minimum(t, 0.8 * t[-1] - t)
                                                             / t[-1], 0.0, 1.0)  # fmt: skip
        f, V = np.fft.rfftfreq(t.size, 1 / rate), np.fft.rfft(v)
        inside = (f >= low) & (f <= high)
        X = np.zeros(f.size, dtype=complex)
        X[inside] = V[inside] * self.motion(f[inside])
        x = np.fft.irfft(X, t.size)
        size = self.options.noise * float(np.max(np.abs(x)))
        x = x + size * self.random.standard_normal(t.size)
        return kinds.RawSignals(t, v, x, told=self.told("raw signals"))

    @cached_property
    def _levels(self) -> si.MetreArray:
        largest = min(0.6 * self.mode.amplitude_per_volt * self.voltage, _LONGEST_AMPLITUDE)
        return np.linspace(0.0, largest, _LEVELS)

    def _relative(
        self, amplitude: si.MetreArray, speed: si.MetrePerSecondArray, force: si.Newton
    ) -> tuple[si.DimensionlessArray, si.Dimensionless]:
        """µ′/µ by speeds × amplitudes, and µ, at a force (N)."""
        display = self.display
        law = friction_law(
            display,
            self.mode.half_wavelength,
            self.mode.resonance_frequency,
            normal_force=force,
        )
        return law.over_speeds(amplitude, speed), law.friction_coefficient

    def friction_bench(self) -> kinds.FrictionBench:
        """Amplitudes in a mixed order, at forces and speeds as a finger varies them."""
        finger, random = self.display.finger, self.random
        number = np.repeat(np.arange(_LEVELS), _REPEATS)
        random.shuffle(number)
        speeds = finger.speed * np.exp(_SPREADS["speed"] * np.array([-1.0, 0.0, 1.0]))
        forces = finger.normal_force * np.exp(_SPREADS["force"] * np.array([-1.0, 0.0, 1.0]))
        tables = [self._relative(self._levels, speeds, float(force)) for force in forces]
        pick = random.integers(0, 3, (2, number.size))
        coefficient = np.array(
            [tables[f][1] * tables[f][0][v, n] for v, f, n in zip(*pick, number, strict=True)]
        )
        sweat = self.options.sweating * np.linspace(-0.5, 0.5, number.size)
        spread = self.options.stroke_spread * random.standard_normal(number.size)
        # A law may have no friction left, which no bench reads as zero.
        coefficient = np.maximum(coefficient, 1e-3) * np.exp(sweat + spread)
        planned = PlannedStrokes(
            self._levels[number], speeds[pick[0]], forces[pick[1]], coefficient
        )
        found = recorded_strokes(
            planned, random, noise=self.options.noise, frequency=self.mode.resonance_frequency
        )
        keep = self.kept(found.time.size)
        return kinds.FrictionBench(
            time=found.time[keep],
            normal_force=found.normal_force[keep],
            tangential_force=found.tangential_force[keep],
            position=found.position[keep],
            vibration_amplitude=found.vibration_amplitude[keep],
            told=self.told("friction bench"),
            frequency=found.frequency,
        )

    def friction_curve(self) -> kinds.FrictionCurve:
        finger = self.display.finger
        exact, _ = self._relative(self._levels, np.array([finger.speed]), finger.normal_force)
        spread = self.options.stroke_spread / np.sqrt(_REPEATS)
        noise = np.exp(spread * self.random.standard_normal(_LEVELS))
        noise[0] = 1.0
        return kinds.FrictionCurve(
            self._levels,
            exact[0] * noise,
            self.mode.resonance_frequency,
            finger.normal_force,
            finger.speed,
            self.options.stroke_spread * exact[0],
            told=self.told("friction curve"),
        )


def _one_mode(f: si.HertzArray, own: si.Hertz, quality: si.Dimensionless) -> si.ComplexArray:
    """A mode's answer over its size at resonance."""
    return np.asarray((1 / quality) / (1 + 1j / quality - (f / own) ** 2))
