"""Results of `squeezefilm plate`: the modes of a plate in a band, and its harmonic response.

`solve_plate` takes whatever a display has: a rectangle, which is solved here, a disc or a stator.
"""

from __future__ import annotations

import dataclasses
import functools
import re
from dataclasses import KW_ONLY, dataclass, field
from typing import Any, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import reads_text
from squeezefilm.core.called_with import called_with
from squeezefilm.core.errors import InputError, OutOfTimeError
from squeezefilm.core.hard_limits import NODAL_LINES, require_within
from squeezefilm.core.kit.numbers import HZ, shown
from squeezefilm.core.progress import Pace, SayProgress, said_with_time_left
from squeezefilm.design.plate.ring import RingAnalysis, analyze_ring
from squeezefilm.design.plate.solved import ALONE, ModeRow, Remarks, SolvedBody
from squeezefilm.physics.display import NamedDisplay
from squeezefilm.physics.plate.elements.nodal_lines import line_distance
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.forecast import band_seconds
from squeezefilm.physics.plate.solid.modes import Label, PlateModes, check_band
from squeezefilm.physics.plate.solid.resonances import antinode, label_name
from squeezefilm.physics.plate.solid.response import HarmonicResponse
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.plate.solid.working import SolidMode, response_frequencies, solid_mode
from squeezefilm.physics.plate.sound import sound_field
from squeezefilm.physics.plate.working_mode import solid_working_mode
from squeezefilm.physics.plausibility.checks import require_plausible
from squeezefilm.physics.plausibility.expected import expectation

# Estimated error (relative) of the band's modes above which a finer mesh is taken.
_BESIDE = 3e-3
_REMARKS = Remarks(
    "(estimated)", "largest, upper face", "from the losses of its materials", "loudest direction"
)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class PlateAnalysis(SolvedBody):
    """The solved plate: table of modes, the working mode as every verb has it, its response.

    `solid` is the solved mode behind `mode`, `modes` those of the band, whose table is `rows`;
    `response` is that of `solid`, at the number of frequencies that was asked for.
    """

    plate: RectangularPlate
    solid: SolidMode
    working_label: Label
    modes: PlateModes
    response: HarmonicResponse

    def _particulars(self) -> dict[str, Any]:
        beam = self.mode.beam
        if beam is None:
            return {"beam": None}
        return {
            "beam": {
                "model": beam.model,
                "frequency_Hz": beam.mode.frequency,
                "amplitude_m_per_V": beam.amplitude_per_volt,
            },
        }


def parse_mode(text: str) -> tuple[int, int]:
    """The label of a mode from text such as ``"8,0"``. Raises `InputError` for anything else."""
    parts = text.strip("() ").split(",")
    if len(parts) == 2 and all(re.fullmatch(r"\s*[0-9]{1,9}\s*", part) for part in parts):
        label = int(parts[0]), int(parts[1])
        for lines in label:
            require_within(NODAL_LINES, max(lines, NODAL_LINES.least), "mode")
        return label
    raise InputError(f"mode '{text}' is no mode; write nodal lines across length, width: 8,0")


@si.checked_numbers
@dataclass(frozen=True)
class PlateRequest:
    """Arguments of `solve_plate`."""

    display: NamedDisplay
    _: KW_ONLY
    mode: tuple[int, int] | None = None
    band: tuple[si.Hertz, si.Hertz] | None = None
    points: int = 200
    progress: SayProgress | None = None
    budget: si.Second | None = None


@reads_text
@called_with(PlateRequest)
def solve_plate(asked: PlateRequest) -> PlateAnalysis | RingAnalysis:
    """The modes of a display's plate, disc or stator in a band (Hz), and its working mode's
    response at `points` frequencies.

    `mode` is by nodal lines across length and width, of a disc or stator (nodal circles, nodal
    diameters). It defaults to the display's own, `band` to ±8 % around it. A plate's mode and its
    response are those of `solid_mode`, which every other verb reads too. Within a `budget` (s)
    meshes are left coarser, with larger errors, and the other modes of the band left out, as time
    asks.

    Raises `InputError` for a display that cannot be right (see `require_plausible`) or that nothing
    drives, `OutOfTimeError` for a budget that allows no solve, and what `solve_modes` raises: a
    band with no mode, a mode that is not found. Of discs and stators those of `analyze_ring`.
    """
    doubts, actuator = require_plausible(asked.display), asked.display.actuator
    if isinstance(actuator, RectangularPlate):
        return _of_rectangle(asked, actuator, doubts)
    given = dict(vars(asked))
    pace = Pace(given.pop("budget"))
    return analyze_ring(**given, pace=pace)


