"""What `squeezefilm plate` computes: the modes of a plate in a band, and its harmonic response.

`solve_plate` takes whatever a display has: a rectangle, which is solved here, a disc or a stator.
"""

from __future__ import annotations

import functools
import re
from dataclasses import KW_ONLY, dataclass, field
from typing import Any, NamedTuple

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.analysis.plate.hurry import Hurry
from squeezefilm.analysis.plate.ring import RingAnalysis, analyze_ring
from squeezefilm.analysis.plate.solved import ModeRow, Remarks, SolvedBody, sweep_around
from squeezefilm.analysis.sound import plate_sound
from squeezefilm.arguments import called_with
from squeezefilm.display import Display, NamedDisplay
from squeezefilm.errors import InputError
from squeezefilm.from_text import reads_text
from squeezefilm.hard_limits import NODAL_LINES, require_within
from squeezefilm.plate.beam.response import BeamResponse, beam_response
from squeezefilm.plate.circuit import EquivalentCircuit
from squeezefilm.plate.elements.nodal_lines import within_nodes, zero_crossings
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.shear.modes import shear_mode
from squeezefilm.plate.solid.layers import COARSE, Resolution
from squeezefilm.plate.solid.modes import Label, PlateModes, check_band, profiles
from squeezefilm.plate.solid.response import HarmonicResponse, harmonic_response
from squeezefilm.plate.solid.solve import solve_for_response, solve_modes
from squeezefilm.plate.sound import SoundField
from squeezefilm.plausibility.checks import require_plausible
from squeezefilm.progress import Pace, SayProgress, said_with_time_left

# Estimated errors (relative) above which a finer mesh is taken: of the working mode, and of the
# other modes of the band, in whose table they stand.
_WORKING, _BESIDE = 1e-3, 3e-3


@dataclass(frozen=True, eq=False, repr=False)
class PlateAnalysis(SolvedBody):
    """The solved plate: table of modes, the working mode, its response and equivalent circuit."""

    display: Display
    plate: RectangularPlate
    modes: PlateModes
    working_label: Label
    alone: PlateModes
    rows: tuple[ModeRow, ...]
    working: ModeRow
    response: HarmonicResponse
    amplitude_per_volt: si.MetrePerVolt
    centreline_per_volt: si.MetrePerVolt
    circuit: EquivalentCircuit | None
    beam_frequency: si.Hertz
    beam_amplitude_per_volt: si.MetrePerVolt
    shear_frequency: si.Hertz | None
    sound: SoundField
    objections: tuple[str, ...] = ()
    remarks = Remarks(
        "(estimated)",
        "largest, upper face",
        "centreline, between outer nodes",
        "from the losses of its materials",
        "loudest direction",
    )

    @property
    def model(self) -> str:
        """What made the numbers."""
        return self.modes.model

    @property
    def status(self) -> str:
        """How good the table is, in words."""
        return self.modes.status

    def _particulars(self) -> dict[str, Any]:
        return {
            "beam": {
                "model": "timoshenko_beam_plane_strain",
                "frequency_Hz": self.beam_frequency,
                "amplitude_m_per_V": self.beam_amplitude_per_volt,
            },
            "shear_plate": None
            if self.shear_frequency is None
            else {
                "model": "shear_plate",
                "frequency_Hz": self.shear_frequency,
                "error_against_solid": self.shear_frequency / self.working.frequency - 1,
            },
        }


def parse_mode(text: str) -> tuple[int, int]:
    """The label of a mode from text such as ``"8,0"``. Raises `InputError` for anything else."""
    parts = text.strip("() ").split(",")
    if len(parts) == 2 and all(re.fullmatch(r"\s*[0-9]{1,9}\s*", part) for part in parts):
        label = int(parts[0]), int(parts[1])
        for lines in label:
            require_within(NODAL_LINES, max(lines, NODAL_LINES.least), "--mode")
        return label
    raise InputError(f"--mode '{text}' is no mode; write nodal lines across length, width: 8,0")


@dataclass(frozen=True)
class PlateRequest:
    """What `solve_plate` is asked for."""

    display: NamedDisplay
    _: KW_ONLY
    mode: tuple[int, int] | None = None
    band: tuple[si.Hertz, si.Hertz] | None = None
    points: int = 200
    progress: SayProgress | None = None
    budget: si.Second | None = None


