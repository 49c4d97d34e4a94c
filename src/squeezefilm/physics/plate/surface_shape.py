"""Motion of each place of the upper face over that of the best antinode.

The seam between the vibrating bodies and what lies on them anywhere: a solved plate has its
harmonic response, all modes in; a beam moves alike all across; a disc varies as cos mθ around; a
measured stator carries a standing wave along its track, every antinode alike.
"""

from __future__ import annotations

import functools
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from scipy.interpolate import RectBivariateSpline

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError, OutOfRangeError
from squeezefilm.physics.plate.beam_response import BeamResponse
from squeezefilm.physics.plate.layout import Actuator, AnnularStator
from squeezefilm.physics.plate.ring.body import surface_profile
from squeezefilm.physics.plate.ring.modes import AnnularMode
from squeezefilm.physics.plate.solid.response import HarmonicResponse
from squeezefilm.physics.plate.working_mode import WorkingMode

# Knots to a half wavelength for places between them: within 3e-4 of the paper's solved plate.
_KNOTS = 24
_MOST_KNOTS = 700
# A hair beyond an edge is rounding.
_EDGE: si.Metre = 1e-9

Axis = Literal["x", "y"]


def _within(middle: si.FloatArray, size: si.MetreLike, low: float, high: float) -> si.FloatArray:
    """The share of intervals of a size about their middles that is within low and high."""
    inside = np.minimum(middle + size / 2, high) - np.maximum(middle - size / 2, low)
    return np.asarray(np.clip(inside / size, 0.0, 1.0))


@dataclass(frozen=True, eq=False)
class SurfaceShape(ABC):
    """The size of the upper face's vibration, 1 at the best antinode `lobe` (x, y).

    `bounds` are the least and largest x and y (m): of a plate from its corner, of a disc from its
    middle, of a stator x along the mean circumference and y across the track. `along` is the axis
    that the working mode's wave runs along. `model` made it, `words` say what it leaves out.
    """

    bounds: tuple[si.Metre, si.Metre, si.Metre, si.Metre]
    lobe: tuple[si.Metre, si.Metre]
    along: Axis
    half_wavelength: si.Metre
    model: str
    words: ClassVar[str]

    @abstractmethod
    def _points(self, x: si.MetreArray, y: si.MetreArray) -> si.DimensionlessArray:
        """|w| over the lobe's at points of one shape."""

    @si.checked_numbers
    def on_face(
        self, x: si.MetreLike, y: si.MetreLike
    ) -> np.ndarray[tuple[int, ...], np.dtype[np.bool]]:
        """True where points (m, broadcast) lie on the face."""
        X, Y = np.broadcast_arrays(x, y)
        return self._covered(X, Y, 2 * _EDGE, 2 * _EDGE) > 0

    @si.checked_numbers
    def grid(self, x: si.MetreArray, y: si.MetreArray) -> si.DimensionlessArray:
        """|w| over the lobe's on the grid of `x` × `y` (m), shape (x, y), as exactly as it was
        solved; 0 beside the face."""
        si.require("x", x, si.Unit("m"), axes=1)
        si.require("y", y, si.Unit("m"), axes=1)
        there = self.on_face(x[:, None], y[None, :])
        return np.where(there, self._grid(x, y), 0.0)

    @si.checked_numbers
    def under(
        self, x: si.MetreLike, y: si.MetreLike, length: si.MetreLike, width: si.MetreLike
    ) -> tuple[si.DimensionlessArray, si.DimensionlessArray]:
        """|w| over the lobe's under cells about points (m, broadcast) that reach over a `length`
        along x and a `width` along y (m), and which share of each cell is on the face. A solved
        plate's is between knots a 24th of a half wavelength apart, by cubic splines; of what lies
        beside the face it is that of its nearest point."""
        X, Y = np.broadcast_arrays(x, y)
        return self._points(*self._nearest(X, Y)), self._covered(X, Y, length, width)

    @si.checked_numbers
    def under_grid(
        self, x: si.MetreArray, y: si.MetreArray, length: si.MetreArray, width: si.MetreArray
    ) -> tuple[si.DimensionlessArray, si.DimensionlessArray]:
        """Motion as by `under` on the grid of `x` × `y` (m), of cells with a length for each x and
        a width for each y (m), both of shape (x, y); for very many points, and quickly. Raises
        `InputError` for a place without its length or width."""
        for name, along, size, places in (("x", x, "length", length), ("y", y, "width", width)):
            si.require(name, along, si.Unit("m"), axes=1)
            if np.shape(places) != np.shape(along):
                raise InputError(
                    f"{size} has the shape {np.shape(places)} and {name} {np.shape(along)}; give "
                    f"one for each {name}",
                    quantity=size,
                )
        covered = self._covered(x[:, None], y[None, :], length[:, None], width[None, :])
        return self._between(*self._nearest(x, y)), covered

    def _nearest(self, x: si.MetreArray, y: si.MetreArray) -> tuple[si.MetreArray, si.MetreArray]:
        """The nearest places of a rectangular face."""
        left, right, front, back = self.bounds
        return np.clip(x, left, right), np.clip(y, front, back)

    def _covered(
        self, x: si.FloatArray, y: si.FloatArray, length: si.MetreLike, width: si.MetreLike
    ) -> si.DimensionlessArray:
        """The share of cells that is on the face, here a rectangular one."""
        left, right, front, back = self.bounds
        return _within(x, length, left, right) * _within(y, width, front, back)

    def _between(self, x: si.MetreArray, y: si.MetreArray) -> si.DimensionlessArray:
        return self._points(*np.meshgrid(x, y, indexing="ij"))

    def _grid(self, x: si.MetreArray, y: si.MetreArray) -> si.DimensionlessArray:
        """|w| over the lobe's on the grid of `x` × `y`, whether there is a face or not."""
        return self._between(x, y)


