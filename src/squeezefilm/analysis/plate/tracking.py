"""The frequencies of a plate's modes against one of its parameters, each mode kept its label.

Labels count nodal lines and jump where they should not; here a mode is followed by its motion
(modal assurance criterion): alike to itself at the value before and to itself where the tracking
began. Where two modes come near each other and exchange their motions, the line so follows the
motion, not the order of frequencies.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.analysis.parameters import value_at, with_values
from squeezefilm.errors import InputError
from squeezefilm.hard_limits import TRACKED_VALUES, require_within
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.solid.modes import Label, PlateModes
from squeezefilm.plate.solid.solve import solve_modes
from squeezefilm.progress import SayProgress

_ALIKE = 0.6  # below it the step is halved
_LOST = 0.4  # below it, at the smallest step, the mode is given up
_HALVINGS = 2
_GRID = (49, 33)
_REACH = 0.08  # of the working mode's frequency: the modes that are followed


# By value: the modes there, which of them each tracked one is, and how alike it is.
_Steps = dict[float, tuple[PlateModes, list[int | None], list[float]]]

PARAMETERS: dict[str, tuple[si.Unit, str]] = {
    "ceramic_thickness": (si.Unit("m"), "patches.*.thickness"),
    "thickness": (si.Unit("m"), "thickness"),
    "young_modulus": (si.Unit("Pa"), "substrate.young_modulus"),
    "density": (si.Unit("kg/m3"), "substrate.density"),
    "poisson_ratio": (si.Unit("1"), "substrate.poisson_ratio"),
    "glue_thickness": (si.Unit("m"), "glue.thickness"),
    "glue_young_modulus": (si.Unit("Pa"), "glue.young_modulus"),
}
"""What `track_modes` can vary: its unit, and its path in a plate."""


@si.checked_numbers
@dataclass(frozen=True)
class TrackRequest:
    """A parameter of `PARAMETERS`, its first and last value (SI) and the number of values."""

    parameter: str
    start: float
    stop: float
    values: int = 9

    def __post_init__(self) -> None:
        if self.parameter not in PARAMETERS:
            raise InputError(
                f"--track '{self.parameter}' cannot be varied."
                f"{si.did_you_mean(self.parameter, PARAMETERS)} Allowed: {', '.join(PARAMETERS)}",
                quantity="track",
            )
        if not self.start < self.stop:
            raise InputError("--from must be smaller than --to", quantity="track")
        require_within(TRACKED_VALUES, self.values, "--values")

    def changed(self, plate: RectangularPlate, value: float) -> RectangularPlate:
        """A plate with another value of the parameter."""
        return with_values(plate, {PARAMETERS[self.parameter][1]: value})


@dataclass(frozen=True, eq=False)
class ModeTrack:
    """One mode over the values: its label where the tracking began, frequencies (NaN beyond where
    it was lost), and how alike it was to the value before or to the beginning (the larger)."""

    label: str
    frequency: si.HertzArray
    likeness: si.FloatArray
    driven: bool


@dataclass(frozen=True, eq=False)
class ModeTracks:
    """Modes over the values of a parameter (SI unit `unit`); `own` is the plate's own value, and
    `begun` the value at which the labels were read."""

    parameter: str
    unit: str
    values: si.FloatArray
    own: float
    begun: float
    tracks: tuple[ModeTrack, ...]
    least_likeness: si.Dimensionless


def parse_track(parameter: str, start: str | None, stop: str | None, values: int) -> TrackRequest:
    """A request from texts such as ``"0.5 mm"``. Raises `InputError` for anything else."""
    unit = PARAMETERS[parameter][0] if parameter in PARAMETERS else si.Unit("1")
    if start is None or stop is None:
        raise InputError('--track needs --from and --to, like --from "0.5 mm" --to "1.5 mm"')
    if parameter not in PARAMETERS:
        return TrackRequest(parameter, 0.0, 1.0, values)
    if unit.symbol == "1":
        try:
            return TrackRequest(parameter, float(start), float(stop), values)
        except ValueError as error:
            raise InputError(f"--from and --to of {parameter} are plain numbers") from error
    return TrackRequest(
        parameter, si.parse_quantity(start, unit), si.parse_quantity(stop, unit), values
    )


def track_modes(
    plate: RectangularPlate,
    request: TrackRequest,
    *,
    label: Label | None = None,
    progress: SayProgress | None = None,
) -> ModeTracks:
    """Follow the modes within 8 % of the working mode's frequency (or of the one with `label`)
    over a parameter's values.

    Labels are read at the plate's own value where it lies between the values, else at the first.
    Where a mode is less than 0.6 alike both to itself at the value before and to itself at the
    beginning, the step is halved up to twice (the values in between are kept); less than 0.4
    alike, it is lost from there on. Raises
    `InputError` for a plate without the glue that is to be varied and what `solve_modes` raises.
    """
    check_track(plate, request)
    unit, path = PARAMETERS[request.parameter]
    tell = progress or (lambda _: None)
    values = np.linspace(request.start, request.stop, request.values)
    # Where ceramics differ, their mean.
    own = plate.ceramic_thickness if "patches" in path else value_at(plate, path)[0]
    begun = own if request.start <= own <= request.stop else request.start
    tell(f"{request.parameter} = {_shown(begun, unit)}")
    working = label or (plate.nodal_lines, 0)
    alone = solve_modes(request.changed(plate, begun), mode=working)
    f0 = float(alone.frequencies[alone.index(working)])
    band = (1 - _REACH) * f0, (1 + _REACH) * f0
    first = solve_modes(request.changed(plate, begun), band=band)
    steps: _Steps = {begun: (first, list(range(first.count)), [1.0] * first.count)}
    for side in (
        values[values > begun + 1e-12 * abs(begun)],
        values[values < begun - 1e-12 * abs(begun)][::-1],
    ):
        last = begun
        for value in side:
            _advance(plate, request, first, last, float(value), steps, _HALVINGS, tell)
            last = float(value)
    tracks = _tracks(first, steps)
    least = float(np.nanmin([one.likeness for one in tracks]))
    every = np.array(sorted(steps))
    return ModeTracks(request.parameter, unit.symbol, every, own, begun, tracks, least)


def _tracks(first: PlateModes, steps: _Steps) -> tuple[ModeTrack, ...]:
    """Each mode of where the tracking began, over all values, rising."""
    shape = (first.count, len(steps))
    frequency, likeness = np.full(shape, np.nan), np.full(shape, np.nan)
    for column, value in enumerate(sorted(steps)):
        modes, numbers, alike = steps[value]
        for row, number in enumerate(numbers):
            if number is not None:
                frequency[row, column] = modes.frequencies[number]
                likeness[row, column] = alike[row]
    driven = np.abs(first.drive_forces) > 1e-6 * np.max(np.abs(first.drive_forces))
    return tuple(
        ModeTrack(
            "in plane" if label is None else f"({label[0]},{label[1]})",
            frequency[row],
            likeness[row],
            bool(driven[row]),
        )
        for row, label in enumerate(first.labels)
    )


def check_track(plate: RectangularPlate, request: TrackRequest) -> None:
    """Refuse, before anything is solved, a parameter that the plate has not or an end it cannot
    have. Raises `InputError`."""
    if request.parameter.startswith("glue") and plate.glue is None:
        raise InputError(
            f"--track {request.parameter}: the plate has no glue; add [actuator.glue] to its file"
        )
    for end in (request.start, request.stop):
        request.changed(plate, end)


def likeness(before: PlateModes, after: PlateModes) -> si.FloatArray:
    """How alike each mode of one plate moves to each of another, shape (before, after): 1 for the
    same motion of both faces in all three directions, 0 for orthogonal ones.

    Over relative coordinates; unlike `plate_modes.tracked` it tells modes apart that move mostly in
    the plane.
    """

    def motions(modes: PlateModes) -> si.FloatArray:
        x = np.linspace(0, modes.plate.length, _GRID[0])
        y = np.linspace(0, modes.plate.width, _GRID[1])
        faces = (0.0, modes.plate.thickness)
        rows = [
            np.concatenate([modes.field(i, x, y, z).ravel() for z in faces])
            for i in range(modes.count)
        ]
        out = np.stack(rows)
        return np.asarray(out / np.linalg.norm(out, axis=1, keepdims=True))

    return np.asarray((motions(before) @ motions(after).T) ** 2)


def _shown(value: float, unit: si.Unit) -> str:
    return f"{value:.4g}" if unit.symbol == "1" else si.format_quantity(value, unit)


def _advance(
    plate: RectangularPlate,
    request: TrackRequest,
    first: PlateModes,
    last: float,
    value: float,
    steps: _Steps,
    halvings: int,
    tell: SayProgress,
) -> None:
    """Follow the modes from one value to the next, with values in between where needed."""
    from scipy.optimize import linear_sum_assignment

    tell(f"{request.parameter} = {_shown(value, PARAMETERS[request.parameter][0])}")
    before, numbers, _ = steps[last]
    known = [n for n in numbers if n is not None]
    if not known:
        steps[value] = (before, numbers, [0.0] * len(numbers))  # all are lost, and stay so
        return
    lowest = float(before.frequencies[min(known)])
    highest = float(before.frequencies[max(known)])
    band = 0.94 * lowest, 1.06 * highest
    after = solve_modes(request.changed(plate, value), band=band)
    rows = [row for row, n in enumerate(numbers) if n is not None]
    to_last = likeness(before, after)[known]
    to_first = likeness(first, after)[rows]
    best = np.maximum(to_last, to_first)
    found: list[int | None] = [None] * len(numbers)
    alikes = [0.0] * len(numbers)
    # What a mode was at the beginning is what its label means: it counts twice.
    for i, k in zip(*linear_sum_assignment(-(to_last + 2 * to_first)), strict=True):
        alikes[rows[i]] = float(best[i, k])
        found[rows[i]] = int(k) if best[i, k] >= _LOST else None
    worst = min(alikes[row] for row in rows)
    if worst < _ALIKE and halvings:
        middle = (last + value) / 2
        _advance(plate, request, first, last, middle, steps, halvings - 1, tell)
        if middle in steps:
            _advance(plate, request, first, middle, value, steps, halvings - 1, tell)
        return
    steps[value] = (after, found, alikes)
