"""A finger on the plate: the one-mode law against the whole solved plate with a load on it."""

import numpy as np
import pytest
from scipy.linalg import block_diag
from tests.finger_stiffness import finger_stiffness, interface_stiffness

from squeezefilm.core import quantities as si
from squeezefilm.core.errors import InputError
from squeezefilm.core.materials import Gas
from squeezefilm.physics.chain.friction import friction_law
from squeezefilm.physics.chain.touch import load_ratios, touch
from squeezefilm.physics.contact.asperities import AsperityLaw
from squeezefilm.physics.contact.finger.fingertip import Skin
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.loaded_mode import LoadedMode, loaded_mode, mean_square_wave
from squeezefilm.physics.plate.solid.layers import NORMAL
from squeezefilm.physics.plate.solid.reduced import reduced_class, surface_values
from squeezefilm.physics.plate.solid.refined_modes import extrapolated_class
from squeezefilm.physics.plate.solid.response import harmonic_response
from squeezefilm.physics.plate.solid.symmetry import all_classes
from squeezefilm.physics.plate.solid.working import solid_mode
from squeezefilm.physics.plate.working_mode import working_mode

AIR = Gas(1.85e-5, 1e5, 1.2, 67e-9)


def test_mean_square_is_a_half_over_whole_waves_and_one_at_an_antinode() -> None:
    assert mean_square_wave(11e-3, 22e-3) == pytest.approx(0.5)
    assert mean_square_wave(11e-3, 1e-6) == pytest.approx(1)
    assert mean_square_wave(11e-3, 1e-6, 5.5e-3) == pytest.approx(0, abs=1e-6)
    x = np.linspace(-5e-3, 5e-3, 20001) + 2e-3
    mean = np.trapezoid(np.cos(np.pi * x / 11e-3) ** 2, x) / 10e-3
    assert mean_square_wave(11e-3, 10e-3, 2e-3) == pytest.approx(mean, rel=1e-7)


def test_without_a_load_the_mode_is_what_it_was() -> None:
    mode = loaded_mode(30e3, 60, 0.01, 0j, 1e-4, 0.7)
    assert (mode.resonance_frequency, mode.quality_factor) == pytest.approx((30e3, 60))
    assert mode.amplitude_ratio(30e3) == pytest.approx(1)
    # A lossless spring detunes and does not damp; a damper damps and does not detune.
    assert LoadedMode(30e3, 60, 0.01 + 0j).resonance_frequency > 30e3
    assert LoadedMode(30e3, 60, 1j / 60).amplitude_ratio(30e3) == pytest.approx(0.5)
    with pytest.raises(InputError, match="loss"):
        loaded_mode(30e3, 60, 0.01, -1j, 1e-4, 0.7)


def loaded_amplitude(
    plate: RectangularPlate,
    frequency: si.FloatArray,
    load: tuple[si.FloatArray, si.FloatArray, si.FloatArray],
    stiffness: si.ComplexArray,
    at: tuple[float, float],
) -> si.FloatArray:
    """|w| per volt (m/V) at a point of a plate solved with a load on its face: points x, y and
    their areas (m²), and a dynamic stiffness per area (Pa/m) for each frequency."""
    x, y, area = load
    band = float(frequency[0]), float(frequency[-1])
    # The load breaks the symmetry of the drive: every class answers.
    parts = [
        extrapolated_class(reduced_class(plate, parity, band, 15, [load], NORMAL), band)
        for parity in all_classes(plate)
    ]
    K, L, M = (
        block_diag(*(getattr(part, name) for part in parts))
        for name in ("stiffness", "loss", "mass")
    )
    pushed = np.concatenate([part.coupling @ part.drive for part in parts])
    w = surface_values(parts, x, y, plate.thickness).reshape(pushed.size, -1)
    overlap = (w * area.ravel()) @ w.T
    there = surface_values(parts, np.array([at[0]]), np.array([at[1]]), plate.thickness)[:, 0, 0]
    moved = []
    for omega, dynamic in zip(2 * np.pi * frequency, stiffness, strict=True):
        A = K + 1j * L - omega**2 * M + dynamic * overlap
        moved.append(abs(np.linalg.solve(A, -pushed) @ there))
    return np.array(moved)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stiffness", "share"), [(2e10j, 1 / 6), (6e10 + 0j, 0.4), (-3e10 + 1e10j, 0.4)]
)
def test_the_plate_with_a_load_on_it_moves_as_the_one_mode_law_says(
    stiffness: complex, share: float
) -> None:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    mode = solid_mode(plate)
    side = 8e-3
    omega = 2 * np.pi * mode.frequency
    nodes, weights = np.polynomial.legendre.leggauss(8)
    x, y = mode.lobe[0] + nodes * side / 2, plate.width / 2 + nodes * side / 2
    area = np.outer(weights, weights) * side**2 / 4
    frequency = mode.frequency * np.linspace(0.99, 1.01, 41)
    free = harmonic_response(plate, frequency).amplitude_at(*mode.lobe)
    # A damper, beside it a spring or a mass.
    turns = 2 * np.pi * frequency / omega
    spring = stiffness.real * (1.0 if stiffness.real > 0 else turns**2)
    dynamic = spring + 1j * stiffness.imag * turns
    solved = loaded_amplitude(plate, frequency, (x, y, area), dynamic, mode.lobe) / free.max()
    # The mode itself over the load, not a cosine: this is a test of the law, not of the shape.
    shape = mode.modes.field(mode.index, x, y, plate.thickness)[:, :, 2]
    lobe = mode.modes.field(
        mode.index, np.array([mode.lobe[0]]), np.array([plate.width / 2]), plate.thickness
    )[0, 0, 2]
    assert mode.modal_mass == pytest.approx(1 / lobe**2, rel=1e-6)
    mean_square = float(np.sum((shape / lobe) ** 2 * area)) / side**2
    assert mean_square == pytest.approx(mean_square_wave(mode.half_wavelength, side), rel=0.05)
    law = loaded_mode(
        mode.frequency, mode.quality_factor, mode.modal_mass, stiffness, side**2, mean_square
    )
    # The load's doing, as solved and by the law. A damper's: alike to a sixth. A spring or a mass
    # also mixes the neighbours of this crowded spectrum in, which one mode cannot show.
    changed = solved - free / free.max()
    alone = LoadedMode(mode.frequency, mode.quality_factor, 0j)
    expected = [law.amplitude_ratio(f) - alone.amplitude_ratio(f) for f in frequency]
    assert np.max(np.abs(changed)) > 0.03
    assert np.max(np.abs(changed - expected)) < share * np.max(np.abs(changed))