@dataclass(frozen=True, eq=False)
class SolvedSurface(SurfaceShape):
    """Surface of a plate solved in three dimensions: its response at frequency number `number`."""

    response: HarmonicResponse
    number: int
    words: ClassVar[str] = (
        "the solved plate's response at the drive's frequency, neighbouring modes included"
    )

    @functools.cached_property
    def _at_lobe(self) -> float:
        x, y = self.lobe
        return float(abs(self.response.motion(self.number, np.array([x]), np.array([y]))[0, 0]))

    def _grid(self, x: si.MetreArray, y: si.MetreArray) -> si.DimensionlessArray:
        return np.asarray(np.abs(self.response.motion(self.number, x, y)) / self._at_lobe)

    @functools.cached_property
    def _splines(self) -> tuple[RectBivariateSpline, RectBivariateSpline]:
        """Real and imaginary part: their size has kinks at nodes, they have none."""
        left, right, front, back = self.bounds
        step = self.half_wavelength / _KNOTS
        x, y = (
            np.linspace(low, high, int(np.clip(np.ceil((high - low) / step), 24, _MOST_KNOTS)) + 1)
            for low, high in ((left, right), (front, back))
        )
        motion = self.response.motion(self.number, x, y) / self._at_lobe
        return RectBivariateSpline(x, y, motion.real), RectBivariateSpline(x, y, motion.imag)

    def _points(self, x: si.MetreArray, y: si.MetreArray) -> si.DimensionlessArray:
        real, imaginary = self._splines
        return np.asarray(np.hypot(real.ev(x, y), imaginary.ev(x, y)))

    def _between(self, x: si.MetreArray, y: si.MetreArray) -> si.DimensionlessArray:
        # Splines ask for places in order.
        row, column = np.argsort(x), np.argsort(y)
        real, imaginary = (spline(x[row], y[column]) for spline in self._splines)
        amplitude = np.empty((x.size, y.size))
        amplitude[np.ix_(row, column)] = np.hypot(real, imaginary)
        return amplitude

    def __getstate__(self) -> dict[str, object]:
        """State without the splines, which are made anew where they are asked for."""
        return {name: value for name, value in vars(self).items() if name != "_splines"}


@dataclass(frozen=True, eq=False)
class BeamSurface(SurfaceShape):
    """Surface of a plate taken as a beam: its working mode along the wave, the same all across."""

    beam: BeamResponse
    words: ClassVar[str] = (
        "a beam's mode, which moves alike all across the plate: a solved plate does not"
    )

    def _points(self, x: si.MetreArray, y: si.MetreArray) -> si.DimensionlessArray:
        mode = self.beam.mode
        along, lobe = (x, self.lobe[0]) if self.along == "x" else (y, self.lobe[1])
        return np.abs(mode.deflection_at(along) / mode.deflection_at(lobe))


