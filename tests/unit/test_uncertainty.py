"""Uncertain parameters and the propagation of their distributions."""

import dataclasses
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest

from squeezefilm.analysis import uncertainty
from squeezefilm.analysis.parameters import (
    Parameter,
    replaced,
    uncertain_parameters,
    value_at,
)
from squeezefilm.analysis.uncertainty import (
    Influence,
    UncertainFriction,
    friction_band,
    uncertain_friction,
)
from squeezefilm.chain.prediction import predict
from squeezefilm.config.provenance import Provenance
from squeezefilm.display import Display, load_display
from squeezefilm.distributions import Uniform
from squeezefilm.errors import InputError, OutOfRangeError
from squeezefilm.quantities import Unit


@pytest.fixture(scope="module")
def stator() -> Display:
    return load_display("biet2008-stator")


def _given(display: Display, **ranges: tuple[float, float]) -> Display:
    """The display with these distributions beside its values (a path with __ for its dots)."""
    known = dict(display.provenance)
    for name, (low, high) in ranges.items():
        known[name.replace("__", ".")] = Provenance("test", "measured", Uniform(low, high))
    return dataclasses.replace(display, provenance=known)


def test_values_are_found_and_replaced_by_their_path(stator: Display) -> None:
    changed = replaced(
        stator,
        {
            "surfaces.1.roughness": 1e-6,
            "finger.asperities.decay_length": 1e-7,
            "gas.viscosity": 2e-5,
        },
    )
    assert value_at(changed, "surfaces.1.roughness")[0] == 1e-6
    assert value_at(changed, "finger.asperities.decay_length")[0] == 1e-7
    assert changed.gas.viscosity == 2e-5
    assert changed.surfaces[0] == stator.surfaces[0]
    assert stator.surfaces[1].roughness == 0.2e-6
    assert value_at(stator, "finger.plateau_width")[1].symbol == "m"


def test_what_is_given_stands_before_what_is_assumed(stator: Display) -> None:
    names = {p.path: p.origin for p in uncertain_parameters(stator, driven=False)}
    assert names["finger.plateau_width"] == "assumed"
    assert "actuator.quality_factor" not in names
    known = _given(stator, finger__plateau_width=(249e-6, 251e-6), drive__voltage=(130.0, 150.0))
    driven = {p.path: p for p in uncertain_parameters(known, "bare", driven=True)}
    assert driven["finger.plateau_width"].origin == "given"
    assert driven["finger.plateau_width"].distribution.support == (249e-6, 251e-6)
    assert "drive.voltage" in driven
    assert "surfaces.1.roughness" in driven
    assert "surfaces.0.roughness" not in driven
    assert "drive.voltage" not in {p.path for p in uncertain_parameters(known, driven=False)}
    # What a finger takes from the vibration matters where there is one to take from.
    damping = "finger.skin.damping_per_area"
    assert damping not in names
    assert driven[damping].distribution.support == pytest.approx((0.4 * 7.7e5, 1.6 * 7.7e5))
    bare = replaced(known, {damping: 0.0})
    assert damping not in {p.path for p in uncertain_parameters(bare, driven=True)}


@pytest.mark.slow
def test_a_range_that_is_known_better_narrows_the_interval(stator: Display) -> None:
    p = predict(stator, vibration_amplitude=2e-6)
    wide = uncertain_friction(stator, p, samples=32)
    ranges = {
        "finger__plateau_width": (249e-6, 251e-6),
        "finger__asperities__reference_gap": (1.99e-6, 2.01e-6),
    }
    narrow = uncertain_friction(_given(stator, **ranges), p, samples=32)
    assert np.ptp(narrow.interval) < 0.6 * np.ptp(wide.interval)
    assert wide.interval[0] < wide.median < wide.interval[1]
    # Both were the most important ones.
    assert {item.parameter.path for item in wide.influences[:2]} == {
        name.replace("__", ".") for name in ranges
    }
    again = uncertain_friction(stator, p, samples=32)
    assert again.interval == wide.interval