def test_a_finger_is_mostly_damping_over_a_thin_film_and_its_skin_stands_still() -> None:
    film = interface_stiffness(4e-6, 1e-6, 250e-6, 35e3, AIR, AsperityLaw())
    felt = finger_stiffness(film, Skin(), 35e3, 250 / 350)
    assert felt.imag > 0
    # An inertial skin, far stiffer than the film, changes it by the ratio of the two.
    ratio = abs(film / Skin().dynamic_stiffness(35e3))
    assert ratio < 0.2
    assert abs(felt / (film * 250 / 350) - 1) < 1.5 * ratio
    # A massive skin holds still: only the interface is felt. A massless one is not felt at all.
    still = finger_stiffness(film, Skin(mass_per_area=1e6), 35e3, 1.0)
    assert still == pytest.approx(film, rel=1e-4)
    gone = finger_stiffness(film, Skin(1e-6, 0.0, 0.0), 35e3, 1.0)
    assert abs(gone) < 1e-3 * abs(film)


def test_asperities_add_a_spring_that_does_not_depend_on_the_swing_if_small() -> None:
    law = AsperityLaw()
    vacuum = Gas(1.85e-5, 1.0, 1.2e-5, 67e-4)
    small = interface_stiffness(2e-6, 1e-9, 250e-6, 35e3, vacuum, law)
    # −dp/dh = p/λ of exponential asperities
    assert small.real == pytest.approx(5e3 / 0.6e-6, rel=1e-3)
    # First harmonic over a large swing: 2 p I1(a/λ)/a
    from scipy.special import i1

    large = interface_stiffness(2e-6, 1.2e-6, 250e-6, 35e3, vacuum, law)
    assert large.real == pytest.approx(2 * 5e3 * i1(2.0) / 1.2e-6, rel=1e-3)


def test_a_finger_that_takes_much_still_settles_on_the_upper_amplitude() -> None:
    # At 18 V and 1 N three amplitudes fit this plate; from no finger it comes to the upper one.
    display = load_display("winfield2007-tpad")
    mode = working_mode(display.actuator)
    for force, volts in ((0.5, 10.0), (0.5, 15.0), (1.0, 5.0), (1.0, 18.0)):
        law = friction_law(
            display, mode.half_wavelength, mode.resonance_frequency, normal_force=force
        )
        free = volts * mode.amplitude_per_volt
        settled = touch(mode, law, free).amplitude
        above = np.linspace(settled * 1.001, free, 200)
        load = load_ratios(mode, law, np.array([settled, *above]))
        alone = np.abs(1 + mode.quality_factor * (load.imag - 1j * load.real))
        made = free / alone
        assert made[0] == pytest.approx(settled, rel=1e-6)
        assert np.all(made[1:] < above)
