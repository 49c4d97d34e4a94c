"""The finger as a load: against two bodies on springs, energy, limits, and a piston in tissue."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.finger_stiffness import finger_stiffness, interface_stiffness

from squeezefilm.core.errors import InputError
from squeezefilm.core.presets import friction_folder
from squeezefilm.physics.chain.friction import friction_law
from squeezefilm.physics.chain.prediction import predict
from squeezefilm.physics.chain.touch import load_ratios, touch
from squeezefilm.physics.contact.finger.fingertip import Skin
from squeezefilm.physics.contact.finger.load import finger_impedance
from squeezefilm.physics.display import Display, load_display
from squeezefilm.physics.plate.layout import RectangularPlate
from squeezefilm.physics.plate.loaded_mode import loaded_mode
from squeezefilm.physics.plate.working_mode import WorkingMode, working_mode

F0, Q, MASS = 34e3, 100.0, 0.02
OMEGA0 = 2 * np.pi * F0
AREA, SHARE = 1e-4, 250 / 350


def two_bodies(
    interface: complex, skin: Skin, frequency: float
) -> tuple[complex, complex, float, float]:
    """Plate and skin (m per newton on the plate), and what interface and skin take (W per N²).

    Written down as two equations of motion: the plate on its spring with loss K (1 + i/Q), the
    skin over the plateaus' area behind the interface.
    """
    w, plateaus = 2 * np.pi * frequency, SHARE * AREA
    own = MASS * OMEGA0**2 * (1 + 1j / Q)
    film, tissue = interface * plateaus, skin.dynamic_stiffness(frequency) * plateaus
    matrix = np.array([[own - MASS * w**2 + film, -film], [-film, film + tissue]])
    plate, body = np.linalg.solve(matrix, [1.0, 0.0])
    between = 0.5 * w * film.imag * abs(plate - body) ** 2
    return plate, body, between, 0.5 * w * tissue.imag * abs(body) ** 2


@pytest.mark.parametrize("frequency", [33.4e3, F0, 34.5e3])
@pytest.mark.parametrize("skin", [Skin(), Skin(3.3, 0.0, 7.7e5), Skin(1.0, 3e10, 4e5)])
@pytest.mark.parametrize("interface", [2e10 + 3e10j, 4e11 + 5e10j])
def test_a_finger_on_a_mode_is_two_bodies_on_springs(
    interface: complex, skin: Skin, frequency: float
) -> None:
    felt = finger_stiffness(interface, skin, frequency, SHARE)
    loaded = loaded_mode(F0, Q, MASS, felt, AREA, 1.0)
    plate, _, film, tissue = two_bodies(interface, skin, frequency)
    static = Q / (MASS * OMEGA0**2)  # the free plate at its resonance
    assert loaded.amplitude_ratio(frequency) * static == pytest.approx(abs(plate), rel=1e-9)
    # What film and tissue turn into heat is what the impedance says that the plate gives them.
    Z = finger_impedance(felt, AREA, frequency)
    speed = 2 * np.pi * frequency * abs(plate)
    assert film + tissue == pytest.approx(0.5 * Z.real * speed**2, rel=1e-9)


def test_what_a_finger_takes_per_period_is_the_loss_of_q() -> None:
    interface, skin = 3e10 + 2e10j, Skin(3.3, 0.0, 7.7e5)
    felt = finger_stiffness(interface, skin, F0, SHARE)
    loaded = loaded_mode(F0, Q, MASS, felt, AREA, 1.0)
    plate, _, film, tissue = two_bodies(interface, skin, F0)
    stored = 0.5 * MASS * OMEGA0**2 * abs(plate) ** 2
    lost = stored / Q + (film + tissue) / OMEGA0
    assert loaded.quality_factor == pytest.approx(
        (1 + loaded.load_ratio.real) * stored / lost, rel=1e-9
    )


@pytest.mark.slow
def test_set_free_it_dies_away_with_the_loaded_q_and_at_the_loaded_frequency() -> None:
    """The same two bodies marched in time, all dampers viscous; to the first order of the load."""
    skin, spring, damper = Skin(3.3, 0.0, 7.7e5), 3e10, 1e5
    plateaus = SHARE * AREA
    interface = complex(spring, damper * OMEGA0)
    loaded = loaded_mode(F0, Q, MASS, finger_stiffness(interface, skin, F0, SHARE), AREA, 1.0)
    assert 0.02 < abs(loaded.load_ratio) * Q < 2

    def motion(_: float, state: np.ndarray) -> list[float]:
        x, v, y, u = state
        between = plateaus * (spring * (x - y) + damper * (v - u))
        own = MASS * (OMEGA0**2 * x + OMEGA0 / Q * v)
        return [
            v,
            -(own + between) / MASS,
            u,
            (between / plateaus - skin.damping_per_area * u) / skin.mass_per_area,
        ]

    time = np.linspace(20 / F0, 60 / F0, 4001)
    found = solve_ivp(
        motion, (0.0, time[-1]), [1.0, 0.0, 0.0, 0.0], t_eval=time, rtol=1e-9, atol=1e-12
    ).y
    # The envelope and phase from place and speed together.
    rotor = found[0] - 1j * found[1] / (2 * np.pi * loaded.resonance_frequency)
    decay = -np.polyfit(time, np.log(np.abs(rotor)), 1)[0]
    turned = np.polyfit(time, np.unwrap(np.angle(rotor)), 1)[0] / (2 * np.pi)
    shift = loaded.resonance_frequency - F0
    assert np.pi * loaded.resonance_frequency / decay == pytest.approx(
        loaded.quality_factor, rel=0.01
    )
    # Damping alone lowers the frequency, by 0.4 Hz.
    assert turned - F0 == pytest.approx(shift, abs=0.05 * abs(shift) + 1.0)


def test_a_stiff_interface_makes_it_a_mass_and_a_soft_one_nothing() -> None:
    still = Skin(damping_per_area=0.0)
    errors = []
    for mass in (0.4, 0.2, 0.1):
        skin = dataclasses.replace(still, mass_per_area=mass)
        felt = finger_stiffness(1e18 + 0j, skin, F0, SHARE)
        loaded = loaded_mode(F0, Q, MASS, felt, AREA, 1.0)
        added = mass * SHARE * AREA
        assert finger_impedance(felt, AREA, F0) == pytest.approx(1j * OMEGA0 * added, rel=1e-5)
        assert loaded.quality_factor == pytest.approx(Q, rel=5 * added / MASS)
        errors.append(loaded.resonance_frequency / F0 - 1 + added / (2 * MASS))
    # −Δm/2M, and what is left of it falls with its square.
    assert np.abs(errors) == pytest.approx([1.1e-7 * 4, 1.1e-7, 1.1e-7 / 4], rel=0.8)
    assert np.log2(np.abs(errors[0] / errors[1])) == pytest.approx(2, abs=0.2)
    soft = loaded_mode(F0, Q, MASS, finger_stiffness(1e3 + 1e3j, Skin(), F0, SHARE), AREA, 1.0)
    assert (soft.resonance_frequency, soft.quality_factor) == pytest.approx((F0, Q), rel=1e-6)


FORCES = np.array([0.1, 0.25, 0.5, 1.0, 1.6])


def pressed(force: float, amplitude: float) -> complex:
    """The impedance of the default finger on the plate of the published fingertips (N s/m)."""
    display = load_display(friction_folder() / "monnoyer2018-glass.toml")
    found = predict(display, vibration_amplitude=amplitude, normal_force=force).touch.impedance
    assert found is not None
    return found


def test_a_resting_finger_is_the_mass_and_the_damper_that_was_published() -> None:
    """43 fingertips at 0.5 N (monnoyer2018-fingertips.csv), from which the skin's mass is derived:
    medians 18.9 N s/m and 0.112 g, and every one a mass."""
    table = np.loadtxt(friction_folder() / "monnoyer2018-fingertips.csv", delimiter=",", skiprows=1)
    damping, mass = np.median(table, axis=0)
    Z = pressed(0.5, 1e-8)
    assert Z.real == pytest.approx(damping, rel=0.2)
    assert Z.imag / (2 * np.pi * 34.59e3) == pytest.approx(1e-3 * mass, rel=0.2)
    published = damping + 2e-3j * np.pi * 34.59e3 * mass
    assert abs(Z) == pytest.approx(abs(published), rel=0.1)


def test_it_grows_with_the_force_and_falls_with_the_amplitude_as_published() -> None:
    """|Z| as F^0.3 up to 1.6 N, and seven times less at 1.1 than at 0.1 µm for one person: none of
    it went into the skin's mass. A resting finger lowers the resonance from 0.25 N on."""
    Z = np.array([pressed(force, 1e-8) for force in FORCES])
    assert np.all(Z[1:].imag > 0)
    exponent = np.polyfit(np.log(FORCES), np.log(np.abs(Z)), 1)[0]
    assert exponent == pytest.approx(0.3, abs=0.15)
    assert np.max(np.abs(np.log(np.abs(Z) / (24 * FORCES**0.3)))) < np.log(1.55)
    assert abs(pressed(0.5, 1e-7)) / abs(pressed(0.5, 1.1e-6)) == pytest.approx(7, rel=0.4)


