"""Values computed for each published claim, one short function each, from the presets."""

from __future__ import annotations

import dataclasses
import functools
import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from squeezefilm.core import quantities as si
from squeezefilm.design.analysis.paper_procedure import (
    PAPER_HALF_WAVELENGTHS,
    PaperDesign,
    design_plate,
    friction_criterion,
    timoshenko_half_wavelength,
)
from squeezefilm.design.plate.solved import (
    PlatePoint,
    with_glue,
    with_loss_in_ceramic_alone,
    working_point,
)
from squeezefilm.physics.chain.friction import friction_law
from squeezefilm.physics.contact.sharing.levitation import (
    relative_friction,
    vibration_amplitude_for,
)
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.film.closed import contact_mean_pressure, mean_pressure_profile
from squeezefilm.physics.film.gap import (
    PaperGap,
    frequency_for_squeeze_number,
    squeeze_number,
    squeeze_number_printed,
)
from squeezefilm.physics.film.validity import asymptotic_fraction
from squeezefilm.physics.plate.beam_modes import (
    euler_bernoulli_half_wavelength,
    timoshenko_frequency,
)
from squeezefilm.physics.plate.beam_response import beam_response
from squeezefilm.physics.plate.laminate import Laminate, LaminateLayer, laminate, plate_laminate
from squeezefilm.physics.plate.layout import AnnularStator
from squeezefilm.validation.explanations import MODAL_FREQUENCY, paper_plate, paper_points

PRINTED_HALF_WAVELENGTH: si.Metre = 10.37e-3
PRINTED_WIDTH: si.Metre = 50e-3  # section 3.1.1 chooses b = 50 mm, section 3.1.2 ends at 49 mm


@dataclass(frozen=True)
class ClaimValue:
    """The values found for a claim, in SI: the corrected value; what the printed formula gives; the
    value under another reading of the print; a note on models and inputs."""

    value: tuple[float, ...]
    printed_formula_value: tuple[float, ...] | None = None
    alternative: tuple[float, ...] | None = None
    note: str = ""


GLASS_MODULUS: si.Pascal = 74e9
GLASS_DENSITY: si.KilogramPerCubicMetre = 2500.0
GLASS_PLATES = ((67e-3, 5e-3, 29.08e3), (105e-3, 3.3e-3, 34.917e3), (135e-3, 3.2e-3, 30e3))
"""Length and thickness (m) and measured resonance (Hz) of glass plates of one laboratory."""

Computes = Callable[..., ClaimValue]
CLAIM_VALUES: dict[str, Computes] = {}


def value_of(
    claim: str, values: dict[str, Computes] = CLAIM_VALUES
) -> Callable[[Computes], Computes]:
    """Enter a function as what computes a claim's value."""

    def register(function: Computes) -> Computes:
        values[claim] = function
        return function

    return register


@functools.cache
def _stator() -> Display:
    return load_display("biet2008-stator")


def _gap(
    amplitude: si.Metre, roughness: si.Metre = 0.6e-6, half_wavelength: si.Metre = 9.35e-3
) -> PaperGap:
    display = _stator()
    surface = dataclasses.replace(display.surface(), roughness=roughness)
    law = friction_law(display, half_wavelength, 40.5e3, surface=surface, model="paper2008")
    return law.gap(amplitude)


def _film(gap: PaperGap) -> tuple[si.Metre, si.MetreLike, si.PascalSecond, si.Pascal]:
    """Length, thickness, viscosity and pressure in the squeeze number of a gap on the stator."""
    gas = _stator().gas
    return gap.contact_length, gap.reference_thickness, gas.viscosity, gas.ambient_pressure


def _sigma(frequency: float, gap: PaperGap) -> tuple[float, float]:
    film = _film(gap)
    return float(squeeze_number(frequency, *film)), float(squeeze_number_printed(frequency, *film))


def _force_and_ambient() -> tuple[float, float]:
    return _stator().finger.normal_force, _stator().gas.ambient_pressure


@value_of("squeeze-number-stator")
def _() -> ClaimValue:
    value, printed = _sigma(40.5e3, _gap(2e-6))
    return ClaimValue((value,), (printed,), note="the printed formula's value is in 1/m")


@value_of("squeeze-number-plate")
def _() -> ClaimValue:
    value, printed = _sigma(30.5e3, _gap(1.15e-6))
    other, _ = _sigma(30.5e3, _gap(2.3e-6))
    return ClaimValue(
        (value,), (printed,), (other,), "alternative: 2.3 µm taken as the amplitude itself"
    )


