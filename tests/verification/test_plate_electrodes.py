"""Electrodes of the paper's plate and of small ones: open, tied, bare, shunted; ceramics of several
thicknesses; foam of several losses. Against scikit-fem where it can be asked, and limits."""

import dataclasses

import numpy as np
import pytest
from tests.lost_power import lost_power

from squeezefilm.core.errors import OutOfRangeError
from squeezefilm.physics.plate.layout import CeramicPatch, FoamSupport, RectangularPlate
from squeezefilm.physics.plate.solid.layers import Resolution
from squeezefilm.physics.plate.solid.mesh import plate_model
from squeezefilm.physics.plate.solid.response import harmonic_response
from squeezefilm.physics.plate.solid.solve import solve_modes

from .test_plate_solid import monomorph, small
from .test_solid_elements import FROM_D31, frequencies, monomorph_on_a_uniform_mesh

EACH = [[(k, 1)] for k in range(4)]
ALTERNATING = [[(0, 1), (1, -1), (2, 1), (3, -1)]]


@pytest.mark.slow
@pytest.mark.parametrize("groups", [EACH, ALTERNATING])
def test_floating_electrodes_are_those_of_scikit_fem(groups: list[list[tuple[int, int]]]) -> None:
    pytest.importorskip("skfem", reason="scikit-fem is a test extra; install squeezefilm[test]")
    from .skfem_plate import skfem_frequencies

    model = monomorph_on_a_uniform_mesh(1, 4, FROM_D31)
    columns = np.zeros((4, len(groups)))
    for column, group in enumerate(groups):
        for electrode, sign in group:
            columns[electrode, column] = sign
    wanted = skfem_frequencies(model, 41e3, 3, groups)  # type: ignore[arg-type]
    assert frequencies(model, 41e3, 3, columns) == pytest.approx(wanted, rel=1e-9)


@pytest.mark.nightly
def test_how_far_open_electrodes_raise_the_paper_s_mode_by_scikit_fem() -> None:
    pytest.importorskip("skfem", reason="scikit-fem is a test extra; install squeezefilm[test]")
    from .skfem_plate import skfem_frequencies

    model = monomorph_on_a_uniform_mesh(2, 8, FROM_D31)

    def rise(outer: object, guess: float) -> float:
        found = skfem_frequencies(model, guess, 3, outer)  # type: ignore[arg-type]
        return float(found[np.argmin(np.abs(found - guess))]) / short - 1

    short = 1.0
    short = 1 + rise("shorted", 34783.0)
    # Coarse elements exaggerate: the refined plate rises by 3.55 % (each strip floating). Only
    # ceramics without any outer metal rise by more than PLATES.md's 4.1 %.
    assert rise(EACH, 36126.0) == pytest.approx(0.0386, abs=1e-4)
    assert rise(ALTERNATING, 36113.0) == pytest.approx(0.0382, abs=1e-4)
    assert rise("bare", 36391.0) == pytest.approx(0.0462, abs=1e-4)


def shunted(resistance: float | None, quality: float = 1e4) -> RectangularPlate:
    electrode = "open" if resistance is None else "shunted"
    sensing = CeramicPatch(
        14e-3, 0, 8e-3, 14e-3, 0.5e-3, electrode=electrode,  # type: ignore[arg-type]
        shunt_resistance=resistance,
    )  # fmt: skip
    return small(
        patches=(CeramicPatch(2e-3, 0, 8e-3, 14e-3, 0.5e-3), sensing), quality_factor=quality
    )


@pytest.mark.slow
def test_shunts_reach_from_short_to_open_and_damp_in_between() -> None:
    def solved(plate: RectangularPlate) -> tuple[float, float]:
        modes = solve_modes(plate, near=19e3, count=1, driven_only=True)
        return float(modes.frequencies[0]), float(modes.quality_factors[0])

    patches = shunted(1.0).patches
    short = solved(
        dataclasses.replace(
            shunted(1.0),
            patches=(
                patches[0],
                dataclasses.replace(patches[1], electrode="shorted", shunt_resistance=None),
            ),
        )
    )
    opened = solved(shunted(None))
    low, high = solved(shunted(1e-6)), solved(shunted(1e12))
    assert low == pytest.approx(short, rel=1e-6)
    assert opened[0] > 1.002 * short[0]
    # The open plate was solved with its own shapes, extrapolated on its own.
    assert high[0] / short[0] - 1 == pytest.approx(opened[0] / short[0] - 1, rel=0.03)
    assert high[1] == pytest.approx(1e4, rel=1e-3)
    middle = [solved(shunted(R)) for R in (300.0, 3e3, 30e3)]
    assert min(q for _, q in middle) < 500
    assert all(short[0] < f < opened[0] for f, _ in middle)
    assert [f for f, _ in middle] == sorted(f for f, _ in middle)


@pytest.mark.slow
def test_a_shunted_mode_is_the_peak_of_the_harmonic_response() -> None:
    plate = shunted(3e3)
    modes = solve_modes(plate, near=19e3, count=1, driven_only=True)
    f0, q = modes.frequencies[0], modes.quality_factors[0]
    f = f0 * (1 + np.linspace(-1.5, 1.5, 301) / q)
    response = harmonic_response(plate, f)
    conductance = response.admittance.real
    half = f[conductance > conductance.max() / 2]
    assert f[np.argmax(conductance)] == pytest.approx(f0, rel=5e-4)
    assert f0 / (half[-1] - half[0]) == pytest.approx(q, rel=0.03)


