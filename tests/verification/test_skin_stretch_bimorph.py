"""The bending actuator as a solid beside closed forms of its two limits: the narrow beam that is
published, and the wide thin strip of plate."""

import dataclasses

import numpy as np
import pytest

from squeezefilm.actuators.skin_stretch.bimorph import Bimorph, _boxes, solid_bender
from squeezefilm.core.materials import ElasticMaterial, Piezoceramic, PiezoConstants

CONSTANTS = PiezoConstants(
    16.5e-12, -4.78e-12, -8.45e-12, 20.7e-12, 43.5e-12, 42.6e-12,
    -274e-12, 593e-12, 741e-12, 1704.0, 1434.0,
)  # fmt: skip
PZT_5H = Piezoceramic(
    "PZT-5H", 66.16e9, 0.2897, 22.99e9, 7500.0, -274e-12, 1434.0, 65.0, constants=CONSTANTS
)
FREE_PERMITTIVITY = float(CONSTANTS.free_permittivity_matrix[2, 2])
BRASS = ElasticMaterial("brass", 112e9, 0.31, 8530.0)
USUAL = Bimorph(21e-3, 1.6e-3, PZT_5H, 0.35e-3, BRASS, 0.1e-3)
BARE = Bimorph(20e-3, 1e-3, PZT_5H, 0.5e-3, BRASS)
WIDE = Bimorph(120e-3, 4e-3, PZT_5H, 0.15e-3, BRASS, 0.1e-3)


def narrow(beam: Bimorph, field: bool = True) -> tuple[float, float]:
    """Deflection per volt and stiffness of a narrow beam, whose layers are each free across.

    Wang and Cross 1999, 10.1109/58.808857: G = (2/3)[(t_m/2 + t_p)³ − (t_m/2)³]/s11 + E_m t_m³/12
    and M = (d31/s11)(t_m + t_p) per width; δ = M L²/2G, k = 3 G w/L³.
    """
    s11, d31 = CONSTANTS.compliance_11, -CONSTANTS.charge_coefficient_31
    own, shim, length = beam.ceramic_thickness, beam.shim_thickness, beam.length
    bending = 2 * ((shim / 2 + own) ** 3 - (shim / 2) ** 3) / (3 * s11)
    bending += beam.shim.young_modulus * shim**3 / 12
    if field:
        # ∂D3/∂z = 0: the field follows the strain and stiffens each ceramic about its own middle.
        coupling = d31**2 / (s11 * FREE_PERMITTIVITY)
        bending += own**3 / (6 * s11) * coupling / (1 - coupling)
    moment = d31 / s11 * (shim + own) * beam.ceramic_share
    return moment * length**2 / (2 * bending), 3 * bending * beam.width / length**3


def wide(beam: Bimorph) -> tuple[float, float]:
    """Deflection per volt and stiffness of a strip of thin plate with free sides.

    Classical lamination theory with D3 the same at every height of a ceramic: curvature
    M/(D11 + D12) by voltage, (D11² − D12²)/D11 against a force. Next to the clamp the width stays
    straight, for 0.41 widths in the mean: the curvature by voltage is there (1 + D12/D11) times as
    large, the stiffness (1 − D12²/D11²)⁻¹ times.
    """
    s11, s12 = CONSTANTS.compliance_11, CONSTANTS.compliance_12
    d31, own, shim = -CONSTANTS.charge_coefficient_31, beam.ceramic_thickness, beam.shim_thickness
    e31 = d31 / (s11 + s12)
    brass, ratio = beam.shim.plane_strain_modulus, beam.shim.poisson_ratio
    ceramics = 2 * ((shim / 2 + own) ** 3 - (shim / 2) ** 3) / 3
    added = e31**2 / (FREE_PERMITTIVITY - 2 * d31 * e31) * own**3 / 6
    along = ceramics * s11 / (s11**2 - s12**2) + brass * shim**3 / 12 + added
    across = ceramics * -s12 / (s11**2 - s12**2) + ratio * brass * shim**3 / 12 + added
    held = 0.41 * beam.width / beam.length * across / along
    free = e31 * (shim + own) * beam.ceramic_share / (along + across)
    bending = (along**2 - across**2) / along
    return (
        free * beam.length**2 / 2 * (1 + 2 * held),
        3 * bending * beam.width / beam.length**3 * (1 + 3 * held * across / along),
    )


