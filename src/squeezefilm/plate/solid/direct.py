"""The admittance by one direct solve with complex constants: the check of the reduced response."""

from __future__ import annotations

import numpy as np

from squeezefilm import quantities as si
from squeezefilm.hard_limits import FREQUENCY, require_within
from squeezefilm.plate.elements.blas_threads import one_blas_thread
from squeezefilm.plate.elements.cross_section import CrossSection
from squeezefilm.plate.elements.slab_factor import SlabFactor
from squeezefilm.plate.elements.slabs import Slabs
from squeezefilm.plate.layout import RectangularPlate
from squeezefilm.plate.solid.mesh import plate_model
from squeezefilm.plate.solid.modes import SolvedModel
from squeezefilm.plate.solid.reduced import (
    class_drive,
    loss_weight,
    resolved_frequency,
    spring_losses,
)
from squeezefilm.plate.solid.resolution import NORMAL, Resolution
from squeezefilm.plate.solid.symmetry import drive_classes


@si.checked_numbers
def direct_admittance(
    plate: RectangularPlate, frequency: si.Hertz, resolution: Resolution = NORMAL
) -> tuple[complex, list[si.ComplexArray]]:
    """Y (S) by a direct solve with complex constants at one frequency, and the solution of each
    driven class: the check of the reduced response. Electrodes driven or shorted only.

    Raises `InputError` for a frequency outside its hard limit.
    """
    require_within(FREQUENCY, frequency, "frequency")
    omega, charge = 2 * np.pi * frequency, 0j
    solutions: list[si.ComplexArray] = []
    with one_blas_thread():
        for parity in drive_classes(plate):
            built = plate_model(
                plate, resolved_frequency((frequency, frequency)), resolution, parity
            )
            slabs = Slabs(built.model)
            solved = SolvedModel(plate, built, slabs)
            lossy = slabs.weighted_sections(loss_weight, spring_losses(built.model.foundations))
            made: dict[int, CrossSection] = {}
            sections = []
            for real, loss in zip(slabs.sections, lossy, strict=True):
                if id(real.P2) not in made:
                    made[id(real.P2)] = CrossSection(
                        real.codes,
                        real.P2 + 1j * loss.P2,
                        real.P1 + 1j * loss.P1,
                        real.P0 + 1j * loss.P0,
                        real.R,
                        real.electrodes,
                        real.g0,
                        real.g1,
                        real.c0,
                    )
                sections.append(made[id(real.P2)])
            factor = SlabFactor(slabs, omega**2, sections=sections)
            G, C = slabs.electrode_columns
            drive = class_drive(plate, solved)
            x = factor.solve(-(G @ drive)[:, None].astype(complex))
            charge -= complex(built.copies * (drive @ (G.T @ x[:, 0] + C @ drive)))
            solutions.append(x[:, 0])
    return 1j * omega * charge, solutions