@called_with(PlateRequest)
def analyze_plate(asked: PlateRequest) -> PlateAnalysis:
    """The modes of a display's plate in a band, and the response around the working mode.

    `mode` defaults to the display's own, (nodal lines, 0); `band` to ±8 % around it. `alone` in the
    result is the working mode solved by itself, to an estimated 0.1 % where meshes allow, those of
    the band to 0.3 %. Within a `budget` (s) meshes are left coarser, with
    larger errors, and the other modes of the band left out, as time asks.

    Raises `InputError` for a display without a rectangular plate or one that cannot be right (see
    `require_plausible`), `OutOfTimeError` for a budget that allows no solve, and what `solve_modes`
    raises: a band with no mode, a mode that is not found.
    """
    display, band = asked.display, asked.band
    plate = _driven_plate(display)
    if band is not None:
        check_band(band)
    tell = asked.progress or (lambda _: None)
    label = asked.mode or plate.working_label
    found = solved_plate(plate, label, band, asked.points, _Teller(asked.budget, tell))
    tell("airborne sound")
    response, alone = found.response, found.alone
    frequency = float(alone.frequencies[alone.index(label)])
    return PlateAnalysis(
        display=display,
        plate=plate,
        modes=found.modes,
        working_label=label,
        alone=alone,
        rows=tuple(mode_row(found.modes, index) for index in range(found.modes.count)),
        working=mode_row(alone, alone.index(label)),
        response=response,
        amplitude_per_volt=float(response.maximum[response.resonance]),
        centreline_per_volt=_centreline_per_volt(response, alone, label),
        circuit=found.circuit,
        beam_frequency=found.beam.mode.frequency,
        beam_amplitude_per_volt=found.beam.amplitude_per_volt,
        shear_frequency=found.shear_frequency,
        sound=plate_sound(response, response.resonance, frequency, display.drive.voltage),
        objections=(*require_plausible(display), *found.left_out),
    )


@dataclass(frozen=True)
class _Teller:
    """A budget (s), which the answer depends on, and who is told, which it does not."""

    budget: si.Second | None
    tell: SayProgress = field(compare=False)


class SolvedPlate(NamedTuple):
    """What a plate's analysis knows of the plate alone, whatever drives it and by which voltage."""

    alone: PlateModes
    modes: PlateModes
    response: HarmonicResponse
    circuit: EquivalentCircuit | None
    beam: BeamResponse
    shear_frequency: si.Hertz | None
    left_out: tuple[str, ...]


# A sweep over voltage asks the same plate at every point; one keeps 10 to 100 MB.
@functools.lru_cache(maxsize=2)
def solved_plate(
    plate: RectangularPlate,
    label: Label,
    band: tuple[si.Hertz, si.Hertz] | None,
    points: int,
    teller: _Teller,
) -> SolvedPlate:
    """The solves behind `analyze_plate`; those of the last two plates are kept."""
    tell, hurry = teller.tell, Hurry.of(plate, label, Pace(teller.budget))
    tell(f"mode ({label[0]},{label[1]})")
    shares = said_with_time_left(tell)
    alone, pieces = solve_for_response(plate, label, _WORKING, shares, hurry.modes)
    at = alone.index(label)
    frequency, quality = float(alone.frequencies[at]), float(alone.quality_factors[at])
    wanted = band or (0.92 * frequency, 1.08 * frequency)
    modes = alone
    if hurry.allows_band(plate, wanted):
        tell("all modes in the band")
        shares = said_with_time_left(tell)
        modes = solve_modes(
            plate, band=wanted, tolerance=_BESIDE, deadline=hurry.modes, progress=shares
        )
    tell(f"response at {points} frequencies")
    asked, mesh = sweep_around(frequency, quality, points), hurry.response_mesh(alone)
    # What a deadline left coarse would not be solved so again.
    solved_so = functools.partial(_response_again, plate, label, asked, mesh)
    again = None if mesh is COARSE else solved_so
    response = harmonic_response(plate, asked, resolution=mesh, solved=pieces, again=again)
    del pieces  # hundreds of megabytes
    try:
        circuit = response.equivalent_circuit()
    except InputError:
        circuit = None
    return SolvedPlate(
        alone,
        modes,
        response,
        circuit,
        beam_response(plate),
        _shear_frequency(plate, label, frequency),
        hurry.left_out(alone, modes),
    )


def _response_again(
    plate: RectangularPlate, label: Label, frequencies: si.HertzArray, resolution: Resolution
) -> HarmonicResponse:
    """The response of `solved_plate`: without its modes the reduced space would be another."""
    _, pieces = solve_for_response(plate, label, _WORKING)
    return harmonic_response(plate, frequencies, resolution=resolution, solved=pieces)


