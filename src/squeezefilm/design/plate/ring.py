"""Results of `squeezefilm plate` for a disc or a stator: modes in a band, and the response."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfTimeError
from squeezefilm.core.hard_limits import RING_MODES, require_within
from squeezefilm.core.kit.numbers import HZ, shown
from squeezefilm.core.progress import NO_HURRY, Deadline, Pace, SayProgress
from squeezefilm.core.results import to_json
from squeezefilm.design.plate.solved import ALONE, ModeRow, Remarks, SolvedBody, sweep_around
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.elements.box_model import require_half_wave
from squeezefilm.physics.plate.layout import AnnularStator, DiscPlate
from squeezefilm.physics.plate.ring.body import (
    Direction,
    RingBody,
    RingResponse,
    half_wavelength_of,
    nodal_circles,
    ring_body,
    ring_circuit,
    ring_response,
    static_capacitance,
)
from squeezefilm.physics.plate.ring.modes import DEFAULT_DEGREE, AnnularMode, annular_modes
from squeezefilm.physics.plate.solid.modes import check_band
from squeezefilm.physics.plate.sound import SoundField, ring_surface, sound_field
from squeezefilm.physics.plate.working_mode import ring_working_mode
from squeezefilm.physics.plausibility.checks import require_plausible
from squeezefilm.physics.plausibility.expected import expectation

_MOST_HARMONICS = 60
# What the parts take (s, one core, measured on the presets) of a disc and of a stator, which is
# fitted: the working mode; its response and sound; and of the band each number of nodal diameters.
_DISC, _STATOR, _BAND = (0.2, 0.8), (3.0, 3.2), 0.12
# Of the 121 radii of a response every fourth carries the sound: within 0.02 dB on the presets.
_RADII_OF_SOUND = slice(None, None, 4)


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class RingAnalysis(SolvedBody):
    """A solved disc or stator: table of modes, the working mode, its response and circuit.

    Modes are B(nodal circles, nodal diameters), or R and T in the plane. `annular` is the solved
    mode behind `mode`; of a stator `mode` is as measured, and what is computed of its amplitude
    stands beside it.
    """

    body: RingBody
    modes: tuple[AnnularMode, ...]
    annular: AnnularMode
    half_wavelength_along: Direction
    circles: si.MetreArray
    response: RingResponse

    @property
    def computed_per_volt(self) -> si.MetrePerVolt | None:
        """Computed amplitude of a stator, whose amplitude is measured, at the same place: at an
        antinode of the mean circumference (m/V). None for a disc, whose amplitude is computed."""
        if not isinstance(self.display.actuator, AnnularStator):
            return None
        w = np.abs(self.response.motion[self.resonance])
        return float(np.interp(self.scan_radius, self.response.radius, w))

    @property
    def scan_radius(self) -> si.Metre:
        """Radius of the scan around: the mean radius of the surface."""
        return float(np.mean(self.body.section.surface_radii))

    def _particulars(self) -> dict[str, Any]:
        return {
            "half_wavelength_along": self.half_wavelength_along,
            "nodal_circles_m": to_json(self.circles),
            "computed_per_volt_m_per_V": self.computed_per_volt,
            "fit": self._fit(),
        }

    def _fit(self) -> dict[str, Any] | None:
        fit = self.body.fit
        if fit is None:
            return None
        return {
            "ring_thickness_m": fit.ring_thickness,
            "fitted_to": {
                "frequency_Hz": fit.mode.frequency,
                "half_wavelength_m": fit.mode.half_wavelength,
            },
            "frequency_with_soft_and_stiff_teeth_Hz": list(fit.frequency_bounds),
            "assumed": to_json(fit.assumptions),
        }


def analyze_ring(
    display: Display,
    *,
    mode: tuple[int, int] | None = None,
    band: tuple[si.Hertz, si.Hertz] | None = None,
    points: int = 200,
    progress: SayProgress | None = None,
    pace: Pace = NO_HURRY,
) -> RingAnalysis:
    """The modes of a disc or stator in a band, and the response around the working mode.

    `mode` is (nodal circles, nodal diameters), by default the display's own; `band` ±8 % around it,
    of which only the working mode is solved where the budget of `pace` leaves no time for the
    others. Raises `InputError` for an actuator without rings, a band without modes, a mode that is
    not there; `UnreachableError` for a stator that cannot be fitted; `OutOfTimeError` for a budget
    that does not allow the working mode and its response.
    """
    actuator = display.actuator
    if not isinstance(actuator, AnnularStator | DiscPlate):
        raise InputError(f"display '{display.name}' has a {actuator.type}; no disc and no stator")
    if band is not None:
        check_band(band)
    deadline = _deadline(actuator, pace)
    tell = progress or (lambda _: None)
    tell("section" if isinstance(actuator, DiscPlate) else "fitting the stator's thickness")
    body = ring_body(actuator)
    label = mode or body.label
    tell(f"mode B({label[0]},{label[1]})")
    working = body.mode(label)
    limits = band or (0.92 * working.frequency, 1.08 * working.frequency)
    whole = deadline is None or deadline.allows(_BAND * (body.label[1] + 2))
    modes = modes_in_band(body, limits, tell) if whole else (working,)
    tell(f"response at {points} frequencies")
    response = _response(body, working, modes, points)
    driven = body.drives(working)
    circuit = ring_circuit(body, working, response) if driven else None
    capacitance = static_capacitance(body, circuit)
    rows = tuple(mode_row(body, listed, capacitance) for listed in modes)
    tell("airborne sound")
    return RingAnalysis(
        display=display,
        body=body,
        modes=modes,
        rows=rows,
        mode=ring_working_mode(actuator, body, working),
        annular=working,
        working=mode_row(body, working, capacitance),
        half_wavelength_along=half_wavelength_of(working)[1],
        circles=nodal_circles(working),
        response=response,
        resonance=response.resonance,
        largest_per_volt=float(response.maximum[response.resonance]),
        circuit=circuit,
        circuit_said="" if driven else "none: the channel does not drive this mode",
        sound=_sound(display, working, response),
        model=working.model + (", fitted stator" if body.fit is not None else ""),
        status=f"{len(rows)} modes in the band, within {largest_error(rows):.1e} (estimated)",
        remarks=_remarks(body),
        objections=(*require_plausible(display), *(() if whole else (ALONE,))),
    )


def _response(
    body: RingBody, working: AnnularMode, modes: Iterable[AnnularMode], points: int
) -> RingResponse:
    """The response around a mode by its own harmonic, those beside it, and those of `modes`."""
    sweep = sweep_around(working.frequency, working.quality_factor, points | 1)
    beside = {working.harmonic - 1, working.harmonic + 1} if working.harmonic else set()
    harmonics = sorted({working.harmonic, *beside, *(mode.harmonic for mode in modes)})
    return ring_response(body, working, sweep, harmonics)


def largest_error(rows: Iterable[ModeRow]) -> si.Dimensionless:
    """Largest estimated error of a frequency among modes, as a share of it."""
    return max(row.frequency_error / row.frequency for row in rows)


def _remarks(body: RingBody) -> Remarks:
    return Remarks(
        "(estimated)" + ("; fitted, not predicted" if body.fit is not None else ""),
        "largest, touched face",
        "from the losses of its materials"
        if body.quality_factor is None
        else "of the assembly, as described",
        "loudest direction, touched face only",
    )


def _deadline(actuator: AnnularStator | DiscPlate, pace: Pace) -> Deadline | None:
    """Time at which all must be there, with time kept for the response after the modes.

    Raises `OutOfTimeError`, with the answer of a closed estimate, where the budget does not allow
    the working mode and its response.
    """
    deadline = pace.deadline()
    if deadline is None:
        return None
    fitted = isinstance(actuator, AnnularStator)
    first, after = _STATOR if fitted else _DISC
    if not deadline.allows(first + after):
        seen = expectation(actuator)
        instead = "" if seen is None else f" Without a solve: {seen.sentence}."
        raise OutOfTimeError(
            f"the working mode of a {'stator, whose thickness is fitted,' if fitted else 'disc'} "
            f"and its response take about {first + after:.2g} s, more than the budget of "
            f"{pace.budget:.3g} s; allow more.{instead}",
            quantity="budget",
        )
    return deadline.earlier(after)


def mode_row(body: RingBody, mode: AnnularMode, capacitance: si.Farad) -> ModeRow:
    """A line of the table of modes; the modal force is that of unit modal mass (N/(V √kg)).

    The amplitude is that of u_z on the surface, which modes in the plane hardly move; the coupling
    is against the `capacitance` beside the mode.
    """
    lift = float(np.max(np.abs(mode.surface_shape)))
    coupling = mode.coupling_coefficient(body.drive, capacitance)
    return ModeRow(
        label=mode.label,
        frequency=mode.frequency,
        frequency_error=mode.frequency_error,
        quality_factor=mode.quality_factor,
        alone_per_volt=lift * mode.amplitude_per_volt(body.drive),
        coupling_coefficient=coupling,
        parallel_resonance_frequency=mode.frequency / math.sqrt(1 - coupling**2),
        modal_force=mode.modal_force(body.drive) / np.sqrt(mode.modal_mass),
        half_wavelength=half_wavelength_of(mode)[0],
    )


def modes_in_band(
    body: RingBody,
    band: tuple[si.Hertz, si.Hertz],
    progress: SayProgress | None = None,
    *,
    degree: Annotated[int, si.AtLeast(3), si.AtMost(12)] = DEFAULT_DEGREE,
) -> tuple[AnnularMode, ...]:
    """All elastic modes of a body in a band (Hz), rising; each stands for its two orientations.

    `degree` is that of the elements: one less is quicker, and less exact (`frequency_error`).

    Harmonics are tried until the lowest mode of one lies above the band, beyond the working one.
    Raises `InputError` where there is none, `OutOfRangeError` for a band of waves across a layer.
    """
    tell = progress or (lambda _: None)
    low, high = band
    require_half_wave(high, body.section.shear_times, "a band up to")
    in_band: list[AnnularMode] = []
    for m in range(_MOST_HARMONICS):
        tell(f"all modes in the band, {m} nodal diameters")
        count = 4
        while True:
            modes = annular_modes(
                body.section,
                m,
                near=(low + high) / 2,
                count=count,
                degree=degree,
                quality_factor=body.quality_factor,
            )
            inside = [x for x in modes if low <= x.frequency <= high and not x.is_rigid]
            # The nearest modes are all there are in the band once one of them lies outside.
            if len(inside) < len(modes):
                break
            require_within(RING_MODES, len(inside), "band", enough="ask for a narrower band")
            count *= 2
        in_band += inside
        if m > body.label[1] and all(x.frequency > high for x in modes):
            break
    if not in_band:
        raise InputError(
            f"no mode lies between {shown(low, HZ)} and {shown(high, HZ)}; widen the band, or "
            "leave it out for the modes around the working mode",
            quantity="band",
        )
    return tuple(sorted(in_band, key=lambda mode: mode.frequency))


def _sound(display: Display, mode: AnnularMode, response: RingResponse) -> SoundField:
    """The sound of the touched surface alone, in a baffle, at the display's voltage."""
    motion = display.drive.voltage * response.motion[response.resonance, _RADII_OF_SOUND]
    velocity = 2j * np.pi * mode.frequency * motion
    radius = response.radius[_RADII_OF_SOUND]
    return sound_field(ring_surface(radius, velocity, mode.harmonic, mode.frequency))
