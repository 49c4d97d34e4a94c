"""Modes followed by their shapes over the points of a sweep, each under the label it had first.

Labels count nodal lines and jump where they should not; here a mode is followed by its motion
(modal assurance criterion): alike to itself at the point before and to itself where the following
began. Where two modes come near each other and exchange their motions, the line so follows the
motion, not the order of frequencies. Each point is solved by itself, so that points can be answered
in any order, and be kept; with its numbers each mode leaves a sample of its motion.
"""

from __future__ import annotations

import base64
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.results import Result, to_json
from squeezefilm.design.plate.command import mode_row
from squeezefilm.design.plate.solved import ModeRow
from squeezefilm.physics.display import Display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.solid.modes import PlateModes
from squeezefilm.physics.plate.solid.solve import solve_modes

LOST = 0.4
"""Likeness (modal assurance criterion) to itself at the nearest point and where the following
began, below which a mode counts as lost."""
REACH = 0.12
"""Share of the working mode's frequency: the modes around it that are followed, without a band."""
_GRID = (33, 21)


@dataclass(frozen=True, eq=False, repr=False)
class ModesToFollow(Result):
    """The modes of one point: their numbers, and a sample of each one's motion, shape (modes,
    places), of unit length."""

    rows: tuple[ModeRow, ...]
    motions: si.FloatArray

    def summary(self) -> dict[str, Any]:
        """The numbers, and the motions as text."""
        return {"modes": to_json(self.rows), "motions": packed(self.motions)}


def modes_to_follow(
    display: Display, *, band: tuple[si.Hertz, si.Hertz] | None = None
) -> ModesToFollow:
    """The modes of a display's rectangular plate in a band (Hz), 12 % around its working mode
    without one, with a sample of their motions on both faces.

    Raises `InputError` for a disc or a stator, whose modes keep their labels, and what
    `solve_modes` raises.
    """
    plate = display.actuator
    if not isinstance(plate, RectangularPlate):
        raise InputError(
            f"modes are followed on rectangular plates; those of a {plate.type.replace('_', ' ')} "
            "keep their labels: ask for plate.modes.0.frequency and so on"
        )
    if band is None:
        alone = solve_modes(plate, mode=plate.working_label)
        frequency = float(alone.frequencies[alone.index(plate.working_label)])
        band = (1 - REACH) * frequency, (1 + REACH) * frequency
    modes = solve_modes(plate, band=band)
    rows = tuple(mode_row(modes, index) for index in range(modes.count))
    return ModesToFollow(rows, sampled_motions(modes))


def sampled_motions(modes: PlateModes) -> si.FloatArray:
    """The motion of every mode of both faces in all three directions over relative coordinates,
    shape (modes, places), of unit length: the square of a product of two is how alike they are."""
    plate = modes.plate
    x, y = np.linspace(0, plate.length, _GRID[0]), np.linspace(0, plate.width, _GRID[1])
    faces = (0.0, plate.thickness)
    rows = [
        np.concatenate([modes.field(number, x, y, z).ravel() for z in faces])
        for number in range(modes.count)
    ]
    out = np.stack(rows)
    return np.asarray(out / np.linalg.norm(out, axis=1, keepdims=True))


def packed(motions: si.FloatArray) -> dict[str, Any]:
    """Motions as JSON keeps them; in half precision a likeness is within a thousandth."""
    half = np.ascontiguousarray(motions, dtype="<f2")
    return {"shape": list(half.shape), "base64": base64.b64encode(half.tobytes()).decode()}


def unpacked(kept: dict[str, Any]) -> si.FloatArray:
    """The motions of `packed`, again of unit length."""
    half = np.frombuffer(base64.b64decode(kept["base64"]), dtype="<f2").reshape(kept["shape"])
    full = half.astype(float)
    return np.asarray(full / np.linalg.norm(full, axis=1, keepdims=True))