@pytest.mark.slow
def test_a_linear_model_has_the_indices_of_its_variances(
    stator: Display, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With µ′/µ replaced by a sum, first and total order are the shares of the variance."""

    def linear(display, prediction, free, compliance):  # type: ignore[no-untyped-def]
        finger = display.finger
        return (
            2 * finger.plateau_width / 250e-6 + finger.contact_length / 10e-3 + 0.5 * compliance,
            free,
        )

    monkeypatch.setattr(uncertainty, "_one", linear)
    found = uncertainty.uncertain_friction(
        stator, predict(stator, vibration_amplitude=2e-6), samples=1024
    )
    shares = {item.parameter.path: item for item in found.influences}
    # Uniform widths: 0.8 × 2, 0.4 × 1, 1 × 0.5
    variances = {
        "finger.plateau_width": 1.6**2,
        "finger.contact_length": 0.4**2,
        "skin_compliance": 0.5**2,
    }
    for name, variance in variances.items():
        expected = variance / sum(variances.values())
        assert shares[name].first_order == pytest.approx(expected, abs=0.02)
        assert shares[name].total == pytest.approx(expected, abs=0.02)
    assert shares["surfaces.0.roughness"].total == pytest.approx(0, abs=1e-6)
    # The 5 % and 95 % quantiles of that sum, by brute force.
    draw = np.random.default_rng(0).random((3, 10**6))
    total = 2 * (0.6 + 0.8 * draw[0]) + 0.8 + 0.4 * draw[1] + 0.5 * draw[2]
    assert found.interval == pytest.approx(np.quantile(total, [0.05, 0.95]), rel=0.01)


@pytest.mark.slow
def test_impossible_designs_are_refused(stator: Display) -> None:
    p = predict(stator, vibration_amplitude=2e-6)
    with pytest.raises(InputError, match="power of two"):
        uncertain_friction(stator, p, samples=100)
    hard = _given(stator, finger__asperities__reference_gap=(0.01e-6, 2.1e-6))
    p = predict(stator, vibration_amplitude=2e-6, normal_force=5.0)
    with pytest.raises(OutOfRangeError, match="presses its asperities through"):
        uncertain_friction(hard, p, samples=8)


SURFACE = "adhesive"


class _Law(NamedTuple):
    """A friction law that needs no film: each limit falls with the amplitude by its own slope."""

    own: float = 1.0
    tied: float = 2.0

    def limits(self, amplitude: Any) -> Any:
        a = np.atleast_1d(np.asarray(amplitude, dtype=float)) / 1e-6
        return SimpleNamespace(own=1 - 0.1 * self.own * a, one_gap=1 - 0.1 * self.tied * a)


def _predicted(**changes: Any) -> Any:
    values: dict[str, Any] = {
        "voltage": None, "surface": SimpleNamespace(name=SURFACE), "vibration_amplitude": 2e-6,
        "touch": SimpleNamespace(free_amplitude=3e-6), "frequency": 40e3, "normal_force": 0.5,
        "mode": SimpleNamespace(half_wavelength=9e-3, modal_mass=None, quality_factor=200.0),
        "law": SimpleNamespace(position=1e-3),
    }  # fmt: skip
    return SimpleNamespace(**{**values, **changes})


@pytest.fixture
def made_up(monkeypatch: pytest.MonkeyPatch) -> Callable[..., Any]:
    """`uncertain_friction` with µ′/µ of a sample by a function of display and compliance."""

    def found(function: Callable[[Display, float], float], display: Display, **more: Any) -> Any:
        def one(here: Display, _: Any, free: float, compliance: float) -> tuple[float, float]:
            value = function(here, compliance)
            return value, 1e-6 * value + free

        monkeypatch.setattr(uncertainty, "_one", one)
        monkeypatch.setattr(uncertainty, "_nominal", lambda _: 0.7)
        return uncertain_friction(display, _predicted(), **more)

    return found


@pytest.mark.parametrize("samples", [0, 4, 7, 9, 12, 100, 131072])
def test_a_design_needs_a_power_of_two(stator: Display, samples: int) -> None:
    with pytest.raises(InputError, match=f"samples = {samples} .* power of two from 8 to 65536"):
        uncertain_friction(stator, _predicted(), samples=samples)


def test_all_that_is_uncertain_is_varied_and_summed_up(
    stator: Display, made_up: Callable[..., Any]
) -> None:
    told: list[str] = []
    every: list[float] = []

    def friction(here: Display, compliance: float) -> float:
        every.append(0.5 * here.finger.contact_length / 10e-3 + 0.2 * compliance)
        return every[-1]

    found = made_up(friction, stator, samples=64, seed=3, progress=told.append)
    # Six parameters: a finger's four, the roughness, the skin; Saltelli's eight blocks of 64.
    assert found.evaluations == len(every) == 64 * 8
    assert (found.failed, found.seed, found.level, found.nominal) == (0, 3, 0.9, 0.7)
    # The two independent samples are the first and last of each eight.
    rows = np.reshape(every, (64, 8))
    assert found.samples == pytest.approx(np.concatenate([rows[:, 0], rows[:, -1]]))
    assert found.amplitudes == pytest.approx(3e-6 + 1e-6 * found.samples)
    assert (found.interval[0], found.median, found.interval[1]) == pytest.approx(
        np.quantile(found.samples, [0.05, 0.5, 0.95])
    )
    # Between 0.4 and 0.6, and 0 and 0.2: each as wide, each half of the variance.
    assert 0.4 < np.min(found.samples) < 0.45
    assert 0.75 < np.max(found.samples) < 0.8
    shares = {one.parameter.path: one for one in found.influences}
    assert len(shares) == 6
    for name in ("finger.contact_length", "skin_compliance"):
        assert shares[name].total == pytest.approx(0.5, abs=0.1)
        assert shares[name].first_order == pytest.approx(0.5, abs=0.2)
        assert 0 < shares[name].total_error < 0.4
        assert 0 < shares[name].first_order_error < 0.6
    totals = [one.total for one in found.influences]
    assert totals == sorted(totals, reverse=True)
    assert totals[2:] == pytest.approx([0] * 4, abs=1e-9)
    # Said some twenty times, from the first sample on.
    assert told[:2] == ["friction of sample 1 of 512", "friction of sample 26 of 512"]
    assert len(told) == 21


def test_what_matters_only_in_company_has_a_total_and_no_first_order(
    stator: Display, made_up: Callable[..., Any]
) -> None:
    """A product of two centred values: neither alone moves the mean, both together all of it."""
    found = made_up(
        lambda here, compliance: (here.finger.contact_length / 10e-3 - 1) * (compliance - 0.5),
        stator,
        samples=64,
    )
    for one in found.influences[:2]:
        assert one.parameter.path in ("finger.contact_length", "skin_compliance")
        # Nothing and all of it; 64 samples tell no more than that.
        assert one.first_order < 0.5 < 0.65 < one.total


@pytest.mark.parametrize(("lost", "kept"), [((0, 1, 17), 6), ((3, 9, 60), 5)])
def test_what_has_no_balance_is_left_out_with_its_row(
    stator: Display, made_up: Callable[..., Any], lost: tuple[int, ...], kept: int
) -> None:
    number = iter(range(64))

    def friction(_: Display, compliance: float) -> float:
        if next(number) in lost:
            raise OutOfRangeError("pressed through")
        return compliance

    found = made_up(friction, stator, samples=8)
    assert (found.failed, found.evaluations, found.samples.size) == (3, 64, 2 * kept)
    assert np.all(np.isfinite(found.samples))
    assert found.amplitudes.size == 2 * kept


def test_more_than_one_in_twenty_without_balance_is_refused(
    stator: Display, made_up: Callable[..., Any]
) -> None:
    number = iter(range(64))

    def friction(_: Display, compliance: float) -> float:
        if next(number) % 16 == 0:
            raise OutOfRangeError("pressed through")
        return compliance

    with pytest.raises(OutOfRangeError, match="4 of 64 samples have no load balance"):
        made_up(friction, stator, samples=8)


def test_an_uncertain_friction_is_said_and_listed() -> None:
    parameter = Parameter("finger.p", 2e-4, Unit("m"), Uniform(150e-6, 350e-6), "given", "a paper")
    found = UncertainFriction(
        nominal=0.412, median=0.43, interval=(0.281, 0.549), level=0.9, samples=np.zeros(2),
        amplitudes=np.zeros(2), influences=(Influence(parameter, 0.1, 0.2, 0.3, 0.4),), failed=2,
        evaluations=64, seed=5, model="a-model",
    )  # fmt: skip
    assert found.sentence == "µ′/µ = 0.41 (0.28–0.55)"
    assert found.summary() == {
        "relative_friction": 0.412, "relative_friction_median": 0.43,
        "relative_friction_interval": [0.281, 0.549], "interval_level": 0.9, "evaluations": 64,
        "failed": 2, "seed": 5,
        "measure_next": [
            {
                "parameter": "finger.p", "first_order": 0.1, "first_order_error": 0.2,
                "total_order": 0.3, "total_order_error": 0.4, "distribution": "given",
                "range": ["150 um", "350 um"], "source": "a paper",
            }
        ],
    }  # fmt: skip


def test_a_band_lies_between_the_limits_of_the_skin_and_ends_where_half_are_pressed_through(
    stator: Display, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Above 3 µm all but the least compliant fail, above 2 µm some."""

    class Law:
        def __init__(self, display: Display) -> None:
            self.wide = display.finger.contact_length / 10e-3  # 0.8 to 1.2, uniform

        def limits(self, amplitude: np.ndarray) -> Any:
            found = _Law(self.wide, self.wide).limits(amplitude)
            gone = (amplitude > 2.5e-6) & (self.wide > 0.9)
            some = (amplitude > 1.5e-6) & (self.wide > 1.1)
            own = np.where(gone | some, np.nan, found.own)
            return SimpleNamespace(own=own, one_gap=own)

    monkeypatch.setattr(uncertainty, "_law", lambda display, _: Law(display))
    told: list[tuple[str, float]] = []
    amplitude = np.array([1e-6, 2e-6, 3e-6])
    band = friction_band(
        stator, _predicted(), amplitude, samples=128, progress=lambda *said: told.append(said)
    )
    assert band.amplitude is amplitude
    assert (band.level, band.samples) == (0.9, 128)
    # 1 − 0.1 w over w from 0.8 to 1.2; the 5 % at each end are left out.
    assert band.low[0] == pytest.approx(1 - 0.1 * 1.18, abs=2e-3)
    assert band.high[0] == pytest.approx(1 - 0.1 * 0.82, abs=2e-3)
    # A quarter failed: of w from 0.8 to 1.1.
    assert band.low[1] == pytest.approx(1 - 0.2 * 1.085, abs=4e-3)
    assert band.high[1] == pytest.approx(1 - 0.2 * 0.815, abs=4e-3)
    assert np.isnan([band.low[2], band.high[2]]).all()
    assert told[0] == ("sample 1 of 128", 0.0)
    assert told[-1] == ("sample 128 of 128", 127 / 128)


def test_a_band_mixes_the_limits_by_the_skin_and_skips_what_fails_as_a_whole(
    stator: Display, monkeypatch: pytest.MonkeyPatch
) -> None:
    number = iter(range(64))

    def law(*_: Any) -> _Law:
        if next(number) % 4 == 0:
            raise OutOfRangeError("pressed through")
        return _Law(own=1.0, tied=3.0)

    monkeypatch.setattr(uncertainty, "_law", law)
    band = friction_band(stator, _predicted(), np.array([1e-6]), samples=64)
    # From all ridges at one gap, 0.7, to each at its own, 0.9; evenly in between.
    assert band.low[0] == pytest.approx(0.71, abs=0.01)
    assert band.high[0] == pytest.approx(0.89, abs=0.01)


def test_a_sample_is_asked_at_the_predictions_working_point(
    stator: Display, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[Any] = []
    monkeypatch.setattr(
        uncertainty, "friction_law", lambda *given, **named: asked.append((given, named)) or _Law()
    )
    p = _predicted()
    value, amplitude = uncertainty._one(stator, p, 3e-6, 0.25)
    # At 3 µm 0.7 by each ridge's own balance, 0.4 at one gap.
    assert value == pytest.approx(0.25 * 0.7 + 0.75 * 0.4)
    assert amplitude == 3e-6
    assert asked == [
        (
            (stator, 9e-3, 40e3),
            {
                "surface": stator.surfaces[0], "normal_force": 0.5, "position": 1e-3,
                "model": "partial-levitation",
            },
        )
    ]  # fmt: skip


@dataclasses.dataclass(frozen=True)
class _Mode:
    half_wavelength: float = 9e-3
    modal_mass: float | None = 0.1
    quality_factor: float = 60.0


def test_a_finger_takes_its_share_of_a_driven_amplitude(
    stator: Display, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the quality factor of the sample; not where the amplitude is given or no mass known."""
    touched: list[tuple[float, float]] = []

    def touch(mode: _Mode, _: Any, free: float) -> Any:
        touched.append((mode.quality_factor, free))
        return SimpleNamespace(amplitude=0.5 * free)

    monkeypatch.setattr(uncertainty, "friction_law", lambda *_, **__: _Law())
    monkeypatch.setattr(uncertainty, "touch", touch)
    other = replaced(stator, {"actuator.quality_factor": 150.0})
    driven = _predicted(voltage=140.0, mode=_Mode())
    value, amplitude = uncertainty._one(other, driven, 3e-6, 1.0)
    assert (value, amplitude) == pytest.approx((0.85, 1.5e-6))
    assert touched == [(150.0, 3e-6)]
    for p in (_predicted(mode=_Mode()), _predicted(voltage=140.0, mode=_Mode(modal_mass=None))):
        assert uncertainty._one(other, p, 3e-6, 1.0)[1] == 3e-6
    assert len(touched) == 1


def test_the_free_amplitude_follows_voltage_quality_and_dimensions(
    stator: Display, monkeypatch: pytest.MonkeyPatch
) -> None:
    plate = load_display("biet2008-plate")
    disc = load_display("winfield2007-tpad")
    # A made-up actuator moves with its thickness, a plate (as a beam) ten times as far.
    monkeypatch.setattr(
        uncertainty, "beam_response", lambda a: SimpleNamespace(amplitude_per_volt=10 * a.thickness)
    )
    monkeypatch.setattr(
        uncertainty, "working_mode",
        lambda a: SimpleNamespace(amplitude_per_volt=getattr(a, "thickness", 1.0)),
    )  # fmt: skip

    def shares(display: Display, *changes: dict[str, float], **more: Any) -> list[float]:
        free = uncertainty._Amplitude(display, _predicted(voltage=15.0, **more))
        return [free(replaced(display, one)) / 3e-6 for one in changes]

    volts = {"drive.voltage": 1.1 * plate.drive.voltage}
    q = {"actuator.quality_factor": 0.8 * plate.actuator.quality_factor}
    thick = {"actuator.thickness": 1.2 * 2e-3}
    found = shares(plate, {}, volts, q, volts | q, thick, volts | thick, {"gas.viscosity": 2e-5})
    assert found == pytest.approx([1, 1.1, 0.8, 0.88, 1.2, 1.32, 1])
    # A plate whose Q differs too is solved with both.
    assert shares(plate, q | thick) == pytest.approx([1.2])
    assert shares(disc, {}, {"actuator.thickness": 1.5 * 1.6e-3}) == pytest.approx([1, 1.5])
    # A stator's amplitude is measured: its Q is in it.
    assert shares(stator, {"actuator.quality_factor": 100.0}) == pytest.approx([1])
    # Where the amplitude is given nothing of drive and actuator moves it.
    free = uncertainty._Amplitude(plate, _predicted())
    assert free(replaced(plate, volts | q | thick)) == 3e-6
    # At rest there is nothing to be in proportion to.
    still = dataclasses.replace(plate, drive=dataclasses.replace(plate.drive, voltage=0.0))
    assert uncertainty._Amplitude(still, _predicted(voltage=15.0))(plate) == 3e-6


def test_the_nominal_friction_is_by_partial_levitation() -> None:
    @dataclasses.dataclass
    class Law:
        model: str

        def at(self, amplitude: float) -> float:
            return {"partial-levitation": 0.4, "paper2008": 0.1}[self.model] + amplitude

    assert uncertainty._nominal(_predicted(law=Law("paper2008"))) == pytest.approx(0.4 + 2e-6)
