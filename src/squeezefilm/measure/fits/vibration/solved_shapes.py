"""Scans beside the solved shapes of a plate: a line as a multiple of its face's motion at its
resonance, and which mode a scan over the face is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, NamedTuple

import numpy as np
from scipy.interpolate import RectBivariateSpline

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import (
    Adequacy,
    Estimate,
    FitResult,
    Observation,
    adequacy_of,
    amplitude_over,
    guarded_fit,
)
from squeezefilm.measure.fits.least_squares import SeparableFit, fit_separable, linear_fit
from squeezefilm.measure.recordings.kinds import GridScan
from squeezefilm.physics.plate.solid.modes import PlateModes
from squeezefilm.physics.plate.solid.resonances import label_name
from squeezefilm.physics.plate.solid.working import SolidMode

REST = "what else the drive moves"
"""The label of the motion that is not the working mode's, beside the labels of modes."""


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class DrivenShape:
    """The motion of a face at places `x`, `y` (m), shapes (x, y), at a resonance: `swing` in phase
    with the best antinode, 1 there, and `rest` a quarter of a period away from that, 0 there.

    At its resonance a mode answers a quarter of a period late; all others that the drive moves,
    among them those far away in frequency, answer at once. They are what a scan has beside the
    mode, of some per cent, and no neighbour alone describes them. `lobe` (m) is the antinode's
    place, `lengthwise` says that nodal lines lie across the length; `half_wavelength` (m) is the
    mode's, of its profile over the whole face, which differs from that along one line.
    """

    x: si.MetreArray
    y: si.MetreArray
    swing: si.DimensionlessArray
    rest: si.DimensionlessArray
    lobe: tuple[si.Metre, si.Metre]
    lengthwise: bool
    half_wavelength: si.Metre

    @classmethod
    def of(cls, mode: SolidMode) -> DrivenShape:
        """Shape of a solved mode at its own resonance."""
        response, at = mode.driven_at()
        x, y = mode.modes.x, mode.modes.y
        there = response.motion(at, *(np.array([place]) for place in mode.lobe))[0, 0]
        turned = response.motion(at, x, y) / there
        lines = mode.modes.labels[mode.index] or (1, 0)
        lengthwise = lines[0] >= lines[1]
        half = mode.half_wavelength
        return cls(x, y, turned.real, turned.imag, mode.lobe, lengthwise, half)

    @cached_property
    def _splines(self) -> tuple[RectBivariateSpline, RectBivariateSpline]:
        swing, rest = (
            RectBivariateSpline(self.x, self.y, motion) for motion in (self.swing, self.rest)
        )
        return swing, rest

    @si.checked_numbers
    def at(self, x: si.MetreArray, y: si.MetreArray) -> si.DimensionlessArray:
        """Swing and rest (2, points) at places (m); beside the face those of its edge.

        Raises `InputError` for places that are no rows of one length.
        """
        si.require_alike(x=x, y=y)
        return np.array([spline.ev(x, y) for spline in self._splines])

    @si.checked_numbers
    def along(self, position: si.MetreArray) -> si.DimensionlessArray:
        """Swing and rest (2, points) along the line through the best antinode that crosses the
        nodal lines, from the face's edge (m)."""
        if self.lengthwise:
            return self.at(position, np.full(position.size, self.lobe[1]))
        return self.at(np.full(position.size, self.lobe[0]), position)

    @property
    def antinode(self) -> si.Metre:
        """Place of the best antinode on that line (m)."""
        return self.lobe[0 if self.lengthwise else 1]


class LineByShape(NamedTuple):
    """A line scan as a multiple of a solved shape: the antinode's `amplitude` (m) and `phase` (rad,
    None without a recorded one), the `offset` (m) of the scan's zero from the face's edge, and the
    fitted `model` (m, (points,)) of data whose sign of the phase is right."""

    amplitude: Estimate
    phase: Estimate | None
    offset: Estimate
    model: si.Array
    phase_reversed: bool
    adequacy: Adequacy