def test_no_finger_is_felt_more_than_its_load_allows() -> None:
    """|Z| ≤ (√(4 F p0 A/5) + 2 F)/(ωa): the published 33 N s/m are not of an amplitude of 1 µm."""
    w = 2 * np.pi * 34.59e3
    for force in FORCES:
        # The area grows as F^(1/3) and is 1 cm² at 0.5 N.
        area = 1e-4 * (force / 0.5) ** (1 / 3)
        most = np.sqrt(0.8 * force * 1e5 * area) + 2 * force
        for amplitude in (0.3e-6, 1e-6, 2e-6):
            assert abs(pressed(force, amplitude)) < most / (w * amplitude)
        if force == 0.5:
            assert most / (w * 1e-6) == pytest.approx(13.8, abs=0.1)
            assert most / (w * 33.0) == pytest.approx(0.42e-6, abs=0.005e-6)


@pytest.mark.parametrize(("force", "bound"), [(0.2, 28.3), (0.5, 57.6)])
def test_through_film_and_asperities_of_a_light_touch_no_skin_would_be_felt_like_that(
    force: float, bound: float
) -> None:
    """1/K = 1/K_i + 1/D, and Im 1/D ≤ 0 of a skin that makes no energy: so |K| ≤ |K_i|²/Im K_i."""
    Ki = resting(force, 1e-8)
    most = finger_impedance(SHARE * abs(Ki) ** 2 / Ki.imag + 0j, AREA, 34e3)
    assert abs(most) == pytest.approx(bound, abs=0.2)
    for skin in (Skin(), Skin(3.3, 0.0, 7.7e5), Skin(0.5, 0.0, 1e4), Skin(3.3, 1.2e11, 1e3)):
        felt = finger_impedance(finger_stiffness(Ki, skin, 34e3, SHARE), AREA, 34e3)
        assert abs(felt) <= abs(most) * (1 + 1e-9)
    # Reached by a mass in resonance with the interface, Re 1/D = −Re 1/K_i, and no damping.
    resonant = Skin(abs(Ki) ** 2 / Ki.real / (2 * np.pi * 34e3) ** 2, 0.0, 0.0)
    if force == 0.5:
        assert resonant.mass_per_area == pytest.approx(1.83, abs=0.02)
    felt = finger_impedance(finger_stiffness(Ki, resonant, 34e3, SHARE), AREA, 34e3)
    assert felt == pytest.approx(abs(most), rel=1e-9)