@value_of("frequency-criterion")
def _() -> ClaimValue:
    rough, smooth = (
        float(frequency_for_squeeze_number(10.0, *_film(_gap(3e-6, r)))) for r in (1.6e-6, 0.6e-6)
    )
    return ClaimValue((rough,), alternative=(smooth,), note="alternative: 0.6 µm")


@value_of("asymptote-at-10")
def _() -> ClaimValue:
    return ClaimValue((float(asymptotic_fraction(10.0)),), note="smooth strip, small amplitude")


@value_of("asymptote-at-20")
def _() -> ClaimValue:
    sigma, _ = _sigma(40.5e3, _gap(2e-6))
    return ClaimValue((float(asymptotic_fraction(sigma)),), note="smooth strip, small amplitude")


@value_of("mean-pressure-above-one")
def _() -> ClaimValue:
    gap = _gap(2e-6)
    return ClaimValue(
        (float(contact_mean_pressure(gap)),),
        (float(contact_mean_pressure(gap, "paper2008-printed")),),
    )


@value_of("ridge-peaks")
def _() -> ClaimValue:
    gap = _gap(2e-6)
    X = np.linspace(0, 0.03, 30001)
    profile = mean_pressure_profile(X, gap)
    top = int(np.argmax(profile))
    return ClaimValue((float(X[top]) * gap.contact_length,), note=f"peak {profile[top]:.3f} p0")


@value_of("levitation-amplitude")
def _() -> ClaimValue:
    force, ambient = _force_and_ambient()
    gaps = [_gap(0.0, roughness) for roughness in (6e-7, 2e-7)]
    rough, smooth = (vibration_amplitude_for(0.0, gap, force, ambient) for gap in gaps)
    return ClaimValue((rough,), alternative=(smooth,), note="alternative: roughness 0.2 µm")


@value_of("two-micrometres-are-felt")
def _() -> ClaimValue:
    force, ambient = _force_and_ambient()
    rough, smooth = (float(relative_friction(_gap(2e-6, r), force, ambient)) for r in (6e-7, 2e-7))
    printed = float(relative_friction(_gap(2e-6), force, ambient, "paper2008-printed"))
    return ClaimValue((rough,), (printed,), (smooth,), "alternative: roughness 0.2 µm")


@value_of("friction-criterion")
def _() -> ClaimValue:
    force, ambient = _force_and_ambient()
    found = friction_criterion(_gap(0.0), PAPER_HALF_WAVELENGTHS, 0.7, force, ambient)
    values = tuple(float(value) for value in found)
    return ClaimValue(values, alternative=values[::-1], note="alternative: the list reversed")


def _section() -> Laminate:
    return plate_laminate(paper_plate(), "paper")


@value_of("half-wavelength-limit")
def _() -> ClaimValue:
    section = _section()
    G, M = section.bending_stiffness, section.mass_per_area
    euler = float(euler_bernoulli_half_wavelength(20.6e3, G, M))
    # As printed: ω taken for f_n, and the width in G_b alone.
    printed = np.pi * (G * PRINTED_WIDTH / M) ** 0.25 / np.sqrt(20.6e3)
    timoshenko = timoshenko_half_wavelength(20.6e3, section)
    return ClaimValue((euler,), (float(printed),), (timoshenko,), "alternative: Timoshenko beam")


@value_of("half-wavelength-of-mode")
def _() -> ClaimValue:
    beam = beam_response(paper_plate(), "euler_bernoulli", "paper")
    return ClaimValue((beam.mode.half_wavelength,), (paper_plate().length / 8,))


def _bare_glass(thickness: si.Metre) -> Laminate:
    """A plate of the glass of Wiertlewski's laboratory, wider than its waves, without ceramics."""
    poisson_ratio = 0.22
    modulus = GLASS_MODULUS / (1 - poisson_ratio**2)
    shear_modulus = GLASS_MODULUS / (2 * (1 + poisson_ratio))
    return laminate([LaminateLayer(thickness, modulus, shear_modulus, GLASS_DENSITY)])


@value_of("glass-half-wavelength")
def _() -> ClaimValue:
    half = timoshenko_half_wavelength(29.08e3, _bare_glass(5e-3))
    return ClaimValue((half,), note="bare glass as a Timoshenko beam, Poisson's ratio 0.22 assumed")


