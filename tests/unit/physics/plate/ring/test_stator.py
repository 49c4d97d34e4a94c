"""A stator fitted to one frequency: what it refuses, by day; how good it is, in verification."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import pytest

from squeezefilm.core.errors import InputError, UnreachableError
from squeezefilm.physics.plate.ring import stator
from squeezefilm.physics.plate.ring.section import alternate_sectors
from squeezefilm.physics.plate.ring.stator import StatorAssumptions, fit_stator, stator_section


def test_a_frequency_that_no_thickness_has_is_refused_with_those_that_some_has() -> None:
    with pytest.raises(UnreachableError, match=r"no ring thickness from .* lies between") as caught:
        fit_stator(frequency=400e3, degree=3)
    assert caught.value.quantity == "frequency"


class Rings:
    """Rings whose frequency is 10 MHz/m of thickness, 30 with stiff teeth, instead of solving."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.asked: list[tuple[Any, ...]] = []

        def section(*given: Any) -> tuple[Any, ...]:
            self.asked.append(given)
            return given

        def mode(made: tuple[Any, ...], waves: int, **rest: Any) -> SimpleNamespace:
            _, thickness, assumed, teeth = made
            assert rest == {"degree": 4, "quality_factor": assumed.quality_factor}
            slope = 30e6 if teeth == "stiff" else 10e6
            return SimpleNamespace(
                frequency=slope * thickness, waves=waves, amplitude_per_volt=lambda drive: 3e-9
            )

        def frequency(made: tuple[Any, ...], waves: int, *, degree: int) -> float:
            _, thickness, _, teeth = made
            # Coarse elements are stiffer.
            stiffer = 1.01 if degree < 4 else 1.0
            return stiffer * (30e6 if teeth == "stiff" else 10e6) * thickness

        monkeypatch.setattr(stator, "stator_section", section)
        monkeypatch.setattr(stator, "bending_frequency", frequency)
        monkeypatch.setattr(stator, "bending_mode", mode)


def test_a_thickness_is_fitted_between_its_bounds(monkeypatch: pytest.MonkeyPatch) -> None:
    rings = Rings(monkeypatch)
    fit = fit_stator(45e3, 20e-3, 7, degree=4)
    assert fit.ring_thickness == pytest.approx(4.5e-3, abs=1e-8)
    assert fit.mode.frequency == pytest.approx(45e3, rel=1e-5)
    assert fit.frequency_bounds == pytest.approx((45e3, 135e3), rel=1e-5)
    assert fit.thickness_bounds == pytest.approx((1.5e-3, 4.5e-3), abs=1e-8)
    assert all(given[0] == pytest.approx(7 * 20e-3 / math.pi) for given in rings.asked)
    assert fit.assumptions == StatorAssumptions()
    # Eight sectors half a wave long.
    assert fit.drive == alternate_sectors(8, math.pi / 7)
    assert fit.amplitude(5.0) == pytest.approx(15e-9)
    assert fit.section[3] == "soft"


def test_stiff_teeth_may_be_what_is_fitted(monkeypatch: pytest.MonkeyPatch) -> None:
    Rings(monkeypatch)
    stiff = StatorAssumptions(tooth_model="stiff")
    fit = fit_stator(45e3, 20e-3, 7, stiff, degree=4)
    assert fit.ring_thickness == pytest.approx(1.5e-3, abs=1e-8)
    assert fit.frequency_bounds == pytest.approx((15e3, 45e3), rel=1e-5)
    assert fit.section[3] == "stiff"


def test_a_ring_without_teeth_has_one_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    Rings(monkeypatch)
    fit = fit_stator(45e3, 20e-3, 7, StatorAssumptions(tooth_height=0.0), degree=4)
    assert fit.thickness_bounds == pytest.approx((4.5e-3, 4.5e-3), abs=1e-8)


def test_a_stiff_bound_out_of_reach_is_the_thinnest_unless_it_is_fitted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    Rings(monkeypatch)
    fit = fit_stator(45e3, 20e-3, 7, thinnest=2e-3, degree=4)
    assert fit.thickness_bounds == pytest.approx((2e-3, 4.5e-3), abs=1e-8)
    stiff = StatorAssumptions(tooth_model="stiff")
    with pytest.raises(UnreachableError, match="with stiff teeth"):
        fit_stator(45e3, 20e-3, 7, stiff, thinnest=2e-3, degree=4)
    with pytest.raises(UnreachableError, match=r"lies between 3 kHz and 100 kHz") as caught:
        fit_stator(101e3, 20e-3, 7, degree=4)
    assert caught.value.quantity == "frequency"


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"frequency": 0.0}, "frequency"), ({"wavelength": 0.0}, "wavelength"),
        ({"waves": 1}, "waves"), ({"thinnest": 0.0}, "thinnest"),
        ({"thinnest": 2e-3, "thickest": 2e-3}, "thickest"),
    ],
)  # fmt: skip
def test_a_fit_that_cannot_be_is_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        fit_stator(**changes)


@pytest.mark.parametrize("outer", [50e-3, 100e-3])
def test_an_outer_diameter_beside_the_mean_one_is_refused(outer: float) -> None:
    with pytest.raises(InputError, match="outer_diameter"):
        stator_section(50e-3, 3e-3, StatorAssumptions(outer_diameter=outer), "soft")
