"""The wave along a line: half wavelength, nodal lines, damping, standing-wave ratio, amplitude."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.measure.fits.estimate import (
    Estimate,
    FitResult,
    Observation,
    adequacy_of,
    amplitude_over,
    guarded_fit,
    inverse_of,
)
from squeezefilm.measure.fits.least_squares import SeparableFit, fit_separable
from squeezefilm.measure.fits.vibration.line_points import LinePoints, LineWaves
from squeezefilm.measure.fits.vibration.solved_shapes import DrivenShape, line_by_shape
from squeezefilm.measure.recordings.kinds import LineScan, finite

_FEWEST_POINTS = 12
_TRIED_NUMBERS = 160
# Half wavelengths on a line, from one bend to as many as points can tell apart.
_FEWEST_HALVES = 0.75
_LEAST_PER_HALF = 3.0
_DENSE = 24
# What is meant by a node of a size that was recorded without its sign.
_DIP = 0.4


@dataclass(frozen=True, eq=False, repr=False)
class LineScanFit(FitResult):
    """The wave along a line at one frequency.

    `half_wavelength` (m); `nodal_lines` where the wave's size is least (m), one for each;
    `antinode_amplitude` (m, zero to peak) at the largest antinode between the outermost nodal
    lines, at `antinode` (m); `standing_wave_ratio` of the waves that run forward and backward at
    the middle of the line, (a + b)/|a − b|: infinite for a pure standing wave; `loss_factor` by how
    the waves fade along their way (four times their decay over the wave number: bending waves);
    `phase` (rad) of the antinode against the drive. The last three are None where no phase was
    recorded, ratio and loss also where no even wave fits. `phase_reversed` says that waves grow
    along their way, which no plate makes: the phase was recorded with the other sign, and the fit
    is of the complex conjugate. `by_points` says that half wavelength and nodal lines are those of
    the points around each, as no even wave fits, and amplitude too, unless the scan was compared
    with a solved shape: then `offset` (m) is where its zero lies from the plate's edge, and
    amplitude and phase are those of the shape, and `face_over_line` is its half wavelength over the
    whole face, which is the library's, over that along the line (else 1). `model` and `residual`
    (m) are at `position` (m).
    """

    recording: LineScan
    position: si.MetreArray
    model: si.Array
    residual: si.Array
    half_wavelength: Estimate
    nodal_lines: tuple[Estimate, ...]
    antinode: si.Metre
    antinode_amplitude: Estimate
    standing_wave_ratio: Estimate | None
    loss_factor: Estimate | None
    phase: Estimate | None
    phase_reversed: bool
    by_points: bool
    offset: Estimate | None
    face_over_line: si.Dimensionless

    @property
    def observations(self) -> tuple[Observation, ...]:
        """Observations for a calibration: half wavelength, and amplitude at the best antinode where
        the drive's voltage was told; by the points where an even wave does not fit. None where
        neither says anything (no two nodal lines)."""
        if not self.adequacy.adequate and not self.by_points:
            return ()
        at = {"frequency": self.recording.frequency}
        half, largest, ratio = self.half_wavelength, self.antinode_amplitude, self.face_over_line
        observed = [
            Observation("half_wavelength", half.value * ratio, half.standard_error * ratio, at)
        ]
        volts = self.recording.voltage
        if volts:
            observed.append(amplitude_over(volts, largest, self.recording.frequency))
        return tuple(observed)


@guarded_fit
def fit_line_scan(
    recording: LineScan,
    shape: DrivenShape | None = None,
    *,
    free_ends: bool = True,
) -> LineScanFit:
    """Half wavelength (m), nodal lines (m), loss, standing-wave ratio and amplitude (m) of a line.

    w = F e^{−ikx} + B e^{ikx} + C e^{−k(x − x0)} + D e^{−k(x1 − x)} with k(1 − iη/4): one bending
    wave number, and with `free_ends` the near fields of edges at both ends of the scan (leave them
    out along a closed track). Losses and the ratio of waves need a recorded phase; without one
    (real values) the sign is turned at every deep minimum of a size. The model is that of an even
    thin plate: a plate with ceramics on it bends its wave, and the
    fit then says by how much, and half wavelength, nodal lines and amplitude are taken from the
    recorded points around each (`LinePoints`). With the solved `shape` of the plate amplitude and
    phase are then those of the shape, which the scan is judged by.

    Raises `InputError` for fewer than 12 points or three to a half wavelength. Source: Cremer,
    Heckl, Petersson, Structure-Borne Sound, 3rd ed., section 3.6 (decay of bending waves).
    """
    x, w = _recorded(recording)
    line = LineWaves(float(x[0]), float(x[-1]), np.iscomplexobj(w), free_ends)
    size = float(np.max(np.abs(w)))
    start = np.zeros(line.count)
    start[0] = _wave_number(line, x, w / size)
    fit = fit_separable(partial(line.columns, x), w / size, start, reach=line.reach(start[0]))
    grows = line.complex and bool(fit.estimate(lambda shape, _: shape[1], "1").interval[1] < 0)
    if grows:
        w = w.conj()
        fit = fit_separable(partial(line.columns, x), w / size, start, reach=line.reach(start[0]))
    told = _told(recording, line, x, w, fit, grows=grows)
    if not told.adequacy.adequate:
        told = _by_points(told, w)
    if shape is None or not told.by_points:
        return told
    return _by_shape(told, shape, w.conj() if grows else w)


def _by_shape(fit: LineScanFit, shape: DrivenShape, w: si.Array) -> LineScanFit:
    """Fit by a solved shape of a line that no even wave fits, from its displacement as recorded."""
    reach = fit.half_wavelength.value / 4
    by = line_by_shape(shape, fit.position, w, reach=reach)
    swing = shape.along(fit.position + by.offset.value)[0]
    along = LinePoints(fit.position, swing, fit.half_wavelength.value).spacing
    said = (
        " Amplitude and phase are those of the shape; half wavelength (the mean distance of nodal "
        "lines) and nodal lines are those of the points around each."
    )
    return replace(
        fit,
        model=by.model,
        residual=(w.conj() if by.phase_reversed else w) - by.model,
        antinode=shape.antinode - by.offset.value,
        antinode_amplitude=by.amplitude,
        phase=by.phase,
        phase_reversed=by.phase_reversed,
        offset=by.offset,
        face_over_line=1.0 if along is None else shape.half_wavelength / along.value,
        adequacy=replace(by.adequacy, sentence=by.adequacy.sentence + said),
    )


def _recorded(recording: LineScan) -> tuple[si.MetreArray, si.Array]:
    """Rising places and what was recorded as a finite number there; sizes with a sign again."""
    x, w = finite(recording.position, recording.displacement)
    order = np.argsort(x, kind="stable")
    x, w = x[order], w[order]
    if x.size < _FEWEST_POINTS:
        raise InputError(
            f"the line scan has {x.size} usable points; a wave along a line needs at least "
            f"{_FEWEST_POINTS}, and more than {_LEAST_PER_HALF:g} to a half wavelength"
        )
    if not x[-1] > x[0]:
        raise InputError("the line scan stays at one place; give places along a line")
    if not np.any(w):
        raise InputError("the line scan is zero everywhere; nothing moved or nothing was recorded")
    if np.iscomplexobj(w) and np.any(w.imag):
        return x, w
    real = np.asarray(w.real, dtype=float)
    return x, _signed(real) if np.all(real >= 0) else real


def _signed(size: si.FloatArray) -> si.FloatArray:
    """A size with its sign turned at every deep minimum: a standing wave's displacement."""
    sign, signs = 1.0, []
    for i in range(size.size):
        signs.append(sign)
        if 0 < i < size.size - 1 and size[i] <= size[i - 1] and size[i] < size[i + 1]:
            around = size[max(i - 4, 0) : i + 5]
            if size[i] < _DIP * around.max():
                # The nearer neighbour in size is on the same side of the node.
                if size[i - 1] > size[i + 1]:
                    signs[-1] = -sign
                sign = -sign
    return np.asarray(size * np.array(signs))