@dataclass(frozen=True, eq=False)
class DiscSurface(SurfaceShape):
    """Surface of a disc or a plate with a hole, u_z = W(r) cos mθ with θ from the x axis."""

    mode: AnnularMode
    words: ClassVar[str] = "the disc's own mode alone, turned so that the x axis crosses antinodes"

    def _nearest(self, x: si.MetreArray, y: si.MetreArray) -> tuple[si.MetreArray, si.MetreArray]:
        return x, y  # `_points` keeps to the radii there are

    def _covered(
        self, x: si.FloatArray, y: si.FloatArray, length: si.MetreLike, width: si.MetreLike
    ) -> si.DimensionlessArray:
        """Motion by the radius alone, over which a cell reaches as far as across it."""
        r, known = np.hypot(x, y), self.mode.surface_radius
        turned = np.where(r > 0, r, 1.0)
        across = (np.abs(x) * length + np.abs(y) * width) / turned
        size = np.where(r > 0, across, np.minimum(length, width))
        return _within(r, size, float(known[0]) or -np.inf, float(known[-1]))

    def _points(self, x: si.MetreArray, y: si.MetreArray) -> si.DimensionlessArray:
        known = self.mode.surface_radius
        r = np.clip(np.hypot(x, y), known[0], known[-1])
        shape = surface_profile(self.mode, r.ravel()).reshape(r.shape)
        return np.asarray(np.abs(shape * np.cos(self.mode.harmonic * np.arctan2(y, x))))


@dataclass(frozen=True, eq=False)
class TrackSurface(SurfaceShape):
    """Surface of a measured stator: |cos(πx/λ_half)| along the mean circumference."""

    words: ClassVar[str] = (
        "a standing wave along the track with one amplitude at all its antinodes, as measured "
        "at one of them: how they differ, and what changes across the track, is not known"
    )

    def _nearest(self, x: si.MetreArray, y: si.MetreArray) -> tuple[si.MetreArray, si.MetreArray]:
        return x, y  # |w| is that of x alone, round and round

    def _covered(
        self, x: si.FloatArray, y: si.FloatArray, length: si.MetreLike, width: si.MetreLike
    ) -> si.DimensionlessArray:
        # The track is closed: every x is on it.
        _, _, inner, outer = self.bounds
        return np.asarray(np.broadcast_arrays(_within(y, width, inner, outer), x)[0])

    def _points(self, x: si.MetreArray, y: si.MetreArray) -> si.DimensionlessArray:
        return np.abs(np.cos(np.pi * x / self.half_wavelength))


@si.checked_numbers
def surface_shape(
    actuator: Actuator, mode: WorkingMode, frequency: si.Hertz | None = None
) -> SurfaceShape:
    """The shape of an actuator's vibration in its working mode, driven at a frequency (Hz).

    Without a frequency at its resonance. Only a plate solved in three dimensions changes its shape
    with the frequency (it is then solved once more), as its neighbouring modes do more or less.
    Raises `OutOfRangeError` for a mode that has no shape over a face. The last few are kept.
    """
    return _surface_shape(actuator, mode, frequency)


@functools.lru_cache(maxsize=4)
def _surface_shape(
    actuator: Actuator, mode: WorkingMode, frequency: si.Hertz | None
) -> SurfaceShape:
    across = actuator.lines_across == "width"
    along: Axis = "y" if across else "x"
    half, lobe = mode.half_wavelength, mode.lobe
    if mode.disc is not None:
        outer = float(mode.disc.surface_radius[-1])
        return DiscSurface((-outer, outer, -outer, outer), lobe, along, half, mode.model, mode.disc)
    width, depth = actuator.extent
    bounds = 0.0, width, 0.0, depth
    if isinstance(actuator, AnnularStator):
        return TrackSurface(bounds, lobe, along, half, mode.model)
    if mode.solid is not None:
        response, number = mode.solid.driven_at(frequency)
        return SolvedSurface(bounds, lobe, along, half, mode.model, response, number)
    if mode.beam is None:
        raise OutOfRangeError(f"the model '{mode.model}' has no shape over the face")
    return BeamSurface(bounds, lobe, along, half, mode.model, mode.beam)
