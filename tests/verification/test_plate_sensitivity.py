"""Sensitivities of the working mode against the specification's list and against theory, and modes
followed over a parameter."""

import dataclasses

import pytest

from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.core.materials import ElasticMaterial
from squeezefilm.design.analysis.coarse_shift import CoarseShifts
from squeezefilm.design.plate.sensitivity import (
    SensitivityTable,
    plate_sensitivity,
    usual_changes,
    with_ceramic_stiffness,
    with_glue,
    working_point,
)
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.layout import CeramicPatch, RectangularPlate
from squeezefilm.physics.plate.solid.solve import solve_modes
from squeezefilm.physics.plate.working_mode import working_mode
from squeezefilm.physics.uncertainty.parameters import with_values


def _paper() -> RectangularPlate:
    plate = load_display("biet2008-plate").actuator
    assert isinstance(plate, RectangularPlate)
    return plate


def _small() -> RectangularPlate:
    return RectangularPlate(
        40e-3, 20e-3, 1.5e-3, 3, 60.0, ElasticMaterial("steel", 200e9, 0.3, 7800.0),
        _paper().ceramic, (CeramicPatch(12e-3, 0.0, 16e-3, 20e-3, 0.5e-3),),
    )  # fmt: skip


# The specification's list, in per cent. Of the glue it states neither Poisson's ratio nor density.
_PER_CENT = {
    ("plate Young's modulus", "115 GPa"): (-2.0, 0.2),
    ("plate Young's modulus", "131 GPa"): (1.9, 0.2),
    ("ceramic stiffness c11_p", "−10 %"): (-2.0, 0.2),
    ("ceramic stiffness c11_p", "+10 %"): (2.0, 0.2),
    ("plate thickness", "1.95 mm"): (-1.6, 0.2),
    ("plate thickness", "2.05 mm"): (1.6, 0.2),
    ("ceramic thickness", "950 µm"): (-0.86, 0.2),
    ("ceramic thickness", "1.05 mm"): (0.86, 0.2),
    ("plate density", "8360 kg/m³"): (-0.45, 0.1),
    ("plate Poisson's ratio", "0.27"): (-0.3, 0.1),
    ("plate Poisson's ratio", "0.33"): (0.3, 0.1),
    ("glue of 3 GPa", "20 µm"): (-1.7, 0.2),
    ("glue of 3 GPa", "50 µm"): (-3.4, 0.2),
    ("glue of 1 GPa", "20 µm"): (-4.9, 0.3),
    ("glue of 1 GPa", "50 µm"): (-9.1, 0.3),
}


@pytest.fixture(scope="module")
def frequencies() -> SensitivityTable:
    return plate_sensitivity(_paper(), amplitude=False)