def _wave_number(line: LineWaves, x: si.MetreArray, w: si.Array) -> float:
    """The wave number that leaves least, of an even row of them."""
    spacing = float(np.median(np.diff(x)))
    most = line.length / max(spacing, line.length / 2000) / _LEAST_PER_HALF
    if most < 1:
        raise InputError("the line scan is too coarse for any wave along it; scan more points")
    halves = np.linspace(_FEWEST_HALVES, most, int(min(_TRIED_NUMBERS, 4 * most + 8)))
    shape, left = np.zeros(line.count), []
    for count in halves:
        shape[0] = np.pi * count / line.length
        columns = line.waves(x, shape)
        basis = np.linalg.qr(columns)[0]
        rest = w - basis @ (basis.conj().T @ w)
        left.append(float(np.sum(np.abs(rest) ** 2)))
    return float(np.pi * halves[int(np.argmin(left))] / line.length)


def _told(
    recording: LineScan,
    line: LineWaves,
    x: si.MetreArray,
    w: si.Array,
    fit: SeparableFit,
    *,
    grows: bool,
) -> LineScanFit:
    """A fit of displacements `w` (m) over the largest of them, read off."""
    size = float(np.max(np.abs(w)))
    dense = np.linspace(x[0], x[-1], 1 + _DENSE * int(np.ceil(fit.shape[0] * line.length / np.pi)))
    wave = np.abs(line.wave(dense, fit.shape, fit.weights))
    nodes = dense[1:-1][(wave[1:-1] < wave[:-2]) & (wave[1:-1] <= wave[2:])]
    lobe = _best_antinode(dense, wave, nodes)

    def there(shape: si.FloatArray, weights: si.Array) -> complex:
        return complex(line.wave(np.array([lobe]), shape, weights)[0])

    model = fit.model * size
    return LineScanFit(
        recording=recording,
        position=x,
        model=model,
        residual=w - model,
        half_wavelength=fit.estimate(lambda shape, _: np.pi / shape[0], "m", positive=True),
        nodal_lines=tuple(_node(line, fit, float(node)) for node in nodes),
        antinode=lobe,
        antinode_amplitude=fit.estimate(
            lambda shape, weights: size * abs(there(shape, weights)), "m", positive=True
        ),
        standing_wave_ratio=_ratio(fit) if line.complex else None,
        loss_factor=fit.estimate(lambda shape, _: 4 * shape[1], "1") if line.complex else None,
        phase=fit.angle(there) if line.complex else None,
        phase_reversed=grows,
        by_points=False,
        offset=None,
        face_over_line=1.0,
        adequacy=adequacy_of(
            w,
            fit.residual * size,
            lambda i: f"{1e3 * x[i]:.3g} mm along the line",
            remedy="A plate with ceramics on it, or one that also bends across the line, has no "
            "one wave: compare it with the solved plate's shape (name the display).",
            said="The phase was recorded with the other sign (waves would grow along their way); "
            "the fit is of the complex conjugate. "
            if grows
            else "",
        ),
    )


