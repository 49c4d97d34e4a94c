"""The skin-stretch array: its file, load line, the whole array, patterns, budget, refusals."""

import dataclasses

import numpy as np
import pytest

from squeezefilm.actuators.described import load_actuator
from squeezefilm.actuators.skin_stretch import bimorph, cradle
from squeezefilm.actuators.skin_stretch.array import (
    Budget,
    SkinStretchArray,
    SkinStretchDescription,
    charging_power,
    lines_needed,
    loss_power,
)
from squeezefilm.core.errors import GeometryError, InputError, OutOfRangeError, UnreachableError
from squeezefilm.physics.contact.finger.fingertip import FingerpadDynamics
from squeezefilm.physics.render.texture.shapes import SineWave


@pytest.fixture(scope="module")
def array() -> SkinStretchArray:
    described = load_actuator("biet2008-skin-stretch")
    assert isinstance(described, SkinStretchDescription)
    return described.skin_stretch


def test_the_preset_has_nearly_the_published_figures(array: SkinStretchArray) -> None:
    bender, voltage = array.bender, array.actuator.largest_voltage
    assert bender.deflection_per_volt * voltage == pytest.approx(bimorph.PUBLISHED_FREE, rel=0.05)
    assert bender.force_per_volt * voltage == pytest.approx(bimorph.PUBLISHED_BLOCKED, rel=0.1)
    skin = array.tissue.under_contactor(*array.cradle.size)
    assert skin.stiffness == pytest.approx(bimorph.IMPLIED_STIFFNESS, rel=0.01)
    loaded = bimorph.loaded_tip(bender, skin, voltage)
    assert loaded.deflection == pytest.approx(bimorph.PUBLISHED_LOADED, rel=0.05)
    mass, stiffness = bender.effective_mass + skin.mass, bender.stiffness + skin.stiffness
    assert (2 * np.pi * loaded.resonance_frequency) ** 2 == pytest.approx(stiffness / mass)
    rate = 2 * np.pi * loaded.bandwidth
    gain = abs(stiffness / (stiffness - mass * rate**2 + 1j * rate * skin.damping))
    assert abs(np.log2(gain)) == pytest.approx(0.5)  # 3 dB
    assert array.cradle.count == 60
    assert array.budget.over == ()


def test_the_implied_load_is_what_a_linear_actuator_leaves() -> None:
    own = bimorph.PUBLISHED_BLOCKED / bimorph.PUBLISHED_FREE
    found = bimorph.loaded_deflection(bimorph.PUBLISHED_FREE, own, bimorph.IMPLIED_STIFFNESS)
    assert found == pytest.approx(bimorph.PUBLISHED_LOADED, rel=1e-12)


def test_the_load_line_meets_the_skin_where_bisection_finds_it(array: SkinStretchArray) -> None:
    skin, bender = FingerpadDynamics(400.0, 0.5, 1e-5), array.bender
    found = bimorph.loaded_tip(bender, skin, 100.0)
    low, high = 0.0, bender.deflection_per_volt * 100.0
    for _ in range(80):
        middle = (low + high) / 2
        given = bender.force_per_volt * 100.0 - bender.stiffness * middle
        low, high = (middle, high) if given > skin.stiffness * middle else (low, middle)
    assert found.deflection == pytest.approx(low, rel=1e-12)
    # At the bandwidth the motion has left by 3 dB, and nowhere before.
    f = np.linspace(0.0, found.bandwidth, 400)
    share = np.abs(bimorph.tip_motion(bender, skin, 100.0, f)) ** 2 / found.deflection**2
    assert np.all((share[:-1] < 2) & (share[:-1] > 0.5))
    assert min(abs(share[-1] - 2), abs(share[-1] - 0.5)) < 1e-6


def test_a_heavily_damped_tip_falls_by_3_db_before_it_rises(array: SkinStretchArray) -> None:
    found = bimorph.loaded_tip(array.bender, FingerpadDynamics(500.0, 5.0, 1e-6), 100.0)
    skin = FingerpadDynamics(500.0, 5.0, 1e-6)
    at = bimorph.tip_motion(array.bender, skin, 100.0, np.array([found.bandwidth]))
    assert abs(at[0]) == pytest.approx(found.deflection / np.sqrt(2), rel=1e-9)


def test_forces_balance_actuators_and_skin(array: SkinStretchArray) -> None:
    voltages = np.random.default_rng(3).uniform(-150, 150, 60)
    pull = array.answer(voltages)
    free = array.bender.deflection_per_volt * voltages
    assert pull.forces / array.bender.stiffness == pytest.approx(
        free - pull.displacements - pull.slid, rel=1e-9, abs=1e-15
    )
    assert array.force_per_volt == pytest.approx(array.force_per_volt.T, rel=1e-9)
    # One alone and all others held by their springs: between the lone load line and being free.
    alone = np.zeros(60)
    alone[27] = 100.0
    skin = array.tissue.under_contactor(*array.cradle.size)
    lone = bimorph.loaded_tip(array.bender, skin, 100.0).deflection
    assert 0.9 * lone < array.answer(alone).displacements[27] < lone
    assert 0 < array.crosstalk < 0.5