@si.checked_numbers
def line_by_shape(
    shape: DrivenShape,
    x: Annotated[si.MetreArray, si.Rising(2)],
    w: si.Array,
    *,
    reach: Annotated[si.Metre, si.Above(0.0)],
) -> LineByShape:
    """The shape of the line that fits displacements `w` (m, real or complex) at rising `x` (m).

    Swing and rest have each a weight of its own; the line may begin up to `reach` (m) from the
    face's edge. The line is taken to run through the best antinode. Raises `InputError` where
    there are fewer points than numbers, the places do not rise, or nothing moves.
    """
    w = np.asarray(w)
    if w.dtype.kind not in "fc" or not np.all(np.isfinite(w)) or not np.any(w):
        raise InputError("w must be finite displacements, not all of them 0", quantity="w")
    si.require_alike(x=x, w=w)
    recorded = np.iscomplexobj(w)

    def rows(offset: float) -> si.Array:
        swing, rest = shape.along(x + offset)
        return np.stack([swing, rest] if recorded else [swing], axis=1)

    def columns(own: si.FloatArray) -> tuple[si.Array, si.Array]:
        offset, step = float(own[0]), 1e-3 * reach
        bent = (rows(offset + step) - rows(offset - step)) / (2 * step)
        return rows(offset), bent[None]

    size = float(np.max(np.abs(w)))
    fit = fit_separable(columns, w / size, np.zeros(1), reach=reach)
    reversed_ = False
    if recorded:
        # The rest moves at once and the mode late: ahead of the swing, unless the sign is wrong.
        ahead = fit.estimate(lambda _, c: float((c[1] * np.conj(c[0])).imag), "1")
        reversed_ = ahead.interval[1] < 0
    if reversed_:
        w = w.conj()
        fit = fit_separable(columns, w / size, np.zeros(1), reach=reach)
    adequacy = adequacy_of(
        w,
        fit.residual * size,
        lambda i: f"{1e3 * x[i]:.3g} mm along the line",
        model="The plate's solved shape",
        said="No even wave fits, as on any plate with ceramics. "
        + ("The phase was recorded with the other sign. " if reversed_ else ""),
        remedy="Check that the line runs through the best antinode from the plate's edge, or doubt "
        "the solved plate.",
    )
    return LineByShape(
        amplitude=fit.estimate(lambda _, c: size * float(abs(c[0])), "m", positive=True),
        phase=fit.angle(lambda _, weights: complex(weights[0])) if recorded else None,
        offset=fit.estimate(lambda numbers, _: float(numbers[0]), "m"),
        model=fit.model * size,
        phase_reversed=reversed_,
        adequacy=adequacy,
    )


SAME_SHAPE: si.Dimensionless = 0.95
"""Criterion from which a scan is called the shape that it is compared with."""

_FEWEST_POINTS = 12
# Shapes that a scan's places cannot tell apart.
_ALIKE = 0.98


@dataclass(frozen=True, eq=False, repr=False)
class GridScanFit(FitResult):
    """A scan as a sum of shapes, the one that it is most alike named `label`.

    `likeness` is the modal assurance criterion of the scan with every shape: 1 for the same, 0 for
    an orthogonal one; noise alone would leave `attainable` of a perfect one. `amplitude` (m, zero
    to peak) and `phase` (rad) are the label's part in the scan where its shape is 1, `parts` the
    amplitudes of all shapes that the places tell apart.
    """

    recording: GridScan
    label: str
    likeness: Mapping[str, si.Dimensionless]
    attainable: si.Dimensionless
    amplitude: Estimate
    phase: Estimate
    parts: Mapping[str, Estimate]
    model: si.Array
    residual: si.Array

    @property
    def observations(self) -> tuple[Observation, ...]:
        """Observations for a calibration: the amplitude per volt where the voltage was told, if the
        scan is of the shape that it is compared with."""
        volts = self.recording.voltage
        if not volts or self.likeness[self.label] < SAME_SHAPE:
            return ()
        return (amplitude_over(volts, self.amplitude, self.recording.frequency),)


@guarded_fit
def fit_grid_scan(recording: GridScan, shapes: Mapping[str, si.Array]) -> GridScanFit:
    """Tell which of the `shapes` a scan is, by the modal assurance criterion, and how far it moves.

    `shapes` by their labels, each (points,), relative motion at the scan's places with 1 where the
    amplitude is asked for (the best antinode): `shapes_at` takes them from solved modes, as many
    neighbours as may take part, and what else the drive moves (of two that the places cannot tell
    apart the one more alike the scan). MAC = |φᴴw|²/(φᴴφ wᴴw) (Allemang 2003, Sound and Vibration
    37(8) 14); amplitudes are least squares of all shapes together. Raises `InputError` for fewer
    than 12 points or a shape of another length.
    """
    good = np.isfinite(recording.x) & np.isfinite(recording.y) & np.isfinite(recording.displacement)
    w = np.asarray(recording.displacement)[good]
    if w.size < _FEWEST_POINTS:
        raise InputError(
            f"the grid scan has {w.size} usable points; comparing shapes needs at least "
            f"{_FEWEST_POINTS}"
        )
    if not np.any(w):
        raise InputError("the grid scan is zero everywhere; nothing moved or nothing was recorded")
    rows = _rows(shapes, good)
    likeness = {name: _likeness(row, w) for name, row in rows.items()}
    names, alike = _told_apart(rows, likeness)
    label, own = names[0], 0
    columns = np.column_stack([rows[name] for name in names])
    size = float(np.max(np.abs(w)))
    recorded = np.iscomplexobj(w) and bool(np.any(w.imag))
    data = w / size if recorded else w.real / size
    fit = linear_fit(columns, data)
    parts = {name: _part(fit, i, size) for i, name in enumerate(names)}
    model = fit.model * size
    x, y = recording.x[good], recording.y[good]
    noise = float(np.sum(np.abs(fit.residual) ** 2)) / max(fit.freedom, 1) * 2 * w.size
    noise = noise if recorded else noise / 2
    power = float(np.sum(np.abs(data) ** 2))
    return GridScanFit(
        recording=recording,
        label=label,
        likeness=likeness,
        attainable=float(np.clip(1 - noise / power, 0.0, 1.0)),
        amplitude=parts[label],
        phase=fit.angle(lambda _, weights: complex(weights[own])),
        parts=parts,
        model=model,
        residual=w - model,
        adequacy=_adequacy(w, fit.residual * size, (x, y), label, likeness[label], alike),
    )


