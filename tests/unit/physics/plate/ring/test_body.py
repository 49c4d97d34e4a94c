"""From a described disc or stator to its solved working mode, response and table of modes."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scipy import special
from scipy.optimize import brentq

from squeezefilm.core.errors import GeometryError, InputError, OutOfRangeError
from squeezefilm.design.plate.ring import analyze_ring, modes_in_band
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.elements.box_model import isotropic_solid, piezoceramic_solid
from squeezefilm.physics.plate.layout import AnnularStator, DiscPlate, RectangularPlate
from squeezefilm.physics.plate.ring.body import (
    half_wavelength_of,
    nodal_circles,
    ring_body,
    ring_circuit,
    ring_response,
    stator_assumptions,
)
from squeezefilm.physics.plate.ring.elements import harmonic_system, nearest_modes
from squeezefilm.physics.plate.ring.modes import (
    _mode,
    annular_admittance,
    annular_modes,
    clamped_capacitance,
)
from squeezefilm.physics.plate.ring.section import bonded_disc
from squeezefilm.physics.plate.solid.layers import media
from squeezefilm.physics.plate.working_mode import working_mode


def test_boxes_and_rings_have_one_definition_of_their_materials(disc: DiscPlate) -> None:
    plate = load_display("basdogan2020-glass").actuator
    assert isinstance(plate, RectangularPlate)
    found = {medium.name: medium for medium in media(plate)}
    solid, box = piezoceramic_solid(plate.ceramic), found["ceramic_top"]
    assert solid.stiffness == pytest.approx(box.stiffness, rel=1e-12, abs=1)
    assert solid.stress_matrix == pytest.approx(box.stress_matrix, rel=1e-12, abs=1e-12)
    assert box.permittivity is not None
    assert solid.permittivity == pytest.approx(box.permittivity, rel=1e-12)
    assert solid.loss == pytest.approx(box.loss)
    glass = isotropic_solid(plate.substrate)
    assert glass.stiffness == pytest.approx(found["substrate"].stiffness, rel=1e-12, abs=1)
    assert glass.loss == pytest.approx(found["substrate"].loss)
    assert isotropic_solid(disc.substrate).loss is None


def test_nodal_circle_of_a_thin_disc_is_kirchhoff_s(disc: DiscPlate) -> None:
    """B(1,0) of a free disc: w = J0(kr) + C I0(kr) with no moment and no shear at the rim."""
    nu = disc.substrate.poisson_ratio

    def parts(k: float) -> tuple[float, float, float]:
        shear = special.j1(k) / special.i1(k)  # J0''' side: C from V(1) = 0
        c = -shear
        moment = -special.j0(k) + (1 - nu) * special.j1(k) / k
        moment += c * (special.i0(k) - (1 - nu) * special.i1(k) / k)
        return moment, c, k

    k = brentq(lambda k: parts(k)[0], 2.5, 3.5)
    c = parts(k)[1]
    node = brentq(lambda r: special.j0(k * r) + c * special.i0(k * r), 0.4, 0.9)
    thin = dataclasses.replace(disc, ceramic_thickness=2e-6, thickness=0.1e-3, glue=None)
    mode = ring_body(thin).mode()
    assert nodal_circles(mode) / 12.5e-3 == pytest.approx([node], rel=2e-3)
    half, along = half_wavelength_of(mode)
    assert along == "diameter"
    assert half == pytest.approx(2 * node * 12.5e-3, rel=2e-3)


def test_glue_softens_a_disc_and_its_own_losses_count(disc: DiscPlate) -> None:
    assert disc.glue is not None
    soft = dataclasses.replace(disc.glue, young_modulus=0.05e9)
    glued = working_mode(dataclasses.replace(disc, glue=soft))
    bonded = working_mode(dataclasses.replace(disc, glue=None))
    # Stiff glue only moves the ceramic away from the glass; soft glue lets it slip.
    assert glued.resonance_frequency < 0.95 * bonded.resonance_frequency
    assert glued.quality_factor == pytest.approx(disc.quality_factor)
    glass = dataclasses.replace(disc.substrate, quality_factor=1000.0)
    own = working_mode(dataclasses.replace(disc, substrate=glass, glue=None))
    # Between the ceramic's 75 and the glass's 1000.
    assert 75 < own.quality_factor < 1000


def test_response_circuit_and_mode_agree(disc: DiscPlate) -> None:
    body = ring_body(disc)
    mode = body.mode()
    f = mode.frequency * (1 + np.linspace(-0.05, 0.08, 400))
    response = ring_response(body, mode, f, [0])
    assert response.maximum[response.resonance] == pytest.approx(
        mode.amplitude_per_volt(body.drive), rel=0.01
    )
    circuit = ring_circuit(body, mode, response)
    gap = np.abs(circuit.admittance(f) - response.admittance)
    assert gap.max() < 0.01 * np.abs(response.admittance).max()
    # What is static around B(1,0) is the held ceramic and the modes above it.
    assert circuit.static_capacitance > clamped_capacitance(body.section, body.drive)
    # Power in at resonance is what the mode loses.
    omega = 2 * math.pi * f[response.resonance]
    lost = omega**3 * mode.modal_mass / mode.quality_factor
    lost *= response.maximum[response.resonance] ** 2 / 2
    assert response.admittance.real[response.resonance] / 2 == pytest.approx(lost, rel=0.03)


@pytest.mark.slow
def test_the_table_of_modes_misses_none(disc: DiscPlate) -> None:
    wide = dataclasses.replace(disc, nodal_circles=0, nodal_diameters=3, sectors=6)
    body = ring_body(wide)
    band = (20e3, 90e3)
    found = [mode.frequency for mode in modes_in_band(body, band)]
    every = [
        mode.frequency
        for m in range(14)
        for mode in annular_modes(body.section, m, count=12, quality_factor=50)
        if band[0] <= mode.frequency <= band[1]
    ]
    assert found == pytest.approx(sorted(every), rel=1e-6)


def test_sectors_drive_their_own_harmonic(disc: DiscPlate) -> None:
    part = dataclasses.replace(disc, nodal_circles=0, nodal_diameters=2, sectors=2)
    whole = dataclasses.replace(part, sectors=4)
    one, two = working_mode(part), working_mode(whole)
    assert one.label == two.label == "B(0,2)"
    assert half_wavelength_of(ring_body(part).mode())[1] == "circumference"
    assert one.half_wavelength == pytest.approx(math.pi * disc.diameter / 4)
    # Half the sectors, half the force.
    assert two.amplitude_per_volt == pytest.approx(2 * one.amplitude_per_volt, rel=1e-9)


def test_a_stator_is_fitted_with_what_is_described() -> None:
    actuator = load_display("biet2008-stator").actuator
    assert isinstance(actuator, AnnularStator)
    assumed = stator_assumptions(actuator)
    assert assumed.outer_diameter == pytest.approx(63.57e-3)
    assert assumed.tooth_fill == pytest.approx(1 - 0.6 / 2.34)
    assert assumed.quality_factor == 200
    plain = dataclasses.replace(actuator, tooth_pitch=None, slot_width=None)
    assert stator_assumptions(plain).tooth_height == 0


def test_impossible_discs_are_refused(disc: DiscPlate) -> None:
    for changes, kind, says in (
        ({"ceramic_outer_diameter": 26e-3}, GeometryError, "overhangs the disc"),
        ({"inner_diameter": 5e-3}, GeometryError, "overhangs the hole"),
        ({"inner_diameter": 25e-3}, InputError, "inner_diameter"),
        ({"sectors": 3}, InputError, "without nodal diameters"),
        ({"nodal_diameters": 3}, InputError, "from 1 to 6 sectors"),
        ({"nodal_diameters": 3, "sectors": 7}, InputError, "from 1 to 6 sectors"),
        ({"nodal_circles": 0}, InputError, "rigid"),
        ({"ceramic_thickness": 0.0}, InputError, "ceramic_thickness"),
    ):
        with pytest.raises(kind, match=says):
            dataclasses.replace(disc, **changes)  # type: ignore[arg-type]
    with pytest.raises(OutOfRangeError, match="aspect ratio"):
        working_mode(dataclasses.replace(disc, glue=None, ceramic_thickness=1e-7))
    thin = dataclasses.replace(disc, thickness=10e-6, ceramic_thickness=5e-6, glue=None)
    with pytest.raises(OutOfRangeError, match="aspect ratio"):
        working_mode(thin)
    with pytest.raises(InputError, match="no disc and no stator"):
        analyze_ring(load_display("biet2008-plate"))


@pytest.mark.parametrize(
    ("display", "said"),
    [
        ("winfield2007-tpad", r"up to 7 MHz.*across PZT-5A.* kHz at most"),
        pytest.param(
            "biet2008-stator", r"up to 7 MHz.*across phosphor bronze.* kHz at most",
            marks=pytest.mark.slow,
        ),
    ],
)  # fmt: skip
def test_a_band_of_waves_across_a_layer_is_refused(
    display: str, said: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    body = ring_body(load_display(display).actuator)
    monkeypatch.setattr(
        "squeezefilm.physics.plate.ring.modes.harmonic_system", None
    )  # Nothing is meshed.
    with pytest.raises(OutOfRangeError, match=said):
        modes_in_band(body, (6.9e6, 7e6))
    with pytest.raises(OutOfRangeError, match=r"near = 7 MHz.* kHz at most"):
        annular_modes(body.section, 0, near=7e6)
    with pytest.raises(OutOfRangeError, match=r"an admittance at 7 MHz.* kHz at most"):
        annular_admittance(body.section, body.drive, np.array([30e3, 7e6]), harmonics=(0,))


@pytest.mark.parametrize("number", [2, 3])
def test_a_mode_does_not_depend_on_the_size_of_its_vector(disc: DiscPlate, number: int) -> None:
    """All but its mass, which is that of a vector of unit modal mass."""
    section = bonded_disc(disc)
    system = harmonic_system(section, 0, 2)
    squares, vectors = nearest_modes(system, 20e3, 4)
    made = [
        _mode(section, system, float(squares[number]), scale * vectors[:, number], 50.0)
        for scale in (1.0, -3.0)
    ]
    one, other = made
    assert other.modal_mass == pytest.approx(one.modal_mass / 9)
    assert other.modal_force_all_round == pytest.approx(one.modal_force_all_round)
    for name in ("displacement", "surface_shape"):
        assert getattr(other, name) == pytest.approx(getattr(one, name), abs=1e-9)
    assert np.abs(one.surface_shape).max() == pytest.approx(1.0)
    # What a volt does to it as it moves: its mean force through its own motion.
    moved = one.displacement[system.z == system.z.max(), 2]
    assert moved == pytest.approx(one.surface_shape)
    assert np.all(np.diff(one.surface_radius) > 0)