def _of_rectangle(
    asked: PlateRequest, plate: RectangularPlate, doubts: tuple[str, ...]
) -> PlateAnalysis:
    """The analysis of a rectangular plate; `doubts` are those about its description."""
    if not any(patch.electrode == "driven" for patch in plate.patches):
        raise InputError(
            "no electrode is driven; give at least one patch electrode = 'driven'",
            quantity="patches",
        )
    if asked.band is not None:
        check_band(asked.band)
    display, tell = asked.display, asked.progress or (lambda _: None)
    label = asked.mode or plate.working_label
    solved = solved_plate(plate, label, asked.band, _Teller(asked.budget, tell))
    solid = solved.solid
    response, at = _resampled(solid, asked.points)
    tell("airborne sound")
    return PlateAnalysis(
        display=display,
        plate=plate,
        mode=solid_working_mode(plate, solid, label),
        solid=solid,
        working_label=label,
        modes=solved.modes,
        rows=tuple(mode_row(solved.modes, index) for index in range(solved.modes.count)),
        working=dataclasses.replace(
            mode_row(solid.modes, solid.index), alone_per_volt=solid.alone_per_volt
        ),
        response=response,
        resonance=at,
        largest_per_volt=solid.largest_per_volt,
        circuit=solid.circuit,
        circuit_said=solid.circuit_said,
        model=solved.modes.model,
        status=solved.modes.status,
        remarks=_REMARKS,
        sound=sound_field(solid.radiating(display.drive.voltage, solid.frequency)),
        objections=(*doubts, *solved.left_out),
    )


def _resampled(solid: SolidMode, points: int) -> tuple[HarmonicResponse, int]:
    """A mode's response at so many frequencies, its resonance among them; and which that is."""
    if points == solid.response.frequencies.size:
        return solid.response, solid.resonance
    top = float(solid.response.frequencies[solid.resonance])
    asked = response_frequencies(solid.frequency, solid.quality_factor, points)
    known = solid.response.frequencies[[0, -1]]
    frequencies = np.union1d(np.clip(asked, *known), top)
    return solid.response.at(frequencies), int(np.searchsorted(frequencies, top))


@dataclass(frozen=True)
class _Teller:
    """A budget (s), which the answer depends on, and who is told, which it does not."""

    budget: si.Second | None
    tell: SayProgress = field(compare=False)


class SolvedPlate(NamedTuple):
    """Analysis of the plate alone, whatever drives it and by which voltage."""

    solid: SolidMode
    modes: PlateModes
    left_out: tuple[str, ...]


# A sweep over voltage asks the same plate at every point; one keeps 10 to 100 MB.
@functools.lru_cache(maxsize=2)
def solved_plate(
    plate: RectangularPlate,
    label: Label,
    band: tuple[si.Hertz, si.Hertz] | None,
    teller: _Teller,
) -> SolvedPlate:
    """The solves of a rectangular plate; those of the last two are kept.

    Raises `OutOfTimeError`, with the answer of a closed estimate, where the budget does not allow
    the coarse meshes.
    """
    tell, deadline = teller.tell, Pace(teller.budget).deadline()
    tell(f"mode ({label[0]},{label[1]}) and its response")
    try:
        solid = solid_mode(plate, label, pace=Pace(teller.budget, said_with_time_left(tell)))
    except OutOfTimeError as error:
        if (seen := expectation(plate)) is None:
            raise
        said = f"{error}. Without a solve: {seen.sentence}."
        raise OutOfTimeError(said, quantity="budget") from error
    frequency, modes = solid.frequency, solid.modes
    left_out = [modes.coarseness] if modes.coarseness else []
    wanted = band or (0.92 * frequency, 1.08 * frequency)
    if deadline is None or deadline.allows(band_seconds(plate, wanted[1])):
        tell("all modes in the band")
        shares = said_with_time_left(tell)
        modes = solve_modes(
            plate, band=wanted, tolerance=_BESIDE, deadline=deadline, progress=shares
        )
    else:
        left_out.append(ALONE)
    return SolvedPlate(solid, modes, tuple(left_out))


def mode_row(modes: PlateModes, index: int) -> ModeRow:
    """A line of the table of modes: that of the mode number `index` of a solved plate."""
    label, frequency = modes.labels[index], float(modes.frequencies[index])
    quality, force = float(modes.quality_factors[index]), float(modes.drive_forces[index])
    shape, nodes = modes.shapes[index], modes.nodal_positions(index)
    answer = quality * abs(force) / (2 * np.pi * frequency) ** 2
    return ModeRow(
        label=label_name(label),
        frequency=frequency,
        frequency_error=float(modes.errors[index]),
        quality_factor=quality,
        alone_per_volt=answer * antinode(shape, label),
        coupling_coefficient=float(modes.couplings[index]),
        coupling_coefficient_error=float(modes.coupling_errors[index]),
        parallel_resonance_frequency=float(modes.open_frequencies[index]),
        parallel_resonance_frequency_error=float(modes.open_errors[index]),
        modal_force=force,
        half_wavelength=line_distance(nodes) if nodes.size >= 2 else None,
    )


def parse_band(text: str) -> tuple[si.Hertz, si.Hertz]:
    """A band from text such as ``"25 kHz..45 kHz"`` (or with a colon between). Raises `InputError`
    for anything else."""
    from squeezefilm.core.quantities import parse_quantity

    parts = text.split(".." if ".." in text else ":")
    if len(parts) != 2:
        raise InputError(f"band '{text}' is no band; write two frequencies: 25 kHz..45 kHz")
    low, high = (parse_quantity(part.strip(), HZ) for part in parts)
    if low >= high:
        raise InputError(
            f"band runs from {shown(low, HZ)} down to {shown(high, HZ)}; write the lower frequency "
            "first"
        )
    return low, high