@pytest.mark.parametrize(
    ("force", "amplitude", "expected"),
    [(0.5, 1e-8, 27 + 29j), (2.0, 1e-8, 3 + 28j), (0.5, 1e-6, 15 - 3j), (2.0, 1e-6, 32 + 21j)],
)
def test_a_plate_feels_a_finger_as_the_page_on_models_says(
    force: float, amplitude: float, expected: complex
) -> None:
    felt = finger_stiffness(resting(force, amplitude), Skin(), 34e3, SHARE)
    assert finger_impedance(felt, AREA, 34e3) == pytest.approx(expected, abs=1.0)
    with pytest.raises(InputError, match="mean_square"):
        finger_impedance(felt, AREA, 34e3, 1.2e4)


def resting(force: float, amplitude: float) -> complex:
    """The interface (Pa/m) of a finger on 1 cm² of the glass pad's surface, at 34 kHz."""
    law = friction_law(load_display("touchpad-glass"), 9.2e-3, 34e3, normal_force=force)
    gap = float(law.sharing(amplitude).mean_gap[0])
    asperities = law.finger.asperity_law(law.surface.roughness)
    return interface_stiffness(gap, amplitude, 250e-6, 34e3, law.gas, asperities)


def preset(name: str) -> tuple[Display, WorkingMode]:
    """A preset with its mode, plates as beams, which take milliseconds."""
    display = load_display(name)
    plate = isinstance(display.actuator, RectangularPlate)
    mode = working_mode(display.actuator, "timoshenko" if plate else "solid")
    if mode.modal_mass is None:
        # As light as a glass plate the stator is harder to settle on than it can be.
        mode = dataclasses.replace(mode, modal_mass=0.02)
    return display, mode


