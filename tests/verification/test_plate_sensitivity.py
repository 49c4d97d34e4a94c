"""Sensitivities of the working mode against the specification's list and against theory, and modes
followed over a parameter."""

import dataclasses
from collections.abc import Callable

import pytest

from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.core.materials import ElasticMaterial
from squeezefilm.design.analysis.sensitivities import CoarseShifts
from squeezefilm.design.plate.solved import (
    with_ceramic_stiffness,
    with_glue,
    with_loss_in_ceramic_alone,
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


def _with(**values: float) -> Callable[[RectangularPlate], RectangularPlate]:
    paths = {name.replace("__", ".").replace("each", "*"): v for name, v in values.items()}
    return lambda plate: with_values(plate, paths)


def _glued(thickness: float, modulus: float) -> Callable[[RectangularPlate], RectangularPlate]:
    return lambda plate: with_glue(plate, thickness, modulus)


# The specification's list, in per cent. Of the glue it states neither Poisson's ratio nor density.
_PER_CENT = [
    (_with(substrate__young_modulus=115e9), -2.0, 0.2),
    (_with(substrate__young_modulus=131e9), 1.9, 0.2),
    (lambda plate: with_ceramic_stiffness(plate, 0.9), -2.0, 0.2),
    (lambda plate: with_ceramic_stiffness(plate, 1.1), 2.0, 0.2),
    (_with(thickness=1.95e-3), -1.6, 0.2),
    (_with(thickness=2.05e-3), 1.6, 0.2),
    (_with(patches__each__thickness=0.95e-3), -0.86, 0.2),
    (_with(patches__each__thickness=1.05e-3), 0.86, 0.2),
    (_with(substrate__density=8360.0), -0.45, 0.1),
    (_with(substrate__poisson_ratio=0.27), -0.3, 0.1),
    (_with(substrate__poisson_ratio=0.33), 0.3, 0.1),
    (_glued(20e-6, 3e9), -1.7, 0.2),
    (_glued(50e-6, 3e9), -3.4, 0.2),
    (_glued(20e-6, 1e9), -4.9, 0.3),
    (_glued(50e-6, 1e9), -9.1, 0.3),
    # Losses are left out of the frequency.
    (with_loss_in_ceramic_alone, 0.0, 1e-7),
]


@pytest.mark.slow
def test_frequencies_shift_as_the_specification_lists() -> None:
    plate = _paper()
    reference = working_point(plate, amplitude=False).frequency
    for number, (make, listed, tolerance) in enumerate(_PER_CENT):
        shift = working_point(make(plate), amplitude=False).frequency / reference - 1
        assert 100 * shift == pytest.approx(listed, abs=tolerance), number


@pytest.mark.slow
def test_open_ceramics_stiffen_like_open_terminals() -> None:
    """Ceramics that are each open are held by at least as many conditions as those whose common
    terminals are open, so the mode lies at least as high. (The specification lists +4.1 %.)"""
    plate = _paper()
    reference = working_point(plate, amplitude=False)
    opened = tuple(dataclasses.replace(patch, electrode="open") for patch in plate.patches)
    there = working_point(dataclasses.replace(plate, patches=opened))
    terminals = reference.open_frequency / reference.frequency - 1
    assert terminals < there.frequency / reference.frequency - 1 < terminals + 1e-3
    assert there.largest_per_volt is None


@pytest.mark.slow
def test_amplitude_per_volt_follows_theory() -> None:
    """At resonance a mode moves by Q F/k: in proportion to Q, whatever its mass; and the quality
    factor is the ceramic's over its share of the elastic energy where it alone loses."""
    plate = _paper()
    reference = working_point(plate).largest_per_volt
    assert reference is not None

    def shift(changed: RectangularPlate) -> float:
        there = working_point(changed).largest_per_volt
        assert there is not None
        return there / reference - 1

    for density in (8140.0, 8360.0):
        assert shift(_with(substrate__density=density)(plate)) == pytest.approx(0.0, abs=2e-3)
    assert shift(_with(quality_factor=48.0)(plate)) == pytest.approx(-0.2, abs=5e-3)
    assert shift(_with(quality_factor=72.0)(plate)) == pytest.approx(0.2, abs=5e-3)
    modes = solve_modes(plate)
    ceramic = modes.energy_shares[0, modes.materials.index("ceramic_bottom")]
    loss = shift(with_loss_in_ceramic_alone(plate))
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