def test_the_same_pull_on_all_slips_nowhere_and_a_fine_wave_does(array: SkinStretchArray) -> None:
    voltage = array.actuator.largest_voltage
    assert array.answer(np.full(60, voltage)).slipping == 0
    x, _ = array.cradle.places
    driven = voltage * np.sin(2 * np.pi * x / 4.8e-3)
    pull, alone = array.answer(driven), array.force_per_volt @ driven
    # Less than would if the others did not give way: 24 instead of 40.
    assert 15 < pull.slipping < np.count_nonzero(np.abs(alone) > pull.held)
    assert np.all(np.abs(pull.forces) <= pull.held * (1 + 1e-12))


def test_what_sticks_follows_and_what_slips_goes_its_own_way(array: SkinStretchArray) -> None:
    voltage = array.actuator.largest_voltage
    x = array.cradle.places[0]
    driven = voltage * np.sin(2 * np.pi * x / 4.8e-3)
    pull, slips = array.answer(driven), array.answer(driven).slips
    bender = array.bender
    tips = bender.deflection_per_volt * driven - pull.forces / bender.stiffness
    way = tips - pull.displacements
    np.testing.assert_allclose(way[~slips], 0, atol=1e-12)
    np.testing.assert_allclose(way, pull.slid, atol=1e-12)
    assert np.all(way[slips] * pull.forces[slips] >= 0)
    # Raised in fifty steps it is the same, and back at rest the skin is held by what slid.
    up = np.linspace(0, 1, 50)[1:]
    steps = array.answers(driven * np.concatenate([up, up[-2::-1], [0.0]])[:, None])
    np.testing.assert_allclose(steps[48].forces, pull.forces, atol=1e-9)
    assert np.max(np.abs(steps[-1].forces)) > 0.05 * np.max(np.abs(pull.forces))
    # A cycle loses energy to friction: it takes work at the tips, and gives none.
    cycle = np.sin(np.linspace(0, 4 * np.pi, 201))
    around = array.answers(driven * cycle[:, None])
    slid = np.diff([one.slid for one in around], axis=0)
    pulled = np.array([one.forces for one in around])[1:]
    assert np.min(slid * pulled) > -1e-15
    assert np.sum(slid * pulled) > 0


def test_strain_of_voltages_is_the_strain_of_their_forces(array: SkinStretchArray) -> None:
    # Little, so that all stick.
    voltages = np.random.default_rng(4).uniform(-20, 20, 60)
    assert array.answer(voltages).slipping == 0
    edges_x, edges_y, per_force = array.strain_per_force(0.6e-3)
    per_volt = per_force @ array.force_per_volt
    assert per_volt.shape == (3, edges_x.size - 1, edges_y.size - 1, 60)
    # The strain along a row of cells adds up to how far its ends came apart.
    forces, (px, py) = array.answer(voltages).forces, array.cradle.places
    row = edges_y.size // 2
    ends = 0.0
    for force, a, b in zip(forces, px, py, strict=True):
        for y in edges_y[row : row + 2]:
            u = array.tissue.shifts(edges_x[[0, -1]] - a, np.full(2, y - b), *array.cradle.size)[0]
            ends += 0.5 * force * (u[1] - u[0])
    total = float((per_volt[0, :, row] @ voltages).sum() * 0.6e-3)
    assert total == pytest.approx(ends, rel=1e-9, abs=1e-15)


def test_a_wave_moves_over_the_contactors_as_the_finger_does(array: SkinStretchArray) -> None:
    wave, times = SineWave(6e-3), np.array([0.0, 0.012, 0.024])
    found = cradle.pattern_voltages(wave, array.cradle, times, (0.1, 0.0), 100.0)
    assert found.shape == (3, 60)
    # In 12 ms at 100 mm/s the finger goes on by one pitch: each column feels what the next felt.
    assert found[1, :54] == pytest.approx(found[0, 6:], abs=1e-9)
    x, y = array.cradle.places
    assert found[0] == pytest.approx(100 * (2 * wave(x, y, 0.1, 0.0) - 1), abs=1e-9)
    # A grating of one pitch is a pull of all together, and another phase is another pull.
    blind = cradle.pattern_voltages(SineWave(1.2e-3), array.cradle, times[:1], (0.1, 0.0), 100.0)
    assert np.ptp(blind) < 1e-6
    assert cradle.finest_period(array.cradle) == pytest.approx(2.4e-3)
    with pytest.raises(InputError, match="pattern"):
        cradle.pattern_voltages(np.cos, array.cradle, times, (0.1, 0.0), 100.0)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="times is empty"):
        cradle.pattern_voltages(wave, array.cradle, np.zeros(0), (0.1, 0.0), 100.0)


