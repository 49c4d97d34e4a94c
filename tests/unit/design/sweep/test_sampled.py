"""Samples in ranges: even, within their ends, the same with the same seed, and extended by more."""

import numpy as np
import pytest

from squeezefilm.core.errors import InputError
from squeezefilm.design.sweep.axes import axes_of
from squeezefilm.design.sweep.sweep import SweepRequest, plan_of
from squeezefilm.physics.display import load_display

PLATE = load_display("biet2008-plate")
RANGES = ["actuator.thickness=1 mm..3 mm", "voltage=1 V..100 V:log"]


def test_they_fill_their_ranges_evenly_and_the_logarithm_where_asked() -> None:
    axis, other = axes_of(PLATE, [*RANGES, "surface=adhesive, bare"], sample=(64, 0))
    assert other.steps == (("adhesive",), ("bare",))
    assert axis.names == ("actuator.thickness", "voltage")
    assert axis.sampled == ("linear", "log")
    thickness, volts = np.array(axis.steps).T
    for share in ((thickness - 1e-3) / 2e-3, np.log10(volts) / 2):
        # One in each sixty-fourth: what makes a Sobol sequence even.
        assert sorted(np.floor(64 * share).astype(int)) == list(range(64))


def test_more_of_one_seed_begin_with_the_same_and_another_seed_has_others() -> None:
    few, more = (axes_of(PLATE, RANGES, sample=(count, 3))[0].steps for count in (5, 40))
    assert more[:5] == few
    assert axes_of(PLATE, RANGES, sample=(5, 4))[0].steps != few
    given = {"actuator.thickness": "1 mm..3 mm", "voltage": "1 V..100 V:log", "speed": 0.1}
    axis, other = axes_of(PLATE, given, sample=(5, 3))
    assert axis.steps == few
    assert (other.names, other.steps) == (("speed",), ((0.1,),))
    with pytest.raises(InputError, match="no number of steps"):
        axes_of(PLATE, RANGES)


def test_whole_numbers_stay_whole() -> None:
    (axis,) = axes_of(PLATE, "actuator.nodal_lines=4..8", sample=(50, 0))
    assert {value for (value,) in axis.steps} == {4, 5, 6, 7, 8}


@pytest.mark.parametrize(
    ("vary", "count", "message"),
    [
        (["voltage=1 V, 2 V"], 5, "none is given"),
        (["surface=a..b"], 5, "takes words"),
        (["voltage=2 V..2 V"], 5, "is no range"),
        (["speed=0 m/s..1 m/s:log"], 5, "above 0 for a logarithm|speed"),
        (RANGES, 0, "samples = 0"),
        (RANGES, 10**6, "samples = 1 000 000"),
    ],
)
def test_what_cannot_be_drawn_is_refused(vary: list[str], count: int, message: str) -> None:
    with pytest.raises(InputError, match=message):
        axes_of(PLATE, vary, sample=(count, 0))


def test_modes_are_not_followed_over_samples() -> None:
    with pytest.raises(InputError, match="modes are followed over a grid, not over samples"):
        plan_of(
            SweepRequest(PLATE, vary=["actuator.thickness=1 mm..2 mm"], ask="followed", sample=8)
        )