@pytest.mark.slow
def test_a_wide_thin_strip_is_the_closed_form_within_one_per_cent() -> None:
    solid = solid_bender(WIDE)
    deflection, stiffness = wide(WIDE)
    assert solid.deflection_per_volt == pytest.approx(deflection, rel=0.01)
    assert solid.stiffness == pytest.approx(stiffness, rel=0.01)
    assert solid.force_per_volt == pytest.approx(deflection * stiffness, rel=0.015)
    # The resonance of a beam of that stiffness, clamped at one end.
    bending = stiffness * WIDE.length**3 / 3
    per_length = WIDE.mass / WIDE.length
    frequency = 1.8751**2 / (2 * np.pi * WIDE.length**2) * np.sqrt(bending / per_length)
    assert solid.resonance_frequency == pytest.approx(frequency, rel=0.01)


@pytest.mark.slow
def test_a_very_narrow_beam_is_the_closed_form_within_one_per_cent() -> None:
    beam = dataclasses.replace(BARE, width=0.05e-3, length=40e-3)
    solid = solid_bender(beam)
    deflection, stiffness = narrow(beam)
    assert deflection == pytest.approx(solid.deflection_per_volt, rel=0.01)
    assert stiffness == pytest.approx(solid.stiffness, rel=0.01)
    # Without the field that follows the strain, as published, it is too soft by 4 %.
    assert narrow(beam, field=False)[1] / solid.stiffness < 0.97


@pytest.mark.parametrize("beam", [USUAL, BARE], ids=["shim", "bare"])
def test_usual_sections_are_strips_rather_than_narrow_beams(beam: Bimorph) -> None:
    solid = solid_bender(beam)
    far, near = (abs(theory(beam)[0] / solid.deflection_per_volt - 1) for theory in (narrow, wide))
    assert near < 0.03 < 0.05 < far
    assert wide(beam)[1] == pytest.approx(solid.stiffness, rel=0.01)


@pytest.mark.slow
def test_the_solid_has_converged() -> None:
    once, again = solid_bender(USUAL), solid_bender(USUAL, 2)
    for name in ("deflection_per_volt", "stiffness", "resonance_frequency", "capacitance"):
        assert getattr(once, name) == pytest.approx(getattr(again, name), rel=1e-3)


def test_series_is_half_the_deflection_and_a_quarter_of_the_charge() -> None:
    parallel, series = (
        solid_bender(dataclasses.replace(USUAL, wiring=w)) for w in ("parallel", "series")
    )
    assert series.deflection_per_volt == pytest.approx(parallel.deflection_per_volt / 2, rel=1e-9)
    assert series.capacitance == pytest.approx(parallel.capacitance / 4, rel=1e-9)
    assert series.stiffness == pytest.approx(parallel.stiffness, rel=1e-9)


def test_cells_end_where_the_beam_has_its_layers_and_clamp() -> None:
    """Wide beams have a layer as thick as they are at the free side, narrow ones none; ceramics
    much thicker than the beam is wide are cut a width from their middle."""
    slim = dataclasses.replace(USUAL, width=2.4 * USUAL.thickness)
    stout = dataclasses.replace(USUAL, width=0.4 * USUAL.ceramic_thickness)
    for beam, layered, pieces in (
        (USUAL, False, 1),
        (slim, False, 1),
        (WIDE, True, 1),
        (stout, False, 2),
    ):
        box = _boxes(beam, 0)
        half, own, shim = beam.width / 2, beam.ceramic_thickness, beam.shim_thickness
        assert box.y.edges == pytest.approx(
            (0.0, half - beam.thickness, half) if layered else (0.0, half)
        )
        assert box.z.edges[-1] == pytest.approx(beam.thickness)
        for edge in (own, own + shim):
            assert np.min(np.abs(np.array(box.z.edges) - edge)) < 1e-12
        assert len(box.z.edges) == 2 * pieces + 2
        cut = {own - beam.width, own + shim + beam.width} if pieces == 2 else set()
        for edge in cut:
            assert np.min(np.abs(np.array(box.z.edges) - edge)) < 1e-12
        assert (box.x.edges[0], box.x.edges[-2], box.x.edges[-1]) == (
            0.0,
            0.5 * beam.length,
            beam.length,
        )
        assert max(box.x.edges[1:-2]) < 0.3 * beam.length
        # Ceramic, shim, ceramic: only the shim is of no ceramic.
        np.testing.assert_array_equal(box.medium[0, 0], [0] * pieces + [1] + [0] * pieces)
        np.testing.assert_array_equal(box.ceramic[0, 0], [0] * pieces + [-1] + [1] * pieces)
        more = _boxes(beam, 2)
        for mesh, finer in ((box.x, more.x), (box.y, more.y), (box.z, more.z)):
            assert [order + 2 for order in mesh.orders] == list(finer.orders)
    bare = _boxes(dataclasses.replace(USUAL, shim_thickness=0.0), 0)
    np.testing.assert_array_equal(bare.ceramic[0, 0], [0, 1])