@pytest.mark.slow
def test_frequencies_shift_as_the_specification_lists(frequencies: SensitivityTable) -> None:
    found = {(row.name, row.change): 100 * row.frequency_shift for row in frequencies.rows}
    for key, (listed, tolerance) in _PER_CENT.items():
        assert found[key] == pytest.approx(listed, abs=tolerance), key
    # Losses are left out of the frequency.
    assert found["losses", "in the ceramic alone"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.slow
def test_open_ceramics_stiffen_like_open_terminals(frequencies: SensitivityTable) -> None:
    """Ceramics that are each open are held by at least as many conditions as those whose common
    terminals are open, so the mode lies at least as high. (The specification lists +4.1 %.)"""
    row = next(row for row in frequencies.rows if row.name == "ceramics open")
    terminals = frequencies.reference.open_frequency / frequencies.reference.frequency - 1
    assert row.frequency_shift is not None
    assert terminals < row.frequency_shift < terminals + 1e-3
    assert row.largest_per_volt is None


@pytest.mark.slow
def test_amplitude_per_volt_follows_theory() -> None:
    """At resonance a mode moves by Q F/k: in proportion to Q, whatever its mass; and the quality
    factor is the ceramic's over its share of the elastic energy where it alone loses."""
    plate = _paper()
    wanted = {"plate density", "quality factor, all materials", "losses"}
    changes = [change for change in usual_changes(plate) if change.name in wanted]
    table = plate_sensitivity(plate, changes)
    shifts = {(row.name, row.change): row.amplitude_shift for row in table.rows}
    for change in ("8140 kg/m³", "8360 kg/m³"):
        assert shifts["plate density", change] == pytest.approx(0.0, abs=2e-3)
    assert shifts["quality factor, all materials", "60 → 48"] == pytest.approx(-0.2, abs=5e-3)
    assert shifts["quality factor, all materials", "60 → 72"] == pytest.approx(0.2, abs=5e-3)
    modes = solve_modes(plate)
    ceramic = modes.energy_shares[0, modes.materials.index("ceramic_bottom")]
    loss = shifts["losses", "in the ceramic alone"]
    # A neighbour 1 kHz away adds a percent to the largest point of the whole face.
    assert loss == pytest.approx(1 / ceramic - 1, rel=0.02)
    # The specification's estimate.
    assert loss == pytest.approx(1.5, abs=0.1)


def test_scaling_every_stiffness_scales_the_frequency() -> None:
    """Without piezoelectricity f goes with the root of the stiffness; with it, nearly."""
    plate = _small()
    weak = dataclasses.replace(plate.ceramic, charge_coefficient=-1e-15, stress_coefficient=None)
    plate = dataclasses.replace(plate, ceramic=weak)
    softer = with_ceramic_stiffness(
        with_values(plate, {"substrate.young_modulus": 0.81 * 200e9}), 0.81
    )
    before, after = (working_point(p, amplitude=False).frequency for p in (plate, softer))
    assert after / before == pytest.approx(0.9, rel=1e-6)


def test_a_ceramic_with_all_constants_gets_softer_too() -> None:
    plate = _small()
    full = plate.ceramic.full_constants
    given = dataclasses.replace(plate, ceramic=dataclasses.replace(plate.ceramic, constants=full))
    changed = with_ceramic_stiffness(given, 0.9)
    assert changed.ceramic.full_constants.stiffness_matrix == pytest.approx(
        0.9 * full.stiffness_matrix
    )
    names = {change.name for change in usual_changes(given)}
    assert "ceramic data set" not in names


@pytest.mark.parametrize(
    "name",
    [
        pytest.param("biet2008-plate", marks=pytest.mark.slow),
        pytest.param("touchpad-glass", marks=pytest.mark.nightly),
    ],
)
def test_another_glue_on_the_coarse_mesh_is_another_glue_solved(name: str) -> None:
    """What is solved on two meshes shifts alike, within what `CoarseShifts.to` states."""
    plate = load_display(name).actuator
    assert isinstance(plate, RectangularPlate)
    if plate.glue is None:
        plate = with_glue(plate, 20e-6, 3e9)
    assert plate.glue is not None
    mode = working_mode(plate)
    shifts = CoarseShifts(plate, mode)
    for path in ("glue.thickness", "glue.young_modulus"):
        nominal = getattr(plate.glue, path.partition(".")[2])
        for share in (0.55, 1.45):
            changed = with_values(plate, {path: share * nominal})
            there = working_mode(changed)
            found = shifts.to(changed)
            f = there.resonance_frequency / mode.resonance_frequency - 1
            a = there.amplitude_per_volt / mode.amplitude_per_volt - 1
            assert found.frequency == pytest.approx(f, rel=0.08), (path, share)
            assert found.amplitude == pytest.approx(a, rel=0.03), (path, share)


@pytest.mark.slow
def test_the_same_glue_shifts_nothing_and_one_out_of_reach_is_refused() -> None:
    aside = CeramicPatch(4e-3, 0.0, 16e-3, 20e-3, 0.5e-3)
    plate = with_glue(dataclasses.replace(_small(), patches=(aside,)), 20e-6, 3e9)
    mode = working_mode(plate)
    shifts = CoarseShifts(plate, mode)
    assert shifts.to(plate) == (0.0, 0.0)
    # Without a bond to speak of the ceramic does not stiffen the plate.
    with pytest.raises(OutOfRangeError, match="sensitivities solved"):
        shifts.to(with_glue(plate, 200e-6, 3e7))
    # The ceramic in the middle does not drive a mode that the middle's mirror turns over.
    still = with_glue(_small(), 20e-6, 3e9)
    with pytest.raises(OutOfRangeError, match="does not move this mode"):
        CoarseShifts(still, working_mode(still)).to(still)