@pytest.mark.slow
def test_ceramics_of_two_thicknesses_are_those_of_scikit_fem() -> None:
    pytest.importorskip("skfem", reason="scikit-fem is a test extra; install squeezefilm[test]")
    from .skfem_plate import skfem_frequencies

    plate = small(
        patches=(
            CeramicPatch(2e-3, 0, 8e-3, 14e-3, 0.5e-3),
            CeramicPatch(14e-3, 2e-3, 8e-3, 10e-3, 0.8e-3, -1),
            CeramicPatch(4e-3, 0, 8e-3, 14e-3, 0.3e-3, 1, "top"),
        )
    )
    quadratic = Resolution((), (), 2, 0, 0, 2, trunk=np.inf)
    model = plate_model(plate, 1e3, quadratic).model
    assert {*model.x.orders, *model.y.orders, *model.z.orders} == {2}
    assert model.z.edges == pytest.approx([-0.8e-3, -0.5e-3, 0, 1.2e-3, 1.5e-3])
    wanted = skfem_frequencies(model, 20e3, 3)
    # The oracle finds a rigid body too.
    wanted = wanted[wanted > 100.0]
    assert wanted.size == 2
    assert frequencies(model, 20e3, 3)[:2] == pytest.approx(wanted, rel=1e-8)


@pytest.mark.slow
def test_thicknesses_that_hardly_differ_solve_like_equal_ones() -> None:
    plate = small()
    other = dataclasses.replace(plate.patches[1], thickness=0.5e-3 + 20e-6)
    uneven = dataclasses.replace(plate, patches=(plate.patches[0], other))
    even = solve_modes(plate, near=19e3, count=1).frequencies[0]
    thicker = tuple(dataclasses.replace(p, thickness=0.5e-3 + 20e-6) for p in plate.patches)
    both = solve_modes(dataclasses.replace(plate, patches=thicker), near=19e3, count=1)
    one = solve_modes(uneven, near=19e3, count=1)
    # One of two mirror images changed by little: half the change of both.
    whole = both.frequencies[0] - even
    assert one.frequencies[0] - even == pytest.approx(whole / 2, rel=0.15)


def foams(first: float, second: float) -> tuple[FoamSupport, FoamSupport]:
    return (
        FoamSupport(0, 0, 1.5e-3, 14e-3, 1e-3, 5e6, first),
        FoamSupport(22.5e-3, 0, 1.5e-3, 14e-3, 1e-3, 5e6, second),
    )


@pytest.mark.slow
def test_each_strip_of_foam_has_its_own_loss() -> None:
    def loss(first: float, second: float) -> float:
        plate = small(supports=foams(first, second), quality_factor=1e6)
        modes = solve_modes(plate, near=19e3, count=1, tolerance=0.05)
        return float(1 / modes.quality_factors[0]) - 1e-6

    lossy, quiet = loss(2.0, 2.0), loss(1e5, 1e5)
    assert lossy > 1e4 * quiet
    # The plate is its own mirror image: either strip carries half.
    assert loss(2.0, 1e5) == pytest.approx(lossy / 2, rel=1e-2)
    assert loss(1e5, 2.0) == pytest.approx(lossy / 2, rel=1e-2)


def test_power_is_conserved_with_two_kinds_of_foam() -> None:
    plate = small(supports=foams(2.0, 50.0))
    f = np.linspace(15e3, 21e3, 13)
    response = harmonic_response(plate, f)
    assert 50 * response.admittance.real == pytest.approx(lost_power(response, 10), rel=1e-6)


@pytest.mark.slow
def test_the_response_stands_at_the_extrapolated_frequency() -> None:
    plate = monomorph()
    modes = solve_modes(plate, mode=(8, 0))
    f = modes.frequencies[0] + np.linspace(-40, 60, 201)
    peaks = []
    for extrapolate in (True, False):
        response = harmonic_response(plate, f, extrapolate=extrapolate)
        peaks.append(float(f[response.resonance]))
    shift = modes.mesh_frequencies[0] - modes.frequencies[0]
    assert shift > 5
    assert peaks[1] - peaks[0] == pytest.approx(shift, abs=1.0)


def test_a_plate_too_slender_for_solid_elements_is_refused() -> None:
    with pytest.raises(OutOfRangeError, match="half a wave"):
        solve_modes(small(), near=0.5, count=1)


@pytest.mark.slow
def test_an_interrupted_solve_leaves_the_next_one_as_it_was() -> None:
    plate = small()
    texts: list[str] = []

    def stop(text: str, fraction: float) -> None:
        texts.append(text)
        assert 0 <= fraction <= 1
        if text.startswith("fine"):
            raise KeyboardInterrupt

    before = solve_modes(plate, near=19e3, count=1).frequencies
    with pytest.raises(KeyboardInterrupt):
        solve_modes(plate, near=19e3, count=1, progress=stop)
    assert sum(text.startswith("coarse") for text in texts) == 4
    assert np.array_equal(solve_modes(plate, near=19e3, count=1).frequencies, before)