def _by_points(fit: LineScanFit, w: si.Array) -> LineScanFit:
    """Fit by the points around each node and antinode of displacements, in place of a wave that
    does not fit."""
    points = LinePoints(fit.position, w, fit.half_wavelength.value)
    spacing, antinode = points.spacing, points.antinode
    if spacing is None or antinode is None:
        return fit
    said = (
        " Half wavelength (their mean distance), nodal lines and amplitude are therefore those "
        "of the points around each; loss and ratio of waves are not given."
    )
    return replace(
        fit,
        half_wavelength=spacing,
        nodal_lines=points.nodes,
        antinode=antinode[0],
        antinode_amplitude=antinode[1],
        standing_wave_ratio=None,
        loss_factor=None,
        by_points=True,
        adequacy=replace(fit.adequacy, sentence=fit.adequacy.sentence + said),
    )


def _node(line: LineWaves, fit: SeparableFit, node: float) -> Estimate:
    """Place where the fitted size is least, near a node: a step of Newton's from there on |w|²."""
    step = 1e-3 / fit.shape[0]
    places = node + step * np.array([-1.0, 0.0, 1.0])

    def least(shape: si.FloatArray, weights: si.Array) -> float:
        low, middle, high = np.abs(line.wave(places, shape, weights)) ** 2
        return float(node - step * (high - low) / (2 * (high - 2 * middle + low)))

    return fit.estimate(least, "m")


def _ratio(fit: SeparableFit) -> Estimate:
    """(a + b)/|a − b| by its inverse, which is finite: 0 for a pure standing wave."""

    def inverse(_: si.FloatArray, weights: si.Array) -> float:
        a, b = np.abs(weights[:2])
        return float((a - b) / (a + b))

    inverted = fit.estimate(inverse, "1")
    low, high = inverted.interval
    ends = 0.0 if low <= 0 <= high else min(abs(low), abs(high)), max(abs(low), abs(high))
    return inverse_of(replace(inverted, value=abs(inverted.value), interval=ends))


def _best_antinode(x: si.MetreArray, size: si.FloatArray, nodes: si.MetreArray) -> float:
    """The largest size between the outermost nodes: free ends move further than a finger meets."""
    if nodes.size >= 2:
        between = (x > nodes[0]) & (x < nodes[-1])
        if between.any():
            x, size = x[between], size[between]
    return float(x[int(np.argmax(size))])