@reads_text
@called_with(PlateRequest)
def solve_plate(asked: PlateRequest) -> PlateAnalysis | RingAnalysis:
    """The modes of a display's plate, disc or stator in a band (Hz), and its working mode's
    response at `points` frequencies.

    Arguments and errors are those of `analyze_plate` and `analyze_ring`.
    """
    given, actuator = dict(vars(asked)), asked.display.actuator
    require_plausible(asked.display)
    if isinstance(actuator, RectangularPlate):
        return analyze_plate(**given)
    pace = Pace(given.pop("budget"))
    return analyze_ring(**given, pace=pace)


def _driven_plate(display: Display) -> RectangularPlate:
    """The display's rectangular plate, refused where it has none, or one that nothing drives."""
    plate = display.actuator
    if not isinstance(plate, RectangularPlate):
        raise InputError(
            f"display '{display.name}' has a {plate.type} and no rectangular plate; analyze_ring "
            "solves discs and stators"
        )
    if not any(patch.electrode == "driven" for patch in plate.patches):
        raise InputError(
            "no electrode is driven; give at least one patch electrode = 'driven'",
            quantity="patches",
        )
    return plate


def _centreline_per_volt(
    response: HarmonicResponse, alone: PlateModes, label: tuple[int, int]
) -> si.MetrePerVolt:
    """The largest amplitude on the centre line at resonance, between the mode's outer nodes."""
    x, line = centre_scan(response, response.resonance, label)
    nodes = zero_crossings(x, centre_profile(alone.shapes[alone.index(label)], alone, x, label))
    return float(np.max(np.abs(line)[within_nodes(x, nodes)]))


def scan_axis(label: tuple[int, int]) -> int:
    """The axis that the nodal lines cross: 0 along the length, 1 along the width."""
    return 0 if label[0] >= label[1] else 1


def centre_scan(
    response: HarmonicResponse, at: int, label: tuple[int, int], points: int = 201
) -> tuple[si.MetreArray, si.ComplexArray]:
    """Position and w per volt (m/V) at frequency number `at` along the middle of the plate, across
    the nodal lines of the mode."""
    plate = response.plate
    if scan_axis(label) == 0:
        return response.line(at, points)
    y = np.linspace(0, plate.width, points)
    return y, response.displacement(np.array([plate.length / 2]), y)[at, 0, :]


def centre_profile(
    shape: si.FloatArray, modes: PlateModes, position: si.MetreArray, label: tuple[int, int]
) -> si.FloatArray:
    """The profile of a mode's shape across its nodal lines, at `position` (m)."""
    axis = scan_axis(label)
    own = (modes.x, modes.y)[axis]
    return np.asarray(np.interp(position, own, profiles(shape)[axis]))


def _shear_frequency(
    plate: RectangularPlate, label: tuple[int, int], near: si.Hertz
) -> si.Hertz | None:
    """The same mode by the screening model; None where it has no such mode nearby."""
    try:
        return shear_mode(plate, label, near).frequency
    except InputError:
        return None


def mode_row(modes: PlateModes, index: int) -> ModeRow:
    """One line of the table of modes: that of the mode number `index` of a solved plate."""
    label, frequency = modes.labels[index], float(modes.frequencies[index])
    quality, force = float(modes.quality_factors[index]), float(modes.drive_forces[index])
    largest = float(np.max(np.abs(modes.shapes[index])))
    half = modes.half_wavelength(index)
    return ModeRow(
        label="in plane" if label is None else f"({label[0]},{label[1]})",
        frequency=frequency,
        frequency_error=float(modes.errors[index]),
        quality_factor=quality,
        amplitude_per_volt=quality * abs(force) * largest / (2 * np.pi * frequency) ** 2,
        coupling_coefficient=float(modes.couplings[index]),
        coupling_coefficient_error=float(modes.coupling_errors[index]),
        parallel_resonance_frequency=float(modes.open_frequencies[index]),
        parallel_resonance_frequency_error=float(modes.open_errors[index]),
        modal_force=force,
        half_wavelength=half if np.isfinite(half) else None,
    )


def parse_band(text: str) -> tuple[si.Hertz, si.Hertz]:
    """A band from text such as ``"25 kHz..45 kHz"`` (or with a colon between). Raises `InputError`
    for anything else."""
    from squeezefilm.quantities import parse_quantity

    parts = text.split(".." if ".." in text else ":")
    if len(parts) != 2:
        raise InputError(f"--band '{text}' is no band; write two frequencies: 25 kHz..45 kHz")
    low, high = (parse_quantity(part.strip(), si.Unit("Hz")) for part in parts)
    if low >= high:
        raise InputError(
            f"--band runs from {si.format_quantity(low, si.Unit('Hz'))} down to "
            f"{si.format_quantity(high, si.Unit('Hz'))}; write the lower frequency first"
        )
    return low, high
