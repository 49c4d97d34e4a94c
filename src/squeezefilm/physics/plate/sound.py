"""The airborne ultrasound that a vibrating surface makes, and the guidance it is compared with.

The surface lies in a rigid baffle and radiates into the half space above it (Rayleigh's integral,
Theory of Sound §278; Kinsler et al., Fundamentals of Acoustics, 4th ed., §7.4). A bare plate
radiates from both faces, which partly cancel around its edges: near the plane of the plate the
baffled level is too high; in the strong lobes, for plates longer than a wave, it is a fair
estimate.

The published guidance is one table of limits, each with how well we know it. What the texts agree
about: a limit in one-third-octave bands that rises by 30 dB or more from the 20 kHz band, which
some people hear, to the 25 kHz band and beyond, which nobody does. What they do not: who it is for
(the public has the lower values, workers the higher), how levels that last less than a working day
count, and whether a limit may be 30 dB higher where the source does not touch the body (Howard,
Hansen and Zander 2004 report that the American recommendations were raised by as much "under
certain conditions", which were not read: it is not counted on here). The ICNIRP reviewed the oldest
ones in 2024 and found that they may be "too low or too high": 10.1097/HP.0000000000001800. Canada's
Safety Code 24 (1991) and the reports of the British HSE (CRR 343/2001) have tables too, whose
numbers could not be read and are not here.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Literal, NamedTuple

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError

EAR_DISTANCE: si.Metre = 0.5
"""Distance from the plate to the ear of somebody seated at it (assumed)."""

Audience = Literal["public", "occupational"]


@dataclass(frozen=True)
class ExposureGuidance:
    """A recommended limit of sound pressure level, with how well we know it.

    It holds in one-third-octave bands between `low` and `high`. `evidence` says what was seen:
    a limit marked "to be checked" was not read in its own text.
    """

    level_dB: float
    low: si.Hertz
    high: si.Hertz
    audience: Audience
    name: str
    source: str
    evidence: str


_IRPA = (
    "IRPA 1984",
    "IRPA/INIRC 1984, Interim guidelines on limits of human exposure to airborne ultrasound, "
    "Health Physics 46(4), 969-974; still the guideline in 2024: 10.1097/HP.0000000000001800",
    "to be checked: quoted second-hand, the guideline's own text was not read",
)
_HOWARD = (
    "Howard et al. 2004",
    "Howard, Hansen and Zander 2004, A review of current ultrasound exposure limits, J. Occup. "
    "Health Saf. Aust. N. Z. 21(3), 253-257: the consensus of the limits reviewed, below 4 hours",
    "to be checked: read as a quotation of the review, not in the limits themselves",
)
GUIDANCE = (
    ExposureGuidance(70.0, 17.8e3, 22.4e3, "public", *_IRPA),
    ExposureGuidance(100.0, 22.4e3, 112e3, "public", *_IRPA),
    ExposureGuidance(75.0, 17.8e3, 22.4e3, "occupational", *_HOWARD),
    ExposureGuidance(110.0, 22.4e3, 56e3, "occupational", *_HOWARD),
)
"""Published guidance, one entry per band and audience; the reviews call its basis thin."""


@si.checked_numbers
def exposure_guidance(
    frequency: Annotated[si.Hertz, si.Above(0.0)],
    audience: Audience = "public",
) -> ExposureGuidance | None:
    """The guidance for a tone, or None where there is none."""
    for entry in GUIDANCE:
        if entry.audience == audience and entry.low <= frequency < entry.high:
            return entry
    return None


DISTANCES: tuple[si.Metre, ...] = (0.3, 0.5, 1.0)
"""Distances of levels unless asked otherwise: a bent head, a seated user, a bystander."""

_DENSITY, _SOUND_SPEED = 1.204, 343.2
"""Density and sound speed of air at 20 °C (kg/m³, m/s)."""

_COARSEST = 4
"""Points per wavelength in air below which a surface is refused."""

_MOST_WAVES = 500
"""Waves along a side of a surface; a plate of 300 nodal lines has 150."""


@si.checked_numbers
@dataclass(frozen=True, eq=False)
class RadiatingSurface:
    """A flat surface cut into points: positions (n, 2) in m, areas (n,) in m², normal velocity
    (n,) in m/s, zero-to-peak and complex, all at one frequency."""

    frequency: si.Hertz
    position: si.MetreArray
    area: si.FloatArray
    velocity: si.ComplexArray

    @property
    def extent(self) -> si.Metre:
        """The largest distance of a point from the middle."""
        return float(np.hypot(*self.position.T).max())


@si.checked_numbers
def smooth_surface(
    sides: tuple[Annotated[si.Metre, si.Above(0.0)], Annotated[si.Metre, si.Above(0.0)]],
    velocity: Callable[[si.MetreArray, si.MetreArray], si.ComplexArray],
    frequency: Annotated[si.Hertz, si.Above(0.0)],
    wave: Annotated[si.Metre, si.Above(0.0)],
) -> RadiatingSurface:
    """A plate's surface from a smooth `velocity` (m/s) of lines x and y (m from a corner), shape
    (x, y), whose shortest wave along the plate is `wave` (m).

    For a displacement w of zero-to-peak amplitude the velocity is 2πi f w. Gauss–Legendre
    quadrature with three points to a wave, of the plate's or in air, and six more along each side:
    levels of the plates that come along are within .01 dB of those of a grid of ten times as many
    points. Raises `InputError` for a velocity of another shape, or more than 500 waves along a
    side.
    """
    wave = min(wave, _SOUND_SPEED / frequency)
    si.require("wave", wave, si.Unit("m"), at_least=max(sides) / _MOST_WAVES)
    nodes, weights = [], []
    for side in sides:
        point, weight = np.polynomial.legendre.leggauss(6 + math.ceil(3 * side / wave))
        nodes.append(side / 2 * point)
        weights.append(side / 2 * weight)
    x, y = nodes
    values = np.asarray(velocity(x + sides[0] / 2, y + sides[1] / 2), dtype=complex)
    if values.shape != (x.size, y.size):
        raise InputError(
            f"velocity has the shape {values.shape}; for these lines it must be {(x.size, y.size)}",
            quantity="velocity",
        )
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1)
    return RadiatingSurface(
        frequency, grid.reshape(-1, 2), np.outer(*weights).ravel(), values.ravel()
    )


@si.checked_numbers
def ring_surface(
    radius: Annotated[si.MetreArray, si.AtLeast(0.0), si.Rising(2)],
    velocity: si.ComplexArray,
    harmonic: Annotated[int, si.AtLeast(0)],
    frequency: Annotated[si.Hertz, si.Above(0.0)],
) -> RadiatingSurface:
    """A ring's or disc's surface moving with `velocity` (r) × cos(`harmonic` × θ).

    `radius` rises from the inner (0 for a disc) to the outer edge. Trapezoidal rule, second order
    in r, spectral in θ. Raises `InputError` for wrong shapes or a grid coarser than a quarter of
    the wave in air.
    """
    values = np.asarray(velocity, dtype=complex)
    si.require_alike(radius=radius, velocity=values)
    _require_fine("radius", float(np.diff(radius).max()), frequency)
    waves = 2 * math.pi * radius[-1] * frequency / _SOUND_SPEED
    around = max(32, 8 * math.ceil(waves), 8 * harmonic)
    angle = 2 * math.pi * np.arange(around) / around
    position = radius[:, None, None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    # ∫ f r dr exactly for f linear between radii, so that a piston has its true area.
    step = np.diff(radius)
    weight = np.zeros_like(radius)
    weight[:-1] += step * (2 * radius[:-1] + radius[1:]) / 6
    weight[1:] += step * (radius[:-1] + 2 * radius[1:]) / 6
    area = np.repeat(weight[:, None], around, axis=1) * (2 * math.pi / around)
    moving = values[:, None] * np.cos(harmonic * angle)
    return RadiatingSurface(frequency, position.reshape(-1, 2), area.ravel(), moving.ravel())


@si.checked_numbers
def sound_pressure(surface: RadiatingSurface, points: si.MetreArray) -> si.ComplexArray:
    """Complex sound pressure (Pa, zero-to-peak) at `points` (..., 3) above the surface (z > 0).

    p = iωρ/2π ∫ v exp(−ikR)/R dS, lossless, in air at 20 °C. Raises `InputError` for a point not
    above the plane.
    """
    points = np.asarray(points, dtype=float)
    if points.shape[-1:] != (3,):
        raise InputError(f"points has the shape {points.shape}; its last axis must be x, y and z")
    si.require("height of the point", points[..., 2], si.Unit("m"), at_least=0)
    flat = points.reshape(-1, 3)
    omega = 2 * math.pi * surface.frequency
    strength = surface.velocity * surface.area
    parts = np.stack([strength.real, strength.imag], axis=1)
    pressure = np.empty(len(flat), dtype=complex)
    x, y = surface.position.T
    rows = max(1, 200_000 // strength.size)  # 3 MB of complex numbers at a time
    for start in range(0, len(flat), rows):
        px, py, pz = flat[start : start + rows].T[:, :, None]
        distance = np.sqrt((px - x) ** 2 + (py - y) ** 2 + pz**2)
        si.require("distance", distance, si.Unit("m"), above=0)
        # In real numbers: the complex exponential takes several times as long.
        phase = (omega / _SOUND_SPEED) * distance
        cosine, sine = ((wave / distance) @ parts for wave in (np.cos(phase), np.sin(phase)))
        pressure[start : start + rows].real = cosine[:, 0] + sine[:, 1]
        pressure[start : start + rows].imag = cosine[:, 1] - sine[:, 0]
    return (1j * omega * _DENSITY / (2 * math.pi) * pressure).reshape(points.shape[:-1])


def pressure_level(pressure: si.ComplexArray) -> si.FloatArray:
    """Sound pressure level (dB re 20 µPa r.m.s., ISO 1683) of zero-to-peak pressures (Pa)."""
    level: si.FloatArray = 20 * np.log10(np.maximum(np.abs(pressure), 1e-30) / math.sqrt(2) / 20e-6)
    return level


@dataclass(frozen=True)
class SoundField:
    """Sound pressure levels (dB re 20 µPa) in the loudest direction at distances (m) from the
    middle of a surface, and the `guidance` for the public that they are compared with, if there is
    any for the frequency (Hz)."""

    frequency: si.Hertz
    distances: tuple[si.Metre, ...]
    sound_pressure_level_dB: tuple[float, ...]
    guidance: ExposureGuidance | None
    model: str = "baffled_rayleigh"


@si.checked_numbers
def sound_field(
    surface: RadiatingSurface, distances: tuple[si.Metre, ...] = DISTANCES
) -> SoundField:
    """The `loudest` levels at distances (m) from a surface's middle. Raises `InputError` as it
    does, and where there is no distance."""
    if not distances:
        raise InputError("distances is empty; name at least one", quantity="distances")
    levels = tuple(loudest(surface, distance).level_dB for distance in distances)
    guidance = exposure_guidance(surface.frequency)
    return SoundField(surface.frequency, tuple(distances), levels, guidance)


class Loudest(NamedTuple):
    """The highest level (dB re 20 µPa) and its direction: the angle `polar` from the normal and
    `azimuth` from the x axis (rad)."""

    level_dB: float
    polar: si.Radian
    azimuth: si.Radian


@si.checked_numbers
def loudest(surface: RadiatingSurface, distance: si.Metre) -> Loudest:
    """The sound pressure level in the loudest direction at a distance (m) from the surface's
    middle.

    A grid of at least 2.5° × 10° is searched, finer for surfaces of many waves, and the best
    direction refined to a few hundredths of a degree. The air's absorption (ISO 9613-1; about
    1 dB/m at 33 kHz) is left out, which errs on the loud side. Raises `InputError` for a distance
    within the surface's extent.
    """
    si.require("distance", distance, si.Unit("m"), above=surface.extent)
    polar, azimuth = _directions(surface)

    def at(theta: si.FloatArray, phi: si.FloatArray) -> si.FloatArray:
        out = np.sin(theta) * distance
        place = [out * np.cos(phi), out * np.sin(phi), np.maximum(np.cos(theta) * distance, 0)]
        return pressure_level(sound_pressure(surface, np.stack(place, axis=-1)))

    level = at(*np.meshgrid(polar, azimuth, indexing="ij"))
    i, j = np.unravel_index(int(np.argmax(level)), level.shape)
    loudest = (float(level[i, j]), float(polar[i]), float(azimuth[j]))
    wide = (float(polar[1]), float(azimuth[1]))
    for _ in range(3):
        near_t = np.clip(loudest[1] + wide[0] * np.linspace(-1, 1, 9), 0, math.pi / 2)
        near_p = loudest[2] + wide[1] * np.linspace(-1, 1, 9)
        t, p = np.meshgrid(near_t, near_p, indexing="ij")
        fine = at(t, p)
        i, j = np.unravel_index(int(np.argmax(fine)), fine.shape)
        loudest = max(loudest, (float(fine[i, j]), float(t[i, j]), float(p[i, j])))
        wide = (wide[0] / 4, wide[1] / 4)
    return Loudest(loudest[0], loudest[1], loudest[2] % (2 * math.pi))


def _directions(surface: RadiatingSurface) -> tuple[si.FloatArray, si.FloatArray]:
    """Polar angles and azimuths (rad) that miss no lobe of a surface."""
    # A lobe is about a wavelength over the extent wide: look at it at least four times.
    lobe = _SOUND_SPEED / surface.frequency / (2 * surface.extent)
    steps = max(36, math.ceil(2 * math.pi / lobe))
    polar = np.linspace(0, math.pi / 2, max(36, steps // 2) + 1)
    return polar, 2 * math.pi * np.arange(steps) / steps


def _require_fine(name: str, step: float, frequency: float) -> None:
    longest = _SOUND_SPEED / frequency / _COARSEST
    if step > longest:
        raise InputError(
            f"{name} has steps of {si.format_quantity(step, si.Unit('m'))}; at "
            f"{si.format_quantity(frequency, si.Unit('Hz'))} they must be at most "
            f"{si.format_quantity(longest, si.Unit('m'))} (a quarter of the wave in air)",
            quantity=name,
        )
