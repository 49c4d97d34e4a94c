"""Geometry and material data: what is refused, and the conversions between constants."""

import dataclasses

import numpy as np
import pytest

from squeezefilm.core.errors import (
    ContradictionError,
    ContradictionWarning,
    GeometryError,
    InputError,
    OutOfRangeError,
)
from squeezefilm.physics.display import load_display
from squeezefilm.physics.plate.beam_response import beam_response, patch_capacitance
from squeezefilm.physics.plate.layout import AnnularStator, CeramicPatch, RectangularPlate


@pytest.fixture
def plate() -> RectangularPlate:
    actuator = load_display("biet2008-plate").actuator
    assert isinstance(actuator, RectangularPlate)
    return actuator


def test_the_two_data_sets_are_named_when_they_contradict(plate: RectangularPlate) -> None:
    ceramic = plate.ceramic
    with pytest.warns(ContradictionWarning, match=r"from_d31.*printed_e31"):
        ceramic.check_consistency()
    with pytest.raises(ContradictionError, match="data_set"):
        ceramic.check_consistency(strict=True)
    agreeing = dataclasses.replace(ceramic, stress_coefficient=ceramic.stress_coefficient_from_d31)
    agreeing.check_consistency(strict=True)


def test_in_plane_stiffness_and_compliances_are_consistent(plate: RectangularPlate) -> None:
    # c11_p = s11 / (s11² − s12²): the paper's own relation between them.
    ceramic = plate.ceramic
    s11 = ceramic.compliance_11
    s12 = -ceramic.in_plane_poisson_ratio * s11
    assert s11 / (s11**2 - s12**2) == pytest.approx(ceramic.in_plane_stiffness, rel=1e-12)
    assert ceramic.charge_coefficient / (s11 + s12) == pytest.approx(
        ceramic.stress_coefficient_from_d31, rel=1e-12
    )


def test_printed_data_set_scales_the_amplitude_by_the_ratio_of_couplings(
    plate: RectangularPlate,
) -> None:
    printed = dataclasses.replace(
        plate, ceramic=dataclasses.replace(plate.ceramic, data_set="printed_e31")
    )
    ratio = plate.ceramic.stress_coefficient_from_d31 / -4.9
    assert (
        beam_response(plate).amplitude_per_volt / beam_response(printed).amplitude_per_volt
    ) == pytest.approx(ratio, rel=1e-12)


def test_printed_data_set_needs_its_number(plate: RectangularPlate) -> None:
    with pytest.raises(ContradictionError, match="stress_coefficient"):
        dataclasses.replace(plate.ceramic, stress_coefficient=None, data_set="printed_e31")


def test_ceramics_may_touch_but_not_overlap_or_overhang(plate: RectangularPlate) -> None:
    a = CeramicPatch(0, 0, 0.011, 0.049, 0.001)
    touching = dataclasses.replace(a, x=0.011)
    assert dataclasses.replace(plate, patches=(a, touching)).coverage == pytest.approx(22 / 83)
    for bad, says in (
        (dataclasses.replace(a, x=0.0109), "overlap"),
        (dataclasses.replace(a, x=0.075), "overhangs"),
        (dataclasses.replace(a, x=0.03, y=0.01), "overhangs"),
    ):
        with pytest.raises(GeometryError, match=says):
            dataclasses.replace(plate, patches=(a, bad))
    with pytest.raises(GeometryError, match="empty"):
        dataclasses.replace(plate, patches=())


def test_ceramics_over_each_other_cover_a_place_once(plate: RectangularPlate) -> None:
    """Coverage against the share of random places that have ceramic above or below them."""
    below = [CeramicPatch(0, 0, 0.03, 0.049, 0.001), CeramicPatch(0.04, 0.01, 0.02, 0.03, 0.001)]
    above = [
        CeramicPatch(0.02, 0.005, 0.05, 0.02, 0.0005, face="top"),
        CeramicPatch(0.02, 0.03, 0.01, 0.01, 0.0005, face="top"),
    ]
    both = dataclasses.replace(plate, patches=(*below, *above))
    places = np.random.default_rng(1).random((20000, 2)) * both.extent
    there = np.array([both.ceramics_at(x, y) for x, y in places.tolist()]) > 0
    assert both.coverage == pytest.approx(there.any(axis=1).mean(), abs=0.015)
    assert both.coverage_of("top") == pytest.approx(there[:, 0].mean(), abs=0.015)
    assert both.coverage_of("bottom") == pytest.approx(there[:, 1].mean(), abs=0.015)
    one_face = dataclasses.replace(plate, patches=tuple(below))
    assert one_face.coverage == one_face.coverage_of("bottom")


@pytest.mark.parametrize("field", ["length", "width", "thickness", "quality_factor"])
@pytest.mark.parametrize("value", [0.0, -1.0, float("nan"), float("inf")])
def test_impossible_plates_are_refused(plate: RectangularPlate, field: str, value: float) -> None:
    with pytest.raises(InputError, match=field):
        dataclasses.replace(plate, **{field: value})


def test_a_stator_needs_a_whole_number_of_wavelengths() -> None:
    good = load_display("biet2008-stator").actuator
    assert isinstance(good, AnnularStator)
    with pytest.raises(GeometryError, match="whole number"):
        dataclasses.replace(good, wavelength=0.0193)
    with pytest.raises(InputError, match="which is mean_diameter"):
        dataclasses.replace(good, radial_width=0.06)


def test_capacitance_is_within_what_the_paper_s_ceramics_can_have(plate: RectangularPlate) -> None:
    # ε33S of 1300–2500 ε0 over 7 × 11 × 49 mm at 1 mm: 43–84 nF; parallel plates, closed form.
    area = 7 * 11e-3 * 49e-3
    for permittivity in (1300.0, 2500.0):
        one = dataclasses.replace(
            plate, ceramic=dataclasses.replace(plate.ceramic, relative_permittivity=permittivity)
        )
        assert patch_capacitance(one) == pytest.approx(
            permittivity * 8.8541878128e-12 * area / 1e-3, rel=1e-12
        )


def test_modes_beyond_the_cut_off_are_refused(plate: RectangularPlate) -> None:
    with pytest.raises(OutOfRangeError, match="cut-off"):
        beam_response(dataclasses.replace(plate, nodal_lines=90))