@pytest.mark.parametrize(
    "name",
    [
        "biet2008-plate",
        "biet2008-stator",
        "touchpad-glass",
        "basdogan2020-glass",
        "winfield2007-tpad",
    ],
)
def test_every_preset_settles_from_a_touch_to_five_newtons_up_to_its_voltage(name: str) -> None:
    display, mode = preset(name)
    assert mode.modal_mass is not None
    w = 2 * np.pi * mode.resonance_frequency
    for force in np.geomspace(0.05, 5.0, 9):
        law = friction_law(
            display, mode.half_wavelength, mode.resonance_frequency, normal_force=float(force)
        )
        for share in (0.01, 0.1, 0.3, 0.6, 0.8, 1.0):
            free = share * display.drive.voltage * mode.amplitude_per_volt
            found = touch(mode, law, free)
            assert found.mode is not None
            assert found.impedance is not None
            assert 0 < found.kept < 1
            left = free * found.mode.amplitude_ratio(law.frequency)
            assert found.amplitude == pytest.approx(left, abs=1e-8 * free)
            # Half Re Z v² is what the loss of Q says.
            taken = 0.5 * found.impedance.real * (w * found.amplitude) ** 2
            stored = 0.5 * mode.modal_mass * (w * found.amplitude) ** 2
            loss = (1 + found.mode.load_ratio.real) / found.mode.quality_factor
            assert taken == pytest.approx((loss - 1 / mode.quality_factor) * w * stored, rel=1e-9)


@pytest.mark.parametrize(("force", "volts"), [(1.9155934247786433, 18.0), (2.32079441676, 20.0)])
def test_near_a_fold_the_upper_amplitude_is_found(force: float, volts: float) -> None:
    """Forces and voltages at which secants alone crawl for longer than they may."""
    display, mode = preset("winfield2007-tpad")
    law = friction_law(display, mode.half_wavelength, mode.resonance_frequency, normal_force=force)
    free = volts * mode.amplitude_per_volt
    settled = touch(mode, law, free).amplitude
    above = np.linspace(settled * 1.001, free, 300)
    load = load_ratios(mode, law, np.array([settled, *above]))
    made = free / np.abs(1 + mode.quality_factor * (load.imag - 1j * load.real))
    assert made[0] == pytest.approx(settled, rel=1e-6)
    assert np.all(made[1:] < above)
