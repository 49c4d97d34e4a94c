"""Body to be solved of a described disc or stator: section, drive, working mode."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.physics.plate.elements.nodal_lines import zero_crossings
from squeezefilm.physics.plate.layout import AnnularStator, DiscPlate
from squeezefilm.physics.plate.ring.modes import AnnularMode, bending_mode
from squeezefilm.physics.plate.ring.section import (
    AnnularSection,
    SectorDrive,
    alternate_sectors,
    bonded_disc,
    full_drive,
)
from squeezefilm.physics.plate.ring.stator import StatorAssumptions, StatorFit, fit_stator

Direction = Literal["circumference", "diameter"]


@dataclass(frozen=True, eq=False)
class RingBody:
    """A ring or a disc ready to be solved.

    `label` is (nodal circles, nodal diameters) of its working mode. `quality_factor` is None where
    every material has its own. `fit` says what was fitted and assumed of a stator.
    """

    section: AnnularSection
    drive: SectorDrive
    label: tuple[int, int]
    quality_factor: si.Dimensionless | None
    fit: StatorFit | None = None

    @si.checked_numbers
    def mode(self, label: tuple[int, int] | None = None) -> AnnularMode:
        """The mode B(circles, diameters), by default the working mode. Raises `InputError`."""
        circles, diameters = label or self.label
        if self.fit is not None and (circles, diameters) == self.label:
            return self.fit.mode
        return bending_mode(self.section, diameters, circles, quality_factor=self.quality_factor)


@functools.lru_cache(maxsize=8)
def ring_body(actuator: AnnularStator | DiscPlate) -> RingBody:
    """The body of a described actuator; a stator's thickness is fitted to its frequency.

    Raises `UnreachableError` for a stator whose frequency no thickness reaches.
    """
    if isinstance(actuator, DiscPlate):
        return _disc(actuator)
    fit = fit_stator(
        actuator.resonance_frequency,
        actuator.wavelength,
        round(actuator.wavelengths_around),
        stator_assumptions(actuator),
    )
    return RingBody(
        fit.section,
        fit.drive,
        (0, round(actuator.wavelengths_around)),
        actuator.quality_factor,
        fit,
    )


def stator_assumptions(actuator: AnnularStator) -> StatorAssumptions:
    """Assumptions for what is not described of a stator, with what is described put in its place.

    Its outer diameter, Q and the teeth's fill are its own; a stator described without teeth has
    none. Materials, ceramic, height of the teeth and the channel stay assumed.
    """
    toothed = actuator.tooth_pitch is not None and actuator.slot_width is not None
    return StatorAssumptions(
        outer_diameter=actuator.mean_diameter + actuator.radial_width,
        quality_factor=actuator.quality_factor,
        tooth_height=StatorAssumptions.tooth_height if toothed else 0.0,
        tooth_fill=1 - (actuator.slot_width or 0.0) / (actuator.tooth_pitch or 1.0),
        driven_sectors=min(
            StatorAssumptions.driven_sectors, 2 * round(actuator.wavelengths_around)
        ),
    )


def _disc(disc: DiscPlate) -> RingBody:
    m = disc.nodal_diameters
    drive = alternate_sectors(disc.sectors, math.pi / m) if m else full_drive()
    quality = disc.quality_factor if disc.substrate.quality_factor is None else None
    return RingBody(bonded_disc(disc), drive, (disc.nodal_circles, m), quality)


@si.checked_numbers
def surface_profile(mode: AnnularMode, radius: si.MetreArray) -> si.DimensionlessArray:
    """The mode's u_z on the surface at radii (m), between its nodes by a cubic spline."""
    # Imports that a list of modes has no use for.
    from scipy.interpolate import CubicSpline

    values: si.DimensionlessArray = CubicSpline(mode.surface_radius, mode.surface_shape)(radius)
    return values


def nodal_circles(mode: AnnularMode) -> si.MetreArray:
    """The radii (m) at which the surface stands still, rising."""
    r = np.linspace(mode.surface_radius[0], mode.surface_radius[-1], 801)
    return zero_crossings(r, surface_profile(mode, r))


def half_wavelength_of(mode: AnnularMode) -> tuple[si.Metre | None, Direction]:
    """The half wavelength (m) that a finger meets, and along what it is measured.

    With nodal diameters along the circumference on which wavelengths are measured. Without, along a
    diameter: the mean distance at which it crosses nodal circles, through the middle too, so twice
    the radius where there is one circle only. None where nothing is crossed twice.
    """
    if mode.half_wavelength is not None:
        return mode.half_wavelength, "circumference"
    circles = nodal_circles(mode)
    if not circles.size:
        return None, "diameter"
    return float(2 * circles[-1] / (2 * circles.size - 1)), "diameter"
