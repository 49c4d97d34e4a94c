"""A pad anywhere on a vibrating face: what each of its ridges meets there."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.arguments import ReadBy
from squeezefilm.core.errors import GeometryError, QuantityError
from squeezefilm.physics.contact.finger.fingertip import Finger
from squeezefilm.physics.contact.sharing.pad import PadPoints, pad_points
from squeezefilm.physics.plate.layout import Actuator
from squeezefilm.physics.plate.surface_shape import SurfaceShape, surface_shape
from squeezefilm.physics.plate.working_mode import WorkingMode

# Of a pad's ridges, when their mean is taken: friction bends sharply where little moves.
_NODES, _NODES_ACROSS_REST = 8, 24
_NEAR_REST = 0.25
_MOST_PADS = 64
ALONG_RIDGE = 8
"""Points along a ridge that stands across the wave, over a pattern that changes along it too."""


def place_words(place: tuple[si.Metre, si.Metre]) -> str:
    """A place as every page writes it: "x 41.5 mm, y 24.5 mm"."""
    return ", ".join(
        f"{axis} {round(1e3 * value, 1) + 0.0:g} mm"
        for axis, value in zip("xy", place, strict=True)
    )


def read_place(text: str) -> tuple[si.Metre, si.Metre]:
    """A place from text: "30 mm, 20 mm", or as it is printed, "x 30 mm, y 20 mm".

    Raises `QuantityError` for anything else.
    """
    parts = text.split(",")
    if len(parts) != 2:
        raise QuantityError(
            f"place = '{text}' is no place; give x and y with their units, like \"30 mm, 20 mm\"",
            quantity="place",
        )
    x, y = (part.strip().removeprefix(axis) for part, axis in zip(parts, "xy", strict=True))
    try:
        return si.parse_quantity(x, si.Unit("m")), si.parse_quantity(y, si.Unit("m"))
    except QuantityError as error:
        raise QuantityError(f"place: {error}", quantity="place") from error


FacePlace = Annotated[tuple[si.Metre, si.Metre], ReadBy(read_place)]
"""A place on a face, x and y in m, or its text (see `reads_text`)."""


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class PadPlace:
    """A pad with its centre at (`x`, `y`) on a face that vibrates in `shape`.

    Amplitudes are over the best antinode's. Of a pad that overhangs the face the points beside it
    are left out: what is left carries as if it were all. `is_best_of_area` says that nobody asked
    for the place: it is the best of the active area. Raises `GeometryError` for a centre that is
    not on the face.
    """

    shape: SurfaceShape
    x: si.Metre
    y: si.Metre
    is_best_of_area: bool = False

    def __post_init__(self) -> None:
        if not self.shape.on_face(np.array([self.x]), np.array([self.y]))[0]:
            left, right, front, back = (1e3 * bound for bound in self.shape.bounds)
            raise GeometryError(
                f"place = {place_words((self.x, self.y))} is not on the face; it goes from x "
                f"{left:.4g} mm to {right:.4g} mm and from y {front:.4g} mm to {back:.4g} mm"
                + (", as far as it is round" if left < 0 else ""),
                quantity="place",
            )

    @functools.cached_property
    def at_centre(self) -> si.Dimensionless:
        """The amplitude at the pad's centre."""
        share = float(self.shape.grid(np.array([self.x]), np.array([self.y]))[0, 0])
        # On a node, but for rounding.
        return 0.0 if share < 1e-9 else share

    @property
    def antinode_said(self) -> str:
        """Words for the antinode whose amplitudes are told: elsewhere the face may move further."""
        return f"the antinode at {place_words(self.shape.lobe)}"

    @functools.cached_property
    def _known(self) -> dict[tuple[float, float, float], tuple[si.FloatArray, si.FloatArray]]:
        """Answers of `met` until now."""
        return {}

    def met(
        self, finger: Finger, contact_length: si.Metre
    ) -> tuple[si.DimensionlessArray, si.DimensionlessArray]:
        """Amplitudes that stand for all of a finger's ridges, with shares: see `gauss_nodes`.

        Kept, since of many draws some have the same pad. Raises as `ridges` does.
        """
        pad = finger.ridge_period, finger.ridge_angle, contact_length
        if pad not in self._known:
            if len(self._known) >= _MOST_PADS:
                self._known.clear()
            _, swings, shares = self.ridges(finger, contact_length)
            self._known[pad] = gauss_nodes(swings, shares)
        return self._known[pad]

    @si.checked_numbers
    def ridges(
        self, finger: Finger, contact_length: si.Metre
    ) -> tuple[si.MetreArray, si.DimensionlessArray, si.DimensionlessArray]:
        """The points of the ridges along the wave (m from the pad's centre), the amplitudes there,
        and the shares of the pad that they stand for.

        Raises `InputError` where the contact holds no ridge.
        """
        points = pad_points(finger, contact_length, ALONG_RIDGE)
        x, y = np.array([self.x]), np.array([self.y])
        swings, shares = met_by_pads(self.shape, x, y, points)
        there = shares[0] > 0
        return points.along[there], swings[0, there], shares[0, there]