def shapes_at(
    modes: PlateModes, x: si.MetreArray, y: si.MetreArray, driven: DrivenShape
) -> dict[str, si.FloatArray]:
    """Solved modes' relative motion at places (m, (points,)) of the upper face, 1 at the best
    antinode of the `driven` plate, whose other motion (`REST`) comes last.

    By label and frequency, such as "(8,0) at 33.58 kHz"; by cubic splines between the modes'
    own points. Modes that move in the plane, or not at the lobe, are 1 at their own largest.
    Raises `InputError` for a place beside the face.
    """
    for name, places, end in (("x", x, modes.plate.length), ("y", y, modes.plate.width)):
        si.require(name, places, si.Unit("m"), at_least=-1e-6, at_most=end + 1e-6)
    relative, lobe = {}, driven.lobe
    for i in range(modes.count):
        spline = RectBivariateSpline(modes.x, modes.y, modes.shapes[i])
        w, largest = spline.ev(x, y), float(np.max(np.abs(modes.shapes[i])))
        there = float(spline.ev(np.array([lobe[0]]), np.array([lobe[1]]))[0])
        label = label_name(modes.labels[i])
        name = f"{label} at {si.format_quantity(modes.frequencies[i], si.Unit('Hz'))}"
        relative[name] = w / (there if abs(there) > 0.05 * largest else largest)
    _, rest = driven.at(x, y)
    return relative | {REST: rest / (float(np.max(np.abs(driven.rest))) or 1.0)}


def _rows(
    shapes: Mapping[str, si.Array], good: np.ndarray[tuple[int, ...], np.dtype[np.bool]]
) -> dict[str, si.Array]:
    """The shapes at the places that count."""
    if not shapes:
        raise InputError("no shape was given to compare the scan with; solve the plate's modes")
    for name, row in shapes.items():
        if np.shape(row) != good.shape:
            raise InputError(
                f"the shape '{name}' has {np.size(row)} places and the scan {good.size}; take the "
                "shapes at the scan's own places (shapes_at)"
            )
    return {name: np.asarray(row)[good] for name, row in shapes.items()}


def _told_apart(
    rows: Mapping[str, si.Array], likeness: Mapping[str, float]
) -> tuple[list[str], dict[str, str]]:
    """Shapes from the most alike to the least, without those that the places cannot tell from one
    before; these with that one."""
    names: list[str] = []
    alike: dict[str, str] = {}
    # A mode gives the scan its name; the rest has none.
    for name in sorted(rows, key=lambda other: (other == REST, -likeness[other])):
        same = [other for other in names if _likeness(rows[other], rows[name]) > _ALIKE]
        if same:
            alike[name] = same[0]
        else:
            names.append(name)
    return names, alike


def _likeness(shape: si.Array, other: si.Array) -> float:
    """The modal assurance criterion of two shapes; 0 where one does not move."""
    norm = float(np.sum(np.abs(shape) ** 2) * np.sum(np.abs(other) ** 2))
    return float(abs(np.vdot(shape, other)) ** 2 / norm) if norm > 0 else 0.0


def _part(fit: SeparableFit, i: int, size: float) -> Estimate:
    """A shape's amplitude (m)."""
    if abs(fit.weights[i]) == 0:
        return Estimate(0.0, 0.0, (0.0, 0.0), "m")
    return fit.estimate(lambda _, weights: size * abs(weights[i]), "m")


def _adequacy(
    w: si.Array,
    residual: si.Array,
    places: tuple[si.MetreArray, si.MetreArray],
    label: str,
    likeness: float,
    alike: Mapping[str, str],
) -> Adequacy:
    """Judge whether the shapes describe the scan, and one of them is it."""
    x, y = places
    same = ", ".join(f"{name} from {other}" for name, other in alike.items())
    adequacy = adequacy_of(
        w,
        residual,
        lambda i: f"at x = {1e3 * x[i]:.3g} mm, y = {1e3 * y[i]:.3g} mm",
        remedy="Compare with more neighbouring modes, check where the scan's origin lies and which "
        "way its axes run, or doubt the solved plate.",
        said=f"These places cannot tell {same}; the former is left out. " if same else "",
    )
    if likeness >= SAME_SHAPE or not adequacy.adequate:
        return adequacy
    sentence = (
        f"No single shape is the scan's: it is most alike {label}, by a modal assurance criterion "
        f"of {likeness:.2f} where {SAME_SHAPE:g} would call it the same; several modes take part, "
        "or the place of the scan on the plate is not what was told. "
    )
    return replace(adequacy, adequate=False, sentence=sentence + adequacy.sentence)