@value_of("glass-resonances")
def _() -> ClaimValue:
    nearest = []
    for length, thickness, measured in GLASS_PLATES:
        halves = length / (np.arange(2.0, 20.0) - 0.5)
        modes = np.asarray(timoshenko_frequency(halves, _bare_glass(thickness)))
        nearest.append(float(modes[np.argmin(np.abs(np.log(modes / measured)))]))
    return ClaimValue(
        tuple(nearest), note="the nearest (n,0) mode of bare glass; modes are 20 % apart and more"
    )


@value_of("prototype-is-enough")
def _() -> ClaimValue:
    force, ambient = _force_and_ambient()
    gap = _gap(1.15e-6, half_wavelength=PRINTED_HALF_WAVELENGTH)
    needed = vibration_amplitude_for(0.7, gap, force, ambient)
    return ClaimValue(
        (float(relative_friction(gap, force, ambient)),), note=f"0.7 needs {needed * 1e6:.3g} µm"
    )


@value_of("plate-area")
@value_of("workspace")
def _() -> ClaimValue:
    return ClaimValue((paper_plate().area,))


@value_of("plate-length")
def _() -> ClaimValue:
    patches = paper_plate().patches
    gaps = sum(right.x - left.x - left.length for left, right in itertools.pairwise(patches))
    return ClaimValue((sum(patch.length for patch in patches) + gaps,))


@value_of("stator-wavelength")
def _() -> ClaimValue:
    actuator = _stator().actuator
    assert isinstance(actuator, AnnularStator)
    return ClaimValue((actuator.wavelengths_around,))


@value_of("effective-coupling")
def _() -> ClaimValue:
    return ClaimValue((paper_plate().ceramic.stress_coefficient_from_d31,))


def paper_design() -> PaperDesign:
    """The design to which the paper's procedure (section 3.1) leads with its own laminate and
    finger."""
    gas = _stator().gas
    force, _ = _force_and_ambient()
    return design_plate(_section(), _gap(0.0), gas.viscosity, gas.ambient_pressure, force)


def _frequencies(note: str) -> ClaimValue:
    """The frequency of the solved plate, and in the alternative reading with the printed e31."""
    ours, printed = paper_points()
    return ClaimValue((ours.frequency,), alternative=(printed.frequency,), note=note)


def _kilohertz(value: float) -> str:
    return f"{value / 1e3:.2f} kHz"


@value_of("modal-frequency")
def _() -> ClaimValue:
    ours, _ = paper_points()
    against = f"{100 * (MODAL_FREQUENCY / ours.frequency - 1):+.1f} %".replace("-", "−")
    beams = [
        f"{theory.replace('_', '–')} {section.replace('_', ' ')} "
        f"{_kilohertz(beam_response(paper_plate(), theory, section).mode.frequency)}"
        for theory in ("euler_bernoulli", "timoshenko")
        for section in ("paper", "plane_stress", "plane_strain")
    ]
    return _frequencies(
        "solved plate, mode (8,0), alternative: the printed e31; the paper stands "
        f"{against} from it; " + "; ".join(beams),
    )


@value_of("harmonic-frequency")
def _() -> ClaimValue:
    ours, printed = paper_points()
    return _frequencies(
        "alternative: the printed e31; with the terminals open "
        f"{_kilohertz(ours.open_frequency)} and {_kilohertz(printed.open_frequency)}"
    )


def _amplitude(point: PlatePoint) -> si.Metre:
    """The largest amplitude on the upper face at the drive's voltage."""
    assert point.largest_per_volt is not None
    return load_display("biet2008-plate").drive.voltage * point.largest_per_volt


def _amplitudes(note: str) -> ClaimValue:
    """The amplitude of the solved plate, and in the alternative reading with the printed e31."""
    ours, printed = (_amplitude(point) for point in paper_points())
    return ClaimValue((ours,), alternative=(printed,), note=note)


@value_of("harmonic-amplitude")
def _() -> ClaimValue:
    loss = _amplitude(working_point(with_loss_in_ceramic_alone(paper_plate())))
    return _amplitudes(
        "alternative: the printed e31; Q 60 in all materials, largest of the upper face; with "
        f"the loss in the ceramic alone {loss * 1e6:.2f} µm with d31"
    )


@value_of("measured-frequency")
def _() -> ClaimValue:
    glued = working_point(with_glue(paper_plate(), 50e-6, 1e9), amplitude=False).frequency
    return _frequencies(
        "perfect bond, alternative: the printed e31; with 50 µm of glue of 1 GPa "
        f"{_kilohertz(glued)}",
    )


@value_of("measured-amplitude")
def _() -> ClaimValue:
    return _amplitudes("alternative: the printed e31")