def test_contactors_may_touch_and_fill_their_cradle() -> None:
    full = cradle.FingerCradle(
        columns=5, rows=3, pitch_along=2e-3, pitch_across=1e-3, contactor_length=2e-3,
        contactor_width=1e-3, length=10e-3, width=3e-3,
    )  # fmt: skip
    assert full.count == 15
    assert full.active_area == pytest.approx(30e-6)
    for wrong, message in (
        ({"columns": 6}, "6 columns of contactors at a pitch of 2 mm .* 10 mm holds, .* for 5;"),
        ({"rows": 4}, "4 rows of contactors at a pitch of 1 mm .* 3 mm holds, .* for 3;"),
        ({"contactor_length": 2.001e-3}, "overlap"),
        ({"contactor_width": 1.001e-3}, "overlap"),
        ({"length": 1.9e-3, "columns": 1}, "room for 0"),
        ({"radius_across": 0.95e-3}, "more than half around"),
        ({"radius_along": 3.1e-3}, "more than half around"),
    ):
        with pytest.raises(GeometryError, match=message):
            dataclasses.replace(full, **wrong)  # type: ignore[arg-type]
    curved = dataclasses.replace(full, radius_across=0.96e-3, radius_along=3.2e-3)
    x, y = curved.places
    np.testing.assert_allclose(x, np.repeat([-4e-3, -2e-3, 0, 2e-3, 4e-3], 3))
    np.testing.assert_allclose(y, np.tile([-1e-3, 0, 1e-3], 5))
    # Arcs of circles: the finger's falls away from it, the cradle's towards it.
    finger = cradle.Fingertip(radius_across=2e-3, radius_along=20e-3)
    fall = [
        radius * (1 - np.cos(place / radius))
        for place, radius in ((x, 20e-3), (x, 3.2e-3), (y, 2e-3), (y, 0.96e-3))
    ]
    gap = fall[0] - fall[1] + fall[2] - fall[3]
    np.testing.assert_allclose(cradle.gaps(curved, finger), gap - gap.min(), atol=1e-15)


def test_what_cannot_be_is_refused_in_words(array: SkinStretchArray) -> None:
    with pytest.raises(GeometryError, match=r"12 columns .* more than a cradle of 13 mm holds"):
        dataclasses.replace(array.cradle, columns=12)
    with pytest.raises(GeometryError, match="overlap"):
        dataclasses.replace(array.cradle, contactor_length=1.3e-3)
    with pytest.raises(GeometryError, match="half around"):
        dataclasses.replace(array.cradle, radius_across=3e-3)
    thick = dataclasses.replace(array.actuator, ceramic_thickness=0.6e-3)
    with pytest.raises(GeometryError, match="would touch"):
        dataclasses.replace(array, actuator=thick)
    with pytest.raises(GeometryError, match="at least 4 times as long"):
        dataclasses.replace(array.actuator, length=5e-3)
    with pytest.raises(OutOfRangeError, match=r"against its poling; at most 0.5 kV/mm"):
        array.answer(np.full(60, -180.0))
    with pytest.raises(InputError, match="give one for each"):
        array.answer(np.zeros(59))
    with pytest.raises(InputError, match="a row for each instant, with 60 voltages"):
        array.answers(np.zeros(60))
    with pytest.raises(UnreachableError, match="the least"):
        cradle.radii_that_touch_all(array.cradle, array.finger, array.pulp, 0.1)


def test_lines_and_power(array: SkinStretchArray) -> None:
    assert lines_needed(60, "direct") == 61
    assert lines_needed(60, "matrix") == 16
    assert lines_needed(60, "daisy_chain") == 5
    bender = array.bender
    one = loss_power(array.actuator, bender, 100.0, 250.0)
    assert one == pytest.approx(np.pi * 250 * bender.capacitance * 0.02 * 1e4)
    assert charging_power(bender, 60, 100.0, 250.0) == pytest.approx(
        60 * 250 * bender.capacitance * 4e4
    )
    actuator = array.actuator
    volume = 60 * actuator.length * actuator.width * actuator.thickness
    assert array.budget == Budget(60 * actuator.mass, volume, array.cradle.active_area)
    small = dataclasses.replace(array.budget, most_mass=10e-3, most_volume=1e-6)
    assert len(small.over) == 2
    assert "10 mm" not in dataclasses.replace(array.budget, area=1e-5).over[0]