@si.checked_numbers
def gauss_nodes(
    values: Annotated[si.DimensionlessArray, si.AtLeast(0.0)],
    weights: Annotated[si.DimensionlessArray, si.AtLeast(0.0)],
) -> tuple[si.DimensionlessArray, si.DimensionlessArray]:
    """Few values, with weights of sum 1, for the mean of a function over many, both of shape (n,).

    Gauss's rule of their distribution, by Lanczos' recurrence of orthogonal polynomials (Golub &
    Welsch 1969, 10.1090/S0025-5718-69-99647-1): of 8 nodes, and so exact for polynomials up to
    degree 15, or, where some values are below a quarter of the largest, of 24. Friction under a
    pad is within 1e-8 by it at an antinode and 3e-5 across a node, where it bends within the
    roughness. Of values of no more kinds than nodes all are kept.
    """
    kinds, alike = np.unique(np.round(values, 9), return_inverse=True)
    counts = np.bincount(alike, weights=weights).astype(float)
    size = _NODES if kinds[0] > _NEAR_REST * kinds[-1] else _NODES_ACROSS_REST
    if kinds.size <= size:
        return kinds, counts
    middle, reach = (kinds[0] + kinds[-1]) / 2, (kinds[-1] - kinds[0]) / 2
    at = (kinds - middle) / reach
    basis = np.zeros((size, kinds.size))
    basis[0] = np.sqrt(counts)
    jacobi = np.zeros((size, size))
    for k in range(size):
        further = at * basis[k]
        # Against all before it: the recurrence alone loses them to rounding.
        along = basis[: k + 1] @ further
        further -= along @ basis[: k + 1]
        jacobi[k, k] = along[k]
        if k + 1 < size:
            jacobi[k, k + 1] = jacobi[k + 1, k] = norm = float(np.linalg.norm(further))
            basis[k + 1] = further / norm
    nodes, vectors = np.linalg.eigh(jacobi)
    return np.clip(middle + reach * nodes, kinds[0], kinds[-1]), vectors[0] ** 2


def pad_place(
    actuator: Actuator,
    mode: WorkingMode,
    frequency: si.Hertz,
    place: tuple[si.Metre, si.Metre] | None,
) -> PadPlace | None:
    """A place (x, y in m) on an actuator that is driven in a mode at a frequency (Hz); None without
    one. Raises `GeometryError` for a place beside the face, and what `surface_shape` raises."""
    if place is None:
        return None
    return PadPlace(surface_shape(actuator, mode, frequency), *place)


@si.checked_numbers
def met_by_pads(
    shape: SurfaceShape,
    x: si.MetreArray,
    y: si.MetreArray,
    points: PadPoints,
) -> tuple[si.DimensionlessArray, si.DimensionlessArray]:
    """The amplitudes over the antinode's under pads centred at places (m), and the shares of each
    pad that meet them, both of shape (places, points): what is beside the face carries nothing."""
    dx, dy, length, width = points.on_axes(shape.along)
    swings, covered = shape.under(x[:, None] + dx, y[:, None] + dy, length, width)
    shares = points.shares * covered
    return swings, shares / np.sum(shares, axis=1, keepdims=True)