@dataclass(frozen=True, eq=False)
class FollowedMode:
    """A mode over the points: its label where the following began, which of each point's modes it
    is (None where it was lost or nothing is known), how alike it is there to itself at the point
    before or at the beginning (the larger), and whether the drive moves it where it began."""

    label: str
    numbers: tuple[int | None, ...]
    likeness: si.FloatArray
    driven: bool

    @property
    def lost(self) -> bool:
        """True where it was lost at a point."""
        return None in self.numbers

    @property
    def least_likeness(self) -> si.Dimensionless:
        """Least likeness where it was not lost."""
        pairs = zip(self.numbers, self.likeness.tolist(), strict=True)
        return float(min(alike for number, alike in pairs if number is not None))

    def values(self, summaries: Sequence[dict[str, Any] | None], quantity: str) -> si.FloatArray:
        """Values of a quantity of the mode over the points; NaN where it was lost."""
        out = np.full(len(self.numbers), np.nan)
        for at, (number, summary) in enumerate(zip(self.numbers, summaries, strict=True)):
            if number is not None and summary is not None:
                value = summary["modes"][number][quantity]
                out[at] = np.nan if value is None else value
        return out


def followed_modes(
    summaries: Sequence[dict[str, Any] | None], shape: tuple[int, ...], begin: int
) -> tuple[FollowedMode, ...]:
    """The modes of the point `begin` followed over a grid of points of a `shape`, in C order;
    those that the drive moves come first.

    `summaries` are those of `ModesToFollow`, None where a point has none. From the first point the
    following goes from neighbour to neighbour; a mode that is less than 0.4 alike both to itself at
    the neighbour and to itself at the beginning is lost from there on.
    """
    from scipy.optimize import linear_sum_assignment

    first = summaries[begin]
    if first is None:
        return ()
    motions = [None if summary is None else unpacked(summary["motions"]) for summary in summaries]
    origin = motions[begin]
    assert origin is not None
    count = len(origin)
    numbers: list[list[int | None]] = [[None] * count for _ in summaries]
    alike = np.full((len(summaries), count), np.nan)
    numbers[begin], alike[begin] = list(range(count)), 1.0
    for before, after in _neighbours(shape, begin, [motion is not None for motion in motions]):
        there, here = motions[before], motions[after]
        assert there is not None
        assert here is not None
        known = [row for row, number in enumerate(numbers[before]) if number is not None]
        if not known:
            continue
        to_last = (there[[numbers[before][row] for row in known]] @ here.T) ** 2  # type: ignore[index]
        to_first = (origin[known] @ here.T) ** 2
        best = np.maximum(to_last, to_first)
        # What a mode was at the beginning is what its label means: it counts twice.
        for i, k in zip(*linear_sum_assignment(-(to_last + 2 * to_first)), strict=True):
            alike[after, known[i]] = best[i, k]
            numbers[after][known[i]] = int(k) if best[i, k] >= LOST else None
    said = [str(row["label"]) for row in first["modes"]]
    labels = [
        label if said[:k].count(label) == 0 else f"{label} #{said[:k].count(label) + 1}"
        for k, label in enumerate(said)
    ]
    forces = np.array([abs(row["modal_force"]) for row in first["modes"]])
    modes = (
        FollowedMode(
            labels[number],
            tuple(point[number] for point in numbers),
            alike[:, number],
            bool(forces[number] > 1e-6 * forces.max()),
        )
        for number in range(count)
    )
    return tuple(sorted(modes, key=lambda mode: not mode.driven))


def _neighbours(
    shape: tuple[int, ...], begin: int, known: Sequence[bool]
) -> Iterator[tuple[int, int]]:
    """Pairs of a point that was reached and a neighbour that was not, the nearest first."""
    grid = np.arange(int(np.prod(shape))).reshape(shape)
    reached, front = {begin}, [begin]
    while front:
        point = front.pop(0)
        place = np.unravel_index(point, shape)
        for axis in range(len(shape)):
            for step in (-1, 1):
                to = [int(p) for p in place]
                to[axis] += step
                # Over a point without an answer to the one behind it.
                while 0 <= to[axis] < shape[axis] and not known[grid[tuple(to)]]:
                    to[axis] += step
                if not 0 <= to[axis] < shape[axis]:
                    continue
                other = int(grid[tuple(to)])
                if other not in reached:
                    reached.add(other)
                    front.append(other)
                    yield point, other
