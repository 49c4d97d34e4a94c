"""The one mode a display works in, whatever the actuator: frequency, wavelength, Q, µm per volt.

This is the seam between the vibrating body and everything above it. A beam makes it for a plate,
measured values make it for a stator; a solved plate can take the beam's place.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from squeezefilm.plate.beam import BeamTheory
from squeezefilm.plate.laminate import CrossSection
from squeezefilm.plate.layout import Actuator, AnnularStator
from squeezefilm.plate.response import BeamResponse, beam_response
from squeezefilm.quantities import (
    Dimensionless,
    DimensionlessLike,
    Hertz,
    HertzLike,
    Metre,
    MetrePerVolt,
    MetrePerVoltLike,
    closed_form,
)


@closed_form(positive="frequency resonance_frequency quality_factor")
def resonance_factor(
    frequency: HertzLike, resonance_frequency: Hertz, quality_factor: Dimensionless
) -> DimensionlessLike:
    """The amplitude off resonance relative to the one at resonance, of one mode; broadcasts.

    1 / √(Q²(1 − (f/f0)²)² + 1) for structural damping 1/Q. Valid near the mode, where the others
    add little.
    """
    ratio = (frequency / resonance_frequency) ** 2
    factor: DimensionlessLike = 1 / np.sqrt(quality_factor**2 * (1 - ratio) ** 2 + 1)
    return factor


@dataclass(frozen=True, eq=False)
class WorkingMode:
    """The mode a display works in; amplitudes are zero-to-peak at the largest interior lobe.

    `model` names what made the numbers; `beam` is the beam behind it, if one is.
    """

    label: str
    resonance_frequency: Hertz
    half_wavelength: Metre
    quality_factor: Dimensionless
    amplitude_per_volt: MetrePerVolt
    model: str
    beam: BeamResponse | None = None

    def amplitude_per_volt_at(self, frequency: HertzLike) -> MetrePerVoltLike:
        """Zero-to-peak amplitude per volt (m/V) at a frequency near resonance."""
        return self.amplitude_per_volt * resonance_factor(
            frequency, self.resonance_frequency, self.quality_factor
        )


def working_mode(
    actuator: Actuator,
    theory: BeamTheory = "timoshenko",
    cross_section: CrossSection = "plane_strain",
) -> WorkingMode:
    """The working mode of an actuator.

    A plate is computed as a beam (see `beam_response` for its range and error); a stator is taken
    as measured, linear in the voltage.
    """
    if isinstance(actuator, AnnularStator):
        return WorkingMode(
            label=f"B(0,{round(actuator.wavelengths_around)})",
            resonance_frequency=actuator.resonance_frequency,
            half_wavelength=actuator.wavelength / 2,
            quality_factor=actuator.quality_factor,
            amplitude_per_volt=actuator.reference_amplitude / actuator.reference_voltage,
            model="measured_stator",
        )
    beam = beam_response(actuator, theory, cross_section)
    return WorkingMode(
        label=f"({actuator.nodal_lines},0)",
        resonance_frequency=beam.mode.frequency,
        half_wavelength=beam.mode.half_wavelength,
        quality_factor=actuator.quality_factor,
        amplitude_per_volt=beam.amplitude_per_volt,
        model=beam.model,
        beam=beam,
    )
